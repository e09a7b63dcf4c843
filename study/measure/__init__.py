"""Speed against accuracy, and where methods fail.

`speed` reads the charts of times; what times them, and the other programs, are benchmarks beside
the tests. `explicit` steps rigid links by five explicit schemes. `stability` predicts and observes
where such steps and impacts fail, `thresholds` finds where anything fails.
"""
