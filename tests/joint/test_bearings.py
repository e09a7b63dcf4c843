"""Bearings of catalogues: joints from their words, pressures and laws of their rings."""

import numpy as np
import pytest

from study import Joint
from study.joint import bearings

GE_40 = {"bearing": "GE 40 ES", "ball_diameter": "52.4mm", "play": "60um"}


def test_words_of_a_catalogue_are_those_of_the_joint():
    sizes = {"bore": "20mm", "outer_diameter": "35mm", "inner_width": "16mm", "outer_width": 0.012}
    joint = Joint.of(**sizes, ball_diameter="29mm", play="61µm", socket="bearing steel")
    assert joint == Joint.of(bearing="GE 20 E")
    assert joint.ball_radius == pytest.approx(14.5e-3)
    assert joint.clearance == pytest.approx(30.5e-6)
    assert joint.socket_radius + joint.wall == pytest.approx(17.5e-3)
    assert joint.opening.first + joint.opening.last == 180
    width = 2 * joint.socket_radius * np.cos(np.radians(joint.opening.first))
    assert width == pytest.approx(12e-3, rel=1e-7)
    assert joint.ball_support.radius == pytest.approx(10 / 14.5)
    assert np.cos(np.radians(joint.ball_support.face)) == pytest.approx(8 / 14.5)


@pytest.mark.parametrize(
    ("name", "play"),
    [("GE 20 E", 61), ("ge20es", 61), ("GE 20 DO-2RS", 61), ("GE 20 ES/C3", 103), ("GE20EC2", 25)],
)
def test_names_of_a_bearing_and_the_play_of_its_class(name, play):
    assert Joint.of(bearing=name).clearance == pytest.approx(play / 2 * 1e-6)


def test_a_given_value_replaces_that_of_the_bearing():
    bearing = Joint.of(bearing="GE 20 E")
    assert Joint.of(bearing="GE 20 E", play="40um").clearance == pytest.approx(20e-6)
    assert Joint.of(bearing="GE 20 E", ball_support="core:0.5").ball_support.radius == 0.5
    assert Joint.of(bearing="GE 20 E", wall="5mm").wall == 5e-3
    assert Joint.of(bearing="GE 20 E", socket="bronze").ball == bearing.ball


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"clearance": "61um"}, "clearance must not be given with bearing; give play"),
        ({"play": "61"}, r"play must be < 0\.029 m, got 61 m"),
    ],
)
def test_a_radial_clearance_and_a_missing_unit_are_errors(values, message):
    with pytest.raises(ValueError, match=message):
        Joint.of(bearing="GE 20 E", **values)


def test_the_table_is_one_of_rings_around_balls():
    for row in bearings.table():
        for low, high in (("c2_min", "c2_max"), ("normal_min", "normal_max"), ("c3_min", "c3_max")):
            assert 0 < row[low] < row[high] < 1e-3
        assert row["bore"] < row["ball_diameter"] < row["outer_diameter"]
        assert row["outer_width"] < row["inner_width"]
        assert Joint.of(bearing=row["name"]).default_tilt == 90


def test_specific_load_and_pressure_at_the_middle_of_a_ring():
    """The catalogue has 500 kN over 22 mm and 52.4 mm, which is 434 MPa."""
    joint = Joint.of(**GE_40)
    found, fine = (joint.solve(force=[5e3, 500e3], resolution=n) for n in (48, 80))
    assert found.specific_load[1] == pytest.approx(433.7e6, rel=1e-4)
    assert found.specific_load_star * joint.pressure_unit == pytest.approx(found.specific_load)
    assert found.peak_at_rim.tolist() == [False, True]
    assert found.tilt.tolist() == found.peak_angle_deg.tolist() == [90, 90]
    assert found.transverse.tolist() == [0, 0]
    assert found.peak_pressure[1] == pytest.approx(737e6, rel=3e-3)
    off = np.abs(found.peak_pressure / fine.peak_pressure - 1)
    assert (off <= found.peak_error).all()
    assert found.peak_error[1] < 0.01
    assert "the pressure at the middle of the contact" in found.limits[1]["rim"]
    assert "rim" not in found.limits[0]


def test_a_range_around_depths_needs_depths():
    joint = Joint.of(bearing="GE20E")
    assert joint.depths_around([3e-6, 5e-6]) == (1.5e-6, 1e-5)
    assert joint.depths_around(20e-6) == (1e-5, 3.05e-5)  # one clearance
    for depth, message in (([], "got none"), (-1e-6, "must be > 0 m"), (np.nan, "finite")):
        with pytest.raises(ValueError, match=message):
            joint.depths_around(depth)


@pytest.mark.parametrize(
    ("tilt", "pressure", "angle"), [(60, 12.41e6, 63.6), (70, 15.44e6, 76.3), (80, 35.05e6, 90)]
)
def test_the_pressure_of_a_soft_cup_is_bounded_at_its_rim(tilt, pressure, angle):
    """It is 35.08, 35.06 and 35.03 MPa at the rim with 32, 48 and 64 elements at 80 deg."""
    hip = Joint(14.1e-3, 100e-6, 8e-3, "CoCr", "UHMWPE", ball_support="core:0.5")
    found = hip.solve(force=2e3, tilt=tilt)
    assert found.reaches_rim[0]
    assert not found.peak_at_rim[0]
    assert found.peak_pressure[0] == pytest.approx(pressure, rel=5e-3)
    assert found.peak_angle_deg[0] == pytest.approx(angle, abs=1.5)
    assert found.peak_error[0] < 0.03


@pytest.mark.parametrize(("size", "percent"), [(8, 7.9), (12, 8.5), (20, 8.6), (30, 9.0)])
def test_errors_of_the_power_law_from_a_twentieth_to_half_a_clearance(size, percent):
    error = Joint.of(bearing=f"GE {size} E").power_law().error
    assert 100 * error == pytest.approx(percent, abs=0.06)
