"""REPRODUCING.md, made from the catalogue and the kept results.

``python -m study.pages.records`` writes it. Nothing is run: the seconds of a notebook are those
of its executed copy, else those that the file has already.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from study import paths
from study.checks import StudyError
from study.dataset import agreement
from study.pages import kept
from study.pages.catalogue import CATALOGUE
from study.pages.report.results import Result, results

REPRODUCING = paths.ROOT / "REPRODUCING.md"
TEMPLATE = Path(__file__).with_name("reproducing.md")
_SECONDS = re.compile(r"^\| \[(\d\d-[\w-]+)\]\(.+\) \| (\d+) \|$", re.MULTILINE)


def reproducing(seconds: Mapping[str, int]) -> str:
    """Text of ``REPRODUCING.md``, with the seconds that each notebook takes.

    Raises
    ------
    study.checks.StudyError
        If an expected number of the catalogue does not name one row of its result.
    """
    paths.require_checkout(paths.NOTEBOOKS)
    found = results(paths.FIGURES)
    chaotic = [f"`{result.name}`" for result in found if result.name in agreement.CHAOTIC]
    return TEMPLATE.read_text(encoding="utf-8").format(
        tolerance=f"{agreement.TOLERANCE:g}".replace("e-0", "e-"),
        chaotic_tolerance=f"{agreement.CHAOTIC_TOLERANCE:g}",
        chaotic=f"{', '.join(chaotic[:-1])} and {chaotic[-1]}",
        levels=kept.LEVELS,
        of_the_paper=_table(
            ("paper", "name", "what it shows", "notebook", "expected"),
            [(result.label, *_row(result)) for result in found if result.place < (2,)],
        ),
        further=_table(
            ("name", "what it shows", "notebook", "expected"),
            [_row(result) for result in found if result.place >= (2,)],
        ),
        notebooks=_table(
            ("notebook", "seconds"),
            [(f"[{n.name}](notebooks/{n.path.name})", str(seconds[n.name])) for n in CATALOGUE],
        ),
    )


def kept_seconds() -> dict[str, int]:
    """Seconds of each notebook that ``REPRODUCING.md`` has."""
    text = REPRODUCING.read_text(encoding="utf-8")
    return {name: int(seconds) for name, seconds in _SECONDS.findall(text)}


def measured_seconds() -> dict[str, int]:
    """Seconds of each notebook whose executed copy is there, as papermill measured them."""
    found = {}
    for notebook in CATALOGUE:
        if notebook.executed.is_file():
            content = json.loads(notebook.executed.read_text(encoding="utf-8"))
            found[notebook.name] = round(content["metadata"]["papermill"]["duration"])
    return found


def expected(result: Result) -> str:
    """What to expect of a result: the number that the catalogue names, or the number of rows.

    Raises
    ------
    study.checks.StudyError
        If the catalogue does not name a number in one row of the result.
    """
    table = pd.read_csv(result.numbers, dtype=str, keep_default_na=False)
    wanted = result.notebook.expect.get(result.name)
    if wanted is None:
        return f"{len(table)} rows"
    column, _, where = wanted.partition(" at ")
    try:
        for key in re.split(r", (?=\w+ = )", where):
            name, value = key.split(" = ")
            table = table[table[name] == value]
        return f"`{column}` = {float(table[column].item()):.4g} at {where}"
    except (KeyError, ValueError):
        raise StudyError(
            f"catalogue.toml: {result.name} must be expected by a column and the keys of one "
            f"row of figures/{result.numbers.name}, got {wanted!r}"
        ) from None


def main() -> None:
    """Write the records."""
    seconds = kept_seconds() | measured_seconds()
    if missing := ", ".join(n.name for n in CATALOGUE if n.name not in seconds):
        raise StudyError(f"no time is known of {missing}: `study run` it first")
    with paths.whole(REPRODUCING) as temporary:
        temporary.write_text(reproducing(seconds), encoding="utf-8")


def _row(result):
    """Name, caption, number of the notebook and expected number of a result."""
    number = result.notebook.name.partition("-")[0]
    return f"`{result.name}`", result.caption, number, expected(result)


def _table(head, rows):
    """Markdown of a table."""
    cells = [[cell.replace("*", r"\*").replace("|", r"\|") for cell in row] for row in rows]
    first, *rest = (f"| {' | '.join(row)} |" for row in (head, *cells))
    return "\n".join([first, f"|{'---|' * len(head)}", *rest])


if __name__ == "__main__":
    main()
