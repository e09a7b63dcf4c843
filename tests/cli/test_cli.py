"""The command line as a user types it: results, one-line errors, exit statuses."""

import json
import os
import pty
import re
import shlex
import signal
import subprocess
import sys
from dataclasses import fields
from functools import wraps
from inspect import Parameter, signature
from io import StringIO
from pkgutil import resolve_name
from typing import get_args, get_type_hints

import numpy as np
import pandas as pd
import pytest
import typer
from benchmarks import timing

from study import contact, dataset, export, paths
from study.checks import StudyError
from study.choose import choose_model, links
from study.cli import joint as joint_command
from study.cli import laws, mechanism, options, output, stored, sweep
from study.contact import materials
from study.contact.damping import DAMPINGS
from study.dataset import store
from study.joint import (
    DimensionalJoint,
    Joint,
    Layer,
    Material,
    curve,
    first_yield,
    force_curve,
    supports,
)
from study.joint.definition import KINEMATICS
from study.measure import speed
from study.mechanism import MechanismError, Scene, particles, simulate
from study.mechanism.simulate import ELEMENTS, TOLERANCE, JointKind, Model
from study.pages import catalogue
from study.sweep.cases import Kind


@pytest.fixture
def on_a_terminal(run, monkeypatch):
    """What a command prints on a terminal of 80 columns, as lines."""

    def printed(*words):
        with monkeypatch.context() as patch:
            patch.setenv("COLUMNS", "80")
            patch.setattr(sys.stdout, "isatty", lambda: True)
            status, out, err = run(*words)
        assert (status, err) == (0, "")
        return out.splitlines()

    return printed


@pytest.mark.parametrize("law", contact.LAWS)
def test_law_prints_one_json_object(run, law):
    status, out, err = run(
        "law", law, "--r2-star", 200, "--depth-star", 0.5, "--depth-star", 0.1, "--json"
    )
    assert (status, err) == (0, "")
    force = json.loads(out)["force_star"]
    assert force == pytest.approx(list(contact.LAWS[law](np.array([0.5, 0.1]), 200)))


def test_law_passes_its_options_on(run):
    words = ["--socket-ratio", 1.5, "--poisson", 0.4, "--modulus-ratio", 0.5]
    words += ["--socket-poisson", 0.3, "--drive", "clamped", "--rim", "free"]
    _, out, _ = run(
        "law", "stiffened_hertz", "--r2-star", 50, "--depth-star", 0.3, *words, "--json"
    )
    materials = {"poisson": 0.4, "modulus_ratio": 0.5, "socket_poisson": 0.3}
    supports = {"ball_drive": "clamped", "rim": "free"}
    expected = contact.stiffened_hertz(0.3, 50, socket_ratio=1.5, **materials, **supports)
    assert json.loads(out)["force_star"] == pytest.approx([expected])


@pytest.mark.parametrize("kinematics", KINEMATICS)
def test_joint_knows_all_kinematics(run, kinematics):
    words = ["--r2-star", 20, "--depth-star", 0.5, "--kinematics", kinematics]
    _, out, _ = run("joint", *words, "--json")
    expected = force_curve(Joint(20, kinematics=kinematics), 0.5).force_star
    assert json.loads(out)["force_star"] == pytest.approx(list(expected))


def test_joint_prints_one_json_object_in_the_order_asked(run):
    words = ["--r2-star", 75, "--socket-ratio", 1.4, "--poisson", 0.3]
    status, out, err = run(
        "joint", *words, "--depth-star", 0.5, "--depth-star", 0.1, "--drive", "plane", "--json"
    )
    assert (status, err) == (0, "")
    found = json.loads(out)
    curve = force_curve(Joint(75, socket_ratio=1.4), [0.5, 0.1])
    assert found["force_star"] == pytest.approx(list(curve.force_star))
    assert found["contact_half_angle_deg"] == pytest.approx(list(curve.contact_half_angle_deg))
    assert found["error_estimate"] == pytest.approx(list(curve.error_estimate))


def test_joint_tells_the_largest_stress_in_every_body(run):
    words = ("joint", "--r2-star", 200, "--depth-star", 0.1, "--json")
    layers = ("--layer", "1.1,0.01,0.4", "--layer", "1.3,1,0.3")
    for more, bodies in (((), ["ball", "socket"]), (layers, ["ball", "layer_1", "layer_2"])):
        found = json.loads(run(*words, *more)[1])
        assert [key for key in found if key.endswith("_place")] == [
            f"von_mises_{body}_place" for body in bodies
        ]
        for body in bodies:
            star, share = (found[f"von_mises_{body}_{key}"][0] for key in ("star", "over_peak"))
            assert star == pytest.approx(share * found["peak_pressure_star"][0])


SIZES = ["joint", "--socket-radius", "12.5e-3", "--clearance", "40e-6", "--wall", "6e-3"]
BRONZE = [*SIZES, "--ball", "steel", "--socket", "bronze"]
DIMENSIONS = DimensionalJoint(12.5e-3, 40e-6, 6e-3, "steel", "bronze")
TILTED = [*BRONZE, "--force", 1, "--drive", "clamped", "--tilt", 5]


def test_joint_with_dimensions_prints_si_units_in_the_order_asked(run):
    status, out, err = run(*BRONZE, "--force", 8000, "--force", 3000, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["force"] == pytest.approx([8000, 3000], rel=1e-12)
    assert found["depth"] == pytest.approx([7.54e-6, 4.19e-6], rel=0.01)
    assert found["stiffness"] == pytest.approx([1.763e9, 1.199e9], rel=0.01)
    assert found["peak_pressure"][0] == pytest.approx(117e6, rel=0.01)
    assert found["yield_factor_socket"][0] * found["von_mises_socket"][0] == pytest.approx(1.6e8)
    assert found["r2_star"] == pytest.approx(312.5)
    assert found["materials"]["socket"]["youngs_modulus"] == 1.1e11
    status, out, _ = run(*BRONZE, *("--depth", found["depth"][0]), "--json")
    assert json.loads(out)["force"] == pytest.approx([8000], rel=1e-9)


def test_joint_with_dimensions_tells_the_law_that_will_do(run):
    status, out, err = run(*BRONZE, "--force", 8000)
    assert (status, err) == (0, "")
    heads = ["depth", "force", "stiffness", "half_angle", "peak_pressure", "error"]
    assert out.splitlines()[0].split() == heads
    assert out.splitlines()[1].split() == ["um", "N", "N/um", "deg", "MPa", "%"]
    assert "The cheapest law that is within 1 % from 0.2 to 7.536 um: stiffened_hertz." in out
    (line,) = (line for line in out.splitlines() if line.startswith("study export"))
    _, out, _ = run(*BRONZE, "--force", 8000, "--json")
    assert json.loads(out)["export"] == line
    status, out, err = run(*line.split()[1:])
    assert (status, err) == (0, "")
    assert "r2_star 312.5" in out
    assert "socket_radius 0.0125 m" in out
    assert "modulus_ratio 0.523809524" in " ".join(out.replace(" * ", " ").split())


def test_joint_with_dimensions_takes_liners_supports_and_a_tolerance(run, monkeypatch):
    lined = [*SIZES, "--liner", "0.5e-3,PTFE", "--liner", "1e-3,7e10,0.33", "--force", 500]
    status, out, err = run(*lined, "--drive", "clamped", "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert [*found["materials"]] == ["ball", "liner 1", "liner 2", "socket"]
    assert found["yield_factor_liner_2"] is None
    assert found["law"] == "tabulated"
    assert "--drive clamped" in found["export"]
    assert found["export"].count("--liner ") == 2

    def none(joint, depth_star, tolerance):
        raise StudyError(f"no law is within {tolerance:g}")

    monkeypatch.setattr("study.choose.cheapest_law.choose_beside", none)
    status, out, _ = run(*BRONZE, "--force", 500, "--tolerance", 1e-5)
    assert status == 0
    assert "No law is chosen: no law is within 1e-05" in out


def test_joint_with_dimensions_compares_laws_no_shallower_than_elements_resolve(run):
    metres = ("--socket-radius", 16e-3, "--clearance", 1e-4, "--wall", 8e-3, "--force")
    for words in ((500, "--drive", "clamped", "--rim", "free"), (0.5,)):
        status, out, err = run("joint", *metres, *words, "--json")
        assert (status, err) == (0, "")
        found = json.loads(out)
        least, most = found["law_depths"]
        assert least < found["depth"][0] < most
        assert found["law_error_bound"] < 0.01


def test_joint_with_dimensions_tells_torque_and_wear(run):
    words = [*BRONZE, "--force", 8000, "--force", 3000, "--friction", 0.1, "--wear", 1e-15]
    status, out, err = run(*words, "--path", 100, "--json")
    assert (status, err) == (0, "")
    found, solution = json.loads(out), DIMENSIONS.solve(force=[8000, 3000])
    for motion, torque in solution.friction_torque(0.1).items():
        assert found[f"{motion}_torque"] == pytest.approx(torque.tolist(), rel=1e-9)
    assert found["wear_depth"] == pytest.approx([1e-13 * p for p in found["peak_pressure"]])
    lines = run(*words, "--path", 100)[1].splitlines()
    heads = lines.index("depth  spin_torque  tilt_torque  wear_depth")
    assert lines[heads + 1].split() == ["um", "N", "m", "N", "m", "um"]
    row = [float(cell) for cell in lines[heads + 3].split()]
    assert row[1:3] == pytest.approx([found[f"{m}_torque"][0] for m in ("spin", "tilt")], rel=1e-3)
    assert row[3] == pytest.approx(1e6 * found["wear_depth"][0], rel=1e-3)
    assert "torque" not in run(*BRONZE, "--force", 3000)[1]


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_joint_with_dimensions_is_drawn(run, tmp_path, suffix):
    words = [*BRONZE, "--force", 8000, "--force", 3000, "--plot", tmp_path / f"joint{suffix}"]
    drawn = []
    for _ in range(2):
        assert run(*words)[0] == 0
        drawn.append((tmp_path / f"joint{suffix}").read_bytes())
    assert drawn[0] == drawn[1]
    assert len(drawn[0]) > 10_000


def test_a_drawing_without_matplotlib_says_what_to_install_before_the_work(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.delitem(sys.modules, "study.cli.plot", raising=False)
    monkeypatch.setattr(DimensionalJoint, "solve", None)
    status, out, err = run(*BRONZE, "--force", 8000, "--plot", "joint.png")
    assert (status, out) == (1, "")
    assert err.startswith("study: study joint needs matplotlib, of the extra [study]: pip install")


def test_the_drawing_has_the_numbers_of_the_solution(monkeypatch, tmp_path):
    from study.cli import plot

    figures, solution = [], DIMENSIONS.solve(force=[8000, 3000])
    monkeypatch.setattr(
        plot.Figure, "savefig", lambda f, path, **_: figures.append(f) or path.touch()
    )
    plot.draw_joint(solution, tmp_path / "joint.png")
    force, pressure = figures[0].axes
    (curve, *points), profiles = force.lines, pressure.lines
    depth, along = curve.get_data()
    assert along == pytest.approx(solution.law.force(1e-6 * depth))
    for k, (point, profile) in enumerate(zip(points, profiles, strict=True)):
        assert np.ravel(point.get_data()) == pytest.approx([1e6 * solution.depth[k], (8e3, 3e3)[k]])
        assert profile.get_ydata() == pytest.approx(1e-6 * solution.pressure[k])
        assert (profile.get_xdata() == solution.angle_deg).all()
    for axes, units in ((force, ("(µm)", "(N)")), (pressure, ("(deg)", "(MPa)"))):
        assert (axes.get_xlabel()[-len(units[0]) :], axes.get_ylabel()[-len(units[1]) :]) == units


def test_joint_with_dimensions_in_mm_is_asked_whether_they_are_in_m(run):
    millimetres = ("--socket-radius", 16, "--clearance", 0.1, "--wall", 8, "--force", 500)
    status, out, err = run("joint", *millimetres)
    assert (status, err) == (0, "")
    small = "No law is chosen: the contact is too small for laws to be compared: there Hertz's law"
    assert re.search(rf"^{small} holds within 0\.\d+ %$", out, re.M)
    assert out.endswith("The socket's radius is 16 m: are the sizes in m?\n")
    clamped = ("--socket-radius", 16e-3, "--clearance", 1e-4, "--wall", 8e-3, "--drive", "clamped")
    assert re.search(
        rf"^{small} holds within 2\.\d %$", run("joint", *clamped, "--force", 1)[1], re.M
    )
    assert "are the sizes in m?" not in run(*BRONZE, "--force", 8000)[1]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([*BRONZE, "--force", 1, "--r2-star", 75], "--r2-star must be left out: --socket-radius"),
        (["joint", "--r2-star", 75, "--depth-star", 0.1, "--ball", "steel"], "--r2-star must be"),
        ([*BRONZE, "--force", 1, "--poisson", 0.3], "--poisson must be left out: --socket-radius"),
        (BRONZE, "study: depth or force must be given"),
        ([*BRONZE, "--force", 1, "--depth", 1e-6], "either depth or force must be given, not both"),
        (["joint", "--socket-radius", 0.01, "--force", 1], "--clearance and --wall must be given"),
        (["joint", "--force", 1], "--socket-radius and --clearance and --wall must be given"),
        (["joint"], "--r2-star and --depth-star must be given or, with dimensions, --socket-radi"),
        (["joint", "--r2-star", 75], "--depth-star must be given"),
        ([*SIZES, "--force", 1, "--ball", "210,0.3"], "got 210 Pa: did you mean 210e9?"),
        (
            [*SIZES, "--force", 1, "--ball", "stel"],
            "material must be one of steel, bearing steel, stainless,",
        ),
        (
            [*SIZES, "--force", 1, "--liner", "PTFE"],
            "liner must be a thickness in m and a mat",
        ),
        ([*SIZES, "--force", -1], "force must be > 0 N, got -1 N"),
        ([*SIZES, "--force", 1, "--friction", -1], "friction must be >= 0, got -1"),
        ([*SIZES, "--force", 1, "--wear", 1e-15], "--path must be given"),
        ([*SIZES, "--force", 1, "--path", 10], "--wear must be given"),
        ([*SIZES, "--force", 1, "--wear", -1, "--path", 1], "wear must be >= 0 m^2/N, got -1 m"),
        ([*SIZES, "--force", 1, "--plot", "joint.jpg"], "--plot must end in .png or .svg or .pdf"),
        ([*SIZES, "--force", 1, "--plot", "no/joint.png"], "--plot must be in a folder that can"),
        ([*TILTED, "--friction", 0.1], "--friction must be left out beside --tilt"),
        ([*TILTED, "--plot", "joint.png"], "--plot must be left out beside --tilt"),
        (["joint", "--r2-star", 75, "--friction", 0.1], "--friction is for a joint with its dim"),
        (["joint", "--r2-star", 75, "--plot", "x.png"], "--plot is for a joint with its dimensio"),
        ([*SIZES, "--force", 1e9], "force must be <= "),
        (
            [*SIZES, "--force", 1, "--tolerance", 0],
            "tolerance must be >= 1e-05 and <= 1, got 0",
        ),
    ],
)
def test_joint_refuses_what_does_not_fit(run, words, message):
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    assert err.startswith("study: ")
    assert message in err


def test_materials_are_csv_where_piped_and_fit_a_terminal(run, on_a_terminal):
    status, out, err = run("data", "materials")
    assert (status, err) == (0, "")
    table = pd.read_csv(StringIO(out))
    pd.testing.assert_frame_equal(table, pd.read_csv(materials.MATERIALS))
    lines = on_a_terminal("data", "materials")
    assert max(map(len, lines)) <= 80
    printed = f"{' '.join(lines).replace('  ', ', ')},"  # a blank line ends a row
    for text in (*table.name, *table.condition, *table.source, "1.1e+11 Pa"):
        assert f": {text}," in printed


def test_joint_takes_layers(run):
    words = ["--r2-star", 80, "--depth-star", 0.3, "--poisson", 0.28]
    layers = ["--layer", "1.125,0.0025,0.46", "--layer", "1.5,1,0.3"]
    status, out, err = run("joint", *words, *layers, "--json")
    assert (status, err) == (0, "")
    lined = Layer(1.125, Material(5e8, 0.46)), Layer(1.5, Material())
    joint = Joint(80, ball=Material(poisson=0.28), layers=lined)
    expected = force_curve(joint, 0.3).force_star
    assert json.loads(out)["force_star"] == pytest.approx(list(expected))
    for more in ("--socket-ratio", "--modulus-ratio", "--socket-poisson"):
        status, _, err = run("joint", *words, *layers, more, 0.4)
        assert status == 2
        name = more.removeprefix("--").replace("-", "_")
        assert err == f"study: {name} must be left out: layer describes the socket\n"


def test_joint_without_json_is_a_table(run):
    status, out, _ = run("joint", "--r2-star", 75, "--depth-star", 0.1, "--rim", "mirror")
    assert status == 0
    assert "force_star" in out
    assert "force_error" in out


def test_data_show_filters(run):
    status, out, _ = run("data", "show", "--r2-star", 200, "--kinematics", "small")
    assert status == 0
    assert "paper-small-200" in out
    assert "paper-small-220" not in out
    status, out, _ = run("data", "show", "--case", "paper-small-200")
    assert status == 0
    assert out.count("\n") > 40


@pytest.mark.parametrize(
    ("column", "asked", "shown"),
    [
        ("r2_star", 203, 200),
        ("socket_ratio", 1.3, 1.298),
        ("poisson_ball", 0.31, 0.3),
        ("poisson_socket", 0.31, 0.3),
        ("modulus_ratio", 1.01, 1.0),
    ],
)
def test_data_show_says_that_it_shows_the_nearest_number(run, column, asked, shown):
    option = f"--{column.replace('_', '-')}"
    there = ("data", "show", "--group", "paper", option, shown)
    status, out, err = run(*there)
    assert (status, err) == (0, "")
    assert set(dataset.load(group="paper", **{column: shown}).case) == set(
        pd.read_csv(StringIO(out)).case
    )
    told = f"study: no such case has {column} {asked}: shown is the nearest, {shown:g}\n"
    assert run(*there[:-1], asked) == (0, out, told)


def test_data_show_filters_by_every_column_of_a_case(run):
    columns = list(dataset.load().loc[:, :"solver"])
    assert sorted(get_type_hints(stored.CaseOptions)) == sorted(columns)
    layers = dataset.load(case="hip-4mm-linear-100").layers[0]
    out = run("data", "show", "--layers", layers, "--solver", "series")[1]
    assert list(pd.read_csv(StringIO(out)).case) == ["hip-4mm-linear-100"]


def test_a_process_on_a_real_terminal_prints_the_same_lines(on_a_terminal):
    ours, theirs = pty.openpty()
    command = [sys.executable, "-m", "study.cli", "data", "materials"]
    environment = os.environ | {"COLUMNS": "80", "PYTHONPATH": str(paths.ROOT)}
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=theirs, env=environment
    ) as child:
        os.close(theirs)
        printed = b""
        try:
            while read := os.read(ours, 65536):
                printed += read
        except OSError:  # the other end is closed
            pass
    os.close(ours)
    assert child.returncode == 0
    assert printed.decode().splitlines() == on_a_terminal("data", "materials")


def test_a_process_ends_with_the_status_of_its_command():
    wrong = [sys.executable, "-m", "study.cli", "law", "hertz", "--r2-star", "200"]
    done = subprocess.run(
        wrong, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": str(paths.ROOT)}
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "study: Missing option '--depth-star'.\n"


AT_DEPTHS = ["--depth-star", 0.1, "--depth-star", 0.5]


@pytest.mark.parametrize(
    "words",
    [
        ["joint", "--r2-star", 75, "--socket-ratio", 1.4, *AT_DEPTHS],
        ["simulate", "--duration", 0.05],
        ["choose", "--r2-star", 200, "--depth-star", 0.3, "--tolerance", 0.01],
        [
            "choose",
            "--r2-star",
            200,
            "--depth-star",
            0.4,
            "--tolerance",
            0.5,
            "--yield-stress",
            2e8,
        ],
        [*BRONZE, "--force", 1000],
        ["data", "check"],
    ],
)
def test_a_table_is_never_broken(run, on_a_terminal, words):
    """Every number and name stands whole: on 80 columns, and in one line where it is piped."""
    wide = run(*words)[1]
    narrow = on_a_terminal(*words)
    assert max(len(line) for line in narrow if not line.startswith("study export ")) <= 80
    words = re.compile(r"[^\s,:─]*[^\s,:.─]")
    assert set(words.findall(wide)) <= set(words.findall(" ".join(narrow)))
    heads = [n for n, line in enumerate(wide.splitlines()) if line.startswith("─")]
    assert heads


def test_data_show_is_csv_where_piped_and_fits_a_terminal(run, on_a_terminal):
    words = ("data", "show", "--r2-star", 200, "--kinematics", "linear")
    table = pd.read_csv(StringIO(run(*words)[1]))
    cases = dataset.summary(dataset.load(r2_star=200, kinematics="linear"))
    assert list(table) == list(cases)
    assert list(table.case) == list(cases.case)
    assert table.largest_force.to_numpy() == pytest.approx(cases.largest_force, rel=1e-8)
    lines = on_a_terminal(*words)
    assert lines[0] == f"{len(cases)} cases."
    assert max(map(len, lines)) <= 80
    rows = " ".join(line or "\n" for line in lines[1:]).split("\n")[1:]
    assert [row.split()[:2] for row in rows] == [["case:", f"{case},"] for case in cases.case]
    assert all("largest_force: " in row and "P/(E* dR^2)" in row for row in rows)
    one = pd.read_csv(StringIO(run("data", "show", "--case", "paper-small-200")[1]))
    assert list(one) == list(dataset.load().loc[:, "depth_star":])


def test_list_is_csv_where_piped_and_by_notebook_on_a_terminal(run, on_a_terminal):
    status, out, err = run("list")
    assert (status, err) == (0, "")
    table = pd.read_csv(StringIO(out))
    assert list(table) == ["name", "notebook", "shows"]
    every = {n: made.shows for nb in catalogue.CATALOGUE for n, made in nb.results.items()}
    assert dict(zip(table.name, table.shows, strict=True)) == every
    lines = on_a_terminal("list")
    assert max(map(len, lines)) <= 80
    heads = [line for line in lines if not line.startswith(" ")]
    assert [head.split(":")[0] for head in heads] == [nb.name for nb in catalogue.CATALOGUE]


def test_list_of_a_name_tells_the_parameters_of_its_notebook(run):
    for name in ("fig10", "03-force-against-depth"):
        status, out, err = run("list", name)
        assert (status, err) == (0, "")
        assert out.startswith("03-force-against-depth:\n")
        assert re.search(r"^  fig10: force against depth", out, re.M)
        assert ("  trend: " in out) == (name != "fig10")
        assert "-p NAME=VALUE" in out
        assert re.search(r"^  r2_star: 200.0 \[20 to 10000\]: socket radius", out, re.M)
        assert re.search(r"^  kinematics: linear \[linear, small\]: ", out, re.M)


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("Fig.14", "fig14"),
        ("Figure 14", "fig14"),
        ("fig 14", "fig14"),
        ("fig9", "fig09"),
        ("table 2", "table2"),
        ("Table-2", "table2"),
        ("14", "fig14 or 14-where-the-laws-apply"),
        ("fgi10", "fig10"),
        ("where-the-laws-apply", "14-where-the-laws-apply"),
    ],
)
def test_an_unknown_name_is_answered_by_the_nearest_one(run, name, near):
    for command in ("run", "list"):
        status, out, err = run(command, name)
        assert (status, out) == (2, "")
        wanted = f"NAME must be one that `study list` shows, got {name!r}: did you mean {near}?"
        assert err == f"study: {wanted}\n"


def test_a_name_unlike_any_other_is_refused_in_a_short_line(run):
    status, _, err = run("run", "something-else-altogether")
    assert status == 2
    told = "NAME must be one that `study list` shows, got 'something-else-altogether'"
    assert err == f"study: {told}\n"


def test_choices_are_those_of_the_library(run):
    simulation = get_type_hints(mechanism.SimulationOptions)
    for choices, names in (
        (get_type_hints(stored.CaseOptions)["ball_drive"], supports.HALF_BALLS),
        (options.Rim, supports.RIMS),
        (options.Kinematics, KINEMATICS),
        (get_type_hints(joint_command.EitherOptions)["solver"], curve.SOLVERS),
        (signature(laws.export_law).parameters["form"].annotation, export.SUFFIXES),
        (simulation["model"], [*get_args(Model), "auto"]),
        (simulation["joint"], get_args(JointKind)),
        (simulation["law"], {*contact.LAWS, "tabulated"}),
        (simulation["method"], get_args(particles.Method)),
        (simulation["quantity"], get_args(links.Quantity)),
        (signature(sweep.sweep_cases).parameters["kind"].annotation, get_args(Kind)),
    ):
        assert set(get_args(choices)) == set(names)
    assert set(speed.CHARTS) <= set(re.findall(r"\w+", run("measure", "--help")[1]))


def test_defaults_are_those_of_the_library():
    relative = signature(contact.stiffened_hertz).parameters
    for source, group in (
        (relative, options.MaterialOptions),
        (signature(Joint).parameters, options.JointOptions),
        (signature(DimensionalJoint).parameters, joint_command.DimensionOptions),
        (signature(simulate).parameters, mechanism.SimulationOptions),
        (signature(choose_model).parameters, mechanism.SimulationOptions),
    ):
        for name in get_type_hints(group):
            stated = re.search(r"\[default: (.*)\]$", getattr(group, name).help)
            default = source[name].default if name in source else None
            if default not in (None, (), Parameter.empty):
                assert stated, name
                assert stated[1] == str(default)
    stated = mechanism.SimulationOptions
    assert stated.tolerance.help.endswith(f"[default: {TOLERANCE:.0e}]".replace("e-0", "e-"))
    assert stated.elements.help.endswith(f"[default: {ELEMENTS[0]},{ELEMENTS[1]}]")


def test_help_names_units(run):
    for command in ("law", "joint"):
        status, out, _ = run(command, "--help")
        assert status == 0
        assert "P/(E* dR^2)" in out or "d/dR" in out


UNIT = (
    r"\bin (m|N|deg|Pa|s|kg m\^2)\b|\bclearances?\b|\bratio\b|\bover\b|relative|no unit|local error"
)


def test_every_option_is_explained_and_every_number_has_its_unit(run):
    def commands(group, *words):
        for name, command in group.commands.items():
            if hasattr(command, "commands"):
                yield from commands(command, *words, name)
            else:
                yield (*words, name)

    for words in commands(typer.main.get_command(options.app)):
        status, out, _ = run(*words, "--help")
        assert status == 0
        listed = re.split(r"\n  (?=-)", out.partition("Options:\n")[2])[1:]
        for entry in (" ".join(text.split()) for text in listed):
            name, kind, text = re.fullmatch(r"(-\S+)( [A-Z]+| <\S+>)? (.+)", entry).groups()
            assert len(text) > 10, (words, name)
            assert kind != " NUMBER" or re.search(UNIT, text), (words, entry)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["law", "hertz", "--r2-star", "0.5", "--depth-star", "1"], "r2_star must be > 1, got 0.5"),
        (["law", "hertz", "--r2-star", "nan", "--depth-star", "1"], "r2_star must be finite"),
        (["law", "hooke", "--r2-star", "200", "--depth-star", "1"], "'hooke' is not one of"),
        (["law", "hertz", "--r2-star", "200"], "Missing option '--depth-star'"),
        (["law", "hertz", "--r2-star", "x", "--depth-star", "1"], "it must be a number, got 'x'"),
        (["law", "hertz", "--r2-star", "2_00", "--depth-star", "1"], "a number, got '2_00'"),
        (["law", "hertz", "--r2-star", "9", "--depth-star", "0x1"], "a number, got '0x1'"),
        (["law", "hertz", "--r2-star", "\uff19", "--depth-star", "1"], "a number, got '\uff19'"),
        (["simulate", "--outputs", "1_00"], "it must be a whole number, got '1_00'"),
        (["simulate", "--outputs", "0x64"], "it must be a whole number, got '0x64'"),
        (["run", "fig17", "-p", "outputs=1_00"], "outputs must be of type int, got '1_00'"),
        (["run", "fig17", "-p", "outputs=0x64"], "outputs must be of type int, got '0x64'"),
        ([*SIZES, "--ball", "2_10e9,0.3"], "material must be one of"),
        ([*SIZES, "--liner", "0_5e-3,PTFE"], "liner must be a thickness"),
        (
            ["law", "liu", "--r2-star", "9", "--depth-star", "1", "--poisson", "0.3"],
            "--poisson must be left out: liu does not depend on it",
        ),
        (
            ["law", "stiffened_hertz", "--r2-star", "9", "--depth-star", "0.1"],
            "r2_star of stiffened_hertz must be >= 20, got 9",
        ),
        (
            [
                "law",
                "stiffened_hertz",
                "--r2-star",
                "99",
                "--depth-star",
                "0.1",
                "--poisson",
                "0.1",
            ],
            "poisson of stiffened_hertz must be >= 0.2 and <= 0.46, got 0.1",
        ),
        (
            [
                "law",
                "stiffened_hertz",
                "--r2-star",
                "99",
                "--depth-star",
                "0.1",
                "--drive",
                "point",
            ],
            "'point' is not one of 'plane', 'clamped'",
        ),
        (
            ["law", "hertz", "--r2-star", "99", "--depth-star", "0.1", "--drive", "clamped"],
            "--drive must be left out: hertz does not depend on it",
        ),
        (["export", "--law", "hooke", "--format", "c"], "'hooke' is not one of"),
        (
            ["export", "--law", "hertz", "--format", "matlab", "--depth-star", "-1"],
            "depth_star must be > 0, got -1",
        ),
        (
            ["export", "--law", "stiffened_hertz", "--format", "c", "--kinematics", "small"],
            "kinematics of stiffened_hertz must be one of linear, got 'small'",
        ),
        (["export", "--law", "tabulated"], "Missing option '--format'"),
        (
            ["export", "--law", "stiffened_hertz", "--format", "csv", "--socket-ratio", "1.05"],
            "socket_ratio of stiffened_hertz must be >= 1.1 and <= 1e+06, got 1.05",
        ),
        (
            ["export", "--law", "tabulated", "--format", "csv", "--output", "law.txt"],
            "--output must end in .csv, got law.txt",
        ),
        (
            [
                "joint",
                "--r2-star",
                "9",
                "--depth-star",
                "0.1",
                "--drive",
                "clamped",
                "--solver",
                "series",
            ],
            "solver must be quadratic or linear for this joint",
        ),
        (["joint", "--r2-star", "9", "--depth-star", "-1"], "depth_star must be >= 0, got -1"),
        (["joint", "--r2-star", "9", "--depth-star", "1", "--poisson", "0.5"], "< 0.5, got 0.5"),
        (
            ["joint", "--r2-star", "9", "--depth-star", "1", "--drive", "x"],
            "ball_drive must be one of plane,",
        ),
        (["joint", "--r2star", "9", "--depth-star", "1"], "No such option: --r2star"),
        (["data", "show", "--r2-star", "7"], "r2_star must be >= 20 and <= 10000, got 7"),
        (
            ["data", "show", "--case", "papr-small-200"],
            "lists, got 'papr-small-200': did you mean paper-small-200 or paper-small-2000 or ",
        ),
        (["data", "show", "--group", "papr"], "got 'papr': did you mean paper?"),
        (["data", "show", "--group", "paper", "--layers", ";"], "layers must be one of"),
        (["run", "fig99"], "NAME must be one that `study list` shows, got 'fig99'"),
        (["run", "-p", "r2_star=100"], "-p must be given with a NAME, as in: study run fig10 -p r"),
        (["run", "fig10", "-p", "r2_star"], "-p must be key=value"),
        (["run", "fig10", "-p", "radius=1"], "parameter must be one of"),
        (["run", "fig10", "-p", "r2_star=big"], "parameter r2_star must be of type float"),
        (["run", "--jobs", "0"], "jobs must be >= 1, got 0"),
        (["walk"], "No such command 'walk'"),
    ],
)
def test_wrong_use_is_one_line_and_status_2(run, words, message):
    status, out, err = run(*words)
    assert status == 2
    assert out == ""
    assert err.count("\n") == 1
    assert message in err


def test_a_failure_is_one_line_and_status_1(run, monkeypatch, tmp_path):
    monkeypatch.setattr(store, "PACKAGE", paths.ROOT / "missing.json")
    status, _, err = run("data", "show")
    assert status == 1
    assert err.startswith("study: missing.json is missing; restore it with: git checkout")
    assert err.count("\n") == 1


def test_no_dask_scheduler_is_one_line_and_status_1(run):
    pytest.importorskip("distributed")
    status, _, err = run("run", "fig09", "--dask", "tcp://127.0.0.1:9")
    assert status == 1
    assert err.startswith("study: no Dask scheduler answers at tcp://127.0.0.1:9")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("why", "told"), [("", ""), ("Unable to allocate 1 GiB", ": Unable to allocate 1 GiB")]
)
def test_too_little_memory_is_one_line_and_status_1(run, monkeypatch, why, told):
    def load():
        raise MemoryError(why)

    monkeypatch.setattr(dataset, "load", load)
    assert run("data", "show") == (1, "", f"study: too little memory{told}\n")


def test_a_solution_under_too_low_a_limit_of_memory_is_refused():
    """Else OpenBLAS asks for memory for ever."""
    joint = "joint --r2-star 200 --depth-star 0.1 --drive clamped"
    command = f"ulimit -v 550000 && exec {shlex.quote(sys.executable)} -m study.cli {joint}"
    done = subprocess.run(["sh", "-c", command], cwd=paths.ROOT, capture_output=True, text=True)
    told = "study: too little memory for a solution: ulimit -v is 550000, and must be at least "
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(told)
    assert done.stderr.count("\n") == 1


def test_interruption_is_one_line_and_status_130(run, monkeypatch, tmp_path):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    for called, kept, words in (
        ("dataset:load", "", ["data", "show"]),
        ("export:export", "", ["export", "--law", "hertz", "--format", "c"]),
        ("choose:choose", "", [*CHOOSE, "--tolerance", 0.1]),
        ("mechanism:simulate", "", ["simulate", "--output", tmp_path / "motion.csv"]),
        ("joint:DimensionalJoint.solve", "", [*BRONZE, "--force", 1]),
        ("dataset.production:to_make", "; what was finished is kept", ["data", "build"]),
        ("measure.speed:measure", "; what was finished is kept", ["measure"]),
        ("measure.speed:measure", "", ["measure", "--output", tmp_path / "times.csv"]),
    ):
        with monkeypatch.context() as patch:
            name = f"study.{called}"
            patch.setattr(name.replace(":", "."), wraps(resolve_name(name))(interrupt))
            status, _, err = run(*words)
        assert (status, err) == (130, f"study: interrupted{kept}\n"), words


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (["simulate", "--scene", "clearence=1e-5"], "clearance"),
        ([*BRONZE, "--force", 1, "--ball", "stel"], "steel"),
        (["law", "hertzz", "--r2-star", 200, "--depth-star", 0.1], "hertz"),
        (["export", "--law", "tabulatd", "--format", "c"], "tabulated"),
        (["run", "fig10", "-p", "r2star=100"], "r2_star"),
        (["run", "fig10", "-p", "kinematics=smal"], "small"),
        (["law", "hooke", "--r2-star", 200, "--depth-star", 0.1], None),
        (["simulate", "--scene", "volume=1"], None),
    ],
)
def test_a_wrong_name_is_answered_by_the_nearest_one(run, words, near):
    status, out, err = run(*words)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert err.endswith(f": did you mean {near}?\n") == bool(near)
    assert ("did you mean" in err) == bool(near)


def test_simulate_states_its_law_and_takes_materials_by_name(run):
    words = ("simulate", "--duration", "0.002", "--law", "stiffened_hertz", "--socket-ratio", "1.5")
    words += ("--scene", "ball=steel", "--scene", "socket=bronze")
    told = "stiffened_hertz: socket_ratio 1.5, modulus_ratio 0.5"
    assert json.loads(run(*words, "--json")[1])["law"].startswith(told)
    assert run(*words)[1].startswith(f"Law {told}")
    assert run(*words)[1].count("poisson 0.34, ball_drive plane") == 1
    status, _, err = run("simulate", "--law", "hertz", "--socket-ratio", 1.5)
    assert status == 2
    assert "socket_ratio must be left out: hertz has no option" in err


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (KeyboardInterrupt(), "The second run, which says how far to trust this one, was interrup"),
        (MechanismError("no step is small enough"), "A second run, at another tolerance, failed"),
    ],
)
def test_a_second_run_that_ends_early_loses_nothing(run, tmp_path, monkeypatch, error, told):
    def second_run(*_):
        raise error

    monkeypatch.setattr(sys.modules["study.mechanism.simulate"], "_second_run", second_run)
    output = tmp_path / "motion.csv"
    status, out, _ = run("simulate", "--duration", "0.01", "--output", output)
    assert status == 0
    assert f"{simulate(duration=0.01).impacts.peak_depth[0]:.6g}" in out
    assert out.splitlines()[-1].startswith(told)
    assert output.is_file()


def test_simulate_says_how_far_it_can_be_trusted(run):
    told = run("simulate", "--duration", "0.01")[1].splitlines()[-1]
    assert told.startswith("A second run, at another tolerance, is the same motion to the end: ")
    agreement = json.loads(run("simulate", "--duration", "0.01", "--json")[1])["agreement"]
    assert (agreement["lasts"], agreement["impacts"]) == (True, [5, 5])
    words = ("crank_clearance=1.7e-4", "damping=flores", "restitution=0.05", "friction=0")
    words += ("clearance=1.86e-5", "initial_crank_angle=-1.54", "crank_speed=250")
    scene = [part for word in words for part in ("--scene", word)]
    told = run("simulate", *scene, "--duration", "0.1")[1].splitlines()[-1]
    assert re.search(r"is the same motion until 0\.0\d+ s: .*one of many motions", told)
    assert json.loads(run("simulate", "--joint", "ideal", "--json")[1])["agreement"] is None


def test_simulate_once_leaves_out_the_second_run(run, monkeypatch):
    monkeypatch.setattr(sys.modules["study.mechanism.simulate"], "_second_run", pytest.fail)
    words = ("simulate", "--duration", "0.01", "--once")
    assert "second run" not in run(*words)[1]
    assert json.loads(run(*words, "--json")[1])["agreement"] is None


def test_simulate_help_has_the_scenes_keys_and_units():
    units = {field.name: field.metadata["unit"].replace("1", "-") for field in fields(Scene)}
    keys = ", ".join(f"{key} ({unit})" if unit else key for key, unit in units.items())
    assert f"KEY (unit): {keys}." in mechanism.SCENE
    assert all(rule in mechanism.SCENE for rule in DAMPINGS)


def test_simulate_prints_the_end_and_every_impact(run):
    words = ["--model", "rigid", "--joint", "clearance", "--law", "hertz", "--duration", 0.1]
    status, out, err = run("simulate", *words, "--json")
    assert (status, err) == (0, "")
    found, response = json.loads(out), simulate(law="hertz")
    assert found["x_slider"] == response.slider_position[-1]
    assert found["theta"] == response.crank_angle[-1]
    assert {"v_slider", "a_slider", "energy_error"} < set(found)
    assert len(found["impacts"]) == len(response.impacts) > 3
    first = found["impacts"][0]
    assert first["time"] == response.impacts.time[0]
    assert {"approach_speed", "peak_force"} < set(first)
    assert found["impacts"][-1]["separation_speed"] is None


def test_simulate_says_which_restitution_is_delivered(run):
    words = ("simulate", "--duration", "0.002", "--once")
    paper = (*words, "--scene", "damping=lankarani-nikravesh")
    told = "Damping delivers the restitution 0.725, not 0.5."
    assert told in run(*paper)[1].splitlines()
    assert "Damping delivers" not in run(*words)[1]
    assert "Damping delivers" not in run(*paper, "--joint", "ideal")[1]
    for command, delivered in ((words, 0.5), (paper, 0.72524)):
        found = json.loads(run(*command, "--json")[1])
        assert found["restitution"] == 0.5
        assert found["delivered_restitution"] == pytest.approx(delivered, abs=1e-5)


def test_simulate_solves_the_joint_of_the_scene(run):
    words = ("simulate", "--duration", "0.002", "--once", "--json")

    def law(*more):
        return json.loads(run(*words, *more)[1])["law"]

    assert law("--law", "tabulated").startswith("tabulated: r2_star 200, socket_ratio 1.298")
    assert law("--wall", "5e-3").startswith("tabulated: r2_star 200, socket_ratio 1.5")
    bodies = ("--scene", "ball=steel", "--scene", "socket=bronze")
    lined = law("--liner", "0.5e-3,PTFE", "--wall", "3e-3", *bodies)
    assert "layers 1.05:0.00238095238:0.46;1.3:0.523809524:0.34; with its own composite" in lined
    status, _, err = run(*words, "--law", "hertz", "--liner", "0.5e-3,PTFE")
    assert (status, "liner must be left out: hertz has no option" in err) == (2, True)


def test_simulate_takes_scene_inertia_and_options(run, tmp_path):
    table = tmp_path / "motion.csv"
    words = ["--inertia", "1e-4,3e-4", "--scene", "restitution=0.9", "--duration", 0.004]
    words += ["--model", "particles", "--elements", "2,4", "--method", "lagged", "--output", table]
    status, out, _ = run("simulate", *words, "--json")
    assert status == 0
    scene = Scene(restitution=0.9, crank_inertia=1e-4, coupler_inertia=3e-4)
    options = {"model": "particles", "elements": (2, 4), "method": "lagged", "duration": 0.004}
    response = simulate(scene, **options)
    assert json.loads(out)["x_slider"] == response.slider_position[-1]
    assert pd.read_csv(table).slider_position.to_numpy() == pytest.approx(
        response.motion.slider_position.to_numpy(), rel=1e-11
    )
    status, out, _ = run("simulate", "--joint", "ideal", "--duration", 0.01)
    assert status == 0
    assert "x_slider" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--law", "hooke"], "'hooke' is not one of 'hertz', 'steuermann'"),
        (["--model", "soft"], "'soft' is not one of 'rigid', 'particles', 'beams'"),
        (["--duration", "-1"], "duration must be > 0 and <= 1e+09 s, got -1 s"),
        (["--duration", "nan"], "duration must be finite and > 0 and <= 1e+09 s, got nan s"),
        (["--inertia", "1e-4"], "--inertia must be two numbers separated by a comma, got '1e-4'"),
        (["--inertia", "a,b"], "--inertia must be a number, got 'a'"),
        (["--inertia", "0,-1"], "coupler inertia must be >= 0 kg m^2, got -1 kg m^2"),
        (["--elements", "2.5,4"], "--elements must be a whole number, got '2.5'"),
        (["--scene", "mass=1"], "--scene must be KEY=VALUE with KEY one of crank_length"),
        (["--scene", "friction"], "--scene must be KEY=VALUE"),
        (["--scene", "friction=high"], "friction must be a number, got 'high'"),
        (["--scene", "damping=none"], "damping must be one of"),
        (["--output", "motion.xls"], "--output must end in .csv, got motion.xls"),
        (["--output", "nowhere/motion.csv"], "--output must be in a folder that can be written"),
        (["--outputs", "1000000000000"], "outputs must be >= 1 and <= 1e+06, got 1e+12"),
        (["--model", "beams", "--elements", "9999,1"], "elements must be >= 1 and <= 500, got 9"),
        (["--model", "beams", "--step", "1e-300"], "step must be >= 1e-11 s, got 1e-300 s"),
        (["--model", "particles", "--method", "late"], "'late' is not one of 'centred', 'lagged'"),
        (["--scene", "driving_moment=1e300"], "driving moment must be >= -1e+06 and <= 1e+06 N m"),
        (["--model", "particles", "--step", "1"], "step must be <= 1.101e-06 s, the limit of sta"),
    ],
)
def test_simulate_refuses_bad_input_in_one_line(run, words, message):
    status, out, err = run("simulate", *words)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert message in err


@pytest.mark.parametrize(
    ("words", "work"),
    [
        (["simulate"], "study.mechanism:simulate"),
        (["measure", "--chart", "laws"], "study.measure.speed:measure"),
        (["export", "--law", "tabulated", "--format", "csv"], "study.export:export"),
    ],
)
def test_output_that_cannot_be_written_is_refused_before_the_work(
    run, monkeypatch, tmp_path, words, work
):
    called = []

    @wraps(resolve_name(work))
    def never(*_, **__):
        called.append(work)

    monkeypatch.setattr(work.replace(":", "."), never)
    (tmp_path / "folder.csv").mkdir()
    (tmp_path / "file").touch()
    (tmp_path / "closed").mkdir()
    access = os.access
    closed = lambda path, mode: "closed" not in str(path) and access(path, mode)  # noqa: E731
    monkeypatch.setattr("os.access", closed)
    in_a_folder = "--output must be in a folder that can be written to, got "
    for name, message in (
        ("nowhere/x.csv", in_a_folder),
        ("file/x.csv", in_a_folder),
        ("closed/x.csv", in_a_folder),
        ("folder.csv", "--output must be a file, got the folder "),
        ("x.txt", "--output must end in .csv, got "),
    ):
        status, out, err = run(*words, "--output", tmp_path / name)
        assert (status, out) == (2, "")
        assert err == f"study: {message}{tmp_path / name}\n"
    assert not called


def test_what_is_being_done_is_told_on_a_terminal_until_it_is(monkeypatch, capsys):
    for is_terminal, told in (
        (True, ["Solving the joint ...", "half of it", ""]),
        (False, []),
    ):
        monkeypatch.setattr(sys.stderr, "isatty", lambda shown=is_terminal: shown)
        with output.working("Solving the joint") as tell:
            tell("half of it")
        lines = capsys.readouterr().err.split("\r")[1:]
        assert [line.removesuffix("\x1b[K") for line in lines] == told


CHOOSE = ["choose", "--r2-star", 200, "--depth-star", 0.3]


def test_choose_prints_the_law_its_error_and_its_cost(run):
    words = ["--socket-ratio", 1.3, "--poisson", 0.3, "--tolerance", 0.01]
    status, out, err = run(*CHOOSE, *words, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["law"] == "stiffened_hertz"
    assert 1e-5 < found["error_bound"] < 0.01
    assert 1 < found["relative_cost"] < 5
    assert found["next_cheaper"]["error"] > 0.01
    _, out, _ = run(*CHOOSE, *words)
    assert "stiffened_hertz" in out
    assert all(law in out for law in contact.LAWS)


def test_choose_warns_beyond_yield(run):
    words = ("choose", "--r2-star", 200, "--depth-star", 0.4, "--tolerance", 0.5)
    text = run(*words, "--yield-stress", 2.5e8)[1]
    assert re.search(r"The socket yields, at the surface, from 0\.25\d* clearances on", text)
    assert "errors are for joints that do not yield" in text
    found = json.loads(run(*words, "--yield-stress", 2.5e8, "--json")[1])["first_yield"]
    steel = Material(yield_stress=2.5e8)
    assert found == pytest.approx(vars(first_yield(Joint(200, ball=steel, socket=steel), 0.4)))
    for more in ((), ("--yield-stress", 2e9)):
        assert json.loads(run(*words, *more, "--json")[1])["first_yield"] is None
        assert "yields" not in run(*words, *more)[1]
    status, _, err = run(*words, "--layer", "1.3,1,0.3", "--yield-stress", 2e9)
    assert status == 2
    assert err == "study: yield_stress must be left out: layer describes the socket\n"


def test_choose_knows_two_materials(run):
    words = ["--tolerance", 0.02, "--modulus-ratio", 0.5, "--socket-poisson", 0.33]
    _, out, _ = run(*CHOOSE, *words, "--json")
    found = json.loads(out)
    assert found["law"] == "stiffened_hertz"
    assert found["options"]["modulus_ratio"] == 0.5


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["--tolerance", 0], 2, "tolerance must be >= 1e-05 and <= 1, got 0"),
        (["--tolerance", 0.1, "--modulus-ratio", 0], 2, "modulus_ratio must be > 0, got 0"),
        (["--tolerance", 0.1, "--poisson", 0.5], 2, "Poisson's ratio must be > -1 and < 0.5"),
        (["--tolerance", 1e-5, "--drive", "clamped"], 1, "no law is known to be within"),
        ([], 2, "Missing option '--tolerance'"),
    ],
)
def test_choose_refuses_in_one_line(run, words, status, message):
    found, out, err = run(*CHOOSE, *words)
    assert (found, out) == (status, "")
    assert err.count("\n") == 1
    assert message in err


def test_measure_times_a_chart_and_writes_where_told(run, tmp_path, monkeypatch):
    monkeypatch.setattr(timing, "compile_time", lambda *_: 1.0)  # it takes some seconds
    table = tmp_path / "laws.csv"
    kept = store.SPEED.read_bytes()
    status, out, _ = run("measure", "--chart", "laws", "--repeats", 1, "--output", table)
    assert status == 0
    assert "rows, on" in out
    rows = pd.read_csv(table)
    assert set(rows.method) == {*contact.LAWS, "tabulated", "solver"}
    assert (rows.time > 0).all()
    assert store.SPEED.read_bytes() == kept
    status, _, err = run("measure", "--output", tmp_path / "laws.txt")
    assert (status, err.count("\n")) == (2, 1)


def test_joint_and_export_take_unequal_materials(run):
    words = ["--r2-star", 150, "--modulus-ratio", 0.35, "--socket-poisson", 0.33]
    _, out, _ = run("joint", *words, "--depth-star", 0.5, "--json")
    expected = Joint(150, socket=Material(0.35 * 2e11, 0.33))
    force = json.loads(out)["force_star"][0]
    assert force == pytest.approx(force_curve(expected, 0.5).force_star[0])
    _, out, _ = run("export", "--law", "tabulated", "--format", "json", *words)
    assert json.loads(out)["joint"]["modulus_ratio"] == pytest.approx(0.35)
    _, out, _ = run("export", "--law", "stiffened_hertz", "--format", "json", *words)
    assert json.loads(out)["joint"]["modulus_ratio"] == pytest.approx(0.35)


def test_simulate_auto_tells_what_it_chose(run):
    words = ["--model", "auto", "--tolerance", 0.001, "--duration", 0.05]
    status, out, err = run("simulate", *words, "--json")
    assert (status, err) == (0, "")
    choice = json.loads(out)["choice"]
    assert choice["error_bound"] <= 0.001
    assert choice["evidence"]
    words += ["--quantity", "slider_velocity", "--tolerance", 0.1, "--socket-ratio", 1.5]
    _, out, _ = run("simulate", *words)
    assert "The simplest model whose slider velocity is known well enough over 0.05 s" in out


def test_simulate_fails_in_one_line(run):
    soft = ("--scene", "youngs_modulus=1e6", "--scene", "driving_moment=25")
    status, out, err = run("simulate", *soft, "--json")
    assert (status, out) == (1, "")
    assert err.count("\n") == 1
    assert "stopped at time 0.0" in err


@pytest.fixture
def heeding_interrupts():
    """Python's own handler of Ctrl-C, which a job in the background of a script has not."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heeding_interrupts")
def test_interrupted_simulation_prints_and_writes_what_it_has(run, tmp_path, monkeypatch):
    @wraps(simulate)
    def interrupted(*words, progress, **options):
        def stop(time):
            if time > 0.02:
                os.kill(os.getpid(), signal.SIGINT)  # as Ctrl-C does

        return simulate(*words, progress=stop, **options)

    monkeypatch.setattr("study.mechanism.simulate", interrupted)
    table = tmp_path / "motion.csv"
    status, out, err = run("simulate", "--json", "--output", table)
    assert (status, err) == (130, "study: interrupted; what was finished is kept\n")
    found = json.loads(out)
    assert not found["complete"]
    assert 0.02 < found["time"] <= 0.1  # told now and then
    assert pd.read_csv(table).time.iloc[-1] == pytest.approx(found["time"])
