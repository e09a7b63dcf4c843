"""One task per notebook of the catalogue: outdated when it, the library or its data changed.

Long ones and those that others read from begin first, so that no core waits at the end.
"""

import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Annotated

from pytask import Product, PythonNode, mark, task

from study import paths
from study.pages.catalogue import CATALOGUE, Notebook
from study.pages.execute import PARAMETERS_VARIABLE, execute

settings = json.loads(os.environ.get(PARAMETERS_VARIABLE, "{}"))
VARIED = [replace(nb, settings=settings[nb.name]) for nb in CATALOGUE if nb.name in settings]
READ = {name for notebook in CATALOGUE for name in notebook.reads}

for notebook in (*CATALOGUE, *VARIED):
    begins_first = notebook.long or READ & notebook.results.keys()
    # pytask would take an empty list for a value, whose name it confuses between tasks
    needed = [notebook.path, *(paths.FIGURES / f"{name}.csv" for name in notebook.reads)]

    @(mark.try_first if begins_first else mark.try_last)
    @task(id=notebook.identifier)
    def task_notebook(
        run: Annotated[Notebook, PythonNode(value=notebook, hash=Notebook.digest)],
        reads: list[Path] = needed,
        products: Annotated[list[Path], Product] = notebook.products(),
    ):
        execute(run)
