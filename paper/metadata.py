"""Metadata of the study, from catalogue and citation: RO-Crate and Zenodo's file.

``python paper/metadata.py`` writes both. Title, authors, version and the paper come from
``CITATION.cff``, results from the catalogue, and the data from ``data/README.md``.
"""

import json
import re
from pathlib import Path

import yaml
from rocrate.rocrate import ROCrate

from study import paths
from study.pages.catalogue import CATALOGUE

CRATE, ZENODO = paths.ROOT / "ro-crate-metadata.json", paths.ROOT / ".zenodo.json"
MIT, CC_BY = "https://spdx.org/licenses/MIT", "https://spdx.org/licenses/CC-BY-4.0"
LICENCES = {MIT: "MIT License (code)", CC_BY: "Creative Commons Attribution 4.0 (data, figures)"}
FILES = {
    "README.md": "what was found, and how to use it",
    "REPRODUCING.md": "how to rebuild every result",
    "Snakefile": "the workflow: rules for notebooks, article, report and dataset",
    "requirements.lock": "every package that is needed, pinned by version and hash",
    "figures/README.md": "every figure with its conclusion, and every table",
    "data/datapackage.json": "Frictionless data package: columns and units of the data",
    "paper/paper.typ": "the article; Typst reads its numbers from the results",
    "paper/supplement.typ": "its supplement",
}
FORMATS = {
    ".csv": "text/csv",
    ".ipynb": "application/x-ipynb+json",
    ".json": "application/json",
    ".png": "image/png",
}
_DATA = re.compile(r"^\| `([\w/]+\.(?:csv|json))` \| (.+?) \| (.+?) \|$", re.MULTILINE)


def crate() -> str:
    """Text of ``ro-crate-metadata.json``: files, and the run of each notebook with its results."""
    study, cited = ROCrate(version="1.2"), _cited()
    (paper,) = cited["references"]
    (author,) = cited["authors"]
    about = {"name": paper["title"], "datePublished": str(paper["year"])}
    described = {
        "@id": "./",
        "name": cited["title"],
        "description": cited["abstract"],
        "keywords": ", ".join(cited["keywords"]),
        "version": cited["version"],
        "datePublished": str(cited["date-released"]),
        "author": _add(study, "#authors", "Organization", author),
        "citation": _add(study, paper["url"], "ScholarlyArticle", about),
        "license": [_add(study, url, "CreativeWork", {"name": of}) for url, of in LICENCES.items()],
    }
    study.update_jsonld(described)
    study.add_directory(dest_path="study", properties={"name": "the library"})
    for name, text in FILES.items():
        _file(study, name, text, CC_BY if "/" in name else MIT)
    for name, text, made in _DATA.findall((paths.DATA / "README.md").read_text(encoding="utf-8")):
        _file(study, f"data/{name}", f"{text} ({made})".replace("`", ""), CC_BY)
    of_results = {
        result.name: [
            _file(study, f"figures/{name}", f"{result.label}: {result.shows}", CC_BY)
            for name in result.files
        ]
        for notebook in CATALOGUE
        for result in notebook.results.values()
    }
    study.root_dataset["mentions"] = [
        study.add_action(
            _file(study, f"notebooks/{notebook.path.name}", _title(notebook), MIT),
            f"#{notebook.name}",
            object=[of_results[name][0] for name in notebook.reads],
            result=[file for name in notebook.results for file in of_results[name]],
            properties={"name": f"study run {notebook.name}"},
        )
        for notebook in CATALOGUE
    ]
    return json.dumps(study.metadata.generate(), indent=1, ensure_ascii=False) + "\n"


def zenodo() -> str:
    """Text of ``.zenodo.json``."""
    cited = _cited()
    described = {
        "upload_type": cited["type"],
        "title": cited["title"],
        "description": cited["abstract"],
        "creators": [{"name": author["name"]} for author in cited["authors"]],
        "keywords": cited["keywords"],
        "version": cited["version"],
        "publication_date": str(cited["date-released"]),
        "access_right": "open",
        "license": cited["license"],
        "related_identifiers": [
            {"identifier": work["url"], "relation": "references"} for work in cited["references"]
        ],
    }
    return json.dumps(described, indent=1, ensure_ascii=False) + "\n"


def _cited():
    return yaml.safe_load((paths.ROOT / "CITATION.cff").read_text(encoding="utf-8"))


def _title(notebook):
    """First line of a notebook."""
    cell = json.loads(notebook.path.read_text(encoding="utf-8"))["cells"][0]
    return "".join(cell["source"]).partition("\n")[0].removeprefix("# ")


def _add(study, identifier, kind, properties):
    """Add to a crate something that is not a file of it, and return what refers to it."""
    study.add_or_update_jsonld({"@id": identifier, "@type": kind} | properties)
    return {"@id": identifier}


def _file(study, name, text, licence):
    kind = FORMATS.get(Path(name).suffix, "text/plain")
    properties = {"name": text, "encodingFormat": kind, "license": {"@id": licence}}
    return study.add_file(paths.ROOT / name, name, properties=properties)


if __name__ == "__main__":
    for file, text in ((CRATE, crate()), (ZENODO, zenodo())):
        file.write_text(text, encoding="utf-8")
