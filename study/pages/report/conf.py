"""Sphinx's settings for the report, and formulas as MathML, which need no network."""

import re
from pathlib import Path
from types import GenericAlias

import numpy as np
import plotly
from docutils import nodes
from latex2mathml.converter import convert
from numpy.typing import ArrayLike, NDArray
from sphinx.domains import ObjType
from sphinx.util.typing import stringify_annotation

from study.pages.report import pages

project = html_title = "Contact in spherical clearance joints"
extensions = ["myst_nb", "numpydoc", "sphinx.ext.autodoc", "sphinx.ext.viewcode"]

nb_execution_mode = "off"
nb_render_markdown_format = "myst"
myst_enable_extensions = ["dollarmath"]
myst_dmath_double_inline = True
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]

default_role = "py:obj"
autodoc_default_options = {"members": True, "ignore-module-all": True}
viewcode_follow_imported_members = False  # nor values of attributes, such as `object`
autodoc_member_order = "bysource"
numpydoc_show_class_members = False

html_theme = "furo"
templates_path = ["templates"]  # the search page needs a heading
html_static_path = ["static", str(Path(plotly.__file__).parent / "package_data/plotly.min.js")]
html_css_files = ["report.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_copyright = False
html_show_search_summary = False  # it would fetch pages, which browsers refuse on disk
html_use_index = False
html_domain_indices = False

_FUNCTION = re.compile(
    r"(<mi>(?:sin|cos|tan|ln|log|exp|max|min)</mi>)(?=<m(?:i|n|frac|sqrt|sub)\b)"
)
_SHORT = {
    stringify_annotation(kind, "smart"): name
    for kind, name in ((ArrayLike, "ArrayLike"), (NDArray[np.float64], "NDArray[float64]"))
}


def setup(app):
    """Add what Sphinx lacks: sources, formulas, places that its search finds, short types."""
    app.add_html_math_renderer("mathml", (_formula("inline"), None), (_formula("block"), None))
    kinds = {kind: ObjType(kind) for kind in pages.KINDS}  # without directives: figure has one
    app.registry.domain_object_types.setdefault("std", {}).update(kinds)
    app.connect("builder-inited", _write_sources)
    app.connect("env-updated", _add_places)
    app.connect("autodoc-process-signature", _shorten, priority=400)  # in place of numpydoc's
    app.connect("autodoc-skip-member", _skip_alias)


def mathml(latex, display="inline"):
    """MathML of a formula in LaTeX, with TeX's spaces around stars, slashes and functions."""
    formula = convert(latex.strip(), display=display)
    for code, sign in (("&#x0002A;", "&#x02217;"), ("&#x0002F;", "&#x0002F;")):
        formula = formula.replace(f"<mo>{code}</mo>", f'<mo lspace="0" rspace="0">{sign}</mo>')
    return _FUNCTION.sub(r'\1<mspace width="0.167em"/>', formula)


def _formula(display):
    def visit(translator, node):
        translator.body.append(mathml(node.astext(), display))
        raise nodes.SkipNode

    return visit


def _write_sources(app):
    app.places = pages.write(app.srcdir, app.outdir)


def _add_places(app, env):
    """Let the search find claims, results and cases, each with its place in a page."""
    for title, kind, page, anchor in app.places:
        env.domains.standard_domain.objects[kind, title] = page, anchor


def _shorten(app, what, name, item, options, *signature):
    """Name types of arrays, of which a signature would show the long definition."""
    for long, short in _SHORT.items():
        signature = [text and text.replace(long, short) for text in signature]
    return tuple(signature)


def _skip_alias(app, what, name, item, skip, options):
    """Leave out names of types, which would be documented as the built-in types they are."""
    return isinstance(item, GenericAlias) or None
