"""Where the project's folders are, and files that are written whole or not at all."""

import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import platformdirs

from study.checks import StudyError

STUDY = Path(__file__).resolve().parent
ROOT = STUDY.parent
DATA = ROOT / "data"
FIGURES = ROOT / "figures"
NOTEBOOKS = ROOT / "notebooks"
PAPER = ROOT / "paper"
BUILD = ROOT / "build"
RESULTS = BUILD / "results"
"""Figures and tables as the workflow made them; `FIGURES` has those that are accepted."""
IS_CHECKOUT = (ROOT / "pyproject.toml").is_file()  # else installed, without these folders
CACHE = BUILD if IS_CHECKOUT else platformdirs.user_cache_path("spherical-clearance-joint-study")
"""Folder of what is compiled, which may be deleted."""

# Folders that a job of the workflow hands to its notebook: where it writes its results, and where
# it reads those of other notebooks
WRITE_VARIABLE, READ_VARIABLE = "STUDY_RESULTS", "STUDY_READS"


def require_checkout(folder: Path) -> None:
    """Raise `StudyError` where the package is installed without the project around it."""
    if not IS_CHECKOUT:
        said = "this command requires a checkout of the project, which contains"
        raise StudyError(f"{said} {folder.name}/; clone the repository and install from there")


def read_result(name: str) -> Path:
    """File of a result: in a job of the workflow that which was made, elsewhere the accepted."""
    return Path(os.environ.get(READ_VARIABLE, FIGURES)) / name


def shown(path: Path) -> str:
    """A file's path in the project, for messages and descriptions; its whole path outside it."""
    return path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.as_posix()


def sha256(path: Path) -> str:
    """SHA-256 of a file, in hexadecimal."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def sources(*packages: str, suffixes: tuple[str, ...] = (".py",)) -> list[Path]:
    """Files of some packages of the study, by default their Python files."""
    files = (path for name in packages for path in (STUDY / name).glob("*.*"))
    return sorted(path for path in files if path.suffix in suffixes)


def digest(files: Iterable[Path], *more: object) -> str:
    """One hash of the names and contents of files and of the ``repr`` of more, in 16 digits."""
    contents = [(path.name, sha256(path)) for path in files]
    return hashlib.sha256(repr((contents, more)).encode()).hexdigest()[:16]


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Give a temporary file in the folder of ``path``, which becomes ``path`` only on success.

    An ``OSError``, such as that of a full disk, names ``path``.
    """
    if path.exists() and not path.is_file():  # such as /dev/null
        raise ValueError(f"a file to write must be a regular file, got {path}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with scratch(path.parent) as folder:
            yield (temporary := folder / path.name)
            temporary.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from None


def copy(source: Path, target: Path) -> None:
    """Copy a file, whole or not at all."""
    with whole(target) as temporary:
        shutil.copyfile(source, temporary)


@contextmanager
def scratch(parent: Path | None = None) -> Iterator[Path]:
    """Give a temporary folder, in ``parent`` or where the system has them, gone at the end."""
    with tempfile.TemporaryDirectory(
        prefix=".part-", dir=parent, ignore_cleanup_errors=True
    ) as name:  # ignored by git
        yield Path(name)
