"""How each law's force grows with depth: force_star = scale(R2*) shape(depth_star).

A `Shape` has one Python function, which is for NumPy arrays, for the compiled stepping loops
(`study.contact.forces`) and, line by line, for texts of other programs (`study.export.formulas`).
Therefore it consists of assignments and one ``return``. They have numbers, names, ``constants[k]``,
the four operations, powers and ``np.sqrt``. A function with loops or look-ups states ``lines`` for
other programs in the same folder; a test compares both.
"""

from collections.abc import Callable
from dataclasses import dataclass
from inspect import getdoc
from math import factorial, pi
from typing import Any

import numpy as np


@dataclass(frozen=True, eq=False)
class Shape:
    """One shape of the force over the depth.

    Attributes
    ----------
    function, formula
        Function of ``ds`` > 0 and ``constants``, which returns value and derivative; and its
        formula for a reader, where ``$name`` is the number of a constant.
    constants
        Names of the constants; None if their number varies.
    lines
        Statements from ``ds`` to ``value`` and ``slope``, written for MATLAB's arrays, if they
        cannot be read from the function; empty for a shape that is not exported.
    polynomial
        Variable of the polynomial whose coefficients are the constants from the highest power on,
        and the coefficients that follow them; ``$polynomial`` and ``$derivative`` in `lines`.
    deepest
        Largest depth_star, if the shape has a limit.
    """

    function: Callable
    formula: str
    constants: tuple[str, ...] | None = ()
    lines: tuple[str, ...] | None = None
    polynomial: tuple[str, tuple[float, ...]] | None = None
    deepest: float | None = None

    def __post_init__(self) -> None:
        text = f"{self.name}(depth_star, constants)\n\n{self.formula}. {getdoc(self.function)}"
        object.__setattr__(self, "__doc__", text)  # for help() and the report

    @property
    def name(self) -> str:
        """Name of the function."""
        return self.function.__name__

    def __call__(self, depth_star: Any, constants: Any) -> tuple[Any, Any]:
        """Value and derivative at depths > 0."""
        return self.function(depth_star, constants)


def shape(formula: str, **more: Any) -> Callable[[Callable], Shape]:
    """Make a `Shape` of the function that follows."""
    return lambda function: Shape(function, formula, **more)


@shape("ds^(3/2)")
def hertz(ds, constants):
    """Of Hertz's law."""
    s = np.sqrt(ds)
    return ds * s, 1.5 * s


@shape("ds^2")
def winkler(ds, constants):
    """Of Winkler's law."""
    return ds * ds, 2 * ds


@shape("ds^$exponent", constants=("exponent",))
def power(ds, constants):
    """Of the power law, and of Steuermann's profiles."""
    value = ds ** constants[0]
    return value, constants[0] * value / ds


@shape("ds sin(eps), cos(eps) = 1/(1 + ds)")
def chord(ds, constants):
    """Of Steuermann's law."""
    root = np.sqrt(ds * (2 + ds))
    sine = root / (1 + ds)
    return ds * sine, sine + ds / (root * (1 + ds) ** 2)


@shape("ds sin(eps) sin(eps/2), cos(eps) = 1/(1 + ds)")
def liu(ds, constants):
    """Of Liu's law."""
    share = ds / (1 + ds)
    value = ds * share * np.sqrt(1 - share / 2)  # the whole never overflows on the way
    return value, value * (2 / ds + 0.5 / (2 + ds) - 1.5 / (1 + ds))


@shape(
    "ds (b0 + b1 ds + b2 ds^2 + ...)",
    constants=None,
    lines=(
        "bracket = $polynomial",
        "value = ds .* bracket",
        "slope = bracket + ds .* ($derivative)",
    ),
    polynomial=("ds", ()),
    deepest=pi**2 / 8,  # a half-angle of 90 deg
)
def hyperbolic(ds, constants):
    """f2 of the hyperbolic Winkler law: ds times the bracket of Eq. 20, a power series in ds.

    ``constants`` are its coefficients, one of `BRACKETS`, from the highest power to 0. Nothing
    cancels as ds -> 0, and the series has full accuracy up to a half-angle of 90 deg.
    """
    bracket = slope = 0.0 * ds
    for k in range(len(constants)):
        slope = slope * ds + bracket
        bracket = bracket * ds + constants[k]
    return ds * bracket, bracket + ds * slope


BRACKETS = {
    "sphere": tuple(
        (-1) ** (k + 1) * (2 * k + 1) * 8.0**k / factorial(2 * k + 2) if k else 0.0
        for k in range(19, -1, -1)
    ),
    "flat": tuple(
        (-1) ** (k + 1) * 2.0**k / (factorial(2 * k - 2) * k * (k + 1)) if k else 0.0
        for k in range(19, -1, -1)
    ),
}
"""Series of 2 int_0^a (1 - t^2/a^2) w(t) cos(t) dt with a = sqrt(2 ds). The area element is that of
the sphere, w(t) = sin(t), or of a flat disc with the arc as its radius, w(t) = t."""


@shape(
    "ds^(3/2) S, S = 1 + c1 u + ... + c9 u^9, u = s/(1 + s), s = sqrt(ds)",
    constants=tuple(f"c{k}" for k in range(9, 0, -1)),
    lines=(
        "s = sqrt(ds)",
        "u = s ./ (1 + s)",
        "factor = $polynomial",
        "steepness = $derivative",
        "value = ds .* s .* factor",
        "slope = 1.5 * s .* factor + ds .* steepness .* (1 - u) .* (1 - u) / 2",
    ),
    polynomial=("u", (1.0,)),
    deepest=1.0,  # the end of the fit
)
def stiffened(ds, constants):
    """Powers are summed in pairs, and pairs of pairs (Estrin): faster than one after the other."""
    root = np.sqrt(ds)
    u = root / (1 + root)
    u2 = u * u
    u4 = u2 * u2
    c9, c8, c7 = constants[0], constants[1], constants[2]
    c6, c5, c4 = constants[3], constants[4], constants[5]
    c3, c2, c1 = constants[6], constants[7], constants[8]
    rise = c5 + c6 * u + u2 * (c7 + c8 * u) + u4 * c9
    factor = 1 + u * (c1 + c2 * u + u2 * (c3 + c4 * u) + u4 * rise)
    slope = 5 * c5 + 6 * c6 * u + u2 * (7 * c7 + 8 * c8 * u) + u4 * (9 * c9)
    slope = c1 + 2 * c2 * u + u2 * (3 * c3 + 4 * c4 * u) + u4 * slope
    steepness = slope * (1 - u) ** 2
    return ds * root * factor, root * 1.5 * factor + ds * steepness / 2


def cubic(x, left, slope, right, next_slope):
    """Value and dvalue/dx at x = 0 to 1 in an interval of a cubic Hermite spline.

    ``left``, ``slope``, ``right`` and ``next_slope`` are those at its ends.
    """
    rise = right - left
    c2, c3 = 3 * rise - 2 * slope - next_slope, slope + next_slope - 2 * rise
    return left + x * (slope + x * (c2 + x * c3)), slope + x * (2 * c2 + x * 3 * c3)


@shape(
    "ds^(3/2) S, S a cubic Hermite spline over sqrt(ds)",
    constants=None,
    lines=(
        "s = sqrt(ds)",
        "x = s * $steps",
        "k = KNOT(x)",
        "x = x - k",
        "left = TABLE(k, 0)",
        "rise = TABLE(k + 1, 0) - left",
        "m0 = TABLE(k, 1) / $steps",
        "m1 = TABLE(k + 1, 1) / $steps",
        "c2 = 3 * rise - 2 * m0 - m1",
        "c3 = m0 + m1 - 2 * rise",
        "factor = left + x .* (m0 + x .* (c2 + x .* c3))",
        "steepness = (m0 + x .* (2 * c2 + x .* (3 * c3))) * $steps",
        "value = ds .* s .* factor",
        "slope = 1.5 * s .* factor + ds .* steepness / 2",
    ),
)
def tabulated(ds, constants):
    """Spline on equal steps of s = sqrt(ds).

    ``constants`` are the steps per unit of s, then S and dS/ds in turn at every knot.
    """
    root = np.sqrt(ds)
    place = root * constants[0]
    knot = np.int64(np.minimum(place, (len(constants) - 1) // 2 - 2))
    x, step, at = place - knot, 1 / constants[0], 1 + 2 * knot
    left, slope = constants[at], constants[at + 1] * step
    right, next_slope = constants[at + 2], constants[at + 3] * step
    factor, steepness = cubic(x, left, slope, right, next_slope)
    steepness = steepness * constants[0]
    return ds * root * factor, root * 1.5 * factor + ds * steepness / 2


@shape("ds F, F a cubic Hermite spline over sqrt(ds)", constants=None, lines=())
def sampled(ds, constants):
    """Spline over s = sqrt(ds) on unequal steps.

    ``constants`` are its knots, F there, and dF/ds there.
    """
    root, count = np.sqrt(ds), len(constants) // 3
    knot = np.searchsorted(constants[:count], root, "right") - 1
    knot = np.minimum(knot, count - 2)
    step = constants[knot + 1] - constants[knot]
    x, value, end = (root - constants[knot]) / step, count + knot, 2 * count + knot
    left, slope = constants[value], constants[end] * step
    right, next_slope = constants[value + 1], constants[end + 1] * step
    factor, steepness = cubic(x, left, slope, right, next_slope)
    return ds * factor, factor + root * steepness / (2 * step)


SHAPES = (hertz, winkler, power, chord, liu, hyperbolic, stiffened, tabulated, sampled)
"""All shapes; a record for the compiled loops holds a shape by its place here."""
