"""Two tasks after the notebooks: paper and supplement, and the report that shows everything."""

from functools import partial
from pathlib import Path
from typing import Annotated

from pytask import Product, PythonNode

from study import paths, provenance
from study.contact import laws
from study.pages import catalogue, typeset

TEXT = [path for path in sorted(paths.PAPER.iterdir()) if path.suffix in (".typ", ".yml")]
DATA = [paths.DATA / "force_curves.csv", paths.DATA / "datapackage.json"]
PRINTED = [paths.DATA / "published/tables.csv", laws.COEFFICIENTS]
SUFFIXES = (".py", ".html", ".md", ".rst", ".css", ".js", ".json", ".csv")
LIBRARY = [path for path in (paths.ROOT / "study").rglob("*.*") if path.suffix in SUFFIXES]
SHOWN = [*LIBRARY, *paths.DOCUMENTS, catalogue.FILE, *DATA]
RESULTS = [paths.FIGURES / name for notebook in catalogue.CATALOGUE for name in notebook.files()]
EXECUTED = [notebook.executed for notebook in catalogue.CATALOGUE]


def task_typeset(
    inputs: list[Path] = [*TEXT, *DATA, *PRINTED, *RESULTS],
    pdfs: Annotated[list[Path], Product] = [*typeset.PDFS],
):
    typeset.typeset_all()


def task_report(
    shown: Annotated[list, PythonNode(value=SHOWN, hash=partial(provenance.digest, words=True))],
    made: list[Path] = [*RESULTS, *EXECUTED, *typeset.PDFS],
    index: Annotated[Path, Product] = paths.BUILD / "report/index.html",
):
    from study.pages import report

    report.write(index.parent)
