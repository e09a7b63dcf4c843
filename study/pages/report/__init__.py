"""The study as a set of pages to browse: claims, figures, notebooks, data, library, documents.

The pages open from disk: no server, no network, nothing is loaded from outside the folder. They
show what is already there (results, executed notebooks, data, documents) and compute nothing
but the laws at the depths of the dataset.
"""

import tempfile
from pathlib import Path

from study import paths
from study.checks import StudyError
from study.pages.catalogue import CATALOGUE
from study.pages.report import pages
from study.pages.report.claims import read_claims
from study.pages.report.results import results
from study.pages.report.site import Site

__all__ = ["write"]


def write(folder, *, figures=None, executed=None, paper=None):
    """Write the report, whole or not at all; one that is already there is replaced.

    Parameters
    ----------
    folder : path-like
        Where the report goes, its start is ``index.html``.
    figures : path-like, optional
        Folder of the results, by default ``figures/``.
    executed : path-like, optional
        Folder of the executed notebooks, by default ``build/notebooks/``.
    paper : path-like, optional
        The paper, by default ``build/paper.pdf``.

    Returns
    -------
    pathlib.Path
        The report's ``index.html``.

    Raises
    ------
    study.checks.StudyError
        If a result, an executed notebook or the paper is missing, or the table of claims is
        damaged; names it and the command that makes it.
    ValueError
        If ``folder`` holds anything else than a report.
    """
    folder = Path(folder).absolute()
    figures = Path(figures or paths.FIGURES)
    executed = Path(executed or paths.BUILD / "notebooks")
    paper = Path(paper or paths.BUILD / "paper.pdf")
    if folder.is_file() or (
        folder.is_dir() and any(folder.iterdir()) and not (folder / Site.INDEX).is_file()
    ):
        raise ValueError(f"folder must be empty or hold a report, got {folder}")
    shown = results(figures)
    _require(shown, executed, paper)
    claims = read_claims(figures / "claims.csv", [result.name for result in shown])
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}-", dir=folder.parent) as work:
        new = Path(work, "new")
        site = Site(new)
        pages.write_all(site, shown, claims, executed, paper)
        site.finish()
        if folder.exists():
            folder.rename(Path(work, "old"))
        new.rename(folder)
    return folder / "index.html"


def _require(shown, executed, paper):
    """Raise one error that names every missing file and what makes it."""
    needed = {file: f"run {result.name}" for result in shown for file in result.files}
    needed |= {executed / f"{nb.name}.ipynb": f"run {nb.name}" for nb in CATALOGUE}
    needed |= {paper: "paper"}
    missing = {file: command for file, command in needed.items() if not file.is_file()}
    if missing:
        names = [str(_short(file)) for file in missing]
        commands = list(dict.fromkeys(f"study {command}" for command in missing.values()))
        more = f" and {len(names) - 4} more" if len(names) > 4 else ""
        others = ", ..." if len(commands) > 4 else ""
        raise StudyError(
            f"the report lacks {', '.join(names[:4])}{more}; make it with: "
            f"{', '.join(commands[:4])}{others}"
        )


def _short(file):
    return file.relative_to(paths.ROOT) if file.is_relative_to(paths.ROOT) else file
