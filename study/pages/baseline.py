"""Results as made here compared with the kept ones: identical, agreeing, or different.

The kept results are the files in ``figures/``. Where every number agrees
(`study.dataset.tolerance`) they stay as they are; otherwise the new file replaces the kept one, and
``git diff`` shows what changed. A further file says how the results of a notebook compared.
"""

import filecmp
import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Literal, NamedTuple, get_args

from study import paths
from study.pages.catalogue import Notebook

LEVELS = 8  # of 255: largest difference of two pixels that agree
State = Literal["identical", "agrees", "differs"]
STATES: tuple[State, ...] = get_args(State)
_PLURAL = {"agrees": "agree", "differs": "differ"}


class Comparison(NamedTuple):
    """State of a file as made here compared with the kept one, and ``where`` they differ."""

    state: State
    where: str = ""


def take_over(folder: Path, notebook: Notebook) -> None:
    """Take over a notebook's results, which it made in a folder.

    Files that differ replace the kept ones.
    """
    compared = {}
    for name in notebook.files():  # the numbers of a figure before its image
        made, kept = folder / name, paths.FIGURES / name
        if not kept.is_file():
            paths.copy(made, kept)
        compared[name] = _compare(kept, made, compared.get(f"{made.stem}.csv"))
        if compared[name].state == "differs":
            paths.copy(made, kept)
    with paths.whole(notebook.compared) as temporary:
        temporary.write_text(json.dumps(compared), encoding="utf-8")


def compare(notebooks: Sequence[Notebook]) -> list[Comparison]:
    """How the results of notebooks that are up to date compare: their worst files."""
    found = []
    for notebook in notebooks:
        files = json.loads(notebook.compared.read_text(encoding="utf-8"))
        for result in notebook.results.values():
            of_result = [Comparison(*files[name]) for name in result.files]
            found.append(max(of_result, key=lambda file: STATES.index(file.state)))
    return found


def summary(comparisons: list[Comparison]) -> str:
    """One line: number of results that are identical, agree, or differ."""
    counts = Counter(comparison.state for comparison in comparisons)
    counted = [f"{counts[state]} {_PLURAL.get(state, state)}" for state in STATES]
    return f"{len(comparisons)} results: {', '.join(counted)}"


def _compare(before, made, numbers):
    """Comparison of a file; ``numbers``: that of those an image shows."""
    if filecmp.cmp(before, made, shallow=False):
        return Comparison("identical")
    try:
        if made.suffix == ".csv":
            from study.dataset.tolerance import table_differs

            where = table_differs(before, made)
        else:
            where = _pixels(before, made, numbers.state)
    except (OSError, SyntaxError, ValueError):  # Pillow and pandas tell damage by any of them
        where = "the kept file was damaged"
    return Comparison("differs", f"figures/{made.name}, {where}") if where else Comparison("agrees")


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
