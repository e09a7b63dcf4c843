"""Model limits of the elastic solution that a contact exceeds, as sentences.

The solution is valid for smooth, elastic bodies without friction, at small strains, with the
supports of the joint. It gives numbers beyond these limits too, and the sentences warn the user.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import radians
from typing import TYPE_CHECKING

from study.joint.stress import first_yield

if TYPE_CHECKING:
    from study.joint.joint import Joint
    from study.joint.solution import Solution

DEEPEST = 1.0
"""Maximum depth_star at which the solution was compared with other programs."""
NEAR_RIM = 5.0
"""In deg: a contact that ends this close to the rim depends on the shape of the edge."""
STRAIN = 0.05
"""Peak pressure over Young's modulus at which strains are no longer small."""
ROUGHNESS = 0.1e-6
"""In m, RMS: a ground or lapped bearing surface (assumed; a turned one has ten times as much)."""
SMOOTH = 20.0
"""Depth over roughness from which on a contact is smooth: Johnson, Contact Mechanics, sec. 13.5,
has roughness times radius over contact radius squared below 0.05, which is roughness over depth."""
SOFT = 1e6
"""In Pa: a Young's modulus below it is that of rubber, or was meant in MPa."""
LARGE = 1.0
"""In m: a socket with a larger radius is rare, or was meant in mm."""
Limits = dict[str, str]
INSIDE = "inside"


def limits(
    joint: Joint,
    depth_star: float,
    half_angle_deg: float,
    *,
    to_rim: float | None = None,
    yield_factor: Mapping[str, float] | None = None,
    depth: float | None = None,
    strain: float | None = None,
) -> Limits:
    """Model limits that one contact exceeds: a key for each, and a sentence.

    The contact ends ``to_rim`` deg from the nearest rim, by default that of a contact about the
    axis; 0 if a rim, or the edge of a ball's face, cuts it. The ``yield_factor`` is the yield
    stress divided by the maximum von Mises stress, for each body that has both; ``depth`` is the
    penetration depth in m, and ``strain`` the peak pressure divided by the minimum Young's modulus.
    """
    found = {}
    for body, factor in (yield_factor or {}).items():
        if factor < 1:
            found["yield"] = (
                f"The {body} yields, because its yield stress is {factor:.2g} times the von Mises "
                "stress. The solution is elastic and therefore too stiff."
            )
    if depth_star > DEEPEST * (1 + 1e-9):
        found["depth"] = (
            f"The penetration depth is {depth_star:.3g} clearances. Beyond {DEEPEST:g} the "
            "solution has not been compared with other programs, and no closed-form law is valid."
        )
    if strain is not None and strain > STRAIN:
        found["strain"] = (
            f"The peak pressure is {strain:.2g} times Young's modulus of the softest body. Beyond "
            f"{STRAIN:g} strains are not small, which the solution assumes."
        )
    if to_rim is None:
        to_rim = joint.opening.last - half_angle_deg
    if to_rim <= 0:
        found["rim"] = (
            "A rim of the socket or the edge of the ball's face cuts the contact. The pressure at "
            "a sharp edge is unbounded, and in reality depends on the shape of the edge."
        )
    elif to_rim < NEAR_RIM:
        found["rim"] = (
            f"The contact ends {to_rim:.2g} deg from a rim of the socket or the edge of the ball's "
            "face, and depends on the shape of the edge there."
        )
    wall = joint.socket_ratio - 1
    if joint.is_held_all_round and wall < radians(half_angle_deg):
        found["wall"] = (
            f"The wall ({wall:.2g} times the socket radius) is thinner than the half-width of the "
            "contact. The force therefore depends on the support of the outside, which is assumed "
            "to be rigid."
        )
    if depth is not None and depth < SMOOTH * ROUGHNESS:
        found["roughness"] = (
            f"The penetration depth of {depth:.2g} m is less than {SMOOTH:g} times a typical "
            f"roughness of {ROUGHNESS:g} m. Rough surfaces are softer than the solution."
        )
    return found


def modulus_limit(moduli: Mapping[str, float]) -> Limits:
    """A warning of Young's moduli in Pa, by the body, that may be meant in another unit."""
    soft = {body: modulus for body, modulus in moduli.items() if modulus < SOFT}
    values = " and ".join(f"of the {body} is {modulus:g} Pa" for body, modulus in soft.items())
    text = f"Young's modulus {values}, which is very small; check that it is in Pa."
    return {"modulus": text} if soft else {}


def unit_warnings(joint: Joint) -> tuple[str, ...]:
    """Sentences on dimensions and Young's moduli that may be meant in another unit."""
    found = []
    if joint.socket_radius >= LARGE:
        found.append(
            f"The radius of the socket is {joint.socket_radius:g} m; check that all dimensions are "
            "in m, not in mm."
        )
    moduli = {body: of.youngs_modulus for body, of in joint.materials.items()}
    return (*found, *modulus_limit(moduli).values())


def law_limit(name: str, fitted_to: float | None, depth_star: float) -> Limits:
    """The limit of a law, from the maximum depth_star to which it was fitted."""
    if fitted_to is None or depth_star <= fitted_to:
        return {}
    text = (
        f"The penetration depth of {depth_star:.2g} clearances is greater than {fitted_to:g}, the "
        f"maximum to which the law {name} was fitted."
    )
    return {"law": text}


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


def of_solution(solution: Solution) -> tuple[Limits, ...]:
    """Model limits that each contact of a solution exceeds.

    Yield is checked if the solution has stresses; roughness, strain and the unit of Young's moduli
    if the joint has dimensions.
    """
    joint, found = solution.joint, []
    moduli = {body: of.youngs_modulus for body, of in joint.materials.items()}
    factors = {body: of for body, of in solution.yield_factor.items() if of is not None}
    strains = solution.peak_pressure / min(moduli.values())
    for k, depth_star in enumerate(solution.depth_star):
        of_sizes: dict = {}
        if joint.has_dimensions:
            of_sizes = {"depth": solution.depth[k], "strain": strains[k]}
        found.append(
            limits(
                joint,
                depth_star,
                solution.contact_half_angle_deg[k],
                to_rim=solution.to_rim_deg[k],
                yield_factor={body: of[k] for body, of in factors.items()},
                **of_sizes,
            )
            | (modulus_limit(moduli) if joint.has_dimensions else {})
        )
    return tuple(found)


def in_short(found: Limits) -> str:
    """Keys of the exceeded limits as one text, for a column of a table."""
    return "; ".join(found) or INSIDE
