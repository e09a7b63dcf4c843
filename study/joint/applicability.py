"""Which limits of the elastic solution a contact exceeds, in words.

The solution is for smooth, elastic bodies without friction, at small strains, held as the joint
says. It answers beyond these limits too; whoever uses the number has to know.
"""

from collections.abc import Mapping, Sequence
from math import radians
from typing import Any

from study.joint.curve import ForceCurve
from study.joint.definition import Joint
from study.joint.tilted import TiltedContact

DEEPEST = 1.0
"""Largest depth_star up to which the solution was compared with other programs."""
NEAR_RIM = 5.0
"""In deg: a contact that ends so near to the rim depends on the edge's own shape."""
STRAIN = 0.05
"""Peak pressure over Young's modulus at which strains are no longer small."""
ROUGHNESS = 0.1e-6
"""In m, RMS: a ground or lapped bearing surface (assumed; a turned one has ten times as much)."""
SMOOTH = 20.0
"""Depth over roughness from which on a contact is smooth: Johnson, Contact Mechanics, sec. 13.5,
has roughness times radius over contact radius squared below 0.05, which is roughness over depth."""
FRICTION = 0.01
"""Share of the force that friction may bear before it is told."""
WORN = 0.1
"""Depth of wear in clearances that leaves the pressure about as it was (assumed)."""
SOFT = 1e6
"""In Pa: a Young's modulus below it is that of rubber, or was meant in MPa."""
Limits = dict[str, str]
INSIDE = "inside"


def limits(
    joint: Joint,
    depth_star: float,
    half_angle_deg: float,
    *,
    middle_deg: float = 0.0,
    yield_factor: Mapping[str, float] | None = None,
    depth: float | None = None,
    strain: float | None = None,
) -> Limits:
    """Limits that one contact exceeds: a key for each, and a sentence.

    The contact extends by ``half_angle_deg`` to both sides of the polar angle ``middle_deg`` of its
    middle, in the plane of symmetry. The ``yield_factor`` is yield stress over largest von Mises
    stress, for each body that has both, ``depth`` is in m, and ``strain`` is peak pressure over the
    least Young's modulus.
    """
    found = {}
    for body, factor in (yield_factor or {}).items():
        if factor < 1:
            found["yield"] = (
                f"The {body} yields: its strength is {factor:.2g} of the stress. The solution is "
                "elastic, and too stiff from there on."
            )
    if depth_star > DEEPEST * (1 + 1e-9):
        found["depth"] = (
            f"The depth is {depth_star:.3g} clearances. Beyond {DEEPEST:g} the solution has not "
            "been compared with other programs, and no closed law reaches."
        )
    if strain is not None and strain > STRAIN:
        found["strain"] = (
            f"The peak pressure is {strain:.2g} of the softest body's modulus. Beyond {STRAIN:g} "
            "strains are not small, as the solution takes them."
        )
    for end, rim in _near_rim(joint, middle_deg - half_angle_deg, middle_deg + half_angle_deg):
        found["rim"] = (
            f"The contact ends at {end:.3g} deg, near the rim at {rim:.3g} deg, where it depends "
            "on the shape of the edge."
        )
    wall = joint.socket_ratio - 1
    if joint.is_held_all_round and wall < radians(half_angle_deg):
        found["wall"] = (
            f"The wall, of {wall:.2g} radii, is thinner than the contact's half-width: the force "
            "depends on what holds its outside, which is rigid here."
        )
    if depth is not None and depth < SMOOTH * ROUGHNESS:
        found["roughness"] = (
            f"The depth of {depth:.2g} m is below {SMOOTH:g} times a usual roughness of "
            f"{ROUGHNESS:g} m: rough surfaces are softer than this."
        )
    return found


def _near_rim(joint, low, high):
    """Ends of a contact that are near a rim, or near an edge of a bored ball, and that angle."""
    first, last = joint.ball_support.surface
    first, last = max(first, joint.opening.first), min(last, joint.opening.last)
    if not joint.has_pole and low < first + NEAR_RIM:
        yield low, first
    if high > last - NEAR_RIM:
        yield high, last


def friction_limit(share: float) -> Limits:
    """The limit of friction, by the share of the force that friction may bear."""
    if share <= FRICTION:
        return {}
    return {"friction": f"Friction, which is left out, may bear {100 * share:.2g} % of the force."}


def modulus_limit(moduli: Mapping[str, float]) -> Limits:
    """A question about Young's moduli in Pa, by the body, that may be in another unit."""
    soft = {body: modulus for body, modulus in moduli.items() if modulus < SOFT}
    told = ", ".join(f"of the {body} is {modulus:g} Pa" for body, modulus in soft.items())
    return {"modulus": f"Young's modulus {told}: is it meant in Pa?"} if soft else {}


def wear_limit(depth: float) -> Limits:
    """The limit of wear, by its depth in clearances."""
    if depth <= WORN:
        return {}
    text = f"The wear is {depth:.2g} clearances deep: it has changed the pressure, and the gap."
    return {"wear": text}


def of_curve(curve: ForceCurve) -> list[Limits]:
    """Limits that each contact of a curve without dimensions exceeds."""
    contacts = zip(curve.depth_star, curve.contact_half_angle_deg, strict=True)
    return [limits(curve.joint, depth, angle) for depth, angle in contacts]


def of_tilted(
    contact: TiltedContact, of_each: Sequence[Mapping[str, Any]] | None = None
) -> list[Limits]:
    """Limits that each contact off the axis exceeds; ``of_each`` are keywords of `limits`."""
    (low, high), joint = contact.contact_edges_deg, contact.joint
    places = zip(contact.depth_star, (high - low) / 2, (low + high) / 2, strict=True)
    several = zip(places, of_each or [{}] * len(low), strict=True)
    return [
        limits(joint, depth, half, middle_deg=middle, **more)
        for (depth, half, middle), more in several
    ]


def in_short(found: Limits) -> str:
    """Keys of the limits, for a column of a table."""
    return "; ".join(found) or INSIDE


def worst(several: Sequence[Limits]) -> list[str]:
    """A sentence for each limit that any of some contacts exceeds, in order of depth.

    The deepest one speaks, but of roughness the shallowest.
    """
    merged: Limits = {}
    for found in several:
        merged |= {k: text for k, text in found.items() if k != "roughness" or k not in merged}
    return list(merged.values())
