"""Wrong inputs of scenes, simulations and comparisons, and what the message of each says."""

import re
from dataclasses import replace

import numpy as np
import pytest
from helpers.with_hertz import simulate

from study import contact, mechanism
from study.joint import Joint, Material
from study.measure import explicit
from study.mechanism import MechanismError, Scene, compare, paper_scene
from study.mechanism.law_in_scene import of_name

PAPER = paper_scene()
BRONZE, STEEL = Material(1.1e11, 0.34), Material(2.07e11, 0.3)
MIXED = paper_scene(socket=BRONZE)
SIZES = {name: getattr(PAPER, name) for name in ("ball_radius", "socket_radius")}
BRIEF = {"duration": 2e-3, "outputs": 20}


def with_law(scene=MIXED, modulus=PAPER.composite_modulus, **sizes):
    law = contact.DimensionalLaw("hertz", composite_modulus=modulus, **SIZES | sizes)
    return simulate(scene, law=law, **BRIEF)


def with_table(scene=MIXED, deepest=1.0, **joint):
    curve = Joint.from_ratios(200, **joint).solve(depth_star=deepest * np.linspace(0.1, 1, 12) ** 2)
    return simulate(scene, law=contact.Table.of_curve(curve), **BRIEF)


def at_two_times():
    return (simulate(joint="ideal", duration=1e-3, outputs=n) for n in (10, 20))


SOFT = Scene(poisson=0.1)
LIGHT = PAPER.replace(slider_mass=1e-40)
FALLING = Scene(gravity=1e6, driving_moment=0.0)  # it turns by gravity alone
OTHER = replace(BRONZE, poisson=0.3)
STEADY = PAPER.replace(crank_speed=10.0)
INPUTS = [
    # at most the length of the coupler less the clearance
    (lambda: Scene(crank_length=0.11996), "crank_length must be < 0.11995 m, got 0.11996 m"),
    (lambda: Scene(slow_speed=0.1), "slow_speed must be < 0.01 m/s, got 0.1 m/s"),
    (lambda: Scene(initial_eccentricity=(3e-5, 4e-5)), "initial_eccentricity must be < 5e-05 m"),
    (lambda: Scene(youngs_modulus=210), "youngs_modulus must be >= 100000 Pa, got 210 Pa: did you"),
    (lambda: PAPER.replace(coupler_inertia=1e-4).link("coupler"), "link must be >= 0.000252"),
    (lambda: explicit.integrate(STEADY, None, 1e-4, 10, 1e-6, "RK4"), "crank_speed does not apply"),
    # options of a simulation
    (lambda: simulate(step=1e-6), "step does not apply to model rigid with joint clearance"),
    (lambda: simulate(joint="ideal", tolerance=1e-6), "tolerance does not apply to model rigid"),
    (lambda: simulate(model="beams", method="lagged"), "method does not apply to model beams"),
    (lambda: simulate({}), "scene must be a Scene, got {}"),
    (lambda: simulate(LIGHT, model="particles", duration=1e-3), "limit must be >= 1e-13 s, got "),
    (lambda: simulate(Scene(crank_length=1e-9)), "turns within the duration must be <= 1e+06"),
    (lambda: simulate(FALLING, duration=1e3), "must be <= 1e+06 rad, got 4.47214e+06 rad"),
    # laws of other joints and materials
    (
        lambda: with_law(ball_radius=9e-3),
        "clearance in m of the law must be 5e-05",
    ),
    (lambda: with_law(modulus=1e11), "composite modulus E* in Pa of the law must be 8.04"),
    (with_table, "modulus_ratio of the law must be 0.531400966, that of the mechanism"),
    (lambda: with_table(ball=STEEL, socket=OTHER), "socket_poisson of the law must be 0.34, that"),
    (lambda: with_table(Scene(socket_radius=20e-3)), "must be 200, that of the joint of the law "),
    (lambda: with_table(PAPER, 0.25), "up to a depth of one clearance, but the law tabulated is"),
    (lambda: mechanism.simulate(SOFT, **BRIEF), "got 0.1; use the law tabulated"),
    # sockets that a scene cannot have
    (lambda: of_name(MIXED, "hertz", socket_ratio=1.3), "does not apply to the law hertz; remove"),
    (lambda: of_name(MIXED, "hooke", wall=3e-3), "law must be one of hertz, "),
    (lambda: of_name(MIXED, wall=3e-3, socket_ratio=1.3), "must not both be given"),
    (lambda: of_name(MIXED, socket_ratio=0.9), "wall must be >= 1e-06 and <= 9999.99 m, got -0.0"),
    (lambda: of_name(MIXED, liner="PTFE"), "liner must be a thickness and a material, for example"),
    # comparisons
    (lambda: compare.agreement(*at_two_times()), "must have the same output times"),
    (lambda: compare.motion_nrms(*at_two_times(), "crank_angle"), "reference and response must "),
]


@pytest.mark.parametrize(("call", "message"), INPUTS, ids=[message for _, message in INPUTS])
def test_wrong_input(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()


@pytest.mark.parametrize("model", ["rigid", "particles", "beams"])
def test_too_deep_a_contact_says_when(model):
    soft = PAPER.replace(youngs_modulus=1e6, driving_moment=25.0, link_modulus=2e11)
    message = r"depth must stay <= one clearance \(5e-05 m\); .* stopped at 0.0\d+ s "
    with pytest.raises(MechanismError, match=message):
        simulate(soft, model=model, elements=None if model == "rigid" else (2, 4))


def test_lagged_velocity_in_stiff_damping_says_when_and_what_limit():
    message = r"the step must stay <= 3.8\d\de-06 s, the stability limit; .* stopped at 0.01"
    with pytest.raises(MechanismError, match=message):
        simulate(model="particles", method="lagged", step=3.9e-6, elements=(2, 4))
