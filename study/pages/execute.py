"""One notebook executed with papermill: in a process of its own, with folders of its own.

Nothing of the process that asks is changed, neither its environment nor its working folder, so
that several threads of one process may execute notebooks at the same time.
"""

import json
import os
import subprocess
import sys
import threading
from pathlib import Path

from study import paths
from study.checks import StudyError
from study.pages import kept


class NotebookError(StudyError):
    """A notebook failed; the message names it, and cell and error if a cell did."""


def execute(notebook, settings):
    """Execute one notebook; its executed copy lands in ``build/notebooks``.

    Its results are compared with the kept ones (`kept.place`) if every cell succeeds and
    it has made just the files that the catalogue names.

    Parameters
    ----------
    notebook : study.pages.catalogue.Notebook
    settings : dict
        Values for its parameters.

    Raises
    ------
    NotebookError
        If a cell fails, or a result is missing or not in the catalogue; names notebook and cell,
        or the files.
    """
    paths.BUILD.mkdir(exist_ok=True)
    with paths.scratch() as folder, paths.scratch(paths.BUILD) as work:
        results, executed = work / "results", work / notebook.path.name
        results.mkdir()
        try:
            _execute_in_a_child(notebook, executed, settings, folder, results)
            _require(notebook, {path.name for path in results.iterdir()})
        finally:
            if executed.is_file():
                paths.copy(executed, notebook.executed)
        kept.place(results, notebook.files())


def _execute_in_a_child(notebook, executed, settings, folder, results):
    """Run this module as a program, which ends when this process does."""
    command = [sys.executable, "-m", "study.pages.execute"]
    arguments = [str(notebook.path), str(executed), json.dumps(settings), str(folder)]
    environment = os.environ | {
        paths.RESULTS_VARIABLE: str(results),
        "PYTHONPATH": os.pathsep.join([str(paths.ROOT), os.environ.get("PYTHONPATH", "")]),
        # kernels run side by side: with threads of their own they would wait for each other
        "PYTHONUTF8": "1",
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        # what a user keeps in the home folder does not change a result
        "IPYTHONDIR": str(folder / "ipython"),
        "JUPYTER_CONFIG_DIR": str(folder / "config"),
        "JUPYTER_DATA_DIR": str(folder / "data"),
        "JUPYTER_RUNTIME_DIR": str(folder / "runtime"),
    }
    ours, held = os.pipe()  # the child reads from it until this process closes it, or is killed
    try:
        child = subprocess.Popen(
            [*command, *arguments],
            stdin=ours,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=folder,
            env=environment,
        )
        os.close(ours)
        out, err = (text.decode(errors="replace") for text in child.communicate())
    finally:
        os.close(held)
    if child.returncode != 0:
        said = out or " ".join(err.split()[-40:]) or f"ended with status {child.returncode}"
        raise NotebookError(f"{notebook.name}{said if out else ': ' + said}")


def _require(notebook, made):
    """Refuse a notebook that has not made what the catalogue says."""
    wanted = set(notebook.files())
    if missing := sorted(wanted - made):
        raise NotebookError(f"{notebook.name} did not save {', '.join(missing)}")
    if unknown := sorted(made - wanted):
        raise NotebookError(
            f"{notebook.name} saved {', '.join(unknown)}, which the catalogue does not name"
        )


def main(path, executed, settings, folder):
    """Execute a notebook in this process; say what failed, and return the exit status."""
    import nbformat
    import papermill
    from traitlets.config import Config

    threading.Thread(target=_end_with_the_parent, daemon=True).start()
    config = Config()
    if os.name == "posix":  # not ports: kernels started at the same time may take the same ones
        config.KernelManager.transport = "ipc"
        config.KernelManager.ip = str(Path(folder, "socket"))
    try:
        papermill.execute_notebook(
            path,
            executed,
            parameters=json.loads(settings),
            kernel_name="python3",
            progress_bar=False,
            config=config,
        )
    except papermill.PapermillExecutionError as error:
        print(f", cell In[{error.exec_count}]: {error.ename}: {error.evalue}", end="")
        return 1
    except nbformat.reader.NotJSONError:
        print(": the file is no notebook", end="")
        return 1
    return 0


def _end_with_the_parent():
    os.read(sys.stdin.fileno(), 1)  # returns when the parent closes its end, or has ended
    os._exit(1)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
