"""Laws in SI units: their dimensions and their inverse."""

import numpy as np
import pytest
from helpers.laws import VARIANTS

from study.contact import DimensionalLaw
from study.joint import Joint

SIZES = {"ball_radius": 9.95e-3, "socket_radius": 10e-3, "composite_modulus": 1.1e11}
CLEARANCE = SIZES["socket_radius"] - SIZES["ball_radius"]
LAWS = {name: law(SIZES["socket_radius"] / CLEARANCE) for name, law in VARIANTS.items()}
SOFT = Joint.from_ratios(200, 1.5, modulus_ratio=0.0035, socket_poisson=0.46).table()
LAWS["table of a soft socket"] = SOFT
every_variant = pytest.mark.parametrize("name", LAWS)


@every_variant
def test_force_and_stiffness_are_the_laws_with_dimensions(name):
    law = DimensionalLaw(LAWS[name], **SIZES)
    depth = CLEARANCE * np.array([[-0.1, 0.0, 1e-6], [0.1, 0.5, 1.0]])
    for derivative, found in ((False, law.force(depth)), (True, law.stiffness(depth))):
        star = LAWS[name](depth / CLEARANCE, law.r2_star, derivative=derivative)
        unit = SIZES["composite_modulus"] * CLEARANCE ** (1 if derivative else 2)
        assert found == pytest.approx(unit * star, rel=1e-12)
    assert isinstance(law.force(1e-6), float)
    assert isinstance(law.stiffness(1e-6), float)


@every_variant
def test_depth_is_the_inverse_of_force(name):
    law = DimensionalLaw(LAWS[name], **SIZES)
    deepest = min(law.deepest, 10 * CLEARANCE)
    depth = np.append(0, deepest * np.logspace(-12, 0, 200)).reshape(3, 67)
    assert law.depth(law.force(depth)) == pytest.approx(depth, rel=1e-11)
    assert law.depth(0) == 0
    assert isinstance(law.depth(law.force(deepest)), float)
    if LAWS[name].deepest is None:
        force = np.array([1e-30, 1e-3, 1e6, 1e20])
        assert law.force(law.depth(force)) == pytest.approx(force, rel=1e-12)
