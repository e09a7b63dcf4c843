"""The study as a set of pages to browse: claims, figures, notebooks, data, library, documents.

Sphinx makes the pages with the settings of `conf`, from the sources that `pages` writes. They open
from disk, without a server, and load nothing from outside the folder. They show what is already
there (results, executed notebooks, data, documents) and compute only the laws at the depths of the
dataset.
"""

import io
import os
import re
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util.docutils import docutils_namespace, patch_docutils

from study import paths
from study.checks import StudyError
from study.pages.catalogue import CATALOGUE, results
from study.pages.freshness import PDF

MARK = "figures.html"  # by which a report is known


def write(folder: Path) -> Path:
    """Write the report, whole or not at all; one that is already there is replaced.

    Returns
    -------
    pathlib.Path
        The report's ``index.html``.

    Raises
    ------
    StudyError
        If a result, an executed notebook or the paper is missing (with the command that makes
        it), the table of claims is damaged, or Sphinx warns.
    ValueError
        If ``folder`` holds anything else than a report.
    """
    folder = Path(folder).absolute()
    if folder.is_file() or (
        folder.is_dir() and any(folder.iterdir()) and not (folder / MARK).is_file()
    ):
        raise ValueError(f"folder must be empty or hold a report, got {folder}")
    _require_all_files()
    folder.parent.mkdir(parents=True, exist_ok=True)
    with paths.scratch(folder.parent) as work:
        build(work / "sources", work / "pages")
        if folder.exists():
            folder.rename(work / "old")
        (work / "pages").rename(folder)
    return folder / "index.html"


def build(sources: Path, pages: Path) -> None:
    """Let Sphinx write the sources and make pages from them; a warning is an error."""
    sources.mkdir()
    warnings, here = io.StringIO(), Path(__file__).parent
    with patch_docutils(), docutils_namespace():
        folders = sources, here, pages, sources.with_name("doctrees")
        jobs = os.cpu_count() or 1
        Sphinx(*folders, "html", status=None, warning=warnings, parallel=jobs).build()
    warned = re.sub(r"\x1b\[[\d;]*m", "", warnings.getvalue()).strip().replace(f"{sources}/", "")
    if warned:
        raise StudyError(f"the report: {warned.splitlines()[0]}")
    for page in (pages / "api").glob("*.html"):  # values and defaults that are paths
        text = page.read_text(encoding="utf-8").replace(f"{paths.ROOT}{os.sep}", "")
        page.write_text(text, encoding="utf-8", newline="\n")


def _require_all_files():
    """Raise one error that names every missing file and what makes it."""
    needed = {paths.FIGURES / name: f"run {r.name}" for r in results() for name in r.files}
    needed |= {notebook.executed: f"run {notebook.name}" for notebook in CATALOGUE}
    needed |= {PDF: "paper"}
    missing = {file: command for file, command in needed.items() if not file.is_file()}
    if missing:
        root = f"{paths.ROOT}{os.sep}"
        names = [str(file).removeprefix(root) for file in missing]
        commands = list(dict.fromkeys(f"study {command}" for command in missing.values()))
        more = f" and {len(names) - 4} more" if len(names) > 4 else ""
        others = ", ..." if len(commands) > 4 else ""
        raise StudyError(
            f"the report lacks {', '.join(names[:4])}{more}; make it with: "
            f"{', '.join(commands[:4])}{others}"
        )
