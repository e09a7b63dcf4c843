"""Wrong inputs of laws, joints, materials and fits, and what the message of each says."""

import re
from math import inf, nan, sin

import numpy as np
import pytest

from study import checks, contact
from study.contact import (
    DimensionalLaw,
    Material,
    Power,
    Steuermann,
    Table,
    laws,
    material,
    materials,
)
from study.contact.forces import damping_factor
from study.contact.power_fit import fit_power
from study.joint import Joint

SIZES = {"ball_radius": 9.95e-3, "socket_radius": 10e-3, "composite_modulus": 1.1e11}
SMALLER = SIZES | {"ball_radius": 9e-3}
JOINT = Joint.from_ratios(200)
STIFF = contact.StiffenedHertz.of(JOINT)
BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
FORCES = {name: DimensionalLaw(name, **SIZES) for name in ("hertz", "hyperbolic_winkler")}


def of_values(function):
    depths = np.linspace(0.02, 1, 50) ** 2
    return Table.of_values(depths, function(depths), 200)


def of_curve(*depths):
    return Table.of_curve(JOINT.solve(depth_star=depths, resolution=64))


INPUTS = [
    (lambda: contact.Hertz()(0.1, 1.0), "r2_star must be > 1, got 1"),
    (lambda: contact.Hertz()([0.1, inf], 200), "depth_star must be finite, got inf"),
    (lambda: contact.Hertz()(np.ma.array([0.1], mask=[True]), 200), "a number, got masked_array"),
    (lambda: contact.Hertz()(0.1), "r2_star must be a number, got None"),
    (lambda: contact.Hertz()([0.1, 0.2], [20, 30, 40]), "shape mismatch"),
    (lambda: STIFF(1.01), "stiffened_hertz must be <= 1, got 1.01"),
    (lambda: STIFF(0.1, 100), "r2_star must be 200, that of the joint of this law, got 100"),
    (
        lambda: contact.StiffenedHertz.of(Joint.from_ratios(19)),
        "r2_star of stiffened_hertz must be >= 20, got 19; use the law tabulated",
    ),
    (lambda: contact.HyperbolicWinkler(area="x"), "area must be one of flat, sphere, got 'x'"),
    (lambda: Steuermann(51), "n must be >= 1 and <= 50, got 51"),
    (lambda: contact.Winkler(-1), "coefficient must be > 0, got -1"),
    (lambda: Power(exponent=1.5), "must be given together"),
    (lambda: laws.find("hooke"), "law must be one of hertz, "),
    (lambda: laws.find(3), "law must be a name or a law, got 3"),
    (lambda: laws.find("tabulated"), "depends on the joint, which is not given"),
    (lambda: JOINT.table()(0.1, 100), "r2_star must be 200, that of the joint of this law"),
    (lambda: JOINT.table()(1.2), "depth_star of tabulated must be <= 1"),
    (lambda: of_curve(0.1, 0.2, 0.3, 0.4), "a tenth of the maximum, because a table is not"),
    (lambda: of_curve(0.1, 0.2, 0.3), "depth_star must be >= 4 different depths > 0, got 3"),
    # functions as laws
    (lambda: laws.find(sin), "make the law of a function from its values with Table.of_values"),
    (lambda: of_values(lambda ds: -ds), "must be > 0 and increase with depth_star, but it does"),
    (lambda: of_values(lambda ds: np.sin(4 * ds)), "but it does not at depth_star 0.40"),
    (lambda: of_values(lambda ds: ds * nan), "force_star must be finite, got nan"),
    (lambda: of_values(lambda ds: ds)(1.1), "depth_star of tabulated must be <= 1, got 1.1"),
    (lambda: of_values(lambda ds: ds)(0.1, 20), "r2_star must be 200, that of the joint"),
    # laws in SI units
    (lambda: DimensionalLaw("hooke", **SIZES), "law must be one of hertz, "),
    (
        lambda: DimensionalLaw("hertz", **SIZES | {"ball_radius": 0.011}),
        "socket_radius must be > 0.011 m, got 0.01 m",
    ),
    (lambda: DimensionalLaw("tabulated", **SIZES), "which is not given; take it from one"),
    (lambda: DimensionalLaw(STIFF, **SMALLER), "must be 200, that of the joint of the law"),
    (lambda: FORCES["hertz"].depth(-1.0), "force of hertz must be >= 0 N, got -1 N"),
    (lambda: FORCES["hertz"].depth(inf), "force of hertz must be finite and >= 0 N, got inf N"),
    (lambda: FORCES["hyperbolic_winkler"].force(1e-4), "must be <= 6.1685e-05 m, got 0.0001 m"),
    (lambda: Joint.from_ratios(ball=Material(1), socket=Material(1e12)), "must be >= 1e-09"),
    # damping
    (lambda: damping_factor("exact", 0.0), "for damping exact must be >= 0.001, got 0"),
    (lambda: damping_factor("flores", 1.5), "restitution must be >= 0 and <= 1, got 1.5"),
    (lambda: damping_factor("newton", 0.5), "damping must be one of lankarani-nikravesh, hunt-"),
    # fits
    (lambda: fit_power([1.0], [1.0]), "must be lists of the same length >= 2"),
    (lambda: fit_power([1.0, 1.0], [1.0, 2.0]), "depth must have two different values"),
    (lambda: fit_power([1.0, 2.0], [1.0, -2.0]), "force must be > 0, got -2"),
    (lambda: BRONZE.power_law((2e-6, 1e-6)), "maximum depth must be > 2e-06 m, got 1e-06 m"),
    # materials
    (lambda: material("bronz"), "material must be one of steel, bearing steel, stainless, bronze,"),
    (lambda: material("210e9"), "210GPa,0.3, got '210e9'"),
    (lambda: material(3), "material must be a Material, got 3"),
    (lambda: material("210,0.3"), "of material must be >= 100000 Pa, got 210 Pa: did you mean"),
    (lambda: material("69000,0.33"), "got 69000 Pa: did you mean 69e9?"),
    (lambda: material(Material(210, 0.3)), "got 210 Pa: did you mean 210e9?"),
]


@pytest.mark.parametrize(("call", "message"), INPUTS, ids=[message for _, message in INPUTS])
def test_wrong_input(call, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        call()


@pytest.mark.parametrize("law", [STIFF, contact.HyperbolicWinkler()])
def test_a_force_beyond_the_largest_depth_names_the_largest_force(law):
    name, law = law.name, DimensionalLaw(law, **SIZES)
    largest = law.force(law.deepest)
    assert law.depth(largest) == pytest.approx(law.deepest, rel=1e-9)
    message = f"force of {name} must be >= 0 and <= {largest:g} N, got {2 * largest:g} N"
    with pytest.raises(ValueError, match=re.escape(message)):
        law.depth([0.1 * largest, 2 * largest])


HEAD = "name,youngs_modulus,poisson,yield_stress,condition,source\n"


@pytest.mark.parametrize("content", ["", "name,poisson\nsteel,0.3\n", f"{HEAD}steel,abc,0.3,,c,s"])
def test_a_damaged_table_of_materials(content, tmp_path, monkeypatch):
    monkeypatch.setattr(materials, "MATERIALS", tmp_path / "materials.csv")
    monkeypatch.setattr(materials, "table", materials.table.__wrapped__)
    materials.MATERIALS.write_text(content)
    wanted = r"materials.csv is missing or damaged.*git checkout -- study/contact/materials.csv, "
    with pytest.raises(checks.StudyError, match=wanted):
        material("brass")
