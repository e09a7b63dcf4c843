"""The step of collocation: Radau's rule, its order, and what it tells inside a step."""

import numpy as np
import pytest

from study.contact.forces import pack
from study.mechanism import Scene, collocation, rigid

SCENE = Scene()
HERTZ = pack("hertz", SCENE.ball_radius, SCENE.socket_radius, SCENE.composite_modulus)
PIECE = (True, 2, 0.06)
START = np.array([0.5, 8e-7, 2.1, 11.0, 0.0, 900.0, 0, 0, 0])


def step(y, h, iterations=20):
    """One step of a contact, with Newton's method to the end."""
    p, n = SCENE.constants(), rigid.UNKNOWNS
    work = np.zeros(1, collocation.fields(n)).view(np.recarray)[0]
    work.start[:] = y
    found, parts = rigid.motion(y, PIECE, p, HERTZ)
    rigid.derive(y, PIECE, p, found, parts, work.k)
    work.rates[0, :n], work.rates[0, n:] = found.accelerations, found.powers
    work.rates[1:, :n] = found.accelerations
    collocation.factorise(work, h)
    for _ in range(iterations):
        for i in range(collocation.STAGES):
            collocation.stage(i, work, h)
            found, _ = rigid.motion(work.trial, PIECE, p, HERTZ)
            work.residuals[i] = found.accelerations - work.rates[1 + i, :n]
            work.rates[1 + i, n:] = found.powers
        collocation.improve(work, h)
    collocation.finish(work, h)
    return work


def after(steps, h=2e-5):
    y = START
    for _ in range(steps):
        y = step(y, h / steps).y.copy()
    return y


def test_points_integrate_polynomials_up_to_twice_their_number():
    weights = collocation.RATE[-1]
    for power in range(2 * collocation.STAGES - 1):
        assert weights @ collocation.POINTS**power == pytest.approx(1 / (power + 1), rel=1e-14)
    beyond = weights @ collocation.POINTS ** (2 * collocation.STAGES - 1)
    assert abs(beyond - 0.1) > 1e-6


def test_eigenvectors_are_those_of_the_matrix():
    def product(values, vectors, inverses):
        return np.real(vectors * values) @ np.real(inverses) - np.imag(vectors * values) @ np.imag(
            inverses
        )

    real = np.outer(collocation.REAL * collocation.REAL_VECTOR, collocation.REAL_INVERSE)
    pairs = collocation.COMPLEX, collocation.COMPLEX_VECTORS, collocation.COMPLEX_INVERSES
    assert real + product(*pairs) == pytest.approx(collocation.RATE, abs=1e-8)


def test_a_step_has_order_9_in_contact():
    truth = after(32)
    errors = [np.abs(after(n) - truth)[[1, 4]] for n in (2, 4)]
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
    found = []
    for h in (4e-6, 2e-6):
        work, exact = step(START, h), after(2, h)
        collocation.estimate(work, h)
        rounding = 4e-16 * np.abs(exact[:6])
        assert (np.abs(work.error) + rounding >= np.abs(work.y - exact)[:6]).all()
        found.append(np.abs(work.error[[4, 5]]))
    assert np.log2(found[0] / found[1]) == pytest.approx(6, abs=0.4)


def test_the_guess_is_the_polynomial_itself():
    work = step(START, 4e-5)
    kept = work.rates.copy()
    collocation.guess(work, 0.0, 1.0)
    assert work.rates[1:, :3] == pytest.approx(kept[1:, :3], rel=1e-10)
