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
from study.contact.damping import damping_factor, delivered_restitution
from study.contact.friction import friction_regime
from study.joint import Joint
from study.mechanism import Scene, simulate
from study.mechanism.spatial import ClearanceJoint, solve

R1, R2, MODULUS = 9.95e-3, 10e-3, 1.137e11
LOSSES = {"restitution": 0.5, "friction": 0.05}
IN_THE_PLANE = {"damping": "lankarani-nikravesh", "tension": True}
ENERGIES = ["kinetic", "potential", "elastic", "lost_damping", "lost_friction"]


BRONZE = Joint(12.5e-3, 40e-6, 6e-3, "steel", "bronze")


def clearance_joint(law="hertz", **changes):
    """A joint in space of a law, by default with what the mechanism in the plane has."""
    return ClearanceJoint(joint_law(law), **(IN_THE_PLANE | changes))


def joint_law(law):
    sizes = {"ball_radius": R1, "socket_radius": R2, "composite_modulus": MODULUS}
    return contact.DimensionalLaw(law, **sizes)


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
    depth, sliding = 5.01e-5 - joint.law.clearance, 0.004 + R1 * 0.1
    regime = friction_regime(sliding, 1e-4, 0.01)
    factor = damping_factor("lankarani-nikravesh", 0.5)
    motion = 0.03, sliding, regime, 0.06, factor, 0.05, 1e-4, 0.01
    expected = forces.joint_forces(joint.law.packed(), depth, *motion)
    assert normal == pytest.approx(expected.normal, rel=1e-12)
    assert force == pytest.approx([-normal, expected.tangential, 0], rel=1e-12)
    assert torque == pytest.approx([0, 0, R1 * expected.tangential], rel=1e-12)
    assert damping == pytest.approx((normal - expected.elastic) * 0.03, rel=1e-12)
    assert friction == pytest.approx(-expected.tangential * sliding, rel=1e-12)


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
    place = np.array([joint.law.clearance + 1.01 * joint.deepest, 0, 0])
    with pytest.raises(StudyError, match="winkler must stay <= 6.1685e-05 m, got 6.23019e-05 m"):
        joint.forces(place, np.zeros(3), np.zeros(3))


def test_bad_joint_is_one_clear_error():
    for changes, message in (
        ({"law": "hertz"}, "law must be a DimensionalLaw, got 'hertz'"),
        ({"tension": "yes"}, "tension must be True or False, got 'yes'"),
        ({"friction": -1}, "friction must be >= 0, got -1"),
        ({"slow_speed": 0.1}, "slow speed must be >= 0 and < 0.01 m/s, got 0.1 m/s"),
    ):
        with pytest.raises(ValueError, match=message):
            ClearanceJoint(**({"law": BRONZE.law("hertz")} | changes))


def at_rest(joint, depth, **motion):
    """Forces at a depth in m, along a skew normal, with velocity and spin along it."""
    normal = np.array([2, -1, 2]) / 3
    velocity, spin = (motion.get(name, 0.0) * normal for name in ("velocity", "spin"))
    joint.approach = motion.get("approach", 0.02)
    force, torque, *numbers = joint.forces((joint.law.clearance + depth) * normal, velocity, spin)
    assert np.cross(force, normal) == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.cross(torque, normal) == pytest.approx(np.zeros(3), abs=1e-12)
    return torque @ normal, *numbers


def test_the_force_pulls_as_published_or_is_cut_off():
    """Eq. 31 pulls where the ball leaves faster than the approach speed over D."""
    published, cut = clearance_joint(**LOSSES), clearance_joint(**LOSSES, tension=False)
    elastic = at_rest(cut, 1e-6)[1]
    for rate in (-0.05, -0.01, 0.02):
        expected = elastic * (1 + damping_factor("lankarani-nikravesh", 0.5) * rate / 0.02)
        motion = {"velocity": rate, "spin": 100.0}
        of_published, of_cut = (at_rest(joint, 1e-6, **motion) for joint in (published, cut))
        assert of_published[1] == pytest.approx(expected, rel=1e-9)
        if expected < 0:
            assert of_cut[:2] == (0, 0)  # nor friction
            assert of_published[0] == 0
            assert of_cut[2:] == (pytest.approx(-elastic * rate, rel=1e-9), 0)
        else:
            assert of_cut == pytest.approx(of_published, rel=1e-12)
            assert of_cut[0] < 0 < of_cut[3]
    assert expected > elastic


def test_spin_about_the_load_has_friction():
    """3 pi/16 mu N a under Hertz's pressure; nothing below the slow speed, half way up to full."""
    joint, depth = clearance_joint(friction=0.2), 2e-6
    radius = 3 * np.pi / 16 * np.sqrt(R1 * R2 / (R2 - R1) * depth)
    for speed, share in ((0.5e-4, 0), (5.05e-3, 0.5), (-5.05e-3, -0.5), (0.02, 1), (-0.02, -1)):
        torque, normal, _, lost = at_rest(joint, depth, spin=speed / radius)
        assert torque == pytest.approx(-0.2 * normal * radius * share, rel=1e-6)
        assert lost == pytest.approx(-torque * speed / radius, rel=1e-6)
    assert clearance_joint().forces(*np.eye(3) * [5.1e-5, 1, 1])[1] == pytest.approx(np.zeros(3))


@pytest.mark.parametrize("law", [None, "stiffened_hertz"])
def test_friction_radius_is_that_of_the_joints_solved_pressure(law):
    joint = ClearanceJoint(BRONZE if law is None else BRONZE.law(law), friction=0.1)
    solved = BRONZE.solve(depth=[2e-7, 4.19e-6, 35e-6])
    for depth, torque in zip(solved.depth, solved.friction_torque(0.1)["spin"], strict=True):
        found, normal, *_ = at_rest(joint, depth, spin=-1e3)
        assert normal == pytest.approx(joint.law.force(depth), rel=1e-9)
        assert found == pytest.approx(torque, rel=4e-3)
    hertz = 3 * np.pi / 16 * np.sqrt(joint.law.ball_radius * 312.5 * 35e-6) * 0.1 * normal
    assert found > 1.05 * hertz
    with pytest.raises(StudyError, match=r"must stay <= 4(\.\d+)?e-05 m, got 5e-05 m"):
        at_rest(joint, 5e-5)


def test_a_law_without_limit_reaches_as_deep_as_the_solved_pressure_if_there_is_friction():
    law = BRONZE.law("hertz")
    assert ClearanceJoint(law).deepest == np.inf
    assert ClearanceJoint(law, friction=0.1).deepest == pytest.approx(BRONZE.law().deepest)
    assert clearance_joint(friction=0.1).deepest == np.inf


@pytest.mark.parametrize("restitution", [0.001, 0.3, 0.9, 1.0])
def test_the_default_damping_delivers_the_restitution_asked_for(restitution):
    joint = ClearanceJoint(BRONZE, restitution=restitution)
    assert joint.delivered_restitution == pytest.approx(restitution, rel=1e-6)
    place, speed, step = joint.law.clearance, 0.1, 1e-8
    for _ in range(200_000):  # a ball of 0.1 kg
        speed -= step / 0.1 * joint.forces(*np.array([[place, 0, 0], [speed, 0, 0], [0, 0, 0]]))[2]
        place += step * speed
        if place <= joint.law.clearance:
            break
    assert -speed / 0.1 == pytest.approx(restitution, abs=2e-3)
    of_rule = clearance_joint(restitution=0.5)
    assert of_rule.delivered_restitution == pytest.approx(
        delivered_restitution(damping_factor("lankarani-nikravesh", 0.5))
    )


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


def test_pendulum_on_a_joint_with_dimensions_balances(exudyn):
    """Without tension, damped by the exact rule, with friction radii of its solved pressure."""
    table = pendulum(ClearanceJoint(BRONZE, **LOSSES), duration=0.01, step=1e-6)
    assert (table.depth > 0).any()
    assert (table.normal_force >= 0).all()
    assert balance(table) < 1e-4


def test_a_ball_under_load_spins_down_by_its_friction(exudyn):
    """Its angular velocity about the load falls by mu N r/J a second."""
    from exudyn import itemInterface as item  # noqa: N813
    from exudyn.utilities import RigidBodyInertia

    joint, load, inertia = ClearanceJoint(BRONZE, friction=0.1), 3e3, 1e-4
    system = exudyn.SystemContainer().AddSystem()
    body = system.CreateRigidBody(
        inertia=RigidBodyInertia(mass=1.0, inertiaTensor=inertia * np.eye(3), com=[0, 0, 0]),
        nodeType=exudyn.NodeType.RotationRotationVector,
        initialDisplacement=[0, 0, -joint.law.clearance - joint.law.depth(load)],
        initialAngularVelocity=[0, 0, 50.0],
        gravity=[0, 0, -load],
    )
    pair = [
        system.AddMarker(item.MarkerBodyRigid(bodyNumber=number))
        for number in (system.AddObject(item.ObjectGround()), body)
    ]
    joint.connect(system, *pair)
    system.Assemble()
    solve(system, integration(1e-3, 1e-6, 1e-3), solverType=exudyn.DynamicSolverType.RK44)
    kind = exudyn.OutputVariableType.AngularVelocity
    spin = system.GetObjectOutputBody(body, kind, localPosition=[0, 0, 0])
    torque = BRONZE.solve(force=load).friction_torque(0.1)["spin"][0]
    assert 50.0 - spin[2] == pytest.approx(1e-3 * torque / inertia, rel=3e-3)
    lost = inertia * (50.0**2 - spin[2] ** 2) / 2
    assert joint.history().lost_friction.iloc[-1] == pytest.approx(lost, rel=1e-4)


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
    with pytest.raises(ValueError, match="crank_speed does not apply to this model"):
        crank_slider(Scene(crank_speed=10.0), duration=1e-3)


def test_a_step_longer_than_the_pendulums_motion_is_refused(exudyn):
    with pytest.raises(ValueError, match="step must be > 0 and <= 0.02 s, got 1 s"):
        pendulum(clearance_joint(), step=1.0)


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
        start = [joint.law.clearance + depth, 0, 0]
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
