"""Laws against closed forms, high-precision arithmetic, and their own derivatives."""

import json
import re

import mpmath
import numpy as np
import pandas as pd
import pytest
from helpers.laws import VARIANTS
from hypothesis import given
from hypothesis import strategies as st

from study import contact, dataset
from study.contact import laws
from study.dataset import fitting, store
from study.joint import Joint

depths = st.floats(1e-6, 0.999)
radii = st.floats(20, 1e5)
every_variant = pytest.mark.parametrize(("name", "options"), VARIANTS)


@pytest.mark.parametrize("ds", [1e-30, 1e-12, 1e-9, 1e-6, 1e-4, 0.025, 0.5, 1.0, 1.2337])
@pytest.mark.parametrize("area", ["sphere", "flat"])
def test_bracket_is_exact_to_1e_12(ds, area):
    value, derivative = laws.shapes.hyperbolic(ds, laws.shapes.BRACKETS[area])
    bracket, slope = value / ds, (derivative - value / ds) / ds
    with mpmath.workdps(160):

        def exact(depth):
            a = mpmath.sqrt(2 * depth)
            if area == "flat":
                whole = 6 * mpmath.sin(a) / a + (6 / a**2 - 2) * mpmath.cos(a) - 1 - 6 / a**2
                return 2 * whole
            return mpmath.mpf(1) / 2 - mpmath.sin(2 * a) / (2 * a) + mpmath.sin(a) ** 2 / (2 * a**2)

        assert abs(bracket / exact(mpmath.mpf(ds)) - 1) < 1e-12
        assert abs(slope / mpmath.diff(exact, mpmath.mpf(ds), h=mpmath.mpf(ds) * 1e-20) - 1) < 1e-12


@pytest.mark.parametrize("area", ["sphere", "flat"])
def test_bracket_is_the_integral_over_the_contact(area):
    a = mpmath.sqrt(2 * mpmath.mpf("0.4"))
    weight = {"sphere": mpmath.sin, "flat": lambda t: t}[area]
    integral = mpmath.quad(lambda t: 2 * (1 - t**2 / a**2) * mpmath.cos(t) * weight(t), [0, a])
    force = contact.hyperbolic_winkler(0.4, 200, area=area, coefficient=1.0)
    assert force == pytest.approx(float(0.4 * integral), rel=1e-12)


def test_hertz_is_the_textbook_formula():
    r1, r2, modulus, d = 9.95e-3, 10e-3, 1.1e11, 2e-5
    radius = 1 / (1 / r1 - 1 / r2)
    expected = 4 / 3 * modulus * np.sqrt(radius) * d**1.5
    sizes = {"ball_radius": r1, "socket_radius": r2, "composite_modulus": modulus}
    law = contact.DimensionalLaw("hertz", **sizes)
    assert law.force(d) == pytest.approx(expected, rel=1e-12)


@given(depths, radii)
def test_steuermann_of_a_parabola_is_hertz(ds, r2_star):
    parabola = contact.steuermann(ds, r2_star, n=1, radius="profile")
    assert parabola == pytest.approx(contact.hertz(ds, r2_star), rel=1e-9)


@pytest.mark.parametrize("n", [1, 2, 3, 5, 50])
def test_steuermann_profile_is_johnsons_formula(n):
    r2 = mpmath.mpf(200)
    gap = mpmath.binomial(mpmath.mpf(1) / 2, n) * (-1) ** (n + 1)  # of R - sqrt(R^2 - r^2)
    a_n = gap * ((r2 - 1) ** (1 - 2 * n) - r2 ** (1 - 2 * n))
    even = mpmath.fprod(range(2, 2 * n + 1, 2))
    c_n = even / mpmath.fprod(range(1, 2 * n, 2))
    radius = (mpmath.mpf("0.3") / (c_n * a_n)) ** (mpmath.mpf(1) / (2 * n))
    expected = mpmath.mpf(4 * n) / (2 * n + 1) * radius * mpmath.mpf("0.3")
    assert contact.steuermann(0.3, 200, n=n, radius="profile") == pytest.approx(
        float(expected), rel=1e-11
    )


def test_steuermann_and_liu_as_identified_from_table_2():
    eps = np.arccos(1 / 1.5)
    assert contact.steuermann(0.5, 200) == pytest.approx(4 / 3 * 200 * np.sin(eps) * 0.5)
    factor = laws.fitted_coefficients()["liu"]["slope"]
    assert factor == pytest.approx(4.57, abs=0.01)
    expected = factor * 200 * 0.5 * np.sin(eps) * np.sin(eps / 2)
    assert contact.liu(0.5, 200) == pytest.approx(expected)


def test_the_papers_law_has_the_area_of_a_disc_unless_told_otherwise():
    disc, sphere = (contact.hyperbolic_winkler(0.3, 200, area=area) for area in ("flat", "sphere"))
    assert contact.hyperbolic_winkler(0.3, 200) == disc
    assert 0.01 < abs(sphere / disc - 1) < 0.05  # each with its own coefficient


@given(st.floats(1e-9, 1e-4), radii)
def test_hyperbolic_law_becomes_the_classical_one_at_small_depth(ds, r2_star):
    hyperbolic = contact.hyperbolic_winkler(ds, r2_star, coefficient=2.0)
    assert hyperbolic == pytest.approx(contact.winkler(ds, r2_star, coefficient=2.0), rel=ds)


@every_variant
@given(ds=depths, r2_star=radii)
def test_derivative_is_that_of_the_force(name, options, ds, r2_star):
    law, step = contact.LAWS[name], 1e-5 * ds
    slope = (law(ds + step, r2_star, **options) - law(ds - step, r2_star, **options)) / (2 * step)
    assert law(ds, r2_star, derivative=True, **options) == pytest.approx(slope, rel=1e-6)


@every_variant
@given(ds=depths, r2_star=radii, factor=st.floats(1.001, 2))
def test_force_increases_with_depth_and_vanishes_without_contact(
    name, options, ds, r2_star, factor
):
    law = contact.LAWS[name]
    deeper = min(ds * factor, 1.0)
    assert law(deeper, r2_star, **options) > law(ds, r2_star, **options) > 0
    for derivative in (False, True):
        assert law(-ds, r2_star, derivative=derivative, **options) == 0
        assert law(0.0, r2_star, derivative=derivative, **options) == 0


@every_variant
def test_laws_broadcast(name, options):
    law = contact.LAWS[name]
    ds, r2 = np.array([-0.1, 0.0, 0.2, 0.5]), np.array([[20.0], [300.0]])
    table = law(ds, r2, **options)
    assert table.shape == (2, 4)
    assert table[1, 3] == pytest.approx(law(0.5, 300.0, **options), rel=1e-12)
    assert isinstance(law(0.5, 300.0, **options), float)


def test_composite_modulus_of_equal_bodies():
    assert contact.composite_modulus(2e11, 0.3, 2e11, 0.3) == pytest.approx(2e11 / (2 * 0.91))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: contact.hertz(0.1, 1.0), "r2_star must be > 1, got 1"),
        (lambda: contact.hertz([0.1, np.inf], 200), "depth_star must be finite, got inf"),
        (lambda: contact.stiffened_hertz(1.01, 200), "stiffened_hertz must be <= 1, got 1.01"),
        (lambda: contact.stiffened_hertz(0.1, 19), "r2_star of stiffened_hertz must be >= 20"),
        (lambda: contact.hyperbolic_winkler(0.1, 200, area="x"), "must be one of flat, sphere"),
        (lambda: contact.steuermann(0.1, 200, n=51), "n of steuermann must be >= 1 and <= 50"),
        (lambda: contact.winkler(0.1, 200, coefficient=-1), "coefficient of winkler must be > 0"),
        (lambda: contact.winkler(0.1, 200, n=2), "option of winkler must be one of coefficient"),
    ],
)
def test_bad_input_is_one_clear_error(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()


def test_stored_coefficients_are_the_fit_to_the_stored_curves():
    stored = json.loads(laws.COEFFICIENTS.read_text())
    fitted = fitting.fit_laws(dataset.load(), pd.read_csv(store.TABLES))
    assert set(fitted) <= set(stored)
    for law in fitted:
        assert stored[law] == pytest.approx(fitted[law], rel=1e-7)


@pytest.fixture(scope="module")
def curve():
    return Joint.from_ratios(200).solve(depth_star=np.linspace(0.025, 1, 40) ** 2, resolution=640)


def test_tabulated_law_is_its_curve(curve):
    law = contact.tabulated(curve)
    assert law(curve.depth_star) == pytest.approx(curve.force_star, rel=1e-6)
    between = np.linspace(0.031, 0.997, 30) ** 2
    exact = Joint.from_ratios(200).solve(depth_star=between, resolution=640).force_star
    assert np.abs(law(between) / exact - 1).max() < 1e-4
    assert law(1e-9) == pytest.approx(contact.hertz(1e-9, 200), rel=1e-3)
    assert law(-0.1) == 0


def test_tabulated_law_is_smooth_and_increasing(curve):
    law = contact.tabulated(curve)
    ds = np.linspace(1e-3, 1, 3001)
    force, slope = law(ds), law(ds, derivative=True)
    assert (np.diff(force) > 0).all()
    step = 1e-6
    numeric = (law(ds[:-1] + step) - law(ds[:-1] - step)) / (2 * step)
    assert slope[:-1] == pytest.approx(numeric, rel=1e-6)
    assert (np.diff(slope) > 0).all()  # and the contact stiffens, without a jump


def test_tabulated_law_refuses_what_it_does_not_know(curve):
    law = contact.tabulated(curve)
    with pytest.raises(ValueError, match="r2_star must be 200, .* got"):
        law(0.1, 100)
    with pytest.raises(ValueError, match="depth_star of tabulated must be <= 1, got 1.1"):
        law(1.1)
    deep = Joint.from_ratios(200).solve(depth_star=[0.1, 0.2, 0.3, 0.4], resolution=64)
    with pytest.raises(ValueError, match="minimum depth .* <= a tenth of .* got 0.1 and 0.4"):
        contact.tabulated(deep)
    short = Joint.from_ratios(200).solve(depth_star=[0.1, 0.2, 0.3], resolution=64)
    with pytest.raises(ValueError, match=">= 4 different depths > 0, got 3"):
        contact.tabulated(short)
