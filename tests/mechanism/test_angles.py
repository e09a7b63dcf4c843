"""Sine, cosine and angle of our own, against mpmath's."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study.mechanism.angles import LARGEST, arcsine, direction, norm, sine_cosine, sixth_root

angles = st.floats(-LARGEST, LARGEST, exclude_min=True, exclude_max=True)


@given(angles)
def test_sine_and_cosine(angle):
    for found, exact in zip(sine_cosine(angle), (mpmath.sin, mpmath.cos), strict=True):
        assert float(abs(found - exact(mpmath.mpf(angle)))) <= 2.3e-16


@given(st.floats(-1e-3, 1e-3))
def test_the_sine_of_a_small_angle_keeps_its_digits(angle):
    exact = float(mpmath.sin(mpmath.mpf(angle)))
    assert sine_cosine(angle)[0] == pytest.approx(exact, rel=3e-16, abs=0)


def test_an_angle_that_is_none_is_nan():
    for angle in (math.nan, math.inf, 2 * LARGEST):
        assert np.isnan(sine_cosine(angle)).all()


@given(st.floats(-10, 10), st.floats(1e-8, 1e8))
def test_directions_are_those_of_vectors(angle, size):
    x, y = size * math.cos(angle), size * math.sin(angle)
    exact = float(mpmath.atan2(y, x))
    assert abs(direction(y, x) - exact) <= 1e-15
    assert norm(x, y) == pytest.approx(size, rel=1e-15)


@pytest.mark.parametrize(
    ("y", "x"), [(0, 1), (1, 0), (0, -1), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1), (0, 0)]
)
def test_directions_of_axes_and_diagonals(y, x):
    assert direction(float(y), float(x)) == pytest.approx(math.atan2(y, x), abs=5e-16)


@given(st.floats(1e-12, 1e12))
def test_sixth_roots(x):
    assert sixth_root(x) == pytest.approx(float(mpmath.root(x, 6)), rel=2e-15)


@given(st.floats(-1, 1))
def test_arcsines(sine):
    assert arcsine(sine) == pytest.approx(math.asin(sine), abs=2e-8 if abs(sine) > 0.99 else 1e-15)
