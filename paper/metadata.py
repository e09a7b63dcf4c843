"""Metadata of the study, and hashes of its results: ``python paper/metadata.py`` writes all.

Version, authors and addresses come from ``pyproject.toml``, the date of the version from
``CHANGELOG.md``, the reproduced paper from ``paper/references.yml``, results from the catalogue,
and the data from ``data/README.md``. An address in which OWNER, REPOSITORY or PLACEHOLDER is not
filled in is written to README only, because other programs would take it for a real one.
"""

import json
import re
import tomllib
from collections.abc import Callable
from datetime import date
from pathlib import Path
from typing import Any

import yaml
from rocrate.rocrate import ROCrate

from study import paths
from study.checks import StudyError
from study.pages.catalogue import CATALOGUE, GALLERY
from study.pages.report import gallery

CITATION, ZENODO = paths.ROOT / "CITATION.cff", paths.ROOT / ".zenodo.json"
CRATE, README = paths.ROOT / "ro-crate-metadata.json", paths.ROOT / "README.md"
HASHES = paths.FIGURES / "SHA256SUMS"
MIT, CC_BY = "https://spdx.org/licenses/MIT", "https://spdx.org/licenses/CC-BY-4.0"
LICENCES = {MIT: "MIT License (code)", CC_BY: "Creative Commons Attribution 4.0 (data, figures)"}
BIOSCHEMAS = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE"
BOTH_LICENCES = (
    "The code has the MIT licence (file LICENSE). Data, figures and article have the licence "
    "CC BY 4.0 (file data/LICENSE)."
)
FILES = {
    "README.md": "what was found, and how to use it",
    "REPRODUCING.md": "how to rebuild every result",
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
    ".md": "text/markdown",
    ".png": "image/png",
}
_DATA = re.compile(r"^\| `([\w/]+\.(?:csv|json))` \| (.+?) \| (.+?) \|$", re.MULTILINE)
MARKERS = ("<!-- links: written by paper/metadata.py -->", "<!-- end of links -->")


def about() -> dict[str, Any]:
    """What ``pyproject.toml`` and ``CHANGELOG.md`` say of this version, and its addresses."""
    described = tomllib.loads((paths.ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    project, more = described["project"], described["tool"]["study"]
    version = project["version"]
    changes = (paths.ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    dated = re.search(rf"^## {re.escape(version)} \((\d{{4}}-\d\d-\d\d)\)$", changes, re.MULTILINE)
    if not dated:
        raise StudyError(f"CHANGELOG.md must have the heading: ## {version} (YYYY-MM-DD)")
    works = yaml.safe_load((paths.PAPER / "references.yml").read_text(encoding="utf-8"))
    return {
        "title": project["description"],
        "version": version,
        "date": date.fromisoformat(dated[1]),
        "authors": [author["name"] for author in project["authors"]],
        "keywords": project["keywords"],
        "abstract": more["abstract"],
        "paper": works[more["paper"]],
        "addresses": project["urls"],
    }


def known(address: str) -> str | None:
    """An address, or None where a placeholder in it is not filled in."""
    return None if re.search("OWNER|REPOSITORY|PLACEHOLDER", address) else address


def citation() -> str:
    """Text of ``CITATION.cff``.

    It has the licence of the code only: a list in this format means that a user may choose.
    """
    of = about()
    addresses = {
        "repository-code": known(of["addresses"]["Repository"]),
        "url": known(of["addresses"]["Report"]),
        "doi": (known(of["addresses"]["DOI"]) or "").removeprefix("https://doi.org/"),
    }
    described = {
        "cff-version": "1.2.0",
        "message": "If you use this study, please cite it, and the paper it reproduces.",
        "title": of["title"],
        "type": "software",
        "abstract": of["abstract"],
        "keywords": of["keywords"],
        "version": of["version"],
        "date-released": of["date"],
        "license": "MIT",
        "authors": [{"name": name} for name in of["authors"]],
        **{name: address for name, address in addresses.items() if address},
        "references": [_reference(of["paper"])],
    }
    text = yaml.safe_dump(described, sort_keys=False, allow_unicode=True, width=100)
    return f"# Written by `python paper/metadata.py`: edit pyproject.toml instead\n{text}"


def _reference(work):
    """An article of ``references.yml`` as a reference of ``CITATION.cff``."""
    authors = [name.partition(", ") for name in work["author"]]
    return {
        "type": "article",
        "title": work["title"],
        "authors": [
            {"family-names": name, "given-names": given} if given else {"name": name}
            for name, _, given in authors
        ],
        "journal": work["parent"]["title"],
        "volume": work["parent"]["volume"],
        "issue": work["parent"]["issue"],
        "start": work["page-range"],
        "year": work["date"],
        "url": work["url"],
    }


def crate() -> str:
    """Text of ``ro-crate-metadata.json``: files, the workflow, and the run of each notebook.

    It is a Workflow RO-Crate 1.0, which is based on RO-Crate 1.1.
    """
    study, of = ROCrate(version="1.1"), about()
    paper = {"name": of["paper"]["title"], "datePublished": str(of["paper"]["date"])}
    authors = [
        _add(study, f"#author-{number}", "Organization", {"name": name})
        for number, name in enumerate(of["authors"], start=1)
    ]
    addresses = {
        "url": known(of["addresses"]["Repository"]),
        "identifier": known(of["addresses"]["DOI"]),
    }
    described = {
        "@id": "./",
        "name": of["title"],
        "description": of["abstract"],
        "keywords": ", ".join(of["keywords"]),
        "version": of["version"],
        "datePublished": str(of["date"]),
        "author": _one_or_all(authors),
        "citation": _add(study, of["paper"]["url"], "ScholarlyArticle", paper),
        "license": [
            _add(study, url, "CreativeWork", {"name": name}) for url, name in LICENCES.items()
        ],
        **{name: address for name, address in addresses.items() if address},
    }
    study.update_jsonld(described)
    study.add_workflow(
        paths.ROOT / "Snakefile",
        "Snakefile",
        main=True,
        lang="snakemake",
        properties={
            "name": "the workflow: rules for notebooks, article, report and dataset",
            "encodingFormat": "text/plain",
            "license": {"@id": MIT},
            "creator": _one_or_all(authors),
            "conformsTo": {"@id": BIOSCHEMAS},
            "version": of["version"],
        },
    )
    study.add_directory(dest_path="study", properties={"name": "the library"})
    for name, text in FILES.items():
        _file(study, name, text, CC_BY if "/" in name else MIT)
    study.get("README.md")["about"] = {"@id": "./"}
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
            _file(study, f"notebooks/{notebook.path.name}", notebook.title(), MIT),
            f"#{notebook.name}",
            object=_one_or_all([of_results[name][0] for name in notebook.reads]),
            result=_one_or_all([file for name in notebook.results for file in of_results[name]]),
            properties={"name": f"study run {notebook.name}"},
        )
        for notebook in CATALOGUE
    ]
    return json.dumps(study.metadata.generate(), indent=1, ensure_ascii=False) + "\n"


def zenodo() -> str:
    """Text of ``.zenodo.json``, whose format has one licence: a note names both."""
    of = about()
    related = {
        of["paper"]["url"]: "references",
        known(of["addresses"]["Repository"]): "isSupplementTo",
        known(of["addresses"]["Report"]): "isDocumentedBy",
    }
    described = {
        "upload_type": "software",
        "title": of["title"],
        "description": of["abstract"],
        "creators": [{"name": name} for name in of["authors"]],
        "keywords": of["keywords"],
        "version": of["version"],
        "publication_date": str(of["date"]),
        "access_right": "open",
        "license": "MIT",
        "notes": BOTH_LICENCES,
        "related_identifiers": [
            {"identifier": address, "relation": relation}
            for address, relation in related.items()
            if address
        ],
    }
    return json.dumps(described, indent=1, ensure_ascii=False) + "\n"


def hashes() -> str:
    """Text of ``figures/SHA256SUMS``: the accepted tables and images, as ``sha256sum`` reads it."""
    files = (path for path in paths.FIGURES.iterdir() if path.suffix in {".csv", ".png"})
    return "".join(f"{paths.sha256(path)}  {path.name}\n" for path in sorted(files))


def links() -> str:
    """Line of README: state of the tests, DOI, and links to the published report and article."""
    to = about()["addresses"]
    tests = f"{to['Repository']}/actions/workflows/checks.yml"
    doi = to["DOI"].removeprefix("https://doi.org/")
    return " ".join(
        (
            f"[![Tests]({tests}/badge.svg)]({tests})",
            f"[![DOI](https://zenodo.org/badge/DOI/{doi}.svg)]({to['DOI']})",
            f"[Report]({to['Report']}) ·",
            f"[Article (PDF)]({to['Report']}/paper.pdf) ·",
            f"[Supplement (PDF)]({to['Report']}/supplement.pdf)",
        )
    )


def readme() -> str:
    """Text of ``README.md`` with its line of links, which is between two markers."""
    text = README.read_text(encoding="utf-8")
    try:
        before, rest = text.split(MARKERS[0])
        _, after = rest.split(MARKERS[1])
    except ValueError:
        raise StudyError(f"README.md must have once: {MARKERS[0]} ... {MARKERS[1]}") from None
    return f"{before}{MARKERS[0]}\n{links()}\n{MARKERS[1]}{after}"


def _add(study, identifier, kind, properties):
    """Add to a crate something that is not a file of it, and return what refers to it."""
    study.add_or_update_jsonld({"@id": identifier, "@type": kind} | properties)
    return {"@id": identifier}


def _one_or_all(values):
    """A list, or its only value, as RO-Crate recommends."""
    return values[0] if len(values) == 1 else values


def _file(study, name, text, licence):
    kind = FORMATS.get(Path(name).suffix, "text/plain")
    properties = {"name": text, "encodingFormat": kind, "license": {"@id": licence}}
    return study.add_file(paths.ROOT / name, name, properties=properties)


WRITTEN: dict[Path, Callable[[], str]] = {
    CITATION: citation,
    ZENODO: zenodo,
    CRATE: crate,
    HASHES: hashes,
    paths.FIGURES / GALLERY.name: gallery,
    README: readme,
}

if __name__ == "__main__":
    for file, text in WRITTEN.items():
        file.write_text(text(), encoding="utf-8", newline="\n")
