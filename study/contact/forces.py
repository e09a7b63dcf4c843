"""Contact force at one point, compiled for the stepping loops of the mechanism.

A law with its dimensions is one record of numbers (`DimensionalLaw.packed`), because compiled code
that is kept on disk cannot hold Python functions. A record is passed as a pointer: references to an
array would be counted at every call, which takes as long as a law. This module does not import the
laws: another law of a known shape compiles nothing again.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numba.extending import register_jitable

from study.compiled import compiled
from study.contact import shapes
from study.contact.friction import friction_factor
from study.contact.shapes import SHAPES

_HERTZ, _WINKLER, _SAMPLED = map(SHAPES.index, (shapes.hertz, shapes.winkler, shapes.sampled))
_ELASTIC_FORCE = '''
def elastic_force(law, depth):
    """Force of a packed law in N, and its derivative in N/m, at a depth > 0 in m."""
    depth_star, shape, constants = depth / law.clearance, law.shape_index, law.constants{branches}
    return law.scale * value, law.scale / law.clearance * slope
'''
_BRANCH = """
    {when}:
        value, slope = {name}(depth_star, {constants})"""


def _elastic_force():
    """Function that evaluates the shape of a law, from its source.

    The source has a branch for each of `SHAPES`, because compiled code cannot choose from a list of
    functions. A call takes as long as a law, so that the shapes' functions become a part of it. Its
    lines are numbered from the end of this file on: numba would take others for its source.
    """
    names, branches = {**globals()}, ""
    for place, shape in enumerate(SHAPES):
        names[shape.name] = register_jitable(inline="always")(shape.function)
        constants = "constants[: law.count]" if shape.constants is None else "constants"
        when = "else" if shape is SHAPES[-1] else f"{'elif' if place else 'if'} shape == {place}"
        branches += _BRANCH.format(when=when, name=shape.name, constants=constants)
    lines = Path(__file__).read_text(encoding="utf-8").count("\n")
    source = "\n" * lines + _ELASTIC_FORCE.format(branches=branches)
    exec(compile(source, __file__, "exec"), names)
    return names["elastic_force"]


register_jitable(inline="always")(shapes.cubic)
elastic_force = compiled(_elastic_force())


def _gauss(count):
    """Nodes and weights of Gauss's rule from 0 to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (1 + nodes) / 2, weights / 2


(NODES, WEIGHTS), (_FEW_NODES, _FEW_WEIGHTS) = _gauss(12), _gauss(4)


@compiled
def stored_energy(law, depth):
    """Elastic energy at a depth, in J: the force integrated over the depth.

    Gauss's rule is applied in the square root of the depth. All shapes are analytic in it but
    Steuermann's profiles of n > 1, whose error is 1e-11. A sampled function may have kinks: each
    interval between its knots is integrated exactly.
    """
    energy = 0.0
    if depth > 0 and law.shape_index == _SAMPLED:
        low, root = 0.0, np.sqrt(depth / law.clearance)
        for knot in law.constants[1 : law.count // 3]:
            step = min(knot, root) - low
            for node, weight in zip(_FEW_NODES, _FEW_WEIGHTS):  # noqa: B905
                s = low + node * step
                inner = s * s * law.clearance
                energy += weight * step * 2 * s * law.clearance * elastic_force(law, inner)[0]
            low = knot
            if low >= root:
                break
    elif depth > 0:
        few_are_exact = law.shape_index == _HERTZ or law.shape_index == _WINKLER
        rule = (_FEW_NODES, _FEW_WEIGHTS) if few_are_exact else (NODES, WEIGHTS)
        for node, weight in zip(*rule):  # noqa: B905 (compiled code has no strict)
            energy += weight * 2 * node * depth * elastic_force(law, node * node * depth)[0]
    return energy


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
