"""Additions to Sphinx: formulas as MathML, places that its search finds, short annotations."""

import re
from types import GenericAlias

import numpy as np
from docutils import nodes
from jinja2.sandbox import SandboxedEnvironment
from latex2mathml.converter import convert
from numpy.typing import ArrayLike, NDArray
from numpydoc import docscrape_sphinx
from sphinx.domains import Domain
from sphinx.util.typing import stringify_annotation

_FUNCTION = re.compile(
    r"(<mi>(?:sin|cos|tan|ln|log|exp|max|min)</mi>)(?=<m(?:i|n|frac|sqrt|sub)\b)"
)
_SHORT = {
    stringify_annotation(kind, "smart"): name
    for kind, name in ((ArrayLike, "ArrayLike"), (NDArray[np.float64], "NDArray[float64]"))
}


def mathml(latex: str, display: str = "inline") -> str:
    """MathML of a formula in LaTeX, with TeX's spaces around stars, slashes and functions."""
    found = convert(latex.strip(), display=display)
    for code, sign in (("&#x0002A;", "&#x02217;"), ("&#x0002F;", "&#x0002F;")):
        found = found.replace(f"<mo>{code}</mo>", f'<mo lspace="0" rspace="0">{sign}</mo>')
    return _FUNCTION.sub(r'\1<mspace width="0.167em"/>', found)


class Places(Domain):
    """Claims, results and cases, by which the search finds a place in a page."""

    name = "places"

    def get_objects(self):
        """Entries of the setting ``report_places``."""
        return self.env.config.report_places

    def merge_domaindata(self, docnames, otherdata):
        """Do nothing: a page adds no place while it is read."""


def setup(app):
    """Register all of it."""
    kept = {}  # numpydoc would compile its template anew for each docstring
    docscrape_sphinx.SandboxedEnvironment = lambda loader: kept.setdefault(
        "environment", SandboxedEnvironment(loader=loader)
    )
    app.add_config_value("report_places", [], "env", list)
    app.add_domain(Places)
    app.add_html_math_renderer("mathml", (_formula("inline"), None), (_formula("block"), None))
    app.connect("autodoc-process-signature", _shorten, priority=400)  # in place of numpydoc's
    app.connect("autodoc-skip-member", _skip_alias)
    app.connect("html-page-context", _collapse, priority=400)  # before the theme's
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _formula(display):
    def visit(translator, node):
        translator.body.append(mathml(node.astext(), display))
        raise nodes.SkipNode

    return visit


def _shorten(app, what, name, item, options, *signature):
    for long, short in _SHORT.items():
        signature = [text and text.replace(long, short) for text in signature]
    return tuple(signature)


def _skip_alias(app, what, name, item, skip, options):
    """Leave out names of types, which would be documented as the built-in types they are."""
    return isinstance(item, GenericAlias) or None


def _collapse(app, page, template, context, doctree):
    """Show only the current branch of the contents: all of them on every page take long."""
    toctree = context["toctree"]
    context["toctree"] = lambda **options: toctree(**options | {"collapse": True})
