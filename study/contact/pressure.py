"""Pressure and extent of the contact behind the laws' forces, in the laws' dimensionless form.

Lengths are in socket radii R2 and pressures in E* dR/R2, so that force_star is R2* times the
pressure's integral. The exact pressure comes from `study.joint.force_curve`.
"""

from math import pi

import numpy as np

from study import checks
from study.contact import laws

ANGLED_LAWS = ("hertz", "steuermann", "hyperbolic_winkler")
FOUNDATIONS = ("winkler", "hyperbolic_winkler")


def contact_radius(depth_star, r2_star):
    """Hertz's contact radius a/R2 = sqrt(ds R1/R2), from a^2 = R d with R = R1 R2/dR.

    Parameters
    ----------
    depth_star : float or ndarray
        Dimensionless penetration depth, >= 0.
    r2_star : float
        Dimensionless socket radius, > 1.

    Returns
    -------
    float or ndarray

    Raises
    ------
    ValueError
        For a value outside its range.
    """
    depth = checks.number("depth_star", depth_star, least=0)
    return np.sqrt(depth * (1 - 1 / checks.number("r2_star", r2_star, above=1)))


def hertz_pressure(radius, depth_star, r2_star):
    """Hertz's pressure p0 sqrt(1 - (r/a)^2) with p0 = 2 E* a/(pi R) (Eq. 4); zero outside a.

    Parameters
    ----------
    radius : ndarray
        Distances r/R2 from the contact's axis.
    depth_star, r2_star : float
        As for `contact_radius`; depth_star > 0.

    Returns
    -------
    ndarray
        Pressure, in E* dR/R2, in the shape of ``radius``.
    """
    checks.number("depth_star", depth_star, above=0)
    radius = checks.number("radius", radius)
    edge = contact_radius(depth_star, r2_star)
    peak = 2 / pi * edge / (1 - 1 / r2_star)
    return peak * np.sqrt(np.clip(1 - (radius / edge) ** 2, 0, None))


def hyperbolic_pressure(polar_angle, depth_star, r2_star):
    """Pressure (K d/h)(1 - theta^2/alpha^2) of the hyperbolic Winkler law; zero beyond alpha.

    K/h is what the law's fitted coefficient f1 implies (Eqs. 16 and 20, derived).

    Parameters
    ----------
    polar_angle : ndarray
        Angles theta from the contact's centre, in rad.
    depth_star, r2_star : float
        As for `study.contact.hyperbolic_winkler`; depth_star > 0.

    Returns
    -------
    ndarray
        Pressure, in E* dR/R2, in the shape of ``polar_angle``.
    """
    alpha = contact_half_angle("hyperbolic_winkler", depth_star, r2_star)
    checks.number("depth_star", depth_star, above=0)
    peak = depth_star / foundation_height("hyperbolic_winkler", r2_star)
    angle = checks.number("polar_angle", polar_angle)
    return peak * np.clip(1 - (angle / alpha) ** 2, 0, None)


def contact_half_angle(law, depth_star, r2_star):
    """Polar angle of the contact's edge by a law.

    Parameters
    ----------
    law : {"hertz", "steuermann", "hyperbolic_winkler"}
        sin = a/R2 with Hertz's radius; cos = dR/(dR + d), where rigid spheres of nearly equal
        radii would meet; sqrt(2 ds), where the arc is Winkler's radius sqrt(2 R d) (Eq. 21).
    depth_star : float or ndarray
        Dimensionless penetration depth, >= 0; at most as deep as gives 90 deg.
    r2_star : float
        Dimensionless socket radius, > 1; it matters to Hertz alone.

    Returns
    -------
    float or ndarray
        Half-angle, in rad.

    Raises
    ------
    ValueError
        For an unknown law or a value outside its range.
    """
    checks.choice("law", law, ANGLED_LAWS)
    edge = contact_radius(depth_star, r2_star)
    if law == "hertz":
        return np.arcsin(checks.number("contact radius over R2", edge, most=1))
    if law == "steuermann":
        return np.arctan(np.sqrt(np.asarray(depth_star) * (2 + np.asarray(depth_star))))
    return np.sqrt(2 * checks.number("depth_star", depth_star, most=pi**2 / 8))


def foundation_height(law, r2_star):
    """Height h/R2 of the foundation that a law's fitted coefficient implies with K = E*.

    Flat: P = pi K R d^2/h, so f1w = pi R/h with R = R1 R2/dR; along the socket's arc (Eq. 20):
    f1 = pi R2^2/(h dR).

    Parameters
    ----------
    law : {"winkler", "hyperbolic_winkler"}
    r2_star : float
        Dimensionless socket radius, > 1.

    Returns
    -------
    float
    """
    checks.choice("law", law, FOUNDATIONS)
    scale, _, _ = laws.LAWS[law].parts(checks.number("r2_star", r2_star, above=1, scalar=True))
    return pi * (r2_star - 1 if law == "winkler" else r2_star) / scale


def vertical_share(depth_star):
    """Share of the hyperbolic Winkler law's pressure that acts along the contact's axis.

    The integral of p cos(theta) over that of p, both with the law's area element, that of a
    flat disc; the flat foundation takes it for 1.

    Parameters
    ----------
    depth_star : float
        As for `hyperbolic_pressure`.

    Returns
    -------
    float
    """
    checks.number("depth_star", depth_star, above=0, scalar=True)
    place, weight = np.polynomial.legendre.leggauss(32)
    share = (place + 1) / 2
    angle = share * contact_half_angle("hyperbolic_winkler", depth_star, 2.0)
    weight = weight * (1 - share**2) * angle
    return float(weight @ np.cos(angle) / weight.sum())
