"""The closed form with 16 numbers of notebook 25, compiled as an engineer would program it.

A force takes seven steps from the depth, as the notebook says. There is no stiffness.
"""

from collections.abc import Callable
from math import sqrt

import pandas as pd

from study import paths
from study.compiled import compiled
from study.joint import Joint

STEPS = 7  # from a depth to its force
NUMBERS = paths.FIGURES / "closed_form_numbers.csv"


@compiled
def _depth(x, share, w, h, ball, cross, wall, radius):
    """Depth over the clearance at Hertz's contact radius x over R2."""
    part = x * (ball[0] + ball[1] * x)
    left = 1 - h * x / (1 + (h * x / w) ** wall[1]) ** (1 / wall[1])
    socket = 1 - left * (1 + wall[0] * (x * x * left) ** 2)
    both = share * (1 - share) * socket * (cross[0] * part + cross[1] * socket)
    y = x * x * (1 - share * part - (1 - share) * socket + both)
    return y + (1 - 2 * share) * y * y / radius


@compiled
def _add(depths, clearance, unit, joint):
    """Forces at depths in m, added: nothing is optimised away."""
    total = 0.0
    for depth in depths:
        wanted = depth / clearance
        x = sqrt(wanted)
        for _ in range(STEPS):
            x *= (wanted / _depth(x, *joint)) ** 0.6
        total += unit * x * x * x
    return total


def program(joint: Joint) -> Callable:
    """A function of depths in m and the clearance that adds the forces over E* clearance^2."""
    table = pd.read_csv(NUMBERS)
    n = table[table.what == "number"].set_index("name").value
    q, poisson, socket_poisson = joint.socket_ratio, joint.ball.poisson, joint.socket.poisson
    share = (1 - poisson**2) * joint.modulus_shares[0]
    h = n.h0 * (1 - socket_poisson) + 1 / (n.h1 * (1 - socket_poisson) * (q**1.5 - 1))
    w = n.w0 + n.w1 * socket_poisson + 1 / (n.w2 + (n.w3 + n.w4 * socket_poisson) * q**3)
    constants = (n.b0, n.b1 + n.b2 * poisson), (n.c1, n.c2), (n.k, n.n)
    of_joint = (share, w, h, *constants, joint.r2_star)
    unit = 4 / 3 * sqrt(joint.r2_star * (joint.r2_star - 1))
    return lambda depths, clearance=1.0: _add(depths, clearance, unit, of_joint)
