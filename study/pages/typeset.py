"""Paper and supplement as PDF: Typst reads text, figures, numbers; a missing one is an error."""

import re
from pathlib import Path
from typing import Any

import typst

from study import paths
from study.checks import StudyError

SOURCE = paths.PAPER / "paper.typ"
PDFS = (paths.BUILD / "paper.pdf", paths.BUILD / "supplement.pdf")


def typeset_all() -> None:
    """Typeset the paper and its supplement."""
    for pdf in PDFS:
        typeset(paths.PAPER / f"{pdf.stem}.typ", pdf)


def typeset(source: Path = SOURCE, output: Path = PDFS[0]) -> None:
    """Typeset a text of the project from the data and the results (`study.paths.read_result`).

    Only Typst's own fonts are used, and no date is written: the bytes are the same every time.
    Raises `study.checks.StudyError` if a number, figure or reference is missing, or Typst warns.
    """
    paths.require_checkout(paths.PAPER)
    try:
        pdf, warnings = typst.compile_with_warnings(source, format="pdf", **options())
    except typst.TypstError as error:
        raise StudyError(_in_one_line(error)) from None
    if warnings:
        raise StudyError(_in_one_line(warnings[0]))
    with paths.whole(output) as temporary:
        temporary.write_bytes(pdf)


def options() -> dict[str, Any]:
    """Options of Typst's compiler: root and results, and no fonts but those it brings."""
    results = paths.read_result("").relative_to(paths.ROOT).as_posix()
    given = {"results": f"/{results}"}
    return {"root": paths.ROOT, "ignore_system_fonts": True, "sys_inputs": given}


def _in_one_line(problem: Any) -> str:
    """File, line and message of Typst's error or warning."""
    place = re.search(r"([\w.-]+):(\d+):\d+", problem.diagnostic)
    where = f"paper/{place[1]}, line {place[2]}" if place else "paper"
    return f"{where}: {problem.message}"
