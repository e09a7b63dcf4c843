"""Exported laws are the laws: C compiled, MATLAB run in Octave, CSV read back."""

import ctypes
import io
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from helpers import programs
from helpers.programs import needs_compiler, needs_octave
from scipy.interpolate import CubicSpline

from study.contact import LAWS, Steuermann, Table
from study.contact.power_fit import DEPTHS, USUAL_RANGE, fit_power
from study.export import DIMENSIONLESS, FORMATS, export
from study.joint import Joint, Layer, Material

BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
PLAIN, LESS = Joint.from_ratios(200), Joint.from_ratios(75, 1.4)
BENDING = Joint(10e-3, 1e-4, 0.3e-3, socket_support="rim")
RING = Joint(
    14.53e-3,
    30e-6,
    2.97e-3,
    socket="bearing steel",
    opening="65.6:114.4",
    ball_support="pin:10e-3,16e-3",
)
MINE = np.linspace(0.01, 1.4, 200) ** 2  # depths of a table of the user
SUITED = {"adams": "power", "mujoco": "tabulated"}
"""Format -> a law that it has; others have all."""


def units(joint):
    """Units of depth and force of an export."""
    return (joint.clearance, joint.force_unit) if joint.has_dimensions else (1.0, 1.0)


def in_python(law, joint, depth_star):
    """Force and stiffness of a law in the units of its export."""
    made = joint.law(law).law
    length, load = units(joint)
    values = (made(depth_star, joint.r2_star, derivative=of) for of in (False, True))
    return [unit * of for unit, of in zip((load, load / length), values, strict=True)]


def deepest_of(law, joint):
    """Maximum depth of a text, in clearances, if none is asked for."""
    limit = joint.law(law).law.deepest
    return USUAL_RANGE[1] if law == "power" else min(1.0, limit or 1.0)


def in_c(text, folder, name, depths):
    """Forces, stiffnesses and returned values of a function in C, (3, n)."""
    function = getattr(programs.compiled(text, folder), name)
    force, stiffness = ctypes.c_double(), ctypes.c_double()
    found = []
    for depth in depths:
        end = function(ctypes.c_double(depth), ctypes.byref(force), ctypes.byref(stiffness))
        found.append((force.value, stiffness.value, end))
    return np.transpose(found)


@needs_compiler
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("joint", [BRONZE, PLAIN, BENDING], ids=["bronze", "plain", "bending"])
def test_law_in_c_is_the_law(tmp_path, law, joint):
    if law == "stiffened_hertz" and joint is BENDING:
        pytest.skip("the law is not for this joint")
    share = deepest_of(law, joint) * np.random.default_rng(1).uniform(0, 1, 1000)
    depths = units(joint)[0] * share
    force, stiffness, _ = in_c(export(law, "c", joint), tmp_path, f"{law}_law", depths)
    expected = in_python(law, joint, share)
    assert force == pytest.approx(expected[0], rel=1e-5 if law == "power" else 1e-6)
    # the slope of the elastic solution's own table has kinks
    assert stiffness == pytest.approx(expected[1], rel=2e-4)


@needs_compiler
@pytest.mark.parametrize("law", ["hertz", "tabulated"])
def test_depths_outside_the_range(tmp_path, law):
    """No force without contact; a table goes on linearly, and says so; NaN stays NaN."""
    deepest = BRONZE.clearance
    depths = np.array([-1e-6, 0.0, deepest, 1.5 * deepest, 2 * deepest, np.nan])
    force, stiffness, is_beyond = in_c(export(law, "c", BRONZE), tmp_path, f"{law}_law", depths)
    assert is_beyond.tolist() == [0, 0, 0, 1, 1, 0]
    assert not force[:2].any()
    assert not stiffness[:2].any()
    assert np.isnan(force[5])
    if law == "tabulated":
        assert stiffness[3] == stiffness[4] == pytest.approx(stiffness[2], rel=1e-9)
        assert force[3:5] == pytest.approx(force[2] + stiffness[2] * (depths[3:5] - deepest))
        assert "continues linearly" in export(law, "c", BRONZE)


@needs_compiler
def test_two_joints_in_one_file_one_with_a_law_of_its_own_numbers(tmp_path):
    mine = Table.of_values(MINE, 300 * MINE**1.6, BRONZE.r2_star)
    laws = {"a": (mine, BRONZE), "b": ("tabulated", LESS), "c": (Steuermann(3, "profile"), LESS)}
    text = "\n".join(export(law, "c", joint, name=name) for name, (law, joint) in laws.items())
    share = np.random.default_rng(2).uniform(0.01, 1, 200)
    for name, (law, joint) in laws.items():
        (tmp_path / name).mkdir()
        force, *_ = in_c(text, tmp_path / name, name, units(joint)[0] * share)
        assert force == pytest.approx(in_python(law, joint, share)[0], rel=1e-6)


@needs_octave
def test_every_law_in_octave_is_the_law(tmp_path):
    """All in one run, with an array of depths of any shape."""
    lines, expected = [], {}
    shares = np.array([[-0.1, 0.0, 1e-3, 0.03], [0.02, 0.37, 0.8, 1.0]])
    for law in LAWS:
        share = deepest_of(law, BRONZE) * shares
        (tmp_path / f"{law}_law.m").write_text(export(law, "matlab", BRONZE))
        expected[law] = in_python(law, BRONZE, share)
        shown = "; ".join(
            " ".join(f"{x!r}" for x in row) for row in (BRONZE.clearance * share).tolist()
        )
        lines += [f"[force, stiffness] = {law}_law([{shown}]);", "disp(size(force))"]
        lines += ["printf('%.17g\\n', force, stiffness)"]
    told = iter(programs.in_octave(lines, tmp_path).split("\n"))
    for law in LAWS:
        assert next(told).split() == ["2", "4"]
        for values, error in zip(
            expected[law], (1e-5 if law == "power" else 1e-6, 2e-4), strict=True
        ):
            found = [float(next(told)) for _ in range(8)]
            assert found == pytest.approx(values.T.ravel().tolist(), rel=error)


@needs_octave
def test_octave_warns_of_a_depth_beyond_the_table(tmp_path):
    (tmp_path / "hip.m").write_text(export("tabulated", "matlab", BRONZE, 0.3, name="hip"))
    lines = ["warning('error', 'study:beyond')"]
    for depths in ("[-1, 0, 0.299]", "[0.1, 0.301]"):
        call = f"hip(4e-5 * {depths})"
        lines += [f"try, {call}; disp('inside'), catch error, disp(error.identifier), end"]
    assert programs.in_octave(lines, tmp_path).split() == ["inside", "study:beyond"]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("deepest", [None, 0.3])
def test_csv_is_the_law_at_its_depths_and_says_how_to_interpolate(law, deepest):
    text = export(law, "csv", PLAIN, deepest)
    table = pd.read_csv(io.StringIO(text), comment="#")
    assert list(table.columns) == ["depth_star", "force_star", "stiffness_star"]
    last = deepest or deepest_of(law, PLAIN)
    depth = table.depth_star.to_numpy()
    assert depth[[0, -1]].tolist() == [0, last]
    if law == "power":  # fitted over the range of the export
        low, high = (deepest / 10, deepest) if deepest else USUAL_RANGE
        places = np.geomspace(low, high, DEPTHS)
        fit = fit_power(places, PLAIN.table()(places))
        force, least = fit.coefficient * depth**fit.exponent, last / 10
        exact = lambda d: fit.coefficient * d**fit.exponent  # noqa: E731
    else:
        made = PLAIN.table(deepest) if law == "tabulated" else PLAIN.law(law).law
        least = 0.005
        force, exact = made(depth, 200), lambda d: made(d, 200)
        stiffness = made(depth[1:], 200, derivative=True)
        assert table.stiffness_star[1:].tolist() == pytest.approx(stiffness, rel=1e-6)
    assert table.force_star.tolist() == pytest.approx(force, rel=1e-6)
    between = np.linspace(np.sqrt(least), np.sqrt(last), 3000) ** 2
    (told,) = (float(line.split()[-2]) / 100 for line in text.splitlines() if " adds " in line)
    off = np.abs(np.interp(between, depth, table.force_star) / exact(between) - 1).max()
    assert off < 1.05 * told + 1e-6


def test_a_table_in_si_units_and_a_short_one_for_a_spline_in_mm():
    text = export("tabulated", "csv", BRONZE, points=30, units="mm")
    table, si = (
        pd.read_csv(io.StringIO(of), comment="#")
        for of in (text, export("tabulated", "csv", BRONZE))
    )
    assert (len(table), "# depth in mm" in text, "# stiffness in N/mm" in text) == (30, True, True)
    assert table.depth.iloc[-1] == pytest.approx(1e3 * si.depth.iloc[-1])
    assert list(si) == ["depth", "force", "stiffness"]
    for name in ("force", "stiffness"):
        expected = getattr(BRONZE.law(), name)(si.depth[1:])
        assert si[name][1:].to_numpy() == pytest.approx(expected, rel=1e-9)
    (told,) = (float(line.split()[-2]) / 100 for line in text.splitlines() if "spline" in line)
    spline = CubicSpline(table.depth, table.force)(1e3 * si.depth[40:])
    off = np.abs(spline / si.force[40:] - 1).max()
    assert 0.2 * told < off < 1.05 * told < 0.01
    for more, message in (
        ({"points": 2}, "points must be >= 3"),
        ({"points": 30, "form": "c"}, "format with points must be one of csv"),
        ({"units": "mm", "form": "adams"}, "format with units mm must be one of c, matlab, csv"),
    ):
        with pytest.raises(ValueError, match=message):
            export("power", **{"form": "csv", "joint": BRONZE} | more)


@pytest.mark.parametrize("form", FORMATS)
def test_a_text_has_joint_name_range_error_and_units(form):
    text = export(SUITED.get(form, "power"), form, BRONZE, 0.5, name="left_hip")
    words = re.sub(r"\s+[*%#!/]*\s*", " ", text)
    modulus = f"E* = {BRONZE.composite_modulus:.9g} Pa"
    for word in ("left_hip", "socket_radius=0.0125", "clearance=4e-05", "socket=bronze", modulus):
        assert word in words
    assert "0 to 0.5 clearances (20 um)" in words
    assert "elastic solution" in words
    assert ("error is unknown" in words or "unknown error" in words) == (form in ("csv", "mujoco"))
    if form in ("c", "matlab"):
        assert re.search(r"^(int|function .* =) left_hip\(", text, re.MULTILINE)
    if form in DIMENSIONLESS:
        layers = Layer(1.125, Material(5e8, 0.46)), Layer(1.5, Material(2e11, 0.3))
        text = export("tabulated", form, Joint.from_ratios(80, layers=layers), 0.5)
        for word in ("1.125,0.0025,0.46;1.5,1,0.3", "R2* = 80", "0 to 0.5 clearances.", "E* dR^2"):
            assert word in text


def stated(text):
    """Errors of the law and of the elastic solution that a text states, relative."""
    words = re.sub(r"\n\W*", " ", text)
    numbers = re.search(r"at most ([\d.e-]+) % .*, at most ([\d.e-]+) % here", words).groups()
    return [float(number) / 100 for number in numbers]


def k_and_n(text):
    """Constants of a power law in C."""
    return [float(x) for x in re.search(r"k = (\S+), n = (\S+)\n", text).groups()]


def test_the_stated_error_is_the_laws():
    depth, exact = np.linspace(0.005, 0.4, 1000), LESS.table(0.4)
    off = np.abs(LESS.law("hertz").law(depth, 75) / exact(depth) - 1).max()
    curve = exact.curve
    of_joint = curve.force_error[curve.depth_star > 0.005].max() + exact.error
    assert stated(export("hertz", "c", LESS, 0.4)) == pytest.approx([off, of_joint], rel=0.1)
    assert "relative to the elastic solution" not in export("tabulated", "c", LESS, 0.4)


def test_power_is_fitted_in_the_range_that_is_asked_for():
    text = export("power", "c", BRONZE, (0.01, 0.1))
    fitted = BRONZE.power_law((0.4e-6, 4e-6))
    assert k_and_n(text) == pytest.approx(fitted[:2], rel=1e-8)
    assert stated(text)[0] == pytest.approx(fitted.error, rel=0.1)


@pytest.mark.slow
def test_a_power_law_along_a_displacement_off_the_axis():
    joint = replace(BRONZE, ball_support="neck:30", rim="free")
    text, fit = export("power", "c", joint, tilt=20), joint.power_law(tilt=20)
    assert k_and_n(text) == pytest.approx(fit[:2], rel=1e-8)
    words = r"20 deg off the axis; between 10 and 30 deg the .* up to (\S+) % and .* (\S+) %"
    solved = joint.solve(depth_star=[0.5] * 3, tilt=[20, 10, 30])
    told = re.search(words, re.sub(r"\n \* ", " ", text)).groups()
    for percent, name in zip(told, ("force", "stiffness"), strict=True):
        of = getattr(solved, name)
        assert float(percent) == pytest.approx(100 * np.abs(of / of[0] - 1).max(), rel=0.1)


@pytest.mark.slow
def test_one_pair_of_numbers_for_a_rod_end_off_its_axis():
    fit = RING.power_law((0.5e-6, 8e-6))
    text = export("power", "c", RING, (0.5 / 30, 8 / 30))
    assert k_and_n(text) == pytest.approx(fit[:2], rel=1e-8)


@pytest.mark.parametrize("law", ["hertz", "tabulated", "power"])
def test_two_joints_for_exudyn_share_no_name(law):
    pytest.importorskip("exudyn")
    names = []
    for name in ("left", "right"):
        module = {}
        exec(export(law, "exudyn", BRONZE, name=name), module)
        names.append({of for of, x in module.items() if getattr(x, "__module__", "") != "math"})
    shared = names[0] & names[1]
    assert shared <= {"__builtins__", "exudyn", "item", "warnings"}


@pytest.mark.parametrize(
    ("form", "name"),
    [
        *(("c", name) for name in ("double", "main", "sqrtf")),
        *(("matlab", name) for name in ("function", "power")),
        *(("modelica", name) for name in ("model", "der")),
        *(("exudyn", name) for name in ("lambda", "print")),
    ],
)
def test_a_word_of_the_language_is_no_name(run, form, name):
    words = ["export", "power", form, "--socket-radius", 12.5e-3]
    words += ["--clearance", 40e-6, "--wall", 6e-3, "--name", name]
    status, out, err = run(*words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"name must not be a keyword or a standard function of {form}, got '{name}'" in err


def test_a_function_of_matlab_has_the_name_of_its_file(run, tmp_path):
    words = ["export", "tabulated", "matlab", "--r2-star", 100]
    assert run(*words, "--output", tmp_path / "hip.m")[0] == 0
    assert re.search(r"^function .* = hip\(", (tmp_path / "hip.m").read_text())
    status, _, err = run(*words, "--output", tmp_path / "power.m")
    assert (status, err.count("\n")) == (2, 1)
    assert "got 'power'" in err
    assert not (tmp_path / "power.m").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("hertz", "c", BRONZE, None, None, "2nd hip"), "name must begin with a letter .* got"),
        (("hooke", "c", PLAIN), r"law must be one of hertz, .*, tabulated, got 'hooke'"),
        (("tabulated", "xml", PLAIN), "format must be one of c, matlab, modelica, csv"),
        (("power", "csv", PLAIN, (0.2, 0.1)), "minimum depth_star must be > 0 and < 0.1, got 0.2"),
        (("power", "csv", PLAIN, (0.1, 0.2, 0.3)), "depth_star must be one depth, or the minimum"),
        (("power", "adams", PLAIN), "format of a joint without dimensions must be one of c,"),
        (("hertz", "mujoco", BRONZE), "law must be tabulated for the format mujoco, got 'hertz'"),
        (("hertz", "c", PLAIN, None, 20), "law must be tabulated or power off the axis, got 'h"),
        (("stiffened_hertz", "c", BRONZE, 1.5), "depth_star of stiffened_hertz must be <= 1, got"),
    ],
)
def test_bad_input_is_one_clear_error(arguments, message):
    with pytest.raises(ValueError, match=message):
        export(*arguments)


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMATS)
def test_a_table_off_the_axis_needs_depths_that_are_resolved(form):
    for deepest, um in ((0.006, "0.18"), (0.05, "1.5")):
        message = rf"depth_star must be > 0.05 clearances \(1.5 um\), .* \({um} um\)$"
        with pytest.raises(ValueError, match=message):
            export("tabulated", form, RING, deepest)


@pytest.mark.slow
def test_a_narrow_socket_has_a_depth_of_its_own():
    joint = Joint.from_ratios(20, opening=40, ball_support="core:0.2")
    deepest = joint.table().deepest
    assert deepest < 1
    for law in ("hertz", "tabulated"):
        assert f"from 0 to {deepest:g} clearances" in export(law, "c", joint)
