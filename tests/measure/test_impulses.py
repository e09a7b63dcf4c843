"""Time steps with impulses on a rigid contact, as physics engines take them."""

import numpy as np
import pytest
from helpers.with_hertz import simulate

from study.measure import explicit, impulses
from study.measure.explicit import EX, EX_RATE, EY, EY_RATE, OMEGA, THETA
from study.mechanism import paper_scene, rigid

PAPER = paper_scene()
SLIPPERY = PAPER.replace(friction=0.0)


def slider_of(scene, y):
    height = y[EY] - scene.crank_length * np.sin(y[THETA])
    return (
        scene.crank_length * np.cos(y[THETA]) + np.sqrt(scene.coupler_length**2 - height**2) - y[EX]
    )


def energy_of(scene, y):
    """Kinetic energy of the links and the slider."""
    p = scene.constants()
    state = np.append(y, np.zeros(3))
    motion = rigid.motion(
        state, rigid.ContactState(False, 0, np.inf), p, explicit.packed(scene, "hertz")
    )
    pose, omega = motion.pose, y[OMEGA]
    kinetic = p.a11 * omega**2 + p.a22 * pose.psi**2 + p.m3 * pose.speed**2
    cosine = pose.ct * pose.cp + pose.st * pose.sp
    return kinetic / 2 + p.a12 * cosine * omega * pose.psi


def first_contact(scene, step):
    """State before the first step with an impulse, and after it, and the force of this step."""
    steps = round(2e-3 / step)
    forces, _ = impulses.integrate(scene, 2e-3, steps)
    first = np.flatnonzero(forces)[0]
    states = [impulses.integrate(scene, n * step, n)[1] for n in (first, first + 1)]
    return *states, forces[first]


def test_first_impact_has_the_restitution_and_the_impulse_of_the_contact_law():
    step = 1e-7
    before, after, force = first_contact(PAPER, step)
    n = before[[EX, EY]] / np.hypot(*before[[EX, EY]])
    approach, separation = before[[EX_RATE, EY_RATE]] @ n, -after[[EX_RATE, EY_RATE]] @ n
    impact = simulate(PAPER, duration=2e-3, outputs=10, tolerance=1e-10).impacts.iloc[0]
    assert approach == pytest.approx(impact.approach_speed, rel=2e-3)
    assert separation / approach == pytest.approx(PAPER.delivered_restitution, rel=1e-3)
    mass = 1 / rigid.inverse_effective_mass(before[THETA], before[EY], *n, 0.0, PAPER.constants())
    ideal = mass * (1 + PAPER.delivered_restitution) * approach
    assert force * step == pytest.approx(ideal, rel=0.02)  # friction adds a little


def test_an_elastic_impact_without_friction_keeps_the_energy():
    bouncy, step = SLIPPERY.replace(restitution=1.0), 1e-7
    before, after, _ = first_contact(bouncy, step)
    assert energy_of(bouncy, after) == pytest.approx(energy_of(bouncy, before), rel=1e-3)


def test_force_of_an_impact_grows_as_the_step_shrinks():
    forces = [first_contact(PAPER, step)[2] for step in (1e-5, 1e-6, 1e-7)]
    assert np.array(forces[1:]) / forces[:-1] == pytest.approx([10, 10], rel=0.02)


def test_sustained_contact_has_the_force_of_the_ideal_joint():
    """Its clearance is small, and its slider heavy, so that impacts have ended."""
    duration, scene = 0.2, SLIPPERY.replace(clearance=1e-6)
    ideal = simulate(scene, joint="ideal", duration=duration, outputs=200).normal_force
    errors = []
    for steps in (20_000, 200_000):
        forces, _ = impulses.integrate(scene, duration, steps)
        at = forces[steps // 200 - 1 :: steps // 200][100:]
        errors.append(abs(at / ideal[101:] - 1).max())
    assert errors[1] < 0.2 * errors[0]
    assert errors[1] < 0.01


def test_grazing_contact_is_not_lost():
    """An integrator that loses contact has the slider at 0.162 m."""
    _, y = impulses.integrate(PAPER, 0.2, 200_000)
    assert slider_of(PAPER, y) == pytest.approx(0.1336, abs=1e-4)
    assert np.hypot(y[EX], y[EY]) == pytest.approx(PAPER.clearance, rel=1e-3)
