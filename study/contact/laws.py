"""Force-depth laws of a ball in a socket: one class each, all dimensionless.

In dimensionless form depth_star = d/dR (ds), r2_star = R2/dR and force_star = P/(E* dR^2), with
the clearance dR = R2 - R1, the penetration depth d and the composite modulus E*.

A law holds its own numbers, and `Law.parts` writes its formula with one of the shapes of
`study.contact.shapes`. "Eq." numbers are those of the paper that the study reproduces.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from math import factorial, gamma, pi, sqrt
from pathlib import Path
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks, parameters
from study.contact import shapes, stiffening, tables
from study.contact.materials import LIMIT_MARGIN, hertz_factor
from study.contact.power_fit import USUAL_RANGE, fit_power
from study.parameters import parameter

Area = Literal["flat", "sphere"]
Floats = float | NDArray[np.float64]
COEFFICIENTS = Path(__file__).with_name("coefficients.json")
AREA_COEFFICIENTS: dict[Area, str] = {
    "flat": "hyperbolic_winkler",
    "sphere": "hyperbolic_winkler_sphere",
}
"""Name of the coefficient of `HyperbolicWinkler` in ``coefficients.json``, by area element."""


class Parts(NamedTuple):
    """A law at some R2*: force_star is ``scale`` times the ``shape`` with its ``constants``."""

    scale: Any
    shape: Callable[[Any, Any], tuple[Any, Any]]
    constants: Any = ()


@dataclass(frozen=True, eq=False)
class Law:
    """A contact law: the normalised force as a function of the normalised penetration depth.

    A law is called to evaluate it.

    Examples
    --------
    >>> print(f"{Hertz()(0.3, 200):.2f}")
    43.71
    """

    name: ClassVar[str]
    """Key of `LAWS`."""
    deepest = None
    """Maximum depth_star, or None."""
    least_r2_star: ClassVar[float] = 1.0
    """Minimum R2*."""
    fitted_to: ClassVar[float | None] = None
    """Maximum depth_star of the fit, in the reference joint, of the default coefficients."""
    fitted_constants: ClassVar[tuple[str, ...]] = ()
    """Numbers that are fitted to a measured curve; ``coefficient`` is a factor of the force."""
    needs_joint: ClassVar[bool] = False
    """Whether the law is made by `of` alone; else its numbers have defaults."""
    r2_star = joint = None
    """R2* and the `study.joint.Joint` of the law of one joint."""

    def __post_init__(self) -> None:
        parameters.take(self)

    def __repr__(self) -> str:
        """The class and its numbers; for one that is left out, what it is by default."""
        about = parameters.described(type(self))
        values = ((name, of, about[name].otherwise) for name, of in self.numbers.items())
        written = (f"{name}={usual if of is None else of}" for name, of, usual in values)
        return f"{type(self).__name__}({', '.join(written)})"

    @property
    def numbers(self) -> dict[str, Any]:
        """The numbers that a user may choose, by name; None for the default."""
        return {name: getattr(self, name) for name in parameters.described(type(self))}

    @classmethod
    def of(cls, joint: Any) -> Law:
        """The law of a joint; a `study.checks.RangeError` if the law is not valid for it."""
        return cls()

    @classmethod
    def fit(cls, joint: Any, depth_star: ArrayLike, force_star: ArrayLike) -> Law:
        """The law of a joint for given depths, where its force is known."""
        return cls.of(joint)

    @property
    def exponent_of_depth(self) -> float | None:
        """Exponent n if the force is k d^n, else None."""
        return None

    def parts(self, r2_star: Any) -> Parts:
        """Scale, shape and constants for one R2*, or for each of an array."""
        raise NotImplementedError

    def __call__(
        self, depth_star: ArrayLike, r2_star: ArrayLike | None = None, *, derivative: bool = False
    ) -> Any:
        """Evaluate the law.

        Parameters
        ----------
        depth_star, r2_star
            Normalised penetration depths d/dR and socket radii R2/dR > 1, as arrays that broadcast.
            A law of one joint needs no ``r2_star``.
        derivative
            Whether to return the derivative of the force with respect to depth_star.

        Returns
        -------
        float or array
            Normalised force P/(E* dR^2), or its derivative; 0 where the depth is <= 0. Raises
            ``ValueError`` if a value is outside its range.
        """
        most = None if self.deepest is None else self.deepest * (1 + LIMIT_MARGIN)
        depth = np.asarray(checks.number("depth_star", depth_star))
        checks.number(f"depth_star of {self.name}", depth, most=most)
        given: Any = self.r2_star if r2_star is None else r2_star
        depth, r2 = np.broadcast_arrays(depth, checks.number("r2_star", given, above=1))
        if self.r2_star is not None and not np.allclose(r2, self.r2_star, rtol=1e-6, atol=0):
            raise ValueError(
                f"r2_star must be {self.r2_star:g}, that of the joint of this law, got {given}"
            )
        result, touches = np.zeros(depth.shape), depth > 0
        if touches.any():
            scale, shape, constants = self.parts(r2[touches])
            result[touches] = scale * shape(depth[touches], constants)[derivative]
        return float(result) if result.ndim == 0 else result


_COEFFICIENT: Any = parameter(
    None, "Fitted coefficient (no unit)", above=0, otherwise="that of the reference joint"
)


@dataclass(frozen=True, repr=False)
class Hertz(Law):
    """Hertz: P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) (Eqs. 4-6, given)."""

    name, exponent_of_depth = "hertz", 1.5

    def parts(self, r2_star: Any) -> Parts:  # noqa: D102
        return Parts(hertz_factor(r2_star), shapes.hertz)


@dataclass(frozen=True, repr=False)
class Steuermann(Law):
    """Steuermann: P = (4n/(2n+1)) E* a d for a profile of order 2n (Eq. 7; Johnson, sec. 5.3).

    ``radius="geometric"`` takes the contact radius a = R2 sin(eps) with
    cos(eps) = dR/(dR + d). With n = 1 this is the law of Table 2 (identified: RMSE within 0.5 %).
    ``radius="profile"`` is the textbook's: a from d = c_n A_n a^(2n), where A_n is the Taylor
    coefficient of the gap between the spheres and c_n = 2*4*..*2n / (1*3*..*(2n-1)). With n = 1 it
    is Hertz's law.
    """

    n: int = parameter(1, "Half of the order 2n of the profile", least=1, most=50, whole=True)
    radius: str = parameter(
        "geometric",
        "Contact radius a: geometric, from the overlap of the spheres, or that of the profile",
        choices=("geometric", "profile"),
    )

    name = "steuermann"

    @property
    def exponent_of_depth(self) -> float | None:  # noqa: D102
        return 1 + 1 / (2 * self.n) if self.radius == "profile" else None

    def parts(self, r2_star: Any) -> Parts:  # noqa: D102
        n, odd = self.n, 2 * self.n - 1
        factor = 4 * n / (2 * n + 1)
        if self.radius == "geometric":
            return Parts(factor * r2_star, shapes.chord)
        c_n = sqrt(pi) * gamma(n + 1) / gamma(n + 0.5)
        taylor = factorial(2 * n - 2) / (2**odd * factorial(n - 1) * factorial(n))
        # A_n = taylor (R1^-odd - R2^-odd), in units of dR; R1^-odd itself may under- or overflow
        inner = -taylor * np.expm1(odd * np.log1p(-1 / r2_star))  # A_n R1^odd
        radius_star = (r2_star - 1) ** (odd / (2 * n)) * (c_n * inner) ** (-1 / (2 * n))
        return Parts(factor * radius_star, shapes.power, (self.exponent_of_depth,))


@dataclass(frozen=True, repr=False)
class Liu(Law):
    """Liu et al. 2006: P* = 4.57 R2* ds sin(eps) sin(eps/2) (Eq. 8 is lost; reconstructed).

    The coefficient of determination in Table 2 gives the factor, the RMSE the growth with depth
    (notebook 13). The half-angle eps is Steuermann's; sin(eps/2) is the factor of Liu's law for
    cylinders.
    """

    name, fitted_to = "liu", USUAL_RANGE[1]

    def parts(self, r2_star: Any) -> Parts:  # noqa: D102
        return Parts(_coefficient("liu", r2_star), shapes.liu)


@dataclass(frozen=True, repr=False)
class Winkler(Law):
    """Winkler with fitted coefficient: P* = f1w(R2*) ds^2 (Eq. 28, derived; f1w fitted).

    The default of the ``coefficient`` f1w is this study's fit in the reference joint, linear in
    R2*.
    """

    coefficient: float | None = _COEFFICIENT

    name, exponent_of_depth = "winkler", 2.0
    fitted_to, fitted_constants = USUAL_RANGE[1], ("coefficient",)

    def parts(self, r2_star: Any) -> Parts:  # noqa: D102
        return Parts(_coefficient("winkler", r2_star, self.coefficient), shapes.winkler)


@dataclass(frozen=True, repr=False)
class HyperbolicWinkler(Law):
    """The paper's law: P* = f1(R2*) f2(ds) (Eqs. 20-27, f2 derived; f1 fitted by this study).

    f2 = 2 ds [(6/a) sin(a) + (6/a^2 - 2) cos(a) - 1 - 6/a^2] with the contact half-angle
    a = sqrt(2 ds). Its area element is R2^2 theta dtheta dphi, that of a flat disc whose radius is
    the arc. The paper's own formula is lost; its Table 2 identifies this element (notebook 13).

    ``area="sphere"`` takes the socket's own element, R2^2 sin(theta) dtheta dphi:
    f2 = ds [1/2 - sin(2a)/(2a) + sin(a)^2/(2 a^2)], with another coefficient.

    The largest depth is pi^2/8, a half-angle of 90 deg. The default of the ``coefficient`` f1 is as
    for `Winkler`.
    """

    coefficient: float | None = _COEFFICIENT
    area: Area = parameter(
        "flat",
        "Area element: that of a flat disc, or that of the sphere of the socket",
        choices=("flat", "sphere"),
    )

    name, deepest = "hyperbolic_winkler", pi**2 / 8  # type: ignore[assignment]
    fitted_to, fitted_constants = USUAL_RANGE[1], ("coefficient",)

    def parts(self, r2_star: Any) -> Parts:  # noqa: D102
        scale = _coefficient(AREA_COEFFICIENTS[self.area], r2_star, self.coefficient)
        return Parts(scale, shapes.hyperbolic, shapes.BRACKETS[self.area])


@dataclass(frozen=True, repr=False)
class Power(Law):
    """Power law: P* = k* ds^n, fitted to one joint and one range of depths (this study).

    `of` a joint, k* and n are fitted to its elastic solution from 0.05 to 0.5 clearances. The
    default is fitted in the paper's joint over this range, with k* linear in R2*. Its error there
    is below 0.5 % at R2* = 200 and below 1.2 % from R2* = 20 on.
    """

    coefficient: float | None = _COEFFICIENT
    exponent: float | None = parameter(
        None, "Exponent (no unit)", least=1, most=3, otherwise="that of the reference joint"
    )

    name, fitted_to = "power", USUAL_RANGE[1]
    fitted_constants = ("coefficient", "exponent")

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.coefficient is None) != (self.exponent is None):
            raise ValueError("coefficient and exponent of the law power must be given together")

    @classmethod
    def of(cls, joint: Any) -> Power:  # noqa: D102
        fit, unit = joint.power_law(), joint.force_unit
        return cls(fit.coefficient * joint.clearance**fit.exponent / unit, fit.exponent)

    @classmethod
    def fit(cls, joint: Any, depth_star: ArrayLike, force_star: ArrayLike) -> Power:  # noqa: D102
        return cls(*fit_power(depth_star, force_star)[:2])

    @property
    def exponent_of_depth(self) -> float:  # noqa: D102
        if self.exponent is not None:
            return self.exponent
        return float(fitted_coefficients()["power"]["exponent"])

    def parts(self, r2_star: Any) -> Parts:  # noqa: D102
        scale = _coefficient("power", r2_star, self.coefficient)
        return Parts(scale, shapes.power, (self.exponent_of_depth,))


@dataclass(frozen=True)
class StiffenedHertz(Law):
    """Hertz stiffened by thickness, materials and supports (this study).

    P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) S with S = 1 + c1 u + ... + c9 u^9, u = s/(1 + s) and
    s = sqrt(ds): Hertz's law as ds -> 0. It is for half a ball, ``guided`` or ``clamped``, in a
    hemispherical socket of one material that is fixed all over its outside, pressed along the axis.
    `study.contact.stiffening` has the nine ``constants`` c1 to c9 of a joint. The law is for small
    displacements, ds <= 1 and the ranges of `study.contact.stiffening.RANGES`. Its largest error is
    0.22 % on 376 random joints, and 0.57 % at the ends of the ranges (notebook 15).
    """

    constants: tuple[float, ...]
    r2_star: float = field()  # type: ignore[assignment]
    joint: Any = field(default=None, compare=False)  # type: ignore[assignment]

    name, deepest, needs_joint = "stiffened_hertz", 1.0, True  # type: ignore[assignment]
    least_r2_star = stiffening.LEAST_R2_STAR

    @classmethod
    def of(cls, joint: Any) -> StiffenedHertz:  # noqa: D102
        return cls(stiffening.constants(joint), joint.r2_star, joint)

    def parts(self, r2_star: Any) -> Parts:  # noqa: D102
        return Parts(hertz_factor(r2_star), shapes.stiffened, self.constants[::-1])


@dataclass(frozen=True, eq=False)
class Table(Law):
    """Table of the elastic solution of one joint: a monotone cubic spline (`study.contact.tables`).

    `of_values` makes a table of a Python function instead. A table is made from at least 4
    different depths > 0, of which the minimum is at most a tenth of the maximum, and of forces that
    increase with the depth; else ``ValueError``.

    Attributes
    ----------
    constants
        Those of `study.contact.shapes.table`.
    curve
        The `study.joint.Solution` at the solved depths.
    error
        Maximum relative error of the force between these depths, if it was checked.
    """

    r2_star: float = field()  # type: ignore[assignment]
    deepest: float = field()  # type: ignore[assignment]
    constants: NDArray[np.float64] = field(repr=False)
    joint: Any = None  # type: ignore[assignment]
    curve: Any = field(default=None, repr=False)
    error: float | None = None

    name, needs_joint = "tabulated", True

    @classmethod
    def of(cls, joint: Any) -> Table:  # noqa: D102
        return joint.table()

    @classmethod
    def of_curve(cls, curve: Any) -> Table:
        """Table of a `study.joint.Solution`."""
        depth, force = tables.in_order(curve.depth_star, curve.force_star)
        r2_star = float(curve.joint.r2_star)
        constants = tables.of_points(np.sqrt(depth), force / Hertz()(depth, r2_star))
        return cls(r2_star, float(depth[-1]), constants, curve.joint, curve)

    @classmethod
    def of_values(cls, depth_star: ArrayLike, force_star: ArrayLike, r2_star: float) -> Table:
        """Table of normalised forces at normalised depths, such as those of a Python function.

        The table is exact for ds, ds^1.5 and ds^2, and smooth: it rounds kinks.

        Examples
        --------
        >>> depth = np.linspace(0.01, 1, 100) ** 2
        >>> law = Table.of_values(depth, 300 * depth**1.6, r2_star=200)
        >>> print(f"{law(0.3):.3f}, by the function {300 * 0.3**1.6:.3f}")
        43.703, by the function 43.703
        """
        depth, force = tables.in_order(depth_star, force_star)
        r2_star = checks.number("r2_star", r2_star, above=1, scalar=True)
        constants = tables.of_secants(np.sqrt(depth), force / depth / hertz_factor(r2_star))
        return cls(r2_star, float(depth[-1]), constants)

    def parts(self, r2_star: Any) -> Parts:  # noqa: D102
        return Parts(hertz_factor(r2_star), shapes.table, self.constants)


CLASSES: tuple[type[Law], ...] = (
    Hertz,
    Steuermann,
    Liu,
    Winkler,
    HyperbolicWinkler,
    Power,
    StiffenedHertz,
    Table,
)
"""All laws, in the order of tables and figures; a new one is added at the end."""
LAWS = {law.name: law for law in CLASSES}
"""Class of each law, by its name."""
CLOSED_FORM = tuple(name for name in LAWS if name != Table.name)
"""Laws that need no elastic solution."""
PAPER_LAWS = ("hertz", "steuermann", "liu", "winkler", "hyperbolic_winkler")
"""The laws that the paper compares."""
AnyLaw = str | type[Law] | Law
"""Key of `LAWS`, or a law or its class."""


def find(law: AnyLaw, joint: Any = None) -> Law:
    """Law by its name or class, or a law itself; else ``ValueError``.

    With a ``joint``, a name or a class stands for the law `Law.of` this joint; without one, for the
    law with its default numbers.
    """
    if isinstance(law, Law):
        return law
    kind: Any = LAWS[checks.choice("law", law, LAWS)] if isinstance(law, str) else law
    if not (isinstance(kind, type) and issubclass(kind, Law)):
        raise ValueError(
            f"law must be a name or a law, got {checks.shown(law)}; make the law of a function "
            "from its values with Table.of_values(depth_star, force_star, r2_star)"
        )
    if joint is not None:
        return kind.of(joint)
    if kind.needs_joint:
        raise ValueError(
            f"the law {kind.name} depends on the joint, which is not given; take it from one, for "
            f"example Joint.from_ratios(200).law({kind.name!r})"
        )
    return kind()


def _coefficient(law, r2_star, given=None):
    """Coefficient of a law as it is given, or as fitted for 20 <= R2* <= 300."""
    if given is not None:
        return given
    fit = fitted_coefficients()[law]
    return fit["slope"] * r2_star + fit["intercept"]


@lru_cache(maxsize=1)
def fitted_coefficients() -> dict[str, Any]:
    """Content of ``coefficients.json``: the fit of every law that has one."""
    with checks.intact("study/contact/coefficients.json"):
        return json.loads(COEFFICIENTS.read_text(encoding="utf-8"))
