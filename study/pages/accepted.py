"""Results that were made, compared with those that are accepted: ``build/results``, ``figures``."""

import filecmp
from collections import Counter
from collections.abc import Iterable
from typing import Literal, NamedTuple

from study import paths
from study.checks import StudyError
from study.pages.catalogue import Result

State = Literal["identical", "agrees", "differs"]


class Comparison(NamedTuple):
    """State of a result that was made, compared with the accepted one.

    ``where`` says where its numbers differ, and ``drawn_differently`` whether its picture differs
    though its numbers are identical.
    """

    result: Result
    state: State
    where: str = ""
    drawn_differently: bool = False


def compare(results: Iterable[Result]) -> list[Comparison]:
    """Compare results that were made with the accepted ones, by their numbers.

    A figure is drawn from the table that is saved with it, so that pictures are not compared.
    """
    return [_compared(result) for result in results]


def summary(compared: list[Comparison]) -> str:
    """One line: how many results are identical, agree within the tolerances, and differ."""
    count = Counter(of.state for of in compared)
    numbers = f"{count['identical']} identical, {count['agrees']} agree, {count['differs']} differ"
    return f"{len(compared)} results: {numbers}"


def accept(results: Iterable[Result]) -> list[str]:
    """Copy results that were made to the accepted ones; return the names of the changed files.

    Raises `study.checks.StudyError`, before anything is copied, if a file was not made.
    """
    names = [name for result in results for name in result.files]
    for name in names:
        if not (made := paths.RESULTS / name).is_file():
            stem = name.partition(".")[0]
            raise StudyError(f"{paths.shown(made)} is missing; make it with: study run {stem}")
    changed = [name for name in names if not _same(name)]
    for name in changed:
        paths.copy(paths.RESULTS / name, paths.FIGURES / name)
    return changed


def _same(name):
    accepted = paths.FIGURES / name
    return accepted.is_file() and filecmp.cmp(accepted, paths.RESULTS / name, shallow=False)


def _compared(result):
    table, *picture = result.files
    accepted, made = paths.FIGURES / table, paths.RESULTS / table
    if _same(table):
        return Comparison(result, "identical", drawn_differently=not all(map(_same, picture)))
    if not accepted.is_file():
        return Comparison(result, "differs", f"{paths.shown(made)}: it was not accepted before")
    from study.dataset import compare

    try:
        where = compare.differs(accepted, made, result.name)
    except ValueError:  # of pandas, for a file that is no table
        both = f"{paths.shown(accepted)} and the new table cannot be compared"
        where = f"{both}: one is damaged (git checkout restores the first)"
    if where is None:
        return Comparison(result, "agrees")
    return Comparison(result, "differs", f"{paths.shown(made)}, {where}")
