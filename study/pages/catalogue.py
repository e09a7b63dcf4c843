"""The catalogue of the notebooks, ``notebooks/catalogue.toml``: what each makes; selection."""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from study import paths, provenance
from study.checks import StudyError
from study.claims import verdicts
from study.pages import baseline


@dataclass(frozen=True)
class Notebook:
    """A notebook and the results it makes.

    Attributes
    ----------
    name
        File name without suffix.
    figures, tables
        Name of each figure and table -> what it shows.
    tells
        Name of each figure -> its conclusion, in one sentence without numbers.
    expect
        Name of a result -> the number of it to expect: ``column at key = value, ...``, with the
        keys of one row. Without one it is the number of rows.
    reads
        Results of other notebooks whose numbers it reads.
    long
        Whether it takes longer than most, so that it begins first.
    """

    name: str
    figures: dict[str, str] = field(default_factory=dict)
    tables: dict[str, str] = field(default_factory=dict)
    tells: dict[str, str] = field(default_factory=dict)
    expect: dict[str, str] = field(default_factory=dict)
    reads: list[str] = field(default_factory=list)
    long: bool = False

    @property
    def path(self) -> Path:
        """Where the notebook is."""
        return paths.NOTEBOOKS / f"{self.name}.ipynb"

    @property
    def executed(self) -> Path:
        """Where the executed copy goes."""
        return paths.BUILD / "notebooks" / f"{self.name}.ipynb"

    @property
    def results(self) -> dict[str, str]:
        """Name of every figure and table -> what it shows."""
        return self.figures | self.tables

    def files(self) -> list[str]:
        """File names of its results: a CSV each, and a PNG for a figure."""
        return [
            file for name in self.results for file in baseline.files(name, name in self.figures)
        ]

    def products(self) -> list[Path]:
        """Files it makes: those of its results, and its executed copy."""
        return [*(paths.FIGURES / name for name in self.files()), self.executed]

    def inputs(self) -> list[Path]:
        """Files it depends on: itself, the code it reaches by imports, and what they read."""
        read = [paths.FIGURES / f"{name}.csv" for name in self.reads]
        return [*provenance.inputs(self.path), *read]


FILE = paths.NOTEBOOKS / "catalogue.toml"
_ENTRIES = tomllib.loads(FILE.read_text(encoding="utf-8")) if paths.IS_CHECKOUT else {}


def notebook(name: str, entry: dict[str, Any]) -> Notebook:
    """A notebook from its entry in the catalogue.

    Raises
    ------
    study.checks.StudyError
        For an unknown key, or what is said of a result that the notebook does not make.
    """
    known = [one.name for one in fields(Notebook)[1:]]
    for key in entry:
        if key not in known:
            listed = ", ".join(known)
            raise StudyError(f"catalogue.toml: {name} must have keys of {listed}, got {key!r}")
    found = Notebook(name, **entry)
    for result in (*found.tells, *found.expect):
        if result not in found.results:
            raise StudyError(f"catalogue.toml: {name} makes no result {result!r}")
    return found


CATALOGUE = tuple(notebook(name, entry) for name, entry in _ENTRIES.items())


def select(names: Sequence[str]) -> list[Notebook]:
    """Notebooks by their own names or those of results, in the catalogue's order; all for no name.

    Raises
    ------
    ValueError
        For an unknown name; the message has the nearest known one.
    """
    paths.require_checkout(paths.NOTEBOOKS)
    known = [name for nb in CATALOGUE for name in (nb.name, *nb.results)]
    for name in names:
        if name not in known:
            near = " or ".join(_nearest(name, known))
            hint = f": did you mean {near}?" if near else ""
            raise ValueError(f"NAME must be one that `study list` shows, got {name!r}{hint}")
    return [nb for nb in CATALOGUE if not names or {nb.name, *nb.results} & set(names)]


def _nearest(name, known):
    """Known names that a text may mean: "Figure 14", "fig 14", "Table2", "14", "fgi14"."""
    plain = {re.sub(r"[\W_]", "", one): one for one in known}
    asked = re.sub(r"[\W_]", "", name.lower().replace("figure", "fig"))
    number = re.sub(r"(?<!\d)(\d)$", r"0\1", asked)
    if number.isdecimal():
        return [one for one in known if one.startswith(f"{number}-") or one == f"fig{number}"]
    exact = [plain[text] for text in (asked, number) if text in plain]
    return exact[:1] or [plain[text] for text in get_close_matches(asked, plain, 1)]


def check_claims() -> None:
    """Refuse wrong rows of ``data/published/claims.csv``, before anything runs for minutes.

    Raises
    ------
    study.claims.verdicts.ClaimError
        As for `study.claims.verdicts.load`, or for a figure or evidence that no notebook makes.
    """
    results = [name for notebook in CATALOGUE for name in notebook.results]
    for row in verdicts.load().itertuples():
        for name in (row.figure, *row.evidence.split()):
            if name not in results:
                raise verdicts.ClaimError(f"claim {row.claim}: no notebook makes {name!r}")
