"""The commands for what is stored: cases of the dataset, materials, times."""

import re
from io import StringIO

import pandas as pd
import pytest

from study import contact, dataset, paths
from study.cli import output
from study.contact import materials
from study.dataset import solutions, store
from study.joint import Joint
from study.measure import timing
from study.pages import catalogue, execute


def test_materials_are_csv_where_piped(run):
    status, out, err = run("data", "materials")
    assert (status, err) == (0, "")
    pd.testing.assert_frame_equal(pd.read_csv(StringIO(out)), pd.read_csv(materials.MATERIALS))


def test_cases_are_csv_where_piped_and_fit_a_terminal(run, on_a_terminal):
    words = ("data", "show", "--r2-star", 200, "--kinematics", "linear")
    table = pd.read_csv(StringIO(run(*words)[1]))
    cases = dataset.summary(dataset.load(r2_star=200, kinematics="linear"))
    assert list(table) == list(cases)
    assert list(table.case) == list(cases.case)
    assert table.largest_force.to_numpy() == pytest.approx(cases.largest_force, rel=1e-8)
    lines = on_a_terminal(*words)
    same = "r2_star 200, kinematics linear, largest_depth 1."
    assert f"{len(cases)} cases. All have: {same}" in " ".join(lines)
    lines = lines[lines.index("") :]
    assert max(map(len, lines)) <= 80
    assert any("poisson_socket: " in line for line in lines)
    rows = " ".join(line or "\n" for line in lines).split("\n")[1:]
    assert [row.split()[:2] for row in rows] == [["case:", f"{case},"] for case in cases.case]
    assert all("largest_force: " in row and "P/(E* dR^2)" in row for row in rows)
    one = pd.read_csv(StringIO(run("data", "show", "--case", "paper-small-200")[1]))
    assert list(one) == list(dataset.load().loc[:, "depth_star":])


def test_cases_are_a_table_on_a_wide_terminal(run, on_a_terminal, monkeypatch):
    monkeypatch.setattr(output, "_terminal", lambda: 200)
    lines = on_a_terminal("data", "show")
    cases = dataset.summary(dataset.load())
    assert lines[0] == f"{len(cases)} cases."
    assert max(map(len, lines)) <= 200
    assert [line.split()[0] for line in lines[-len(cases) :]] == list(cases.case)
    assert "poisson" in lines[2]


def test_of_a_number_that_no_case_has_the_nearest_is_shown(run):
    there = ("data", "show", "--group", "paper", "--socket-ratio", 1.298)
    status, out, err = run(*there)
    assert (status, err) == (0, "")
    expected = dataset.load(group="paper", socket_ratio=1.298)
    assert set(expected.case) == set(pd.read_csv(StringIO(out)).case)
    status, shown, err = run(*there[:-1], 1.3)
    assert (status, shown, err.count("\n")) == (0, out, 1)
    assert "socket_ratio = 1.3" in err
    assert "1.298" in err


def test_cases_are_chosen_by_every_column(run):
    first, columns = dataset.load(case="hip-4mm-linear-100").iloc[0], []
    for column in dataset.load().loc[:, :"solver"]:
        if first[column] != "":
            columns += [f"--{column.replace('_', '-')}", first[column]]
    out = run("data", "show", *columns)[1]
    assert out == run("data", "show", "--case", "hip-4mm-linear-100")[1]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--r2-star", "7"], "r2_star must be >= 20 and <= 10000, got 7"),
        (["--case", "papr-small-200"], "did you mean paper-small-200 or paper-small-2000 or "),
    ],
)
def test_cases_that_are_not_there(run, words, message):
    status, out, err = run("data", "show", *words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err


def test_missing_data_is_one_line_and_status_1(run, monkeypatch):
    monkeypatch.setattr(store, "PACKAGE", paths.ROOT / "missing.json")
    status, _, err = run("data", "show")
    assert (status, err.count("\n")) == (1, 1)
    assert err.startswith("study: missing.json is missing or damaged; restore it with: git")


def test_measure_times_a_chart_and_writes_where_told(run, tmp_path, monkeypatch):
    monkeypatch.setattr(timing, "compile_time", lambda *_: 1.0)  # it takes some seconds
    table = tmp_path / "laws.csv"
    kept = store.SPEED.read_bytes()
    status, out, _ = run("measure", "--chart", "laws", "--repeats", 1, "--output", table)
    assert status == 0
    assert re.match(r"\d+ times were measured on .+\n", out)
    rows = pd.read_csv(table)
    assert set(rows.method) == {*contact.LAWS, "tabulated", "solver"}
    assert (rows.time > 0).all()
    assert store.SPEED.read_bytes() == kept


def test_kept_solutions_are_listed_and_printed(run):
    listed = pd.read_csv(StringIO(run("data", "solutions")[1]))
    assert tuple(listed) == solutions.COLUMNS
    assert set(" ".join(listed.notebooks).split()) <= {nb.name for nb in catalogue.CATALOGUE}
    for kind, case in listed.groupby("kind").case.first().items():
        printed = pd.read_csv(StringIO(run("data", "solutions", "--case", case)[1]))
        kept = store.read(store.SOLUTIONS[kind])
        assert len(printed) == (kept.case == case).sum() > 0
    status, out, err = run("data", "solutions", "--case", f"{listed.case[0][:-1]}-")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"did you mean {listed.case[0]}" in err


def test_recording_a_notebook_renews_its_rows(run, monkeypatch, tmp_path):
    monkeypatch.setattr(paths, "BUILD", tmp_path)
    before, kept = solutions.design(), {}
    monkeypatch.setattr(store, "keep", lambda frame, path: kept.update({path: frame}))
    monkeypatch.setattr(execute, "execute", lambda notebook: solutions.curve(Joint(77), [0.1]))
    status, out, err = run("data", "record", "03-force-against-depth")
    assert (status, err) == (0, "")
    assert out.endswith(" needs 1 solution\n")
    name = out.split()[0]
    after = kept[store.CASES]
    (row,) = after[after.notebooks.str.contains(name)].to_dict("records")
    assert '"r2_star": 77.0' in row["joint"]
    others = before[before.notebooks != name].case
    assert set(after.case) == {*others, row["case"]}
