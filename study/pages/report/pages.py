"""The pages, subject by subject: each function writes its pages and lets the search find them."""

import hashlib
import html
import pkgutil
import posixpath
import re
from base64 import b64decode
from collections import Counter
from inspect import signature
from pathlib import Path

import nbformat
import pdoc
from markupsafe import Markup
from nbconvert import HTMLExporter
from nbformat import v4

import study
from study import paths
from study.dataset import store
from study.pages.catalogue import CATALOGUE
from study.pages.report.claims import VERDICTS
from study.pages.report.curves import PARAMETERS, curves, describe
from study.pages.report.prose import Prose
from study.pages.report.results import ROWS

HEADLINE = "trend"


def write_all(site, results, claims, executed, paper):
    """Write every page but the search's index.

    Parameters
    ----------
    site : study.pages.report.site.Site
    results : list of study.pages.report.results.Result
    claims : list of dict
        From `study.pages.report.claims.read_claims`.
    executed, paper : pathlib.Path
        As for `study.pages.report.write`.
    """
    documents = [path.relative_to(paths.ROOT).as_posix() for path in paths.DOCUMENTS]
    modules = ["study", *(m.name for m in pkgutil.walk_packages(study.__path__, "study."))]
    for result in results:
        for file in result.files:
            site.sources[f"figures/{file.name}"] = f"figures/{result.name}.html"
    for notebook in CATALOGUE:
        site.sources[f"notebooks/{notebook.path.name}"] = f"notebooks/{notebook.name}.html"
    for name in documents:
        site.sources[name] = _document_page(name)
    for name in modules:
        path = f"{name.replace('.', '/')}.html"
        site.sources |= {path[:-5] + end: f"api/{path}" for end in (".py", "")}
    for file in (store.CURVES, store.PACKAGE):
        site.copy(file, f"data/{file.name}")
        site.sources[f"data/{file.name}"] = f"data/{file.name}"
    site.copy(paper, "paper.pdf")
    _claims(site, results, claims)
    _figures(site, results, claims)
    _notebooks(site, results, executed)
    _data(site)
    _documents(site, documents)
    _library(site, modules)


def _claims(site, results, claims):
    counts = Counter(claim["verdict"] for claim in claims)
    headline = next(result for result in results if result.name == HEADLINE)
    names = {result.name: result.label for result in results}
    parts = {}
    for claim in claims:
        parts.setdefault(claim["group"], []).append(claim)
    context = {"claims": claims, "parts": parts, "counts": counts, "names": names}
    site.page("index.html", "index.html", "Claims", headline=headline, verdicts=VERDICTS, **context)
    for claim in claims:
        text = " ".join(claim[c] for c in ("where", "measure", "found", "verdict"))
        title = f"{claim['claim']}: {claim['statement']}"
        site.find("claim", title, text, f"index.html#{claim['anchor']}")


def _figures(site, results, claims):
    tables = {result.name: result.table() for result in results}
    site.page("figures.html", "figures.html", "Figures and tables", results=results, tables=tables)
    for result in results:
        judged = [claim for claim in claims if result.name in claim["shown_by"]]
        page = f"figures/{result.name}.html"
        table = tables[result.name]
        site.page(
            page,
            "figure.html",
            result.label,
            result=result,
            table=table,
            claims=judged,
            most=ROWS,
            results=results,
        )
        for file in result.files:
            site.copy(file, f"figures/{file.name}")
        text = f"{result.name} {result.caption} {' '.join(table['head'])}"
        kind = "figure" if result.image else "table"
        site.find(kind, f"{result.label}: {result.caption}", text, page)


def _notebooks(site, results, executed):
    images = {_hash(r.image.read_bytes()): r for r in results if r.image}
    exporter = HTMLExporter(template_name="basic")
    exporter.register_filter("clean_html", lambda text: text)  # slow; the notebooks are ours
    titles = {}
    for notebook in CATALOGUE:
        page = f"notebooks/{notebook.name}.html"
        prose = Prose(site, page, "notebooks")
        content = nbformat.read(executed / f"{notebook.name}.ipynb", as_version=4)
        for cell in content.cells:
            if cell.cell_type == "code":
                cell.outputs = [_linked(output, images) for output in cell.outputs]
        exporter.register_filter("markdown2html", prose.render)
        body, _ = exporter.from_notebook_node(content)
        titles[notebook.name] = prose.title or notebook.name
        context = {"notebook": notebook, "sections": prose.sections, "results": results}
        body = Markup(body.replace(str(paths.ROOT), "..."))
        site.page(page, "notebook.html", titles[notebook.name], body=body, **context)
        prose.find(site, "notebook", page)
    context = {"notebooks": CATALOGUE, "titles": titles, "results": results}
    site.page("notebooks/index.html", "notebooks.html", "Notebooks", **context)


def _linked(output, images):
    """An output; in place of a figure's image, the figure of the report with a link."""
    image = output.get("data", {}).get("image/png")
    result = images.get(_hash(b64decode(image))) if image else None
    if not result:
        return output
    width, height = result.size()
    caption = html.escape(result.caption)
    text = (
        f'<a class="figure" href="../figures/{result.name}.html">'
        f'<img src="../figures/{result.name}.png" width="{width}" height="{height}" '
        f'loading="lazy" alt="{caption}"></a>'
    )
    return v4.new_output("display_data", {"text/html": text})


def _hash(content):
    return hashlib.sha256(content).hexdigest()


def _data(site):
    found = curves()
    site.script("data.js", "STUDY_DATA", found)
    counts = Counter(case["group"] for case in found["cases"])
    context = {"parameters": PARAMETERS, "groups": found["groups"], "counts": counts}
    site.page("data.html", "data.html", "Data", looks=found["looks"], **context)
    for case in found["cases"]:
        site.find("case", case["name"], describe(case), f"data.html#case={case['name']}")


def _document_page(name):
    return f"docs/{name[:-3].replace('/', '-').lower()}.html"


def _documents(site, names):
    pages = {name: _document_page(name) for name in names}
    for name, page in pages.items():
        prose = Prose(site, page, posixpath.dirname(name))
        body = prose.render((paths.ROOT / name).read_text(encoding="utf-8"))
        context = {"name": name, "documents": pages, "sections": prose.sections}
        site.page(page, "document.html", prose.title, body=body, **context)
        prose.find(site, "document", page)


def _library(site, names):
    """Pages of the library by pdoc, in the report's frame."""
    templates = Path(__file__).parent / "templates" / "api"
    pdoc.render.configure(docformat="numpy", search=False, template_directory=templates)
    modules = {name: pdoc.doc.Module.from_name(name) for name in names}
    site.text("api/pdoc.css", pdoc.render.env.get_template("content.css").render())
    for name, module in modules.items():
        for member in module.flattened_own_members:
            if hasattr(getattr(member, "wrapped", None), "__signature__"):
                member.signature = signature(member.wrapped)  # not that of what it wraps
        page = f"api/{name.replace('.', '/')}.html"
        body = pdoc.render.html_module(module, modules).replace(str(paths.ROOT), "...")
        body = body.replace("<main ", "<article ").replace("</main>", "</article>")  # one per page
        site.page(page, "library.html", name, body=Markup(body))
        site.find("library", name, _first_line(module), page)
        for member in module.flattened_own_members:
            inner = member.own_members if member.kind == "class" else []
            for item in (member, *inner):
                if not re.search(r"(^|\.)_", item.qualname):
                    title = f"{name}.{item.qualname}"
                    site.find("library", title, _first_line(item), f"{page}#{item.qualname}")
    lines = {name: _first_line(module) for name, module in modules.items()}
    site.page("api/index.html", "modules.html", "Library", modules=lines)


def _first_line(item):
    return item.docstring.strip().partition("\n\n")[0].replace("\n", " ")
