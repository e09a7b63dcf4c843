"""The cached dataset: what it holds, what it refuses, its physics, and that it is solved again."""

import json
import re
import shutil

import numpy as np
import pandas as pd
import pytest
from frictionless import Package
from threadpoolctl import threadpool_limits

from study import dataset, paths
from study.dataset import cached, check, design, store
from study.joint import Joint, series
from study.joint.axial import SOLVERS
from study.joint.supports import BALL_SUPPORTS, KINEMATICS, RIMS


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A copy of the data that the modules take for the project's; its folder."""
    shutil.copytree(paths.DATA, tmp_path / "data")
    for name, path in [*vars(store).items()]:
        if isinstance(path, type(paths.DATA)) and path.is_relative_to(paths.DATA):
            monkeypatch.setattr(store, name, tmp_path / path.relative_to(paths.ROOT))
    moved = {kind: tmp_path / p.relative_to(paths.ROOT) for kind, p in store.SOLUTIONS.items()}
    library = tuple(tmp_path / path.relative_to(paths.ROOT) for path in store.LIBRARY)
    for path, source in zip(library, store.LIBRARY, strict=True):
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, path)
    monkeypatch.setattr(store, "SOLUTIONS", moved)
    monkeypatch.setattr(store, "LIBRARY", library)
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "DATA", tmp_path / "data")
    monkeypatch.setattr(paths, "BUILD", tmp_path / "build")
    return tmp_path / "data"


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


def test_filters_select_rows():
    rows = dataset.load(r2_star=[20, 200], kinematics="small", group="paper")
    assert set(rows.r2_star) == {20, 200}
    assert set(rows.kinematics) == {"small"}
    assert list(rows.index) == list(range(80))
    with pytest.raises(ValueError, match="ball_support must be one of guided, got clamped"):
        dataset.load(group="liner", ball_support="clamped")
    with pytest.raises(ValueError, match="r2_star must be one that study data show lists, got 7.0"):
        dataset.load(r2_star=[200, 7.0])
    with pytest.raises(ValueError, match="r2_star must be one that study data show lists, got x"):
        dataset.load(r2_star="x")
    with pytest.raises(ValueError, match="column must be one of group.*got 'radius'"):
        dataset.load(radius=1)


@pytest.mark.parametrize("sample", [4, pytest.param(20, marks=pytest.mark.slow)])
def test_a_sample_solved_again_agrees(sample):
    names, found = zip(*check.check(sample, seed=sample, jobs=1), strict=True)
    assert names == ("hashes", "description", "cases", "solved again")
    assert found[-1].startswith(f"{sample} of ")


def test_curves_have_the_physics_of_a_closing_contact():
    for name, case in dataset.load().groupby("case"):
        depth, force = case.depth_star.to_numpy(), case.force_star.to_numpy()
        stiffness = np.diff(force, prepend=0) / np.diff(depth, prepend=0)
        assert (stiffness > 0).all(), name
        assert (np.diff(stiffness) > -1e-2 * stiffness[1:]).all(), name
        # 1.5 for Hertz's law, 2 for a thin layer, 3 for an incompressible one
        assert 1.45 < np.log(force[1] / force[0]) / np.log(depth[1] / depth[0]) < 3, name
        assert case.error_estimate.between(0, 5e-3).all(), name


def test_every_table_is_as_its_schema_says():
    report = Package(str(store.PACKAGE)).validate()
    assert report.valid, report.flatten(["title", "note", "message", "rowNumber"])
    described = {paths.DATA / r["path"] for r in json.loads(store.PACKAGE.read_text())["resources"]}
    assert described == {path for path in store.files() if path.is_relative_to(paths.DATA)} - {
        store.PACKAGE
    }


def test_columns_have_units_and_meaning():
    package = json.loads(store.PACKAGE.read_text())
    fields = package["resources"][0]["schema"]["fields"]
    assert [f["name"] for f in fields] == list(dataset.load().columns)
    assert all(f["description"] for f in fields)
    assert all(("unit" in f) == (f["type"] == "number") for f in fields)
    others = [of for r in package["resources"] if "schema" in r for of in r["schema"]["fields"]]
    assert all(of["description"] for of in others)
    text = (paths.DATA / "README.md").read_text()
    for field in fields:
        assert f"`{field['name']}`" in text


def test_measured_times_are_kept_with_their_hash(copy):
    frame = dataset.measured()
    assert set(frame.chart) == {"laws", "solvers", "steppers", "flexible"}
    assert (frame.groupby("chart", sort=False).relative.first() == 1).all()
    before = dataset.measured("steppers")
    laws = frame[frame.chart == "laws"].assign(machine="another")
    store.keep_measured(laws)
    assert set(dataset.measured("laws").machine) == {"another"}
    pd.testing.assert_frame_equal(dataset.measured("steppers"), before)
    own = frame[(frame.chart == "steppers") & (frame.program == "ours")].iloc[:1]
    store.keep_measured(own)
    after = dataset.measured("steppers")
    assert (after.program == "ours").sum() == 1
    others = before[before.program != "ours"].reset_index(drop=True)
    pd.testing.assert_frame_equal(after[after.program != "ours"].reset_index(drop=True), others)
    store.verify()


@pytest.mark.parametrize(
    "name",
    [
        "data/force_curves.csv",
        "data/published/claims.csv",
        "data/published/joint.csv",
        "data/solutions/cases.json",
        "data/datapackage.json",
        "study/pages/looks.csv",
        "study/contact/stiffening.csv",
    ],
)
def test_a_flipped_digit_and_a_missing_file_are_named_with_the_remedy(copy, name):
    path = copy.parent / name
    text = path.read_text(encoding="utf-8")
    digit = re.search(r"\d", text).start()
    path.write_text(f"{text[:digit]}{9 - int(text[digit])}{text[digit + 1 :]}", encoding="utf-8")
    restore = f"git checkout -- {name} data/SHA256SUMS"
    with pytest.raises(dataset.DatasetError, match=rf"^{name} is not .*{restore}\. If you edited"):
        dataset.verify()
    store.write_hashes([path])
    dataset.verify()
    path.unlink()
    with pytest.raises(dataset.DatasetError, match=rf"^{name} is missing.*git checkout -- {name}"):
        dataset.verify()


def test_hashes_that_are_damaged_or_lack_a_file_are_refused(copy):
    lines = store.HASHES.read_text().splitlines(keepends=True)
    store.HASHES.write_text("".join(line for line in lines if "claims.csv" not in line))
    with pytest.raises(
        dataset.DatasetError,
        match=r"^data/published/claims.csv is not the file whose SHA-256 hash is in data/SHA256",
    ):
        dataset.verify()
    store.HASHES.write_text("junk")
    with pytest.raises(dataset.DatasetError, match=r"^data/SHA256SUMS is missing or damaged"):
        dataset.load()


def test_what_others_printed_names_its_source_and_a_whole_joint():
    rows = dataset.others()
    entries = (paths.PAPER / "references.yml").read_text(encoding="utf-8")
    by_doi = rows.source.str.startswith("10.")  # its title or authors were not seen
    assert set(rows.source[~by_doi]) <= set(re.findall(r"^(\w+):$", entries, re.MULTILINE))
    assert not any(f"doi: {doi}" in entries for doi in rows.source[by_doi])
    assert set(rows.role) == {"stated", "assumed", "second joint", "result", "unread"}
    assert rows.minimum.isna().equals(rows.role == "unread")
    assert not (rows.minimum > rows.maximum).any()
    results = rows[rows.role == "result"]
    assert (results.rounding > 0).all()
    assert results.read.notna().all()
    needed = {"ball_radius", "clearance", "ball_modulus", "ball_poisson", "wall_1", "force"}
    for joint in results.joint.unique():
        given = rows[(rows.joint == joint) & rows.role.isin(["stated", "assumed"])]
        assert given.quantity.is_unique
        assert needed <= set(given.quantity)


def test_the_schema_allows_what_the_design_has():
    fields = json.loads(store.PACKAGE.read_text())["resources"][0]["schema"]["fields"]
    allowed = {f["name"]: f["constraints"].get("enum") for f in fields}
    assert allowed["group"] == list(design.GROUPS)
    assert allowed["ball_support"] == [kind.word for kind in BALL_SUPPORTS if kind.is_half]
    for column, names in (("rim", RIMS), ("kinematics", KINEMATICS), ("solver", SOLVERS)):
        assert allowed[column] == list(names)


def test_numbers_that_agree_leave_the_stored_file(copy):
    stored, frame = store.CURVES.read_bytes(), dataset.load()
    store.write_table(frame.assign(force_star=frame.force_star * (1 + 1e-8)), store.CURVES)
    assert store.CURVES.read_bytes() == stored
    store.write_table(frame.assign(force_star=frame.force_star * (1 + 1e-5)), store.CURVES)
    assert store.CURVES.read_bytes() != stored
    dataset.verify()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda f: f[f.case != "ratio-1.05-linear-200"], "cases .*missing: ratio-1.05-linear-200"),
        (lambda f: f.iloc[1:], "cases of the design, with all depths"),
        (lambda f: f.rename(columns={"rim": "edge"}), "columns .*missing: rim; not in .*: edge"),
    ],
)
def test_what_is_not_complete_fails_the_check(copy, change, message):
    store.write_table(change(dataset.load()), store.CURVES)
    with pytest.raises(dataset.DatasetError, match=rf"force_curves.csv must have the {message}"):
        list(check.check())


@pytest.mark.slow
def test_numbers_unlike_the_solver_fail_the_check(copy):
    case = next(case for case in design.every_case() if case.group == "ratio")
    solution = next(case for case in cached.requests() if case.kind == "stress")
    assert check._difference(case) is None
    assert check._difference(solution) is None
    curves, stresses = dataset.load(), store.read(store.SOLUTIONS["stress"])
    curves.loc[curves.case == case.name, "force_star"] *= 1 + 1e-5
    stresses.loc[stresses.case == solution.name, "von_mises"] *= 1 + 1e-5
    store.write_table(curves, store.CURVES)
    store.write_table(stresses, store.SOLUTIONS["stress"])
    assert f"case {case.name} solved again differs: row" in check._difference(case)
    assert f"case {solution.name} solved again differs" in check._difference(solution)


def test_a_case_is_solved_to_the_same_bytes_on_any_number_of_threads():
    joint = Joint.from_ratios(20, 1.5, kinematics="small")
    case = design.Case("ratio", "one", joint, (0.1, 0.5))
    texts = set()
    for threads in (1, 2):
        series.compliance.cache_clear()
        with threadpool_limits(threads):
            texts.add(store.as_csv(design.solve(case), "force_curves"))
    assert len(texts) == 1
