"""Sphinx's sources: Markdown pages, executed notebooks, documents, and a file per module."""

import ast
import json
import re
import shutil
from base64 import b64decode
from hashlib import sha256
from pathlib import Path
from posixpath import dirname, join, normpath

from docutils.nodes import make_id
from jinja2 import Environment, PackageLoader

from study import paths
from study.dataset.store import CURVES, PACKAGE
from study.pages.catalogue import CATALOGUE
from study.pages.execute import explained, shown_with
from study.pages.report.claims import VERDICTS
from study.pages.report.curves import curves
from study.pages.report.results import Result

DOCUMENTS = [path.relative_to(paths.ROOT).as_posix() for path in paths.DOCUMENTS]
_LINK = re.compile(r"(!?)\[([^]]*)\]\(([^)#\s]+)(#[^)\s]*)?\)")
_UNIT = re.compile(r"(?<=\d) (?=(?:%|[µnm]?[ms]|[GM]?Pa|N)(?!\w))")
"""Space between a number and its unit, at which no line may break."""
_SIGNS = str.maketrans({"'": "\N{RIGHT SINGLE QUOTATION MARK}"} | dict.fromkeys('"<>&', " "))
"""Sphinx's search would show these signs escaped."""


class Sources:
    """Sources of the report's pages in one folder, and files beside the pages in another.

    ``places`` are found by the search besides pages: objects as of `sphinx.domains.Domain`.
    """

    def __init__(self, folder: Path, pages: Path, results: list[Result]):
        self.places = []
        self._folder, self._pages, self._results = folder, pages, results
        self._templates = Environment(
            loader=PackageLoader("study.pages.report"),
            autoescape=True,
            trim_blocks=True,
            lstrip_blocks=True,
        )
        self._templates.globals |= {"results": results, "verdicts": VERDICTS}
        self._templates.globals |= {"explained": explained, "shown_with": shown_with}
        self._macros = self._templates.get_template("macros.html").module
        self._images = {sha256(r.image.read_bytes()).digest(): r for r in results if r.image}
        self._modules = {}
        for path in sorted((paths.ROOT / "study").rglob("*.py")):
            name = path.relative_to(paths.ROOT).as_posix()
            self._modules[name] = name[:-3].replace("/", ".").removesuffix(".__init__")
        self._pages_of = {name: f"/api/{page}.rst" for name, page in self._modules.items()}
        for name in DOCUMENTS:
            self._pages_of[name] = f"/docs/{name.replace('/', '-').lower()}"
        for result in results:
            page = f"/figures/{result.name}.md"
            self._pages_of |= {f"figures/{file.name}": page for file in result.files}
        for notebook in CATALOGUE:
            page = f"/notebooks/{notebook.name}.ipynb"
            self._pages_of[page[1:]] = self._pages_of[f"build{page[:-6]}.html"] = page

    def write(self, claims: list[dict], executed: Path, paper: Path):
        """Write all of them."""
        self._page("index.md", claims=claims, documents=[self._pages_of[d] for d in DOCUMENTS])
        _copy(paper, self._pages / "paper.pdf")
        for claim in claims:
            self._place(
                f"{claim['claim']}: {claim['statement']}", "claim", "index", claim["anchor"]
            )
        self._page("figures.md")
        for result in self._results:
            judged = [claim for claim in claims if result.name in claim["shown_by"]]
            page, kind = f"figures/{result.name}", "figure" if result.image else "table"
            self._page("figure.md", f"{page}.md", result=result, claims=judged)
            self._place(f"{result.label}: {result.caption}", kind, page, make_id(result.label))
            for file in result.files:
                _copy(file, self._pages / "figures" / file.name)
        titles = [self._notebook(notebook, executed) for notebook in CATALOGUE]
        self._page("notebooks.md", notebooks=list(zip(CATALOGUE, titles, strict=True)))
        for name in DOCUMENTS:
            text = (paths.ROOT / name).read_text(encoding="utf-8")
            _write(f"{self._folder}{self._pages_of[name]}", self._linked(text, dirname(name)))
        self._data()
        lines = {}  # of each module, the first one of its docstring
        for path, name in self._modules.items():
            text = ast.get_docstring(ast.parse((paths.ROOT / path).read_text(encoding="utf-8")))
            lines[name] = (text or "").partition("\n\n")[0]
            inner = [n for n in self._modules.values() if n.rpartition(".")[0] == name]
            self._page("module.rst", f"api/{name}.rst", name=name, inner=inner)
        self._page("library.md", lines=lines)

    def _page(self, template, path=None, **context):
        text = self._templates.get_template(template).render(**context)
        _write(self._folder / (path or template), text)

    def _place(self, title, kind, page, anchor):
        title = title.translate(_SIGNS)
        self.places.append((title, title, kind, page, anchor, 2 if kind == "case" else 1))

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
            _copy(paths.ROOT / path, self._pages / "files" / path)
            return f'<a href="../files/{path}">{words}</a>'

        return _LINK.sub(replaced, text)

    def _notebook(self, notebook, executed):
        """Write an executed notebook with links to the figures it shows, and return its title."""
        text = (executed / f"{notebook.name}.ipynb").read_text(encoding="utf-8")
        content = json.loads(text.replace(str(paths.ROOT), "..."))
        content["metadata"] = {"language_info": {"name": "python", "pygments_lexer": "ipython3"}}
        title = None
        for cell in content["cells"]:
            cell["source"] = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                cell["source"] = self._linked(cell["source"], "notebooks")
                head = re.match(r"# (.+)", cell["source"])
                if head and not title:
                    title, rest = head[1], cell["source"][head.end() :]
                    cell["source"] = f"{head[0]}\n\n{self._macros.note(notebook)}\n{rest}"
            for output in cell.get("outputs", ()):
                data = output.get("data", {})
                if text := "".join(data.get("text/markdown", "")):
                    data["text/markdown"] = _UNIT.sub("\N{NO-BREAK SPACE}", text)
                image = b64decode(data.get("image/png", ""))
                if result := self._images.get(sha256(image).digest()):
                    output["data"] = {"text/html": self._macros.figure(result, "../")}
        _write(self._folder / f"notebooks/{notebook.name}.ipynb", json.dumps(content))
        return title or notebook.name

    def _data(self):
        found = curves()
        text = json.dumps(found, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
        _write(self._pages / "data.js", f"window.STUDY_DATA={text};\n")
        for file in (CURVES, PACKAGE):
            _copy(file, self._pages / "data" / file.name)
        package = json.loads(PACKAGE.read_text(encoding="utf-8"))
        self._page("data.md", **found, fields=package["resources"][0]["schema"]["fields"])
        for case in found["cases"]:
            self._place(case["name"], "case", "data", f"case={case['name']}")


def _write(path, text):
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8", newline="\n")


def _copy(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)
