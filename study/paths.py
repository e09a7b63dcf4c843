"""Where the project's folders are, found from this file: whatever folder one works in."""

import os
import shutil
import socket
import tempfile
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DATA = ROOT / "data"
FIGURES = ROOT / "figures"
NOTEBOOKS = ROOT / "notebooks"
PAPER = ROOT / "paper"
BUILD = ROOT / "build"
DOCUMENTS = tuple(
    ROOT / name
    for name in ("README.md", "REPRODUCING.md", "CONTRIBUTING.md", "data/README.md", "CHANGELOG.md")
)
"""What the report shows besides results: texts for readers."""

RESULTS_VARIABLE = "STUDY_RESULTS"  # folder for results while a notebook runs as a task


def results():
    """Folder that figures and tables are written to: ``figures/``, or a task's own for a while."""
    return Path(os.environ.get(RESULTS_VARIABLE, FIGURES))


@contextmanager
def whole(path):
    """Give a temporary path beside ``path``, and rename it to ``path`` only on success.

    Parameters
    ----------
    path : pathlib.Path
        File to write; its folder is made if missing.

    Yields
    ------
    pathlib.Path
        Temporary file with the same suffix.

    Raises
    ------
    OSError
        If the file cannot be written; names it.
    """
    temporary = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=_prefix(), suffix=path.suffix, dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        yield temporary
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        names = (error.filename, error.filename2)
        if names == (None, None) or any(_PART in str(name) for name in names):
            raise OSError(error.errno, error.strerror, str(path)) from None  # what the user knows
        raise
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def copy(source, target):
    """Copy a file, to another file system as well, whole or not at all."""
    with whole(target) as temporary:
        shutil.copyfile(source, temporary)


@contextmanager
def scratch(parent=None):
    """Give a temporary folder, in ``parent`` or where the system has them, gone at the end."""
    with tempfile.TemporaryDirectory(
        prefix=_prefix(), dir=parent, ignore_cleanup_errors=True
    ) as name:
        yield Path(name)


def sweep():
    """Remove the temporary files and folders of processes of this machine that were killed."""
    for folder in (ROOT / "study", DATA, FIGURES, BUILD, Path(tempfile.gettempdir())):
        found = folder.glob if folder == Path(tempfile.gettempdir()) else folder.rglob
        for path in list(found(f"{_PART}*")):
            process = path.name.removeprefix(_PART).split("-")[0]
            if not process.isdecimal() or _alive(int(process)):
                continue
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)


_PART = f".part-{socket.gethostname()}-"  # ignored by git


def _prefix():
    return f"{_PART}{os.getpid()}-"


def _alive(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:  # somebody else's
        return True
    return True
