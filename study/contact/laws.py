"""Force-depth laws of a ball in a socket: one function per law, all dimensionless.

In dimensionless form depth_star = d/dR (ds), r2_star = R2/dR and force_star = P/(E* dR^2), with
the clearance dR = R2 - R1, the penetration depth d and the composite modulus E*. Every law takes
``depth_star`` and ``r2_star`` > 1 and returns the force in their broadcast shape, or with
``derivative=True`` dP*/d(ds). The force is zero for depths <= 0. A value outside its range is a
``ValueError``. Damping and friction are not here.

Each docstring says how sure its formula is: given, derived, identified, reconstructed or fitted.
"Eq." numbers are those of the paper that the study reproduces.
"""

import json
from collections.abc import Callable
from functools import lru_cache, partial, wraps
from inspect import Parameter, Signature, signature
from math import factorial, gamma, pi, sqrt
from pathlib import Path
from typing import Any, Literal, Protocol, cast, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import hertz_correction, sampling, shapes
from study.contact.bodies import SOCKET_RATIO

PaperLawName = Literal["hertz", "steuermann", "liu", "winkler", "hyperbolic_winkler"]
LawName = Literal[PaperLawName, "power", "stiffened_hertz"]
Area = Literal["flat", "sphere"]
Floats = float | NDArray[np.float64]
Parts = tuple[Any, Callable, Any]
"""A law at some R2*: scale, shape, and the shape's constants."""
COEFFICIENTS = Path(__file__).with_name("coefficients.json")
AREA_COEFFICIENTS: dict[Area, str] = {
    "flat": "hyperbolic_winkler",
    "sphere": "hyperbolic_winkler_sphere",
}
"""Name of the fitted coefficient of `hyperbolic_winkler`, by the area element of its pressure."""
LIMIT_MARGIN = 1e-9  # by rounding, d/dR and R2/dR from radii in m may exceed a limit


class Law(Protocol):
    """Dimensionless force over depth: a function with the arguments that the module names."""

    __name__: str
    __call__: Callable[..., Any]
    parts: Callable[..., Parts]
    deepest: float | None  # largest depth_star, where the shape has no limit
    joint: Any  # a `study.joint.Joint`, for the law of one joint


AnyLaw = str | Law | Callable[[float, float], float]
"""Key of `LAWS`, a law itself, or a function of one depth_star and one r2_star (`sampled`)."""


def _law(
    parts: Callable[..., Parts],
    usual_r2_star: float | None = None,
    deepest: float | None = None,
    joint: Any = None,
) -> Law:
    """Make a law from its parts: check the arguments, evaluate depths > 0 only."""

    @wraps(parts)
    def law(depth_star, r2_star=usual_r2_star, *, derivative=False, **options):
        depth = np.asarray(checks.depth("depth_star", depth_star))
        r2 = np.asarray(checks.number("r2_star", r2_star, above=1))
        checks.flag("derivative", derivative)
        try:
            depth, r2 = np.broadcast_arrays(depth, r2)
        except ValueError:
            wanted = "depth_star and r2_star must have shapes that broadcast"
            raise ValueError(f"{wanted}, got {depth.shape} and {r2.shape}") from None
        of_r2_star = parts(r2[depth > 0], **options)
        limit = shapes.LIMITS.get(of_r2_star[1], deepest)
        if limit is not None:
            name = f"depth_star of {parts.__name__}"
            checks.number(name, depth, most=limit * (1 + LIMIT_MARGIN))
        return evaluated(of_r2_star, depth, int(derivative))

    r2_star, *options = signature(parts).parameters.values()
    r2_star = r2_star.replace(annotation=ArrayLike)
    kind = Parameter("derivative", Parameter.KEYWORD_ONLY, default=False, annotation=bool)
    given = [r2_star.replace(name="depth_star"), r2_star, kind, *options]
    returns = Signature(given, return_annotation=Floats)
    vars(law).update(parts=parts, deepest=deepest, joint=joint, __signature__=returns)
    return cast(Law, law)


def evaluated(parts: Parts, depth_star: NDArray[np.float64], derivative: int) -> Any:
    """Dimensionless force, or its derivative by the depth, of a law at some R2*; 0 at depths <= 0.

    The scale and the constants are one for all depths, or one for each depth > 0.
    """
    scale, shape, constants = parts
    result, contact = np.zeros(depth_star.shape), depth_star > 0
    result[contact] = scale * shape(depth_star[contact], constants)[derivative]
    return float(result) if result.ndim == 0 else result


@_law
def hertz(r2_star: Floats) -> Parts:
    """Hertz: P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) (Eqs. 4-6, given)."""
    return 4 / 3 * np.sqrt(r2_star * (r2_star - 1)), shapes.hertz, ()


@_law
def steuermann(
    r2_star: Floats, *, n: int = 1, radius: Literal["geometric", "profile"] = "geometric"
) -> Parts:
    """Steuermann: P = (4n/(2n+1)) E* a d for a profile of order 2n (Eq. 7; Johnson, sec. 5.3).

    ``n`` is from 1 to 50. ``radius="geometric"`` takes the contact radius a = R2 sin(eps) with
    cos(eps) = dR/(dR + d). With n = 1 this is the law of Table 2 (identified: RMSE within 0.5 %).
    ``radius="profile"`` is the textbook's: a from d = c_n A_n a^(2n), where A_n is the Taylor
    coefficient of the gap between the spheres and c_n = 2*4*..*2n / (1*3*..*(2n-1)). With n = 1 it
    is Hertz's law.
    """
    checks.choice("radius", radius, ("geometric", "profile"))
    n = checks.whole("n", n, least=1, most=50)
    factor = 4 * n / (2 * n + 1)
    if radius == "geometric":
        return factor * r2_star, shapes.chord, ()
    c_n = sqrt(pi) * gamma(n + 1) / gamma(n + 0.5)
    taylor = factorial(2 * n - 2) / (2 ** (2 * n - 1) * factorial(n - 1) * factorial(n))
    odd = 2 * n - 1
    # ln(R1^-odd - R2^-odd), in units of dR: the powers themselves may under- or overflow
    ratio = -odd * np.log1p(-1 / r2_star)  # ln((R2/R1)^odd); beyond 700 the 1 in it is lost
    difference = np.where(ratio < 700, np.log(np.expm1(np.minimum(ratio, 700))), ratio)
    difference = difference - odd * np.log(r2_star)
    radius_star = np.exp(-(np.log(c_n * taylor) + difference) / (2 * n))  # at ds = 1
    return factor * radius_star, shapes.power, (1 + 1 / (2 * n),)


@_law
def liu(r2_star: Floats) -> Parts:
    """Liu et al. 2006: P* = 4.57 R2* ds sin(eps) sin(eps/2) (Eq. 8 is lost; reconstructed).

    The coefficient of determination in Table 2 gives the factor, the RMSE the growth with depth
    (notebook 13). The half-angle eps is Steuermann's; sin(eps/2) is the factor of Liu's law for
    cylinders. Another form also meets both numbers: a pressure 1 - theta^2/eps^2 on the socket's
    sphere. At a depth of 0.5 it differs by less than 1 % of the force.
    """
    return _coefficient("liu", r2_star), shapes.liu, ()


@_law
def winkler(r2_star: Floats, *, coefficient: float | None = None) -> Parts:
    """Winkler with fitted coefficient: P* = f1w(R2*) ds^2 (Eq. 28, derived; f1w fitted).

    The default of the ``coefficient`` f1w > 0 is this study's fit in the paper's joint
    (`study.joint.paper_joint`), linear in R2*.
    """
    return _coefficient("winkler", r2_star, coefficient), shapes.winkler, ()


@_law
def hyperbolic_winkler(
    r2_star: Floats, *, area: Area = "flat", coefficient: float | None = None
) -> Parts:
    """The paper's law: P* = f1(R2*) f2(ds) (Eqs. 20-27, f2 derived; f1 fitted by this study).

    f2 = 2 ds [(6/a) sin(a) + (6/a^2 - 2) cos(a) - 1 - 6/a^2] with the contact half-angle
    a = sqrt(2 ds). Its area element is R2^2 theta dtheta dphi, that of a flat disc whose radius is
    the arc. The paper's own formula is lost; its Table 2 identifies this element (notebook 13).

    ``area="sphere"`` takes the socket's own element, R2^2 sin(theta) dtheta dphi:
    f2 = ds [1/2 - sin(2a)/(2a) + sin(a)^2/(2 a^2)], with another coefficient. In the paper's joint
    its error for ds from 0.1 to 0.5 is up to 29 %, that of the flat element up to 32 %.

    Both are series, without cancellation (`study.contact.shapes.hyperbolic`). The largest depth is
    pi^2/8, a half-angle of 90 deg. The default of the ``coefficient`` f1 > 0 is as for `winkler`.
    """
    checks.choice("area", area, tuple(shapes.BRACKETS))
    scale = _coefficient(AREA_COEFFICIENTS[area], r2_star, coefficient)
    return scale, shapes.hyperbolic, shapes.BRACKETS[area]


@_law
def power(
    r2_star: Floats, *, coefficient: float | None = None, exponent: float | None = None
) -> Parts:
    """Power law: P* = k* ds^n, fitted to one joint and one range of depths (this study).

    It has the two numbers that programs for multibody dynamics ask for. A joint's own are those of
    `study.joint.DimensionalJoint.power_law`. The default is fitted in the paper's joint
    for depths from 0.05 to 0.5 clearances, with k* linear in R2*. Its error there is below 0.5 %
    at R2* = 200 and below 1.2 % from R2* = 20 on; elsewhere it is a guess.

    Parameters
    ----------
    coefficient, exponent
        k* > 0, and n from 1 to 3. Both or neither are given.
    """
    if (coefficient is None) != (exponent is None):
        raise ValueError("coefficient and exponent of power must be given together, got only one")
    if exponent is None:
        exponent = _fitted("power", "exponent")
    n = checks.number("exponent of power", exponent, least=1, most=3, scalar=True)
    return _coefficient("power", r2_star, coefficient), shapes.power, (n,)


@_law
def stiffened_hertz(
    r2_star: Floats,
    *,
    socket_ratio: float = SOCKET_RATIO,
    modulus_ratio: float = 1.0,
    poisson: float = 0.3,
    socket_poisson: float | None = None,
    ball_drive: Literal["plane", "clamped"] = "plane",
    rim: Literal["mirror", "free"] = "mirror",
) -> Parts:
    """Hertz stiffened by thickness, materials and supports (this study, tabulated).

    P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) S with S = 1 + c1 u + ... + c9 u^9, u = s/(1 + s) and
    s = sqrt(ds): Hertz's law as ds -> 0. It is for half a ball, ``plane`` or ``clamped``, in a
    hemispherical socket (an opening of 90 deg) that is fixed all over its outside (the backing
    ``whole``), of one material, pressed along the axis. The nine numbers of a joint are looked up
    once, in ``hertz_correction.csv`` (`study.contact.hertz_correction`). The law is for linear
    kinematics, ds <= 1 and the ranges of `study.contact.hertz_correction.RANGES`. Its largest error
    is 0.18 % on 336 random joints, and 0.57 % at the ends of the ranges (notebook 15). Defaults are
    the paper's socket ratio and equal materials.

    Parameters
    ----------
    socket_ratio
        Outer over inner radius of the socket.
    modulus_ratio
        Young's modulus of the socket over that of the ball.
    poisson, socket_poisson
        Of the ball, and of the socket if it differs.
    ball_drive, rim
        Supports, as for `study.joint.Joint`.
    """
    socket_poisson = poisson if socket_poisson is None else socket_poisson
    least_r2_star = hertz_correction.LEAST_R2_STAR * (1 - LIMIT_MARGIN)
    checks.number("r2_star of stiffened_hertz", r2_star, least=least_r2_star)
    given = {
        "socket_ratio": socket_ratio,
        "modulus_ratio": modulus_ratio,
        "poisson": poisson,
        "socket_poisson": socket_poisson,
    }
    for name, (least, most) in hertz_correction.RANGES.items():
        least *= 1 - LIMIT_MARGIN
        checks.number(
            f"{name} of stiffened_hertz", given[name], least=least, most=most, scalar=True
        )
    clamped = checks.choice("ball_drive of stiffened_hertz", ball_drive, ("plane", "clamped"))
    free = checks.choice("rim of stiffened_hertz", rim, ("mirror", "free"))
    share = hertz_correction.share_of_ball(modulus_ratio, poisson, socket_poisson)
    bodies = share, poisson, socket_poisson, socket_ratio
    radii = np.asarray(r2_star)
    if radii.ndim and (radii == radii[:1]).all():  # nearly always: the table is looked up once
        radii = radii[:1]
    constants = hertz_correction.powers(radii, bodies, clamped == "clamped", free == "free")
    return hertz.parts(r2_star)[0], shapes.stiffened, constants


def tabulated(curve: Any) -> Law:
    """Law of one joint, interpolated from its force-depth curve.

    The stiffening S = P*/P*(Hertz) is interpolated over sqrt(ds), from S = 1 at ds = 0. The cubic
    spline has limited slopes, so that it is monotone where the curve is (Hyman, SIAM J. Sci. Stat.
    Comput. 4 (1983) 645-654). The table is a cubic Hermite spline on equal steps: continuously
    differentiable, at the cost of one square root.

    The law's ``r2_star`` may be left out. Its largest depth is that of the curve.

    Parameters
    ----------
    curve
        A `study.joint.ForceCurve` of at least 4 different depths > 0, the shallowest at most a
        tenth of the deepest. Take 40 depths in equal steps of sqrt(ds) from 0.025 to 1, at a
        resolution of 640: the law is then within 1e-4 of the solver from a depth of 0.001 on. The
        usual resolution of 320 leaves noise of 3e-4 in the curve at depths below 0.005.

    Raises
    ------
    ValueError
        For too few or too deep depths, or a force that does not increase with depth.
    """
    if isinstance(curve, type) or not {"joint", "depth_star", "force_star"} <= {*dir(curve)}:
        raise ValueError(f"curve must be a ForceCurve, got {checks.shown(curve)}")
    lists = {"depth_star of curve": curve.depth_star, "force_star of curve": curve.force_star}
    depth, force = checks.same_length(**lists)
    order = np.argsort(depth)
    order = order[depth[order] > 0]
    depth, force = depth[order], force[order]
    if len(depth) < 4 or (np.diff(depth) <= 0).any():
        raise ValueError(f"curve must have at least 4 different depths > 0, got {len(depth)}")
    if depth[0] > 0.1 * depth[-1]:
        raise ValueError(
            "curve must start at a tenth of its largest depth or less: below its shallowest depth "
            f"the law is a guess; got {depth[0]:g} and {depth[-1]:g}"
        )
    if (np.diff(force, prepend=0) <= 0).any():
        raise ValueError("curve must have a force that increases with depth")
    joint_r2_star = float(curve.joint.r2_star)
    root = np.append(0, np.sqrt(depth))
    constants = sampling.of_points(root, np.append(1, force / hertz(depth, joint_r2_star)))

    def tabulated(r2_star: Floats) -> Parts:
        if not np.allclose(r2_star, joint_r2_star, rtol=1e-6, atol=0):
            raise ValueError(f"r2_star must be the curve's, {joint_r2_star:g}, got {r2_star}")
        return hertz.parts(r2_star)[0], shapes.tabulated, constants

    return _law(tabulated, joint_r2_star, depth[-1], curve.joint)


def sampled(function: Callable[[float, float], float], deepest: float = 1.0) -> Law:
    """Law from a plain Python function, as a table that compiled code can read.

    The secant stiffness P*/ds is sampled on equal steps of sqrt(ds), with a cubic Hermite spline
    between them. It is continuously differentiable, and exact for ds, ds^1.5, ds^2 and ds^2.5.
    Steps are halved until the force between them is within `sampling.TOLERANCE`, or within
    `sampling.FLOOR` of the largest force. There is one table for each R2*, so that a call takes one
    R2* only.

    A function may be given wherever a law is taken; it is then sampled up to one clearance.

    Parameters
    ----------
    function
        Of (``depth_star``, ``r2_star``), each one number, that returns force_star = P/(E* dR^2):
        0 at depth 0, and increasing. The law takes its name.
    deepest
        Largest depth_star of the law, up to which the function is sampled.

    Raises
    ------
    ValueError
        For a function of other arguments. When the law is used: for a force that is not a finite
        number, is not 0 at depth 0, does not increase with depth, or jumps.
    """
    if not callable(function) or isinstance(function, type):
        raise ValueError(f"law must be a name or a function, got {checks.shown(function)}")
    name = getattr(function, "__name__", type(function).__name__)
    sampling.check_arguments(function, name)
    limit = checks.number("deepest", deepest, above=0, most=sampling.DEEPEST, scalar=True)
    table = lru_cache(maxsize=8)(partial(sampling.of_function, function, name, deepest=limit))

    def parts(r2_star: Floats) -> Parts:
        given = np.unique(r2_star)
        if given.size == 0:  # nothing touches
            return 1.0, shapes.hertz, ()
        if given.size > 1:
            raise ValueError(f"r2_star of law {name} must be one number, got {checks.shown(given)}")
        return 1.0, shapes.sampled, table(r2_star=float(given[0]))

    parts.__name__ = parts.__qualname__ = name
    parts.__doc__ = function.__doc__
    return _law(parts, deepest=limit)


LAWS: dict[str, Law] = {
    law.__name__: law
    for law in (hertz, steuermann, liu, winkler, hyperbolic_winkler, power, stiffened_hertz)
}
PAPER_LAWS: tuple[PaperLawName, ...] = get_args(PaperLawName)
"""The laws that the paper compares."""


def find(law: AnyLaw) -> Law:
    """Law by its name, a law itself, or one `sampled` from a function; else ``ValueError``."""
    if not isinstance(law, str) and callable(getattr(law, "parts", None)):
        return cast(Law, law)
    if isinstance(law, partial) and hasattr(law.func, "parts"):
        shown = checks.shown(law)
        raise ValueError(f"law must be without its options, which are given beside it, got {shown}")
    if hasattr(law, "composite_modulus"):  # a JointLaw
        wanted = "a law without dimensions, such as tabulated(whole_curve(joint))"
        raise ValueError(f"law must be a name, a function, or {wanted}, got a JointLaw")
    if callable(law) and not isinstance(law, type):
        return sampled(law)
    return LAWS[checks.choice("law", law, LAWS)]


def _coefficient(law, r2_star, given=None):
    """Coefficient of a law as it is given, or as fitted for 20 <= R2* <= 300."""
    if given is not None:
        return checks.number(f"coefficient of {law}", given, above=0, scalar=True)
    return _fitted(law, "slope") * r2_star + _fitted(law, "intercept")


def _fitted(law, name):
    """One number of a law's fit."""
    try:
        return float(fitted_coefficients()[law][name])
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        file = f"study/contact/{COEFFICIENTS.name}"
        why = f"is missing or damaged, or lacks {law}"
        raise checks.StudyError(f"{file} {why}; rebuild it with: study data build") from None


@lru_cache(maxsize=1)
def fitted_coefficients() -> dict[str, Any]:
    """Content of ``coefficients.json``: the fit of every law that has one."""
    return json.loads(COEFFICIENTS.read_text(encoding="utf-8"))
