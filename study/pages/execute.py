"""Execute a notebook by papermill, after its parameters are checked."""

import ast
import json
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from study import checks, paths, threads
from study.pages.catalogue import Notebook

_COMMENT = re.compile(r"(.*?)\s*(?:\[([^][]*)\])?")  # meaning and values allowed
_OTHER_NUMBER = re.compile(r"\d_\d|\b0[xob]", re.IGNORECASE)  # Python's own: 1_00, 0x64
RADII = "a radius of the dataset"
"""Values allowed for a normalised socket radius whose curves are read from the dataset."""
LONGEST_FOLDER = 100  # name of a folder for parameters, in characters


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
    each of a list, ``[linear, small]`` for a word, ``[a law]`` for those of ``study law``, and ``[a
    radius of the dataset]``.

    Raises `NotebookError` if the file is no notebook, or has anything but such lines in that cell.
    """
    read = {}
    try:
        cells = json.loads(notebook.path.read_text(encoding="utf-8"))["cells"]
        (cell,) = (cell for cell in cells if "parameters" in cell["metadata"].get("tags", ()))
        source = "".join(cell["source"])
        line: Any
        for line in ast.parse(source).body:
            after = source.splitlines()[line.end_lineno - 1].encode()[line.end_col_offset :]
            found: Any = _COMMENT.fullmatch(after.decode().strip(" #"))
            meaning, allowed = found.groups("")
            default = ast.literal_eval(line.value)
            read[line.targets[0].id] = Parameter(default, allowed, meaning)
    except (ValueError, KeyError, AttributeError, SyntaxError) as error:
        raise NotebookError(f"{notebook.name}: its parameters cannot be read ({error})") from None
    return read


def check_parameters(notebooks: list[Notebook], settings: list[str]) -> dict[str, dict[str, Any]]:
    """Turn settings ``key=value`` into parameters; each notebook gets those it has.

    Papermill itself only warns of an unknown parameter and runs the default. A value is a Python
    literal or a bare word. Raises ``ValueError`` for no ``=``, an unknown parameter, a value of
    another type or range, or a notebook that has none of the parameters.
    """
    known = {nb.name: parameters(nb) for nb in notebooks} if settings else {}
    chosen: dict[str, dict[str, Any]] = {nb.name: {} for nb in notebooks}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals:
            raise ValueError(f"-p must be KEY=VALUE, got {setting!r}")
        owners = [name for name, entries in known.items() if key in entries]
        if not owners:
            keys = ", ".join(sorted({key for entries in known.values() for key in entries}))
            raise ValueError(f"-p must be KEY=VALUE with KEY one of {keys}, got {key!r}")
        try:
            value = text if _OTHER_NUMBER.search(text) else ast.literal_eval(text)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            value = text
        for name in owners:
            default, allowed, _ = known[name][key]
            converted = _as_default(key, value, default)
            check_range(key, converted, allowed)
            chosen[name][key] = converted
    for name in (name for name, given in chosen.items() if settings and not given):
        raise ValueError(f"{name} has none of the given parameters; leave it out")
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
    """Raise ``ValueError`` for a value, or one of a list, that is not allowed."""
    low, to, high = allowed.partition(" to ")
    for item in value if isinstance(value, list | tuple) else [value]:
        if to:
            checks.number(f"parameter {key}", item, least=float(low), most=float(high))
        elif allowed == RADII:
            from study import dataset

            radii = sorted(set(dataset.load(group="paper").r2_star))
            if item not in radii:
                listed = ", ".join(f"{radius:g}" for radius in radii)
                raise checks.RangeError(f"parameter {key} must be one of {listed}, got {item:g}")
        elif allowed:
            from study.contact import CLOSED_FORM

            names = CLOSED_FORM if allowed == "a law" else allowed.split(", ")
            checks.choice(f"parameter {key}", item, tuple(names))


def folder_with(given: Mapping[str, Any]) -> Path:
    """Folder for the results with other parameters, such as ``build/with/r2_star=100``."""
    stated = ",".join(f"{key}={value}" for key, value in sorted(given.items()))
    name = re.sub(r"[^\w.,=+-]", "", re.sub(r"\.0\b", "", stated))
    if len(name) > LONGEST_FOLDER:  # which not every file system takes
        name = f"{name[:LONGEST_FOLDER]}-{paths.digest([], name)}"
    return paths.BUILD / "with" / name


def execute(
    notebook: Notebook, results: Path, executed: Path, given: Mapping[str, Any] | None = None
) -> None:
    """Execute a notebook, and put its results in a folder once every cell has succeeded.

    The executed copy is written last. Raises `NotebookError` if a cell fails, a result is missing
    or not in the catalogue, or a file on which the results depend was edited meanwhile; the cells
    that were run are then in ``build/failed``.
    """
    import papermill
    from nbclient.exceptions import DeadKernelError
    from nbformat.reader import NotJSONError
    from traitlets.config import Config

    before, failed = _stamps(notebook), paths.BUILD / "failed" / notebook.path.name
    failed.unlink(missing_ok=True)
    paths.BUILD.mkdir(exist_ok=True)
    with paths.scratch() as folder, paths.scratch(paths.BUILD) as work:
        made, copy = work / "results", work / notebook.path.name
        made.mkdir()
        os.environ |= threads.ONE | {
            paths.WRITE_VARIABLE: str(made),
            "PYTHONPATH": os.pathsep.join([str(paths.ROOT), os.environ.get("PYTHONPATH", "")]),
            "PYTHONUTF8": "1",
            "IPYTHONDIR": str(folder / "ipython"),  # not the user's settings
        }
        try:
            papermill.execute_notebook(
                notebook.path,
                copy,
                parameters=dict(given or {}),
                cwd=folder,
                kernel_name="python3",
                progress_bar=False,
                request_save_on_cell_execute=False,  # but once, at the end
                start_timeout=600,
                iopub_timeout=600,  # s, on a busy machine
                # connected by files in its folder: kernels may choose the same TCP ports
                config=Config(KernelManager={"transport": "ipc"} if os.name == "posix" else {}),
                shutdown_kernel="immediate",  # its results are written
                extra_arguments=["--log-level=50"],  # or it prints that it is interrupted then
            )
            saved, wanted = {path.name for path in made.iterdir()}, set(notebook.files())
            for path, stamp in _stamps(notebook).items():
                if before.get(path) != stamp:  # the results may be of two versions of a file
                    edited = f"{paths.shown(path)} was edited while it ran"
                    raise NotebookError(f"{notebook.name}: {edited}; run it again")
            if missing := ", ".join(sorted(wanted - saved)):
                raise NotebookError(f"{notebook.name} did not save {missing}")
            if extra := ", ".join(sorted(saved - wanted)):
                unnamed = "which notebooks/catalogue.toml does not name"
                raise NotebookError(f"{notebook.name} saved {extra}, {unnamed}")
        except papermill.PapermillExecutionError as error:
            where = f"{notebook.name}, cell In[{error.exec_count}]"
            seen = f"the cells that were run are in {paths.shown(failed)}"
            reason = f"{error.ename}: {error.evalue}".rstrip(". ")
            paths.copy(copy, failed)
            raise NotebookError(f"{where}: {reason}; {seen}") from None
        except DeadKernelError:
            why = "its kernel ended, perhaps because memory was short; use fewer --jobs"
            raise NotebookError(f"{notebook.name}: {why}") from None
        except NotJSONError:
            raise NotebookError(f"{notebook.name}: the file is not a notebook") from None
        for name in notebook.files():
            paths.copy(made / name, results / name)
        paths.copy(copy, executed)


def _stamps(notebook):
    """Time of the last change of each file on which the results depend."""
    data = (path for suffix in ("csv", "json") for path in paths.DATA.rglob(f"*.{suffix}"))
    files = (notebook.path, *paths.STUDY.rglob("*.py"), *data)
    return {path: path.stat().st_mtime_ns for path in files}
