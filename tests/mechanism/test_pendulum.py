"""The clearance joint of the example in Exudyn: in space, and in the plane beside our stepper."""

import importlib.util

import numpy as np
import pytest
from other_programs.multibody import crank_slider

from study import paths
from study.contact import forces
from study.contact.forces import damping_factor, friction_regime
from study.joint import Joint
from study.mechanism import Scene, law_in_scene, simulate

_SPEC = importlib.util.spec_from_file_location("pendulum", paths.ROOT / "examples/pendulum.py")
PENDULUM = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(PENDULUM)
BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze").law("hertz")
FRAME = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]


@pytest.mark.parametrize("sliding", [5e-5, 5e-3, 0.2])
def test_forces_in_any_plane_are_those_of_the_plane(sliding):
    joint = PENDULUM.ClearanceJoint(BRONZE, restitution=0.5, friction=0.1)
    depth, rate, v0, v1 = 3e-6, 0.02, *PENDULUM.SPEEDS
    joint.approach = 0.05
    n, t, _ = FRAME
    place, velocity = (BRONZE.clearance + depth) * n, rate * n + sliding * t
    force, torque, found, normal = joint.forces(place, velocity, np.zeros(3))
    factor, regime = damping_factor("exact", 0.5), friction_regime(sliding, v0, v1)
    of_plane = forces.joint_forces(
        BRONZE.packed(), depth, rate, sliding, regime, 0.05, factor, 0.1, v0, v1
    )
    assert found == pytest.approx(depth, rel=1e-9)
    assert normal == pytest.approx(of_plane.normal, rel=1e-9)
    assert force == pytest.approx(-of_plane.normal * n + of_plane.tangential * t, rel=1e-9)
    assert torque == pytest.approx(
        BRONZE.ball_radius * of_plane.tangential * np.cross(n, t), abs=1e-12
    )


def test_a_contact_begins_with_its_approach_speed_and_ends_in_flight():
    joint = PENDULUM.ClearanceJoint(BRONZE, restitution=0.5)
    start, still = [BRONZE.clearance + 1e-9, 0, 0], np.zeros(3)
    joint.forces(start, [0.03, 0, 0], still)
    assert joint.approach == 0.03
    joint.forces([0.5 * BRONZE.clearance, 0, 0], still, still)
    assert np.isnan(joint.approach)


@pytest.mark.parametrize("law", ["hertz", "stiffened_hertz"])
def test_crank_slider_in_exudyn_is_ours(law):
    pytest.importorskip("exudyn")
    scene, duration = Scene(socket="bronze"), 2e-3
    ours = simulate(scene, law=law, duration=duration, outputs=200)
    joint = PENDULUM.ClearanceJoint(
        law_in_scene.in_scene(scene, law), scene.restitution, scene.friction, scene.damping
    )
    position = crank_slider(scene, joint, duration=duration)
    first, (time, depth, normal) = ours.impacts.iloc[0], np.transpose(joint.rows)
    touching = int(np.argmax(depth > 0))
    t0, t1, d0, d1 = *time[touching - 1 : touching + 1], *depth[touching - 1 : touching + 1]
    assert t0 - d0 * (t1 - t0) / (d1 - d0) == pytest.approx(first.time, rel=1e-6)
    assert normal.max() == pytest.approx(first.peak_force, rel=2e-3)
    assert depth.max() == pytest.approx(first.peak_depth, rel=1e-3)
    assert position[-1] == pytest.approx(ours.slider_position[-1], abs=1e-9)
