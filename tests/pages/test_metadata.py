"""Metadata follow from the project and the catalogue, and expected numbers are in results."""

import hashlib
import json
import re
import shutil
import tomllib

import metadata
import pytest
import yaml
from rocrate.model.computationalworkflow import ComputationalWorkflow
from rocrate.rocrate import ROCrate
from rocrate.utils import as_list

from study import paths
from study.checks import StudyError
from study.dataset import compare
from study.pages import catalogue, report

FILLED = {
    "Repository": "https://github.com/us/joint",
    "Report": "https://us.github.io/joint",
    "DOI": "https://doi.org/10.5281/zenodo.123",
}
RESULTS = {result.name: result for result in catalogue.results()}


@pytest.mark.parametrize("name", [name for name, result in RESULTS.items() if result.expect])
def test_what_is_expected_is_one_number_of_the_accepted_result(name):
    assert re.fullmatch(r"\S+ = \S+ at .+", RESULTS[name].expected())


def test_tolerances_are_of_results_and_data_that_exist():
    tables = {path.stem for path in paths.DATA.rglob("*.csv")}
    assert {*compare.DIGITS, *compare.CHAOTIC} <= tables | RESULTS.keys()


def test_the_page_of_figures_is_made_from_the_catalogue_and_shows_every_figure():
    text = (paths.FIGURES / "README.md").read_text(encoding="utf-8")
    assert text == report.gallery()
    shown = re.findall(r"\]\(([\w-]+\.png)\)", text)
    assert sorted(shown) == sorted(path.name for path in paths.FIGURES.glob("*.png"))


def test_reproducing_names_the_tolerances():
    text = (paths.ROOT / "REPRODUCING.md").read_text(encoding="utf-8")
    within = [float(number) for number in re.findall(r"within (1e-\d+|0\.\d+)\b(?! %)", text)]
    assert within[:2] == [compare.TOLERANCE, compare.CHAOTIC_TOLERANCE]


@pytest.mark.parametrize("file", metadata.WRITTEN, ids=lambda path: path.name)
def test_the_stored_file_is_what_is_made(file):
    assert file.read_text(encoding="utf-8") == metadata.WRITTEN[file]()


def test_every_data_file_figure_and_notebook_is_in_the_crate():
    text = metadata.CRATE.read_text(encoding="utf-8")
    entities = {entity["@id"]: entity for entity in json.loads(text)["@graph"]}
    named = set(re.findall(r'"@id": "(.+)"', text))
    assert all(name.startswith("https://") for name in named - entities.keys())
    parts = {part["@id"] for part in entities["./"]["hasPart"]}
    assert not [part for part in parts if not (paths.ROOT / part).exists()]
    for pattern in ("data/**/*.csv", "figures/*.csv", "figures/*.png", "notebooks/*.ipynb"):
        files = paths.ROOT.glob(pattern)
        assert {path.relative_to(paths.ROOT).as_posix() for path in files} <= parts
    actions = [entity for entity in entities.values() if entity["@type"] == "CreateAction"]
    made = [file["@id"] for action in actions for file in as_list(action["result"])]
    figures = {part for part in parts if part.startswith("figures/")}
    assert sorted(made) == sorted(figures - {"figures/README.md"})


def test_the_crate_is_a_workflow_crate():
    """What the Workflow RO-Crate profile 1.0 demands, as the package rocrate reads it."""
    crate = ROCrate(paths.ROOT)
    profiles = ("ro/crate/1.1", "workflowhub/workflow-ro-crate/1.0")
    assert crate.metadata["conformsTo"] == [f"https://w3id.org/{name}" for name in profiles]
    assert isinstance(crate.mainEntity, ComputationalWorkflow)
    assert crate.mainEntity.type == ["File", "SoftwareSourceCode", "ComputationalWorkflow"]
    assert crate.mainEntity.id == "Snakefile"
    assert crate.mainEntity.lang["name"] == "Snakemake"
    assert [licence.id for licence in crate.root_dataset["license"]] == list(metadata.LICENCES)
    assert (paths.ROOT / crate.mainEntity.id).is_file()


def test_all_files_have_the_version_of_the_project_and_the_date_of_the_changelog():
    project = tomllib.loads((paths.ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    version = project["version"]
    cited = yaml.safe_load(metadata.CITATION.read_text(encoding="utf-8"))
    record = json.loads(metadata.ZENODO.read_text(encoding="utf-8"))
    root = ROCrate(paths.ROOT).root_dataset
    assert cited["version"] == record["version"] == root["version"] == version
    date = str(cited["date-released"])
    assert record["publication_date"] == root["datePublished"][:10] == date
    changes = (paths.ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (\d\S+) \((.+)\)$", changes, re.MULTILINE)[0] == (version, date)
    names = [author["name"] for author in project["authors"]]
    assert [author["name"] for author in cited["authors"]] == names
    assert [author["name"] for author in record["creators"]] == names


def test_the_note_on_licences_names_files_that_exist():
    licences = re.findall(r"(MIT|CC BY 4\.0)[^(]*\(file ([\w/]+)\)", metadata.BOTH_LICENCES)
    assert len(licences) == len(metadata.LICENCES)
    for name, file in licences:
        assert name in (paths.ROOT / file).read_text(encoding="utf-8")


def test_hashes_are_those_of_all_accepted_results():
    lines = metadata.HASHES.read_text(encoding="utf-8").splitlines()
    stated = {name: sha for sha, _, name in (line.partition("  ") for line in lines)}
    accepted = [name for result in RESULTS.values() for name in result.files]
    assert sorted(stated) == list(stated) == sorted(accepted)
    for name, sha in stated.items():
        assert hashlib.sha256((paths.FIGURES / name).read_bytes()).hexdigest() == sha, name


@pytest.fixture
def root(tmp_path, monkeypatch):
    """Copies of the files from which metadata are made, which a test may change."""
    (tmp_path / "paper").mkdir()
    for name in ("pyproject.toml", "CHANGELOG.md", "README.md", "paper/references.yml"):
        shutil.copy(paths.ROOT / name, tmp_path / name)
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "PAPER", tmp_path / "paper")
    monkeypatch.setattr(metadata, "README", tmp_path / "README.md")
    return tmp_path


def change(path, pattern, new):
    """Replace a line that a file must have once."""
    text, replaced = re.subn(pattern, new, path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert replaced == 1
    path.write_text(text, encoding="utf-8")


def fill_in(root, addresses):
    for name, address in addresses.items():
        change(root / "pyproject.toml", f'^{name} = ".+"$', f'{name} = "{address}"')


def test_addresses_are_written_when_they_are_filled_in(root):
    assert metadata.about()["addresses"].keys() == FILLED.keys()
    unknown = ("https://to.me/OWNER/a", "https://to.me/REPOSITORY", "https://to.me/PLACEHOLDER")
    fill_in(root, dict(zip(FILLED, unknown, strict=True)))
    assert "to.me" not in metadata.citation() + metadata.zenodo() + metadata.crate()
    fill_in(root, FILLED)
    cited = yaml.safe_load(metadata.citation())
    assert cited["repository-code"] == FILLED["Repository"]
    assert cited["url"] == FILLED["Report"]
    assert cited["doi"] == "10.5281/zenodo.123"
    related = json.loads(metadata.zenodo())["related_identifiers"]
    assert {"identifier": FILLED["Repository"], "relation": "isSupplementTo"} in related
    assert {"identifier": FILLED["Report"], "relation": "isDocumentedBy"} in related
    described = json.loads(metadata.crate())["@graph"][0]
    assert described["url"] == FILLED["Repository"]
    assert described["identifier"] == FILLED["DOI"]


def test_a_version_without_a_section_of_the_changelog_is_an_error(root):
    change(root / "pyproject.toml", '^version = ".+"$', 'version = "9.8.7"')
    with pytest.raises(StudyError, match=r"must have the heading: ## 9\.8\.7 \(YYYY-MM-DD\)"):
        metadata.citation()


def test_the_links_of_readme_are_those_of_the_project(root):
    opened, closed = metadata.MARKERS
    metadata.README.write_text(f"# Title\n\n{opened}\nold\n{closed}\n\nText", encoding="utf-8")
    fill_in(root, FILLED)
    tests = "https://github.com/us/joint/actions/workflows/checks.yml"
    assert (paths.STUDY.parent / ".github/workflows/checks.yml").is_file()
    line = (
        f"[![Tests]({tests}/badge.svg)]({tests}) [![DOI](https://zenodo.org/badge/DOI/10.5281/"
        f"zenodo.123.svg)]({FILLED['DOI']}) [Report](https://us.github.io/joint) · "
        "[Article (PDF)](https://us.github.io/joint/paper.pdf) · "
        "[Supplement (PDF)](https://us.github.io/joint/supplement.pdf)"
    )
    made = metadata.readme()
    assert made == f"# Title\n\n{opened}\n{line}\n{closed}\n\nText"
    metadata.README.write_text(made, encoding="utf-8")
    assert metadata.readme() == made


@pytest.mark.parametrize("text", ["", "{0}", "{1}", "{0}{1}{1}", "{1}{0}"])
def test_a_damaged_block_of_links_is_an_error(root, text):
    metadata.README.write_text(text.format(*metadata.MARKERS), encoding="utf-8")
    with pytest.raises(StudyError, match=r"README\.md must have once"):
        metadata.readme()
