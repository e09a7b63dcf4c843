"""The paper as PDF: Typst reads text, figures and numbers; a missing one is an error."""

import typst

from study import paths
from study.checks import StudyError

SOURCE = paths.PAPER / "paper.typ"
PDF = paths.BUILD / "paper.pdf"


def typeset(source=SOURCE, output=PDF):
    """Typeset the paper from the results in ``figures/`` and the data; same bytes every time.

    Only Typst's own fonts are used, and no date is written.

    Parameters
    ----------
    source : pathlib.Path
        Typst file inside the project.
    output : pathlib.Path
        PDF file.

    Raises
    ------
    study.checks.StudyError
        If a number, figure or reference is missing, or Typst warns; tells which.
    """
    try:
        pdf, warnings = typst.compile_with_warnings(
            source, root=paths.ROOT, ignore_system_fonts=True, format="pdf"
        )
    except typst.TypstError as error:
        raise StudyError(f"{source.relative_to(paths.ROOT)}: {error.message}") from None
    if warnings:
        raise StudyError(f"{source.relative_to(paths.ROOT)}: {warnings[0].message}")
    with paths.whole(output) as temporary:
        temporary.write_bytes(pdf)
