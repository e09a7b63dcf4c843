"""A free impact, integrated by SciPy."""

import numpy as np
from scipy.integrate import solve_ivp


def free_impact(factor, pull=0.0, depth=0.0, speed=1.0, power=1.5):
    """Speed at the end of x'' = -x^p (1 + D x') - pull, and largest tension over largest load."""

    def motion(t, y):
        return y[1], -(max(y[0], 0.0) ** power) * (1 + factor * y[1]) - pull

    def parting(t, y):
        return y[0]

    parting.terminal, parting.direction = True, -1
    options = {"method": "LSODA", "rtol": 1e-9, "atol": 1e-12, "max_step": 0.02}
    places, speeds = solve_ivp(motion, (0, 1e3), (depth, speed), events=parting, **options).y
    force = np.maximum(places, 0.0) ** power * (1 + factor * speeds)
    return -speeds[-1], max(-force.min(), 0.0) / force.max()
