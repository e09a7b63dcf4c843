"""Results as made here beside the baseline: identical, agreeing, or different.

The baseline is the files in ``figures/``. Where every number agrees (`study.dataset.tolerance`)
they stay as they are; otherwise the new file replaces the one there. The last files made are in
``build/made``, and files of the baseline that were replaced in ``build/baseline``.
"""

import filecmp
import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

from study import paths, provenance
from study.pages.catalogue import Notebook

MADE, REPLACED = paths.BUILD / "made", paths.BUILD / "baseline"
LEVELS = 8  # of 255: largest difference of two pixels that agree
State = Literal["identical", "agrees", "differs", "new", "other parameters", "not made here"]
STATES: tuple[State, ...] = get_args(State)
"""``new``: there was none to compare with. ``other parameters``: not to be compared."""
_RULES = (Path(__file__), Path(__file__).parents[1] / "dataset/tolerance.py")
_PLURAL = {"agrees": "agree", "differs": "differ"}


class Comparison(NamedTuple):
    """State of a result as made here beside the baseline, and ``where`` they differ."""

    state: State
    where: str = ""


def take_over(folder: Path, notebook: Notebook, settings: Mapping[str, Any]) -> None:
    """Take over a notebook's results, which it made in a folder with some settings.

    Files that differ replace the baseline's.
    """
    paths.FIGURES.mkdir(exist_ok=True)
    with paths.whole(_record(notebook)) as record:
        record.write_text(json.dumps(settings), encoding="utf-8")
    for name in notebook.files():  # the numbers of a figure before its image
        new, before = folder / name, _file(name)
        aside, shown = REPLACED / name, paths.FIGURES / name
        state, _ = _compare(name, before, new)
        if state in ("identical", "agrees"):
            if before == aside:
                paths.copy(aside, shown)
            aside.unlink(missing_ok=True)
        else:
            if before != aside and shown.is_file():
                paths.copy(shown, aside)
            paths.copy(new, shown)
        paths.copy(new, MADE / name)


def accept(notebook: Notebook) -> None:
    """Take a notebook's results as made last for the baseline from now on."""
    for name in notebook.files():
        (REPLACED / name).unlink(missing_ok=True)


def compare(notebooks: Sequence[Notebook]) -> list[Comparison]:
    """Compare the results of notebooks, as made last, with the baseline."""
    return [
        _compare_result(result, bool(_made_with(notebook)))
        for notebook in notebooks
        for result in notebook.results.values()
    ]


def shown_with(notebook: Notebook) -> str:
    """Parameters, other than the defaults, with which its results in ``figures/`` were made."""
    settings = _made_with(notebook)
    shown = settings and any(map(_is_as_made, notebook.files()))
    return ", ".join(f"{key}={value}" for key, value in settings.items()) if shown else ""


def summary(comparisons: list[Comparison]) -> str:
    """One line: number of results that are identical, agree, differ, or have another state."""
    counts = Counter(comparison.state for comparison in comparisons)
    shown = [state for state in STATES if counts[state] or state in STATES[:3]]
    counted = [f"{counts[state]} {_PLURAL.get(state, state)}" for state in shown]
    return f"{len(comparisons)} results: {', '.join(counted)}"


def _record(notebook):
    return MADE / f"{notebook.name}.json"


def _made_with(notebook):
    """Parameters, other than the defaults, with which its results in ``build/made`` were made."""
    record = _record(notebook)
    return json.loads(record.read_text(encoding="utf-8")) if record.is_file() else {}


def _is_as_made(name):
    """Whether a file in ``figures/`` is the one that was made last."""
    shown, made = paths.FIGURES / name, MADE / name
    return shown.is_file() and made.is_file() and filecmp.cmp(made, shown, shallow=False)


def _file(name):
    """A file of the baseline: the one set aside, as long as ``figures/`` has what replaced it."""
    aside = REPLACED / name
    return aside if aside.is_file() and _is_as_made(name) else paths.FIGURES / name


def _compare_result(result, other_parameters):
    """Worst state of a result's files."""
    files = [_compare(name, _file(name), MADE / name) for name in result.files]
    state, where = max(files, key=lambda file: STATES.index(file[0]))
    if other_parameters and state in ("agrees", "differs"):
        return Comparison("other parameters")
    return Comparison(state, where)


def _compare(name, before, made):
    """State of one file, and where it differs."""
    if not made.is_file():
        return "not made here", ""
    if not before.is_file():
        return "new", ""
    if filecmp.cmp(before, made, shallow=False):
        return "identical", ""
    numbers = ""
    if made.suffix == ".png":
        table = f"{made.stem}.csv"
        numbers, _ = _compare(table, _file(table), MADE / table)
    where = _difference(before, made, numbers)
    return ("differs", f"figures/{name}, {where}") if where else ("agrees", "")


def _difference(before, made, numbers):
    """Where two files differ too much to agree, or None; it is looked for once.

    The answer is kept beside the files made, with the hashes of what decides it, as every later run
    asks again and pixels take long. ``numbers`` is the state of the numbers that an image shows.
    """
    record = MADE / f"{made.name}.json"
    of = [*(provenance.sha256(path.read_bytes()) for path in (before, made, *_RULES)), numbers]
    if record.is_file():
        compared = json.loads(record.read_text(encoding="utf-8"))
        if compared["of"] == of:
            return compared["where"]
    if made.suffix == ".csv":
        from study.dataset.tolerance import table_differs

        where = table_differs(before, made)
    else:
        where = _pixels(before, made, numbers)
    with paths.whole(record) as temporary:
        temporary.write_text(json.dumps({"of": of, "where": where}), encoding="utf-8")
    return where


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
