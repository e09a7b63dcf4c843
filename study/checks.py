"""Checks of input, which make one clear error of wrong input before any work begins.

The messages have the form ``name must be <range>, got <value> <unit>``. No value is changed or
guessed.
"""

import math
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from decimal import Decimal
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

T = TypeVar("T")

SOFTEST = 1e5
"""Minimum Young's modulus in Pa, that of soft rubber. In GPa every modulus is a smaller number."""

LIMITS = {
    "above": (">", np.greater),
    "least": (">=", np.greater_equal),
    "below": ("<", np.less),
    "most": ("<=", np.less_equal),
}
"""Name of a limit -> its sign, and the function that tells which numbers are within it."""


class StudyError(RuntimeError):
    """A failure other than wrong input; the message says what failed and how to repair it."""


class UnitWarning(UserWarning):
    """A value that was probably meant in another unit."""


class EnergyWarning(UserWarning):
    """The energy balance of a simulation shows that its contact force may be wrong."""


class RangeError(ValueError):
    """A valid value that is outside the range allowed here."""


@contextmanager
def intact(file: str) -> Iterator[None]:
    """Make one `StudyError` of what is raised while a file of the project is read."""
    remedy = f"restore it in a checkout with: git checkout -- {file}, else install the study again"
    try:
        yield
    except (OSError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise StudyError(f"{file} is missing or damaged ({error}); {remedy}") from None


def number(
    name: str, value: ArrayLike, unit: str = "", *, scalar: bool = False, **limits: float | None
) -> Any:
    """Return ``value``, in ``unit``, as a float, or as an array of floats unless ``scalar``.

    The ``limits`` are some of `LIMITS`: ``above`` and ``below`` are open, ``least`` and ``most``
    closed. Raises `RangeError` if any element is outside, or ``ValueError`` if it is not finite.
    """
    try:
        array = np.asarray(value)
    except (ValueError, TypeError):  # lists of different lengths
        array = np.array(None)
    if array.dtype.kind not in "iuf" or (scalar and array.ndim) or np.ma.is_masked(value):
        wanted = "one number" if scalar else "a number"
        raise ValueError(f"{name} must be {wanted}, got {shown(value)}")
    array = array.astype(float)
    good, texts = np.isfinite(array), []
    for of, limit in limits.items():
        if limit is not None:
            sign, within = LIMITS[of]
            good &= within(array, limit)
            texts.append(f"{sign} {limit:g}")
    if not good.all():
        worst, in_unit = float(array[~good].flat[0]), f" {unit}" if unit else ""
        kind = RangeError if math.isfinite(worst) else ValueError
        wanted = " and ".join(texts if kind is RangeError else ["finite", *texts])
        raise kind(f"{name} must be {wanted}{in_unit if texts else ''}, got {worst:g}{in_unit}")
    return float(array) if array.ndim == 0 else array


def whole(name: str, value: Any, *, least: int, most: int | None = None) -> int:
    """Return a whole number from ``least`` to ``most`` as int, or raise ``ValueError``."""
    checked = number(name, value, least=least, most=most, scalar=True)
    if checked != int(checked):
        limit = "" if most is None else f" and <= {most}"
        raise ValueError(f"{name} must be an integer >= {least}{limit}, got {value}")
    return int(checked)


def several(
    name: str,
    values: Any,
    check: Callable[..., Any] = number,
    *given: Any,
    fewest: int = 1,
    **limits: Any,
) -> list[Any]:
    """Return a list of ``fewest`` values or more, each checked, for example by `number`."""
    if not isinstance(values, list | tuple) or len(values) < fewest:
        wanted = "one value" if fewest == 1 else f"{fewest} values"
        raise ValueError(f"{name} must be a list of {wanted} or more, got {shown(values)}")
    return [check(name, value, *given, **limits) for value in values]


def poisson(name: str, value: Any) -> float:
    """Return a Poisson's ratio inside the open range (-1, 0.5), or raise ``ValueError``."""
    return number(name, value, above=-1.0, below=0.5, scalar=True)


def youngs_modulus(name: str, value: Any) -> float:
    """Return a Young's modulus in Pa; the error of one in GPa or MPa suggests the value in Pa."""
    try:
        return number(name, value, "Pa", least=SOFTEST, scalar=True)
    except RangeError as error:
        if not 1e-3 <= value < SOFTEST:
            raise
        meant = f"{value:g}e9" if value < 1e3 else f"{value / 1e3:g}e9"
        raise RangeError(f"{error}: did you mean {meant}?") from None


def choice(name: str, value: Any, allowed: Collection[str]) -> Any:
    """Return ``value`` if it is one of the names ``allowed``, or raise `RangeError`."""
    if not isinstance(value, str) or value not in allowed:
        raise RangeError(f"{name} must be one of {', '.join(allowed)}, got {shown(value)}")
    return value


def instance(name: str, value: Any, kind: type[T]) -> T:
    """Return ``value`` if it is of a class, or raise ``ValueError`` naming the class."""
    if not isinstance(value, kind):
        raise ValueError(f"{name} must be a {kind.__name__}, got {shown(value)}")
    return value


PREFIXES = {"": 0, "n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "c": -2, "k": 3, "M": 6, "G": 9}
"""SI prefix -> power of ten; micro is a letter u, a sign of its own, or the Greek letter."""
TOO_LONG = {"km": "kilometre", "Mm": "megametre", "Gm": "gigametre"}
"""Units of length that no joint has; they are typed by mistake for mm, µm or nm."""
OTHERS = {
    "m": {"in": "0.0254"},
    "N": {"lbf": "4.4482216152605"},
    "Pa": {"psi": "6894.757293168361", "ksi": "6894757.293168361"},
}
"""SI unit -> the other units of the same quantity, in terms of it."""
_WITH_UNIT = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(\S.*)", re.ASCII)
_UNIT = re.compile(f"[{''.join(PREFIXES)}]?(m|N|Pa|g|s|deg|rad)|in|lbf|[pk]si", re.IGNORECASE)


def factor_of(text: str, unit: str) -> Decimal | None:
    """A unit such as mm, kN or psi in terms of the SI unit of the quantity; None of another."""
    if text in OTHERS.get(unit, {}):
        return Decimal(OTHERS[unit][text])
    base, own = (unit[1:], 3) if unit.startswith("kg") else (unit, 0)
    prefix = text.removesuffix(base)
    if not base or prefix == text or prefix not in PREFIXES or text in TOO_LONG:
        return None
    return Decimal(1).scaleb(PREFIXES[prefix] - own)


def separate_unit(number: str, unit: str) -> bool:
    """Whether two words of a command line are a number and its unit, such as ``3 kN``."""
    is_number = _WITH_UNIT.fullmatch(f"{number} {unit}")
    return bool(is_number and is_number[2] == unit and _UNIT.fullmatch(unit))


def read(name: str, text: str, kind: Callable[[str], Any] = float, unit: str = "") -> Any:
    """Return the number that a text states, or raise ``ValueError``.

    A number of an SI ``unit`` may be followed by this unit, which may have a prefix (``12.5mm``),
    or by one of `OTHERS`.
    Underscores (``5_0``) and digits of other scripts are rejected, although Python accepts them.

    Examples
    --------
    >>> read("wall", "12.5mm", unit="m"), read("wall", "0.0125", unit="m")
    (0.0125, 0.0125)
    """
    text = text.strip()
    found = _WITH_UNIT.fullmatch(text)
    factor = factor_of(found[2], unit) if found and kind is float else None
    if found and factor is not None:
        return float(Decimal(found[1]) * factor)  # exactly the number in the SI unit
    try:
        if "_" in text or not text.isascii():
            raise ValueError
        return kind(text)
    except ValueError:
        what = "an integer" if kind is int else "a number"
        if unit and kind is float:
            what += f" in {unit}, or with its unit, such as {_EXAMPLES.get(unit, f'5 {unit}')}"
        meant = ""
        if found and unit == "m" and found[2] in TOO_LONG:
            meant = f"; {found[2]} is a {TOO_LONG[found[2]]}, and mm or um was probably meant"
        raise ValueError(f"{name} must be {what}, got {text!r}{meant}") from None


_EXAMPLES = {"m": "5mm", "N": "3kN", "Pa": "110GPa"}


def read_several(name: str, text: str, units: Sequence[str]) -> tuple[float, ...]:
    """Return the numbers that a text states, separated by commas, one of each unit."""
    parts = text.split(",")
    if len(parts) != len(units):
        forms = ("one number", "two numbers separated by a comma")
        wanted = (*forms, "three numbers separated by commas")[len(units) - 1]
        raise ValueError(f"{name} must be {wanted}, got {text!r}")
    return tuple(read(name, part, unit=unit) for part, unit in zip(parts, units, strict=True))


def percent(error: float) -> str:
    """Return a relative error in percent as text: two digits, rounded upwards as a bound is."""
    if not error > 0:
        return "0 %"
    step = 10.0 ** (math.floor(math.log10(100 * error)) - 1)
    return f"{math.ceil(100 * error / step * (1 - 1e-12)) * step:g} %"


def shown(value: object) -> str:
    """A value for an error message: one line, not too long."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 70 else f"{text[:67]}..."
