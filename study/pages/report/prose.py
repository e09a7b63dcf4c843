"""Markdown to HTML: formulas as MathML, links to the report's pages, text for the search."""

import html
import posixpath
import re

from latex2mathml.converter import convert
from markupsafe import Markup
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath

from study.pages.report.site import anchor

_FUNCTION = re.compile(
    r"(<mi>(?:sin|cos|tan|ln|log|exp|max|min)</mi>)(?=<m(?:i|n|frac|sqrt|sub)\b)"
)
_HEADING = re.compile(r'<h(\d) id="([^"]+)">(.*?)</h\1>')
_TAG = re.compile(r"<[^>]+>")


class Prose:
    """The Markdown of one page.

    Parameters
    ----------
    site : study.pages.report.site.Site
        Knows which files of the repository have pages.
    page : str
        Path of the page in the report.
    folder : str
        Folder of the source in the repository, to which its links are relative.

    Attributes
    ----------
    sections : list of dict
        ``level``, ``anchor``, ``title`` and ``text`` of every section so far; the first one has
        no title.
    """

    def __init__(self, site, page, folder=""):
        self.sections = [{"level": 0, "anchor": "", "title": "", "text": ""}]
        self._markdown = MarkdownWithMath(renderer=_Renderer(site, page, folder))

    def render(self, source):
        """HTML of some Markdown."""
        text = self._markdown.render(source)
        first, *rest = _HEADING.split(text)
        self.sections[-1]["text"] += plain(first) + " "
        for level, name, title, body in zip(*[iter(rest)] * 4, strict=True):
            section = {"level": int(level), "anchor": name, "title": plain(title)}
            self.sections.append(section | {"text": plain(body) + " "})
        return Markup(text)  # the repository's own documents and notebooks

    @property
    def title(self):
        """The first heading."""
        return next((s["title"] for s in self.sections if s["title"]), "")

    def find(self, site, kind, page):
        """Let the search find every section."""
        for section in self.sections:
            title = " · ".join(dict.fromkeys(t for t in (self.title, section["title"]) if t))
            if section["title"] or section["text"].strip():
                place = f"#{section['anchor']}" if section["anchor"] else ""
                site.find(kind, title or page, section["text"], page + place)


class _Renderer(IPythonRenderer):
    def __init__(self, site, page, folder):
        super().__init__(escape=False)
        self._site, self._page, self._folder, self._anchors = site, page, folder, set()

    def heading(self, text, level, **attrs):
        base = name = anchor(plain(text)) or "section"
        number = 1
        while name in self._anchors:
            name, number = f"{base}-{number}", number + 1
        self._anchors.add(name)
        return f'<h{level} id="{name}">{text}</h{level}>\n'

    def inline_math(self, body):
        return mathml(body)

    def block_math(self, body):
        return mathml(body, "block")

    def link(self, text, url, title=None):
        url = self._there(url)
        if url is None:
            return text if text.startswith("<code>") else f"<code>{text}</code>"
        return super().link(text, url, title)

    def image(self, text, url, title=None):
        page = self._there(url)
        if page is None:
            return f"<em>{html.escape(text)}</em>"
        shown = super().image(text, page.removesuffix(".html") + ".png", title)
        return f'<a class="figure" href="{page}">{shown}</a>'

    def _there(self, url):
        """Link from this page to what the repository's link means; None if nothing is there."""
        if re.match(r"(https?:|mailto:|#)", url):
            return url
        path, _, place = url.partition("#")
        target = self._site.sources.get(posixpath.normpath(posixpath.join(self._folder, path)))
        if target is None:
            return None
        return self._site.root(self._page) + target + (f"#{place}" if place else "")


def mathml(latex, display="inline"):
    """MathML of a formula in LaTeX, with TeX's spaces around stars, slashes and functions."""
    found = convert(latex.strip(), display=display)
    for code, sign in (("&#x0002A;", "&#x02217;"), ("&#x0002F;", "&#x0002F;")):
        found = found.replace(f"<mo>{code}</mo>", f'<mo lspace="0" rspace="0">{sign}</mo>')
    return _FUNCTION.sub(r'\1<mspace width="0.167em"/>', found)


def plain(text):
    """Text of HTML."""
    return html.unescape(_TAG.sub("", text))
