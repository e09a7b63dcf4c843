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
from sphinx.errors import ExtensionError
from sphinx.util.docutils import docutils_namespace, patch_docutils

from study import paths
from study.checks import StudyError


def write(folder: Path) -> Path:
    """Write the report, whole or not at all, in place of an old one; return its ``index.html``."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with paths.scratch(folder.parent) as work:
        build(work / "sources", work / "pages")
        if folder.exists():
            folder.rename(work / "old")
        (work / "pages").rename(folder)
    return folder / "index.html"


def build(sources: Path, pages: Path) -> None:
    """Let Sphinx write the sources and make pages from them; a warning raises `StudyError`."""
    sources.mkdir()
    warnings, here = io.StringIO(), Path(__file__).parent
    with patch_docutils(), docutils_namespace():
        folders = sources, here, pages, sources.with_name("doctrees")
        jobs = (os.cpu_count() or 1) + 1  # one hands pages out while the others write them
        try:
            Sphinx(*folders, "html", status=None, warning=warnings, parallel=jobs).build()
        except ExtensionError as error:  # of our own sources, whose error says what is wrong
            raise error.orig_exc or error from None
    warned = re.sub(r"\x1b\[[\d;]*m", "", warnings.getvalue()).strip().replace(f"{sources}/", "")
    if warned:
        raise StudyError(f"the report: {warned.splitlines()[0]}")
    for page in (pages / "api").glob("*.html"):  # values and defaults that are paths
        text = page.read_text(encoding="utf-8").replace(f"{paths.ROOT}{os.sep}", "")
        page.write_text(text, encoding="utf-8", newline="\n")
