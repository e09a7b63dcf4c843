"""The metadata of the study follow from the catalogue, and its expected numbers are in results."""

import importlib.metadata
import json
import re

import metadata
import pytest
import yaml

from study import paths
from study.dataset import compare
from study.pages import catalogue, report

RESULTS = {result.name: result for result in catalogue.results()}


@pytest.mark.parametrize("name", [name for name, result in RESULTS.items() if result.expect])
def test_what_is_expected_is_one_number_of_the_accepted_result(name):
    assert re.fullmatch(r"\S+ = \S+ at .+", RESULTS[name].expected())


def test_the_page_of_figures_is_made_from_the_catalogue_and_shows_every_figure():
    text = (paths.FIGURES / "README.md").read_text(encoding="utf-8")
    assert text == report.gallery()
    shown = re.findall(r"\]\(([\w-]+\.png)\)", text)
    assert sorted(shown) == sorted(path.name for path in paths.FIGURES.glob("*.png"))


def test_reproducing_names_the_tolerances():
    text = (paths.ROOT / "REPRODUCING.md").read_text(encoding="utf-8")
    within = [float(number) for number in re.findall(r"within (1e-\d+|0\.\d+)\b(?! %)", text)]
    assert within[:2] == [compare.TOLERANCE, compare.CHAOTIC_TOLERANCE]


@pytest.mark.parametrize("name", ["crate", "zenodo"])
def test_the_stored_file_is_what_is_made(name):
    stored = getattr(metadata, name.upper()).read_text(encoding="utf-8")
    assert stored == getattr(metadata, name)()


def test_every_data_file_figure_and_notebook_is_in_the_crate():
    text = metadata.CRATE.read_text(encoding="utf-8")
    entities = {entity["@id"]: entity for entity in json.loads(text)["@graph"]}
    named = set(re.findall(r'"@id": "(.+)"', text))
    assert named - entities.keys() == {"https://w3id.org/ro/crate/1.2"}
    parts = {part["@id"] for part in entities["./"]["hasPart"]}
    assert not [part for part in parts if not (paths.ROOT / part).exists()]
    for pattern in ("data/**/*.csv", "figures/*", "notebooks/*.ipynb"):
        files = paths.ROOT.glob(pattern)
        assert {path.relative_to(paths.ROOT).as_posix() for path in files} <= parts
    actions = [entity for entity in entities.values() if entity["@type"] == "CreateAction"]
    made = [file["@id"] for action in actions for file in action["result"]]
    figures = {part for part in parts if part.startswith("figures/")}
    assert sorted(made) == sorted(figures - {"figures/README.md"})


def test_package_citation_changelog_and_zenodo_have_the_same_version():
    cited = yaml.safe_load((paths.ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    version, date = cited["version"], str(cited["date-released"])
    assert importlib.metadata.version("spherical-clearance-joint-study") == version
    changes = (paths.ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"\n## {version} ({date})\n" in changes
    record = json.loads(metadata.ZENODO.read_text(encoding="utf-8"))
    assert (record["version"], record["publication_date"]) == (version, date)
