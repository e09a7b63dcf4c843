"""The whole curve at once, against contacts solved one by one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study import contact
from study.joint import Joint, Material, UnresolvedError, force_curve, paper_joint, whole_curve

DEPTHS = np.array([0.002, 0.01, 0.1, 0.4, 0.7, 1.0])
SOFT = {"ball": Material(2e11, 0.3), "socket": Material(2e9, 0.45)}


@pytest.mark.parametrize(
    "joint",
    [Joint(200), Joint(20, 1.1), Joint(40, 2.0, **SOFT), Joint(1e4, 10, kinematics="small")],
)
def test_whole_curve_is_that_of_the_finest_contacts(joint):
    law = contact.tabulated(whole_curve(joint))
    finest = force_curve(joint, DEPTHS, 960)
    assert np.abs(law(DEPTHS) / finest.force_star - 1).max() < 1e-4


def test_whole_curve_by_finite_elements():
    curve = whole_curve(paper_joint(60), 0.5)
    one_by_one = force_curve(curve.joint, curve.depth_star[10::6])
    difference = np.abs(curve.force_star[10::6] / one_by_one.force_star - 1)
    assert (difference < 1.5 * one_by_one.error_estimate).all()
    assert curve.depth_star[-1] >= 0.5


def test_contact_ends_where_it_is_said_to_and_estimates_hold():
    joint = Joint(100, 1.2)
    coarse, fine = whole_curve(joint, resolution=160), whole_curve(joint, resolution=640)
    law = contact.tabulated(fine)
    inside = (coarse.depth_star >= fine.depth_star[0]) & (coarse.depth_star <= 1)
    error = np.abs(coarse.force_star[inside] / law(coarse.depth_star[inside]) - 1)
    assert (error < np.maximum(coarse.error_estimate[inside], 1e-5)).all()
    for angle, pressure in zip(
        np.radians(coarse.contact_half_angle_deg), coarse.pressure, strict=True
    ):
        assert (pressure[coarse.angles >= angle] == 0).all()
        assert (pressure[coarse.angles < 0.98 * angle] > 0).all()
    one_by_one = force_curve(joint, coarse.depth_star[::8], 320)
    assert coarse.peak_pressure_star[::8] == pytest.approx(one_by_one.peak_pressure_star, rel=0.01)


@pytest.mark.parametrize("modulus", [1e-8, 1e-2, 1e8])  # of a rigid ball to a rigid socket
def test_pressure_has_no_ripples_where_the_surfaces_nodes_move_past_each_other(modulus):
    curve = whole_curve(Joint(20, 1.3, Material(1.0), Material(modulus)))
    inner = curve.pressure[20::6, 2:60]
    assert (curve.peak_pressure_star[20::6] < 1.03 * inner[:, :10].mean(axis=1)).all()
    assert (np.abs(np.diff(inner, axis=1)) < 0.04 * inner[:, :-1]).all()


@given(
    share=st.floats(0, 1),
    nu=st.tuples(*2 * [st.floats(0.0, 0.48)]),
    ratio=st.floats(1.05, 10),
    r2_star=st.floats(10, 1e5),
)
@settings(max_examples=25, deadline=None)
def test_force_grows_from_that_of_hertz(share, nu, ratio, r2_star):
    modulus = 10.0 ** (8 * share - 4)
    joint = Joint(r2_star, ratio, Material(1e9, nu[0]), Material(1e9 * modulus, nu[1]))
    curve = whole_curve(joint, 0.3, 128)
    assert (np.diff(curve.depth_star) > 0).all()
    assert (np.diff(curve.force_star) > 0).all()
    stiffening = curve.force_star / contact.hertz(curve.depth_star, r2_star)
    assert (stiffening > 0.98).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: whole_curve(Joint(200), 20), "deepest must be < 18.97"),
        (lambda: whole_curve(Joint(20), 5), "rim of the socket .* got 5"),
        (lambda: whole_curve(Joint(200), 1e-4), "deepest must be .* contact of >= 16 elements"),
    ],
)
def test_whole_curve_refuses(call, message):
    with pytest.raises((ValueError, UnresolvedError), match=message):
        call()
