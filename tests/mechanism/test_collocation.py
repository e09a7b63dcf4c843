"""The step of collocation: Radau's rule, its order, and what it tells inside a step."""

from fractions import Fraction
from math import comb

import numpy as np
import pytest
from helpers.laws import packed

from study.mechanism import collocation, paper_scene, rigid
from study.mechanism.rigid import ContactState

SCENE = paper_scene()
HERTZ = packed("hertz", SCENE.ball_radius, SCENE.socket_radius, SCENE.composite_modulus)
CONTACT = ContactState(True, 2, 0.06)
START = np.array([0.5, 8e-7, 2.1, 11.0, 0.0, 900.0, 0, 0, 0])


def step(y, h, iterations=20):
    """One step of a contact, with Newton's method to the end."""
    p, n = SCENE.constants(), rigid.UNKNOWNS
    work = np.zeros(1, collocation.fields(n, rigid.INTEGRALS)).view(np.recarray)[0]
    work.start[:] = y
    motion = rigid.motion(y, CONTACT, p, HERTZ)
    rigid.derive(y, CONTACT, p, motion, work.k)
    work.rates[0, :n], work.rates[0, n:] = motion.accelerations, motion.powers
    work.rates[1:, :n] = motion.accelerations
    collocation.factorise(work, h)
    for _ in range(iterations):
        for i in range(collocation.STAGES):
            collocation.stage(i, work, h)
            motion = rigid.motion(work.trial, CONTACT, p, HERTZ)
            work.residuals[i] = motion.accelerations - work.rates[1 + i, :n]
            work.rates[1 + i, n:] = motion.powers
        collocation.improve(work, h)
    collocation.finish(work, h)
    return work


def after(steps, h=2e-5):
    y = START
    for _ in range(steps):
        y = step(y, h / steps).y.copy()
    return y


def legendre(degree):
    """Coefficients of Legendre's polynomial on (0, 1), from the lowest power."""
    return [(-1) ** (degree + k) * comb(degree, k) * comb(degree + k, k) for k in range(degree + 1)]


def value(coefficients, x):
    return sum(c * x**k for k, c in enumerate(coefficients))


def lagrange(points):
    """Coefficients of Lagrange's polynomials of some points, each from the lowest power."""
    polynomials = []
    for j, own in enumerate(points):
        polynomial = [Fraction(1)]
        for point in points[:j] + points[j + 1 :]:
            pairs = zip([0, *polynomial], [*polynomial, 0], strict=True)
            polynomial = [(low - point * high) / (own - point) for low, high in pairs]
        polynomials.append(polynomial)
    return polynomials


def integrals(points):
    """Radau's matrix: Lagrange's polynomials integrated from 0 to each point."""
    return [
        [value([0, *(c / (k + 1) for k, c in enumerate(p))], x) for p in lagrange(points)]
        for x in points
    ]


def same(kept, exact):
    """Is each kept number the one closest to the exact fraction?"""
    return np.array_equal(kept, np.array(exact, dtype=float))


POINTS = [Fraction(x) for x in collocation.POINTS]


def test_points_are_those_of_radaus_rule():
    difference = [a - b for a, b in zip(legendre(5), [*legendre(4), 0], strict=True)]
    slope = [k * c for k, c in enumerate(difference)][1:]
    roots = [x - value(difference, x) / value(slope, x) for x in POINTS]
    assert same(collocation.POINTS, roots)


def test_weights_are_integrals_of_lagranges_polynomials():
    matrix = integrals(POINTS)
    square = [
        [sum(map(Fraction.__mul__, row, c)) for c in zip(*matrix, strict=True)] for row in matrix
    ]
    assert same(collocation.RATE, matrix)
    assert same(collocation.PLACE, square)
    assert same(collocation.MONOMIALS, list(zip(*lagrange([Fraction(0), *POINTS]), strict=True)))


def test_weights_of_the_error_are_those_to_a_method_of_lower_order():
    """That method integrates 1, x, ... x^4 with the weight `REAL` at 0."""
    matrix, gamma = integrals(POINTS), Fraction(collocation.REAL)
    change = [
        sum(c / (k + 1) for k, c in enumerate(p)) - gamma * p[0] - last
        for p, last in zip(lagrange(POINTS), matrix[-1], strict=True)
    ]
    assert same(collocation.RATE_ERROR, change)
    of_places = [sum(map(Fraction.__mul__, change, c)) for c in zip(*matrix, strict=True)]
    assert same(collocation.PLACE_ERROR, of_places)


def test_eigenvectors_are_those_of_the_matrix():
    """To ten digits, so that the rest is the same on every processor."""
    real, pairs = np.atleast_1d(collocation.REAL), collocation.COMPLEX
    values = np.concatenate([real, pairs, pairs.conj()])
    halves = collocation.COMPLEX_VECTORS / 2
    vectors = np.column_stack([collocation.REAL_VECTOR, halves, halves.conj()])
    rows = collocation.COMPLEX_INVERSES
    inverses = np.vstack([collocation.REAL_INVERSE, rows, rows.conj()])
    assert np.sort_complex(np.linalg.eigvals(collocation.RATE)) == pytest.approx(
        np.sort_complex(values), abs=1e-10
    )
    assert collocation.RATE @ vectors == pytest.approx(vectors * values, abs=1e-9)
    assert vectors[-1] == pytest.approx(1)
    assert inverses @ vectors == pytest.approx(np.eye(5), abs=1e-8)


def test_a_step_has_order_9_in_contact():
    reference = after(32)
    errors = [np.abs(after(n) - reference)[[1, 4]] for n in (2, 4)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(9, abs=0.7)


def test_inside_a_step_the_state_has_order_7():
    errors = []
    for h in (8e-6, 4e-6):
        work, middle = step(START, h), after(2, h / 2)
        collocation.inside(work, h, 0.5)
        errors.append(np.abs(work.trial - middle)[[1, 4, 5]])
        collocation.inside(work, h, 1.0)
        assert work.trial == pytest.approx(work.y, rel=1e-12)
    assert np.log2(errors[0] / errors[1])[1:] == pytest.approx(7, abs=0.4)
    assert np.log2(errors[0] / errors[1])[0] == pytest.approx(8, abs=0.5)  # of a place


def test_the_error_estimate_has_order_6_and_is_above_the_error():
    errors = []
    for h in (4e-6, 2e-6):
        work, exact = step(START, h), after(2, h)
        collocation.estimate(work, h)
        rounding = 4e-16 * np.abs(exact[:6])
        assert (np.abs(work.error) + rounding >= np.abs(work.y - exact)[:6]).all()
        errors.append(np.abs(work.error[[4, 5]]))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(6, abs=0.4)


def test_the_guess_is_the_polynomial_itself():
    work = step(START, 4e-5)
    kept = work.rates.copy()
    collocation.guess(work, 0.0, 1.0)
    assert work.rates[1:, :3] == pytest.approx(kept[1:, :3], rel=1e-10)
