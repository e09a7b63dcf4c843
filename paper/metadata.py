"""Metadata of the study, from catalogue and citation: RO-Crate and Zenodo's file.

``python paper/metadata.py`` writes both.
"""

import json
import re
import sys
import tomllib
from contextlib import contextmanager
from pathlib import Path

import yaml
from rocrate.rocrate import ROCrate

from study import paths
from study.checks import StudyError
from study.pages.catalogue import CATALOGUE, results

CRATE = paths.ROOT / "ro-crate-metadata.json"
ZENODO = paths.ROOT / ".zenodo.json"
MIT, CC_BY = "https://spdx.org/licenses/MIT", "https://spdx.org/licenses/CC-BY-4.0"
PYTHON = "https://www.python.org/"
FILES = {
    "README.md": "what was found, and how to use it",
    "REPRODUCING.md": "how to rebuild every result, and how sure we are of each part",
    "CONTRIBUTING.md": "where things are, and how to add something",
    "CHANGELOG.md": "what changed from version to version",
    "CITATION.cff": "how to cite this study",
    "LICENSE": "licence of the code",
    "Makefile": "the commands make reproduce and make test",
    "Snakefile": "the workflow: rules for notebooks, article, report and dataset",
    "pyproject.toml": "the package and what it depends on",
    "requirements.lock": "every package that is needed, pinned by version and hash",
    "notebooks/catalogue.toml": "every notebook with its results",
    "environment.yml": "the packages for conda",
    "Dockerfile": "a container that rebuilds everything",
    "paper/paper.typ": "the article; Typst reads its numbers from the results",
    "paper/supplement.typ": "its supplement",
    "paper/results.typ": "the results that both name, read from files",
    "paper/references.yml": "the literature that both cite",
    "data/LICENSE": "licence of data, figures and article",
    "data/README.md": "every file of data and its source",
    "data/datapackage.json": "Frictionless data package: columns and units of the data",
    "data/SHA256SUMS": "hash of every file of numbers",
    "data/build.py": "makes the generated files of data, as the Snakefile asks",
}
"""What is in the crate besides data, notebooks and results: file -> what it is."""
FOLDERS = {
    "study": "the Python package: the library and the study",
    "examples": "short programs that use it",
    "tests": "tests of all of it",
}
_FORMATS = {
    ".cff": "application/yaml",
    ".csv": "text/csv",
    ".ipynb": "application/x-ipynb+json",
    ".json": "application/json",
    ".md": "text/markdown",
    ".png": "image/png",
    ".toml": "application/toml",
    ".yml": "application/yaml",
}
_DATA = re.compile(r"^\| `([\w/]+\.(?:csv|json))` \| (.+?) \| (.+?) \|$", re.MULTILINE)


def crate() -> str:
    """Metadata of the study as an RO-Crate, for archives: text of ``ro-crate-metadata.json``.

    Title, authors, version, date and the paper come from ``CITATION.cff``, results from the
    catalogue, the data from ``data/README.md``. Each notebook is the instrument of an action
    that has its figures and tables as results.

    Raises
    ------
    study.checks.StudyError
        If ``CITATION.cff`` lacks a key.
    """
    paths.require_checkout(paths.NOTEBOOKS)
    study = ROCrate(version="1.2")
    with _complete():
        _describe(study)
    for name, text in FILES.items():
        _file(study, name, text, CC_BY if name.startswith(("data/", "paper/")) else MIT)
    for name, text, made in _DATA.findall((paths.DATA / "README.md").read_text(encoding="utf-8")):
        _file(study, f"data/{name}", f"{text} ({made})".replace("`", ""), CC_BY)
    for name, text in FOLDERS.items():
        study.add_directory(dest_path=name, properties={"name": text, "license": {"@id": MIT}})
    _runs(study)
    return json.dumps(study.metadata.generate(), indent=1, ensure_ascii=False) + "\n"


def zenodo() -> str:
    """Description of the study for Zenodo, from ``CITATION.cff``: text of ``.zenodo.json``.

    Raises
    ------
    study.checks.StudyError
        If ``CITATION.cff`` lacks a key.
    """
    with _complete():
        cited = _cited()
        (paper,) = cited["references"]
        described = {
            "upload_type": cited["type"],
            "title": cited["title"],
            "description": cited["abstract"],
            "creators": [{"name": _name(author)} for author in cited["authors"]],
            "keywords": cited["keywords"],
            "version": cited["version"],
            "publication_date": str(cited["date-released"]),
            "access_right": "open",
            "license": cited["license"],
            "related_identifiers": [{"identifier": paper["url"], "relation": "references"}],
        }
    return json.dumps(described, indent=1, ensure_ascii=False) + "\n"


def main() -> None:
    """Write the files."""
    for file, text in ((CRATE, crate()), (ZENODO, zenodo())):
        with paths.whole(file) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _cited():
    """Content of ``CITATION.cff``."""
    return yaml.safe_load((paths.ROOT / "CITATION.cff").read_text(encoding="utf-8"))


@contextmanager
def _complete():
    """Name a key that ``CITATION.cff`` lacks."""
    try:
        yield
    except KeyError as missing:
        raise StudyError(f"CITATION.cff must have the key {missing}") from None


def _describe(study):
    """Say what the study is, whose, of when and under which licences, and what it reproduces."""
    cited = _cited()
    (paper,) = cited["references"]
    names = ", ".join(_name(author) for author in paper["authors"])
    where = f"{paper['journal']} {paper['volume']}({paper['issue']}), {paper['start']}"
    reproduced = {
        "name": paper["title"],
        "author": _authors(study, paper),
        "datePublished": str(paper["year"]),
        "creditText": f"{names}, {where}",
    }
    code = {"name": "MIT License", "description": "the code"}
    rest = {"name": "Creative Commons Attribution 4.0", "description": "data, figures and article"}
    described = {
        "@id": "./",
        "name": cited["title"],
        "description": cited["abstract"],
        "keywords": ", ".join(cited["keywords"]),
        "version": cited["version"],
        "datePublished": str(cited["date-released"]),
        "author": _authors(study, cited),
        "citation": _entity(study, paper["url"], "ScholarlyArticle", reproduced),
        "license": [
            _entity(study, MIT, "CreativeWork", code),
            _entity(study, CC_BY, "CreativeWork", rest),
        ],
    }
    study.update_jsonld(described)


def _authors(study, work):
    """Add the authors of a work in CITATION.cff that are named there."""
    return [
        _entity(
            study,
            f"#{_name(author).replace(' ', '-')}",
            "Person" if "family-names" in author else "Organization",
            {"name": _name(author)},
        )
        for author in work["authors"]
        if _name(author) != "others"
    ]


def _name(author):
    """Name of an author in CITATION.cff: of a person both, else the one there is."""
    return author.get("name") or f"{author['given-names']} {author['family-names']}"


def _runs(study):
    """Add the results, and the notebooks with the action of each."""
    files = {
        result.name: [
            _file(study, f"figures/{name}", f"{result.label}: {result.shows}", CC_BY)
            for name in reversed(result.files)  # the image first
        ]
        for result in results()
    }
    needed = tomllib.loads((paths.ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    language = {"name": "Python", "url": PYTHON, "version": needed["requires-python"]}
    python = _entity(study, PYTHON, "ComputerLanguage", language)
    code = {"@type": ["File", "SoftwareSourceCode"], "programmingLanguage": python}
    study.root_dataset["mentions"] = [
        study.add_action(
            _file(study, f"notebooks/{notebook.path.name}", notebook.title, MIT, **code),
            f"#{notebook.name}",
            object=[files[name][-1] for name in notebook.reads],
            result=[file for name in notebook.results for file in files[name]],
            properties={"name": f"study run {notebook.name}"},
        )
        for notebook in CATALOGUE
    ]


def _entity(study, identifier, kind, properties):
    """Add to a crate something that is not a file of it, and return what refers to it."""
    study.add_or_update_jsonld({"@id": identifier, "@type": kind} | properties)
    return {"@id": identifier}


def _file(study, name, text, licence, **properties):
    """Add a file to a crate."""
    properties |= {"name": text, "license": {"@id": licence}}
    properties["encodingFormat"] = _FORMATS.get(Path(name).suffix, "text/plain")
    return study.add_file(paths.ROOT / name, name, properties=properties)


if __name__ == "__main__":
    try:
        main()
    except StudyError as error:
        sys.exit(str(error))
