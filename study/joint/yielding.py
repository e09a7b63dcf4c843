"""First yield of a joint by the von Mises criterion.

Stresses are those of linear elasticity; beyond first yield, stresses and errors of laws are for
elastic bodies.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.contact import hertz_factor, largest_depth
from study.joint.joint import Joint
from study.joint.limits import Limits

Floats = NDArray[np.float64]
_LEAST_ROOT = 0.06  # of a depth at which elements resolve the stresses
_DEEP = 0.05  # a joint is solved to this depth even where less is asked for


@dataclass(frozen=True)
class FirstYield:
    """Body that yields first, where (as in `LargestStress`), and normalised depth and force."""

    body: str
    place: str
    depth_star: float
    force_star: float


class StressOverDepth(NamedTuple):
    """Largest von Mises stress in one body over the depth, as in `LargestStress`; shape (k,)."""

    depth_star: Floats
    force_star: Floats
    von_mises: Floats
    place: NDArray[np.str_]


def first_yield(joint: Joint, depth_star: float = 1.0) -> FirstYield | None:
    """First yield of a joint by the von Mises criterion; None if no body yields.

    A body with yield stress Y yields when its maximum von Mises stress, in units of E* dR/R2, is
    R2* Y/E*. This stress, divided by the square root of the depth, is interpolated between solved
    depths and down to Hertz's limit at depth 0. Its error is below 0.5 % for socket ratios from
    1.05 on, and below 5 % in thinner sockets at depths below 0.001.

    Parameters
    ----------
    joint
        A joint in which at least one material has a yield stress.
    depth_star
        Maximum normalised penetration depth that is considered.

    Raises
    ------
    ValueError
        If no material has a yield stress, if the ball support is not ``guided`` or ``clamped``, if
        the socket is not held at its whole outside, or if the contact cannot be so deep.

    Examples
    --------
    >>> from study.joint import Joint, Material
    >>> ball, socket = Material(yield_stress=5e8), Material()
    >>> first = first_yield(Joint.from_ratios(50, ball=ball, socket=socket), 0.3)
    >>> first.body, first.place, round(first.depth_star, 3)
    ('ball', 'below the surface', 0.13)
    """
    if not (joint.ball_support.is_half and joint.is_held_all_round):
        raise checks.RangeError(
            "first yield requires ball_support guided or clamped and socket_support outside, got "
            f"{joint.ball_support} and {joint.socket_support}"
        )
    deepest = checks.number("depth_star", depth_star, above=0, scalar=True)
    if not any(material.yield_stress for material in joint.materials.values()):
        raise ValueError("a material of joint must have a yield_stress, got none")
    return first_crossing(joint, over_depth(joint, deepest), deepest)


def first_crossing(
    joint: Joint, stresses: Mapping[str, StressOverDepth], deepest: float
) -> FirstYield | None:
    """First yield of a joint from the stresses `over_depth` in its bodies; None if no body yields.

    The joint must be one that `first_yield` accepts. Because the stresses do not depend on the
    yield stresses, one table applies to all joints that differ only in these.
    """
    from scipy.interpolate import PchipInterpolator  # a quarter of a second, for this alone
    from scipy.optimize import brentq

    yields = []
    hertz = hertz_factor(joint.r2_star)  # times the cube of the root
    for body, material in joint.materials.items():
        table, touches = stresses[body], body in list(joint.materials)[:2]
        solved = np.sqrt(table.depth_star)
        used = solved >= (0 if joint.series_applies else _LEAST_ROOT)
        root = np.append(0, solved[used])
        stiffening = np.append(1, (table.force_star / (hertz * solved**3))[used])
        limit = touches * hertz_von_mises(material.poisson)
        slope = np.append(
            2 / np.pi / np.sqrt(joint.radius_ratio) * limit, (table.von_mises / solved)[used]
        )
        yield_star = joint.r2_star * (material.yield_stress or np.inf) / joint.composite_modulus
        beyond = np.flatnonzero(root * slope >= yield_star)
        if beyond.size:
            between, ends = PchipInterpolator(root, slope), root[beyond[0] - 1 :][:2]
            x = brentq(lambda x, of, value: x * of(x) - value, *ends, args=(between, yield_star))
            force = hertz * x**3 * PchipInterpolator(root, stiffening)(x)
            place = table.place[np.abs(solved - x).argmin()]
            yields.append(FirstYield(body, str(place), x**2, float(force)))
    first = min(yields, key=lambda of_body: of_body.depth_star, default=None)
    return first if first and first.depth_star <= deepest else None


@lru_cache(maxsize=8)
def over_depth(joint: Joint, deepest: float = 1.0) -> dict[str, StressOverDepth]:
    """Largest von Mises stress in each body, at the depths of `study.joint.Joint.curve`."""
    deepest = max(deepest, min(_DEEP, largest_depth(joint.r2_star) / 2))
    curve = joint.curve(deepest, stresses=True)
    return {
        body: StressOverDepth(curve.depth_star, curve.force_star, of.von_mises, np.array(of.place))
        for body, of in curve.stress.items()
    }


def hertz_von_mises(poisson: float) -> float:
    """Largest von Mises stress under Hertz's pressure on a half-space, over its peak.

    On the axis (Johnson, Contact Mechanics, 1985, Eq. 3.45), or for Poisson's ratios below about
    -0.1 at the contact's edge, where pure shear is (1 - 2 nu)/3.
    """
    depth = np.linspace(0, 2, 20_001)  # over the contact's radius
    around = -(1 + poisson) * (1 - depth * np.arctan2(1, depth)) + 0.5 / (1 + depth**2)
    axis = np.abs(around + 1 / (1 + depth**2)).max()
    return float(max(axis, (1 - 2 * poisson) / np.sqrt(3)))


def yield_limit(joint: Joint, depth_star: float) -> Limits:
    """The limit of yield, from the depth of first yield; none without a yield stress."""
    if not any(of.yield_stress for of in joint.materials.values()):
        return {}
    first = first_yield(joint, min(depth_star, 1.0))
    if first is None:
        return {}
    text = (
        f"The {first.body} yields at depths above {first.depth_star:.2g} clearances, and "
        f"{depth_star:.2g} are reached. The law is elastic and therefore too stiff there."
    )
    return {"yield": text}
