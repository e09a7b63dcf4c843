"""Stresses against closed forms, equilibrium and other programs; first yield."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest
from helpers.programs import needs_calculix
from hypothesis import given, settings
from hypothesis import strategies as st
from other_programs import calculix

from study.contact import Hertz
from study.joint import Joint, Layer, Material, first_yield, modes, stress, yielding
from study.joint.compliance import HatFunctions
from study.joint.supports import HEIGHT

RATIOS = Joint.from_ratios
SMALL = RATIOS(200, kinematics="small")
BODIES = {"ball": (0.5, 0.97), "socket": (1.02, 1.25)}
"""Bodies -> radii inside them."""


@pytest.fixture(scope="module")
def curve():
    return SMALL.solve(depth_star=[0.05, 0.5])


def steel(yield_stress, youngs_modulus=2e11):
    return Material(youngs_modulus, 0.3, yield_stress)


def test_von_mises_of_plain_states():
    states = np.array([[-1, -1, -1, 0], [2, 0, 0, 0], [0, 0, 0, 1], [1, 3, 2, 0]]).T
    assert stress.von_mises(states) == pytest.approx([0, 2, np.sqrt(3), np.sqrt(3)])


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
def test_a_small_contact_is_that_of_hertz_on_half_spaces(poisson):
    joint = RATIOS(1e6, 50, poisson=poisson, kinematics="small")
    found = joint.solve(depth_star=2e-5, resolution=640, stresses=True)
    edge, peak = np.sqrt(2e-5), 2 / np.pi * np.sqrt(2e-5)
    depth = np.array([0.1, 0.3, 0.48, 1.0, 2.0])  # Johnson, Contact Mechanics, Eq. 3.45
    along = -1 / (1 + depth**2)
    across = -(1 + poisson) * (1 - depth * np.arctan(1 / depth)) - along / 2
    for body, side in (("ball", -1), ("socket", 1)):
        inside = stress.stresses(found, body, 1 + side * edge * depth, 0.0)[:, 0, :, 0] / peak
        assert inside[0] == pytest.approx(along, abs=5e-3)
        assert inside[1:3] == pytest.approx(np.array([across, across]), abs=5e-3)
        largest = found.stress[body]
        assert largest.von_mises / peak == pytest.approx(
            yielding.hertz_von_mises(poisson), rel=5e-3
        )
        assert largest.place == ("below the surface",)
    if poisson == 0.3:
        assert largest.over_peak == pytest.approx(0.62, abs=5e-3)
        assert largest.radius == pytest.approx(1 + 0.48 * edge, abs=0.03 * edge)


@pytest.mark.parametrize("poisson", [-0.5, 0.0, 0.3, 0.5 - 1e-9])
def test_limit_of_hertz(poisson):
    known = {-0.5: 2 / np.sqrt(3), 0.3: 0.6200}  # pure shear at the edge; Johnson's 0.62
    found = yielding.hertz_von_mises(poisson)
    assert found == pytest.approx(known.get(poisson, found), abs=1e-4)
    assert 0.5 < found < 1.2


def test_uniform_pressure_gives_the_stresses_of_lame(curve):
    uniform = replace(curve, pressure_star=np.ones_like(curve.pressure_star))
    inside = stress.stresses(uniform, "ball", [0.1, 0.6, 1.0], [0.0, 1.0, np.pi / 2])
    assert inside[:3] == pytest.approx(-np.ones_like(inside[:3]), abs=1e-5)
    nu, q = 0.3, SMALL.socket_ratio
    spread = (1 + nu) / (1 - 2 * nu)  # A r + B/r^2, over 2 G; zero at the outer sphere
    a = -1 / (spread + 2 * q**3)
    radius = np.array([1.0, 1.1, q])
    radial = spread * a + 2 * q**3 * a / radius**3
    hoop = spread * a - q**3 * a / radius**3
    inside = stress.stresses(uniform, "socket", radius, [0.3])[:, 0, :, 0]
    assert inside == pytest.approx(np.array([radial, hoop, hoop, 0 * hoop]), abs=1e-5)


@pytest.mark.parametrize("body", BODIES)
def test_stresses_are_in_equilibrium(curve, body):
    step = 1e-4
    for radius in BODIES[body]:
        angles = np.array([0.1, 0.4, 0.7, 1.3])
        near = radius + step * np.array([-1, 0, 1])
        here, before, after = (
            stress.stresses(curve, body, near, angles + shift) for shift in (0, -step, step)
        )
        by_radius = (here[:, :, 2] - here[:, :, 0]) / (2 * step)
        by_angle = (after - before)[:, :, 1] / (2 * step)
        radial, polar, around, shear = here[:, :, 1]
        cotangent = 1 / np.tan(angles)
        along = by_radius[0] + (2 * radial - polar - around) / radius
        along += (by_angle[3] + shear * cotangent) / radius
        across = by_radius[3] + (by_angle[1] + 3 * shear) / radius
        across += (polar - around) * cotangent / radius
        scale = np.abs(here).max() / radius
        assert np.abs([along, across]).max() < 2e-5 * scale


@pytest.mark.parametrize("body", BODIES)
def test_resultants_are_the_force(curve, body):
    force = curve.pressure_star @ HatFunctions(np.radians(curve.angle_deg)).integrate(np.cos)
    # the curve's force is extrapolated from two meshes, its pressure is that of the finer one
    assert curve.joint.r2_star * force == pytest.approx(curve.force_star, rel=1e-5)
    inner, outer = (0, 1) if body == "ball" else (1, SMALL.socket_ratio)
    x, w = np.polynomial.legendre.leggauss(40)
    radius, angle = inner + (outer - inner) * (x + 1) / 2, np.pi / 4 * (x + 1)
    polar = stress.stresses(curve, body, radius, np.pi / 2)[1, :, :, 0]
    equator = np.pi * (outer - inner) * polar @ (w * radius)
    if body == "ball":
        assert -equator == pytest.approx(force, rel=1e-4, abs=1e-9)
    else:
        radial, _, _, shear = stress.stresses(curve, body, outer, angle)[:, :, 0]
        axial = radial * np.cos(angle) - shear * np.sin(angle)
        sphere = 2 * np.pi * outer**2 * np.pi / 4 * axial @ (w * np.sin(angle))
        assert equator - sphere == pytest.approx(force, rel=1e-3, abs=1e-9)


def test_surfaces_carry_the_pressure_and_the_outer_sphere_is_held(curve):
    angles, nodes = np.linspace(0, 1.5, 40), np.radians(curve.angle_deg)
    pressure = np.array([np.interp(angles, nodes, of) for of in curve.pressure_star])
    for body in BODIES:
        radial, _, _, shear = stress.stresses(curve, body, 1.0, angles)[:, :, 0]
        assert radial == pytest.approx(-pressure, abs=1e-3 * pressure.max())
        assert np.abs(shear).max() < 1e-9
        equator = stress.stresses(curve, body, BODIES[body], np.pi / 2)[3]
        assert np.abs(equator).max() < 1e-9
    radial, polar, around, _ = stress.stresses(curve, "socket", SMALL.socket_ratio, angles)[:, :, 0]
    assert polar == pytest.approx(0.3 / 0.7 * radial, abs=1e-9)  # no strain along the sphere
    assert around == pytest.approx(polar, abs=1e-9)


@pytest.mark.parametrize("body", BODIES)
def test_stresses_at_the_surface_converge(body):
    found = [
        stress.stresses(of_resolution, body, 1.0, [0.0, 0.3, 0.6])[:, 0, 0]
        for of_resolution in (
            SMALL.solve(depth_star=0.5, resolution=n) for n in (64, 128, 256, 512)
        )
    ]
    errors = [np.abs(other - found[-1]).max() for other in found[:-1]]
    assert errors[0] > 4 * errors[1]
    assert errors[1] > errors[2]
    assert errors[2] < 1e-4


def both_ways(joint, depth):
    """Solutions with stresses by the series and by elements."""
    return (
        joint.solve(depth_star=depth, solver=solver, stresses=True)
        for solver in ("series", "quadratic")
    )


@pytest.mark.parametrize("kinematics", ["small", "linear"])
def test_elements_have_the_stresses_of_the_series(kinematics):
    joint = RATIOS(50, 1.2, socket=Material(1e11, 0.4), kinematics=kinematics)
    exact, found = both_ways(joint, [0.02, 0.1, 0.5])
    for body in BODIES:
        a, b = exact.stress[body], found.stress[body]
        assert b.von_mises == pytest.approx(a.von_mises, rel=5e-3)
        assert b.place == a.place
        assert b.radius * np.cos(b.angle) == pytest.approx(a.radius * np.cos(a.angle), abs=0.03)


@needs_calculix
def test_largest_stress_is_that_of_calculix(tmp_path):
    joint, depth, resolution = RATIOS(200, ball_support="clamped", rim="free"), 0.2, 64
    text = calculix.deck(joint, [depth], resolution)
    output = "*EL FILE, OUTPUT=2D, FREQUENCY=1000\nS\n*END STEP"
    (tmp_path / "joint.inp").write_text(text.replace("*END STEP", output))
    subprocess.run(["ccx", "joint"], cwd=tmp_path, capture_output=True, check=True)
    block = (tmp_path / "joint.frd").read_text().split(" -4  STRESS")[1].split("\n -3")[0]
    lines = [line[13:] for line in block.splitlines() if line.startswith(" -1")]
    rows = [[float(line[i : i + 12]) for i in (0, 12, 24, 36)] for line in lines]
    found = joint.r2_star * stress.von_mises(np.array(rows).T)
    meshes = [modes.meshed(of, resolution).mesh for of in (joint.ball_body, joint.socket_body)]
    radius, height = np.hstack([mesh.doflocs for mesh in meshes])
    # its contact scatters at the three nodes next to the axis
    inside = (height > HEIGHT) & (radius > 0.02 * height)
    first = meshes[0].doflocs.shape[1]
    own = joint.solve(depth_star=depth, stresses=True).stress
    bodies = {"ball": slice(None, first), "socket": slice(first, None)}
    for body, its in bodies.items():
        assert (found * inside)[its].max() == pytest.approx(own[body].von_mises[0], rel=5e-3)


def test_layers_of_one_material_are_one_socket():
    layers = Layer(1.1, Material()), Layer(1.298, Material())
    one, two = (joint.solve(depth_star=0.3) for joint in (RATIOS(200), RATIOS(200, layers=layers)))
    for body, radius in (("liner 1", [1.0, 1.05, 1.1]), ("socket", [1.1, 1.2, 1.298])):
        expected = stress.stresses(one, "socket", radius, [0.0, 0.2, 1.0])
        found = stress.stresses(two, body, radius, [0.0, 0.2, 1.0])
        assert found == pytest.approx(expected, abs=1e-10)


def test_a_liner_hands_its_stress_to_the_housing():
    layers = Layer(1.1, Material(2e9, 0.4)), Layer(1.3, Material())
    exact, found = both_ways(RATIOS(200, layers=layers), [0.02, 0.3])
    inner, outer = (
        stress.stresses(exact, body, 1.1, [0.0, 0.2, 1.0]) for body in ("liner 1", "socket")
    )
    assert inner[[0, 3]] == pytest.approx(outer[[0, 3]], abs=1e-9)
    assert list(exact.stress) == ["ball", "liner 1", "socket"]
    assert exact.stress["socket"].place[1] == "at an interface"
    for body, one in exact.stress.items():
        other = found.stress[body]
        assert other.von_mises == pytest.approx(one.von_mises, rel=3e-3)
        assert other.place == one.place
    weak = Layer(1.3, Material(2e11, 0.3, 1e6))
    assert first_yield(RATIOS(200, layers=(layers[0], weak))).body == "socket"


def test_a_thin_incompressible_socket_is_sheared_at_its_outer_sphere():
    joint = RATIOS(200, 1.02, socket_poisson=0.49)
    assert joint.solve(depth_star=0.05, stresses=True).stress["socket"].place == ("outside",)


def test_yield_stress_changes_neither_force_nor_equality():
    assert steel(1e9) == Material()
    assert hash(steel(1e9)) == hash(Material())


@settings(max_examples=10)
@given(
    r2_star=st.floats(20, 1000),
    ratio=st.sampled_from([1.05, 1.298, 3.0]),
    yield_stress=st.floats(1e8, 2e9),
    scale=st.floats(0.01, 10),
)
def test_first_yield(r2_star, ratio, yield_stress, scale):
    def yields(yield_stress, modulus=2e11):
        return first_yield(RATIOS(r2_star, ratio, ball=steel(yield_stress, modulus)))

    first, again = yields(yield_stress), yields(scale * yield_stress, scale * 2e11)
    later = yields(1.2 * yield_stress)
    if first is None:
        assert again is None
        assert later is None
        return
    assert again.depth_star == pytest.approx(first.depth_star, rel=1e-9)
    assert later is None or later.depth_star > 1.1 * first.depth_star
    joint = RATIOS(r2_star, ratio)
    found = joint.solve(depth_star=first.depth_star, stresses=True)
    strength = r2_star * yield_stress / joint.composite_modulus
    largest = {body: one.von_mises[0] for body, one in found.stress.items()}
    assert max(largest, key=largest.get) == first.body or np.ptp([*largest.values()]) < 0.01
    assert max(largest.values()) == pytest.approx(strength, rel=5e-3)
    assert found.force_star == pytest.approx(first.force_star, rel=2e-3)


def test_a_weak_joint_yields_as_hertz_tells():
    joint = RATIOS(200, ball=steel(1e5))  # and a socket of the same steel
    first = first_yield(joint, 0.3)
    strength = 200 * 1e5 / joint.composite_modulus
    root = strength * np.pi / 2 * np.sqrt(joint.radius_ratio) / yielding.hertz_von_mises(0.3)
    assert first.depth_star == pytest.approx(root**2, rel=5e-3)
    assert first.force_star == pytest.approx(Hertz()(first.depth_star, 200), rel=5e-3)


def test_only_bodies_with_a_yield_stress_yield():
    weak, weakest, plain = steel(1e10), steel(2e8), Material()
    assert first_yield(RATIOS(200, ball=weakest, socket=plain)).body == "ball"
    assert first_yield(RATIOS(200, socket=weakest)).body == "socket"
    assert first_yield(RATIOS(200, ball=weakest, socket=plain), 0.01) is None
    assert first_yield(RATIOS(200, ball=weak, socket=plain)) is None


def test_elements_yield_as_the_series_does():
    series, free = (first_yield(RATIOS(100, ball=steel(4e8), rim=of)) for of in ("mirror", "free"))
    assert free.depth_star == pytest.approx(series.depth_star, rel=0.01)
