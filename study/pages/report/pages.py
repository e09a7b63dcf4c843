"""Sphinx's sources: Markdown pages, executed notebooks, documents, and a file per module."""

import ast
import json
import re
from base64 import b64decode
from pathlib import Path
from posixpath import dirname, join, normpath
from typing import Any

from docutils.nodes import make_id
from jinja2 import Environment, PackageLoader

from study import paths
from study.checks import StudyError
from study.dataset.store import CURVES, PACKAGE
from study.pages import catalogue
from study.pages.catalogue import CATALOGUE
from study.pages.execute import parameters
from study.pages.report.numbers import curves, joint_data
from study.pages.typeset import PDFS

DOCUMENTS = [path.relative_to(paths.ROOT).as_posix() for path in paths.DOCUMENTS]
KINDS = ("claim", "figure", "table", "case")
"""What the search finds a place of, besides pages."""
VERDICTS = {"contradicted": "✗", "undecided": "?", "reproduced": "✓"}
"""Verdict -> sign, as colour alone must not distinguish verdicts."""
GROUPS = {
    "implied only": "Assumptions that the paper only implies",
    "used to identify": "Statements used to infer the reference joint, or following from it",
    "trivially satisfied": "Statements that nearly any result would satisfy",
}
"""Kinds of claims that are not counted as statements of the paper, as headings."""
_LINK = re.compile(r"(!?)\[([^]]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")
_UNIT = re.compile(r"(?<=\d) (?=(?:%|[µnm]?[ms]|[GM]?Pa|N)(?!\w))")
"""Space between a number and its unit, at which no line may break."""
_SIGNS = str.maketrans({"'": "\N{RIGHT SINGLE QUOTATION MARK}"} | dict.fromkeys('"<>&', " "))
"""Sphinx's search would show these signs escaped."""


def write(sources: Path, pages: Path) -> list[tuple[str, str, str, str]]:
    """Write Sphinx's sources to a folder, and files that the pages link to, to another.

    Return title, kind (of `KINDS`), page and anchor of each place that the search should find.
    """
    return _Sources(sources, pages).write(read_claims())


def read_claims() -> list[dict[str, Any]]:
    """Rows of the result ``claims``, each with its ``group``, ``anchor`` and ``shown_by``."""
    (result,) = (result for result in catalogue.results() if result.name == "claims")
    head, *rows = result.rows()
    claims: list[dict[str, Any]] = [dict(zip(head, row, strict=True)) for row in rows]
    for claim in claims:
        claim["shown_by"] = f"{claim['figure']} {claim['evidence']}".split()
        claim["group"] = GROUPS.get(claim["kind"]) or f"Stated by the paper: {claim['verdict']}"
        claim["anchor"] = make_id(f"claim-{claim['claim']}")
    return claims


def modules() -> list[Path]:
    """Files of the library that have a page: all but the commands and these pages themselves."""
    library = paths.ROOT / "study"
    hidden = library / "cli", library / "pages"
    return sorted(path for path in library.rglob("*.py") if not {*hidden} & {*path.parents})


class _Sources:
    """Sources of the pages in one folder, and files that the pages link to in another."""

    def __init__(self, folder, pages):
        self._folder, self._pages, self._results = folder, pages, catalogue.results()
        self._places = []
        loader = PackageLoader("study.pages.report")
        self._templates = Environment(
            loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True
        )
        self._templates.globals |= {"results": self._results, "verdicts": VERDICTS}
        self._templates.globals |= {"parameters": parameters, "notebooks": CATALOGUE}
        self._macros = self._templates.get_template("macros.html").module
        self._modules = {}
        for path in modules():
            name = path.relative_to(paths.ROOT).as_posix()
            self._modules[name] = name[:-3].replace("/", ".").removesuffix(".__init__")
        self._pages_of = {name: f"/api/{page}.rst" for name, page in self._modules.items()}
        for name in DOCUMENTS:
            self._pages_of[name] = f"/docs/{name.replace('/', '-').lower()}"
        self._images = {}
        for result in self._results:
            for name in result.files:
                self._pages_of[f"figures/{name}"] = f"/figures/{result.name}.md"
                self._images[paths.read_result(name).read_bytes()] = result
        for notebook in CATALOGUE:
            page = f"/notebooks/{notebook.name}.ipynb"
            self._pages_of[page[1:]] = self._pages_of[f"build{page[:-6]}.html"] = page

    def write(self, claims):
        """Write all of them, and return the places."""
        documents = [self._pages_of[name] for name in DOCUMENTS]
        for page in ("index.md", "evidence.md", "statements.md"):
            self._page(page, claims=claims, documents=documents)
        for pdf in PDFS:
            paths.copy(pdf, self._pages / pdf.name)
        for claim in claims:
            title = f"{claim['claim']}: {claim['statement']}"
            self._place(title, "claim", "statements", claim["anchor"])
        self._page("figures.md")
        self._page("results.md", claims=claims)
        for result in self._results:
            compared = [claim for claim in claims if result.name in claim["shown_by"]]
            page, kind = f"figures/{result.name}", "figure" if result.is_figure else "table"
            (notebook,) = (nb for nb in CATALOGUE if nb.name == result.notebook)
            shown = {"result": result, "claims": compared, "notebook": notebook}
            self._page("figure.md", f"{page}.md", **shown)
            self._place(f"{result.label}: {result.shows}", kind, page, make_id(result.label))
            for name in result.files:
                paths.copy(paths.read_result(name), self._pages / "figures" / name)
        self._page("notebooks.md")
        for notebook in CATALOGUE:
            self._notebook(notebook)
        for name in DOCUMENTS:
            text = (paths.ROOT / name).read_text(encoding="utf-8")
            _write(f"{self._folder}{self._pages_of[name]}", self._linked(text, dirname(name)))
        _write_numbers(self._pages / "joint_data.js", "JOINT_DATA", joint := joint_data())
        self._page("joint.md", materials=joint["materials"])
        self._data()
        self._library()
        return self._places

    def _page(self, template, path=None, **context):
        text = self._templates.get_template(template).render(**context)
        _write(self._folder / (path or template), text)

    def _place(self, title, kind, page, anchor):
        self._places.append((title.translate(_SIGNS), kind, page, anchor))

    def _linked(self, text, folder):
        """Markdown from the repository's ``folder``, its links to pages or to copies of files."""

        def replaced(match):
            image, words, path, place = match.groups(default="")
            if re.match(r"(https?|mailto):", path):
                return match[0]
            path = normpath(join(folder, path))
            if image:
                result = next(r for r in self._results if path == f"figures/{r.name}.png")
                return self._macros.figure(result, "../")
            if path in self._pages_of:
                return f"[{words}]({self._pages_of[path]}{place})"
            if not (paths.ROOT / path).is_file():
                return words
            paths.copy(paths.ROOT / path, self._pages / "files" / path)
            return f'<a href="../files/{path}">{words}</a>'

        return _LINK.sub(replaced, text)

    def _notebook(self, notebook):
        """Write an executed notebook, with a note below its title and links to the figures."""
        text = notebook.executed.read_text(encoding="utf-8")
        try:
            content = json.loads(text.replace(str(paths.ROOT), "..."))
        except ValueError:
            again = f"make it again with: study run {notebook.name} --force"
            raise StudyError(f"{paths.shown(notebook.executed)} is damaged; {again}") from None
        content["metadata"] = {"language_info": {"name": "python", "pygments_lexer": "ipython3"}}
        for cell in content["cells"]:
            cell["source"] = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                cell["source"] = self._linked(cell["source"], "notebooks")
            for output in cell.get("outputs", ()):
                data = output.get("data", {})
                if text := "".join(data.get("text/markdown", "")):
                    data["text/markdown"] = _UNIT.sub("\N{NO-BREAK SPACE}", text)
                if result := self._images.get(b64decode(data.get("image/png", ""))):
                    output["data"] = {"text/html": self._macros.figure(result, "../")}
        first = content["cells"][0]
        title, _, rest = first["source"].partition("\n")
        first["source"] = f"{title}\n\n{self._macros.note(notebook)}\n\n{rest}"
        _write(self._folder / f"notebooks/{notebook.name}.ipynb", json.dumps(content))

    def _data(self):
        """Write the page of the dataset, and the numbers that its plot shows."""
        shown = curves()
        _write_numbers(self._pages / "data.js", "STUDY_DATA", shown)
        for file in (CURVES, PACKAGE):
            paths.copy(file, self._pages / "data" / file.name)
        package = json.loads(PACKAGE.read_text(encoding="utf-8"))
        self._page("data.md", **shown, fields=package["resources"][0]["schema"]["fields"])
        for case in shown["cases"]:
            self._place(case["name"], "case", "data", f"case={case['name']}")

    def _library(self):
        """Write a page for each module, and one with the first lines of their docstrings."""
        lines = {}
        for path, name in self._modules.items():
            text = ast.get_docstring(ast.parse((paths.ROOT / path).read_text(encoding="utf-8")))
            lines[name] = (text or "").partition("\n\n")[0]
            self._page("module.rst", f"api/{name}.rst", name=name)
        self._page("library.md", lines=lines)


def _write_numbers(path, name, numbers):
    text = json.dumps(numbers, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    _write(path, f"window.{name}={text};\n")


def _write(path, text):
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8", newline="\n")
