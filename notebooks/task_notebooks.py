"""One task per notebook of the catalogue: stale when it, the library or its data changed.

Long ones and those that others read from begin first, so that no core waits at the end.
"""

import json
import os
from pathlib import Path
from typing import Annotated

from pytask import Product, PythonNode, mark, task

from study.pages import catalogue, execute, tasks

settings = json.loads(os.environ.get(execute.PARAMETERS_VARIABLE, "{}"))

READ = {name for notebook in catalogue.CATALOGUE for name in notebook.reads}

for notebook in catalogue.CATALOGUE:
    chosen = json.dumps(settings.get(notebook.name, {}), sort_keys=True)
    begins_first = notebook.long or READ & notebook.results.keys()

    @(mark.try_first if begins_first else mark.try_last)
    @task(id=notebook.name)
    def task_notebook(
        parameters: Annotated[str, PythonNode(value=chosen, hash=True)],
        name: str = notebook.name,
        inputs: list[Path] = notebook.inputs(),
        products: Annotated[list[Path], Product] = notebook.products(),
    ):
        tasks.leave_interrupts_to_the_runner()
        (selected,) = catalogue.select([name])
        execute.execute(selected, json.loads(parameters))
