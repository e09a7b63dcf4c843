"""Force-depth laws of a ball in a socket: one `Law` each, all dimensionless.

In dimensionless form depth_star = d/dR (ds), r2_star = R2/dR and force_star = P/(E* dR^2), with
the clearance dR = R2 - R1, the penetration depth d and the composite modulus E*. Damping and
friction are not here.

A law is a function of R2* and of its options, which returns its `Parts`; `new_law` makes an object
of it. "Eq." numbers are those of the paper that the study reproduces.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, partial
from inspect import getdoc
from math import factorial, gamma, pi, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks, parameters
from study.contact import sampling, shapes, stiffening
from study.contact.bodies import SOCKET_RATIO, hertz_factor
from study.contact.power_fit import USUAL_RANGE
from study.contact.shapes import Shape
from study.parameters import Parameter, describe

Area = Literal["flat", "sphere"]
Evidence = Literal["given", "derived", "identified", "reconstructed", "fitted", "solved", "user's"]
"""How sure a law's formula is."""
Floats = float | NDArray[np.float64]
COEFFICIENTS = Path(__file__).with_name("coefficients.json")
AREA_COEFFICIENTS: dict[Area, str] = {
    "flat": "hyperbolic_winkler",
    "sphere": "hyperbolic_winkler_sphere",
}
"""Name of the fitted coefficient of `hyperbolic_winkler`, by the area element of its pressure."""
LIMIT_MARGIN = 1e-9  # by rounding, d/dR and R2/dR from radii in m may exceed a limit


class Parts(NamedTuple):
    """A law at some R2*: force_star is ``scale`` times the ``shape`` with its ``constants``."""

    scale: Any
    shape: Shape
    constants: Any = ()

    def at(self, depth_star: NDArray[np.float64], derivative: int) -> Any:
        """Dimensionless force, or its derivative by the depth; 0 at depths <= 0.

        Scale and constants are one for all depths, or one for each depth > 0.
        """
        result, touches = np.zeros(depth_star.shape), depth_star > 0
        values = self.shape(depth_star[touches], self.constants)
        result[touches] = self.scale * values[derivative]
        return float(result) if result.ndim == 0 else result


@dataclass(frozen=True, eq=False)
class Law:
    """A contact law: the normalised force as a function of the normalised penetration depth.

    A law is called to evaluate it.

    Attributes
    ----------
    name
        Key of `LAWS`, or the name of the function from which another law was made.
    formula
        Function of R2* and all options, with their defaults, that returns the law's `Parts`.
    of_bodies
        Options that a joint with dimensions determines, where they have no default.
    deepest
        Maximum depth_star, if the law has a limit that its shape does not have.
    least_r2_star
        Minimum R2*, if it is not 1.
    fitted_to
        Maximum depth_star of the fit, in the reference joint, of the default coefficients.
    examples
        Options with which all laws are tested.
    r2_star, joint
        For the law of one `study.joint.Joint`: its only R2*, and the joint.
    error, curve
        For the table of an elastic solution: the maximum relative error of its force between the
        solved depths, and the `study.joint.Solution` at these.

    Examples
    --------
    >>> print(f"{hertz(0.3, 200):.2f}")
    43.71
    """

    name: str
    formula: Callable[..., Parts] = field(repr=False)
    evidence: Evidence
    of_bodies: tuple[str, ...] = field(default=(), repr=False)
    deepest: float | None = field(default=None, repr=False)
    least_r2_star: float | None = field(default=None, repr=False)
    fitted_to: float | None = field(default=None, repr=False)
    examples: tuple[Mapping[str, Any], ...] = field(default=({},), repr=False)
    r2_star: float | None = field(default=None, repr=False)
    joint: Any = field(default=None, repr=False)
    error: float | None = field(default=None, repr=False)
    curve: Any = field(default=None, repr=False)

    def __post_init__(self) -> None:
        given = ["depth_star", "r2_star" if self.r2_star is None else f"r2_star={self.r2_star:g}"]
        given += ["*", "derivative=False"]
        given += [f"{name}={default!r}" for name, default in self.defaults.items()]
        text = f"{self.name}({', '.join(given)})\n\n{getdoc(self.formula) or ''}"
        object.__setattr__(self, "__doc__", text)  # for help() and the report

    @property
    def options(self) -> dict[str, Parameter]:
        """What each option is."""
        return vars(self.formula).get("described", {})

    @cached_property
    def defaults(self) -> dict[str, Any]:
        """Default of each option."""
        return parameters.defaults(self.formula)

    def __call__(
        self,
        depth_star: ArrayLike,
        r2_star: ArrayLike | None = None,
        *,
        derivative: bool = False,
        **options: Any,
    ) -> Any:
        """Evaluate the law.

        Parameters
        ----------
        depth_star, r2_star
            Normalised penetration depths d/dR and socket radii R2/dR > 1, as arrays that broadcast.
            A law of one joint needs no ``r2_star``.
        derivative
            Whether to return the derivative of the force with respect to depth_star.
        **options
            Options of the law.

        Returns
        -------
        float or array
            Normalised force P/(E* dR^2), or its derivative; 0 where the depth is <= 0.

        Raises
        ------
        ValueError
            If an option is unknown or a value is outside its range.
        """
        depth = np.asarray(checks.depth("depth_star", depth_star))
        given: Any = self.r2_star if r2_star is None else r2_star
        r2 = np.asarray(checks.number("r2_star", given, above=1))
        depth, r2 = np.broadcast_arrays(depth, r2)
        touches = depth > 0
        if not touches.any():
            self._checked(options)
            return 0.0 if depth.ndim == 0 else np.zeros(depth.shape)
        parts = self.parts(r2[touches], **options)
        limit = self.limit(parts.shape)
        if limit is not None:
            checks.number(f"depth_star of {self.name}", depth, most=limit * (1 + LIMIT_MARGIN))
        return parts.at(depth, int(derivative))

    def parts(self, r2_star: Any, **options: Any) -> Parts:
        """Scale, shape and constants for one R2*, or for each of an array."""
        if self.least_r2_star is not None:
            least = self.least_r2_star * (1 - LIMIT_MARGIN)
            checks.number(f"r2_star of {self.name}", r2_star, least=least)
        return self.formula(r2_star, **self._checked(options))

    def limit(self, shape: Shape) -> float | None:
        """Largest depth_star of the law with one of its shapes."""
        return self.deepest if shape.deepest is None else shape.deepest

    def _checked(self, options):
        """All options: those given, in their ranges, and defaults."""
        for name in options:
            if not self.options:
                raise checks.RangeError(
                    f"{name} does not apply to the law {self.name}, which has no options; remove it"
                )
            checks.choice(f"option of {self.name}", name, self.options)
        return self.defaults | {
            name: self.options[name].taken(f"{name} of {self.name}", value)
            for name, value in options.items()
            if value is not None or self.defaults[name] is not None
        }


def new_law(evidence: Evidence, **more: Any) -> Callable[[Callable[..., Parts]], Law]:
    """Make a `Law` of the function that follows, its ``formula``; more attributes are `Law`'s."""
    return lambda formula: Law(formula.__name__, formula, evidence, **more)


COEFFICIENT = Parameter("Fitted coefficient (no unit)", limits={"above": 0})


@new_law("given")
def hertz(r2_star: Floats) -> Parts:
    """Hertz: P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) (Eqs. 4-6, given)."""
    return Parts(hertz_factor(r2_star), shapes.hertz)


@new_law("identified", examples=({}, {"n": 3}, {"n": 2, "radius": "profile"}))
@describe(
    n=Parameter("Half of the order 2n of the profile", limits={"least": 1, "most": 50}, whole=True),
    radius=Parameter(
        "Contact radius a: geometric, from the overlap of the spheres, or that of the profile",
        choices=("geometric", "profile"),
    ),
)
def steuermann(r2_star: Floats, n: int = 1, radius: str = "geometric") -> Parts:
    """Steuermann: P = (4n/(2n+1)) E* a d for a profile of order 2n (Eq. 7; Johnson, sec. 5.3).

    ``radius="geometric"`` takes the contact radius a = R2 sin(eps) with
    cos(eps) = dR/(dR + d). With n = 1 this is the law of Table 2 (identified: RMSE within 0.5 %).
    ``radius="profile"`` is the textbook's: a from d = c_n A_n a^(2n), where A_n is the Taylor
    coefficient of the gap between the spheres and c_n = 2*4*..*2n / (1*3*..*(2n-1)). With n = 1 it
    is Hertz's law.
    """
    factor = 4 * n / (2 * n + 1)
    if radius == "geometric":
        return Parts(factor * r2_star, shapes.chord)
    c_n = sqrt(pi) * gamma(n + 1) / gamma(n + 0.5)
    taylor = factorial(2 * n - 2) / (2 ** (2 * n - 1) * factorial(n - 1) * factorial(n))
    odd = 2 * n - 1
    # ln(R1^-odd - R2^-odd), in units of dR: the powers themselves may under- or overflow
    ratio = -odd * np.log1p(-1 / r2_star)  # ln((R2/R1)^odd); beyond 700 the 1 in it is lost
    difference = np.where(ratio < 700, np.log(np.expm1(np.minimum(ratio, 700))), ratio)
    difference = difference - odd * np.log(r2_star)
    radius_star = np.exp(-(np.log(c_n * taylor) + difference) / (2 * n))  # at ds = 1
    return Parts(factor * radius_star, shapes.power, (1 + 1 / (2 * n),))


@new_law("reconstructed", fitted_to=USUAL_RANGE[1])
def liu(r2_star: Floats) -> Parts:
    """Liu et al. 2006: P* = 4.57 R2* ds sin(eps) sin(eps/2) (Eq. 8 is lost; reconstructed).

    The coefficient of determination in Table 2 gives the factor, the RMSE the growth with depth
    (notebook 32). The half-angle eps is Steuermann's; sin(eps/2) is the factor of Liu's law for
    cylinders. Another form also agrees with both numbers: a pressure 1 - theta^2/eps^2 on the
    socket's sphere. At a depth of 0.5 it differs by less than 1 % of the force.
    """
    return Parts(_coefficient("liu", r2_star), shapes.liu)


@new_law("derived", fitted_to=USUAL_RANGE[1], examples=({}, {"coefficient": 3.0}))
@describe(coefficient=COEFFICIENT)
def winkler(r2_star: Floats, coefficient: float | None = None) -> Parts:
    """Winkler with fitted coefficient: P* = f1w(R2*) ds^2 (Eq. 28, derived; f1w fitted).

    The default of the ``coefficient`` f1w is this study's fit in the paper's joint
    (`study.joint.reference_joint`), linear in R2*.
    """
    return Parts(_coefficient("winkler", r2_star, coefficient), shapes.winkler)


@new_law(
    "derived",
    fitted_to=USUAL_RANGE[1],
    examples=({}, {"coefficient": 3.0}, {"area": "sphere"}),
)
@describe(
    area=Parameter(
        "Area element: that of a flat disc, or that of the sphere of the socket",
        choices=("flat", "sphere"),
    ),
    coefficient=COEFFICIENT,
)
def hyperbolic_winkler(
    r2_star: Floats, area: Area = "flat", coefficient: float | None = None
) -> Parts:
    """The paper's law: P* = f1(R2*) f2(ds) (Eqs. 20-27, f2 derived; f1 fitted by this study).

    f2 = 2 ds [(6/a) sin(a) + (6/a^2 - 2) cos(a) - 1 - 6/a^2] with the contact half-angle
    a = sqrt(2 ds). Its area element is R2^2 theta dtheta dphi, that of a flat disc whose radius is
    the arc. The paper's own formula is lost; its Table 2 identifies this element (notebook 13).

    ``area="sphere"`` takes the socket's own element, R2^2 sin(theta) dtheta dphi:
    f2 = ds [1/2 - sin(2a)/(2a) + sin(a)^2/(2 a^2)], with another coefficient. In the paper's joint
    its error for ds from 0.1 to 0.5 is up to 29 %, that of the flat element up to 32 %.

    The largest depth is pi^2/8, a half-angle of 90 deg. The default of the ``coefficient`` f1 is as
    for `winkler`.
    """
    scale = _coefficient(AREA_COEFFICIENTS[area], r2_star, coefficient)
    return Parts(scale, shapes.hyperbolic, shapes.BRACKETS[area])


@new_law(
    "fitted",
    fitted_to=USUAL_RANGE[1],
    examples=({}, {"coefficient": 600.0, "exponent": 1.7}),
)
@describe(
    coefficient=COEFFICIENT,
    exponent=Parameter("Exponent (no unit)", limits={"least": 1, "most": 3}),
)
def power(
    r2_star: Floats, coefficient: float | None = None, exponent: float | None = None
) -> Parts:
    """Power law: P* = k* ds^n, fitted to one joint and one range of depths (this study).

    It has the two numbers that programs for multibody dynamics ask for. A joint's own are those of
    `study.joint.Joint.power_law`. The default is fitted in the paper's joint
    for depths from 0.05 to 0.5 clearances, with k* linear in R2*. Its error there is below 0.5 %
    at R2* = 200 and below 1.2 % from R2* = 20 on; elsewhere it is a guess. k* and n are
    given together.
    """
    if (coefficient is None) != (exponent is None):
        raise ValueError(
            "coefficient and exponent of the law power must be given together, got only one of them"
        )
    n = _fitted("power", "exponent") if exponent is None else exponent
    return Parts(_coefficient("power", r2_star, coefficient), shapes.power, (n,))


_MEANINGS = {
    "socket_ratio": "Outer radius of the socket divided by its inner radius",
    "modulus_ratio": "Young's modulus of the socket divided by that of the ball",
    "poisson": "Poisson's ratio of the ball",
    "socket_poisson": "Poisson's ratio of the socket",
}
"""Options of `stiffened_hertz` that describe both bodies."""


def _in_table(name):
    least, most = stiffening.RANGES[name]
    return Parameter(_MEANINGS[name], limits={"least": least * (1 - LIMIT_MARGIN), "most": most})


_PAPER = {"socket_ratio": SOCKET_RATIO, "modulus_ratio": 1.0, "poisson": 0.3, "socket_poisson": 0.3}


@new_law(
    "fitted",
    of_bodies=tuple(_MEANINGS),
    least_r2_star=stiffening.LEAST_R2_STAR,
    examples=(
        _PAPER,
        _PAPER | {"socket_ratio": 1.1, "poisson": 0.45, "socket_poisson": 0.45},
        _PAPER | {"socket_ratio": 3.0, "modulus_ratio": 0.01, "ball_support": "clamped"},
        _PAPER | {"socket_poisson": 0.46, "modulus_ratio": 30.0, "rim": "free"},
    ),
)
@describe(
    **{name: _in_table(name) for name in _MEANINGS},
    ball_support=Parameter(
        "Ball support: a plate on which half a ball can slide (guided) or is clamped (clamped)",
        choices=("guided", "clamped"),
    ),
    rim=Parameter(
        "Edge of the socket: in a mirror plane (mirror), or free of traction (free)",
        choices=("mirror", "free"),
    ),
)
def stiffened_hertz(
    r2_star: Floats,
    socket_ratio: float = SOCKET_RATIO,
    modulus_ratio: float = 1.0,
    poisson: float = 0.3,
    socket_poisson: float | None = None,
    ball_support: str = "guided",
    rim: str = "mirror",
) -> Parts:
    """Hertz stiffened by thickness, materials and supports (this study, tabulated).

    P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) S with S = 1 + c1 u + ... + c9 u^9, u = s/(1 + s) and
    s = sqrt(ds): Hertz's law as ds -> 0. It is for half a ball, ``guided`` or ``clamped``, in a
    hemispherical socket of one material that is fixed all over its outside, pressed along the axis.
    The nine numbers of a joint are looked up once, in ``stiffening.csv``
    (`study.contact.stiffening`). The law is for small displacements, ds <= 1 and the ranges of
    `study.contact.stiffening.RANGES`. Its largest error is 0.18 % on 336 random joints, and 0.57 %
    at the ends of the ranges (notebook 15). Defaults are the paper's socket ratio and equal
    materials; supports are those of `study.joint.Joint`.
    """
    socket_poisson = poisson if socket_poisson is None else socket_poisson
    share = stiffening.share_of_ball(modulus_ratio, poisson, socket_poisson)
    bodies = share, poisson, socket_poisson, socket_ratio
    radii = np.asarray(r2_star)
    if radii.ndim and (radii == radii[:1]).all():  # nearly always: the table is looked up once
        radii = radii[:1]
    constants = stiffening.powers(radii, bodies, ball_support == "clamped", rim == "free")
    return Parts(hertz.parts(r2_star).scale, shapes.stiffened, constants)


def tabulated(curve: Any) -> Law:
    """Law of one joint, interpolated from its force-depth curve.

    The stiffening S = P*/P*(Hertz) is interpolated over sqrt(ds), from S = 1 at ds = 0, by a spline
    that is monotone where the curve is (`sampling.monotone_slopes`). The table is a cubic Hermite
    spline with equal steps, which is continuously differentiable and needs only one square root.
    The maximum depth of the law is that of the curve, and ``r2_star`` need not be given.

    Parameters
    ----------
    curve
        A `study.joint.Solution` with at least 4 different depths > 0, a minimum depth of at most
        a tenth of the maximum, and a force that increases with depth. With 40 depths in equal steps
        of sqrt(ds) from 0.025 to 1, at a resolution of 640, the law is within 1e-4 of the elastic
        solution from a depth of 0.001 on. The default resolution of 320 leaves noise of 3e-4 in the
        curve at depths below 0.005.

    Raises
    ------
    ValueError
        If the curve has too few depths, or its force does not increase.

    Examples
    --------
    >>> from study.joint import Joint
    >>> law = tabulated(Joint.from_ratios(200).curve())
    >>> print(f"{law(0.3):.2f}")
    81.63
    """
    order = np.argsort(curve.depth_star)
    order = order[curve.depth_star[order] > 0]
    depth, force = curve.depth_star[order], curve.force_star[order]
    if len(depth) < 4 or (np.diff(depth) <= 0).any():
        raise ValueError(f"curve must have >= 4 different depths > 0, got {len(depth)}")
    if depth[0] > 0.1 * depth[-1]:
        raise ValueError(
            "the minimum depth of curve must be <= a tenth of the maximum depth, because the law "
            f"is not reliable below it, got {depth[0]:g} and {depth[-1]:g}"
        )
    if (np.diff(force, prepend=0) <= 0).any():
        raise ValueError("the force of curve must increase with depth, but it decreases somewhere")
    joint_r2_star = float(curve.joint.r2_star)
    root, factor = np.sqrt(depth), force / hertz(depth, joint_r2_star)
    below = np.zeros(1)
    if factor[0] < 1:  # the contact bends the wall
        below = root[0] * np.array([0, 0.125, 0.25, 0.5])
    factor = np.append(sampling.in_series(below, root[0], factor[0]), factor)
    constants = sampling.of_points(np.append(below, root), factor)

    def formula(r2_star: Floats) -> Parts:
        """Table of one joint's force-depth curve."""
        if not np.allclose(r2_star, joint_r2_star, rtol=1e-6, atol=0):
            raise ValueError(
                f"r2_star must be {joint_r2_star:g}, that of the tabulated joint, got {r2_star}"
            )
        return Parts(hertz.parts(r2_star).scale, shapes.tabulated, constants)

    return Law(
        "tabulated",
        formula,
        "solved",
        deepest=float(depth[-1]),
        r2_star=joint_r2_star,
        joint=curve.joint,
    )


def sampled(function: Callable[[float, float], float], deepest: float = 1.0) -> Law:
    """Law from a Python function, as a table that compiled code can read.

    The secant stiffness P*/ds is a cubic Hermite spline over sqrt(ds), which is continuously
    differentiable and exact for ds, ds^1.5, ds^2 and ds^2.5. Steps are halved until the error of
    the force between them is within `sampling.TOLERANCE`, or within `sampling.FLOOR` of the maximum
    force. There is one table for each R2*, and therefore a call accepts one R2* only.

    Functions that accept a law also accept such a function, and sample it up to one clearance.

    Parameters
    ----------
    function
        Function of two numbers (``depth_star``, ``r2_star``) that returns the normalised force
        P/(E* dR^2), which must be 0 at depth 0 and increase. The law has the name of the function.
    deepest
        Maximum depth_star of the law, up to which the function is sampled.

    Raises
    ------
    ValueError
        When the law is first used, if the force is not a finite number, is not 0 at depth 0, does
        not increase with depth, or jumps.

    Examples
    --------
    >>> law = sampled(lambda depth_star, r2_star: 1.5 * r2_star * depth_star**1.6)
    >>> print(f"{law(0.3, 200):.2f}")
    43.70
    """
    if not callable(function) or isinstance(function, type):
        raise ValueError(f"law must be a name or a function, got {checks.shown(function)}")
    name = getattr(function, "__name__", type(function).__name__)
    limit = checks.number("deepest", deepest, above=0, most=sampling.DEEPEST, scalar=True)
    table = lru_cache(maxsize=8)(partial(sampling.of_function, function, name, deepest=limit))

    def formula(r2_star: Floats) -> Parts:
        given = np.unique(r2_star)
        if given.size > 1:
            raise ValueError(f"r2_star of law {name} must be one number, got {checks.shown(given)}")
        return Parts(1.0, shapes.sampled, table(r2_star=float(given[0])))

    formula.__doc__ = function.__doc__
    return Law(name, formula, "user's", deepest=limit)


PAPER_LAWS = ("hertz", "steuermann", "liu", "winkler", "hyperbolic_winkler")
"""The laws that the paper compares."""
COMPARED_LAWS = (*PAPER_LAWS, "power", "stiffened_hertz")
"""The laws that results of all laws show: another law changes none of them."""
LAWS = {
    law.name: law
    for law in (hertz, steuermann, liu, winkler, hyperbolic_winkler, power, stiffened_hertz)
}
"""Every law that has a name, by it."""
if TYPE_CHECKING:
    LawName = str
else:
    LawName = Literal[tuple(LAWS)]
AnyLaw = str | Law | Callable[[float, float], float]
"""Key of `LAWS`, a law itself, or a function of one depth_star and one r2_star (`sampled`)."""


def find(law: AnyLaw) -> Law:
    """Law by its name, a law itself, or one `sampled` from a function; else ``ValueError``."""
    if isinstance(law, Law):
        return law
    if isinstance(law, partial) and isinstance(law.func, Law):
        shown = checks.shown(law)
        raise ValueError(
            f"law must be a law without options, which are given as separate arguments, got {shown}"
        )
    if callable(law):
        return sampled(law)
    return LAWS[checks.choice("law", law, LAWS)]


def _coefficient(law, r2_star, given=None):
    """Coefficient of a law as it is given, or as fitted for 20 <= R2* <= 300."""
    if given is not None:
        return given
    return _fitted(law, "slope") * r2_star + _fitted(law, "intercept")


def _fitted(law, name):
    """One number of a law's fit."""
    with checks.intact("study/contact/coefficients.json"):
        return float(fitted_coefficients()[law][name])


@lru_cache(maxsize=1)
def fitted_coefficients() -> dict[str, Any]:
    """Content of ``coefficients.json``: the fit of every law that has one."""
    return json.loads(COEFFICIENTS.read_text(encoding="utf-8"))
