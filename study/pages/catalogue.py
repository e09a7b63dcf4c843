"""The catalogue, ``notebooks/catalogue.toml``: every notebook and the results it makes."""

import csv
import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from study import paths
from study.checks import StudyError

FILE = paths.NOTEBOOKS / "catalogue.toml"


@dataclass(frozen=True)
class Result:
    """A figure, which has an image, or a table; both have their numbers as CSV.

    ``name`` is that of its files, without suffix, ``notebook`` that of the notebook that makes it.
    ``tells`` is the conclusion from a figure, in one sentence without numbers; a table has none.
    ``expect`` names the number to expect, as ``column at key = value, ...`` with the keys of one
    row. Without one it is the number of rows.
    """

    name: str
    notebook: str
    shows: str
    tells: str = ""
    expect: str = ""

    @property
    def is_figure(self) -> bool:
        """Whether it has an image."""
        return bool(self.tells)

    @property
    def files(self) -> list[str]:
        """Names of its files: its numbers first, then its image."""
        return [f"{self.name}.csv", *([f"{self.name}.png"] if self.is_figure else [])]

    @property
    def is_made(self) -> bool:
        """Whether its files are in ``build/results``."""
        return all((paths.RESULTS / name).is_file() for name in self.files)

    @property
    def place(self) -> tuple[int, int]:
        """Where it comes: the paper's figures, the paper's tables, the others."""
        match = re.fullmatch(r"(fig|table)(\d+)", self.name)
        return (["fig", "table"].index(match[1]), int(match[2])) if match else (2, 0)

    @property
    def label(self) -> str:
        """Its name for readers: ``Fig. 10``, ``Table 2``, else the name itself."""
        kind, number = self.place
        return f"{('Fig.', 'Table')[kind]} {number}" if kind < 2 else self.name.replace("_", " ")

    def size(self) -> list[int]:
        """Width and height of the image at 100 of its 200 dots per inch."""
        header = paths.read_result(f"{self.name}.png").read_bytes()[16:24]
        return [int.from_bytes(header[k : k + 4], "big") // 2 for k in (0, 4)]

    def rows(self) -> list[list[str]]:
        """Lines of its CSV, head first."""
        path = paths.read_result(f"{self.name}.csv")
        with path.open(encoding="utf-8", newline="") as file:
            return list(csv.reader(file))

    def expected(self) -> str:
        """The number to compare, as ``column = value at key = value, ...``, or the number of rows.

        Raises `study.checks.StudyError` if ``expect`` does not name a number in one row.
        """
        head, *lines = self.rows()
        rows = [dict(zip(head, line, strict=True)) for line in lines]
        if not self.expect:
            return f"{len(rows)} rows"
        column, _, where = self.expect.partition(" at ")
        try:
            keys = dict(text.split(" = ") for text in re.split(r", (?=\w+ = )", where))
            (row,) = (row for row in rows if keys.items() <= row.items())
            return f"{column} = {float(row[column]):.4g} at {where}"
        except (KeyError, ValueError):
            raise StudyError(
                f"catalogue.toml: {self.name} must be expected by a column and the keys of one "
                f"row of figures/{self.files[0]}, got {self.expect!r}"
            ) from None


@dataclass(frozen=True)
class Notebook:
    """A notebook, by its file name without suffix, and the results it makes, by their names.

    It ``reads`` the numbers of results of other notebooks. A ``long`` one takes longer than most,
    so that it begins first.
    """

    name: str
    results: dict[str, Result] = field(default_factory=dict)
    reads: list[str] = field(default_factory=list)
    long: bool = False

    @property
    def path(self) -> Path:
        """Where the notebook is."""
        return paths.NOTEBOOKS / f"{self.name}.ipynb"

    @property
    def executed(self) -> Path:
        """Where its executed copy goes, which is the name of its target in the Snakefile."""
        return paths.BUILD / "notebooks" / self.path.name

    @property
    def title(self) -> str:
        """First line of its text."""
        cell = json.loads(self.path.read_text(encoding="utf-8"))["cells"][0]
        return "".join(cell["source"]).partition("\n")[0].removeprefix("# ")

    def files(self) -> list[str]:
        """File names of its results."""
        return [file for result in self.results.values() for file in result.files]


def notebook(name: str, entry: Mapping[str, Any]) -> Notebook:
    """A notebook from its entry in the catalogue, in which every table is a result.

    Raises `study.checks.StudyError` for an unknown or a missing key.
    """
    tables = {key: value for key, value in entry.items() if isinstance(value, dict)}
    others = {key: value for key, value in entry.items() if key not in tables}
    try:
        results = {key: Result(key, name, **table) for key, table in tables.items()}
        return Notebook(name, results, **others)
    except TypeError as error:
        raise StudyError(f"notebooks/catalogue.toml: the entry {name} is wrong: {error}") from None


try:
    _ENTRIES = tomllib.loads(FILE.read_text(encoding="utf-8")) if paths.IS_CHECKOUT else {}
except ValueError as error:
    raise StudyError(f"notebooks/catalogue.toml: it is not valid TOML: {error}") from None
CATALOGUE = tuple(notebook(name, entry) for name, entry in _ENTRIES.items())


def results() -> list[Result]:
    """Every result: the paper's figures and tables in its order, then the others."""
    every = [result for notebook in CATALOGUE for result in notebook.results.values()]
    return sorted(every, key=lambda result: result.place)


def select(names: Sequence[str]) -> list[Notebook]:
    """Notebooks by their own names or those of results, in the catalogue's order; all for no name.

    Raises ``ValueError`` for an unknown name, with a known one that is nearly the same.
    """
    paths.require_checkout(paths.NOTEBOOKS)
    known = [name for nb in CATALOGUE for name in (nb.name, *nb.results)]
    for name in names:
        if name not in known:
            plain = re.sub(r"\W", "", name.lower()).replace("figure", "fig")
            padded = re.sub(r"^fig(\d)$", r"fig0\1", plain)
            near = [padded] if padded in known else get_close_matches(plain, known, 1, cutoff=0.85)
            hint = f": did you mean {near[0]}?" if near else ""
            raise ValueError(f"NAME must be a name that study list shows, got {name!r}{hint}")
    return [nb for nb in CATALOGUE if not names or {nb.name, *nb.results} & set(names)]
