"""What is stale: a task that was never run, or one whose inputs or products have changed since.

The one record of it is ``pytask.lock``, in which pytask notes the state of a task's files after
each run. `tasks.build` lets pytask decide by that record. `stale` reads it and decides the same in
a tenth of a second, for then pytask need not be loaded if there is nothing to do.
"""

import json
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from study import contact, paths, provenance
from study.pages import catalogue
from study.pages.catalogue import CATALOGUE, Notebook

LOCK = paths.ROOT / "pytask.lock"
PDFS = (paths.BUILD / "paper.pdf", paths.BUILD / "supplement.pdf")
INDEX = paths.BUILD / "report/index.html"
_SHOWN_DATA = (paths.DATA / "force_curves.csv", paths.DATA / "datapackage.json")
_PRINTED_DATA = (
    paths.DATA / "published/tables.csv",
    contact.laws.COEFFICIENTS,
    contact.stiffening.TABLE,
)
_PRINTED = (".typ", ".yml")
_IN_REPORT = (".py", ".html", ".md", ".rst", ".css", ".js", ".json", ".csv")


@dataclass(frozen=True)
class Task:
    """A task of pytask, and what makes it stale.

    Attributes
    ----------
    name
        Identifier of the notebook, ``typeset`` or ``report``.
    identifier
        Its name in ``pytask.lock``: file, function and name.
    inputs
        Gives the files whose content is in the task's `digest`: text, code and data.
    reads
        Files that other tasks make. They are not in the digest, as pytask orders tasks by them.
    products
        Files that it makes.
    settings
        Parameters of a notebook, other than the defaults.
    words
        Whether comments and docstrings of the code count too.
    """

    name: str
    identifier: str
    inputs: Callable[[], Iterable[Path]]
    reads: Sequence[Path]
    products: Sequence[Path]
    settings: Mapping[str, Any] = field(default_factory=dict)
    words: bool = False

    def digest(self, _value: object = None) -> str:
        """Digest of the settings, the inputs, and the names of the other files.

        pytask calls it with the value of the task's only argument that is not a file.
        """
        names = [provenance.name(path) for path in (*self.reads, *self.products)]
        of = sorted(self.settings.items()), names
        return provenance.digest(self.inputs(), *of, words=self.words)

    def is_as_recorded(self, entry: Mapping[str, Any]) -> bool:
        """Whether its own file, its digest and its other files are as an entry of the lock says."""
        states = {self.identifier.partition("::")[0]: entry["state"]}
        states |= entry["depends_on"] | entry["produces"]
        return all(
            state == (self.digest() if "::" in node else provenance.sha256_of(paths.ROOT / node))
            for node, state in states.items()
            if state != "0"  # an empty list of files, which pytask takes for a value
        )


def of_notebook(notebook: Notebook) -> Task:
    """Task of a notebook with its settings. It reads results that were made without any."""
    name, products = notebook.identifier, notebook.products()
    identifier = f"notebooks/task_notebooks.py::task_notebook[{name}]"
    reads = [paths.FIGURES / f"{result}.csv" for result in notebook.reads]
    return Task(name, identifier, notebook.inputs, reads, products, notebook.settings)


def of_paper() -> Task:
    """Task of the paper and its supplement, which read the results."""
    text = [path for path in sorted(paths.PAPER.iterdir()) if path.suffix in _PRINTED]
    inputs = (*text, *_SHOWN_DATA, *_PRINTED_DATA)
    shown = [paths.FIGURES / name for notebook in CATALOGUE for name in notebook.files()]
    return Task("typeset", "paper/task_paper.py::task_typeset", lambda: inputs, shown, PDFS)


def of_report() -> Task:
    """Task of the report, which shows everything."""
    library = [path for path in (paths.ROOT / "study").rglob("*.*") if path.suffix in _IN_REPORT]
    inputs = (*sorted(library), *paths.DOCUMENTS, catalogue.FILE, *_SHOWN_DATA)
    reads = [path for notebook in CATALOGUE for path in notebook.products()] + [*PDFS]
    identifier = "paper/task_paper.py::task_report"
    return Task("report", identifier, lambda: inputs, reads, [INDEX], words=True)


def needed(notebooks: Sequence[Notebook], *, report: bool = False) -> list[Task]:
    """Tasks of notebooks and of those that they read from, in an order in which they can be run.

    Paper and report need all notebooks.
    """
    tasks = [of_notebook(notebook) for notebook in catalogue.with_sources(notebooks)]
    return [*tasks, of_paper(), of_report()] if report else tasks


def stale(tasks: Iterable[Task]) -> list[str]:
    """Names of the tasks that a run would run: stale ones, and those that read from them."""
    entries, names, made = _recorded(), [], set()
    for task in tasks:
        entry = entries.get(task.identifier)
        if entry is None or made & set(task.reads) or not task.is_as_recorded(entry):
            names.append(task.name)
            made |= set(task.products)
    return names


def _recorded():
    """Entry of each task in ``pytask.lock``, and in the journal that a killed run leaves."""
    journal, entries = LOCK.with_name("pytask.lock.journal"), []
    try:
        if LOCK.is_file():
            entries += tomllib.loads(LOCK.read_text(encoding="utf-8")).get("task", [])
        if journal.is_file():
            entries += map(json.loads, journal.read_text(encoding="utf-8").splitlines())
    except ValueError:  # damaged: pytask says so, or mends it, as it runs
        return {}
    return {entry["id"]: {"depends_on": {}, "produces": {}} | entry for entry in entries}
