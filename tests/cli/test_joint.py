"""The command for a joint: its numbers are the solver's, in the order asked, in the right units."""

import json
import re
import shlex
from dataclasses import replace

import numpy as np
import pytest

from study.checks import StudyError, UnitWarning
from study.joint import Joint, Layer, Material

SIZES = ["joint", "--socket-radius", "12.5e-3", "--clearance", "40e-6", "--wall", "6e-3"]
BRONZE = [*SIZES, "--ball", "steel", "--socket", "bronze"]
LAYERED = Joint.from_ratios(80, layers=(Layer(1.125, Material(5e8, 0.46)), Layer(1.5, Material())))
DIMENSIONS = Joint(12.5e-3, 40e-6, 6e-3, "steel", "bronze")
RATIOS = ["joint", "--r2-star", 75, "--depth-star", 0.1]
TILTED = [*BRONZE, "--force", 1, "--ball-support", "clamped", "--tilt", 5]


@pytest.mark.parametrize(
    ("words", "joint"),
    [
        (["--socket-ratio", 1.4, "--ball-support", "guided"], Joint.from_ratios(80, 1.4)),
        (["--layer", "1.125,0.0025,0.46", "--layer", "1.5,1,0.3"], LAYERED),
    ],
)
def test_a_joint_by_ratios_is_one_json_object_in_the_order_asked(run, words, joint):
    words = ["--r2-star", 80, "--depth-star", 0.5, "--depth-star", 0.1, *words]
    status, out, err = run("joint", *words, "--json")
    assert (status, err) == (0, "")
    found, curve = json.loads(out), joint.solve(depth_star=[0.5, 0.1])
    for name in ("force_star", "contact_half_angle_deg", "error_estimate"):
        assert found[name] == pytest.approx(list(getattr(curve, name)))
    bodies = [body.replace(" ", "_") for body in joint.materials]
    places = [key for key in found if key.endswith("_place")]
    assert places == [f"von_mises_{body}_place" for body in bodies]
    for body in bodies:
        star, share = (found[f"von_mises_{body}_{key}"][0] for key in ("star", "over_peak"))
        assert star == pytest.approx(share * found["peak_pressure_star"][0])


def test_a_joint_with_dimensions_is_in_si_units_in_the_order_asked(run):
    status, out, err = run(*BRONZE, "--force", 8000, "--force", 3000, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["force"] == pytest.approx([8000, 3000], rel=1e-8)
    assert found["depth"] == pytest.approx([7.54e-6, 4.19e-6], rel=0.01)
    assert found["stiffness"] == pytest.approx([1.763e9, 1.199e9], rel=0.01)
    assert found["peak_pressure"][0] == pytest.approx(117e6, rel=0.01)
    assert found["yield_factor_socket"][0] * found["von_mises_socket"][0] == pytest.approx(1.6e8)
    assert found["r2_star"] == pytest.approx(312.5)
    assert found["materials"]["socket"]["youngs_modulus"] == 1.1e11
    status, out, _ = run(*BRONZE, "--depth", found["depth"][0], "--json")
    assert json.loads(out)["force"] == pytest.approx([8000], rel=1e-6)


def test_the_line_to_export_the_chosen_law_can_be_typed(run):
    status, out, err = run(*BRONZE, "--force", 8000)
    assert (status, err) == (0, "")
    heads, units = (line.split() for line in out.splitlines()[:2])
    assert dict(zip(heads, units, strict=True)) == {
        **{"depth": "um", "force": "N", "stiffness": "N/um", "half_angle": "deg"},
        **{"contact_area": "mm^2", "peak_pressure": "MPa", "peak_error": "%", "force_error": "%"},
    }
    assert "within 1 % of the elastic solution at depths from 0.2 to 7.536 um is stiffened" in out
    (line,) = (line for line in out.splitlines() if line.startswith("study export"))
    assert json.loads(run(*BRONZE, "--force", 8000, "--json")[1])["export"] == line
    status, out, err = run(*line.split()[1:])
    assert (status, err) == (0, "")
    words = " ".join(out.replace(" * ", " ").split())
    assert "socket_radius=0.0125, clearance=4e-05, wall=0.006, ball=steel, socket=bronze" in words
    assert "R2* = 312.5, E* = 8.08189655e+10 Pa" in words


@pytest.mark.slow
def test_a_joint_with_liners_and_a_tolerance(run, monkeypatch):
    lined = [*SIZES, "--liner", "0.5e-3,PTFE", "--liner", "1e-3,7e10,0.33", "--force", 500]
    status, out, err = run(*lined, "--ball-support", "clamped", "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert [*found["materials"]] == ["ball", "liner 1", "liner 2", "socket"]
    assert found["yield_factor_liner_2"] is None
    assert found["law"] == "tabulated"
    assert "--ball-support clamped" in found["export"]
    assert found["export"].count("--liner ") == 2

    def none(joint, depth_star, tolerance):
        raise StudyError(f"no law is within {tolerance:g}")

    monkeypatch.setattr("study.choose.cheapest_law.choose_beside", none)
    status, out, _ = run(*BRONZE, "--force", 500, "--tolerance", 1e-5)
    assert status == 0
    assert "No contact law is recommended: no law is within 1e-05" in out


@pytest.mark.slow
def test_laws_are_compared_no_shallower_than_elements_resolve(run):
    metres = ("--socket-radius", 16e-3, "--clearance", 1e-4, "--wall", 8e-3, "--force")
    for words in ((500, "--ball-support", "clamped", "--rim", "free"), (0.5,)):
        status, out, err = run("joint", *metres, *words, "--json")
        assert (status, err) == (0, "")
        found = json.loads(out)
        least, most = found["law_depths"]
        assert least < found["depth"][0] < most
        assert found["law_error_bound"] < 0.01


def test_torque_is_that_of_the_solution(run):
    words = [*BRONZE, "--force", 8000, "--force", 3000, "--friction", 0.1]
    found, solution = json.loads(run(*words, "--json")[1]), DIMENSIONS.solve(force=[8000, 3000])
    for motion, torque in solution.friction_torque(0.1).items():
        assert found[f"{motion}_torque"] == pytest.approx(torque.tolist(), rel=1e-9)
    lines = run(*words)[1].splitlines()
    heads = lines.index("depth  spin_torque  tilt_torque")
    assert lines[heads + 1].split() == ["um", "N", "m", "N", "m"]
    row = [float(cell) for cell in lines[heads + 3].split()]
    assert row[1:] == pytest.approx([found[f"{m}_torque"][0] for m in ("spin", "tilt")], rel=1e-3)


@pytest.mark.slow
def test_a_law_off_the_axis_and_a_resolution_are_for_those_who_ask(run):
    tilted = [*BRONZE, "--depth", 4e-6, "--ball-support", "clamped", "--tilt", 20]
    status, out, err = run(*tilted)
    assert (status, err) == (0, "")
    assert "For the contact law in this direction, add --law." in out
    found = json.loads(run(*tilted, "--resolution", 32, "--json")[1])
    assert not {"law", "export", "power_law"} & set(found)
    joint = replace(DIMENSIONS, ball_support="clamped", rim="free")
    coarse = joint.solve(depth=4e-6, tilt=20, resolution=32)
    assert found["force"] == pytest.approx(coarse.force)
    found = json.loads(run(*tilted, "--law", "--json")[1])
    assert found["power_law"]["exponent"] == pytest.approx(
        joint.power_law((0.4e-6, 4e-6), 20).exponent
    )
    assert "--law tabulated --tilt 20 --format c " in found["export"]


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_the_same_joint_is_drawn_with_the_same_bytes(run, tmp_path, suffix):
    words = [*BRONZE, "--force", 8000, "--force", 3000, "--plot", tmp_path / f"joint{suffix}"]
    drawn = []
    for _ in range(2):
        assert run(*words)[0] == 0
        drawn.append((tmp_path / f"joint{suffix}").read_bytes())
    assert drawn[0] == drawn[1]
    assert len(drawn[0]) > 10_000


def test_the_drawing_has_the_numbers_of_the_solution(monkeypatch, tmp_path):
    from matplotlib.figure import Figure

    from study.cli import joint

    figures, solution = [], DIMENSIONS.solve(force=[8000, 3000])
    monkeypatch.setattr(Figure, "savefig", lambda f, path, **_: figures.append(f) or path.touch())
    joint.draw(solution, tmp_path / "joint.png")
    force, pressure = figures[0].axes
    (curve, *points), profiles = force.lines, pressure.lines
    depth, along = curve.get_data()
    assert along == pytest.approx(DIMENSIONS.law().force(1e-6 * depth))
    for k, (point, profile) in enumerate(zip(points, profiles, strict=True)):
        assert np.ravel(point.get_data()) == pytest.approx([1e6 * solution.depth[k], (8e3, 3e3)[k]])
        assert profile.get_ydata() == pytest.approx(1e-6 * solution.pressure[k])
        assert (profile.get_xdata() == solution.angle_deg).all()
    for axes, units in ((force, ("(µm)", "(N)")), (pressure, ("(deg)", "(MPa)"))):
        assert (axes.get_xlabel()[-len(units[0]) :], axes.get_ylabel()[-len(units[1]) :]) == units


def test_values_in_another_unit_are_asked_about(run):
    millimetres = ("--socket-radius", 16, "--clearance", 0.1, "--wall", 8, "--force", 500)
    status, out, err = run("joint", *millimetres)
    assert (status, err) == (0, "")
    assert "check that all dimensions are in m, not in mm" in out
    told, *_ = json.loads(run("joint", *millimetres, "--json")[1])["warnings"]
    assert told == Joint(16, 0.1, 8).warnings[0]
    status, _, err = run(*BRONZE, "--ball", "110000,0.3", "--force", 3000)
    assert status == 2
    assert re.search("110000 Pa, which is very small; check .* force must be <= 6", err)
    with pytest.warns(UnitWarning, match="not in mm"):
        Joint(16, 0.1, 8)


def test_units_of_numbers_and_of_results(run):
    typed = ["--socket-radius", "12.5mm", "--clearance", "40um", "--wall", "0.6cm"]
    typed += ["--ball", "steel", "--socket", "110GPa,0.34,160MPa", "--force", "3kN", "--json"]
    plain, with_units = (
        json.loads(run(*w)[1]) for w in ([*BRONZE, "--force", 3000, "--json"], ["joint", *typed])
    )
    plain.pop("export"), with_units.pop("export")
    assert plain == with_units
    found = json.loads(run("joint", *typed, "--units", "mm")[1])
    for name, factor in (
        ("depth", 1e3),
        ("force", 1),
        ("stiffness", 1e-3),
        ("contact_area", 1e6),
        ("peak_pressure", 1e-6),
        ("von_mises_socket", 1e-6),
    ):
        assert found[name] == pytest.approx([factor * plain[name][0]])
    assert found["materials"]["socket"]["youngs_modulus"] == pytest.approx(1.1e5)
    heads, units = (
        line.split() for line in run("joint", *typed[:-1], "--units", "mm")[1].splitlines()[:2]
    )
    assert dict(zip(heads, units, strict=True))["stiffness"] == "N/mm"


def test_a_joint_is_saved_and_given_to_other_commands(run, tmp_path):
    save = tmp_path / "cup.toml"
    words = ["--socket-radius", "12.5mm", "--play", "80um", "--wall", "6mm", "--socket", "bronze"]
    status, out, _ = run("joint", *words, "--save", save)
    assert (status, f"--joint {save}" in out) == (0, True)
    direct = json.loads(run("joint", *words, "--force", 3000, "--json")[1])
    saved = json.loads(run("joint", "--joint", save, "--force", 3000, "--json")[1])
    assert saved["depth"] == direct["depth"]
    assert shlex.split(saved["export"])[-2:] == ["--joint", str(save)]
    assert run(*shlex.split(saved["export"])[1:])[0] == 0
    for command in (
        ["choose", "--force", "3kN", "--tolerance", 0.05],
        ["law", "hertz", "--depth", "4um"],
        ["fit", "--try-power", "2e12,1.65"],
    ):
        assert run(*command, "--joint", save)[0] == 0
    other = json.loads(
        run("joint", "--joint", save, "--clearance", "60um", "--force", 3000, "--json")[1]
    )
    assert other["r2_star"] == pytest.approx(12.5e-3 / 60e-6)
    save.write_text("wall = 0.1\nwal = 3\n")
    status, _, err = run("joint", "--joint", save, "--force", 1)
    assert (status, "has the line wal = 3" in err) == (2, True)


@pytest.mark.slow
def test_a_ring_by_its_width(run):
    words = [*SIZES, "--ball-support", "core:0.2", "--force", 9000, "--json"]
    width = 2 * 12.5e-3 * np.cos(np.radians(55))
    by_width, by_angles = (
        json.loads(run(*words, *of)[1])["depth"]
        for of in (["--ring-width", width], ["--opening", "55:125"])
    )
    assert by_width == pytest.approx(by_angles, rel=1e-6)


def test_k_and_n_are_for_one_range_unless_depths_are_asked_for(run):
    """From 0.05 to 0.5 clearances, or a tenth of the depth to it."""
    for words, depths in (
        (["--force", 3000], None),
        (["--depth", 4e-6], (0.4e-6, 4e-6)),
        (["--depth", 1e-6, "--depth", 9e-6], (1e-6, 9e-6)),
    ):
        found = json.loads(run(*BRONZE, *words, "--json")[1])["power_law"]
        assert found["exponent"] == pytest.approx(DIMENSIONS.power_law(depths).exponent)
        assert found["depths"] == pytest.approx(depths or (2e-6, 20e-6))
