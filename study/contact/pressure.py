"""Pressure and extent of the contact behind the laws' forces, and a thin liner's springs.

Lengths are in socket radii R2 and pressures in E* dR/R2, so that force_star is R2* times the
pressure's integral. ``depth_star`` is d/dR, and ``r2_star`` > 1 is R2/dR. A value outside its range
is a ``ValueError``. The exact pressure comes from `study.joint.force_curve`.
"""

from math import pi
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact.laws import LAWS, Floats

AngledLaw = Literal["hertz", "steuermann", "hyperbolic_winkler"]
ANGLED_LAWS: tuple[AngledLaw, ...] = get_args(AngledLaw)


def contact_radius(depth_star: ArrayLike, r2_star: float) -> Floats:
    """Hertz's contact radius a/R2 = sqrt(ds R1/R2), from a^2 = R d with R = R1 R2/dR."""
    depth = checks.number("depth_star", depth_star, least=0)
    return np.sqrt(depth * (1 - 1 / checks.number("r2_star", r2_star, above=1)))


def hertz_pressure(radius: ArrayLike, depth_star: float, r2_star: float) -> NDArray[np.float64]:
    """Hertz's pressure p0 sqrt(1 - (r/a)^2) with p0 = 2 E* a/(pi R) (Eq. 4); zero outside a.

    The ``radius`` is the distance r/R2 from the contact's axis; depth_star > 0.
    """
    checks.number("depth_star", depth_star, above=0)
    r = checks.number("radius", radius)
    edge = contact_radius(depth_star, r2_star)
    peak = 2 / pi * edge / (1 - 1 / r2_star)
    return peak * np.sqrt(np.clip(1 - (r / edge) ** 2, 0, None))


def contact_half_angle_deg(law: AngledLaw, depth_star: ArrayLike, r2_star: float) -> Floats:
    """Polar angle of the contact's edge by a law, in deg; at most 90.

    ``hertz``: sin = a/R2 with Hertz's radius; this angle alone depends on R2*. ``steuermann``:
    cos = dR/(dR + d), where rigid spheres of nearly equal radii would meet. ``hyperbolic_winkler``:
    sqrt(2 ds) rad, where the arc is Winkler's radius sqrt(2 R d) (Eq. 21).
    """
    checks.choice("law", law, ANGLED_LAWS)
    edge = contact_radius(depth_star, r2_star)
    if law == "hertz":
        return np.degrees(np.arcsin(checks.number("contact radius over R2", edge, most=1)))
    if law == "steuermann":
        depth = np.asarray(depth_star)
        return np.degrees(np.arctan(np.sqrt(depth * (2 + depth))))
    return np.degrees(np.sqrt(2 * checks.number("depth_star", depth_star, most=pi**2 / 8)))


def foundation_height(law: Literal["winkler", "hyperbolic_winkler"], r2_star: float) -> float:
    """Height h/R2 of the foundation that a law's fitted coefficient implies if K = E*.

    Flat: f1w = pi R/h with R = R1 R2/dR; along the socket's arc (Eq. 20): f1 = pi R2^2/(h dR).
    """
    checks.choice("law", law, ("winkler", "hyperbolic_winkler"))
    scale, _, _ = LAWS[law].parts(checks.number("r2_star", r2_star, above=1, scalar=True))
    return pi * (r2_star - 1 if law == "winkler" else r2_star) / scale


def thin_liner_force(
    depth_star: ArrayLike, r2_star: float, thickness: float, poisson: float
) -> Floats:
    """Force P/(E* dR^2) of a rigid ball on a thin liner with a rigid backing: Winkler's springs.

    P = 2 pi R2^2 K [(dR + d)(1 - c^3)/3 - dR (1 - c^2)/2] with c = dR/(dR + d) and
    E* = E/(1 - nu^2). K = (1 - nu) E/((1 + nu)(1 - 2 nu) h) is the stiffness of a layer that cannot
    spread. The force is exact as the ``thickness`` h/R2 and 1/R2* go to zero, for a compressible
    liner: ``poisson`` nu < 0.5 (Johnson, sec. 5.8, for the springs; this study).
    """
    depth = checks.number("depth_star", depth_star, least=0)
    r2_star = checks.number("r2_star", r2_star, above=1, scalar=True)
    h = checks.number("thickness", thickness, above=0, scalar=True)
    nu = checks.poisson("poisson", poisson)
    stiffness = (1 - nu) * (1 - nu**2) / ((1 + nu) * (1 - 2 * nu) * h)  # K R2/E*
    return pi * stiffness * r2_star * depth**2 * (1 + 2 * depth / 3) / (1 + depth) ** 2
