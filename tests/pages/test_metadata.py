"""The metadata of the study follow from the catalogue, and its expected numbers are in results."""

import json
import re
from dataclasses import replace

import metadata
import pytest
import yaml

from study import paths
from study.checks import StudyError
from study.dataset import compare
from study.pages import catalogue
from study.pages.catalogue import results

RESULTS = {result.name: result for result in results()}


@pytest.mark.parametrize("name", RESULTS)
def test_what_is_expected_is_one_number_of_the_accepted_result(name):
    assert re.fullmatch(r"\d+ rows|\S+ = \S+ at .+", RESULTS[name].expected())


@pytest.mark.parametrize("text", ["value", "mass at parameter = restitution"])
def test_an_expected_number_that_is_not_there_is_an_error(text):
    with pytest.raises(StudyError, match=r"catalogue\.toml: table4 must .*, got '" + text):
        replace(RESULTS["table4"], expect=text).expected()


def test_reproducing_names_the_tolerances():
    text = (paths.ROOT / "REPRODUCING.md").read_text(encoding="utf-8")
    within = [float(number) for number in re.findall(r"within (1e-\d+|0\.\d+)\b(?! %)", text)]
    assert within[:2] == [compare.TOLERANCE, compare.CHAOTIC_TOLERANCE]


GRAPH = json.loads(metadata.CRATE.read_text(encoding="utf-8"))["@graph"]
ENTITIES = {entity["@id"]: entity for entity in GRAPH}


def test_crate_is_what_is_made():
    assert metadata.CRATE.read_text(encoding="utf-8") == metadata.crate()


def test_zenodos_record_is_what_is_made():
    text = metadata.ZENODO.read_text(encoding="utf-8")
    assert text == metadata.zenodo()
    record = json.loads(text)
    assert record["creators"][0]["name"].startswith("Contributors")
    assert record["publication_date"] in (paths.ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_what_the_crate_names_is_in_it():
    named = set(re.findall(r'"@id": "(.+)"', metadata.CRATE.read_text(encoding="utf-8")))
    assert named - ENTITIES.keys() == {"https://w3id.org/ro/crate/1.2"}
    parts = {part["@id"] for part in ENTITIES["./"]["hasPart"]}
    assert not [part for part in parts if not (paths.ROOT / part).exists()]
    for pattern in ("data/**/*.csv", "figures/*", "notebooks/*.ipynb"):
        assert {
            path.relative_to(paths.ROOT).as_posix() for path in paths.ROOT.glob(pattern)
        } <= parts


def test_every_result_is_made_by_one_notebook():
    actions = [entity for entity in GRAPH if entity["@type"] == "CreateAction"]
    made = [file["@id"] for action in actions for file in action["result"]]
    assert sorted(made) == sorted(part for part in ENTITIES if part.startswith("figures/"))


def test_the_changelog_has_the_version_and_its_date():
    cited = yaml.safe_load((paths.ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    changes = (paths.ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = f"{cited['version']} ({cited['date-released']})"
    assert f"\n## {newest}\n" in changes


def test_a_slip_in_the_catalogue_is_told():
    with pytest.raises(StudyError, match=r"catalogue\.toml: the entry 00-mine .*'figures'$"):
        catalogue.notebook("00-mine", {"fig99": {"shows": "", "figures": ""}})
