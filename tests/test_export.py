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


JOINTS = (
    Joint(200),
    Joint(20, 1.1, Material(2e11, 0.3), Material(7e10, 0.34), "clamped"),
    Joint(1e5, 8.0, Material(2e11, 0.46), Material(2e9, 0.46), "clamped", "free"),
)


@needs_compiler
@pytest.mark.parametrize("joint", JOINTS)
def test_stiffened_hertz_in_c(compiled, joint):
    function, options = compiled("stiffened_hertz", joint), joint.stiffening_options()
    clearance = R2 / joint.r2_star
    for depth in clearance * np.random.default_rng(1).uniform(-0.1, 1, 100):
        status, force, stiffness = function(depth, clearance, MODULUS)
        assert status == 0
        arguments = "stiffened_hertz", depth, R2 - clearance, R2, MODULUS
        assert force == pytest.approx(contact.contact_force(*arguments, **options), rel=1e-9)
        assert stiffness == pytest.approx(
            contact.contact_stiffness(*arguments, **options), rel=1e-9
        )


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


@needs_compiler
@pytest.mark.parametrize("law", EXPORTED)
def test_a_depth_of_the_whole_clearance_is_in_range(compiled, law):
    joint = Joint(200)
    function = compiled(law, joint)
    clearance = R2 - R1  # in rounded numbers 5e-5/clearance is above 1
    status, force, _ = function(5e-5, clearance, MODULUS)
    assert status == 0
    assert force == pytest.approx(
        contact.contact_force("stiffened_hertz", 5e-5, R1, R2, MODULUS), rel=5e-3
    )


@pytest.mark.parametrize("joint", JOINTS)
def test_json_holds_coefficients_and_formula(joint):
    content = json.loads(export("stiffened_hertz", "json", joint))
    assert content["range"] == {"depth_star": [0, 1]}
    ds = 0.37
    u = ds**0.5 / (1 + ds**0.5)
    stiffening = 1 + sum(c * u ** (k + 1) for k, c in enumerate(content["coefficients"]))
    expected = contact.stiffened_hertz(ds, joint.r2_star, **joint.stiffening_options())
    assert content["scale"] * ds**1.5 * stiffening == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("law", EXPORTED)
def test_csv_is_the_law_at_its_depths(law):
    table = pd.read_csv(io.StringIO(export(law, "csv", Joint(200))))
    assert list(table.columns) == ["depth_star", "force_star", "stiffness_star"]
    assert table.depth_star.iloc[[0, -1]].tolist() == [0, 1]
    expected = contact.stiffened_hertz(table.depth_star.to_numpy(), 200)
    tolerance = 1e-9 if law == "stiffened_hertz" else 5e-3
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
    with pytest.raises(ValueError, match="stiffened_hertz is not for ball_drive point"):
        export("stiffened_hertz", "c", Joint(200, ball_drive="point"))
    with pytest.raises(ValueError, match="kinematics of stiffened_hertz must be one of linear"):
        export("stiffened_hertz", "csv", Joint(200, kinematics="finite"))
    with pytest.raises(ValueError, match="socket_ratio of stiffened_hertz must be >= 1.1"):
        export("stiffened_hertz", "json", Joint(200, 1.05))
