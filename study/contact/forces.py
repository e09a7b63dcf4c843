"""Contact force at one point, compiled for the stepping loops of the mechanism, and its damping.

A law with its dimensions is one record of numbers (`DimensionalLaw.packed`), because compiled code
that is kept on disk cannot hold Python functions. A record is passed as a pointer: references to an
array would be counted at every call, which takes as long as a law. This module does not import the
laws: another law of a known shape compiles nothing again.

The damped normal force is F_N = P(d) (1 + D d'/v0). v0 is the approach speed at the start of the
impact, kept until the surfaces part. D is the damping factor; four rules give it from the
coefficient of restitution cr. Only ``exact`` delivers it.
"""

from collections.abc import Callable
from functools import lru_cache
from math import inf, log1p
from typing import Literal, NamedTuple

import numpy as np
from numba.extending import register_jitable

from study import checks
from study.compiled import compiled
from study.contact import shapes
from study.contact.shapes import SHAPES, chord, hertz, hyperbolic, liu, power, stiffened, winkler

HERTZ, WINKLER, POWER, CHORD, LIU, HYPERBOLIC, STIFFENED, TABLE = range(8)
"""Place of each shape in `SHAPES`."""
for _shape in (*SHAPES, shapes.cubic):  # a call takes as long as a law: they are inlined
    register_jitable(inline="always")(_shape)


@compiled
def elastic_force(law, depth):
    """Force of a packed law in N, and its derivative in N/m, at a depth > 0 in m."""
    ds, shape, constants = depth / law.clearance, law.shape_index, law.constants
    if shape == HERTZ:
        value, slope = hertz(ds, constants)
    elif shape == WINKLER:
        value, slope = winkler(ds, constants)
    elif shape == POWER:
        value, slope = power(ds, constants)
    elif shape == CHORD:
        value, slope = chord(ds, constants)
    elif shape == LIU:
        value, slope = liu(ds, constants)
    elif shape == HYPERBOLIC:
        value, slope = hyperbolic(ds, constants[: law.count])
    elif shape == STIFFENED:
        value, slope = stiffened(ds, constants)
    else:
        value, slope = shapes.table(ds, constants[: law.count])
    return law.scale * value, law.scale / law.clearance * slope


def _gauss(count):
    """Nodes and weights of Gauss's rule from 0 to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (1 + nodes) / 2, weights / 2


(NODES, WEIGHTS), (_FEW_NODES, _FEW_WEIGHTS) = _gauss(12), _gauss(4)


@compiled
def stored_energy(law, depth):
    """Elastic energy at a depth, in J: the force integrated over the depth.

    Gauss's rule is applied in the square root of the depth. All shapes are analytic in it but
    Steuermann's profiles of n > 1, whose error is 1e-11, and tables, of which each interval between
    two knots is integrated exactly.
    """
    energy = 0.0 * depth  # NaN of NaN, for which no comparison below holds
    if depth > 0 and law.shape_index == TABLE:
        root, step = np.sqrt(depth / law.clearance), 1 / law.constants[0]
        for k in range(int(np.ceil(root / step))):
            width = min(step, root - k * step)
            for node, weight in zip(_FEW_NODES, _FEW_WEIGHTS):  # noqa: B905
                s = k * step + node * width
                inner = s * s * law.clearance
                energy += weight * width * 2 * s * law.clearance * elastic_force(law, inner)[0]
    elif depth > 0:
        few_are_exact = law.shape_index == HERTZ or law.shape_index == WINKLER
        rule = (_FEW_NODES, _FEW_WEIGHTS) if few_are_exact else (NODES, WEIGHTS)
        for node, weight in zip(*rule):  # noqa: B905 (compiled code has no strict)
            energy += weight * 2 * node * depth * elastic_force(law, node * node * depth)[0]
    return energy


# Ambrosio's regularised Coulomb friction (Eqs. 32-33): the tangential force is -mu F_N times a
# factor that carries the sign of the sliding speed. Between its four kinks, at -v1, -v0, v0 and v1,
# the factor is linear: no force below v0, all of it above v1.


@compiled
def friction_regime(speed, v0, v1):
    """Number of the linear piece that a sliding speed lies in: -2, -1, 0, 1 or 2."""
    size = abs(speed)
    piece = 0 if size < v0 else (1 if size < v1 else 2)
    return piece if speed > 0 else -piece


@compiled
def friction_factor(speed, regime, v0, v1):
    """Signed factor c_d sign(v_T) of one linear piece, and its derivative by the speed."""
    if regime == 0:
        return 0.0, 0.0
    sign = 1.0 if regime > 0 else -1.0
    if abs(regime) == 2:
        return sign, 0.0
    return (speed - sign * v0) / (v1 - v0), 1 / (v1 - v0)


class JointForces(NamedTuple):
    """Forces of a joint in contact, with their derivatives."""

    normal: float
    normal_by_depth: float
    normal_by_rate: float
    elastic: float
    """Elastic part of the normal force."""
    tangential: float
    tangential_by_normal: float
    tangential_by_sliding: float


@compiled
def joint_forces(law, depth, rate, sliding, regime, approach, damping, friction, v0, v1):
    """Normal and tangential force at a depth > 0, as `JointForces` (Eqs. 31-33).

    ``regime`` is that of friction. Where the ball leaves faster than the approach speed over D,
    Eq. 31 pulls. It is kept as published, without friction while it pulls.
    """
    elastic, slope = elastic_force(law, depth)
    loss = damping / approach
    normal = elastic * (1 + loss * rate)
    factor, steep = friction_factor(sliding, regime, v0, v1)
    friction *= normal > 0
    return JointForces(
        normal,
        slope * (1 + loss * rate),
        elastic * loss,
        elastic,
        -friction * normal * factor,
        -friction * factor,
        -friction * normal * steep,
    )


Damping = Literal["lankarani-nikravesh", "hunt-crossley", "flores", "exact"]
POWERS = range(2, 60)  # of a series that converges as 0.5^k


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root of a function that is < 0 at ``low`` and > 0 at ``high``, halved to the last digit."""
    while low < (middle := (low + high) / 2) < high:
        if function(middle) < 0:
            low = middle
        else:
            high = middle
    return high


def _surplus(factor: float, restitution: float) -> float:
    """Value of ln((1+D)/(1-cr D)) - D (1 + cr), over D^2 in a series: 0 where D delivers cr."""
    if factor <= 0.5:  # where the logarithms cancel
        return sum(((-1) ** (k + 1) + restitution**k) * factor ** (k - 2) / k for k in POWERS)
    back = restitution * factor
    return log1p(factor) - log1p(-back) - factor - back if back < 1 else inf


@lru_cache(maxsize=1024)
def exact(restitution: float) -> float:
    """Factor D with which a free impact has the restitution cr, whatever the force P(d).

    D (1 + cr) = ln((1+D)/(1-cr D)) follows from dv/dd of the free impact (this study).
    """
    if restitution == 1:
        return 0.0
    return _root(lambda factor: _surplus(factor, restitution), 0.0, 1 / restitution)


DAMPINGS: dict[Damping, Callable[[float], float]] = {
    "lankarani-nikravesh": lambda cr: 3 * (1 - cr**2) / 4,  # Eq. 31: for nearly elastic impacts
    "hunt-crossley": lambda cr: 3 * (1 - cr) / 2,  # exact to first order in 1 - cr (1975)
    "flores": lambda cr: 8 * (1 - cr) / (5 * cr),  # Flores, Machado, Silva & Martins (2011)
    "exact": exact,
}


def damping_factor(damping: Damping, restitution: float) -> float:
    """Damping factor D >= 0 by a rule of `DAMPINGS`, for a restitution from 0 to 1.

    For ``flores`` and ``exact``, whose D grows as 1/cr, the restitution is at least 0.001.
    """
    checks.choice("damping", damping, DAMPINGS)
    cr = checks.number("restitution", restitution, least=0, most=1, scalar=True)
    if damping in ("flores", "exact"):
        checks.number(f"restitution for damping {damping}", cr, least=1e-3)
    return DAMPINGS[damping](cr)


def delivered_restitution(factor: float) -> float:
    """Restitution cr that a damping factor D gives in a free impact.

    The root of D (1 + cr) = ln((1 + D)/(1 - cr D)) below 1/D, where the force would vanish.
    """
    factor = checks.number("factor", factor, least=0, scalar=True)
    return _root(lambda restitution: _surplus(factor, restitution), 0.0, 1.0)
