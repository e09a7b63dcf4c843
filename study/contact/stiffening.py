"""The factor by which thickness, materials and supports stiffen a joint relative to Hertz's law.

The table of `study.contact.StiffenedHertz` has ln S at nine depths, as a Chebyshev series in five
coordinates of the joint. A clamped ball and a free rim have additional terms. The table is made by
`study.dataset.stiffening_fit`, and ``data/README.md`` describes its format.

It is evaluated with the same bits on every processor, because every impact multiplies a difference
of the last digits. Therefore S is rounded to `DIGITS`, after the logarithms and sums that differ
between processors, and only sums and products follow.
"""

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact.materials import LIMIT_MARGIN

TABLE = Path(__file__).with_name("stiffening.csv")
LEAST_R2_STAR = 20.0
RANGES = {
    "socket_ratio": (1.1, 1e6),
    "poisson": (0.2, 0.46),
    "socket_poisson": (0.2, 0.46),
    "modulus_ratio": (0, 1e9),
}
"""Minimum and maximum values for which the table is valid; R2* is at least `LEAST_R2_STAR`."""
PLACES = np.round((1 - np.cos(np.pi * np.arange(1, 10) / 9)) / 4, 12)
"""Values of u = s/(1 + s) with s = sqrt(ds), up to ds = 1, at which ln S is kept; shape (9,)."""
DEGREES = ("ball_compliance_ratio", "poisson", "socket_poisson", "socket_ratio", "r2_star")
"""Coordinates of the Chebyshev series, and columns of their degrees in the table."""
SUPPORTS = ("clamped", "free")
"""Columns of marks, 0 or 1. A row is added only if every support marked 1 is present."""
UNIT = 1e-5  # of ln S in the table, which contains whole numbers
DIGITS = 10
"""Decimals to which S is rounded at `PLACES`: beyond them, processors differ."""


def _to_powers():
    """Powers of u from S - 1 at `PLACES`, (9, 9), by additions, products and quotients alone."""
    matrix = np.zeros((9, 9))
    for k, place in enumerate(PLACES):
        row = np.zeros(9)  # of u times the product of (u - u_j)/(u_k - u_j), over u_k
        row[0] = 1 / place
        for other in np.delete(PLACES, k):
            row[1:], row[0] = row[:-1] - other * row[1:], -other * row[0]
            row /= place - other
        matrix[:, k] = row
    return matrix


_POWERS = _to_powers()


def constants(joint: Any) -> tuple[float, ...]:
    """Coefficients c1 to c9 of S in a joint; a `RangeError` if the table is not valid for it."""
    instead = "use the law tabulated, which is valid for any joint"
    for unsuited, what in (
        (joint.liner, "a socket with layers"),
        (not joint.ball_support.is_half, f"ball_support {joint.ball_support}"),
        (str(joint.opening) != "90", f"an opening of {joint.opening} deg"),
        (not joint.is_held_all_round, f"socket_support {joint.socket_support}"),
    ):
        if unsuited:
            raise checks.RangeError(f"stiffened_hertz is not valid for {what}; {instead}")
    limits = {"r2_star": (LEAST_R2_STAR, None), **RANGES}
    poissons = joint.ball.poisson, joint.socket.poisson
    values = joint.r2_star, joint.socket_ratio, *poissons, joint.modulus_ratio
    try:
        for (name, (least, most)), value in zip(limits.items(), values, strict=True):
            least *= 1 - LIMIT_MARGIN
            checks.number(f"{name} of stiffened_hertz", value, least=least, most=most)
    except checks.RangeError as error:
        raise checks.RangeError(f"{error}; {instead}") from None
    compliance_ratio = (1 - poissons[0] ** 2) * joint.modulus_shares[0]  # (1 - nu1^2) E*/E1
    bodies = compliance_ratio, *poissons, joint.socket_ratio
    supports = joint.ball_support.word == "clamped", joint.rim == "free"
    return tuple(powers(joint.r2_star, bodies, *supports)[::-1].tolist())


def coordinates(
    ball_compliance_ratio: ArrayLike,
    poisson: ArrayLike,
    socket_poisson: ArrayLike,
    socket_ratio: ArrayLike,
) -> list[NDArray[np.float64]]:
    """Four coordinates of a joint, from -1 to 1, in which ln S is smooth; the fifth is in 1/R2*."""

    def scaled(value: Any, least: Any, most: Any) -> Any:
        return (2 * value - least - most) / (most - least)

    ends = [np.log(1 - 1.8 * nu) for nu in RANGES["poisson"]]
    return [
        2 * np.sqrt(ball_compliance_ratio) - 1,
        *(scaled(np.log(1 - 1.8 * np.asarray(nu)), *ends) for nu in (poisson, socket_poisson)),
        scaled(np.log1p(-1 / np.asarray(socket_ratio)), np.log(1 - 1 / 1.1), 0),
    ]


def powers(r2_star: ArrayLike, bodies: tuple[float, ...], clamped: bool, free: bool) -> Any:
    """Coefficients of u^9 to u in S - 1, shape (9,) or (9, n) for n values of ``r2_star``.

    ``bodies`` are the arguments of `coordinates`: compliance ratio of the ball, both Poisson's
    ratios and socket ratio.
    """
    place = 2 * LEAST_R2_STAR / np.asarray(r2_star) - 1
    logarithm = chebyshev.chebval(place, _in_r2_star(bodies, clamped, free))
    rise = np.round(np.expm1(logarithm), DIGITS)
    terms = _POWERS.T.reshape(9, 9, *(1,) * (rise.ndim - 1)) * rise[:, None]
    return terms.sum(axis=0)[::-1]  # in the same order for one R2* and for many


@lru_cache(maxsize=1024)
def _in_r2_star(bodies, clamped, free):
    """Chebyshev coefficients in 1/R2* of ln S at `PLACES`, shape (3, 9)."""
    supports, degrees, values = table()
    held = (supports <= (clamped, free)).all(axis=1)
    degrees, values = degrees[held], values[held]
    factors = np.ones(len(degrees))
    for place, degree in zip(coordinates(*bodies), degrees.T, strict=False):
        factors *= chebyshev.chebvander(place, int(degrees.max())).ravel()[degree]
    return np.array([factors * (degrees[:, -1] == k) @ values for k in range(3)])


@lru_cache(maxsize=1)
def table() -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Table of ln S: supports (rows, 2), degrees (rows, 5), values (rows, 9).

    Raises `study.checks.StudyError` if its file is missing or damaged.
    """
    with checks.intact("study/contact/stiffening.csv"):
        _, *rows = TABLE.read_text(encoding="utf-8").splitlines()
        numbers = np.array([line.split(",") for line in rows], dtype=np.int64).reshape(-1, 16)
    supports, degrees, values = np.split(numbers, [2, 7], axis=1)
    return supports, degrees, np.array(UNIT * values)
