"""Boundary checks: bad input becomes one clear error before any work starts.

Every message has the form ``name must be <range>, got <value> <unit>``. Nothing is
clamped and nothing is guessed.
"""

import math

import numpy as np


class StudyError(RuntimeError):
    """A failure that is nobody's wrong input; the message says what failed and what mends it."""


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
        If any element is not a finite number or lies outside the range.
    """
    unit = f" {unit}" if unit else ""
    array = np.asarray(value)
    if array.dtype.kind not in "iuf" or (scalar and array.ndim):
        kind = "one number" if scalar else "a number"
        raise ValueError(f"{name} must be {kind}, got {value!r}")
    array = array.astype(float)
    good = np.isfinite(array)
    limits = []
    if above is not None:
        good &= array > above
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
        wanted = " and ".join(limits) if limits and math.isfinite(worst) else ""
        wanted = wanted or " and ".join(["finite", *limits])
        raise ValueError(f"{name} must be {wanted}{unit}, got {worst:g}{unit}")
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


def choice(name, value, allowed):
    """Return ``value`` if it is one of ``allowed``, or raise ``ValueError`` naming them."""
    if value not in allowed:
        raise ValueError(f"{name} must be one of {', '.join(allowed)}, got {value!r}")
    return value
