"""One task per notebook of the catalogue: stale when it, the library or its data changed.

Long ones and those that others read from begin first, so that no core waits at the end.
"""

import json
import os
from dataclasses import replace
from pathlib import Path
from typing import Annotated

from pytask import Product, PythonNode, mark, task

from study.pages import catalogue, execute, freshness

settings = json.loads(os.environ.get(execute.PARAMETERS_VARIABLE, "{}"))
VARIED = [
    replace(nb, settings=settings[nb.name]) for nb in catalogue.CATALOGUE if nb.name in settings
]
READ = {name for notebook in catalogue.CATALOGUE for name in notebook.reads}

for notebook in (*catalogue.CATALOGUE, *VARIED):
    described = freshness.of_notebook(notebook)
    begins_first = notebook.long or READ & notebook.results.keys()

    @(mark.try_first if begins_first else mark.try_last)
    @task(id=notebook.identifier)
    def task_notebook(
        run: Annotated[catalogue.Notebook, PythonNode(value=notebook, hash=described.digest)],
        reads: list[Path] = described.reads,
        products: Annotated[list[Path], Product] = described.products,
    ):
        execute.execute(run)
