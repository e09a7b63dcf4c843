"""Table of Chebyshev coefficients of `study.contact.stiffening`, from joints at Chebyshev points.

The grid is fine in the limit of large R2*, and coarse for the changes with a smaller R2*, because
these are smooth. Notebook 15 shows the errors of the table for other joints.
"""

import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study.compiled import one_thread
from study.contact import Hertz
from study.contact.stiffening import DEGREES, LEAST_R2_STAR, PLACES, RANGES, SUPPORTS, UNIT
from study.joint import Joint, Material
from study.joint.axial import at_nodes
from study.joint.supports import RIMS, ClampedPlate, GuidedPlate

Logarithms = Sequence[NDArray[np.float64]]
LIMITS = dict(zip(DEGREES, (9, 5, 6, 10, 1), strict=True))
CHANGES = dict(zip(DEGREES, (9, 5, 4, 6, 3), strict=True))
"""Numbers of points of the coordinates: for infinite R2*, and for the changes with R2*."""
_ORDER = ("socket_poisson", "socket_ratio", "ball_compliance_ratio", "poisson", "r2_star")
RESOLUTION = 128  # of the table's joints
FINER = 320  # of those with the default supports, on which the changes by supports build
COARSER = 96  # for the changes with R2*, which are at large depths
LARGEST = 1e9  # R2*, practically infinite
THICK = 1e4  # ratio of the thickest socket solved: 1e-4 of the coordinate from the limit
DEEPEST = 1.15  # depth_star of the curves, as fits are poor at their ends
SMALLEST = 8e-5  # coefficient that is kept in the table


@one_thread
def logarithms(socket_poisson: float, counts: dict[str, int]) -> NDArray[np.float64]:
    """Logarithms of S at `PLACES`, of the joints with one socket's Poisson's ratio.

    Axes: socket ratio, compliance ratio of the ball, Poisson's ratio of the ball and R2* of `grid`;
    clamped ball (no, yes); free rim (no, yes); place.
    """
    places = grid(counts)
    of_ball = places["ball_compliance_ratio"]
    places["ball_compliance_ratio"] = np.clip(of_ball, 2e-9, 1 - 2e-9)  # nearly rigid
    plates = GuidedPlate(), ClampedPlate()
    axes: list[Any] = [*(places[name] for name in _ORDER[1:]), plates, RIMS]
    solved: list[Any] = []
    for ratio, share, poisson, r2_star, support, rim in itertools.product(*axes):
        ball = Material((1 - poisson**2) / share, poisson)
        socket = Material((1 - socket_poisson**2) / (1 - share), socket_poisson)
        supports = {"ball_support": support, "rim": rim}
        joint = Joint.from_ratios(r2_star, ratio, ball=ball, socket=socket, **supports)
        resolution = FINER if joint.series_applies else RESOLUTION
        resolution = COARSER if counts["r2_star"] > 1 else resolution
        nodes = at_nodes(joint, DEEPEST, resolution)
        assert nodes is not None  # contacts of these supports are nested
        factor = nodes.force_star / Hertz()(nodes.depth_star, r2_star)
        solved.append(at_places(nodes.depth_star, factor))
    return np.reshape(solved, (*map(len, axes), *np.shape(solved[0])))


def grid(counts: dict[str, int]) -> dict[str, NDArray[np.float64]]:
    """Values of the joint's coordinates in the table, at Chebyshev points, by their names."""
    by_poisson = (
        *(np.log(1 - 1.8 * nu) for nu in RANGES["poisson"]),
        lambda x: (1 - np.exp(x)) / 1.8,
    )
    thinnest = np.log(1 - 1 / RANGES["socket_ratio"][0])
    axes: dict[str, tuple[float, float, Callable]] = {  # ends, and the value at a place between
        "ball_compliance_ratio": (0, 1, np.square),
        "poisson": by_poisson,
        "socket_ratio": (thinnest, -1 / THICK, lambda x: 1 / (1 - np.exp(x))),
        "r2_star": (1 / LARGEST, 1 / LEAST_R2_STAR, lambda x: 1 / x),
        "socket_poisson": by_poisson,
    }
    values = {}
    for name, (least, most, value) in axes.items():
        fraction = (1 - np.cos(np.pi * np.arange(counts[name]) / max(counts[name] - 1, 1))) / 2
        values[name] = value(least + (most - least) * fraction)
    return values


def at_places(depth: NDArray[np.float64], factor: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ln S at `PLACES`, from the best polynomial in u for S - 1, which is 0 at u = 0."""
    root = np.sqrt(depth)
    powers = np.arange(1, len(PLACES) + 1)
    terms = (root / (1 + root))[:, None] ** powers / factor[:, None]
    coefficients = np.linalg.lstsq(terms, 1 - 1 / factor, rcond=None)[0]
    return np.log1p(PLACES[:, None] ** powers @ coefficients)


def table(limits: Logarithms, changes: Logarithms) -> pd.DataFrame:
    """Table of `study.contact.stiffening`: Chebyshev coefficients, without small ones.

    ``limits`` are the `logarithms` for each Poisson's ratio of the socket and infinite R2*, on the
    grid of `LIMITS`. ``changes`` are those on the grid of `CHANGES`, of which only the changes with
    R2* are used.
    """
    terms = np.zeros((*(max(LIMITS[n], CHANGES[n]) for n in DEGREES), 2, 2, len(PLACES)))
    for part, places in (limits, LIMITS), (changes, CHANGES):
        shape = [places[name] for name in _ORDER]
        values = np.reshape(part, (*shape, *terms.shape[5:])).transpose(2, 3, 0, 1, 4, 5, 6, 7)
        values = values - values[:, :, :, :, :1] if places is CHANGES else values
        for axis, name in enumerate(DEGREES):
            orders = np.arange(places[name])
            at = np.cos(np.pi * np.outer(orders[::-1], orders) / max(orders[-1], 1))
            values = np.moveaxis(np.tensordot(np.linalg.inv(at), values, (1, axis)), 0, axis)
        terms[tuple(slice(n) for n in values.shape)] += values
    # a law sums the terms of its supports: those of both, clamped and free, are what is beyond the
    # sum of those of one, and these are what is beyond the default supports
    terms[..., 1, 1, :] -= terms[..., 1, 0, :] + terms[..., 0, 1, :] - terms[..., 0, 0, :]
    terms[..., 1, 0, :] -= terms[..., 0, 0, :]
    terms[..., 0, 1, :] -= terms[..., 0, 0, :]
    kept = np.argwhere(np.abs(terms).max(axis=-1) >= SMALLEST)
    named = [f"at_{k}" for k in range(1, len(PLACES) + 1)]
    whole = np.rint(terms[tuple(kept.T)] / UNIT).astype(int)
    rows = pd.DataFrame(np.hstack([kept, whole]), columns=[*DEGREES, *SUPPORTS, *named])
    first = [*SUPPORTS, *DEGREES]
    return rows.sort_values(first)[first + named]
