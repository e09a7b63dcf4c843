"""Exported laws are the laws: C compiled and compared, JSON and CSV read back."""

import ctypes
import io
import json
import shutil
import subprocess

import numpy as np
import pandas as pd
import pytest

from study import contact
from study import export as module
from study.export import EXPORTED, export
from study.joint import Joint, Material

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler found")
R1, R2, MODULUS = 9.95e-3, 10e-3, 1.137e11


@pytest.fixture(autouse=True, scope="module")
def solved_once():
    """Curves of joints by their arguments: several tests export the same joint."""
    curves, solve = {}, module.force_curve

    def force_curve(joint, depths, **options):
        key = joint, tuple(depths), *options.items()
        if key not in curves:
            curves[key] = solve(joint, depths, **options)
        return curves[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "force_curve", force_curve)
        yield


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
@pytest.mark.parametrize("kinematics", ["linear", "finite"])
def test_stiffened_hertz_in_c(compiled, kinematics):
    function = compiled("stiffened_hertz", Joint(200, kinematics=kinematics))
    draw = np.random.default_rng(1)
    for _ in range(200):
        clearance, ratio = R2 / 20 ** draw.uniform(1, 4), draw.uniform(1.1, 3)
        poisson, depth = draw.uniform(0.2, 0.45), clearance * draw.uniform(-0.1, 1)
        options = {"socket_ratio": ratio, "poisson": poisson, "kinematics": kinematics}
        arguments = depth, R2 - clearance, R2, MODULUS
        status, force, stiffness = function(*arguments, ratio, poisson)
        assert status == 0
        expected = contact.contact_force("stiffened_hertz", *arguments, **options)
        assert force == pytest.approx(expected, rel=1e-9)
        expected = contact.contact_stiffness("stiffened_hertz", *arguments, **options)
        assert stiffness == pytest.approx(expected, rel=1e-9)


@needs_compiler
def test_stiffened_hertz_in_c_refuses_what_is_out_of_range(compiled):
    function = compiled("stiffened_hertz", Joint(200))
    good = [1e-5, R1, R2, MODULUS, 1.2, 0.3]
    for place, wrong in enumerate((6e-5, -1.0, 9e-3, 0.0, 1.05, 0.5)):
        status, force, stiffness = function(*good[:place], wrong, *good[place + 1 :])
        assert status == place + 1
        assert (force, stiffness) == (-1, -1)
    assert function(float("nan"), *good[1:])[0] == 1
    assert function(good[0], float("nan"), *good[2:])[0] == 2
    assert function(*good[:3], float("inf"), *good[4:])[0] == 4


@needs_compiler
def test_tabulated_law_in_c(compiled):
    joint = Joint(200, 1.4, Material(2e11, 0.3), Material(7e10, 0.33))
    function = compiled("tabulated", joint)
    table = pd.read_csv(io.StringIO(export("tabulated", "csv", joint)))
    clearance = 5e-5
    for row in table.itertuples():
        status, force, stiffness = function(row.depth_star * clearance, clearance, MODULUS)
        assert status == 0
        assert force == pytest.approx(MODULUS * clearance**2 * row.force_star, rel=1e-9)
        assert stiffness == pytest.approx(MODULUS * clearance * row.stiffness_star, rel=1e-9)
    for place, wrong in enumerate(((6e-5, 5e-5, 1.0), (1e-6, 0.0, 1.0), (1e-6, 5e-5, 0.0))):
        assert function(*wrong)[0] == place + 1


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
def test_a_depth_of_the_whole_clearance_is_in_range(compiled, law):
    joint = Joint(200)
    function = compiled(law, joint)
    clearance = R2 - R1  # in rounded numbers 5e-5/clearance is above 1
    radii = (
        (R1, R2, MODULUS, contact.SOCKET_RATIO, 0.3)
        if law == "stiffened_hertz"
        else (clearance, MODULUS)
    )
    status, force, _ = function(5e-5, *radii)
    assert status == 0
    assert force == pytest.approx(
        contact.contact_force("stiffened_hertz", 5e-5, R1, R2, MODULUS), rel=8e-3
    )


def test_json_holds_coefficients_ranges_and_formula():
    content = json.loads(export("stiffened_hertz", "json", Joint(200, kinematics="finite")))
    assert np.array(content["limit"]).shape == (5, 9)
    assert content["range"]["socket_ratio"] == [1.1, 3]
    r2_star, q, nu, ds = 50, 1.7, 0.41, 0.37
    t = np.outer([1, 1 / q, q**-4], [1, nu, 1 / (1 - 1.8 * nu)]).ravel()
    matrix = np.array(content["limit"]) + np.array(content["first_order"]) / r2_star
    a1, a2, b1, b2, b3 = matrix @ t
    u = ds**0.5 / (ds**0.5 + 0.6 * (q - 1))
    stiffening = 1 + a1 * u + a2 * u**2 + b1 * ds + b2 * ds**2 + b3 * ds**3
    options = {"socket_ratio": q, "poisson": nu, "kinematics": "finite"}
    expected = contact.stiffened_hertz(ds, r2_star, **options)
    assert contact.hertz(ds, r2_star) * stiffening == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("law", EXPORTED)
def test_csv_is_the_law_at_its_depths(law):
    table = pd.read_csv(io.StringIO(export(law, "csv", Joint(200))))
    assert list(table.columns) == ["depth_star", "force_star", "stiffness_star"]
    assert table.depth_star.iloc[[0, -1]].tolist() == [0, 1]
    expected = contact.stiffened_hertz(table.depth_star.to_numpy(), 200)
    tolerance = 1e-9 if law == "stiffened_hertz" else 8e-3
    assert table.force_star.iloc[8:].tolist() == pytest.approx(expected[8:], rel=tolerance)


def test_tabulated_json_describes_its_joint():
    joint = Joint(200, 1.4, Material(2e11, 0.3), Material(7e10, 0.33))
    content = json.loads(export("tabulated", "json", joint))
    assert content["joint"]["socket_ratio"] == 1.4
    assert len(content["stiffening"]) == len(content["root_depth_star"]) == len(content["slope"])
    assert content["stiffening"][0] == 1


def test_bad_input_is_one_clear_error():
    with pytest.raises(ValueError, match="law must be one of stiffened_hertz, tabulated"):
        export("hertz", "c", Joint(200))
    with pytest.raises(ValueError, match="format must be one of c, json, csv"):
        export("tabulated", "xml", Joint(200))
    with pytest.raises(ValueError, match="materials of ball and socket must be equal"):
        export("stiffened_hertz", "c", Joint(200, socket=Material(7e10)))
    with pytest.raises(ValueError, match="ball_drive of stiffened_hertz must be one of plane"):
        export("stiffened_hertz", "csv", Joint(200, ball_drive="clamped"))
    with pytest.raises(ValueError, match="rim of stiffened_hertz must be one of mirror"):
        export("stiffened_hertz", "json", Joint(200, rim="free"))
