"""Force-depth curves against independent solutions, convergence, and mechanics."""

import itertools

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study import contact, paths
from study.elastic import HatFunctions, fem
from study.joint import Joint, Material, force_curve

REFERENCE = pd.read_csv(paths.DATA / "published" / "joint.csv")


def reference(source, r2_star, kinematics):
    rows = REFERENCE[
        REFERENCE.source.str.startswith(source)
        & (REFERENCE.r2_star == r2_star)
        & (REFERENCE.kinematics == kinematics)
    ]
    return rows.depth_star.to_numpy(), rows.force_star.to_numpy()


def test_force_is_that_of_the_exact_series():
    depth, exact = reference("Legendre", 200, "small")
    curve = force_curve(Joint(200, socket_ratio=1.2, rim="mirror"), depth)
    error = np.abs(curve.force_star / exact - 1)
    assert (error[depth >= 0.1] < 5e-4).all()
    assert error[depth == 0.05] < 3e-3
    assert (error < curve.error_estimate + 1e-4).all()  # 1e-4: trust in the series' digits


@pytest.mark.parametrize(("r2_star", "tolerance"), [(200, 5e-3), (20, 1e-2)])
def test_force_is_that_of_calculix(r2_star, tolerance):
    depth, expected = reference("CalculiX", r2_star, "linear")
    curve = force_curve(Joint(r2_star, socket_ratio=1.25, kinematics="linear"), depth)
    assert np.abs(curve.force_star / expected - 1).max() < tolerance


def test_force_converges_with_order_two():
    depth = np.linspace(0.1, 1.0, 91)  # many, as the error oscillates with the edge's place
    joint = Joint(200, socket_ratio=1.2, rim="mirror")
    forces = [force_curve(joint, depth, n).force_star for n in (32, 64, 128, 256)]
    steps = [
        np.sqrt(np.mean((coarse / fine - 1) ** 2)) for coarse, fine in itertools.pairwise(forces)
    ]
    assert (np.diff(steps) < 0).all()
    assert np.log2(steps[0] / steps[-1]) / 2 >= 2


@pytest.mark.parametrize("kinematics", ["small", "linear"])
def test_reaction_of_the_supports_balances_the_force(kinematics):
    joint = Joint(200, socket_ratio=1.2, kinematics=kinematics)
    curve = force_curve(joint, [0.05, 0.3, 1.0])
    area = 1.0 if kinematics == "small" else joint.ball_radius**2  # whose area the force acts on
    for body in (fem.socket_compliance(1.2), fem.ball_compliance()):
        reaction = joint.r2_star * area * curve.pressure @ body.reaction
        assert reaction == pytest.approx(curve.force_star, rel=1e-8)


def test_dimensionless_force_does_not_depend_on_the_modulus():
    curves = [
        force_curve(Joint(75, ball=Material(e, 0.25), socket=Material(e, 0.25)), [0.1, 0.5], 64)
        for e in (1.0, 7e10, 2e11)
    ]
    for curve in curves[1:]:
        assert curve.force_star == pytest.approx(curves[0].force_star, rel=1e-12)


def test_compliances_of_unequal_bodies_add():
    # a ball a million times stiffer leaves the socket's compliance alone, and vice versa
    stiff, soft = Material(1e12, 0.3), Material(1e6, 0.3)
    sockets = [force_curve(Joint(200, r, ball=stiff, socket=soft), 0.3, 64) for r in (1.1, 1.5)]
    balls = [force_curve(Joint(200, r, ball=soft, socket=stiff), 0.3, 64) for r in (1.1, 1.5)]
    assert sockets[0].force_star[0] > 1.2 * sockets[1].force_star[0]
    assert balls[0].force_star == pytest.approx(balls[1].force_star, rel=1e-5)


def test_small_contact_is_hertzs():
    # the ratio to Hertz tends to 1 linearly in the contact radius, that is in sqrt(depth)
    depth = np.array([2.5e-4, 1e-3, 4e-3])
    curve = force_curve(Joint(1e4, socket_ratio=2.0), depth, 256)
    excess = curve.force_star / contact.hertz(depth, 1e4) - 1
    assert (excess > 0).all()
    assert excess[1:] / excess[:-1] == pytest.approx(2, rel=0.15)
    extrapolated = 2 * excess[0] - excess[1]
    assert abs(extrapolated) < 0.01
    angle = curve.contact_half_angle / np.sqrt(depth)
    assert angle == pytest.approx(1, rel=0.03)


def test_gap_and_pressure_are_complementary():
    joint = Joint(200)
    curve = force_curve(joint, [0.1, 0.5])
    of_ball, of_socket = joint.modulus_shares
    flexibility = (
        of_ball * joint.ball_radius * fem.ball_compliance().flexibility
        + of_socket * fem.socket_compliance(joint.socket_ratio).flexibility
    )

    for depth, pressure in zip(curve.depth_star, curve.pressure, strict=True):
        e, r1 = (1 + depth) / 200, joint.ball_radius

        def rigid_gap(theta, e=e, r1=r1):
            ball = e * np.cos(theta) + np.sqrt(r1**2 - (e * np.sin(theta)) ** 2)
            return (1 - ball) * 200

        gap = HatFunctions(curve.angles).integrate(rigid_gap) + flexibility @ pressure
        scale = np.abs(gap).max()
        assert (pressure >= 0).all()
        assert gap.min() > -1e-9 * scale
        assert np.abs(gap * pressure).max() < 1e-9 * scale * pressure.max()


def test_error_estimate_covers_the_error():
    depth = np.linspace(0.025, 1, 79)
    finest = force_curve(Joint(200), depth, 256).force_star
    for n in (32, 64, 128):
        curve = force_curve(Joint(200), depth, n)
        error = np.abs(curve.force_star / finest - 1)
        assert (error <= curve.error_estimate).all()
        assert np.median(curve.error_estimate / error) < 15  # and is no wild overestimate


@settings(max_examples=25)
@given(
    r2_star=st.floats(10, 1e4),
    ratio=st.floats(1.05, 4),
    poisson=st.floats(-0.3, 0.48),
    stiffer=st.floats(0.1, 10),
    drive=st.sampled_from(fem.DRIVES),
    rim=st.sampled_from(fem.RIMS),
    kinematics=st.sampled_from(["small", "linear"]),
)
def test_any_joint_stiffens_with_depth(r2_star, ratio, poisson, stiffer, drive, rim, kinematics):
    socket = Material(2e11 * stiffer, poisson)
    joint = Joint(r2_star, ratio, Material(), socket, drive, rim, kinematics)
    curve = force_curve(joint, [0.6, 0.0, 0.2, 0.4], 32)
    order = np.argsort(curve.depth_star)
    force = curve.force_star[order]
    assert force[0] == 0
    assert (np.diff(force, 2) > 0).all()
    assert (np.diff(curve.contact_half_angle[order]) > 0).all()
    assert (np.diff(curve.peak_pressure[order]) > 0).all()
    assert (curve.error_estimate[order] < 0.1).all()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Joint(1.0), "r2_star must be > 1, got 1"),
        (lambda: Joint(200, socket_ratio=0.9), "socket_ratio must be >= 1.02, got 0.9"),
        (lambda: Joint(200, ball_drive="point"), "ball_drive must be one of plane, clamped"),
        (lambda: Joint(200, kinematics="finite"), "kinematics must be one of small, linear"),
        (lambda: Material(-1.0), "Young's modulus must be > 0 Pa, got -1 Pa"),
        (lambda: Material(poisson=float("nan")), "Poisson's ratio must be finite and > -1"),
        (lambda: force_curve(Joint(200), -0.1), "depth_star must be >= 0, got -0.1"),
        (lambda: force_curve(Joint(200), []), "depth_star must be a list of depths"),
        (lambda: force_curve(Joint(200), 0.1, 48), "resolution must be a multiple of 32"),
        (lambda: force_curve(Joint(200), 1e-9, 32), "depth_star must be 0 or so large that"),
        (lambda: force_curve(Joint(200), 20, 32), "depth_star must be < 18.97"),
        (lambda: force_curve(Joint(200, kinematics="linear"), 9, 32), "off the socket's rim"),
        (lambda: Joint("20"), "r2_star must be one number, got '20'"),
        (lambda: Joint(200, socket="steel"), "socket must be a Material, got 'steel'"),
    ],
)
def test_bad_input_is_one_clear_error(call, message):
    with pytest.raises(ValueError, match=message):
        call()
