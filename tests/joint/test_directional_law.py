"""A law of depth and tilt against joints solved anew; as text for other programs; the choice."""

import ctypes
import io
import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from helpers import programs
from helpers.programs import needs_compiler, needs_octave
from scipy.interpolate import RegularGridInterpolator

from study import choose, contact
from study import export as exporting
from study.choose import cheapest_law
from study.joint import Joint, Layer, Material, directional_law, tilted_contact, whole_curve

NECK = Joint(200, ball_support="neck:30", opening=110)
CORE = Joint(200, ball_support="core:0.2", opening=110)
DEEPEST, TILT, RADIUS, CLEARANCE, MODULUS = 0.4, 25.0, 1e-2, 5e-5, 1.137e11


@pytest.fixture(scope="module")
def law():
    return directional_law(NECK, DEEPEST, TILT)


@pytest.fixture
def exported(law, monkeypatch):
    """Export the law that is solved already."""
    monkeypatch.setattr(exporting, "directional_law", lambda *_: law)
    return lambda form: exporting.export("tabulated", form, NECK, DEEPEST, TILT)


def places(count):
    draw = np.random.default_rng(3)
    return draw.uniform(-0.05, DEEPEST, count), draw.uniform(-TILT, TILT, count)


def test_the_table_is_within_its_error_of_joints_solved_anew(law):
    depth, tilt = (np.abs(x) for x in places(12))
    depth = np.maximum(depth, law.depth_star[0])
    solved = tilted_contact(NECK, depth, tilt)
    along, across = law.force(depth, tilt)
    off = np.hypot(along - solved.force_star, across - solved.transverse_star)
    assert (off / np.hypot(solved.force_star, solved.transverse_star)).max() < law.error < 0.025
    assert np.abs(across / along).max() > 0.05  # the neck bends: one law would not do


def test_shallower_depths_lead_to_hertz(law):
    solved = tilted_contact(NECK, [0.036], TILT)
    assert law.force(0.036, TILT)[0] == pytest.approx(solved.force_star[0], rel=0.015)
    assert law.force(1e-9, TILT)[0] == pytest.approx(contact.hertz(1e-9, 200), rel=1e-3)


def test_without_tilt_it_is_the_law_along_the_axis(law):
    depth = np.linspace(0.02, np.sqrt(DEEPEST), 100) ** 2
    along, across = law.force(depth, 0)
    axial = contact.tabulated(whole_curve(NECK, DEEPEST))
    assert along == pytest.approx(axial(depth), rel=5e-4)
    assert (across == 0).all()


def test_both_sides_of_the_axis_are_alike_and_no_depth_is_no_force(law):
    depth, tilt = places(50)
    (along, across), other = law.force(depth, tilt), law.force(depth, -tilt)
    assert np.array_equal(along, other[0])
    assert np.array_equal(across, -other[1])
    assert ((along > 0) == (depth > 0)).all()
    assert law.force([[0.1], [0.2]], [1, 2, 3])[1].shape == (2, 3)


def test_beyond_the_table_is_refused(law):
    for depth, tilt, message in (
        (0.41, 1, "depth_star must be <= 0.4, got 0.41"),
        (0.1, -26, "tilt must be >= -25 and <= 25 deg, got -26 deg"),
        ([0.1, 0.2], [1, 2, 3], "depth_star and tilt must have shapes that can be broadcast"),
    ):
        with pytest.raises(ValueError, match=message):
            law.force(depth, tilt)


@needs_compiler
def test_the_table_in_c_is_the_law(law, exported, tmp_path):
    function = programs.compiled(exported("c"), tmp_path).tabulated

    def call(*arguments):
        results = ctypes.c_double(-1), ctypes.c_double(-1)
        status = function(*map(ctypes.c_double, arguments), *map(ctypes.byref, results))
        return status, *(x.value for x in results)

    unit = MODULUS * CLEARANCE**2
    ends = [DEEPEST, DEEPEST, 1e-9], [TILT, -TILT, 0.0]
    for depth, tilt in zip(
        *(np.append(*two) for two in zip(places(200), ends, strict=True)), strict=True
    ):
        status, along, across = call(depth * CLEARANCE, tilt, RADIUS, CLEARANCE, MODULUS)
        force, transverse = law.force(depth, tilt)
        assert status == 0
        assert along == pytest.approx(unit * force, rel=1e-9)
        assert across == pytest.approx(unit * transverse, rel=1e-9, abs=1e-9 * unit * force)
    good = [1e-5, 10.0, RADIUS, CLEARANCE, MODULUS]
    wrongs = (2.1e-5, np.nan), (26.0, -26.0, np.nan), (2 * RADIUS,), (0.0, -1.0, np.nan), (0.0,)
    for place, values in enumerate(wrongs):
        for wrong in values:
            arguments = [*good[:place], wrong, *good[place + 1 :]]
            assert call(*arguments) == (place + 1, -1, -1)


@needs_octave
def test_the_table_in_octave_is_the_law(law, exported, tmp_path):
    (tmp_path / "tabulated.m").write_text(exported("matlab"))
    depth, tilt = places(20)
    depths, tilts = (" ".join(f"{x!r}" for x in row.tolist()) for row in (depth * CLEARANCE, tilt))
    lines = [f"[a, b] = tabulated([{depths}], [{tilts}], {RADIUS!r}, {CLEARANCE!r}, {MODULUS!r});"]
    lines += ["printf('%.17g\\n', a, b)"]
    for wrong in ("1, 1", "1e-6, 30", "[1e-6 0 0], [1 2]"):
        wrong += f", {RADIUS!r}, {CLEARANCE!r}, 1e11"
        lines += [f"try, tabulated({wrong}); disp('taken'), catch e, disp('refused'), end"]
    *numbers, first, second, third = programs.in_octave(lines, tmp_path).split()
    expected = MODULUS * CLEARANCE**2 * np.ravel(law.force(depth, tilt))
    assert [float(x) for x in numbers] == pytest.approx(expected.tolist(), rel=1e-9)
    assert [first, second, third] == ["refused"] * 3


def test_csv_is_the_law_and_says_how_to_interpolate(law, exported):
    text = exported("csv")
    table = pd.read_csv(io.StringIO(text), comment="#")
    assert list(table.columns) == ["depth_star", "tilt", "force_star", "transverse_star"]
    along, across = law.force(table.depth_star, table.tilt)
    assert table.force_star.to_numpy() == pytest.approx(along, rel=1e-9)
    assert table.transverse_star.to_numpy() == pytest.approx(across, rel=1e-9)
    assert (table.depth_star.iloc[-1], table.tilt.iloc[-1]) == (DEEPEST, TILT)
    (told,) = (float(line.split()[-2]) / 100 for line in text.splitlines() if " adds " in line)
    over = (table.force_star / table.depth_star**1.5).to_numpy()
    depths, tilts = table.depth_star.unique(), table.tilt.unique()
    read = RegularGridInterpolator((np.sqrt(depths), tilts), over.reshape(len(depths), -1))
    depth, tilt = (np.abs(x) for x in places(500))
    off = read((np.sqrt(depth), tilt)) * depth**1.5 / law.force(depth, tilt)[0] - 1
    assert 0.3 * told < np.abs(off).max() < 1.1 * told


@pytest.mark.parametrize("form", ["c", "matlab", "csv"])
def test_the_text_states_joint_ranges_units_and_error(law, exported, form):
    text = " ".join(exported(form).replace("\n% ", " ").replace("\n * ", " ").split())
    words = ["neck:30", "opening 110", "0 to 0.4 clearances", "tilts from -25 to 25 deg", "E*"]
    assert all(
        word in text for word in [*words, "socket_support outside", exporting._percent(law.error)]
    )


def test_by_the_rule_one_law_serves_a_ball_on_its_core():
    found = choose.axial_law_suffices(CORE, 0.1, 20, 0.01)
    assert found == choose.OffAxis(True, cheapest_law.OF_RULE, "rule")


def test_a_neck_is_measured_and_needs_the_table():
    found = choose.axial_law_suffices(NECK, DEEPEST, 20, 0.05)
    assert (found.one_law_for_all_directions, found.known_by) == (False, "measured")
    assert 0.15 < found.direction_error < 0.25
    assert choose.axial_law_suffices(NECK, DEEPEST, 2, 0.05).one_law_for_all_directions


@pytest.mark.parametrize(
    "unlike",
    [
        {"socket_support": "rim"},
        {"ball_support": "clamped", "opening": 90.0},
        {"layers": (Layer(1.1, Material(2e9, 0.46)), Layer(1.3, Material()))},
    ],
)
def test_the_rule_is_not_for_a_joint_that_differs_all_round(unlike, monkeypatch):
    def solved(*_):
        raise InterruptedError

    monkeypatch.setattr(cheapest_law, "tilted_contact", solved)
    joint = replace(CORE, **unlike)
    with pytest.raises(InterruptedError):
        choose.axial_law_suffices(joint, 0.1, 20, 0.01)


@pytest.mark.parametrize("drive", ["guided", "centre"])
def test_a_ball_that_is_free_across_the_axis_is_refused(drive):
    joint = Joint(200, ball_support=drive)
    for call in (
        lambda: choose.axial_law_suffices(joint, 0.3, 20, 0.05),
        lambda: exporting.export("tabulated", "c", joint, tilt=20),
    ):
        with pytest.raises(ValueError, match=f"ball is free across the axis, got {drive}"):
            call()


def test_the_command_says_it_in_words_and_in_json(run):
    words = ["choose", "--r2-star", "200", "--depth-star", "0.4", "--tolerance", "0.05"]
    words += ["--ball-support", "neck:30", "--opening", "110", "--tilt", "20"]
    (status, text, _), (_, out, _) = run(*words), run(*words, "--json")
    assert status == 0
    said = json.loads(out)
    assert said["one_law_for_all_directions"] is False
    assert 0.15 < said["direction_error"] < 0.25
    assert said["known_by"] == "measured"
    assert "not known to be accurate enough for all tilts up to 20 deg" in text
    assert "\nstudy export --law tabulated --tilt 20 --format c --rim free --r2-star 200" in text


@pytest.mark.parametrize(
    ("supports", "what"),
    [
        ({"ball_support": "core:0.2"}, "ball_support core:0.2"),
        ({"ball_support": "clamped", "opening": 70.0}, "an opening of 70 deg"),
        ({"socket_support": "rim"}, "socket_support rim"),
    ],
)
def test_stiffened_hertz_is_not_for_other_supports(supports, what):
    joint = Joint(200, **supports)
    with pytest.raises(ValueError, match=f"stiffened_hertz is not valid for {what}"):
        joint.correction_options()
