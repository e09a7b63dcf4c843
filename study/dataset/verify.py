"""Results as made here beside the kept ones: identical, agreeing, or different.

The kept results are the files in ``figures/``. On another processor the last digits of a number
differ, so that a run compares: where every number agrees within `TOLERANCE` the kept file stays
as it is, and where one does not the new file takes its place. What was made last lies in
``build/made``, and a kept file that has been replaced in ``build/kept``.
"""

import filecmp
from dataclasses import dataclass

import numpy as np
import pandas as pd

from study import paths

MADE, KEPT = paths.BUILD / "made", paths.BUILD / "kept"
TOLERANCE = 1e-6
"""Largest difference of two numbers that agree, relative to the larger."""
ROUNDING = 1e-12
"""Added to it: rounding of differences between numbers of size 1."""
CHAOTIC = (
    *("fig17", "fig18", "fig19", "fig20", "fig21", "first_impacts", "impacts", "persistence"),
    *("variants", "durations", "agreement", "convergence", "choice_mechanism"),
    "links",
)
"""Results of simulated impacts, each of which enlarges the rounding of the one before."""
CHAOTIC_TOLERANCE = 1e-3
"""Instead of `TOLERANCE` there, and as share of the column's largest number times 1/1000."""
DIGITS = {
    "stability_steps": {"y": 3},
    "stability_impacts": {"y": 3},
    "stability_contact": {"y": 3},
    "force_curves": {"error_estimate": 3, "contact_half_angle": 5},
}
"""Columns that are written with fewer digits: one unit of the last agrees."""
LEVELS = 8
"""Largest difference of two pixels that agree, of 255 levels."""


@dataclass(frozen=True)
class Comparison:
    """A result as made here beside the kept one.

    Attributes
    ----------
    name : str
        Of the figure or table.
    state : str
        One of `STATES`.
    where : str
        For one that differs: file, row, column, kept and new value.
    """

    name: str
    state: str
    where: str = ""


STATES = ("identical", "agrees", "differs", "new", "other parameters", "not made here")
"""``new``: there was none to compare with. ``other parameters``: not to be compared."""
_WORDS = {"agrees": "agree", "differs": "differ"}  # of more than one


def files(name, is_figure):
    """File names of a result: its numbers first, then its image if it is a figure."""
    return [f"{name}.csv", *([f"{name}.png"] if is_figure else [])]


def place(folder, names):
    """Take over files that were made: those that differ from the kept ones replace them.

    Parameters
    ----------
    folder : pathlib.Path
        Where they were made.
    names : list of str
        File names, the CSV of a figure before its image.
    """
    paths.FIGURES.mkdir(exist_ok=True)
    for name in names:
        new, kept, aside, shown = folder / name, _kept(name), KEPT / name, paths.FIGURES / name
        state, _ = _compare(name, kept, new)
        if state in ("identical", "agrees"):
            if kept == aside:
                paths.copy(aside, shown)
            aside.unlink(missing_ok=True)
            paths.copy(new, MADE / name)
            continue
        if kept != aside and shown.is_file():
            paths.copy(shown, aside)
        paths.copy(new, MADE / name)
        paths.copy(new, shown)


def keep(names):
    """Take what was made as the kept files from now on."""
    for name in names:
        (KEPT / name).unlink(missing_ok=True)


def compare(name, is_figure, other_parameters=False):
    """Compare a result as made last with the kept one; runs nothing.

    Parameters
    ----------
    name : str
        Of a figure or table.
    is_figure : bool
        Whether it has an image.
    other_parameters : bool
        Whether it was made with parameters that are not the notebook's own.

    Returns
    -------
    Comparison
    """
    found = []
    for file in files(name, is_figure):
        if not (MADE / file).is_file():
            found.append(("not made here", ""))
        else:
            found.append(_compare(file, _kept(file), MADE / file))
    state, where = max(found, key=lambda each: STATES.index(each[0]))
    if other_parameters and state in ("agrees", "differs"):
        return Comparison(name, "other parameters")
    return Comparison(name, state, where)


def summary(comparisons):
    """One line: how many results are identical, agree and differ, and more if there are others.

    Parameters
    ----------
    comparisons : list of Comparison

    Returns
    -------
    str
    """
    counts = {state: sum(c.state == state for c in comparisons) for state in STATES}
    told = [
        f"{count} {_WORDS.get(state, state)}"
        for state, count in counts.items()
        if count or state in STATES[:3]
    ]
    return f"{len(comparisons)} results: {', '.join(told)}"


def _kept(name):
    """The kept file: the one set aside, as long as ``figures/`` holds what a run put there."""
    shown, made, aside = paths.FIGURES / name, MADE / name, KEPT / name
    replaced = aside.is_file() and made.is_file() and shown.is_file()
    return aside if replaced and filecmp.cmp(made, shown, shallow=False) else shown


def _compare(name, kept, made):
    """State of one file, and where it differs."""
    if not kept.is_file():
        return "new", ""
    if filecmp.cmp(kept, made, shallow=False):
        return "identical", ""
    where = table_differs(kept, made) if made.suffix == ".csv" else _pixels(name, kept, made)
    return ("differs", f"figures/{name}, {where}") if where else ("agrees", "")


def table_differs(kept, made):
    """Where two tables of one name differ by more than agrees, or None.

    Parameters
    ----------
    kept, made : pathlib.Path
        CSV files; the name of ``kept`` tells the tolerance.

    Returns
    -------
    str or None
        Row, column, kept and new value, and how many differ.
    """
    result = kept.stem
    kept, made = (pd.read_csv(path, dtype=str, keep_default_na=False) for path in (kept, made))
    if list(kept) != list(made):
        return f"columns: kept {', '.join(kept)}; now {', '.join(made)}"
    if len(kept) != len(made):
        return f"rows: kept {len(kept)}, now {len(made)}"
    off, worst = 0, (0.0, "")
    for column in kept:
        old, new = kept[column], made[column]
        excess = _excess(old, new, result, column)
        off += np.count_nonzero(excess > 1)
        if excess.size and excess.max() > max(worst[0], 1):
            row = int(excess.argmax())
            text = f"row {row + 2}, column {column}: kept {old[row]}, now {new[row]}"
            worst = excess.max(), text
    return f"{worst[1]} ({off} in all)" if off else None


def _excess(old, new, result, column):
    """Differences of two columns in units of what agrees; infinite where text differs."""
    changed = (old != new).to_numpy()
    excess = np.where(changed, np.inf, 0.0)
    numbers = [pd.to_numeric(values, errors="coerce").to_numpy(float) for values in (old, new)]
    both = changed & np.isfinite(numbers).all(axis=0)
    if both.any():
        size = np.nanmax(np.abs(numbers), axis=0)
        limit = ROUNDING + TOLERANCE * size
        if result in CHAOTIC:
            limit = CHAOTIC_TOLERANCE * (size + 1e-3 * np.nanmax(size))
        if digits := DIGITS.get(result, {}).get(column):
            limit = limit + 10.0 ** (np.floor(np.log10(np.maximum(size, ROUNDING))) + 1 - digits)
        excess[both] = (np.abs(numbers[0] - numbers[1]) / limit)[both]
    return excess


def _pixels(name, kept, made):
    """Where two images differ by more than agrees, or None.

    If the numbers beside them are the same, every pixel must be; if they only agree, a line may
    have moved by less than a pixel, so that a pixel must be within the range of its neighbours.
    """
    from matplotlib.image import imread
    from scipy.ndimage import maximum_filter, minimum_filter

    old, new = (np.round(255 * imread(path)) for path in (kept, made))
    if old.shape != new.shape:
        return f"size: kept {old.shape[1]} x {old.shape[0]}, now {new.shape[1]} x {new.shape[0]}"
    table = f"{name.removesuffix('.png')}.csv"
    numbers, _ = _compare(table, _kept(table), MADE / table)
    if numbers == "differs":
        return "for its numbers do"
    around = (1, 1, 1) if numbers == "identical" else (3, 3, 1)
    outside = np.zeros(old.shape)
    for one, other in ((old, new), (new, old)):
        for off in (minimum_filter(one, around) - other, other - maximum_filter(one, around)):
            outside = np.maximum(outside, off)
    count = np.count_nonzero(outside.max(axis=2) > LEVELS)
    return f"{count} pixels differ" if count else None
