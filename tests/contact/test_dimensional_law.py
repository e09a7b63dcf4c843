"""Laws in SI units: their dimensions, their inverse, and what they refuse."""

import re
from math import inf

import numpy as np
import pytest
from helpers.laws import IN_SI_UNITS, VARIANTS
from hypothesis import given
from hypothesis import strategies as st

from study import contact
from study.contact import DimensionalLaw
from study.joint import Joint

SIZES = {"ball_radius": 9.95e-3, "socket_radius": 10e-3, "composite_modulus": 1.1e11}
CLEARANCE = SIZES["socket_radius"] - SIZES["ball_radius"]
PAPER = IN_SI_UNITS["stiffened_hertz"]
WITHOUT_LIMIT = [v for v in VARIANTS if DimensionalLaw(v[0], **SIZES, **v[1]).deepest == inf]
every_variant = pytest.mark.parametrize(("name", "options"), VARIANTS)


@every_variant
def test_force_and_stiffness_are_the_laws_with_dimensions(name, options):
    law = DimensionalLaw(name, **SIZES, **options)
    depth = CLEARANCE * np.array([[-0.1, 0.0, 1e-6], [0.1, 0.5, 1.0]])
    for derivative, found in ((False, law.force(depth)), (True, law.stiffness(depth))):
        star = contact.LAWS[name](depth / CLEARANCE, law.r2_star, derivative=derivative, **options)
        unit = SIZES["composite_modulus"] * CLEARANCE ** (1 if derivative else 2)
        assert found == pytest.approx(unit * star, rel=1e-12)
    assert isinstance(law.force(1e-6), float)
    assert isinstance(law.stiffness(1e-6), float)


@pytest.fixture(scope="module")
def soft():
    """A law by the table of a soft socket's curve."""
    curve = Joint.from_ratios(200, 1.5, modulus_ratio=0.0035, socket_poisson=0.46).curve()
    return DimensionalLaw(contact.tabulated(curve), **SIZES)


@every_variant
def test_depth_is_the_inverse_of_force(name, options):
    check_inverse(DimensionalLaw(name, **SIZES, **options))


def test_depth_is_the_inverse_of_a_tabulated_force(soft):
    check_inverse(soft)


def check_inverse(law):
    deepest = min(law.deepest, 10 * CLEARANCE)
    depth = np.append(0, deepest * np.logspace(-12, 0, 200)).reshape(3, 67)
    assert law.depth(law.force(depth)) == pytest.approx(depth, rel=1e-11)
    assert law.depth(0) == 0
    assert isinstance(law.depth(law.force(deepest)), float)


@given(st.sampled_from(VARIANTS), st.floats(1e-12, 1))
def test_force_of_the_depth_of_a_force(variant, share):
    law = DimensionalLaw(variant[0], **SIZES, **variant[1])
    force = share * law.force(min(law.deepest, 10 * CLEARANCE))
    assert law.force(law.depth(force)) == pytest.approx(force, rel=1e-11)


@pytest.mark.parametrize("force", [1e-30, 1e-3, 1e6, 1e20])
@pytest.mark.parametrize(("name", "options"), WITHOUT_LIMIT)
def test_laws_without_a_limit_have_a_depth_for_any_force(name, options, force):
    law = DimensionalLaw(name, **SIZES, **options)
    assert law.force(law.depth(force)) == pytest.approx(force, rel=1e-12)


def test_largest_depths(soft):
    assert DimensionalLaw("stiffened_hertz", **SIZES, **PAPER).deepest == pytest.approx(CLEARANCE)
    limit = DimensionalLaw("hyperbolic_winkler", **SIZES).deepest
    assert limit == pytest.approx(np.pi**2 / 8 * CLEARANCE)
    assert CLEARANCE <= soft.deepest < 1.1 * CLEARANCE


@pytest.mark.parametrize("law", [("stiffened_hertz", PAPER), ("hyperbolic_winkler", {})])
def test_a_force_beyond_the_largest_depth_names_the_largest_force(law):
    name, options = law
    law = DimensionalLaw(name, **SIZES, **options)
    largest = law.force(law.deepest)
    assert law.depth(largest) == pytest.approx(law.deepest, rel=1e-9)
    message = f"force of {name} must be >= 0 and <= {largest:g} N, got {2 * largest:g} N"
    with pytest.raises(ValueError, match=re.escape(message)):
        law.depth([0.1 * largest, 2 * largest])
    message = f"depth of {name} must be <= {law.deepest:g} m, got {2 * law.deepest:g} m"
    with pytest.raises(ValueError, match=re.escape(message)):
        law.force(2 * law.deepest)


def test_stiffened_hertz_takes_nothing_of_the_papers_joint_silently():
    for left_out in PAPER:
        options = {name: value for name, value in PAPER.items() if name != left_out}
        with pytest.raises(ValueError, match=f"in SI units requires {left_out}, "):
            DimensionalLaw("stiffened_hertz", **SIZES, **options)
    message = "requires socket_ratio, modulus_ratio, poisson, socket_poisson"
    with pytest.raises(ValueError, match=message):
        DimensionalLaw("stiffened_hertz", **SIZES)


@pytest.mark.parametrize(
    ("law", "changes", "message"),
    [
        ("hooke", {}, "law must be one of hertz, "),
        ("hertz", {"ball_radius": 0.011}, "socket_radius must be > 0.011 m, got 0.01 m"),
        ("stiffened_hertz", PAPER | {"poisson": 0.1}, "poisson of stiffened_hertz must be >= 0.2"),
    ],
)
def test_wrong_joints(law, changes, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        DimensionalLaw(law, **(SIZES | changes))


@pytest.mark.parametrize("force", [-1.0, np.inf])
def test_wrong_forces(force):
    with pytest.raises(ValueError, match="force of hertz must be "):
        DimensionalLaw("hertz", **SIZES).depth(force)
