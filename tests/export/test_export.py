"""Exported laws are the laws: C compiled, MATLAB run in Octave, JSON and CSV read back."""

import ctypes
import io
import json
import re
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd
import pytest
from helpers import programs
from helpers.laws import VARIANTS
from helpers.programs import needs_compiler, needs_octave
from scipy.interpolate import CubicHermiteSpline

from study import contact
from study.contact import LAWS, shapes
from study.contact.power_fit import USUAL_RANGE
from study.export import FUNCTIONS, LAW_OF, SUFFIXES, export, formulas
from study.joint import Joint, Layer, Material
from study.joint.table import table

R1, R2, MODULUS = 9.95e-3, 10e-3, 1.137e11
EXPORTED = [*LAWS, "tabulated"]
BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
PLAIN, LESS = Joint.from_ratios(200), Joint.from_ratios(75, 1.4)
JOINTS = (
    PLAIN,
    Joint.from_ratios(
        20, 1.1, modulus_ratio=0.35, socket_poisson=0.34, ball_support="clamped", rim="free"
    ),
    Joint.from_ratios(1e5, 8.0, modulus_ratio=0.01, poisson=0.46),
)


def in_python(law, joint, deepest=None):
    """Dimensionless force and stiffness, of depths."""
    function = LAWS.get(law) or table(joint, deepest)
    options = joint.law_options(function)
    if law == "power":
        unit = joint.clearance
        fit = joint.power_law(deepest and (unit * deepest / 10, unit * deepest))
        coefficient = fit.coefficient * unit**fit.exponent / joint.force_unit
        options = {"coefficient": coefficient, "exponent": fit.exponent}
    return [partial(function, r2_star=joint.r2_star, derivative=of, **options) for of in (0, 1)]


@pytest.fixture
def compiled(tmp_path):
    """Compile an exported law; returns a function of its arguments."""

    def compiled(law, joint):
        library = programs.compiled(export(law, "c", joint), tmp_path)
        function = getattr(library, FUNCTIONS.get(law, law))

        def call(*arguments):
            force, stiffness = ctypes.c_double(-1), ctypes.c_double(-1)
            inputs = [ctypes.c_double(x) for x in arguments]
            status = function(*inputs, ctypes.byref(force), ctypes.byref(stiffness))
            return status, force.value, stiffness.value

        return call

    return compiled


def deepest_of(law):
    """Largest depth of a text, in clearances, if none is asked for."""
    return USUAL_RANGE[1] if law == "power" else 1.0


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
@pytest.mark.parametrize("joint", JOINTS[:2])
def test_law_in_c_is_the_law(compiled, law, joint):
    last = deepest_of(law)
    function, (force_star, stiffness_star) = compiled(law, joint), in_python(law, joint)
    clearance = R2 / joint.r2_star
    for depth in clearance * np.random.default_rng(1).uniform(-0.1, last, 100):
        status, force, stiffness = function(depth, R2, clearance, MODULUS)
        assert status == 0
        expected = MODULUS * clearance**2 * force_star(depth / clearance)
        assert force == pytest.approx(expected, rel=1e-9)
        expected = MODULUS * clearance * stiffness_star(depth / clearance)
        assert stiffness == pytest.approx(expected, rel=1e-9)


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
def test_law_in_c_refuses_what_is_out_of_range(compiled, law):
    function = compiled(law, PLAIN)
    good = [1e-5, R2, 5e-5, MODULUS]
    other_joints, sizes = (3 * R2, R2 * (1 + 2e-6), np.nan), (-1.0, 0.0, np.nan)
    for place, wrongs in enumerate(((6e-5, np.nan), other_joints, sizes, (0.0, np.inf))):
        for wrong in wrongs:
            status, force, stiffness = function(*good[:place], wrong, *good[place + 1 :])
            assert status == place + 1
            assert (force, stiffness) == (-1, -1)
    assert function(-1e-5, *good[1:]) == (0, 0, 0)


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
def test_a_depth_of_the_whole_clearance_is_in_range(compiled, law):
    function = compiled(law, PLAIN)
    clearance = R2 - R1  # in rounded numbers 5e-5/clearance is above 1
    last = deepest_of(law)
    status, force, _ = function(5e-5 * last, R2, clearance, MODULUS)
    assert status == 0
    expected = MODULUS * clearance**2 * in_python(law, PLAIN)[0](last)
    assert force == pytest.approx(expected, rel=1e-8)


@needs_octave
def test_every_law_in_octave_is_the_law(tmp_path):
    """All in one run: an array of depths of any shape, and what is refused."""
    joint, clearance, lines, expected = Joint.from_ratios(200, 1.4), R2 / 200, [], {}
    shares = np.array([[-0.1, 0.0, 1e-9, 0.003], [0.02, 0.37, 0.8, 1.0]])
    for law in EXPORTED:
        depths = clearance * deepest_of(law) * shares
        name = FUNCTIONS.get(law, law)
        (tmp_path / f"{name}.m").write_text(export(law, "matlab", joint))
        found = in_python(law, joint)
        found = zip(found, (clearance**2, clearance), strict=True)
        expected[law] = [MODULUS * unit * of(depths / clearance) for of, unit in found]
        shown = "; ".join(" ".join(f"{x!r}" for x in row) for row in depths.tolist())
        call = f"{name}([{shown}], {R2!r}, {clearance!r}, {MODULUS!r})"
        lines += [f"[force, stiffness] = {call};", "disp(size(force))"]
        lines += ["printf('%.17g\\n', force, stiffness)"]
        for wrong in (
            "1, 1, 5e-3, 1e11",
            "1e-5, 2, 5e-3, 1e11",
            "1e-5, 1, -5e-3, 1e11",
            "1e-5, 1, 5e-3, NaN",
            "NaN, 1, 5e-3, 1e11",
        ):
            lines += [f"try, {name}({wrong}); disp('taken'), catch e, disp('refused'), end"]
    told = iter(programs.in_octave(lines, tmp_path).split("\n"))
    for law in EXPORTED:
        assert next(told).split() == ["2", "4"]
        for values in expected[law]:
            found = [float(next(told)) for _ in range(8)]
            assert found == pytest.approx(values.T.ravel().tolist(), rel=1e-9)
        assert [next(told) for _ in range(5)] == ["refused"] * 5


@pytest.mark.parametrize("joint", JOINTS)
def test_json_holds_coefficients_and_formula(joint):
    content = json.loads(export("stiffened_hertz", "json", joint))
    assert content["range"] == {"depth_star": [0, 1]}
    ds = 0.37
    u = ds**0.5 / (1 + ds**0.5)
    stiffening = sum(c * u**k for k, c in enumerate([1, *content["coefficients"]]))
    expected = contact.stiffened_hertz(ds, joint.r2_star, **joint.law_options("stiffened_hertz"))
    assert content["scale"] * ds**1.5 * stiffening == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("law", EXPORTED)
@pytest.mark.parametrize("deepest", [None, 0.3])
def test_csv_is_the_law_at_its_depths_and_says_how_to_interpolate(law, deepest):
    text = export(law, "csv", PLAIN, deepest)
    table = pd.read_csv(io.StringIO(text), comment="#")
    assert list(table.columns) == ["depth_star", "force_star", "stiffness_star"]
    last = deepest or deepest_of(law)
    assert table.depth_star.iloc[[0, -1]].tolist() == [0, last]
    force, stiffness = in_python(law, PLAIN, deepest)
    depth = table.depth_star.to_numpy()
    assert table.force_star.tolist() == pytest.approx(force(depth), rel=1e-9)
    assert table.stiffness_star[1:].tolist() == pytest.approx(stiffness(depth[1:]), rel=1e-9)
    least = last / 10 if law == "power" else 0.005
    between = np.linspace(np.sqrt(least), np.sqrt(last), 3000) ** 2
    told = [float(line.split()[-2]) / 100 for line in text.splitlines() if " adds " in line]
    root = np.sqrt(depth)
    spline = CubicHermiteSpline(root, table.force_star, 2 * root * table.stiffness_star)
    for found, bound in zip(
        (np.interp(between, depth, table.force_star), spline(np.sqrt(between))), told, strict=True
    ):
        assert np.abs(found / force(between) - 1).max() < 1.001 * bound + 1e-9


@pytest.mark.parametrize("form", formulas.DIMENSIONLESS)
@pytest.mark.parametrize("law", ["hertz", "tabulated"])
def test_every_format_states_joint_range_error_and_units(law, form):
    liner, housing = Layer(1.125, Material(5e8, 0.46)), Layer(1.5, Material(2e11, 0.3))
    text = export(law, form, Joint.from_ratios(80, layers=(liner, housing)), 0.5)
    words = ["1.125,0.0025,0.46;1.5,1,0.3", "mirror", "0.5", "E*"]
    assert all(word in text for word in words)
    assert re.search("of_solved_joint|elastic solution", text.replace("\n", " "))


@pytest.mark.parametrize("form", SUFFIXES)
def test_a_text_of_a_joint_with_dimensions_has_them(form):
    text = export(LAW_OF.get(form, "power"), form, BRONZE)
    words = re.sub(r"[^\w.+-]+", " ", text)  # whatever the comments' signs, lines and quotes
    for word in ("socket_radius 0.0125", "clearance 4e-05", "wall 0.006"):
        assert word in words
    modulus = BRONZE.composite_modulus
    assert f"{modulus:.9g}" in text or f"{float(modulus)!r}" in text


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
def test_law_in_c_of_a_joint_with_dimensions(compiled, law):
    function, last = compiled(law, BRONZE), deepest_of(law)
    force_star, stiffness_star = in_python(law, BRONZE)
    modulus = BRONZE.composite_modulus
    for share in np.linspace(-0.1, last, 23):
        status, force, stiffness = function(share * 40e-6)
        assert status == 0
        assert force == pytest.approx(modulus * 40e-6**2 * force_star(share), rel=1e-9)
        assert stiffness == pytest.approx(modulus * 40e-6 * stiffness_star(share), rel=1e-9)
    assert function(40e-6 * last * 1.01) == (1, -1, -1)


def test_csv_of_a_joint_with_dimensions_is_in_si_units():
    table = pd.read_csv(io.StringIO(export("tabulated", "csv", BRONZE)), comment="#")
    assert list(table.columns) == ["depth", "force", "stiffness"]
    law = BRONZE.law()
    assert table.force[1:].to_numpy() == pytest.approx(law.force(table.depth[1:]), rel=1e-9)
    assert table.stiffness[1:].to_numpy() == pytest.approx(law.stiffness(table.depth[1:]), rel=1e-9)


def test_power_is_fitted_in_the_range_that_is_asked_for():
    content = json.loads(export("power", "json", BRONZE, (0.01, 0.1)))
    fitted = BRONZE.power_law((0.4e-6, 4e-6))
    assert content["exponent"] == pytest.approx(fitted.exponent, rel=1e-3)
    assert content["error"]["against_solved_joint"] == pytest.approx(fitted.error, rel=0.02)
    assert content["error"]["from_depth_star"] == 0.01
    assert content["range"] == {"depth_star": [0, 0.1]}


def test_the_stated_error_is_the_laws():
    content = json.loads(export("hertz", "json", LESS, 0.4))["error"]
    depth, exact = np.linspace(0.005, 0.4, 1000), table(LESS, 0.4)
    off = np.abs(contact.hertz(depth, 75) / exact(depth) - 1).max()
    assert content["against_solved_joint"] == pytest.approx(off, rel=1e-3)
    of_table = json.loads(export("tabulated", "json", LESS, 0.4))["error"]
    assert of_table["against_solved_joint"] == 0
    curve = exact.curve
    of_force = curve.force_error[curve.depth_star > 0.005].max()
    for of in (content, of_table):
        assert of["of_solved_joint"] == pytest.approx(of_force + exact.error)


def test_tabulated_json_describes_its_joint():
    joint = Joint.from_ratios(200, 1.4, ball=Material(2e11, 0.3), socket=Material(7e10, 0.33))
    content = json.loads(export("tabulated", "json", joint))
    assert content["joint"]["socket_ratio"] == 1.4
    assert len(content["stiffening"]) == len(content["root_depth_star"]) == len(content["slope"])
    assert content["stiffening"][0] == 1


TABLE = contact.tabulated(PLAIN.curve())
PARTS = [*(LAWS[name].parts(200.0, **options) for name, options in VARIANTS), TABLE.parts(200.0)]


@pytest.mark.parametrize("parts", PARTS, ids=lambda parts: parts.shape.name)
def test_the_lines_of_a_shape_are_its_function(parts):
    table = np.reshape(parts.constants[1:], (-1, 2)) if parts.shape is shapes.tabulated else []
    for ds in (1e-6, 0.03, 0.4, 1.0):
        names = {"ds": ds, "TABLE": lambda k, column: table[k][column]}
        names["KNOT"] = lambda x: min(int(x), len(table) - 2)
        lines = "\n".join(formulas.lines(parts.shape, parts.constants))
        exec(re.sub(r"\.([*/])", r"\1", f"from math import *\n{lines}"), names)
        expected = parts.shape(ds, parts.constants)
        assert (names["value"], names["slope"]) == pytest.approx(expected, rel=1e-12)


def test_every_shape_is_that_of_a_law():
    assert {parts.shape for parts in PARTS} == {*shapes.SHAPES} - {shapes.sampled}


@pytest.mark.parametrize("form", SUFFIXES)
def test_a_name_is_that_of_function_or_element(form):
    text = export(LAW_OF.get(form, "power"), form, BRONZE, name="left_hip")
    assert "left_hip" in text
    for word in ("ball of bearing steel", "socket of bronze", "40 um"):
        assert form == "json" or word in re.sub(r"\s+[*%#!/]*\s*", " ", text)
    assert form != "json" or json.loads(text)["materials"]["ball"] == "bearing steel"
    if form in ("c", "matlab"):
        assert re.search(r"^(int|function .* =) left_hip\(", text, re.MULTILINE)


@pytest.mark.parametrize("law", ["hertz", "tabulated", "power"])
def test_two_joints_for_exudyn_share_no_name(law):
    pytest.importorskip("exudyn")
    names = []
    for name in ("left", "right"):
        module = {}
        exec(export(law, "exudyn", BRONZE, name=name), module)
        names.append({of for of, x in module.items() if getattr(x, "__module__", "") != "math"})
    shared = names[0] & names[1]
    assert shared <= {"__builtins__", "exudyn", "item"}


def test_a_function_of_matlab_has_the_name_of_its_file(run, tmp_path):
    words = ["export", "--law", "tabulated", "--format", "matlab", "--r2-star", 100]
    assert run(*words, "--output", tmp_path / "hip.m")[0] == 0
    assert re.search(r"^function .* = hip\(", (tmp_path / "hip.m").read_text())
    status, _, err = run(*words, "--output", tmp_path / "hip.m", "--name", "knee")
    assert (status, err.count("\n")) == (2, 1)
    assert "name of the function in hip.m must be one of hip, got 'knee'" in err


def test_a_power_law_along_a_displacement_off_the_axis():
    joint = replace(BRONZE, ball_support="clamped", rim="free")
    power, fit = json.loads(export("power", "json", joint, tilt=20)), joint.power_law(tilt=20)
    coefficient = power["scale"] * joint.force_unit / joint.clearance ** power["exponent"]
    assert (coefficient, power["exponent"]) == pytest.approx(fit[:2])
    words = r"20 deg off the axis; between 10 and 30 deg the .* up to (\S+) % and .* (\S+) %"
    solved = joint.solve(depth_star=[0.5] * 3, tilt=[20, 10, 30])
    told = zip(re.search(words, power["load"]).groups(), ("force", "stiffness"), strict=True)
    for percent, name in told:
        of = getattr(solved, name)
        assert float(percent) == pytest.approx(100 * np.abs(of / of[0] - 1).max(), rel=0.1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("hertz", "c", BRONZE, None, None, "2nd hip"), "name must begin with a letter .* got"),
        (("hooke", "c", PLAIN), r"law must be one of hertz, .*, tabulated, got 'hooke'"),
        (("tabulated", "xml", PLAIN), "format must be one of c, matlab, modelica, json, csv"),
        (("power", "json", PLAIN, (0.2, 0.1)), "minimum depth_star must be > 0 and < 0.1, got 0.2"),
        (("power", "json", PLAIN, (0.1, 0.2, 0.3)), "depth_star must be one depth, or the minimum"),
        (("power", "adams", PLAIN), "format of a joint without dimensions must be one of c,"),
        (("hertz", "adams", BRONZE), "law in format adams must be one of power, got 'hertz'"),
        (("hertz", "c", PLAIN, None, 20), "off the axis must be one of tabulated, power, got 'h"),
    ],
)
def test_bad_input_is_one_clear_error(arguments, message):
    with pytest.raises(ValueError, match=message):
        export(*arguments)


def test_a_narrow_socket_has_a_depth_of_its_own():
    joint = Joint.from_ratios(20, opening=40, ball_support="core:0.2")
    ends = [
        json.loads(export(law, "json", joint))["range"]["depth_star"][1]
        for law in ("hertz", "tabulated")
    ]
    assert ends[0] == ends[1] == table(joint).deepest < 1
