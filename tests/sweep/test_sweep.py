"""Parameter studies: one table whatever the processes, resumed, and no bad case begun."""

import csv
import os
import re
from contextlib import suppress
from functools import partial

import numpy as np
import pandas as pd
import psutil
import pytest

from study import paths
from study.checks import StudyError
from study.joint import Joint
from study.joint.solution import quantities
from study.mechanism import MechanismError, Scene, compare, simulate
from study.sweep import COLUMNS, cases, random_cases, run, run_study

JOINTS = {"r2_star": "20:2000:log", "socket_ratio": "1.1:2", "modulus_ratio": "0.3:3:log"}
JOINTS |= {"kinematics": "small,linear"}
SCENES = {"clearance": "2e-5:2e-4:log", "restitution": "0.2:0.95", "duration": "0.01"}
SCENES |= {"law": "hertz,stiffened_hertz"}
POWER = [f"power_{name}" for name in ("coefficient", "exponent", "error")]
OFF_AXIS = ["displacement_tilt", "transverse_star", "transverse_stiffness_star"]
OFF_AXIS += ["peak_angle_deg", "contact_from_deg", "contact_to_deg", "warnings"]
"""Columns that are empty along the axis."""
RING = {"ball_support": "bore:0.5,45", "opening": "55:125"}
OF_SIZES = {"socket_radius": 12.5e-3, "clearance": 40e-6, "wall": 6e-3, "socket": "bronze"}


def assert_solution(rows, solution):
    """Rows of a table are a solution, with the power law of its joint."""
    joint = solution.joint
    for name in quantities(joint.has_dimensions):
        column, values = (
            rows[{"tilt": "displacement_tilt"}.get(name, name)],
            getattr(solution, name),
        )
        assert column.isna().all() if values is None else column.to_numpy() == pytest.approx(values)
    k, n, error, _ = joint.power_law(tilt=solution.direction_deg)
    if not joint.has_dimensions:
        k *= joint.clearance**n / joint.force_unit
    assert rows[POWER].to_numpy() == pytest.approx(np.tile([k, n, error], (len(rows), 1)))


def swept(given, kind, output, jobs=1, **more):
    return run_study(given, kind, output, jobs=jobs, **more), pd.read_csv(output)


@pytest.mark.parametrize(("kind", "ranges"), [("joints", JOINTS), ("scenes", SCENES)])
def test_random_cases_give_the_same_bytes_with_one_process_and_two(tmp_path, kind, ranges):
    given, progress = random_cases(12, ranges, seed=1), []
    for jobs in (1, 2):
        found, table = swept(
            given, kind, tmp_path / f"{jobs}.csv", jobs, progress=lambda *n: progress.append(n)
        )
        assert found == (12, len(table), COLUMNS[kind], {}, [])
    assert (tmp_path / "1.csv").read_bytes() == (tmp_path / "2.csv").read_bytes()
    assert sorted(os.listdir(tmp_path)) == ["1.csv", "2.csv"]
    assert progress == 2 * [(k, 12, 0) for k in range(13)]
    assert list(table.case.unique()) == list(range(1, 13))
    assert list(table) == ["case", *ranges, *COLUMNS[kind], "error"]
    empty = table.columns[table.isna().all()]
    assert set(empty) == {"error", *(OFF_AXIS if kind == "joints" else ["agrees_until"])}
    assert table.drop(columns=empty).notna().all(axis=None)


def test_joints_without_dimensions_are_those_of_the_solver(tmp_path):
    given = [
        {"case": "lined", "r2_star": 80, "layer": "1.125,0.0025,0.46;1.5,1,0.3"},
        {"case": "deep", "r2_star": 75, "socket_poisson": 0.4, "depth_star": [0.5, 0.1]},
    ]
    _, table = swept(given, "joints", tmp_path / "table.csv")
    lined, deep = (table[table.case == name] for name in ("lined", "deep"))
    layers = "1.125,0.0025,0.46;1.5,1,0.3"
    assert_solution(lined, Joint.from_ratios(80, layers=layers).curve())
    joint = Joint.from_ratios(75, socket_poisson=0.4)
    assert_solution(deep, joint.solve(depth_star=[0.5, 0.1]))
    assert deep.applicability.tolist() == ["wall", "wall"]


def test_joints_with_dimensions_are_those_of_the_solver(tmp_path):
    given = [
        OF_SIZES | {"force": "3000; 8000"},
        OF_SIZES | {"liner": ["0.5mm,PTFE"], "depth": "5um", "ball": None, "rim": None},
        OF_SIZES,
    ]
    _, table = swept(given, "joints", tmp_path / "table.csv")
    forces, lined, whole = (table[table.case == case] for case in (1, 2, 3))
    joint = Joint(**OF_SIZES)
    solved = joint.solve(force=[3000, 8000], stresses=True)
    assert_solution(forces, solved)
    assert_solution(whole, joint.curve())
    assert_solution(lined, Joint(**OF_SIZES, liner="0.5mm,PTFE").solve(depth=5e-6))
    assert forces.applicability.tolist() == ["inside", "wall"]
    factors = np.minimum(solved.yield_factor["ball"], solved.yield_factor["socket"])
    assert forces.yield_factor.to_numpy() == pytest.approx(factors)
    at_3000 = np.interp(3000, whole.force, whole.yield_factor)
    assert at_3000 == pytest.approx(forces.yield_factor[0], rel=0.02)


def test_scenes_are_those_of_the_simulation(tmp_path):
    given = [
        {"restitution": 0.9, "duration": 0.02, "outputs": 200},
        {"ball": "steel", "socket": "bronze", "law": "stiffened_hertz", "socket_ratio": 1.5}
        | {"initial_eccentricity": "1e-5,0", "duration": 0.02},
        {"joint": "ideal", "gravity": 9.81, "initial_crank_angle": 1.0, "duration": 0.02},
    ]
    _, table = swept(given, "scenes", tmp_path / "table.csv")
    response = simulate(Scene(restitution=0.9), duration=0.02, outputs=200)
    row, impacts = table.iloc[0], response.impacts
    assert row.contacts == len(impacts) > 3
    assert row.largest_force == pytest.approx(impacts.peak_force.max(), rel=1e-8)
    assert row.largest_depth == pytest.approx(impacts.peak_depth.max(), rel=1e-8)
    assert row.energy_lost == pytest.approx(impacts.lost.sum(), rel=1e-6)
    clearance, ideal = Scene().clearance, table.iloc[2]
    assert 0 < row.mean_slider_deviation < row.largest_slider_deviation < 1.05 * clearance
    assert ideal.largest_slider_deviation < 1e-15
    assert (ideal.contacts, ideal.largest_force) == (0, 0)
    other = table.iloc[1]
    assert (row.delivered_restitution, other.delivered_restitution) == (0.9, 0.5)
    assert other.contacts > 3
    assert other.largest_force != row.largest_force


def test_scenes_run_twice_say_until_when_they_can_be_trusted(tmp_path):
    wild = {"restitution": 1.0, "friction": 0.0}
    given = [{"duration": 0.01}, wild, {"joint": "ideal"}, {"model": "beams", "duration": 1e-4}]
    once = swept(given, "scenes", tmp_path / "table.csv")[1]
    assert once.pop("agrees_until").isna().all()
    table = swept(given, "scenes", tmp_path / "table.csv", twice=True)[1]
    again = partial(simulate, Scene(**wild))
    agreement = compare.second_run(again(), again)
    assert 0.001 < agreement.until < 0.1
    expected = [0.01, agreement.until, np.nan, np.nan]
    assert table.agrees_until.to_list() == pytest.approx(expected, nan_ok=True)
    pd.testing.assert_frame_equal(table.drop(columns="agrees_until"), once)


def test_a_scene_whose_second_run_fails_is_a_row_with_its_reason(tmp_path, monkeypatch):
    def second_run(*_):
        raise MechanismError("no step is small enough")

    monkeypatch.setattr(cases, "second_run", second_run)
    found, _ = swept([{"duration": 0.01}], "scenes", tmp_path / "table.csv", twice=True)
    why = "the run at a second tolerance failed: no step is small enough"
    assert found.failures == {"1": why}


def test_more_random_cases_begin_with_the_fewer():
    few, many = (random_cases(count, JOINTS, seed=3) for count in (5, 200))
    assert few == many[:5] != random_cases(5, JOINTS, seed=4)
    r2_star = pd.DataFrame(many).r2_star.astype(float)
    assert 20 <= r2_star.min() < 25
    assert 1600 < r2_star.max() <= 2000
    assert r2_star.median() == pytest.approx(200, rel=0.4)


def stopped(given, output, after):
    """A study that ends after some cases, and how many were known when it began."""
    known = []

    def progress(done, *_):
        known.append(done)
        if done >= after:
            raise KeyboardInterrupt

    with suppress(KeyboardInterrupt):
        run_study(given, "scenes", output, jobs=1, progress=progress)
    return known[0]


def test_a_stopped_study_goes_on_and_passes_over_what_is_damaged(tmp_path, monkeypatch):
    given, output = random_cases(9, SCENES), tmp_path / "table.csv"
    run_study(given, "scenes", output, jobs=1)
    whole, part = output.read_bytes(), tmp_path / "table.csv.part"
    output.unlink()
    assert stopped(given, output, 0) == 0
    assert not part.exists()  # nothing is kept
    assert stopped(given, output, 5) == 0
    kept = part.read_bytes()
    assert len(kept.splitlines()) == 5
    part.write_bytes(b"\xff\x00 no line of ours\n[]\n" + kept[:-7])  # cut in the last line
    assert stopped(given, output, 6) == 4
    with monkeypatch.context() as patched:
        patched.setattr(run, "version", lambda _: "other")
        assert stopped(given, output, 1) == 0  # other code: nothing of it counts
    assert stopped(random_cases(3, SCENES), output, 9) == 3  # fewer cases, all known
    assert output.read_bytes() == b"".join(whole.splitlines(keepends=True)[:4])
    assert not part.exists()
    assert stopped(given, output, 5) == 0
    run_study(given, "scenes", output, jobs=1)
    assert output.read_bytes() == whole


def test_a_case_that_fails_is_a_row_with_its_reason(tmp_path, monkeypatch):
    given = [{"r2_star": 50, "depth_star": depth} for depth in (0.1, 9.0, 0.1)]
    given += [given[0] | {"socket_ratio": np.nan}, given[0] | {"r2_star": None}]
    found, table = swept(given, "joints", tmp_path / "table.csv")
    assert (found.cases, found.rows, list(found.failures)) == (5, 5, ["2", "4", "5"])
    assert found.failures["2"].startswith("depth_star must be < 8.9")
    assert found.failures["4"].startswith("socket_ratio must be finite and ")
    assert (
        found.failures["5"]
        == "socket_radius, clearance, wall must be given for a joint with dimensions; a joint "
        "without dimensions is described by r2_star instead"
    )
    assert table.error.tolist()[1] == found.failures["2"]
    assert table.force_star.isna().tolist() == [False, True, False, True, True]
    assert table.force_star[0] == table.force_star[2]

    def broken(*_, **__):
        raise KeyError("lost\nit")

    monkeypatch.setattr(Joint, "solve", broken)
    (row,) = cases.solve("joints", {"r2_star": 50.0, "depth_star": (0.1,)})
    assert row[-1] == "KeyError: 'lost\\nit'"


@pytest.mark.slow
def test_a_ring_and_a_tilt_are_solved_off_the_axis(tmp_path):
    ring = {"r2_star": 200} | RING
    given = [
        ring | {"depth_star": "0.2;0.4"},
        ring,
        {"r2_star": 200, "ball_support": "clamped", "tilt": 20, "depth_star": 0.3},
        {"r2_star": 200, "ball_support": "clamped", "depth_star": 0.3},
        {"r2_star": 200, "tilt": 20, "depth_star": 0.3},
    ]
    found, table = swept(given, "joints", tmp_path / "table.csv")
    assert list(found.failures) == ["5"]  # the ball is free across the axis
    at_two, whole, hip, axial, _ = (table[table.case == case] for case in range(1, 6))
    joint = Joint.from_ratios(**ring)
    assert_solution(at_two, joint.solve(depth_star=[0.2, 0.4]))
    assert_solution(whole, joint.curve())
    assert (at_two.displacement_tilt == 90).all()
    assert at_two.applicability.to_list() == ["wall", "rim; wall"]
    assert len(whole) == 9
    free = Joint.from_ratios(ball_support="clamped", rim="free")
    assert_solution(hip, free.solve(depth_star=0.3, tilt=20))
    assert hip.transverse_star.item() < -0.001 * hip.force_star.item()
    assert axial.displacement_tilt.isna().all()


def test_the_table_of_the_examples_can_be_solved(tmp_path):
    text = (paths.ROOT / "examples/README.md").read_text(encoding="utf-8")
    (tmp_path / "cases.csv").write_text(re.search(r"```text\n(case,.*?)```", text, re.DOTALL)[1])
    given = cases.load(tmp_path / "cases.csv")
    form = cases.form_of("joints", given, {})
    for case in given:
        cases.bodies_of(form, cases.values_of(form, case, {}))  # raises if it is impossible


def test_units_catalogues_and_a_saved_joint(run, tmp_path):
    """Heads and cells with units, decimal commas, and columns over the values of a joint."""
    save = tmp_path / "cup.toml"
    words = ("--socket-radius", "12.5mm", "--play", "80um", "--wall", "6mm", "--socket", "bronze")
    assert run("joint", *words, "--save", save)[0] == 0
    text = "case;wall [mm];play;force (kN)\na;6,0;80um;3\nb;5,5;0,06mm;3,0\n"
    (tmp_path / "cases.csv").write_text(text)
    found = run_study(tmp_path / "cases.csv", "joints", tmp_path / "table.csv", joint=save, jobs=1)
    table = pd.read_csv(tmp_path / "table.csv")
    assert found.failures == {}
    assert table.wall.tolist() == [6e-3, 5.5e-3]
    assert table.play.tolist() == [80e-6, 60e-6]
    first, second = Joint(**OF_SIZES), Joint(12.5e-3, 30e-6, 5.5e-3, socket="bronze")
    expected = [of.solve(force=3000.0).depth[0] for of in (first, second)]
    assert table.depth.to_numpy() == pytest.approx(expected)
    text = "model;elements;duration\nparticles;2,4;1e-4\nparticles;4,8;0,0001\n"
    (tmp_path / "scenes.csv").write_text(text)
    found = run_study(tmp_path / "scenes.csv", "scenes", tmp_path / "table.csv", jobs=1)
    assert found.failures == {}
    found = run_study([{"clearance": 30e-6}], "joints", tmp_path / "one.csv", joint=first, jobs=1)
    assert found.rows > 40


@pytest.mark.slow
def test_k_and_n_are_empty_where_the_range_of_the_fit_cannot_be_solved(tmp_path):
    given = [{"r2_star": 20, "opening": 30, "ball_support": "core:0.2", "depth_star": 0.1}]
    _, table = swept(given, "joints", tmp_path / "table.csv")
    assert table.force_star.notna().all()
    assert table[POWER].isna().all(axis=None)


def test_columns_of_the_user_are_kept_and_are_no_formulas(tmp_path):
    output = tmp_path / "table.csv"
    given = [{"part": part, "r2_star": 50, "depth_star": 0.1} for part in ("no 1", "=1+1", "-2")]
    found = run_study(given, "joints", output, jobs=1)
    assert found.kept == ["part"]
    table = pd.read_csv(output)
    assert list(table)[:4] == ["case", "part", "r2_star", "depth_star"]
    assert table.part.tolist() == ["no 1", "'=1+1", "-2"]


@pytest.mark.parametrize(
    ("column", "message"),
    [
        ("tlit", "did you mean tilt"),
        ("Tilt", "did you mean tilt"),
        ("opening_deg", "did you mean opening"),
        ("socket_raduis", "did you mean socket_radius"),
        ("force (lbf)", "did you mean force"),
        ("r2_star", "a parameter of joints and not of joints with dimensions"),
        ("friction", "a parameter of scenes and not of joints with dimensions"),
        ("yield_factor", "yield_factor must have another name"),
    ],
)
def test_a_column_that_may_be_meant_as_another_is_refused(column, message):
    form = "joints with dimensions"
    with pytest.raises(ValueError, match=message):
        cases.check_own(form, column)
    for other in ("part", "socket_mass", "wall_2", "bolt", "id", "lot", "force_note"):
        cases.check_own(form, other)


def test_on_a_dask_cluster(tmp_path):
    distributed = pytest.importorskip("distributed")
    given = random_cases(10, SCENES)
    run_study(given, "scenes", tmp_path / "processes.csv", jobs=1)
    options = {"n_workers": 1, "threads_per_worker": 2, "processes": False}
    with distributed.LocalCluster(**options, protocol="tcp://", dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        found = run_study(given, "scenes", tmp_path / "dask.csv", dask_address=address)
    assert found.cases == 10
    assert (tmp_path / "dask.csv").read_bytes() == (tmp_path / "processes.csv").read_bytes()


@pytest.fixture
def command(run, tmp_path):
    """A study from a table of text by the command line: status, output, errors."""

    def command(kind, text, *words):
        file = tmp_path / "cases.csv"
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        given = [] if text == "" else [file]
        return run("sweep", kind, *given, "--output", tmp_path / "table.csv", "--jobs", 1, *words)

    return command


SIZES = "socket_radius,clearance,wall"
FRICTION = ("--random", 5, "--range")


@pytest.mark.parametrize(
    ("kind", "text", "words", "message"),
    [
        ("joints", f"{SIZES}\n1e-2,-1,2e-3\n1e-2,-1,2e-3", (), "row 1: clearance must be > 0 m"),
        (
            "joints",
            f"{SIZES},depth,force\n1e-2,5e-5,2e-3,1e-6,5",
            (),
            "row 1: depth and force must",
        ),
        (
            "joints",
            "clearance\n5e-5",
            (),
            "row 1: socket_radius, wall must be given for a joint with",
        ),
        ("joints", "r2_star,socket_rato\n50,1.2", (), "did you mean socket_ratio?"),
        ("joints", "r2_star,r2_star\n50,1.2", (), "each column must have a different name"),
        ("joints", "case,r2_star\na,50\na,60", (), "row 2: case must have a different name"),
        ("joints", "r2_star,rim\n50", (), "row 1 must have 2 cells"),
        ("joints", "r2_star\n", (), "cases must have at least one row"),
        ("joints", b"\xff\xfe\x00", (), "it is not CSV text in UTF-8"),
        ("joints", "r2_star\n50", ("--twice",), "twice applies to scenes only, got joints"),
        ("scenes", "friction", (*FRICTION, "friction=0:1"), "but not both"),
        ("scenes", "friction\n0.1", ("--seed", 1), "--range and --seed do not apply"),
        ("scenes", "", (), "a FILE of cases or --random must be given"),
        ("scenes", "", (*FRICTION[:2],), "ranges of the random cases must be a mapping"),
        ("scenes", "", (*FRICTION, "friction"), "--range must be NAME=RANGE"),
        ("scenes", "", (*FRICTION, "friction=0.2:0.1"), "high end of the range of friction"),
        ("scenes", "", (*FRICTION, "friction=0:1:lin"), "range of friction must be low:high"),
    ],
)
def test_bad_input_is_one_line_before_any_work(command, tmp_path, kind, text, words, message):
    status, out, err = command(kind, text, *words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err
    assert sorted(os.listdir(tmp_path)) == ["cases.csv"]


def test_bad_cases_in_python(tmp_path):
    message = "each of cases must be a mapping of columns to values, got 'r2_star'"
    with pytest.raises(ValueError, match=message):
        run_study(pd.DataFrame({"r2_star": [50]}), "joints", tmp_path / "table.csv")
    with pytest.raises(ValueError, match="kind must be one of joints, scenes, got 'laws'"):
        run_study([{"r2_star": 50}], "laws", tmp_path / "table.csv")
    with pytest.raises(ValueError, match="cases must be a CSV file, got none.csv: No such file"):
        run_study("none.csv", "joints", tmp_path / "table.csv")


def test_a_worker_that_ends_is_an_error_and_what_was_finished_is_kept(tmp_path):
    """As where the system ends a process that takes too much memory."""
    given = random_cases(40, SCENES | {"duration": "0.05"}, seed=2)
    output = tmp_path / "table.csv"

    def end_a_worker(done, *_):
        if done == 1:
            for process in psutil.Process().children():
                if "popen_loky" in " ".join(process.cmdline()):
                    process.kill()

    with pytest.raises(StudyError, match=r"^a worker .* use fewer --jobs"):
        run_study(given, "scenes", output, jobs=2, progress=end_a_worker)
    assert not output.exists()
    known = []
    run_study(given, "scenes", output, jobs=1, progress=lambda done, *_: known.append(done))
    assert known[0] > 0
    assert pd.read_csv(output).largest_force.notna().all()


def test_a_file_with_a_failing_case_by_the_command_line(command, tmp_path, monkeypatch):
    monkeypatch.setattr("study.cli.sweep.PLAIN_EVERY", 0.0)
    text = "\ufeffcase, r2_star ,depth_star,note\nfirst,50,0.1,x\n\nsecond,50,9,\n"
    status, out, err = command("joints", text)
    assert status == 1
    first, *columns = out.splitlines()
    assert re.match(rf"2 cases .* {re.escape(str(tmp_path))}/table.csv has 2 rows\.", first)
    assert len(columns) == len(COLUMNS["joints"]) + 1
    assert re.fullmatch(r"  displacement_tilt: .*, deg", columns[1])
    assert columns[-1].endswith(": note.")
    *told, last = err.splitlines()
    assert told[-1] == "2 of 2 cases, 1 failed"
    assert last.startswith("failed: 1 of 2 cases failed")
    with (tmp_path / "table.csv").open(newline="") as file:
        assert [row["case"] for row in csv.DictReader(file)] == ["first", "second"]


def test_an_interrupted_study_says_what_is_kept(command, tmp_path, monkeypatch):
    text, real = "r2_star,depth_star\n50,0.1\n60,0.1\n70,0.1\n", cases.solve

    def solve(form, values, twice):
        if values["r2_star"] == 70:
            raise KeyboardInterrupt
        return real(form, values, twice)

    with monkeypatch.context() as patched:
        patched.setattr(cases, "solve", solve)
        status, out, err = command("joints", text)
    assert (status, out) == (130, "")
    assert (
        err
        == "study: interrupted; 2 of 3 cases are kept, and the same command continues from there\n"
    )
    assert len((tmp_path / "table.csv.part").read_bytes().splitlines()) == 2
    assert command("joints", text)[0] == 0
