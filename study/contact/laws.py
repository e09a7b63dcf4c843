"""Force-depth laws of a ball in a socket: one function per law, and one wrapper to SI units.

In dimensionless form depth_star = d/dR, r2_star = R2/dR and force_star = P/(E* dR^2), with
the clearance dR = R2 - R1, the penetration depth d and the composite modulus E*. Damping and
friction are not here. Every law is zero for depth <= 0 (no contact).

How sure we are of each formula (given, derived, identified, reconstructed, fitted) stands in
its docstring; "Eq." numbers are those of the paper the study reproduces.
"""

import json
from functools import lru_cache, wraps
from inspect import Parameter, Signature, signature
from math import factorial, gamma, pi, sqrt
from pathlib import Path

import numpy as np

from study import checks
from study.contact import shapes

COEFFICIENTS = Path(__file__).with_name("coefficients.json")


def composite_modulus(ball_modulus, ball_poisson, socket_modulus, socket_poisson):
    """Composite modulus E* of two bodies: 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2.

    Parameters
    ----------
    ball_modulus, socket_modulus : float
        Young's moduli, > 0, in Pa.
    ball_poisson, socket_poisson : float
        Poisson's ratios, in (-1, 0.5).

    Returns
    -------
    float
        Composite modulus, in Pa.

    Raises
    ------
    ValueError
        For a value outside its range.
    """
    moduli = [
        checks.number(f"{body} Young's modulus", value, "Pa", above=0)
        for body, value in (("ball", ball_modulus), ("socket", socket_modulus))
    ]
    ratios = [
        checks.poisson(f"{body} Poisson's ratio", value)
        for body, value in (("ball", ball_poisson), ("socket", socket_poisson))
    ]
    return 1 / sum((1 - nu**2) / e for e, nu in zip(moduli, ratios, strict=True))


def _law(parts):
    """Make a law of its parts: ``parts(r2_star, **options)`` is (scale, shape, constants).

    The law checks its arguments, sees penetrating depths only, and returns the force or its
    derivative; ``law.parts`` stays at hand for the compiled loops.
    """

    @wraps(parts)
    def law(depth_star, r2_star, *, derivative=False, **options):
        depth = np.asarray(checks.number("depth_star", depth_star))
        r2 = np.asarray(checks.number("r2_star", r2_star, above=1))
        depth, r2 = np.broadcast_arrays(depth, r2)
        contact = depth > 0
        scale, shape, constants = parts(r2[contact], **options)
        checks.number(f"depth_star of {parts.__name__}", depth, most=shapes.LIMITS.get(shape))
        result = np.zeros(depth.shape)
        with np.errstate(over="ignore"):
            result[contact] = scale * shape(depth[contact], constants)[int(derivative)]
        if not np.isfinite(result).all():
            raise ValueError(f"depth_star must not overflow the force, got {depth.max():g}")
        return float(result) if result.ndim == 0 else result

    given = list(signature(parts).parameters.values())
    first = Parameter("depth_star", Parameter.POSITIONAL_OR_KEYWORD)
    which = Parameter("derivative", Parameter.KEYWORD_ONLY, default=False)
    law.__signature__ = Signature([first, given[0], which, *given[1:]])
    law.parts = parts
    return law


@_law
def hertz(r2_star):
    """Hertz: P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) (Eqs. 4-6, given).

    Parameters
    ----------
    depth_star : float or ndarray
        Dimensionless penetration depth; zero force where it is negative.
    r2_star : float or ndarray
        Dimensionless socket radius, > 1.
    derivative : bool
        Return dP*/d(depth_star) instead of P*.

    Returns
    -------
    float or ndarray
        Dimensionless force, or its derivative, in the broadcast shape.

    Raises
    ------
    ValueError
        For NaN, or ``r2_star`` <= 1.
    """
    return 4 / 3 * np.sqrt(r2_star * (r2_star - 1)), shapes.hertz, ()


@_law
def steuermann(r2_star, *, n=1, radius="geometric"):
    """Steuermann: P = (4n/(2n+1)) E* a d for a profile of order 2n (Eq. 7; Johnson, sec. 5.3).

    ``radius="geometric"`` takes the contact radius a = R2 sin(eps) with
    cos(eps) = dR/(dR + d); with n = 1 this is what Table 2 plots (identified: RMSE within
    0.5 %). ``radius="profile"`` is the textbook's: a from d = c_n A_n a^(2n), where
    A_n is the Taylor coefficient of the gap between the spheres and
    c_n = 2*4*..*2n / (1*3*..*(2n-1)); with n = 1 it is Hertz.

    Parameters
    ----------
    depth_star, r2_star, derivative
        As for `hertz`.
    n : int
        Half the order of the profile, from 1 to 50.
    radius : {"geometric", "profile"}
        Where the contact radius comes from.

    Returns
    -------
    float or ndarray
        Dimensionless force, or its derivative.

    Raises
    ------
    ValueError
        As for `hertz`; for n not a whole number from 1 to 50, or an unknown ``radius``.
    """
    checks.choice("radius", radius, ("geometric", "profile"))
    n = checks.whole("n", n, least=1, most=50)
    factor = 4 * n / (2 * n + 1)
    if radius == "geometric":
        return factor * r2_star, shapes.chord, ()
    c_n = sqrt(pi) * gamma(n + 1) / gamma(n + 0.5)
    taylor = factorial(2 * n - 2) / (2 ** (2 * n - 1) * factorial(n - 1) * factorial(n))
    odd = 2 * n - 1
    # ln(R1^-odd - R2^-odd), in units of dR: the powers themselves may underflow
    difference = np.log(np.expm1(-odd * np.log1p(-1 / r2_star))) - odd * np.log(r2_star)
    radius_star = np.exp(-(np.log(c_n * taylor) + difference) / (2 * n))  # at ds = 1
    return factor * radius_star, shapes.power, (1 + 1 / (2 * n),)


@_law
def liu(r2_star, *, reading="spherical"):
    """Liu et al. 2006, a reconstruction (Eq. 8 is lost; identified weakly, RMSE within 5 %).

    ``reading="spherical"``: P = pi E* R2 d sqrt(d / (2 (dR + d))), the sphere's analogue of
    Liu's cylindrical law. ``reading="half-angle"``: P = (pi/2) E* R2 eps d with
    cos(eps) = dR/(dR + d).

    Parameters
    ----------
    depth_star, r2_star, derivative
        As for `hertz`.
    reading : {"spherical", "half-angle"}
        Which of the two reconstructions.

    Returns
    -------
    float or ndarray
        Dimensionless force, or its derivative.

    Raises
    ------
    ValueError
        As for `hertz`, or for an unknown reading.
    """
    checks.choice("reading", reading, ("spherical", "half-angle"))
    if reading == "spherical":
        return pi * r2_star, shapes.liu, ()
    return pi / 2 * r2_star, shapes.half_angle, ()


@_law
def winkler(r2_star, *, coefficient=None):
    """Winkler with fitted coefficient: P* = f1w(R2*) ds^2 (Eq. 28, derived; f1w fitted).

    Parameters
    ----------
    depth_star, r2_star, derivative
        As for `hertz`.
    coefficient : float, optional
        Value of f1w, > 0; by default this study's fit, linear in R2*.

    Returns
    -------
    float or ndarray
        Dimensionless force, or its derivative.

    Raises
    ------
    ValueError
        As for `hertz`, or for a coefficient <= 0.
    """
    return _coefficient("winkler", r2_star, coefficient), shapes.winkler, ()


@_law
def hyperbolic_winkler(r2_star, *, coefficient=None):
    """The paper's law: P* = f1(R2*) f2(ds) (Eqs. 20-27, f2 derived; f1 fitted by this study).

    f2 = ds [1/2 - sin(2a)/(2a) + sin(a)^2/(2 a^2)] with the contact half-angle
    a = sqrt(2 ds), evaluated without cancellation (`study.contact.shapes.hyperbolic`).

    Parameters
    ----------
    depth_star, r2_star, derivative
        As for `hertz`; depth_star <= pi^2/8, where the half-angle is 90 deg.
    coefficient : float, optional
        Value of f1, > 0; by default this study's fit, linear in R2*.

    Returns
    -------
    float or ndarray
        Dimensionless force, or its derivative.

    Raises
    ------
    ValueError
        As for `hertz`, for depth_star > pi^2/8, or for a coefficient <= 0.
    """
    return _coefficient("hyperbolic_winkler", r2_star, coefficient), shapes.hyperbolic, ()


LAWS = {
    "hertz": hertz,
    "steuermann": steuermann,
    "liu": liu,
    "winkler": winkler,
    "hyperbolic_winkler": hyperbolic_winkler,
}


def contact_force(law, depth, ball_radius, socket_radius, composite, **options):
    """Contact force of a law in SI units: P = E* dR^2 P*(d/dR, R2/dR).

    Parameters
    ----------
    law : str
        Name of a law, a key of `LAWS`.
    depth : float or ndarray
        Penetration depth, in m; zero force where it is negative.
    ball_radius, socket_radius : float
        Radii, in m, with 0 < ball_radius < socket_radius.
    composite : float
        Composite modulus E*, > 0, in Pa (see `composite_modulus`).
    **options
        Passed to the law.

    Returns
    -------
    float or ndarray
        Force, in N.

    Raises
    ------
    ValueError
        For an unknown law, a value outside its range or NaN.
    """
    return _dimensional(law, depth, ball_radius, socket_radius, composite, False, options)


def contact_stiffness(law, depth, ball_radius, socket_radius, composite, **options):
    """Derivative dP/dd of `contact_force`, in N/m; same arguments, same errors."""
    return _dimensional(law, depth, ball_radius, socket_radius, composite, True, options)


def _dimensional(law, depth, ball_radius, socket_radius, composite, derivative, options):
    checks.choice("law", law, LAWS)
    depth = checks.number("depth", depth, "m")
    r1 = checks.number("ball_radius", ball_radius, "m", above=0, scalar=True)
    r2 = checks.number("socket_radius", socket_radius, "m", above=r1, scalar=True)
    modulus = checks.number("composite modulus", composite, "Pa", above=0, scalar=True)
    clearance = r2 - r1
    value = LAWS[law](depth / clearance, r2 / clearance, derivative=derivative, **options)
    return modulus * clearance ** (1 if derivative else 2) * value


def _coefficient(law, r2_star, coefficient):
    if coefficient is not None:
        return checks.number(f"coefficient of {law}", coefficient, above=0, scalar=True)
    fit = fitted_coefficients().get(law)
    if fit is None:
        raise checks.StudyError(
            f"study/contact/{COEFFICIENTS.name} lacks {law}; make it anew with: study data build"
        )
    return fit["slope"] * r2_star + fit["intercept"]


@lru_cache(maxsize=1)
def fitted_coefficients():
    """Coefficients of the fitted laws, f1 = slope R2* + intercept, for 20 <= R2* <= 300.

    Returns
    -------
    dict
        Law name -> ``slope`` and ``intercept``, dimensionless.

    Raises
    ------
    study.checks.StudyError
        If the file is missing or damaged; names the command that makes it.
    """
    try:
        fits = json.loads(COEFFICIENTS.read_text(encoding="utf-8"))
        return {law: {key: float(fits[law][key]) for key in ("slope", "intercept")} for law in fits}
    except (OSError, ValueError, KeyError, TypeError):
        raise checks.StudyError(
            f"study/contact/{COEFFICIENTS.name} is missing or damaged; make it anew with: "
            "study data build"
        ) from None
