"""Where the project's folders are, and files that are written whole or not at all."""

import os
import shutil
import socket
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import platformdirs

from study.checks import StudyError

ROOT = Path(__file__).resolve().parents[1]
DATA = ROOT / "data"
FIGURES = ROOT / "figures"
NOTEBOOKS = ROOT / "notebooks"
PAPER = ROOT / "paper"
BUILD = ROOT / "build"
IS_CHECKOUT = (ROOT / "pyproject.toml").is_file()  # else installed, without these folders
CACHE = BUILD if IS_CHECKOUT else platformdirs.user_cache_path("spherical-clearance-joint-study")
"""What is compiled or found out about the code, and may be deleted."""
_TEXTS = ("README.md", "REPRODUCING.md", "CONTRIBUTING.md", "CHANGELOG.md")
DOCUMENTS = (*(ROOT / name for name in _TEXTS), DATA / "README.md", ROOT / "examples/README.md")
"""Texts that the report shows with the results."""

RESULTS_VARIABLE = "STUDY_RESULTS"  # folder for results while a notebook runs as a task
_PART = f".part-{socket.gethostname()}-"  # ignored by git


def require_checkout(folder: Path) -> None:
    """Raise `StudyError` where the package is installed without the project around it."""
    if not IS_CHECKOUT:
        what = f"{folder.name}/ is not part of the installed package"
        raise StudyError(
            f"this command requires a checkout of the project, because {what}; clone the "
            "repository and install from there"
        )


def results() -> Path:
    """Folder that figures and tables are written to: ``figures/``, or a running task's own."""
    return Path(os.environ.get(RESULTS_VARIABLE, FIGURES))


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Give a temporary file in the folder of ``path``, which becomes ``path`` only on success.

    An ``OSError`` names ``path``.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with scratch(path.parent) as folder:
            yield (temporary := folder / path.name)
            temporary.chmod(0o644)
            temporary.replace(path)
    except OSError as error:
        names = (error.filename, error.filename2)
        if names == (None, None) or any(_PART in str(name) for name in names):
            raise OSError(error.errno, error.strerror, str(path)) from None  # the user's path
        raise


def copy(source: Path, target: Path) -> None:
    """Copy a file, to another file system as well, whole or not at all."""
    with whole(target) as temporary:
        shutil.copyfile(source, temporary)


@contextmanager
def scratch(parent: Path | None = None) -> Iterator[Path]:
    """Give a temporary folder, in ``parent`` or where the system has them, gone at the end."""
    prefix = f"{_PART}{os.getpid()}-"
    with tempfile.TemporaryDirectory(None, prefix, parent, ignore_cleanup_errors=True) as name:
        yield Path(name)


def remove_abandoned() -> None:
    """Remove the temporary folders of processes of this machine that were killed."""
    temporary = Path(tempfile.gettempdir()).glob(f"{_PART}*")
    ours = (ROOT / "study", DATA, FIGURES, BUILD)
    for path in [*temporary, *(path for folder in ours for path in folder.rglob(f"{_PART}*"))]:
        process = path.name.removeprefix(_PART).split("-")[0]
        if process.isdecimal():
            try:
                os.kill(int(process), 0)  # asks only if it lives
            except ProcessLookupError:
                shutil.rmtree(path, ignore_errors=True)
            except PermissionError:
                pass  # it lives, and belongs to another user
