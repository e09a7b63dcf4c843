"""The commands for what is stored: cases of the dataset, materials, times."""

import re
from io import StringIO

import pandas as pd
import pytest

from study import contact, dataset, paths
from study.cli import output
from study.contact import materials
from study.dataset import store
from study.measure import timing


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
    monkeypatch.setattr(output, "_terminal", lambda: 400)
    lines = on_a_terminal("data", "show")
    cases = dataset.summary(dataset.load())
    assert lines[0].startswith(f"{len(cases)} cases.")
    assert max(map(len, lines)) <= 400
    assert [line.split()[0] for line in lines[-len(cases) :]] == list(cases.case)
    assert "poisson" in lines[2]


def test_cases_are_chosen_by_every_column(run):
    first, columns = dataset.load(case="hip-4mm-linear-100").iloc[0], []
    for column in dataset.load().loc[:, :"solver"]:
        if first[column] != "":
            columns += [f"--{column.replace('_', '-')}", first[column]]
    out = run("data", "show", *columns)[1]
    assert out == run("data", "show", "--case", "hip-4mm-linear-100")[1]


def test_missing_data_is_one_line_and_status_1(run, monkeypatch):
    monkeypatch.setattr(store, "CURVES", paths.DATA / "missing.csv")
    status, _, err = run("data", "show")
    assert (status, err.count("\n")) == (1, 1)
    assert err.startswith("study: data/missing.csv is missing; restore it with: git checkout")


def test_a_check_says_what_it_found(run):
    status, out, err = run("data", "check", "--sample", 1, "--jobs", 1)
    assert (status, err) == (0, "")
    assert [line.split()[0] for line in out.splitlines()[2:]] == [
        "hashes",
        "description",
        "cases",
        "solved",
    ]


def test_only_files_of_the_dataset_are_accepted(run, tmp_path, monkeypatch):
    hashed = []
    monkeypatch.setattr(store, "write_hashes", hashed.extend)
    file = paths.DATA / "published/claims.csv"
    status, _, err = run("data", "accept", file)
    assert (status, err, hashed) == (0, "", [file])
    status, _, err = run("data", "accept", tmp_path / "x.csv")
    assert (status, err) == (
        2,
        f"study: FILE must be a file of the dataset, got {tmp_path}/x.csv\n",
    )


@pytest.mark.slow
def test_measure_times_a_chart_and_writes_where_told(run, tmp_path, monkeypatch):
    monkeypatch.setattr(timing, "compile_time", lambda *_: 1.0)  # it takes some seconds
    table = tmp_path / "laws.csv"
    kept = store.SPEED.read_bytes()
    status, out, _ = run("measure", "--chart", "laws", "--repeats", 1, "--output", table)
    assert status == 0
    assert re.match(r"\d+ times were measured on .+\n", out)
    rows = pd.read_csv(table)
    assert set(rows.method) == {*contact.LAWS, "solver"}
    assert (rows.time > 0).all()
    assert store.SPEED.read_bytes() == kept


@pytest.mark.slow
def test_one_method_is_timed_and_the_other_rows_stay(run, monkeypatch):
    monkeypatch.setattr(timing, "compile_time", lambda *_: 1.0)
    before, written = dataset.measured(), []
    monkeypatch.setattr(
        store, "keep_measured", lambda frame: written.append(dataset.renewed(frame))
    )
    status, out, _ = run("measure", "--method", "liu", "--repeats", 1)
    assert status == 0
    assert out.startswith("1 times were measured")
    (after,) = written
    is_liu = before.method == "liu"
    pd.testing.assert_frame_equal(after[~is_liu], before[~is_liu])
    assert after.method.equals(before.method)
    assert 0 < after[is_liu].relative.item() != before[is_liu].relative.item()
