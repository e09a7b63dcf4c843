"""Check the parameters of notebooks, run outdated ones as tasks, execute one by papermill.

A notebook is executed in a kernel with separate folders (`study.pages.kernel`). Nothing in the
calling process changes, so that several threads may execute notebooks at the same time.
"""

import ast
import json
import os
import re
from functools import cache
from typing import Any, NamedTuple

from study import checks, paths
from study.contact import LAWS
from study.pages import baseline, tasks
from study.pages.catalogue import Notebook, check_claims

_COMMENT = re.compile(r"(.*?)\s*(?:\[([^][]*)\])?")  # meaning and values allowed
PARAMETERS_VARIABLE = "STUDY_PARAMETERS"  # hands parameters to notebooks/task_notebooks.py
_RETURNED = re.compile(
    r"\[|Text\(|<\w*(matplotlib|Axes|Container)|\(array\("
)  # by a call for a plot
_OTHER_NUMBER = re.compile(r"\d_\d|\b0[xob]", re.IGNORECASE)  # Python's own: 1_00, 0x64


class NotebookError(checks.StudyError):
    """A notebook failed; the message names it, and cell and error if a cell did."""


class Parameter(NamedTuple):
    """A notebook's parameter: default value, values allowed (empty if any is), and meaning."""

    default: Any
    allowed: str
    meaning: str

    def __str__(self) -> str:
        """Default and values allowed, for a reader."""
        return f"{self.default} [{self.allowed}]" if self.allowed else str(self.default)


def parameters(notebook: Notebook) -> dict[str, Parameter]:
    """Parameters of a notebook by name, from its ``parameters`` cell.

    A comment tells the meaning, and ends with the values allowed: ``[20 to 10000]`` for a number or
    each of a list, ``[linear, small]`` for a word, ``[a law]`` for those of ``study law``.

    Raises `NotebookError` if the file is no notebook, or has anything but such lines in that cell.
    """
    read = {}
    try:
        cells = json.loads(notebook.path.read_text(encoding="utf-8"))["cells"]
        (cell,) = (cell for cell in cells if "parameters" in cell["metadata"].get("tags", ()))
        source = "".join(cell["source"])
        for line in ast.parse(source).body:
            after = source.splitlines()[line.end_lineno - 1].encode()[line.end_col_offset :]
            meaning, allowed = _COMMENT.fullmatch(after.decode().strip(" #")).groups("")
            default = ast.literal_eval(line.value)
            read[line.targets[0].id] = Parameter(default, allowed, meaning)
    except (ValueError, KeyError, AttributeError, SyntaxError) as error:
        raise NotebookError(f"{notebook.name}: its parameters cannot be read ({error})") from None
    return read


def check_parameters(notebooks: list[Notebook], settings: list[str]) -> dict[str, dict[str, Any]]:
    """Turn settings ``key=value`` into parameters; each notebook gets those it has.

    Papermill itself only warns of an unknown parameter and runs the default. A value is a Python
    literal or a bare word. The default is left out. Raises ``ValueError`` for no ``=``, an unknown
    parameter, or a value of another type or range.
    """
    known = {nb.name: parameters(nb) for nb in notebooks} if settings else {}
    chosen = {nb.name: {} for nb in notebooks}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals:
            raise ValueError(f"-p must be KEY=VALUE, got {setting!r}")
        owners = [name for name, entries in known.items() if key in entries]
        if not owners:
            keys = ", ".join(sorted({key for entries in known.values() for key in entries}))
            raise ValueError(f"parameter must be one of {keys}, got {key!r}")
        try:
            value = text if _OTHER_NUMBER.search(text) else ast.literal_eval(text)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            value = text
        for name in owners:
            default, allowed, _ = known[name][key]
            converted = _as_default(key, value, default)
            check_range(key, converted, allowed)
            if converted != default:
                chosen[name][key] = converted
    return chosen


def _as_default(key, value, default):
    """``value`` in the type of ``default``: a whole number may stand for a float."""
    if isinstance(default, float) and type(value) is int:
        value = float(value)
    if type(value) is not type(default):
        kind = type(default).__name__
        raise ValueError(f"parameter {key} must be of type {kind}, got {checks.shown(value)}")
    if isinstance(default, list | tuple) and default:
        return type(default)(_as_default(key, item, default[0]) for item in value)
    return value


def check_range(key: str, value: Any, allowed: str) -> None:
    """Refuse a value, or one of a list, that is not allowed."""
    low, to, high = allowed.partition(" to ")
    for item in value if isinstance(value, list | tuple) else [value]:
        if to:
            checks.number(f"parameter {key}", item, least=float(low), most=float(high))
        elif allowed:
            names = LAWS if allowed == "a law" else allowed.split(", ")
            checks.choice(f"parameter {key}", item, tuple(names))


def run(notebooks: list[Notebook], *, report: bool = False, **options: Any) -> tasks.Built:
    """Run outdated notebooks, and the outdated ones that they read from, as pytask tasks.

    The options and errors are those of `study.pages.tasks.build`. Paper and report need all
    notebooks.
    """
    settings = {nb.name: nb.settings for nb in notebooks if nb.settings}
    os.environ[PARAMETERS_VARIABLE] = json.dumps(settings, sort_keys=True)
    if options.get("jobs") is None and len(notebooks) == 1 and not notebooks[0].reads:
        options["jobs"] = 1  # a worker would only have to start
    folders = [paths.NOTEBOOKS, *([paths.PAPER] if report else [])]
    return tasks.build(folders, "task_report" if report else _expression(notebooks), **options)


def outdated(notebooks: list[Notebook]) -> list[str]:
    """Names of the outdated notebooks among some (`study.pages.tasks.outdated`)."""
    found = set(tasks.outdated([paths.NOTEBOOKS], _expression(notebooks)))
    return [notebook.name for notebook in notebooks if notebook.name in found]


def _expression(notebooks):
    """Expression of pytask for the tasks of notebooks, which cannot have "=" or ","."""
    return " or ".join(f"[{nb.name}{':' if nb.settings else ']'}" for nb in notebooks)


def execute(notebook: Notebook) -> None:
    """Execute one notebook with its settings, and keep its executed copy.

    If every cell succeeds, its results are compared with the kept ones (`baseline.take_over`).
    Those made with settings go to a separate folder. Raises `NotebookError` if a cell fails, or
    a result is missing or not in the catalogue, and `study.checks.StudyError` if data are damaged
    or a claim cannot be judged.
    """
    import papermill
    from nbformat.reader import NotJSONError

    from study.pages import kernel

    _check_inputs()
    paths.BUILD.mkdir(exist_ok=True)
    with paths.scratch() as folder, paths.scratch(paths.BUILD) as work:
        results, executed = work / "results", work / notebook.path.name
        results.mkdir()
        try:
            papermill.execute_notebook(
                notebook.path,
                executed,
                parameters=notebook.settings,
                kernel_name="python3",
                progress_bar=False,
                request_save_on_cell_execute=False,  # but once, at the end
                kernel_manager_class=kernel.manager(folder, results),
            )
        except papermill.PapermillExecutionError as error:
            where = f"{notebook.name}, cell In[{error.exec_count}]"
            raise NotebookError(f"{where}: {error.ename}: {error.evalue}") from None
        except NotJSONError:
            raise NotebookError(f"{notebook.name}: the file is not a notebook") from None
        finally:
            if executed.is_file():
                paths.copy(executed, notebook.executed)
        refuse_returned(notebook)
        wanted, made = set(notebook.files()), {path.name for path in results.iterdir()}
        if missing := ", ".join(sorted(wanted - made)):
            raise NotebookError(f"{notebook.name} did not save {missing}")
        if extra := ", ".join(sorted(made - wanted)):
            raise NotebookError(
                f"{notebook.name} saved {extra}, which notebooks/catalogue.toml does not name"
            )
        if notebook.settings:
            for name in notebook.files():
                paths.copy(results / name, notebook.folder / name)
        else:
            baseline.take_over(results, notebook)


@cache
def _check_inputs():
    """Refuse damaged data and wrong claims, once in each process and before a notebook runs."""
    from study import dataset

    dataset.verify_files()
    check_claims()


def refuse_returned(notebook: Notebook) -> None:
    """Refuse an executed notebook with what a call for a plot returns, by a `NotebookError`."""
    for cell in json.loads(notebook.executed.read_text(encoding="utf-8"))["cells"]:
        for data in (output.get("data", {}) for output in cell.get("outputs", ())):
            text = "".join(data["text/plain"]) if [*data] == ["text/plain"] else ""
            if _RETURNED.match(text):
                where = f"{notebook.name}, cell In[{cell['execution_count']}]"
                raise NotebookError(f"{where} shows {checks.shown(text)}; end its last line with ;")
