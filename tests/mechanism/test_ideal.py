"""The ideal joint with friction, against the clearance joint, balances and the frictionless one."""

import numpy as np
import pytest
from helpers.with_hertz import simulate

from study.mechanism import MechanismError, Scene, compare, paper_scene

ROUGH = {"joint": "ideal_with_friction"}
PAPER = paper_scene()


def test_it_is_the_limit_of_the_clearance_joint():
    differences = []
    for clearance in (5e-5, 5e-6, 5e-7):
        scene = PAPER.replace(clearance=clearance)
        runs = simulate(scene, law="hertz"), simulate(scene, **ROUGH)
        differences.append(compare.motion_nrms(*runs, "slider_position"))
    assert np.divide(differences[:-1], differences[1:]) == pytest.approx(10, rel=0.1)
    assert differences[-1] < 2e-5
    ideal = compare.motion_nrms(runs[0], simulate(scene, joint="ideal"), "slider_position")
    assert ideal > 50 * differences[-1]  # friction does change this motion


def test_without_friction_it_is_the_ideal_joint():
    scene = PAPER.replace(friction=0.0, gravity=9.81)
    rough, smooth = (simulate(scene, joint=joint) for joint in (ROUGH["joint"], "ideal"))
    assert np.array_equal(rough.rows, smooth.rows)
    assert not np.array_equal(rough.rows, simulate(scene.replace(friction=0.05), **ROUGH).rows)


@pytest.mark.parametrize(
    "changed",
    [{}, {"gravity": 9.81}, {"crank_speed": 30.0}, {"driving_moment": -2.0, "friction": 0.4}],
)
def test_the_energy_balance_contains_the_work_of_friction(changed):
    response = simulate(PAPER.replace(**changed), duration=0.2, **ROUGH)
    assert response.energy_error < 1e-11
    lost = response.rows["lost_friction"]
    assert (np.diff(lost) >= 0).all()
    assert lost[-1] > 1e-3 * np.ptp(response.kinetic)


def test_friction_and_force_move_slider_and_coupler():
    scene = PAPER.replace(gravity=9.81, coupler_inertia=4e-4, friction=0.3)
    r = simulate(scene, duration=0.05, outputs=2000, **ROUGH)
    assert r.force_x == pytest.approx(scene.slider_mass * r.slider_acceleration, rel=1e-12)
    # Coulomb's friction of a ball that slides fast, against its motion
    sliding = abs(scene.ball_radius * r.coupler_speed)
    full = sliding > scene.full_speed
    ratio = abs(r.tangential_force) / r.normal_force
    assert full.mean() > 0.5
    assert ratio[full] == pytest.approx(0.3, rel=1e-12)
    assert (r.tangential_force * r.coupler_speed <= 0).all()
    size = np.hypot(r.force_x, r.force_y)
    assert size == pytest.approx(np.hypot(r.normal_force, r.tangential_force), rel=1e-12)
    # the coupler's centre and its turning, by differences of the simulated motion
    cos, sin = np.cos(r.coupler_angle), np.sin(r.coupler_angle)
    moved = r.slider_position - 0.06 * cos, -0.06 * sin, r.coupler_angle
    ax, ay, turning = (np.gradient(np.gradient(q, r.time), r.time) for q in moved)
    fx, fy = scene.coupler_mass * ax + r.force_x, scene.coupler_mass * (ay + 9.81) + r.force_y
    of_forces = -0.06 * cos * (fy + r.force_y) + 0.06 * sin * (fx + r.force_x)
    moment = of_forces + scene.ball_radius * r.tangential_force
    inside = slice(20, -20)
    assert moment[inside] == pytest.approx(4e-4 * turning[inside], abs=1e-3)
    assert np.abs(scene.ball_radius * r.tangential_force[inside]).max() > 0.01


def test_too_much_friction_locks_the_joint():
    scene = Scene(friction=1.0, socket_radius=0.2)
    with pytest.raises(MechanismError, match="a friction of 1 locks a ball of radius 0.19995 m"):
        simulate(scene, duration=0.2, **ROUGH)


@pytest.mark.parametrize("model", ["particles", "beams"])
def test_flexible_links_have_no_such_joint(model):
    with pytest.raises(ValueError, match=f"clearance or ideal for model {model}, got ideal_with"):
        simulate(PAPER, model=model, duration=1e-3, **ROUGH)
