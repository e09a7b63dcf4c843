"""Command for what to cite: this study, and the paper that it reproduces."""

import re

from study import paths
from study.cli import options as cli

CITATION = paths.ROOT / ("CITATION.cff" if paths.IS_CHECKOUT else "study/CITATION.cff")
_FORMS = "{title}, version {version}.", "{title}. {journal} {volume}({issue}), {start}. {url}"
_BIBTEX = {"issue": "number", "start": "pages"}  # whose other fields have the same names
_KEYS = ("title", "journal", "volume", "issue", "start", "version", "year", "url")
_FIELD = re.compile(r'^[ -]*([\w-]+): "?(.+?)"?$', re.MULTILINE)
_AUTHOR = re.compile(r"- (?:family-names: (.+)\n +given-names: (.+)|name: (.+))")


@cli.command("cite")
def cite():
    """Print what to cite, as text and as BibTeX: this study, and the paper it reproduces."""
    works = CITATION.read_text(encoding="utf-8").split("\nreferences:\n")
    for text, form in zip(works, _FORMS, strict=True):
        work = dict(_FIELD.findall(text))
        work["year"] = work.get("year") or work["date-released"][:4]
        authors = [name or f"{family}, {given}" for family, given, name in _AUTHOR.findall(text)]
        print(f"{' and '.join(authors)} ({work['year']}). {form.format(**work)}\n")
        # else BibTeX takes the name of a group for that of a person
        names = [f"{{{name}}}" if " " in name and "," not in name else name for name in authors]
        fields = {"author": " and ".join(names)}
        fields |= {_BIBTEX.get(key, key): work[key] for key in _KEYS if key in work}
        print(f"@{work['type']}{{{re.match('[A-Za-z]+', authors[0])[0].lower()}{work['year']},")
        print("".join(f"  {key} = {{{value}}},\n" for key, value in fields.items()) + "}\n")
