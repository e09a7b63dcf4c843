"""The cached dataset: what it holds, what it refuses, and that it is written whole."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from threadpoolctl import threadpool_limits

from study import dataset, paths
from study.contact import costs
from study.dataset import design, fitting, production, store
from study.joint import curve
from study.joint.curve import SOLVERS
from study.joint.supports import BALL_SUPPORTS, KINEMATICS, RIMS

ROOT = paths.ROOT


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A copy of data and code that the modules take for their own; its data folder."""
    root = tmp_path / "project"
    ignored = shutil.ignore_patterns("__pycache__", "static", "cli")
    for name in ("data", "study"):
        shutil.copytree(ROOT / name, root / name, ignore=ignored)
    moved = {
        name: root / path.relative_to(ROOT)
        for name, path in vars(store).items()
        if isinstance(path, Path)
    }
    every = (*production.GENERATED, *store.PUBLISHED, store.CASES)
    of = {path: root / path.relative_to(ROOT) for path in every}
    made_from = {of[p]: [of[file] for file in files] for p, files in production.MADE_FROM.items()}
    monkeypatch.setattr(
        production, "GENERATED", {of[p]: m for p, m in production.GENERATED.items()}
    )
    monkeypatch.setattr(production, "MADE_FROM", made_from)
    monkeypatch.setattr(store, "SOLUTIONS", {k: of[path] for k, path in store.SOLUTIONS.items()})
    monkeypatch.setattr(store, "PUBLISHED", tuple(of[path] for path in store.PUBLISHED))
    library = tuple(root / path.relative_to(ROOT) for path in store.LIBRARY)
    monkeypatch.setattr(store, "LIBRARY", library)
    for name, path in moved.items():
        monkeypatch.setattr(store, name, path)
    monkeypatch.setattr(paths, "ROOT", root)
    monkeypatch.setattr(paths, "DATA", root / "data")
    return root / "data"


@pytest.fixture
def made(copy):
    """The copy, described as made by this code."""
    production.write_description()
    return copy


def test_dataset_holds_the_papers_design_and_the_wider_sweep():
    paper = dataset.paper_curves()
    assert sorted(set(paper.r2_star)) == [*range(20, 301, 20), 400, 600, 1000, 2000, 5000, 10000]
    assert (paper.groupby("r2_star").size() == 40).all()
    assert np.allclose(sorted(set(paper.depth_star)), np.arange(1, 41) * 0.025)
    assert not dataset.load().isna().any().any()


def test_every_group_is_there():
    frame = dataset.load()
    assert set(frame.group) == set(design.GROUPS)
    validation = frame[frame.group == "validation"].drop_duplicates("case")
    assert len(validation) == design.FREE_VALIDATION + design.HELD_VALIDATION
    assert validation.groupby(["ball_support", "rim"]).size().min() >= 8
    finite = frame[frame.kinematics == "finite"]
    assert set(finite.solver) == {"quadratic"}


def test_filters_select_rows():
    rows = dataset.load(r2_star=[20, 200], kinematics="small", group="paper")
    assert set(rows.r2_star) == {20, 200}
    assert set(rows.kinematics) == {"small"}
    assert list(rows.index) == list(range(80))
    with pytest.raises(ValueError, match="ball_support must be one of guided, got clamped"):
        dataset.load(group="liner", ball_support="clamped")
    with pytest.raises(ValueError, match="column must be one of group.*got 'radius'"):
        dataset.load(radius=1)


def test_every_check_passes():
    assert {"force increases", "error estimate", "solved again"} <= set(dict(production.check()))


def test_columns_have_units_and_meaning():
    package = json.loads(store.PACKAGE.read_text())
    fields = package["resources"][0]["schema"]["fields"]
    assert [f["name"] for f in fields] == list(dataset.load().columns)
    assert all(f["description"] for f in fields)
    assert all(("unit" in f) == (f["type"] == "number") for f in fields)
    text = (paths.DATA / "README.md").read_text()
    for field in fields:
        assert f"`{field['name']}`" in text


def test_a_build_does_not_bless_damaged_published_numbers(copy):
    path = copy / "published" / "tables.csv"
    path.write_text("x,y\n")
    for build in (production.write_description, production.to_make):
        with pytest.raises(dataset.DatasetError, match=r"published/tables.csv is damaged"):
            build()


def test_measured_times_are_kept_with_their_hash(copy):
    frame = dataset.measured()
    assert set(frame.chart) == {"laws", "solvers", "steppers", "flexible"}
    assert (frame.groupby("chart", sort=False).relative.first() == 1).all()
    before = dataset.measured("steppers")
    laws = frame[frame.chart == "laws"].assign(machine="another")
    store.keep_measured(laws)
    assert set(dataset.measured("laws").machine) == {"another"}
    pd.testing.assert_frame_equal(dataset.measured("steppers"), before)
    own = frame[(frame.chart == "steppers") & (frame.program == "ours")].iloc[:3]
    store.keep_measured(own)
    kept = dataset.measured("steppers")
    assert kept.program.value_counts().to_dict() == {
        "ours": 3,
        **before[before.program != "ours"].program.value_counts().to_dict(),
    }


@pytest.mark.parametrize(
    ("name", "read", "rebuild"),
    [
        ("links.csv", dataset.links, ", or rebuild it with: study data build"),
        ("published/joint.csv", dataset.reference_forces, ""),
    ],
)
def test_damaged_and_missing_files_are_named_with_a_remedy(copy, name, read, rebuild):
    path, remedy = copy / name, f"git checkout -- data/{name} data/datapackage.json{rebuild}"
    path.write_text(path.read_text().replace("2", "3", 1))
    for reader in (read, dataset.verify_files):
        with pytest.raises(dataset.DatasetError, match=rf"data/{name} is damaged.*{remedy}$"):
            reader()
    path.unlink()
    with pytest.raises(dataset.DatasetError, match=rf"data/{name} is missing.*{remedy}$"):
        read()


def test_a_read_verifies_its_own_file_and_no_code(copy):
    with (copy.parent / "study/mechanism/events.py").open("a") as module:
        module.write("# a remark\n")
    (copy / "links.csv").write_text("damaged")
    assert len(dataset.load(r2_star=200)) > 0
    assert len(dataset.published()) > 0
    with pytest.raises(dataset.DatasetError, match=r"data/links.csv is damaged"):
        dataset.links()


def test_what_others_printed_names_its_source_and_a_whole_joint():
    rows = dataset.others()
    entries = (paths.PAPER / "references.yml").read_text(encoding="utf-8")
    by_doi = rows.source.str.startswith("10.")  # its title or authors were not seen
    assert set(rows.source[~by_doi]) <= set(re.findall(r"^(\w+):$", entries, re.MULTILINE))
    assert not any(f"doi: {doi}" in entries for doi in rows.source[by_doi])
    assert set(rows.role) == {"stated", "assumed", "beside", "result", "unread"}
    assert rows.least.isna().equals(rows.role == "unread")
    assert not (rows.least > rows.most).any()
    results = rows[rows.role == "result"]
    assert (results.rounding > 0).all()
    assert results.read.notna().all()
    needed = {"ball_radius", "clearance", "ball_modulus", "ball_poisson", "wall_1", "force"}
    for joint in results.joint.unique():
        given = rows[(rows.joint == joint) & rows.role.isin(["stated", "assumed"])]
        assert given.quantity.is_unique
        assert needed <= set(given.quantity)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda package: package.update(resources="text"), "is missing or damaged"),
        (lambda package: package["resources"][0].pop("schema"), "is missing or damaged"),
        (lambda package: package["provenance"].pop("made_by"), "is missing or damaged"),
    ],
)
def test_a_wrong_description_is_one_error_with_a_remedy(copy, change, message):
    path = copy / "datapackage.json"
    package = json.loads(path.read_text())
    change(package)
    path.write_text(json.dumps(package))
    with pytest.raises(dataset.DatasetError, match=f"datapackage.json {message}") as caught:
        production.check()
    assert str(caught.value).endswith("restore it with: git checkout -- data/datapackage.json")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda field: field.update(type="string"), "constraint .minimum. is not supported"),
        (lambda field: field.update(name="radius"), "radius"),
    ],
)
def test_a_wrong_schema_fails_the_check(made, change, message):
    path = made / "datapackage.json"
    package = json.loads(path.read_text())
    change(package["resources"][0]["schema"]["fields"][3])
    path.write_text(json.dumps(package))
    with pytest.raises(dataset.DatasetError, match=f"datapackage.json: .*{message}"):
        production.check()


def test_the_schema_allows_what_the_design_has():
    fields = json.loads(store.PACKAGE.read_text())["resources"][0]["schema"]["fields"]
    allowed = {f["name"]: f["constraints"].get("enum") for f in fields}
    assert allowed["group"] == list(design.GROUPS)
    assert allowed["ball_support"] == [kind.word for kind in BALL_SUPPORTS if kind.is_half]
    for column, names in (("rim", RIMS), ("kinematics", KINEMATICS), ("solver", SOLVERS)):
        assert allowed[column] == list(names)


OF_LAWS = ["study/contact/coefficients.json", "study/contact/stiffening.csv"]
OF_LAWS += ["study/pages/report/contact_size.csv", "data/links.csv", "data/set_ups.csv"]


@pytest.mark.parametrize(
    ("module", "old", "new", "outdated"),
    [
        ("joint/curve", "_COUNT = 48", "_COUNT = 49", ["data/force_curves.csv"]),
        ("joint/series", '"""', '"""Another. ', []),
        ("contact/laws", "Parts(hertz", "Parts(1.01 * hertz", OF_LAWS),
        ("dataset/stiffening_fit", "FINER = 320", "FINER = 9", ["study/contact/stiffening.csv"]),
        ("choose/random_scenes", "COUNT = 160", "COUNT = 161", ["data/links.csv"]),
        ("claims/search", "never_together", "never_both", []),
    ],
)
def test_changed_code_makes_out_of_date_what_reaches_it(made, module, old, new, outdated):
    assert production.to_make() == set()
    path = made.parent / f"study/{module}.py"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    found = {path.relative_to(made.parent).as_posix() for path in production.out_of_date()}
    assert set(outdated) <= found
    assert ("data/force_curves.csv" in found) == ("data/force_curves.csv" in outdated)
    dataset.load(r2_star=200)  # is not refused: its numbers are as they were
    dataset.verify_files()
    if not outdated:
        production.verify_made_by()
        assert production.to_make() == set()
        return
    assert production.to_make() >= {*production.out_of_date(), store.PACKAGE}
    message = f" is outdated: .*study/{module}.py.* changed since.*study data build"
    with pytest.raises(dataset.DatasetError, match=message):
        production.verify_made_by()


def test_what_is_made_from_other_files_is_made_with_them(made):
    store.CURVES.unlink()
    assert production.to_make() == {store.CURVES, store.COEFFICIENTS, store.SET_UPS, store.PACKAGE}
    shutil.copy(ROOT / "data/force_curves.csv", store.CURVES)
    with store.MATERIALS.open("a") as table:
        table.write("\n")
    assert production.to_make() == {store.PACKAGE}
    production.write_description()
    store.TABLE.write_text(store.TABLE.read_text().replace("1", "2", 1))
    assert production.to_make() == {store.TABLE, store.LINKS, store.SET_UPS, store.PACKAGE}


def test_relative_costs_follow_the_measured_times(made):
    frame = dataset.measured("laws")
    frame["relative"] *= np.where(frame.method == "hertz", 1, 2)
    store.keep_measured(frame)
    assert production.to_make() == {store.RELATIVE_COSTS, store.PACKAGE}
    found = fitting.relative_costs(dataset.measured())
    kept = costs.relative_costs()
    expected = {law: cost * (1 if law == "hertz" else 2) for law, cost in kept.items()}
    assert found == pytest.approx(expected, rel=1e-3)  # four digits are kept


def test_nothing_is_made_again_but_from_nothing(made, monkeypatch):
    before = store.PACKAGE.read_bytes()
    assert production.to_make() == set()
    production.write_description()
    assert store.PACKAGE.read_bytes() == before
    monkeypatch.setenv(production.FROM_NOTHING, "1")
    assert production.to_make() == {*production.GENERATED, store.PACKAGE}


def test_a_changed_default_of_the_joint_makes_the_dataset_out_of_date(made, monkeypatch):
    monkeypatch.setattr(
        design, "Joint", lambda r2_star, **given: curve.Joint(r2_star, **{"rim": "free"} | given)
    )
    with pytest.raises(dataset.DatasetError, match=r"outdated: the design.*a default of the j"):
        production.verify_made_by()


def test_numbers_that_agree_leave_the_kept_file(copy):
    kept = store.CURVES.read_bytes()
    frame = dataset.load()
    production.write_table(frame.assign(force_star=frame.force_star * (1 + 1e-8)), store.CURVES)
    assert store.CURVES.read_bytes() == kept
    production.write_table(frame.assign(force_star=frame.force_star * (1 + 1e-5)), store.CURVES)
    assert store.CURVES.read_bytes() != kept


def rewrite(copy, change):
    """Change the curves and state the new hash, as a wrong build would."""
    frame = dataset.load()
    change(frame)
    production.write_table(frame, store.CURVES)
    production.write_description()


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("force_star", 1.0, "case .*: force increases must be in"),
        ("error_estimate", 0.1, "case .*: error estimate must be in"),
        ("rim", "open", "datapackage.json: .*enum"),
    ],
)
def test_wrong_values_fail_the_check(copy, column, value, message):
    def change(frame):
        frame.loc[4, column] = value

    rewrite(copy, change)
    with pytest.raises(dataset.DatasetError, match=message):
        production.check()


def test_a_curve_unlike_the_solver_fails_the_check(copy):
    def change(frame):
        frame.loc[frame.case == design.case_name("ratio-1.05"), "force_star"] *= 1.00001

    rewrite(copy, change)
    with pytest.raises(dataset.DatasetError, match=r"ratio-1.05-linear-200 solved again"):
        production.check()


def test_a_case_is_solved_to_the_same_bytes_on_any_number_of_threads(tmp_path):
    case = ("ratio", "one", curve.Joint(20, 1.5, kinematics="small"), (0.1, 0.5))
    for threads, name in ((1, "first.csv"), (2, "second.csv")):
        curve.series.compliance.cache_clear()
        with threadpool_limits(threads):
            production.write_table(production.solve_case(*case), tmp_path / name)
    assert (tmp_path / "first.csv").read_bytes() == (tmp_path / "second.csv").read_bytes()
