"""Laws against closed forms, high-precision arithmetic, and their own derivatives."""

import mpmath
import numpy as np
import pytest
from helpers.laws import VARIANTS
from hypothesis import given
from hypothesis import strategies as st

from study import contact, dataset
from study.contact import laws, shapes
from study.dataset import fitting, store
from study.joint import Joint

depths = st.floats(1e-6, 0.999)
radii = st.floats(20, 1e5)
STIFF = contact.StiffenedHertz.of(Joint.from_ratios(200))
every_variant = pytest.mark.parametrize("name", VARIANTS)


@pytest.mark.parametrize("ds", [1e-30, 1e-12, 1e-9, 1e-6, 1e-4, 0.025, 0.5, 1.0, 1.2337])
@pytest.mark.parametrize("area", ["sphere", "flat"])
def test_bracket_is_exact_to_1e_12(ds, area):
    value, derivative = shapes.hyperbolic(ds, shapes.BRACKETS[area])
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


@pytest.mark.parametrize(("area", "weight"), [("sphere", mpmath.sin), ("flat", lambda t: t)])
def test_bracket_is_the_integral_over_the_contact(area, weight):
    a = mpmath.sqrt(2 * mpmath.mpf("0.4"))
    integral = mpmath.quad(lambda t: 2 * (1 - t**2 / a**2) * mpmath.cos(t) * weight(t), [0, a])
    force = contact.HyperbolicWinkler(1.0, area)(0.4, 200)
    assert force == pytest.approx(float(0.4 * integral), rel=1e-12)


def test_hertz_is_the_textbook_formula():
    radius = 1 / (1 / 9.95e-3 - 1 / 10e-3)
    law = contact.DimensionalLaw(
        "hertz", ball_radius=9.95e-3, socket_radius=10e-3, composite_modulus=1.1e11
    )
    assert law.force(2e-5) == pytest.approx(4 / 3 * 1.1e11 * np.sqrt(radius) * 2e-5**1.5, rel=1e-12)


@given(depths, radii)
def test_limits_of_laws_are_other_laws(ds, r2_star):
    parabola = contact.Steuermann(1, "profile")(ds, r2_star)
    assert parabola == pytest.approx(contact.Hertz()(ds, r2_star), rel=1e-9)
    hyperbolic = contact.HyperbolicWinkler(2.0)(1e-4 * ds, r2_star)
    assert hyperbolic == pytest.approx(contact.Winkler(2.0)(1e-4 * ds, r2_star), rel=1e-4 * ds)


@pytest.mark.parametrize("r2_star", [1.0005, 200])  # also a nearly full ball
@pytest.mark.parametrize("n", [1, 2, 3, 5, 50])
def test_steuermann_profile_is_johnsons_formula(n, r2_star):
    r2 = mpmath.mpf(r2_star)
    gap = mpmath.binomial(mpmath.mpf(1) / 2, n) * (-1) ** (n + 1)  # of R - sqrt(R^2 - r^2)
    a_n = gap * ((r2 - 1) ** (1 - 2 * n) - r2 ** (1 - 2 * n))
    even = mpmath.fprod(range(2, 2 * n + 1, 2))
    c_n = even / mpmath.fprod(range(1, 2 * n, 2))
    radius = (mpmath.mpf("0.3") / (c_n * a_n)) ** (mpmath.mpf(1) / (2 * n))
    expected = mpmath.mpf(4 * n) / (2 * n + 1) * radius * mpmath.mpf("0.3")
    force = contact.Steuermann(n, "profile")(0.3, r2_star)
    assert force == pytest.approx(float(expected), rel=1e-11)


def test_steuermann_and_liu_as_identified_from_table_2():
    eps = np.arccos(1 / 1.5)
    assert contact.Steuermann()(0.5, 200) == pytest.approx(4 / 3 * 200 * np.sin(eps) * 0.5)
    factor = laws.fitted_coefficients()["liu"]["slope"]
    assert factor == pytest.approx(4.57, abs=0.01)
    expected = factor * 200 * 0.5 * np.sin(eps) * np.sin(eps / 2)
    assert contact.Liu()(0.5, 200) == pytest.approx(expected)


@every_variant
@given(ds=depths, r2_star=radii)
def test_derivative_is_that_of_the_force_and_positive(name, ds, r2_star):
    law, step = VARIANTS[name](r2_star), 1e-5 * ds
    slope = (law(ds + step, r2_star) - law(ds - step, r2_star)) / (2 * step)
    assert law(ds, r2_star, derivative=True) == pytest.approx(slope, rel=1e-6)
    assert min(slope, law(ds, r2_star)) > 0
    for derivative in (False, True):
        assert not law([-ds, 0.0], r2_star, derivative=derivative).any()  # without contact


@pytest.mark.parametrize("name", [name for name in VARIANTS if "stiffened" not in name])
def test_laws_broadcast(name):
    law = VARIANTS[name](200)
    ds, r2 = np.array([-0.1, 0.0, 0.2, 0.5]), np.array([[20.0], [300.0]])
    table = law(ds, r2)
    assert table.shape == (2, 4)
    assert table[1, 3] == pytest.approx(law(0.5, 300.0), rel=1e-12)
    assert isinstance(law(0.5, 300.0), float)


@pytest.mark.parametrize("name", contact.LAWS)
def test_every_name_stands_for_a_law_of_a_joint(name):
    joint = Joint.from_ratios(200)
    law = contact.LAWS[name].of(joint)
    assert law.name == name
    assert law(0.3, 200) == pytest.approx(joint.law(name).force(0.3 / 200) / joint.force_unit)
    assert laws.find(law) is law
    for number, value in law.numbers.items():
        assert f"{number}=" in repr(law)
        assert value is None or str(value) in repr(law)


@every_variant
def test_a_power_of_the_depth_says_so(name):
    law, ds = VARIANTS[name](200), np.array([0.01, 0.3])
    exponents = ds * law(ds, 200, derivative=True) / law(ds, 200)
    assert (law.exponent_of_depth is None) == (np.ptp(exponents) > 1e-3)
    assert exponents[0] == pytest.approx(law.exponent_of_depth or exponents[0], rel=1e-12)


def test_stored_coefficients_are_the_fit_to_the_stored_curves():
    fitted = fitting.fit_laws(dataset.load(), store.read(store.TABLES))
    assert fitted.keys() == laws.fitted_coefficients().keys()
    for law, stored in laws.fitted_coefficients().items():
        assert stored == pytest.approx(fitted[law], rel=1e-7)


def test_tabulated_law_is_its_curve():
    joint, between = Joint.from_ratios(200), np.linspace(0.031, 0.997, 30) ** 2
    curve = joint.solve(depth_star=np.linspace(0.025, 1, 40) ** 2, resolution=640)
    law = contact.Table.of_curve(curve)
    assert law(curve.depth_star) == pytest.approx(curve.force_star, rel=1e-6)
    exact = joint.solve(depth_star=between, resolution=640).force_star
    assert np.abs(law(between) / exact - 1).max() < 1e-4
    assert law(1e-9) == pytest.approx(contact.Hertz()(1e-9, 200), rel=1e-3)
    stiffness = law(np.linspace(1e-3, 1, 3001), derivative=True)
    assert (np.diff(stiffness, prepend=0) > 0).all()  # the contact stiffens, without a jump
