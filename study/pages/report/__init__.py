"""The study as a set of pages to browse: claims, figures, notebooks, data, library, documents.

Sphinx makes the pages. They open from disk, without a server, and load nothing from outside the
folder. They show what is already there (results, executed notebooks, data, documents) and compute
only the laws at the depths of the dataset.
"""

import io
import os
import re
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util.docutils import docutils_namespace, patch_docutils

from study import paths
from study.checks import StudyError
from study.pages.catalogue import CATALOGUE
from study.pages.report.claims import read_claims
from study.pages.report.results import results
from study.pages.report.sources import Sources

__all__ = ["write"]

SETTINGS = {
    "project": "Contact in spherical clearance joints",
    "extensions": [
        *("myst_nb", "numpydoc", "sphinx.ext.autodoc", "sphinx.ext.viewcode"),
        "study.pages.report.extension",
    ],
    "nb_execution_mode": "off",
    "nb_render_markdown_format": "myst",
    "myst_enable_extensions": ["dollarmath"],
    "myst_dmath_double_inline": True,
    "myst_heading_anchors": 4,
    "suppress_warnings": ["myst.header"],
    "default_role": "py:obj",
    "autodoc_default_options": {"members": True, "ignore-module-all": True},
    "autodoc_member_order": "bysource",
    "numpydoc_show_class_members": False,
    "html_theme": "furo",
    "html_title": "Contact in spherical clearance joints",
    "html_static_path": [str(Path(__file__).with_name("static"))],
    "html_css_files": ["report.css"],
    "html_math_renderer": "mathml",
    "html_copy_source": False,
    "html_show_copyright": False,
    "html_show_search_summary": False,  # it would fetch pages, which browsers refuse on disk
    "html_use_index": False,
    "html_domain_indices": False,
}
MARK = "figures.html"  # by which a report is known


def write(
    folder: str | os.PathLike,
    *,
    figures: str | os.PathLike | None = None,
    executed: str | os.PathLike | None = None,
    paper: str | os.PathLike | None = None,
) -> Path:
    """Write the report, whole or not at all; one that is already there is replaced.

    Parameters
    ----------
    folder
        Where the report goes.
    figures
        Folder of the results, by default ``figures/``.
    executed
        Folder of the executed notebooks, by default ``build/notebooks/``.
    paper
        By default ``build/paper.pdf``.

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
    executed = Path(executed or paths.BUILD / "notebooks")
    paper = Path(paper or paths.BUILD / "paper.pdf")
    if folder.is_file() or (
        folder.is_dir() and any(folder.iterdir()) and not (folder / MARK).is_file()
    ):
        raise ValueError(f"folder must be empty or hold a report, got {folder}")
    shown = results(Path(figures or paths.FIGURES))
    _require(shown, executed, paper)
    numbers = next(result.numbers for result in shown if result.name == "claims")
    claims = read_claims(numbers, [result.name for result in shown])
    folder.parent.mkdir(parents=True, exist_ok=True)
    with paths.scratch(folder.parent) as work:
        sources = Sources(work / "sources", work / "pages", shown)
        sources.write(claims, executed, paper)
        _build(work, sources.places)
        if folder.exists():
            folder.rename(work / "old")
        (work / "pages").rename(folder)
    return folder / "index.html"


def _build(work, places):
    """Run Sphinx from ``sources`` to ``pages`` in the folder ``work``; a warning is an error."""
    sources, warnings = work / "sources", io.StringIO()
    folders = (sources, None, work / "pages", work / "doctrees")
    with patch_docutils(), docutils_namespace():
        app = Sphinx(
            *folders,
            "html",
            SETTINGS | {"report_places": places},
            status=None,
            warning=warnings,
            parallel=os.cpu_count() or 1,
        )
        app.build()
    told = re.sub(r"\x1b\[[\d;]*m", "", warnings.getvalue()).strip().replace(f"{sources}/", "")
    if told:
        raise StudyError(f"the report: {told.splitlines()[0]}")
    for page in (work / "pages" / "api").glob("*.html"):  # values and defaults that are paths
        text = page.read_text(encoding="utf-8").replace(f"{paths.ROOT}{os.sep}", "")
        page.write_text(text, encoding="utf-8", newline="\n")


def _require(shown, executed, paper):
    """Raise one error that names every missing file and what makes it."""
    needed = {file: f"run {result.name}" for result in shown for file in result.files}
    needed |= {executed / f"{nb.name}.ipynb": f"run {nb.name}" for nb in CATALOGUE}
    needed |= {paper: "paper"}
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
