"""Whether the law along the axis is accurate for displacements off it, up to some tilt.

By a rule, if ball and socket are the same all round and the rim is far: a ball on its core, a
socket backed all over, and a contact that stays off the rim by twice the wall's thickness. In 8
joints along the axis such a rim changed the force by at most 0.0015 of it. Else the joint is
solved.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from study import checks
from study.joint import Joint, force_curve, tilted_contact
from study.joint.supports import Core
from study.joint.tilted import LARGEST_TILT

OF_RULE = 0.002
"""Largest change of the force by a rim that the rule takes for far."""
_WALLS, _LARGEST_POISSON = 2, 0.4  # of the rule: thickness to the rim, and of every material
_TILTS = 4


@dataclass(frozen=True)
class OffAxis:
    """Whether the law along the axis is within a tolerance in all directions.

    Attributes
    ----------
    one_law_for_all_directions
        Whether ``direction_error`` is within the tolerance.
    direction_error
        Largest difference of the force, as a vector, from that along the axis, over the latter; a
        measured one includes the solution's error estimate.
    known_by
        ``rule``, or ``measured`` at the largest depth and four tilts.
    """

    one_law_for_all_directions: bool
    direction_error: float
    known_by: Literal["rule", "measured"]


def axial_law_suffices(joint: Joint, depth_star: float, tilt: float, tolerance: float) -> OffAxis:
    """Whether the law along the axis is within a tolerance in all directions up to a tilt, in deg.

    Raises
    ------
    ValueError
        For a value outside its range, and the errors of `study.joint.tilted_contact`.
    """
    depth = checks.number("depth_star", depth_star, above=0, scalar=True)
    most = checks.number("tilt", tilt, "deg", above=0, most=LARGEST_TILT, scalar=True)
    checks.number("tolerance", tolerance, above=0, most=1, scalar=True)
    if isinstance(joint.ball_support, Core) and joint.is_held_all_round:
        edge = force_curve(joint, depth).contact_half_angle_deg[0] + most
        edge += _WALLS * np.degrees(joint.socket_ratio - 1)
        stiff = all(m.poisson <= _LARGEST_POISSON for m in joint.materials.values())
        if stiff and edge <= joint.opening and tolerance >= OF_RULE:
            return OffAxis(True, OF_RULE, "rule")
    tilts = np.linspace(0, most, _TILTS + 1)[1:]
    found = tilted_contact(joint, np.full(_TILTS, depth), tilts)
    axial = force_curve(joint, depth).force_star
    off = np.hypot(found.force_star / axial - 1, found.transverse_star / axial)
    error = float((off + found.error_estimate).max())
    return OffAxis(error <= tolerance, error, "measured")
