"""Make the generated tables of the dataset, as the Snakefile asks.

``python data/build.py part TABLE PART FILE`` solves one part of a table and writes it to a file.
``python data/build.py table TABLE FILE ...`` joins such files and the stored rows of other cases,
and writes the table, unless it agrees with the stored one. ``python data/build.py hash FILE ...``
renews the hashes of files that were edited by hand.
"""

import json
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any

import pandas as pd

from study import paths
from study.contact import stiffening
from study.dataset import cached, design, fitting, stiffening_fit, store
from study.pages.build import be_job

SOLUTIONS_AT_ONCE = 24


def no_parts(everything: bool) -> dict[str, Any]:
    """Parts of a table that is computed at once."""
    return {}


@dataclass(frozen=True)
class Generated:
    """A generated table, or two that are written together.

    ``parts`` gives the parts by name: of all cases, or of those that are not stored. ``solve``
    makes the rows of a part, and ``write`` writes the table from the rows of parts by name. A table
    is made ``after`` others that it reads. Only with ``--all`` are those made that are not
    ``extensible``.
    """

    write: Callable[[dict[str, pd.DataFrame]], Any]
    parts: Callable[[bool], dict[str, Any]] = no_parts
    solve: Callable[[Any], pd.DataFrame] = pd.DataFrame
    after: tuple[str, ...] = ()
    extensible: bool = False


def named(batches: Iterable[Sequence[Any]], names: Callable[[Any], str]) -> dict[str, Any]:
    """Batches of cases by a name that follows from those of the cases."""
    return {paths.digest([], [names(case) for case in batch]): batch for batch in batches}


def curve_parts(everything: bool) -> dict[str, list[design.Case]]:
    """Batches of cases of the design."""
    stored = store.read(store.CURVES).case.value_counts()
    cases = design.every_case()
    if not everything:
        cases = [case for case in cases if stored.get(case.name) != len(case.depths)]
    return named(design.batches(cases), attrgetter("name"))


def write_cases(path: Path, names: list[str], made: dict[str, pd.DataFrame]) -> None:
    """Write the rows of some cases in their order: those just solved, and the stored others."""
    stored = store.read(path)
    solved = pd.concat([stored[:0], *made.values()])
    by_case = dict(iter(stored.groupby("case"))) | dict(iter(solved.groupby("case")))
    store.write_table(pd.concat([by_case[name] for name in names]), path)


def write_curves(made: dict[str, pd.DataFrame]) -> None:
    """Write the curves of the design."""
    write_cases(store.CURVES, [case.name for case in design.every_case()], made)


def solution_parts(kind: str, everything: bool) -> dict[str, list[cached.Request]]:
    """Batches of the cases of a kind."""
    stored = set() if everything else set(store.read(store.SOLUTIONS[kind]).case)
    cases = [case for case in cached.requests() if case.kind == kind and case.name not in stored]
    starts = range(0, len(cases), SOLUTIONS_AT_ONCE)
    batches = [cases[start : start + SOLUTIONS_AT_ONCE] for start in starts]
    return named(batches, attrgetter("name"))


def write_solutions(kind: str, made: dict[str, pd.DataFrame]) -> None:
    """Write the solutions of a kind."""
    names = [case.name for case in cached.requests() if case.kind == kind]
    write_cases(store.SOLUTIONS[kind], names, made)


def stiffening_parts(everything: bool) -> dict[str, tuple[float, dict[str, int]]]:
    """Poisson's ratios of the socket, on the grid of the limit and on that of the changes."""
    grids = {"limit": stiffening_fit.LIMITS, "change": stiffening_fit.CHANGES}
    return {
        f"{name}-{k}": (float(nu), counts)
        for name, counts in grids.items()
        for k, nu in enumerate(stiffening_fit.grid(counts)["socket_poisson"])
    }


def write_stiffening(made: dict[str, pd.DataFrame]) -> None:
    """Write the table of `study.contact.stiffened_hertz`."""
    limits, changes = (
        [rows.to_numpy() for name, rows in made.items() if name.startswith(grid)]
        for grid in ("limit", "change")
    )
    write_coefficients(stiffening_fit.table(limits, changes), store.TABLE)


def write_coefficients(table: pd.DataFrame, path: Path) -> None:
    """Write a table of Chebyshev coefficients, unless it agrees with the stored one.

    On another processor a number may differ by one unit, and a number at the limit below which it
    is left out by two units.
    """
    keys = list(table.columns[: -len(stiffening.PLACES)])
    stored = pd.read_csv(path).set_index(keys)
    if stored.sub(table.set_index(keys), fill_value=0).abs().to_numpy().max() > 2:
        with paths.whole(path) as temporary:
            table.to_csv(temporary, index=False, lineterminator="\n")
        store.write_hashes([path])


def write_laws(made: dict[str, pd.DataFrame]) -> None:
    """Fit the laws to the curves, and compute their costs from the measured times."""
    coefficients = fitting.fit_laws(store.load(), store.read(store.TABLES))
    laws = store.measured("laws")
    laws = laws[laws.program == "ours"]  # without the closed form, which no function offers
    costs = dict(zip(laws.method, laws.relative, strict=True))
    for path, values in {store.COEFFICIENTS: coefficients, store.RELATIVE_COSTS: costs}.items():
        with paths.whole(path) as temporary:
            temporary.write_text(json.dumps(values, indent=2) + "\n", encoding="utf-8")
        store.write_hashes([path])


def as_frame(function: Callable, *given: Any) -> pd.DataFrame:
    """Values of a function at the places of a table of coefficients, one joint for each row."""
    return pd.DataFrame(function(*given).reshape(-1, len(stiffening.PLACES)))


TABLES = {
    "curves": Generated(
        write_curves,
        curve_parts,
        lambda cases: pd.concat(map(design.solve, cases)),
        extensible=True,
    ),
    "laws": Generated(write_laws, after=("curves",), extensible=True),
    "stiffening": Generated(
        write_stiffening, stiffening_parts, lambda of: as_frame(stiffening_fit.logarithms, *of)
    ),
    **{
        f"{kind}_solutions": Generated(
            partial(write_solutions, kind),
            partial(solution_parts, kind),
            lambda cases: pd.concat(map(cached.solve, cases)),
            extensible=True,
        )
        for kind in store.SOLUTIONS
    },
}
"""Generated tables by name, the longest first."""


def main(action: str, name: str, *words: str) -> None:
    """Solve a part of a table, write a table from the files of its parts, or renew hashes."""
    if action == "hash":
        store.write_hashes(Path(file).resolve() for file in (name, *words))
        return
    table = TABLES[name]
    if action == "part":
        part, file = words
        with paths.whole(Path(file)) as temporary:
            parts = table.parts(True) | table.parts(False)
            table.solve(parts[part]).to_csv(temporary, index=False)
    else:
        files = {Path(file).stem: file for file in words}
        table.write({k: pd.read_csv(file, dtype={"case": str}) for k, file in files.items()})


if __name__ == "__main__":
    action, table, *words = sys.argv[1:]
    name = f"{action} {words[0]} of {table}" if action == "part" else f"{action} {table}"
    be_job(name, partial(main, action, table, *words))
