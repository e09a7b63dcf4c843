"""Where the project's folders are, found from this file: whatever folder one works in."""

import os
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
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=".", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
