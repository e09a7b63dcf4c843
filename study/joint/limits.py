"""Model limits of the elastic solution that a contact exceeds, as sentences.

The solution is valid for smooth, elastic bodies without friction, at small strains, with the
supports of the joint. It gives numbers beyond these limits too, and the sentences warn the user.
"""

from collections.abc import Mapping
from math import radians

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
    depth_star: float,
    *,
    to_rim: float | None = None,
    wall: float | None = None,
    half_angle_deg: float = 0.0,
    yield_factor: Mapping[str, float] | None = None,
    depth: float | None = None,
    strain: float | None = None,
    peak_at_rim: bool = False,
) -> Limits:
    """Model limits that one contact exceeds: a key for each, and a sentence.

    What is not given is not checked.

    Parameters
    ----------
    depth_star
        Penetration depth divided by the clearance.
    to_rim
        Angle from the end of the contact to the nearest rim or face in deg; 0 if it is cut.
    wall, half_angle_deg
        Wall thickness divided by the socket radius of a socket that is held at its whole outside,
        and half-angle of the contact in deg.
    yield_factor
        Yield stress divided by the maximum von Mises stress, for each body that has both.
    depth, strain
        Penetration depth in m, and peak pressure divided by the minimum Young's modulus.
    peak_at_rim
        Whether the maximum pressure is at a rim that cuts the contact.
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
    if to_rim is not None and to_rim <= 0:
        found["rim"] = (
            "A rim of the socket or the edge of the ball's face cuts the contact. The pressure at "
            "a sharp edge is unbounded, and in reality depends on the shape of the edge."
        )
        if peak_at_rim:
            found["rim"] += (
                " Here it is largest at the edge and grows with the resolution. Therefore "
                "peak_pressure is the pressure at the middle of the contact, and the von Mises "
                "stresses leave out what is nearer to an edge than a tenth of the radius."
            )
    elif to_rim is not None and to_rim < NEAR_RIM:
        found["rim"] = (
            f"The contact ends {to_rim:.2g} deg from a rim of the socket or the edge of the ball's "
            "face, and depends on the shape of the edge there."
        )
    if wall is not None and wall < radians(half_angle_deg):
        found["wall"] = (
            f"The wall ({wall:.2g} times the socket radius) is thinner than the half-width of the "
            "contact. The force therefore depends on the support of the outside, which is assumed "
            "to be rigid."
        )
    if depth is not None and depth < SMOOTH * ROUGHNESS:
        found["roughness"] = (
            f"The penetration depth of {depth:.3g} m is less than {SMOOTH:g} times a typical "
            f"roughness of {ROUGHNESS:g} m. Rough surfaces are softer than the solution."
        )
    return found


def modulus_limit(moduli: Mapping[str, float]) -> Limits:
    """A warning of Young's moduli in Pa, by the body, that may be meant in another unit."""
    soft = {body: modulus for body, modulus in moduli.items() if modulus < SOFT}
    values = " and ".join(f"of the {body} is {modulus:g} Pa" for body, modulus in soft.items())
    text = f"Young's modulus {values}, which is very small; check that it is in Pa."
    return {"modulus": text} if soft else {}


def unit_warnings(socket_radius: float, moduli: Mapping[str, float]) -> tuple[str, ...]:
    """Sentences on a socket radius in m and Young's moduli that may be meant in another unit."""
    found = modulus_limit(moduli)
    if socket_radius >= LARGE:
        text = f"The radius of the socket is {socket_radius:g} m"
        found = {"size": f"{text}; check that all dimensions are in m, not in mm."} | found
    return tuple(found.values())


def law_limit(name: str, fitted_to: float | None, depth_star: float) -> Limits:
    """The limit of a law, from the maximum depth_star to which it was fitted."""
    if fitted_to is None or depth_star <= fitted_to:
        return {}
    text = (
        f"The penetration depth of {depth_star:.2g} clearances is greater than {fitted_to:g}, the "
        f"maximum to which the law {name} was fitted."
    )
    return {"law": text}


def in_short(found: Limits) -> str:
    """Keys of the exceeded limits as one text, for a column of a table."""
    return "; ".join(found) or INSIDE
