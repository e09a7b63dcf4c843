"""The contact solver on random problems, against an independent method, and when it cannot end."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls

from study.joint import complementarity


def problem(seed, size, conditioning):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(size, size)) + conditioning * np.eye(size)
    return root @ root.T + 1e-3 * np.eye(size), rng.normal(size=size)


@given(st.integers(0, 10_000), st.integers(1, 40), st.sampled_from([0.0, 1.0, 10.0]))
def test_solution_is_complementary_from_any_first_guess(seed, size, conditioning):
    matrix, vector = problem(seed, size, conditioning)
    guess = np.random.default_rng(seed + 1).random(size) < 0.5
    p, active = complementarity.solve(matrix, vector, guess)
    w = matrix @ p + vector
    scale = np.abs(vector).max()
    assert (p >= 0).all()
    assert (active == (p > 0)).all()
    assert w.min() > -1e-8 * scale
    assert np.abs(p * w).max() < 1e-7 * scale * max(p.max(), 1)


@given(st.integers(0, 10_000), st.integers(2, 25))
def test_solution_agrees_with_non_negative_least_squares(seed, size):
    matrix, vector = problem(seed, size, 5.0)
    root = np.linalg.cholesky(matrix).T
    expected, _ = nnls(root, -np.linalg.solve(root.T, vector))
    assert complementarity.solve(matrix, vector)[0] == pytest.approx(expected, abs=1e-7)


def test_pivoting_takes_few_steps():
    for seed in range(30):
        for size in (10, 40, 160):
            complementarity.solve(*problem(seed, size, 0.0), max_pivots=10)


def test_single_pivots_end_where_blocks_make_no_progress(monkeypatch):
    monkeypatch.setattr(complementarity, "PATIENCE", 0)
    matrix, vector = problem(3, 30, 0.0)
    p, _ = complementarity.solve(matrix, vector)
    assert (matrix @ p + vector).min() > -1e-8


def test_a_solver_that_does_not_end_says_so_with_its_residual():
    matrix, vector = problem(3, 30, 0.0)
    with pytest.raises(complementarity.ComplementarityError, match=r"is \d.* of 30 points"):
        complementarity.solve(matrix, vector, max_pivots=1)


def test_a_matrix_that_is_not_positive_definite_is_named():
    with pytest.raises(complementarity.ComplementarityError, match="not positive definite"):
        complementarity.solve(-np.eye(2), -np.ones(2))
