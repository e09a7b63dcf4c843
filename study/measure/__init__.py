"""Computing time and error of laws, elastic solutions and time integration, and their limits.

`charts` times laws, elastic solutions (solvers), time integration (steppers) and ``flexible``
links; `timing` makes and reads the tables of times. Other programs are timed by benchmarks in
`tests`. `explicit` integrates rigid links by three explicit schemes. `stability` predicts and
observes the limits of such steps, and finds the limits of other methods by bisection.
"""
