"""Speed against accuracy, and where methods fail.

`charts` times laws, solvers, steppers and `flexible` links; `timing` makes and reads its tables.
Other programs are timed by benchmarks in `tests`. `explicit` steps rigid links by five
explicit schemes. `stability` predicts and observes where such steps and impacts fail, `thresholds`
finds where anything fails. `warm` compiles all stepping loops when the project is set up.
"""
