"""Cases in tables: the solutions of the library, whatever the processes, and no bad case hidden."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from io import StringIO

import numpy as np
import pandas as pd
import pytest

from study.cases import joints, run, scenes
from study.cases.joints import JOINTS
from study.cases.scenes import SCENES
from study.joint import Joint
from study.mechanism import Scene, simulate

SIZED = {"socket_radius": "12.5mm", "clearance": 40e-6, "wall": "6mm", "socket": "bronze"}
BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
CHEAP = [{"r2_star": radius, "depth_star": "0.1;0.5"} for radius in np.geomspace(50, 500, 5)]


def same(one, other):
    """Compare the digits that are written: the last ones depend on where arrays are in memory."""
    pd.testing.assert_frame_equal(one, other, rtol=1e-8)


def test_joints_are_those_of_the_library():
    hard = {"wall": "5mm", "socket": "UHMWPE", "liner": "0.1mm,CoCr", "force": "100"}
    given = SIZED | {"force": "3kN;8kN"}, SIZED | {"liner": "0.5mm,PTFE", "depth": "5um"}
    table = run.solve(JOINTS, [*given, SIZED | hard], jobs=1)
    solution = BRONZE.solve(force=[3e3, 8e3], stresses=True)
    lined = replace(BRONZE, liner="0.5mm,PTFE").solve(depth=5e-6)
    hard = replace(BRONZE, wall=5e-3, socket="UHMWPE", liner="0.1mm,CoCr").solve(force=100)
    for name in ("depth", "force", "peak_pressure", "force_error", "friction_radius"):
        expected = [value for of in (solution, lined, hard) for value in getattr(of, name)]
        assert table[name].to_numpy() == pytest.approx(expected)
    factor = solution.yield_factor["socket"]
    assert table.yield_factor_socket[:2].to_numpy() == pytest.approx(factor)
    assert table.socket_radius.tolist() == [12.5e-3] * 4
    assert table.applicability.tolist()[0] == "inside"


def test_k_and_n_are_within_their_error_around_the_load():
    found = {name: of[0] for name, of in joints.solve(SIZED | {"force": "3kN"}).items()}
    ends = found["power_from"], found["power_to"]
    depth = np.linspace(*ends, 9)
    power = found["power_coefficient"] * depth ** found["power_exponent"]
    error = np.abs(power / BRONZE.solve(depth=depth).force - 1).max()
    assert error == pytest.approx(found["power_error"], rel=0.1)
    assert ends == pytest.approx((found["depth"] / 2, 2 * found["depth"]), rel=1e-3)


def test_a_power_law_that_cannot_be_fitted_does_not_lose_the_solution(monkeypatch):
    def fails(*_):
        raise ValueError("the contact is too small")

    monkeypatch.setattr(Joint, "power_law", fails)
    columns = joints.solve(SIZED | {"force": "3kN"})
    assert columns["depth"] == pytest.approx(BRONZE.solve(force=3e3).depth)
    assert columns["warnings"] == ["No power law was fitted: the contact is too small."]
    assert "power_exponent" not in columns


def test_a_joint_without_loads_is_a_curve():
    joint = Joint.from_ratios(50)
    assert "power_exponent" not in joints.solve({"r2_star": 50})
    columns = joints.solve({"r2_star": 50, "power_law": "yes"})
    assert columns["force_star"] == pytest.approx(joint.curve().force_star)
    assert columns["power_exponent"][0] == pytest.approx(joint.power_law().exponent)


def test_the_tilt_of_a_force_and_that_of_its_displacement_are_two_columns():
    case = {"r2_star": 100, "ball_support": "core:0.3", "tilt": 20, "depth_star": 0.2}
    (row,) = run.solve(JOINTS, [case], jobs=1).itertuples()
    assert (row.tilt, row.displacement_tilt) == (20, 20)
    assert row.transverse_star != 0


def test_scenes_are_those_of_the_simulation():
    response = simulate(Scene(restitution=0.9, clearance=1e-4), duration=0.02)
    case = {"restitution": "0.9", "clearance": "100um", "duration": "20ms"}
    (row,) = run.solve(SCENES, [case | {"run": "a"}], jobs=1).itertuples()
    assert (row.contacts, row.largest_force) == (response.contacts, response.largest_force)
    assert (row.clearance, row.run) == (1e-4, "a")
    walled = scenes.solve({"duration": "10ms", "wall": "5mm", "socket": "bronze", "ball": "steel"})
    assert walled["largest_force"] != scenes.solve({"duration": "10ms"})["largest_force"]


def test_processes_do_not_change_a_number():
    one, two = (run.solve(JOINTS, CHEAP, jobs=jobs) for jobs in (1, 2))
    same(one, two)


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_table():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(1, processes=False, dashboard_address=None) as cluster:
        table = run.solve(JOINTS, CHEAP, dask=cluster.scheduler_address)
    same(table, run.solve(JOINTS, CHEAP, jobs=1))


@pytest.mark.parametrize(
    ("case", "reason"),
    [
        ({"r2_star": 5}, "r2_star must be >= 10"),
        ({"r2_star": float("nan")}, "r2_star must be finite"),
        ({"r2_star": 50, "wall": "6mm"}, "r2_star and wall must not both be given"),
        (SIZED | {"force": "3kg"}, "force must be a number in N, or with its unit"),
        (SIZED | {"clearance": "", "play": ""}, "; empty cells: clearance, play"),
    ],
)
def test_a_case_that_fails_is_a_row_with_its_reason(case, reason):
    table = run.solve(JOINTS, [{"r2_star": 50, "depth_star": 0.1}, case], jobs=1)
    assert table.force_star.notna().tolist() == [True, False]
    assert reason in table.error[1]


@pytest.mark.parametrize(
    ("text", "cases"),
    [
        ("name,wall [mm],force\na,6,\n,,\n", [{"name": "a", "wall": "6mm", "force": ""}]),
        ('wall (mm);force [kN]\n6,5;"3;8,5"\n', [{"wall": "6.5mm", "force": "3kN;8.5kN"}]),
        ("liner;depth\n0.5mm,PTFE;1,5um\n", [{"liner": "0.5mm,PTFE", "depth": "1.5um"}]),
        (
            'liner,depth [μm]\n"8mm,UHMWPE;1mm,PTFE",1\n',
            [{"liner": "8mm,UHMWPE;1mm,PTFE", "depth": "1μm"}],
        ),
        ("wall [\u00b5m],force [lbf]\n6,7\n", [{"wall": "6\u00b5m", "force": "7lbf"}]),
        ("wall [in]\n0.5\n", [{"wall": "0.5in"}]),
        ("\ufeffwall\theat [K]\n6mm\t293,1\n", [{"wall": "6mm", "heat [K]": "293,1"}]),
    ],
)
def test_cells_of_a_file(tmp_path, text, cases):
    (tmp_path / "cases.csv").write_text(text, encoding="utf-8")
    found = run.read(tmp_path / "cases.csv", joints.PARAMETERS)
    assert found == cases


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("wall [mm]\n6\n7mm\n", r"row 2: wall \[mm\] must be a number, got '7mm'"),
        (
            "wall [furlong]\n6\n",
            "the unit of wall must be m with or without a prefix, or in, got f",
        ),
        ("wall [Mm]\n6\n", "the unit of wall must be m with or without a prefix, or in, got Mm"),
        ("opening [deg]\n80\n", "the unit of opening must be left out, got deg"),
        ("wall,wall [mm]\n6,6\n", "each column must have a different name"),
        ("wall,rim\n6\n", "row 1 of .* must have 2 cells, as its first line has, got 1"),
        ("wall\n", "FILE must have a row below its heads"),
        ("wall\n\xff\n", "FILE must be a CSV file"),
    ],
)
def test_wrong_files(tmp_path, text, message):
    (tmp_path / "cases.csv").write_text(text, encoding="latin-1")
    with pytest.raises(ValueError, match=message):
        run.read(tmp_path / "cases.csv", joints.PARAMETERS)


def test_only_missing_and_failed_cases_are_solved_again(tmp_path):
    file, calls = tmp_path / "table.csv", []

    def counted(case):
        calls.append(case)
        return joints.solve(case)

    kind = JOINTS._replace(solve=counted)
    given = [*CHEAP, {"r2_star": 5, "depth_star": 0.1}, CHEAP[0]]  # one fails, one comes twice
    first = run.solve(kind, given, file, jobs=1)
    assert (len(calls), first.error.notna().sum(), len(first)) == (6, 1, 13)
    assert first.force_star.iloc[-1] == pytest.approx(first.force_star[1])
    whole = file.read_text()
    file.write_text("".join(whole.splitlines(keepends=True)[:6]) + "54.1,0.")  # cut in the third
    run.solve(kind, given, file, jobs=1)
    same(pd.read_csv(file), pd.read_csv(StringIO(whole)))
    assert len(calls) == 6 + 4
    run.solve(kind, [*CHEAP[1:], {"r2_star": 60, "depth_star": 0.2}], file, jobs=1)
    assert len(calls) == 11
    run.solve(kind, [case | {"power_law": "yes"} for case in CHEAP[:1]], file, jobs=1)
    assert len(calls) == 12


def test_what_would_be_overwritten_is_an_error(tmp_path):
    (tmp_path / "cases.csv").write_text("wall\n6mm\n")
    with pytest.raises(ValueError, match="output must be a new file, or a table of this command"):
        run.solve(JOINTS, CHEAP, tmp_path / "cases.csv", jobs=1)
    with pytest.raises(ValueError, match="column stiffness must have another name"):
        run.solve(JOINTS, [CHEAP[0] | {"stiffness": "high"}], jobs=1)


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="has no SIGKILL")
def test_a_killed_command_goes_on_where_it_was(tmp_path):
    rows = [f"{radius},core:0.2,20,0.2" for radius in range(50, 58)]
    head = "r2_star,ball_support,tilt,depth_star"
    (tmp_path / "cases.csv").write_text("\n".join([head, *rows]) + "\n")
    words = ["joint", "cases.csv", "--output", "table.csv", "--jobs", "1"]
    words = [sys.executable, "-m", "study.cli", *words]
    command = subprocess.Popen(words, cwd=tmp_path)
    table = tmp_path / "table.csv"
    while not table.is_file() or len(table.read_text().splitlines()) < 3:
        time.sleep(0.05)
        assert command.poll() is None
    command.send_signal(signal.SIGKILL)
    command.wait()
    kept = table.read_text().splitlines()[:3]
    assert len(table.read_text().splitlines()) < 9
    subprocess.run(words, cwd=tmp_path, check=True)
    assert table.read_text().splitlines()[:3] == kept
    assert pd.read_csv(table).r2_star.tolist() == [*range(50, 58)]
