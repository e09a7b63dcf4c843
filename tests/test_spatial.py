"""The spherical clearance joint in Exudyn: in space, and in the plane beside our own stepper."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from other_programs.multibody import crank_slider, integration
from other_programs.pendulum import pendulum

from study import contact
from study.checks import StudyError
from study.contact import forces
from study.contact.friction import friction_branch
from study.mechanism import Scene, simulate
from study.mechanism.spatial import ClearanceJoint, solve

R1, R2, MODULUS = 9.95e-3, 10e-3, 1.137e11
LOSSES = {"restitution": 0.5, "friction": 0.05}
ENERGIES = ["kinetic", "potential", "elastic", "lost_damping", "lost_friction"]


def clearance_joint(law="hertz", **changes):
    return ClearanceJoint(R1, R2, MODULUS, law, **changes)


def turned(vector):
    """A vector in another frame of reference."""
    c, s = np.cos(1.1), np.sin(1.1)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array(vector)[[2, 0, 1]]


def test_forces_in_the_plane_are_those_of_the_mechanism():
    joint = clearance_joint(**LOSSES)
    place, velocity, spin = (
        np.array([5.01e-5, 0, 0]),
        np.array([0.03, 0.004, 0]),
        np.array([0, 0, 0.1]),
    )
    joint.approach = 0.06
    force, torque, normal, damping, friction = joint.forces(place, velocity, spin)
    depth, sliding = 5.01e-5 - joint.clearance, 0.004 + R1 * 0.1
    branch = friction_branch(sliding, 1e-4, 0.01)
    motion = 0.03, sliding, branch, 0.06, joint.damping_factor, 0.05, 1e-4, 0.01
    expected = forces.joint_forces(joint.law, depth, *motion)
    assert normal == pytest.approx(expected[0], rel=1e-12)
    assert force == pytest.approx([-normal, expected[5], 0], rel=1e-12)
    assert torque == pytest.approx([0, 0, R1 * expected[5]], rel=1e-12)
    assert damping == pytest.approx((normal - expected[3]) * 0.03, rel=1e-12)
    assert friction == pytest.approx(-expected[5] * sliding, rel=1e-12)


def test_forces_do_not_depend_on_the_frame_of_reference():
    joint = clearance_joint("steuermann", **LOSSES)
    vectors = np.array([3.1e-5, 3e-5, 3e-5]), np.array([0.01, -0.02, 0.04]), np.array([1, 2, 3.0])
    joint.approach = 0.06
    force, torque, *numbers = joint.forces(*vectors)
    force_too, torque_too, *numbers_too = joint.forces(*map(turned, vectors))
    assert force_too == pytest.approx(turned(force), rel=1e-9)
    assert torque_too == pytest.approx(turned(torque), rel=1e-9)
    assert numbers_too == pytest.approx(numbers, rel=1e-9)
    assert not joint.forces(0.5 * vectors[0], *vectors[1:])[0].any()


@pytest.mark.parametrize("rate", [0.0, -0.01])
def test_contact_that_begins_without_approach_is_not_damped(rate):
    joint, place = clearance_joint(restitution=0.5), np.array([5.01e-5, 0, 0])
    elastic = clearance_joint().forces(place, np.zeros(3), np.zeros(3))[2]
    for speed in (rate, 0.03):  # the approach speed is that of the first evaluation
        _, _, normal, damping, _ = joint.forces(place, np.array([speed, 0, 0]), np.zeros(3))
        assert (normal, damping) == (elastic, 0)
    joint._note(0.0, place, np.zeros(3), np.zeros(3))
    assert np.isnan(joint.history().approach_speed[0])


def test_depth_beyond_the_law_is_one_clear_error():
    joint = clearance_joint("hyperbolic_winkler")
    place = np.array([joint.clearance + 1.01 * joint.deepest, 0, 0])
    with pytest.raises(StudyError, match="winkler must stay <= 6.1685e-05 m, got 6.23019e-05 m"):
        joint.forces(place, np.zeros(3), np.zeros(3))


def test_bad_joint_is_one_clear_error():
    for changes, message in (
        ({"law": "hooke"}, "law must be one of hertz"),
        ({"law": "stiffened_hertz"}, "stiffened_hertz in SI units must be given socket_ratio"),
        ({"restitution": 1.1}, "restitution must be >= 0 and <= 1, got 1.1"),
        ({"friction": -1}, "friction must be >= 0, got -1"),
        ({"full_speed": "x"}, "full speed must be one number, got 'x'"),
        ({"full_speed": 0.0}, "full speed must be > 0 m/s, got 0 m/s"),
        ({"slow_speed": [1e-4, 1e-3]}, "slow speed must be one number"),
        ({"slow_speed": 0.1}, "slow speed must be >= 0 and < 0.01 m/s, got 0.1 m/s"),
    ):
        with pytest.raises(ValueError, match=message):
            clearance_joint(**changes)


@pytest.fixture
def exudyn():
    return pytest.importorskip("exudyn")


def balance(table):
    total = table[ENERGIES].sum(axis=1)
    return np.ptp(total) / np.ptp(table[ENERGIES].to_numpy(), axis=0).max()


def test_pendulum_in_space_keeps_energy_and_spin_without_losses(exudyn):
    table = pendulum(clearance_joint())
    assert (np.diff((table.depth > 0).astype(int)) == 1).sum() >= 3  # impacts
    assert balance(table) < 1e-5
    assert np.ptp(table.spin_z) < 1e-10 * table.spin_z[0]  # the force meets the socket's centre
    assert np.abs(table.y).max() > 1e-3  # it left the plane
    assert not table[["lost_damping", "lost_friction"]].any(axis=None)


def test_pendulum_with_losses_balances_with_order_2(exudyn):
    tables = [pendulum(clearance_joint(**LOSSES), step=step) for step in (4e-6, 2e-6, 1e-6)]
    errors = [balance(table) for table in tables]
    assert errors[-1] < 2e-5
    assert all(3 < coarse / fine < 5 for coarse, fine in pairwise(errors))
    last = tables[-1].iloc[-1]
    assert min(last.lost_damping, last.lost_friction) > 1e-6
    assert (np.diff(tables[-1].lost_damping) > -1e-12).all()


@pytest.mark.parametrize(
    ("law", "options"),
    [
        ("hertz", {}),
        ("stiffened_hertz", {"socket_ratio": 1.5}),
        (lambda ds, r2: 300 * ds**1.5, {}),
    ],
)
def test_crank_slider_in_exudyn_is_ours(exudyn, law, options):
    scene, duration = Scene(socket="bronze"), 2e-3
    ours = simulate(scene, law=law, duration=duration, outputs=200, **options)
    theirs = crank_slider(scene, law, duration=duration, **options)
    first, touching = ours.impacts.iloc[0], int(np.argmax(theirs.depth > 0))
    (t0, d0), (t1, d1) = theirs[["time", "depth"]].to_numpy()[touching - 1 : touching + 1]
    assert t0 - d0 * (t1 - t0) / (d1 - d0) == pytest.approx(first.time, rel=1e-6)
    assert theirs.approach_speed[touching] == pytest.approx(first.approach_speed, rel=1e-3)
    assert theirs.normal_force.max() == pytest.approx(first.peak_force, rel=2e-3)
    assert theirs.depth.max() == pytest.approx(first.peak_depth, rel=1e-3)
    last = theirs.iloc[-1]
    assert last.time == pytest.approx(duration, rel=1e-12)
    assert last.slider_position == pytest.approx(ours.slider_position[-1], abs=1e-9)
    assert last.lost_damping + last.lost_friction == pytest.approx(first.lost, rel=2e-3)


def test_what_exudyns_crank_slider_has_not_is_refused(exudyn):
    for name, value in (("crank_speed", 10.0), ("gravity", 9.81), ("crank_clearance", 1e-5)):
        with pytest.raises(ValueError, match=f"{name.replace('_', ' ')} must be left out: this"):
            crank_slider(Scene(**{name: value}), duration=1e-3)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"step": 1.0}, "step must be > 0 and <= 0.02 s, got 1 s"),
        ({"duration": 0.0}, "duration must be > 0 s, got 0 s"),
        ({"length": 0.0}, "length must be > 0 m, got 0 m"),
        ({"mass": -1.0}, "mass must be > 0 kg, got -1 kg"),
        ({"tilt": np.nan}, "tilt must be finite"),
        ({"precession": "x"}, "precession must be one number, got 'x'"),
    ],
)
def test_bad_pendulum_is_one_clear_error(exudyn, given, message):
    with pytest.raises(ValueError, match=message):
        pendulum(clearance_joint(), **given)


def test_pendulum_begins_the_joints_history_anew(exudyn):
    joint = clearance_joint(**LOSSES)
    tables = [pendulum(joint, duration=3.2e-3, step=1e-5) for _ in range(2)]
    assert (tables[0].depth > 0).iloc[-1]  # the first run ends in a contact
    pd.testing.assert_frame_equal(*tables)


def test_ball_that_goes_too_deep_in_exudyn_is_one_clear_error(exudyn):
    with pytest.raises(StudyError, match="^depth of hyperbolic_winkler must stay <="):
        pendulum(clearance_joint("hyperbolic_winkler"), mass=1e9, precession=100.0)


def test_two_joints_of_one_system_are_both_noted(exudyn):
    from exudyn import itemInterface as item  # noqa: N813
    from exudyn.utilities import InertiaSphere

    system = exudyn.SystemContainer().AddSystem()
    ground = system.AddObject(item.ObjectGround())
    joints, depths = [clearance_joint(), clearance_joint()], [1e-6, 2e-6]
    for joint, depth in zip(joints, depths, strict=True):
        start = [joint.clearance + depth, 0, 0]
        body = system.CreateRigidBody(
            inertia=InertiaSphere(0.1, 0.01),
            nodeType=exudyn.NodeType.RotationRotationVector,
            initialDisplacement=start,
        )
        pair = [
            system.AddMarker(item.MarkerBodyRigid(bodyNumber=number)) for number in (ground, body)
        ]
        joint.connect(system, *pair)
    with pytest.raises(ValueError, match="joint must be connected once, got it twice"):
        joints[0].connect(system, *pair)
    system.Assemble()
    settings = integration(1e-5, 1e-6, 1e-6)
    solve(system, settings, solverType=exudyn.DynamicSolverType.RK44)
    for joint, depth in zip(joints, depths, strict=True):
        assert joint.history().depth[0] == pytest.approx(depth, rel=1e-9)
        assert len(joint.rows) == 11


def test_the_laws_force_is_the_one_of_si_units():
    joint = clearance_joint(lambda ds, r2: 300 * ds**1.5)
    depth = np.array([5.02e-5, 0, 0])
    force = joint.forces(depth, np.zeros(3), np.zeros(3))[2]
    law = contact.JointLaw(
        lambda ds, r2: 300 * ds**1.5, ball_radius=R1, socket_radius=R2, composite_modulus=MODULUS
    )
    assert force == pytest.approx(law.force(5.02e-5 - joint.clearance), rel=1e-12)
