"""Damping, friction and the compiled contact force against what they are meant to be."""

import mpmath
import numpy as np
import pytest
from helpers.impacts import free_impact
from helpers.laws import VARIANTS, packed
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from study import contact
from study.contact import forces
from study.contact.forces import damping_factor, delivered_restitution

R1, R2, MODULUS = 9.95e-3, 10e-3, 1.1e11
R2_STAR = R2 / (R2 - R1)
V0, V1 = 1e-4, 1e-2


@pytest.mark.parametrize(
    ("damping", "factor"),
    [("lankarani-nikravesh", 0.5625), ("hunt-crossley", 0.75), ("flores", 1.6), ("exact", 1.43275)],
)
def test_damping_factors_are_the_published_ones(damping, factor):
    assert damping_factor(damping, 0.5) == pytest.approx(factor, abs=5e-6)
    assert damping_factor(damping, 1.0) == 0
    assert free_impact(damping_factor(damping, 0.99))[0] == pytest.approx(0.99, abs=8e-4)


def test_only_exact_damping_delivers_its_restitution():
    for restitution in (0.05, 0.2, 0.5, 0.9, 0.999):
        separation, _ = free_impact(damping_factor("exact", restitution))
        assert separation == pytest.approx(restitution, abs=1e-7)
    separation, _ = free_impact(damping_factor("lankarani-nikravesh", 0.5))
    assert separation == pytest.approx(0.725, abs=5e-4)


@given(st.floats(-0.03, 0.03))
def test_friction_factor_is_ambrosios(speed):
    regime = forces.friction_regime(speed, V0, V1)
    factor, slope = forces.friction_factor(speed, regime, V0, V1)
    assert factor == pytest.approx(np.sign(speed) * np.clip((abs(speed) - V0) / (V1 - V0), 0, 1))
    assert slope == (1 / (V1 - V0) if abs(regime) == 1 else 0)


@pytest.mark.parametrize("restitution", [1e-3, 0.03, 0.5, 0.7, 0.75, 0.95, 1 - 1e-6, 1 - 1e-12])
def test_exact_damping_solves_its_equation_to_the_last_digits(restitution):
    found = damping_factor("exact", restitution)
    with mpmath.workdps(40):
        cr = mpmath.mpf(restitution)

        def off(share):  # of the range from 0 to 1/cr
            return mpmath.log((1 + share / cr) / (1 - share)) - share / cr * (1 + cr)

        low, high = (cr * (found + sign * (1e-15 + 1e-12 * found)) for sign in (-1, 1))
        assert off(low) < 0
        assert high >= 1 or off(high) > 0
    assert delivered_restitution(found) == pytest.approx(restitution, rel=1e-12)


@pytest.mark.parametrize("name", VARIANTS)
def test_compiled_force_is_the_law_and_the_energy_its_integral(name):
    sizes = {"ball_radius": R1, "socket_radius": R2, "composite_modulus": MODULUS}
    of_joint = contact.DimensionalLaw(VARIANTS[name](R2_STAR), **sizes)
    law, depths = of_joint.packed(), np.array([1e-9, 1e-7, 1e-6, 2.5e-5, R2 - R1])
    found = np.array([forces.elastic_force(law, d) for d in depths])
    close = 1e-11 if "stiffened" in name else 1e-13  # its nine numbers, up to 1e4, cancel
    assert found[:, 0] == pytest.approx(of_joint.force(depths), rel=close)
    assert found[:, 1] == pytest.approx(of_joint.stiffness(depths), rel=close)
    exact, _ = quad(lambda d: forces.elastic_force(law, d)[0], 0, 2e-5, epsabs=0, epsrel=1e-12)
    assert forces.stored_energy(law, 2e-5) == pytest.approx(exact, rel=1e-9)
    assert forces.stored_energy(law, -1e-6) == 0


@given(st.floats(1e-7, 5e-5), st.floats(-0.2, 0.2), st.floats(-0.02, 0.02))
def test_joint_forces_and_their_derivatives(depth, rate, sliding):
    law = packed("hertz", R1, R2, MODULUS)
    regime = forces.friction_regime(sliding, V0, V1)

    def at(depth, rate, sliding):
        return forces.joint_forces(law, depth, rate, sliding, regime, 0.1, 0.6, 0.05, V0, V1)

    normal, by_depth, by_rate, elastic, tangential, by_normal, by_sliding = at(depth, rate, sliding)
    _, stiffness = forces.elastic_force(law, depth)
    assert normal == pytest.approx(elastic * (1 + 6 * rate), rel=1e-12)
    assert tangential * sliding <= 0
    h = 1e-6
    assert by_depth == pytest.approx(stiffness * (1 + 6 * rate), rel=1e-12)
    change = at(depth, rate + h, sliding).normal - at(depth, rate - h, sliding).normal
    assert by_rate == pytest.approx(change / (2 * h), rel=1e-6)
    change = at(depth, rate, sliding + h).tangential - at(depth, rate, sliding - h).tangential
    assert by_sliding == pytest.approx(change / (2 * h), rel=1e-5, abs=1e-9 * abs(normal))
    assert by_normal * normal == pytest.approx(tangential, abs=1e-12 * abs(normal))


def test_there_is_no_friction_while_the_normal_force_pulls():
    law, sliding = packed("hertz", R1, R2, MODULUS), 2 * V1
    at = forces.joint_forces(law, 1e-5, -0.5, sliding, 2, 0.1, 0.6, 0.05, V0, V1)
    assert at.normal < 0 < at.elastic
    assert (at.tangential, at.tangential_by_normal, at.tangential_by_sliding) == (0, 0, 0)
