"""The exact series against closed forms and half-spaces, and its convergence."""

import numpy as np
import pytest
from helpers.bodies import of_socket

from study.joint import Joint, series
from study.joint.compliance import Ball, HatFunctions, Socket, surface_angles

EVEN = np.arange(0, 10_001, 2)


def of_ball(orders, poisson):
    """Inward displacement of a ball's surface under the pressures P_n(cos theta)."""
    return -series.ball(orders, poisson).state(1.0)[0]


@pytest.mark.parametrize("poisson", [-0.5, 0.0, 0.3, 0.49])
def test_ball_under_uniform_pressure_shrinks_as_lame(poisson):
    assert of_ball(EVEN[:1], poisson) == pytest.approx(1 - 2 * poisson)


def modes_residual(orders, poisson, radius, which):
    """Largest residual of radial equilibrium of one mode, from differences in the radius."""
    step = 1e-4
    at = [series.modes(orders, poisson, radius + k * step, 2.0) for k in (-1, 0, 1)]
    radial, _, normal, shear = (np.array([a[q][which] for a in at]) for q in range(4))
    n, r = orders, radius
    lame = poisson / (1 - 2 * poisson)  # over 2 G: stresses below are over 2 G as well
    strain = radial[1] / r
    divergence = (radial[2] - radial[0]) / (2 * step) + 2 * strain
    divergence -= n * (n + 1) * at[1][1][which] / r
    around = 2 * lame * divergence + 2 * strain - n * (n + 1) * at[1][1][which] / r  # both hoops
    slope = (normal[2] - normal[0]) / (2 * step)
    residual = slope + (2 * normal[1] - around) / r - n * (n + 1) * shear[1] / r
    return np.abs(residual / (np.abs(slope) + np.abs(normal[1])))


@pytest.mark.parametrize("which", range(4))
def test_modes_are_in_equilibrium(which):
    orders = np.array([2, 4, 10, 20])
    assert modes_residual(orders, 0.3, 1.3, which).max() < 1e-5


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
def test_high_orders_are_those_of_a_half_space(poisson):
    # a wave of pressure p on a half-space of modulus 1 displaces it by 2 (1 - nu^2) p / k
    limit = 2 * (1 - poisson**2)
    last = EVEN[-1:]
    for receptance in (
        of_ball(last, poisson),
        of_socket(last, 1.1, poisson),
        of_socket(last, 50.0, poisson),
    ):
        assert receptance * last == pytest.approx(limit, rel=2e-4)


def test_hat_coefficients_are_the_integrals():
    angles = surface_angles(16)
    coefficients = series.hat_coefficients(16, 60)
    hats = HatFunctions(angles)
    for order in (0, 2, 10, 60):
        legendre = np.polynomial.legendre.Legendre.basis(order)
        # finer quadrature than that of the hats: each element in 8 parts
        fine = np.interp(np.arange(16 * 8 + 1) / 8, np.arange(17), angles)
        parts = HatFunctions(fine)
        weights = parts.integrate(lambda t: legendre(np.cos(t)))  # noqa: B023
        expected = (2 * order + 1) / (2 * np.pi) * hats.values(fine).T @ weights
        assert coefficients[order // 2] == pytest.approx(expected, rel=1e-10, abs=1e-12)


def test_more_orders_change_neither_force_nor_peak_pressure(monkeypatch):
    joint, depth, found = Joint.from_ratios(200, 1.1), np.linspace(0.02, 1, 15), []
    for orders in (4 * series.ORDERS, series.ORDERS):  # the usual ones stay cached
        monkeypatch.setattr(series, "ORDERS", orders)
        series.compliance.cache_clear()
        found.append(joint.solve(depth_star=depth, resolution=128))
    more, usual = found
    assert usual.force_star == pytest.approx(more.force_star, rel=1e-6)
    assert usual.peak_pressure_star == pytest.approx(more.peak_pressure_star, rel=1e-5)


def test_coarser_hats_are_those_of_half_the_resolution(monkeypatch):
    usual, found = series.ORDERS, []
    for orders, resolution in ((2 * usual, 32), (usual, 64)):  # as many orders in all
        monkeypatch.setattr(series, "ORDERS", orders)
        series.compliance.cache_clear()
        found.append([series.compliance(body, resolution) for body in (Ball(), Socket(1.2))])
    for expected, fine in zip(*found, strict=True):
        assert fine.coarser.angles == pytest.approx(expected.angles, abs=1e-12)
        most = expected.flexibility.max()
        assert fine.coarser.flexibility == pytest.approx(expected.flexibility, abs=1e-12 * most)
