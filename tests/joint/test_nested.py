"""The whole curve at once, against contacts solved one by one."""

import numpy as np
import pytest

from study import contact
from study.joint import (
    Joint,
    Material,
    complementarity,
    kinematics,
    nested,
    reference_joint,
    series,
)

DEPTHS = np.array([0.002, 0.01, 0.1, 0.4, 0.7, 1.0])
SOFT = {"modulus_ratio": 0.01, "socket_poisson": 0.45}


@pytest.mark.parametrize(
    "joint",
    [
        Joint.from_ratios(200),
        Joint.from_ratios(20, 1.1),
        Joint.from_ratios(40, 2.0, **SOFT),
        Joint.from_ratios(1e4, 10, kinematics="small"),
    ],
)
def test_whole_curve_is_that_of_the_finest_contacts(joint):
    law = contact.Table.of_curve(joint.curve())
    finest = joint.solve(depth_star=DEPTHS, resolution=960)
    assert np.abs(law(DEPTHS) / finest.force_star - 1).max() < 1e-4
    slope = law(DEPTHS, derivative=True)
    assert np.abs(slope / finest.stiffness_star - 1).max() < 2e-3


def test_whole_curve_by_finite_elements():
    curve = reference_joint(60).curve(0.5)
    one_by_one = curve.joint.solve(depth_star=curve.depth_star[10::6])
    difference = np.abs(curve.force_star[10::6] / one_by_one.force_star - 1)
    assert (difference < 1.5 * one_by_one.error_estimate).all()
    assert curve.depth_star[-1] >= 0.5


def test_contact_ends_where_it_is_said_to_and_estimates_hold():
    joint = Joint.from_ratios(100, 1.2)
    coarse, fine = joint.curve(resolution=160), joint.curve(resolution=640)
    law = contact.Table.of_curve(fine)
    inside = (coarse.depth_star >= fine.depth_star[0]) & (coarse.depth_star <= 1)
    error = np.abs(coarse.force_star[inside] / law(coarse.depth_star[inside]) - 1)
    assert (error < np.maximum(coarse.error_estimate[inside], 1e-5)).all()
    for angle, pressure in zip(coarse.contact_half_angle_deg, coarse.pressure_star, strict=True):
        assert (pressure[coarse.angle_deg >= angle] == 0).all()
        assert (pressure[coarse.angle_deg < 0.98 * angle] > 0).all()
    one_by_one = joint.solve(depth_star=coarse.depth_star[::8], resolution=320)
    assert coarse.peak_pressure_star[::8] == pytest.approx(one_by_one.peak_pressure_star, rel=0.01)


@pytest.mark.parametrize("of", ["small", "linear"])
@pytest.mark.parametrize(
    ("socket", "ratio"), [(Material(), 1.2), (Material(2e9, 0.49), 1.05), (Material(2e13, 0.2), 3)]
)
def test_contact_grown_from_the_pole_is_that_found_by_pivoting(of, socket, ratio):
    joint = Joint.from_ratios(30, ratio, socket=socket, kinematics=of)
    bodies = [series.compliance(body, 64) for body in (joint.ball_body, joint.socket_body)]
    problem, axial = kinematics.problem_of(joint, *bodies)
    for depth in (0.02, 0.2, 0.5):
        contacts = nested.NestedContacts(joint, *bodies, 2.0, np.array([depth]))
        pressure = contacts.pressure(depth)
        matrix, parts = problem(depth)
        expected, _ = complementarity.solve(matrix, depth ** np.arange(3) @ parts)
        assert pressure == pytest.approx(expected, abs=1e-9 * expected.max())
        # the force at a node's closure depth is that of the contact that ends there
        at, force = contacts.depth, joint.r2_star * pressure @ axial
        assert contacts.force[at < depth].max() < force < contacts.force[at >= depth].min()


@pytest.mark.parametrize("modulus", [1e-8, 1e-2, 1e8])  # of a rigid ball to a rigid socket
def test_pressure_has_no_ripples_where_the_surfaces_nodes_move_past_each_other(modulus):
    curve = Joint.from_ratios(20, 1.3, modulus_ratio=modulus).curve()
    inner = curve.pressure_star[20::6, 2:60]
    assert (curve.peak_pressure_star[20::6] < 1.03 * inner[:, :10].mean(axis=1)).all()
    assert (np.abs(np.diff(inner, axis=1)) < 0.04 * inner[:, :-1]).all()
