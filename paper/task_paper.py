"""Two tasks after the notebooks: the paper, and the report that shows everything."""

from pathlib import Path
from typing import Annotated

from pytask import Product

from study import contact, paths
from study.dataset import store
from study.pages import catalogue, tasks, typeset

RESULTS = [path for notebook in catalogue.CATALOGUE for path in notebook.products()]
SHOWN = [path for path in RESULTS if path.parent == paths.FIGURES]
NUMBERS = [
    store.CURVES,
    store.PACKAGE,
    paths.DATA / "published/tables.csv",
    contact.laws.COEFFICIENTS,
]
TEXT = [path for path in sorted(paths.PAPER.iterdir()) if path.suffix in (".typ", ".yml")]
LIBRARY = [
    path
    for path in sorted((paths.ROOT / "study").rglob("*.*"))
    if path.suffix in (".py", ".html", ".md", ".rst", ".css", ".js", ".json")
]
PAPER = [*TEXT, *SHOWN, *NUMBERS]
REPORT = [*RESULTS, *LIBRARY, *paths.DOCUMENTS, catalogue.FILE, store.CURVES, store.PACKAGE]


def task_typeset(
    sources: list[Path] = PAPER,
    output: Annotated[Path, Product] = typeset.PDF,
):
    tasks.leave_interrupts_to_the_runner()
    typeset.typeset(output=output)


def task_report(
    sources: list[Path] = REPORT,
    paper: Path = typeset.PDF,
    index: Annotated[Path, Product] = paths.BUILD / "report/index.html",
):
    tasks.leave_interrupts_to_the_runner()
    from study.pages import report

    report.write(index.parent)
