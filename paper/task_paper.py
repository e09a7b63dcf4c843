"""Two tasks after the notebooks: paper and supplement, and the report that shows everything."""

from pathlib import Path
from typing import Annotated

from pytask import Product, PythonNode

from study.pages import freshness, typeset

PAPER, REPORT = freshness.of_paper(), freshness.of_report()


def task_typeset(
    inputs: Annotated[None, PythonNode(value="text and data", hash=PAPER.digest)],
    results: list[Path] = PAPER.reads,
    output: Annotated[list[Path], Product] = PAPER.products,
):
    typeset.typeset_all()


def task_report(
    inputs: Annotated[None, PythonNode(value="library, text and data", hash=REPORT.digest)],
    shown: list[Path] = REPORT.reads,
    index: Annotated[list[Path], Product] = REPORT.products,
):
    from study.pages import report

    report.write(index[0].parent)
