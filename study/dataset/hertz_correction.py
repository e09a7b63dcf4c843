"""The table behind `study.contact.stiffened_hertz`: joints solved at Chebyshev's places.

Bodies are solved once for many joints: some 10,000 joints take two minutes. In the limit of large
R2* the grid is fine. The changes with a smaller R2* are smooth and take few places.
`study.contact.hertz_correction` evaluates the table; notebook 15 has its errors on other joints.
"""

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study.contact import hertz, hertz_correction
from study.joint import Joint, Material
from study.joint.compliance import DRIVES, RIMS
from study.joint.nested_contact import depths_and_forces
from study.threads import one_thread

LIMITS = {"share": 9, "poisson": 5, "socket_poisson": 6, "socket_ratio": 10, "r2_star": 1}
CHANGES = {"share": 9, "poisson": 5, "socket_poisson": 4, "socket_ratio": 6, "r2_star": 3}
"""Places of the joint's coordinates in the table: for infinite R2*, and for changes with R2*."""
_ORDER = ("socket_poisson", "socket_ratio", "share", "poisson", "r2_star")
RESOLUTION = 128  # of the table's joints
FINER = 320  # of those with the default supports, on which the changes by supports build
COARSER = 96  # for the changes with R2*, which are at large depths
LARGEST = 1e9  # R2*, practically infinite
THICK = 1e4  # ratio of the thickest socket solved: 1e-4 of the coordinate from the limit
DEEPEST = 1.15  # depth_star of the curves, as fits are poor at their ends
SMALLEST = 8e-5  # coefficient of the table


@one_thread
def logarithms(socket_poisson: float, counts: dict[str, int]) -> NDArray[np.float64]:
    """Logarithms of S at `PLACES`, of the joints with one socket's Poisson's ratio.

    Axes: socket ratio, share, Poisson's ratio of the ball and R2* of `grid`; clamped ball, no or
    yes; free rim, no or yes; place.
    """
    places = grid(counts)
    shares = np.clip(places["share"], 2e-9, 1 - 2e-9)  # nearly rigid
    axes = places["socket_ratio"], shares, places["poisson"], places["r2_star"]
    found = np.empty((*(len(axis) for axis in axes), 2, 2, len(hertz_correction.PLACES)))
    for *at, drive, rim in np.ndindex(found.shape[:-1]):
        ratio, share, poisson, r2_star = (axis[k] for axis, k in zip(axes, at, strict=True))
        ball = Material((1 - poisson**2) / share, poisson)
        socket = Material((1 - socket_poisson**2) / (1 - share), socket_poisson)
        joint = Joint(r2_star, ratio, ball, socket, DRIVES[drive], RIMS[rim])
        resolution = FINER if joint.series_applies else RESOLUTION
        resolution = COARSER if counts["r2_star"] > 1 else resolution
        found[*at, drive, rim] = _at_places(joint, *depths_and_forces(joint, DEEPEST, resolution))
    return found


def grid(counts: dict[str, int]) -> dict[str, NDArray[np.float64]]:
    """Values of the joint's coordinates in the table, at Chebyshev's places, by their names."""
    low, high = hertz_correction.RANGES["poisson"]
    limits: dict[str, tuple[float, float]] = {
        "share": (0, 1),
        "poisson": (np.log(1 - 1.8 * low), np.log(1 - 1.8 * high)),
        "socket_ratio": (np.log(1 - 1 / hertz_correction.RANGES["socket_ratio"][0]), -1 / THICK),
        "r2_star": (1 / LARGEST, 1 / hertz_correction.LEAST_R2_STAR),
    }
    limits["socket_poisson"] = limits["poisson"]
    values: dict[str, Callable] = {
        "share": np.square,
        "poisson": lambda x: (1 - np.exp(x)) / 1.8,
        "socket_poisson": lambda x: (1 - np.exp(x)) / 1.8,
        "socket_ratio": lambda x: 1 / (1 - np.exp(x)),
        "r2_star": lambda x: 1 / x,
    }
    found = {}
    for name, (least, most) in limits.items():
        share = (1 - np.cos(np.pi * np.arange(counts[name]) / max(counts[name] - 1, 1))) / 2
        found[name] = values[name](least + (most - least) * share)
    return found


def _at_places(joint, depth, force):
    """Ln S at `PLACES`, from the best polynomial in u for S - 1, which is 0 at u = 0."""
    factor, root = force / hertz(depth, joint.r2_star), np.sqrt(depth)
    powers = np.arange(1, len(hertz_correction.PLACES) + 1)
    terms = (root / (1 + root))[:, None] ** powers / factor[:, None]
    found = np.linalg.lstsq(terms, 1 - 1 / factor, rcond=None)[0]
    return np.log1p(hertz_correction.PLACES[:, None] ** powers @ found)


def table(
    limits: Sequence[NDArray[np.float64]], changes: Sequence[NDArray[np.float64]]
) -> pd.DataFrame:
    """Table of `study.contact.hertz_correction`: Chebyshev coefficients, without small ones.

    Both arguments are `logarithms` for each Poisson's ratio of the socket: on the grid of `LIMITS`,
    for infinite R2*, and on that of `CHANGES`, of which only the changes with R2* are used.
    """
    values = np.zeros((*(max(LIMITS[n], CHANGES[n]) for n in hertz_correction.DEGREES), 2, 2, 9))
    for part, counts in ((limits, LIMITS), (changes, CHANGES)):
        shape = [counts[name] for name in _ORDER]
        found = np.reshape(part, (*shape, 2, 2, 9)).transpose(2, 3, 0, 1, 4, 5, 6, 7)
        found = found - found[:, :, :, :, :1] if counts is CHANGES else found
        for axis, name in enumerate(hertz_correction.DEGREES):
            orders = np.arange(counts[name])
            at = np.cos(np.pi * np.outer(orders[::-1], orders) / max(orders[-1], 1))
            found = np.moveaxis(np.tensordot(np.linalg.inv(at), found, (1, axis)), 0, axis)
        values[tuple(slice(n) for n in found.shape)] += found
    values[..., 1, 1, :] -= values[..., 1, 0, :] + values[..., 0, 1, :] - values[..., 0, 0, :]
    values[..., 1, 0, :] -= values[..., 0, 0, :]
    values[..., 0, 1, :] -= values[..., 0, 0, :]
    kept = np.argwhere(np.abs(values).max(axis=-1) >= SMALLEST)
    names = [
        *hertz_correction.DEGREES,
        *hertz_correction.SUPPORTS,
        *(f"at_{k}" for k in range(1, 10)),
    ]
    whole = np.rint(values[tuple(kept.T)] / hertz_correction.UNIT).astype(int)
    rows = pd.DataFrame(np.hstack([kept, whole]), columns=names)
    first = [*hertz_correction.SUPPORTS, *hertz_correction.DEGREES]
    return rows.sort_values(first)[first + names[7:]]
