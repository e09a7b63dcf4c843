"""The law on paper against exact curves of joints that had no part in its fit."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.contact import hertz
from study.contact.laws import fitted_coefficients
from study.contact.printed import PRINTED_RANGES, PrintedLaw
from study.dataset.printed import joint_of_share
from study.joint import whole_curve
from study.joint.growth import depths_and_forces

OF_FORCE, OF_ANGLE, OF_PEAK = 0.035, 0.07, 0.12  # largest relative errors stated
ROOTS = np.linspace(0.001**0.5, 1, 40)


def options(joint):
    return {
        "r2_star": joint.r2_star,
        "socket_ratio": joint.socket_ratio,
        "modulus_ratio": joint.modulus_ratio,
        "poisson": joint.ball.poisson,
        "socket_poisson": joint.socket.poisson,
    }


def random_joints(count, shares, seed):
    """Joints over the whole range: a pair of bodies for every four shares."""
    random = np.random.default_rng(seed)
    for number in range(count):
        if number % 4 == 0:
            ratio = 1 + 0.25 * 40 ** random.random()
            poissons = random.uniform(*PRINTED_RANGES["poisson"])
            poissons = poissons, random.uniform(*PRINTED_RANGES["socket_poisson"])
        share = (*shares, *random.random(2))[number % 4]
        yield joint_of_share(50 * 200 ** random.random(), share, ratio, *poissons)


def test_error_of_force_on_joints_that_had_no_part_in_the_fit():
    worst = []
    for joint in random_joints(300, (0.0, 1.0), seed=3):
        depth, force = depths_and_forces(joint, 1.0, 160)
        inside = (depth >= 0.001) & (depth <= 1)
        found = PrintedLaw(**options(joint)).force(depth[inside])
        worst.append(np.abs(found / force[inside] - 1).max())
    assert max(worst) < OF_FORCE
    assert np.median(worst) < 0.02


def test_half_angle_and_peak_pressure():
    for joint in random_joints(40, (0.01, 1.0), seed=4):
        curve = whole_curve(joint)
        inside = (curve.depth_star >= 0.001) & (curve.depth_star <= 1)
        law, depth = PrintedLaw(**options(joint)), curve.depth_star[inside]
        angle = law.contact_half_angle_deg(depth)
        assert angle == pytest.approx(curve.contact_half_angle_deg[inside], rel=OF_ANGLE)
        peak = law.peak_pressure_star(depth)
        assert peak == pytest.approx(curve.peak_pressure_star[inside], rel=OF_PEAK)


in_range = {
    "r2_star": st.floats(50, 1e6),
    "socket_ratio": st.floats(1.25, 1e3),
    "modulus_ratio": st.floats(1e-4, 1e4),
    "poisson": st.floats(0.2, 0.4),
    "socket_poisson": st.floats(0.2, 0.46),
}


@given(st.fixed_dictionaries(in_range))
def test_limit_is_hertz(joint):
    shallow, law = 1e-10, PrintedLaw(**joint)
    assert law.force(shallow) == pytest.approx(hertz(shallow, joint["r2_star"]), rel=2e-4)
    first_order = 1.1 / joint["r2_star"] + 1e-4  # which angle and pressure leave out
    angle = law.contact_half_angle_deg(shallow)
    assert angle == pytest.approx(np.degrees(shallow**0.5), rel=1e-4)
    peak = law.peak_pressure_star(shallow)
    assert peak == pytest.approx(2 / pi * shallow**0.5, rel=first_order)
    for method in (law.depth, *of_depth(law)):
        assert method(0.0) == 0


def of_depth(law):
    return law.force, law.contact_half_angle_deg, law.peak_pressure_star


@given(st.fixed_dictionaries(in_range))
def test_depth_and_force_are_inverse_and_grow(joint):
    depth, law = ROOTS**2, PrintedLaw(**joint)
    assert law.depth(law.force(depth)) == pytest.approx(depth, rel=1e-9)
    for method in of_depth(law):
        assert (np.diff(method(depth)) > 0).all()


@given(st.fixed_dictionaries(in_range), st.floats(0.01, 1))
def test_force_by_hand(joint, depth):
    """Seven steps of the fixed-point iteration that the docstring gives."""
    r2_star, x, law = joint["r2_star"], depth**0.5, PrintedLaw(**joint)
    scale = 4 / 3 * np.sqrt(r2_star * (r2_star - 1))
    right = law.force(depth)
    largest = (law.force(1.0) / scale) ** (1 / 3)
    for _ in range(7):
        x = min(x, largest)
        x *= (depth / law.depth(scale * x**3)) ** 0.6
    assert scale * x**3 == pytest.approx(right, rel=1e-3)


def test_at_most_16_numbers_of_4_digits():
    numbers = [n for part in fitted_coefficients()["printed_hertz"].values() for n in part]
    assert len(numbers) <= 16
    assert all(float(f"{number:.4g}") == number for number in numbers)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("r2_star", 49.0),
        ("socket_ratio", 1.2),
        ("modulus_ratio", 0.0),
        ("poisson", 0.45),
        ("socket_poisson", 0.19),
        ("socket_poisson", np.nan),
        ("r2_star", [100.0, 200.0]),
    ],
)
def test_joints_outside_the_range(name, value):
    joint = {"r2_star": 200.0, "socket_ratio": 1.5} | {name: value}
    with pytest.raises(ValueError, match=name):
        PrintedLaw(**joint)


def test_depths_and_forces_outside_the_range():
    law = PrintedLaw(200.0, socket_ratio=1.5)
    for depth in (-0.1, 1.01, np.inf, "0.1"):
        for method in of_depth(law):
            with pytest.raises(ValueError, match="depth_star"):
                method(depth)
    for force in (-1.0, 1.01 * law.force(1.0), np.nan):
        with pytest.raises(ValueError, match="force_star"):
            law.depth(force)
