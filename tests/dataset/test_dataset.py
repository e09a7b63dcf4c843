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


def test_dataset_holds_the_papers_design_the_wider_sweep_and_every_group():
    paper, frame = dataset.paper_curves(), dataset.load()
    assert sorted(set(paper.r2_star)) == [*range(20, 301, 20), 400, 600, 1000, 2000, 5000, 10000]
    assert (paper.groupby("r2_star").size() == 40).all()
    assert np.allclose(sorted(set(paper.depth_star)), np.arange(1, 41) * 0.025)
    assert not frame.isna().any().any()
    assert set(frame.group) == set(design.GROUPS)
    validation = frame[frame.group == "validation"].drop_duplicates("case")
    counts = design.FREE_VALIDATION, design.HELD_VALIDATION, design.REFERENCE_VALIDATION
    assert len(validation) == sum(counts)
    of_supports = validation.groupby(["ball_support", "rim"]).size()
    assert of_supports.min() >= 8
    assert of_supports["clamped", "free"] >= design.REFERENCE_VALIDATION


def test_filters_select_rows():
    rows = dataset.load(r2_star=[20, 200], kinematics="small", group="paper")
    assert set(rows.r2_star) == {20, 200}
    assert set(rows.kinematics) == {"small"}
    assert list(rows.index) == list(range(80))
    for filters, message in (
        ({"group": "liner", "ball_support": "clamped"}, "support must be one of guided, got clamp"),
        ({"r2_star": [200, 7.0]}, "r2_star must be one that study data show lists, got 7.0"),
        ({"r2_star": "x"}, "r2_star must be one that study data show lists, got x"),
        ({"radius": 1}, "column must be one of group.*got 'radius'"),
    ):
        with pytest.raises(ValueError, match=message):
            dataset.load(**filters)


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
    resources = json.loads(store.PACKAGE.read_text())["resources"]
    described = {store.PACKAGE, *(paths.DATA / of["path"] for of in resources)}
    assert described == {path for path in store.files() if path.is_relative_to(paths.DATA)}
    fields = resources[0]["schema"]["fields"]
    assert [f["name"] for f in fields] == list(dataset.load().columns)
    assert all(("unit" in f) == (f["type"] == "number") for f in fields)
    every = [of for r in resources if "schema" in r for of in r["schema"]["fields"]]
    assert all(of["description"] for of in every)
    text = (paths.DATA / "README.md").read_text()
    assert all(f"`{field['name']}`" in text for field in fields)
    allowed = {f["name"]: f["constraints"].get("enum") for f in fields}
    assert allowed["group"] == list(design.GROUPS)
    assert allowed["ball_support"] == [kind.word for kind in BALL_SUPPORTS if kind.is_half]
    for column, names in (("rim", RIMS), ("kinematics", KINEMATICS), ("solver", SOLVERS)):
        assert allowed[column] == list(names)


def test_measured_times_are_kept_with_their_hash(copy):
    frame = dataset.measured()
    assert set(frame.chart) == {"laws", "solvers", "steppers", "second", "flexible"}
    assert (frame.groupby("chart", sort=False).relative.first() == 1).all()
    before = dataset.measured("steppers")
    laws = frame[frame.chart == "laws"].assign(machine="another")
    store.keep_measured(laws[laws.program == "ours"])
    kept = dataset.measured("laws").groupby("method").machine.first()
    assert kept.drop("closed form").eq("another").all()
    assert kept["closed form"] != "another"  # what was not timed stays
    pd.testing.assert_frame_equal(dataset.measured("steppers"), before)
    store.verify()


@pytest.mark.parametrize(
    "name",
    [
        "data/force_curves.csv",
        "data/solutions/cases.json",
        "data/datapackage.json",
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
    wanted = r"^data/published/claims.csv is not the file whose SHA-256 hash is in data/SHA256"
    with pytest.raises(dataset.DatasetError, match=wanted):
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


def test_numbers_unlike_the_solver_fail_the_check(copy):
    request = next(request for request in cached.requests() if request.kind == "stress")
    assert check._difference(request) is None
    stresses = store.read(store.SOLUTIONS["stress"])
    stresses.loc[stresses.case == request.name, "von_mises"] *= 1 + 1e-5
    store.write_table(stresses, store.SOLUTIONS["stress"])
    assert f"case {request.name} solved again differs: row" in check._difference(request)


def test_a_case_is_solved_to_the_same_bytes_on_any_number_of_threads():
    joint = Joint.from_ratios(20, 1.5, kinematics="small")
    case = design.Case("ratio", "one", joint, (0.1, 0.5))
    texts = set()
    for threads in (1, 2):
        series.compliance.cache_clear()
        with threadpool_limits(threads):
            texts.add(store.as_csv(design.solve(case), "force_curves"))
    assert len(texts) == 1
