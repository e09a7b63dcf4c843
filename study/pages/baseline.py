"""Results as made here beside the baseline: identical, agreeing, or different.

The baseline is the files in ``figures/``. Where every number agrees (`study.dataset.tolerance`)
they stay as they are; otherwise the new file replaces the one there, which is put aside in
``build/baseline``. A record there, one for each notebook, says how its files compared.
"""

import filecmp
import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Literal, NamedTuple, get_args

from study import paths, provenance
from study.pages.catalogue import Notebook

BASELINE = paths.BUILD / "baseline"
LEVELS = 8  # of 255: largest difference of two pixels that agree
State = Literal["identical", "agrees", "differs", "not made here"]
STATES: tuple[State, ...] = get_args(State)
"""``not made here``: there is no record."""
_PLURAL = {"agrees": "agree", "differs": "differ"}


class Comparison(NamedTuple):
    """State of a file as made here beside the baseline, and ``where`` they differ."""

    state: State
    where: str = ""
    sha256: str = ""  # of the file that was in ``figures/`` after the comparison


def take_over(folder: Path, notebook: Notebook) -> None:
    """Take over a notebook's results, which it made in a folder.

    Files that differ replace the baseline's.
    """
    last, compared = _recorded(notebook), {}
    for name in notebook.files():  # the numbers of a figure before its image
        made, aside, shown = folder / name, BASELINE / name, paths.FIGURES / name
        if aside.is_file() and _is_as_recorded(name, last):  # else it was put back by hand
            paths.copy(aside, shown)
        aside.unlink(missing_ok=True)
        if not shown.is_file():
            paths.copy(made, shown)
        state, where = _compare(shown, made, compared.get(f"{made.stem}.csv"))
        if state == "differs":
            paths.copy(shown, aside)
            paths.copy(made, shown)
        compared[name] = Comparison(state, where, provenance.sha256_of(shown))
    _record(notebook, compared)


def accept(notebook: Notebook) -> None:
    """Take a notebook's results, as they are in ``figures/``, for the baseline from now on."""
    compared = _recorded(notebook)
    for name in compared:
        sha256 = provenance.sha256_of(paths.FIGURES / name)
        compared[name] = Comparison("identical", sha256=sha256)
        (BASELINE / name).unlink(missing_ok=True)
    _record(notebook, compared)


def compare(notebooks: Sequence[Notebook]) -> list[Comparison]:
    """How the results of notebooks, as made last, compare with the baseline: their worst files."""
    return [
        max(
            (_as_shown(name, _recorded(notebook)) for name in result.files),
            key=lambda file: STATES.index(file.state),
        )
        for notebook in notebooks
        for result in notebook.results.values()
    ]


def summary(comparisons: list[Comparison]) -> str:
    """One line: number of results that are identical, agree, differ, or have another state."""
    counts = Counter(comparison.state for comparison in comparisons)
    shown = [state for state in STATES if counts[state] or state in STATES[:3]]
    counted = [f"{counts[state]} {_PLURAL.get(state, state)}" for state in shown]
    return f"{len(comparisons)} results: {', '.join(counted)}"


def _record(notebook, compared):
    """Keep how a notebook's files compared."""
    with paths.whole(BASELINE / f"{notebook.name}.compared.json") as record:
        record.write_text(json.dumps(compared), encoding="utf-8")


def _recorded(notebook):
    """Comparison by file; empty if not made here."""
    record = BASELINE / f"{notebook.name}.compared.json"
    compared = json.loads(record.read_text(encoding="utf-8")) if record.is_file() else {}
    return {name: Comparison(*fields) for name, fields in compared.items()}


def _is_as_recorded(name, compared):
    """Whether a file in ``figures/`` is the one that was there after the last comparison."""
    return name in compared and provenance.sha256_of(paths.FIGURES / name) == compared[name].sha256


def _as_shown(name, compared):
    """Comparison of one file as it is in ``figures/``."""
    if name not in compared:
        return Comparison("not made here")
    if not _is_as_recorded(name, compared):
        return Comparison("differs", f"figures/{name}, changed since it was made here")
    return compared[name]


def _compare(before, made, numbers):
    """State of a file, and where it differs; ``numbers``: comparison of those an image shows."""
    if filecmp.cmp(before, made, shallow=False):
        return "identical", ""
    try:
        if made.suffix == ".csv":
            from study.dataset.tolerance import table_differs

            where = table_differs(before, made)
        else:
            where = _pixels(before, made, numbers.state)
    except (OSError, SyntaxError, ValueError):  # Pillow and pandas tell damage by any of them
        where = "the kept file was damaged"
    return ("differs", f"figures/{made.name}, {where}") if where else ("agrees", "")


def _pixels(before, made, numbers):
    """Where two images differ too much to agree, or None.

    With the same numbers, every pixel must be the same. If the numbers only agree, a line may have
    moved by less than a pixel: a pixel must be within the range of its neighbours.
    """
    import numpy as np
    from matplotlib.image import imread
    from scipy.ndimage import maximum_filter, minimum_filter

    old, new = (np.round(255 * imread(path)) for path in (before, made))
    if old.shape != new.shape:
        return f"size: kept {old.shape[1]} x {old.shape[0]}, now {new.shape[1]} x {new.shape[0]}"
    if numbers == "differs":
        return "because its numbers differ"
    around = (1, 1, 1) if numbers == "identical" else (3, 3, 1)
    outside = [
        off
        for this, other in ((old, new), (new, old))
        for off in (minimum_filter(this, around) - other, other - maximum_filter(this, around))
    ]
    count = np.count_nonzero(np.max(outside, axis=(0, 3)) > LEVELS)
    return f"{count} pixels differ" if count else None
