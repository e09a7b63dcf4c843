"""Exported laws are the laws: C compiled, MATLAB run in Octave, JSON and CSV read back."""

import ctypes
import io
import json
import shutil
import subprocess

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import CubicHermiteSpline

from study import contact
from study.contact import LAWS
from study.export import SUFFIXES, export, formulas
from study.joint import Joint, Layer, Material, whole_curve

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
OCTAVE = shutil.which("octave-cli") or shutil.which("octave")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler found")
needs_octave = pytest.mark.skipif(OCTAVE is None, reason="GNU Octave is not installed")
R1, R2, MODULUS = 9.95e-3, 10e-3, 1.137e11
EXPORTED = [*LAWS, "tabulated"]
UNEQUAL = Joint(20, 1.1, Material(2e11, 0.3), Material(7e10, 0.34), "clamped", "free")
JOINTS = (
    Joint(200),
    UNEQUAL,
    Joint(1e5, 8.0, Material(2e11, 0.46), Material(2e9, 0.46)),
)


def in_python(law, joint, deepest=1.0):
    """Dimensionless force and stiffness, of depths."""
    function = LAWS.get(law) or contact.tabulated(whole_curve(joint, deepest))
    options = joint.correction_options() if law == "stiffened_hertz" else {}
    return [
        lambda ds, derivative=derivative: function(
            ds, joint.r2_star, derivative=derivative, **options
        )
        for derivative in (False, True)
    ]


@pytest.fixture
def compiled(tmp_path):
    """Compile an exported law without any warning; returns a function of its arguments."""

    def compiled(law, joint):
        source, library = tmp_path / "law.c", tmp_path / "law.so"
        source.write_text(export(law, "c", joint))
        words = ["-std=c89", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-fPIC"]
        subprocess.run([COMPILER, *words, source, "-o", library, "-lm"], check=True)
        function = getattr(ctypes.CDLL(library), law)

        def call(*arguments):
            force, stiffness = ctypes.c_double(-1), ctypes.c_double(-1)
            inputs = [ctypes.c_double(x) for x in arguments]
            status = function(*inputs, ctypes.byref(force), ctypes.byref(stiffness))
            return status, force.value, stiffness.value

        return call

    return compiled


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
@pytest.mark.parametrize("joint", JOINTS[:2])
def test_law_in_c_is_the_law(compiled, law, joint):
    function, (force_star, stiffness_star) = compiled(law, joint), in_python(law, joint)
    clearance = R2 / joint.r2_star
    for depth in clearance * np.random.default_rng(1).uniform(-0.1, 1, 100):
        status, force, stiffness = function(depth, clearance, MODULUS)
        assert status == 0
        expected = MODULUS * clearance**2 * force_star(depth / clearance)
        assert force == pytest.approx(expected, rel=1e-9)
        expected = MODULUS * clearance * stiffness_star(depth / clearance)
        assert stiffness == pytest.approx(expected, rel=1e-9)


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
def test_law_in_c_refuses_what_is_out_of_range(compiled, law):
    function = compiled(law, Joint(200))
    good = [1e-5, 5e-5, MODULUS]
    for place, wrongs in enumerate(((6e-5, np.nan), (-1.0, 0.0, np.nan), (0.0, np.inf))):
        for wrong in wrongs:
            status, force, stiffness = function(*good[:place], wrong, *good[place + 1 :])
            assert status == place + 1
            assert (force, stiffness) == (-1, -1)
    assert function(-1e-5, *good[1:]) == (0, 0, 0)


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
def test_a_depth_of_the_whole_clearance_is_in_range(compiled, law):
    function = compiled(law, Joint(200))
    clearance = R2 - R1  # in rounded numbers 5e-5/clearance is above 1
    status, force, _ = function(5e-5, clearance, MODULUS)
    assert status == 0
    expected = MODULUS * clearance**2 * in_python(law, Joint(200))[0](1.0)
    assert force == pytest.approx(expected, rel=1e-8)


@needs_octave
def test_every_law_in_octave_is_the_law(tmp_path):
    """All in one run: an array of depths of any shape, and what is refused."""
    joint, clearance, lines, expected = Joint(200, 1.4), R2 / 200, [], {}
    depths = clearance * np.array([[-0.1, 0.0, 1e-9, 0.003], [0.02, 0.37, 0.8, 1.0]])
    for law in EXPORTED:
        (tmp_path / f"{law}.m").write_text(export(law, "matlab", joint))
        found = zip(in_python(law, joint), (clearance**2, clearance), strict=True)
        expected[law] = [MODULUS * unit * of(depths / clearance) for of, unit in found]
        shown = "; ".join(" ".join(f"{x!r}" for x in row) for row in depths.tolist())
        call = f"{law}([{shown}], {clearance!r}, {MODULUS!r})"
        lines += [f"[force, stiffness] = {call};", "disp(size(force))"]
        lines += ["printf('%.17g\\n', force, stiffness)"]
        for wrong in ("1, 1e-3, 1e11", "1e-5, -1, 1e11", "1e-5, 5e-5, NaN", "NaN, 5e-5, 1e11"):
            lines += [f"try, {law}({wrong}); disp('taken'), catch e, disp('refused'), end"]
    script = tmp_path / "compare_laws.m"
    script.write_text("\n".join(lines))
    words = [OCTAVE, "--quiet", "--no-init-file", "--no-gui", str(script)]
    done = subprocess.run(words, cwd=tmp_path, check=True, capture_output=True, text=True)
    assert "warning" not in done.stderr
    told = iter(done.stdout.split("\n"))
    for law in EXPORTED:
        assert next(told).split() == ["2", "4"]
        for values in expected[law]:
            found = [float(next(told)) for _ in range(8)]
            assert found == pytest.approx(values.T.ravel().tolist(), rel=1e-9)
        assert [next(told) for _ in range(4)] == ["refused"] * 4


@pytest.mark.parametrize("joint", JOINTS)
def test_json_holds_coefficients_and_formula(joint):
    content = json.loads(export("stiffened_hertz", "json", joint))
    assert content["range"] == {"depth_star": [0, 1]}
    ds = 0.37
    u = ds**0.5 / (1 + ds**0.5)
    stiffening = sum(c * u**k for k, c in enumerate([1, *content["coefficients"]]))
    expected = contact.stiffened_hertz(ds, joint.r2_star, **joint.correction_options())
    assert content["scale"] * ds**1.5 * stiffening == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("law", EXPORTED)
@pytest.mark.parametrize("deepest", [None, 0.3])
def test_csv_is_the_law_at_its_depths_and_says_how_to_interpolate(law, deepest):
    text = export(law, "csv", Joint(200), deepest)
    table = pd.read_csv(io.StringIO(text), comment="#")
    assert list(table.columns) == ["depth_star", "force_star", "stiffness_star"]
    last = deepest or 1
    assert table.depth_star.iloc[[0, -1]].tolist() == [0, last]
    force, stiffness = in_python(law, Joint(200), last)
    depth = table.depth_star.to_numpy()
    assert table.force_star.tolist() == pytest.approx(force(depth), rel=1e-9)
    assert table.stiffness_star[1:].tolist() == pytest.approx(stiffness(depth[1:]), rel=1e-9)
    between = np.linspace(np.sqrt(0.005), np.sqrt(last), 3000) ** 2
    told = [float(line.split()[-2]) / 100 for line in text.splitlines() if " adds " in line]
    root = np.sqrt(depth)
    spline = CubicHermiteSpline(root, table.force_star, 2 * root * table.stiffness_star)
    for found, bound in zip(
        (np.interp(between, depth, table.force_star), spline(np.sqrt(between))), told, strict=True
    ):
        assert np.abs(found / force(between) - 1).max() < 1.001 * bound + 1e-9


@pytest.mark.parametrize("form", SUFFIXES)
@pytest.mark.parametrize("law", ["hertz", "tabulated"])
def test_every_format_states_joint_range_error_and_units(law, form):
    liner, housing = Layer(1.125, Material(5e8, 0.46)), Layer(1.5, Material(2e11, 0.3))
    text = export(law, form, Joint(80, layers=(liner, housing)), 0.5)
    words = ["1.125:0.0025:0.46;1.5:1:0.3", "mirror", "0.5", "E*", "solved"]
    assert all(word in text for word in words)


def test_the_stated_error_is_the_laws():
    joint = Joint(75, 1.4)
    content = json.loads(export("hertz", "json", joint, 0.4))
    depth = np.linspace(0.005, 0.4, 1000)
    exact = contact.tabulated(whole_curve(joint, 0.4))(depth)
    off = np.abs(contact.hertz(depth, 75) / exact - 1).max()
    assert content["error"]["against_solved_joint"] == pytest.approx(off, rel=1e-3)
    table = json.loads(export("tabulated", "json", joint, 0.4))["error"]
    assert table["against_solved_joint"] == 0
    assert 0 < table["of_solved_joint"] < 1e-3


def test_tabulated_json_describes_its_joint():
    joint = Joint(200, 1.4, Material(2e11, 0.3), Material(7e10, 0.33))
    content = json.loads(export("tabulated", "json", joint))
    assert content["joint"]["socket_ratio"] == 1.4
    assert len(content["stiffening"]) == len(content["root_depth_star"]) == len(content["slope"])
    assert content["stiffening"][0] == 1


def test_every_shape_of_a_law_has_its_formula():
    for law in LAWS.values():
        _, shape, constants = law.parts(200.0)
        assert formulas.words(shape)
        text = formulas.text("c", shape, constants, "", **FILLED)
        assert text.index("    value = ") < text.index("    slope = ")


FILLED = dict.fromkeys(("law", "title", "source", "deepest", "margin", "scale"), "1")


def test_bad_input_is_one_clear_error():
    with pytest.raises(ValueError, match=r"law must be one of hertz, .*, tabulated, got 'hooke'"):
        export("hooke", "c", Joint(200))
    with pytest.raises(ValueError, match="format must be one of c, matlab, json, csv"):
        export("tabulated", "xml", Joint(200))
    with pytest.raises(ValueError, match="stiffened_hertz is not for ball_drive point"):
        export("stiffened_hertz", "c", Joint(200, ball_drive="point"))
    with pytest.raises(ValueError, match="kinematics of stiffened_hertz must be one of linear"):
        export("stiffened_hertz", "csv", Joint(200, kinematics="finite"))
    with pytest.raises(ValueError, match="socket_ratio of stiffened_hertz must be >= 1.1"):
        export("stiffened_hertz", "json", Joint(200, 1.05))
    with pytest.raises(ValueError, match="depth_star of stiffened_hertz must be <= 1, got 2"):
        export("stiffened_hertz", "json", Joint(200), 2.0)
    with pytest.raises(ValueError, match="depth_star must be > 0, got 0"):
        export("hertz", "json", Joint(200), 0.0)


@pytest.mark.parametrize("law", ["hertz", "tabulated"])
def test_a_socket_little_larger_than_its_clearance_has_a_depth_of_its_own(law):
    """At R2* = 2 the contact would be at the rim before one clearance."""
    _, deepest = json.loads(export(law, "json", Joint(2)))["range"]["depth_star"]
    assert 0.5 < deepest < 0.73
