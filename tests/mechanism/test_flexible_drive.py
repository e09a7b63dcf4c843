"""Flexible links that are driven at constant speed, or start from any angle and speed."""

import numpy as np
import pytest
from helpers.with_hertz import simulate

from study.mechanism import paper_scene, particles

FLEXIBLE = ["particles", "beams"]
PAPER = paper_scene()
STIFF = PAPER.replace(link_modulus=100 * PAPER.youngs_modulus)
STARTS = [
    {"crank_speed": 30.0},
    {"crank_speed": -30.0, "initial_crank_angle": -4.0, "gravity": 9.81},
    {"initial_crank_angle": 1.0, "initial_crank_speed": 25.0, "initial_eccentricity": (1e-5, 2e-5)},
    {"initial_crank_angle": 2.0, "initial_crank_speed": -25.0, "gravity": 9.81},
]
every_model = pytest.mark.parametrize("model", FLEXIBLE)
every_start = pytest.mark.parametrize("start", STARTS)


@every_model
@every_start
@pytest.mark.parametrize("joint", ["ideal", "clearance"])
def test_first_row_is_that_of_rigid_links(model, start, joint):
    scene = STIFF.replace(**start)
    rigid, flexible = (
        simulate(scene, model=kind, joint=joint, duration=1e-5, outputs=1).rows[0]
        for kind in ("rigid", model)
    )
    names = ["crank_angle", "slider_position", "crank_speed", "slider_velocity", "coupler_angle"]
    names += ["coupler_speed", "eccentricity_x", "eccentricity_y", "depth", "kinetic"]
    assert [*flexible[names]] == pytest.approx([*rigid[names]], rel=1e-3, abs=1e-8)


@every_model
@every_start
def test_stiff_links_with_an_ideal_joint_move_as_rigid_ones(model, start):
    scene, options = STIFF.replace(**start), {"joint": "ideal", "duration": 0.02, "outputs": 200}
    rigid = simulate(scene, **options)
    flexible = simulate(scene, model=model, elements=(2, 3), **options)
    assert flexible.crank_angle == pytest.approx(rigid.crank_angle, abs=2e-5)
    assert flexible.slider_position == pytest.approx(rigid.slider_position, abs=5e-7)
    assert flexible.energy_error < 1e-6
    if "crank_speed" in start:
        speed, angle = start["crank_speed"], start.get("initial_crank_angle", 0.0)
        # the angle is a sum over tens of thousands of steps
        assert flexible.crank_angle == pytest.approx(angle + speed * flexible.time, rel=1e-10)
        assert (flexible.crank_speed == speed).all()
        assert flexible.work[-1] == pytest.approx(rigid.work[-1], rel=2e-3)


@every_model
@pytest.mark.parametrize("speed", [40.0, -40.0])
def test_moment_that_holds_the_speed_is_that_of_rigid_links_but_for_ringing(model, speed):
    scene = STIFF.replace(crank_speed=speed, initial_crank_angle=1.0, gravity=9.81)
    options = {"joint": "ideal", "duration": 0.02, "outputs": 20000}
    rigid, flexible = (
        np.convolve(simulate(scene, model=kind, **options).driving_moment, np.full(1000, 1e-3))
        for kind in ("rigid", model)
    )  # means over 1 ms, in which stiff links ring some hundred times
    assert flexible[999:-999] == pytest.approx(rigid[999:-999], abs=0.02 * np.abs(rigid).max())


@every_model
@every_start
def test_energy_balance_follows_the_step(model, start):
    scene, errors = PAPER.replace(restitution=0.9, **start), []
    for parts in (1, 4):
        step = 1e-6 if model == "beams" else particles.stable_step(scene, (2, 3)) / 4
        options = {"duration": 5e-3, "outputs": 200, "elements": (2, 3), "step": step / parts}
        errors.append(simulate(scene, model=model, **options).energy_error)
    assert errors[1] < errors[0] / 2
    assert errors[1] < 3e-5
