"""Boundary checks: bad input becomes one clear error before any work starts.

Every message has the form ``name must be <range>, got <value> <unit>``. Nothing is
clamped and nothing is guessed.
"""

import math

import numpy as np

LARGEST, SMALLEST = 1e40, 1e-40
"""Size of any number, and least size of a positive one. The force of a law in SI units has six
factors of such numbers and of a clearance that is 1e-16 of the radii: it neither overflows nor
underflows."""


class StudyError(RuntimeError):
    """A failure that is nobody's wrong input; the message says what failed and what mends it."""


class RangeError(ValueError):
    """A value that is possible, but outside the range of what it is given to."""


def number(name, value, unit="", *, above=None, least=None, below=None, most=None, scalar=False):
    """Return ``value`` as floats if all of it lies in the stated range.

    Parameters
    ----------
    name : str
        What the value is, in the words of the error message.
    value : float or array_like
        Value to check, in ``unit``.
    unit : str
        Unit named in the message; empty for a pure number.
    above, least, below, most : float, optional
        Open lower, closed lower, open upper and closed upper limit.
    scalar : bool
        Refuse an array.

    Returns
    -------
    float or ndarray
        A float for a scalar, else an array of the same shape.

    Raises
    ------
    ValueError
        If any element is no finite number, or masked.
    RangeError
        If any lies outside the range or is larger than `LARGEST`, or, for the range above 0, is
        below `SMALLEST`.
    """
    unit = f" {unit}" if unit else ""
    try:
        array = np.asarray(value)
    except (ValueError, TypeError):  # lists of different lengths
        array = np.array(None)
    masked = isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value)
    if array.dtype.kind not in "iuf" or (scalar and array.ndim) or masked:
        kind = "one number" if scalar else "a number"
        raise ValueError(f"{name} must be {kind}, got {shown(value)}")
    array = array.astype(float)
    good = np.abs(array) <= LARGEST
    limits = []
    if above is not None:
        good &= (array > above) if above else (array >= SMALLEST)
        limits.append(f"> {above:g}")
    if least is not None:
        good &= array >= least
        limits.append(f">= {least:g}")
    if below is not None:
        good &= array < below
        limits.append(f"< {below:g}")
    if most is not None:
        good &= array <= most
        limits.append(f"<= {most:g}")
    if not good.all():
        worst = float(array[~good].flat[0])
        kind = RangeError
        if not math.isfinite(worst):
            kind, limits = ValueError, ["finite", *limits]
        elif abs(worst) > LARGEST and ((below, most), (above, least))[worst < 0] == (None, None):
            limits.append(f"<= {LARGEST:g} in size")
        elif above == 0 and 0 < worst < SMALLEST:
            limits[0] = f">= {SMALLEST:g}"
        wanted = " and ".join(limits)
        raise kind(f"{name} must be {wanted}{unit}, got {worst:g}{unit}")
    return float(array) if array.ndim == 0 else array


def whole(name, value, *, least, most=None):
    """Return a whole number from ``least`` to ``most`` as int, or raise ``ValueError``."""
    found = number(name, value, least=least, most=most, scalar=True)
    if found != int(found):
        limit = "" if most is None else f" and <= {most}"
        raise ValueError(f"{name} must be a whole number >= {least}{limit}, got {value}")
    return int(found)


def poisson(name, value):
    """Return a Poisson's ratio inside the open range (-1, 0.5), or raise ``ValueError``."""
    return number(name, value, above=-1.0, below=0.5, scalar=True)


def depth(name, value, unit=""):
    """Return penetration depths, of any sign: `number`, but none from 0 to `SMALLEST`."""
    found = number(name, value, unit)
    tiny = (found > 0) & (found < SMALLEST)
    if tiny.any() if isinstance(found, np.ndarray) else tiny:
        number(name, np.asarray(found)[tiny], unit, least=SMALLEST)
    return found


def choice(name, value, allowed):
    """Return ``value`` if it is one of the names ``allowed``, or raise `RangeError`."""
    if not isinstance(value, str) or value not in allowed:
        raise RangeError(f"{name} must be one of {', '.join(allowed)}, got {shown(value)}")
    return value


def flag(name, value):
    """Return ``value`` if it is True or False, or raise ``ValueError``."""
    if value is not True and value is not False and not isinstance(value, np.bool_):
        raise ValueError(f"{name} must be True or False, got {shown(value)}")
    return value


def instance(name, value, kind):
    """Return ``value`` if it is of a class, or raise ``ValueError`` naming the class."""
    if not isinstance(value, kind):
        raise ValueError(f"{name} must be a {kind.__name__}, got {shown(value)}")
    return value


def like(name, value, kind, *attributes):
    """Return ``value`` if it has the attributes of a class that is not at hand here."""
    if isinstance(value, type) or not all(hasattr(value, a) for a in attributes):
        raise ValueError(f"{name} must be a {kind}, got {shown(value)}")
    return value


def same_length(least=1, **lists):
    """Return lists of numbers as arrays, or raise ``ValueError`` if their lengths differ."""
    arrays = [np.asarray(number(name, value)) for name, value in lists.items()]
    if arrays[0].ndim != 1 or arrays[0].size < least or len({a.shape for a in arrays}) > 1:
        names, shapes = " and ".join(lists), " and ".join(f"{a.shape}" for a in arrays)
        raise ValueError(
            f"{names} must be lists of the same length >= {least}, got shapes {shapes}"
        )
    return arrays


def frame(name, value, columns):
    """Return a ``pandas.DataFrame`` that has some columns, or raise ``ValueError``."""
    held = getattr(value, "columns", ())
    missing = [column for column in columns if column not in held]
    if missing or not hasattr(value, "itertuples") or value.empty:
        wanted = f"a table with rows and the columns {', '.join(columns)}"
        raise ValueError(f"{name} must be {wanted}, got {shown(value)}")
    return value


def shown(value):
    """A value as an error message shows it: one line, not too long."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # a whole number of thousands of digits
        text = f"one of type {type(value).__name__}"
    return text if len(text) <= 70 else f"{text[:67]}..."
