"""Typeset the article and its supplement, as the Snakefile asks: ``python paper/typeset.py``."""

from pathlib import Path
from typing import Any

import typst

from study import paths
from study.checks import StudyError
from study.pages.build import PDFS, be_job


def typeset(source: Path, pdf: Path) -> None:
    """Typeset a text of the project by Typst; a missing number or figure is an error.

    Only Typst's own fonts are used, and no date is written: the bytes are the same every time.
    """
    try:
        made, warnings = typst.compile_with_warnings(source, **options())
    except typst.TypstError as error:
        raise StudyError(f"paper: {error.diagnostic}") from None
    if warnings:
        raise StudyError(f"paper: {warnings[0].diagnostic}")
    with paths.whole(pdf) as temporary:
        temporary.write_bytes(made)


def options() -> dict[str, Any]:
    """Options of Typst's compiler: root and results, and no fonts but those it brings."""
    results = {"results": f"/{paths.shown(paths.read_result(''))}"}
    return {"root": paths.ROOT, "ignore_system_fonts": True, "sys_inputs": results}


def main() -> None:
    """Typeset both."""
    for pdf in PDFS:
        typeset(paths.PAPER / f"{pdf.stem}.typ", pdf)


if __name__ == "__main__":
    be_job("article", main, PDFS)
