"""Results as made here beside the kept ones: identical, agreeing, or different.

The kept results are the files in ``figures/``. Where every number agrees
(`study.dataset.tolerance`) the kept file stays as it is; otherwise the new file replaces it. The
last files made are in ``build/made``, and replaced kept files in ``build/kept``.
"""

import filecmp
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from study import paths
from study.dataset.tolerance import table_differs

MADE, KEPT = paths.BUILD / "made", paths.BUILD / "kept"
LEVELS = 8  # of 255: largest difference of two pixels that agree
State = Literal["identical", "agrees", "differs", "new", "other parameters", "not made here"]
STATES: tuple[State, ...] = get_args(State)
"""``new``: there was none to compare with. ``other parameters``: not to be compared."""
_PLURAL = {"agrees": "agree", "differs": "differ"}


@dataclass(frozen=True)
class Comparison:
    """A result as made here beside the kept one, and ``where`` they differ."""

    name: str
    state: State
    where: str = ""


def files(name: str, is_figure: bool) -> list[str]:
    """File names of a result: its numbers first, then its image if it is a figure."""
    return [f"{name}.csv", *([f"{name}.png"] if is_figure else [])]


def place(folder: Path, names: Iterable[str]) -> None:
    """Take over files made in a folder; those that differ replace the kept ones.

    The CSV of a figure is named before its image.
    """
    paths.FIGURES.mkdir(exist_ok=True)
    for name in names:
        new, kept, aside, shown = folder / name, _kept(name), KEPT / name, paths.FIGURES / name
        state, _ = _compare(name, kept, new)
        if state in ("identical", "agrees"):
            if kept == aside:
                paths.copy(aside, shown)
            aside.unlink(missing_ok=True)
        else:
            if kept != aside and shown.is_file():
                paths.copy(shown, aside)
            paths.copy(new, shown)
        paths.copy(new, MADE / name)


def accept(names: Iterable[str]) -> None:
    """Keep the files as made last from now on."""
    for name in names:
        (KEPT / name).unlink(missing_ok=True)


def compare(name: str, is_figure: bool, other_parameters: bool = False) -> Comparison:
    """Compare a result as made last, perhaps with other parameters, with the kept one."""
    found = [_compare(file, _kept(file), MADE / file) for file in files(name, is_figure)]
    state, where = max(found, key=lambda one: STATES.index(one[0]))
    if other_parameters and state in ("agrees", "differs"):
        return Comparison(name, "other parameters")
    return Comparison(name, state, where)


def is_as_made(name: str) -> bool:
    """Whether a file in ``figures/`` is the one that was made last."""
    shown, made = paths.FIGURES / name, MADE / name
    return shown.is_file() and made.is_file() and filecmp.cmp(made, shown, shallow=False)


def summary(comparisons: list[Comparison]) -> str:
    """One line: number of results that are identical, agree, differ, or have another state."""
    counts = Counter(comparison.state for comparison in comparisons)
    shown = [state for state in STATES if counts[state] or state in STATES[:3]]
    told = [f"{counts[state]} {_PLURAL.get(state, state)}" for state in shown]
    return f"{len(comparisons)} results: {', '.join(told)}"


def _kept(name):
    """The kept file: the one set aside, as long as ``figures/`` holds what a run put there."""
    aside = KEPT / name
    return aside if aside.is_file() and is_as_made(name) else paths.FIGURES / name


def _compare(name, kept, made):
    """State of one file, and where it differs."""
    if not made.is_file():
        return "not made here", ""
    if not kept.is_file():
        return "new", ""
    if filecmp.cmp(kept, made, shallow=False):
        return "identical", ""
    where = table_differs(kept, made) if made.suffix == ".csv" else _pixels(name, kept, made)
    return ("differs", f"figures/{name}, {where}") if where else ("agrees", "")


def _pixels(name, kept, made):
    """Where two images differ too much to agree, or None.

    With the same numbers, every pixel must be the same. If the numbers only agree, a line may have
    moved by less than a pixel: a pixel must be within the range of its neighbours.
    """
    from matplotlib.image import imread
    from scipy.ndimage import maximum_filter, minimum_filter

    old, new = (np.round(255 * imread(path)) for path in (kept, made))
    if old.shape != new.shape:
        return f"size: kept {old.shape[1]} x {old.shape[0]}, now {new.shape[1]} x {new.shape[0]}"
    table = f"{name.removesuffix('.png')}.csv"
    numbers, _ = _compare(table, _kept(table), MADE / table)
    if numbers == "differs":
        return "because its numbers differ"
    around = (1, 1, 1) if numbers == "identical" else (3, 3, 1)
    outside = [
        off
        for one, other in ((old, new), (new, old))
        for off in (minimum_filter(one, around) - other, other - maximum_filter(one, around))
    ]
    count = np.count_nonzero(np.max(outside, axis=(0, 3)) > LEVELS)
    return f"{count} pixels differ" if count else None
