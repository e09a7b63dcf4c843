"""One set of pages: the frame around each, links between them, and what the search finds."""

import json
import re
import shutil
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from pygments.formatters import HtmlFormatter

ASSETS = ("report.css", "search.js", "plot.js")


def anchor(text):
    """Name of a place in a page, as GitHub makes them of headings."""
    return re.sub(r"[^\w\- ]", "", text.lower()).strip().replace(" ", "-")


class Site:
    """Pages under one folder.

    Parameters
    ----------
    folder : pathlib.Path
        Made by this call.
    """

    INDEX = "search-index.js"

    def __init__(self, folder):
        self.folder = folder
        self.sources = {}  # path in the repository -> page or file of the report
        self._entries = []
        self._templates = Environment(
            loader=PackageLoader("study.pages.report"),
            autoescape=True,
            trim_blocks=True,
            lstrip_blocks=True,
            undefined=StrictUndefined,
        )
        folder.mkdir()

    def page(self, path, template, title, **content):
        """Write one page: ``template`` with ``content``, ``root`` being the way to the start."""
        text = self._templates.get_template(template).render(
            title=title, path=path, root=self.root(path), **content
        )
        self.text(path, text + "\n")

    def text(self, path, text):
        """Write a text file."""
        target = self.folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8", newline="\n")

    def script(self, path, name, value):
        """Write a value as a script that assigns a global: pages on disk cannot fetch."""
        value = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
        self.text(path, f"window.{name}={value};\n")

    def copy(self, source, path):
        """Copy a file into the report."""
        target = self.folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, target)

    def find(self, kind, title, text, target):
        """Let the search find ``target`` by its title and its text."""
        text = re.sub(r"\s+", " ", text).strip()
        self._entries.append({"kind": kind, "title": title, "text": text, "url": target})

    def finish(self):
        """Write the search's index, styles and scripts."""
        self.script(self.INDEX, "SEARCH_INDEX", self._entries)
        for name in ASSETS:
            self.copy(Path(__file__).with_name(name), name)
        codes = [".highlight", ".pdoc-code"]
        light, dark = (
            HtmlFormatter(style=style).get_style_defs(codes) for style in ("default", "github-dark")
        )
        dark = f"@media screen and (prefers-color-scheme: dark) {{\n{dark}\n}}"
        self.text("highlight.css", f"{light}\n{dark}\n")

    @staticmethod
    def root(path):
        """The way from a page to the report's folder: ``../`` per folder."""
        return "../" * path.count("/")
