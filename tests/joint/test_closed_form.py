"""The closed form of notebook 25 against exact curves of joints that had no part in its fit."""

import ast
import json
from math import pi
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import dataset, paths
from study.contact import Hertz
from study.joint.axial import at_nodes

OF_FORCE, OF_ANGLE, OF_PEAK = 0.035, 0.07, 0.12  # largest relative errors stated
ROOTS = np.linspace(0.001**0.5, 1, 40)


def definitions(name):
    """Functions and constants in capitals of a notebook, without running the rest."""
    cells = json.loads((paths.NOTEBOOKS / f"{name}.ipynb").read_text())["cells"]
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    tree, kept = ast.parse(code), (ast.Import, ast.ImportFrom, ast.FunctionDef)
    tree.body = [
        node
        for node in tree.body
        if isinstance(node, kept)
        or (isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) in ("NUMBERS", "RANGES"))
    ]
    found = {}
    exec(compile(tree, name, "exec"), found)
    return SimpleNamespace(**found)


form = definitions("25-formulas-with-few-constants")


def depth_at(force_star, r2_star, *bodies):
    """Depth at a force, without iteration."""
    x = np.cbrt(0.75 * force_star / np.sqrt(r2_star * (r2_star - 1)))
    return form.depth_of(x, r2_star, *bodies)


def random_joints(count, shares, seed):
    """Joints over the whole range: a pair of bodies for every four shares."""
    random = np.random.default_rng(seed)
    for number in range(count):
        if number % 4 == 0:
            ratio = 1 + 0.25 * 40 ** random.random()
            poissons = random.uniform(*form.RANGES["poisson"])
            poissons = poissons, random.uniform(*form.RANGES["socket_poisson"])
        share = (*shares, *random.random(2))[number % 4]
        yield form.joint_of_share(50 * 200 ** random.random(), share, ratio, *poissons)


@pytest.mark.slow
def test_error_of_force_on_joints_that_had_no_part_in_the_fit():
    worst = []
    for joint in random_joints(160, (0.0, 1.0), seed=3):
        nodes = at_nodes(joint, 1.0, 160)
        inside = nodes.depth_star >= 0.001
        depth, force = nodes.depth_star[inside], nodes.force_star[inside]
        found = form.force_at(depth, joint.r2_star, *form.bodies_of(joint))
        worst.append(np.abs(found / force - 1).max())
    assert max(worst) < OF_FORCE
    assert np.median(worst) < 0.02


def test_half_angle_and_peak_pressure():
    for joint in random_joints(40, (0.01, 1.0), seed=4):
        curve = joint.curve(resolution=160)
        inside = (curve.depth_star >= 0.001) & (curve.depth_star <= 1)
        depth, bodies = curve.depth_star[inside], form.bodies_of(joint)
        angle, peak = form.half_angle_and_peak(depth, joint.r2_star, *bodies)
        assert angle == pytest.approx(curve.contact_half_angle_deg[inside], rel=OF_ANGLE)
        assert peak == pytest.approx(curve.peak_pressure_star[inside], rel=OF_PEAK)


in_range = st.tuples(
    st.floats(50, 1e6),  # R2*
    st.floats(1e-4, 1 - 1e-4),  # share of the ball
    st.floats(1.25, 1e3),  # socket ratio
    st.floats(0.2, 0.4),  # Poisson's ratios of ball and socket
    st.floats(0.2, 0.46),
)


@given(in_range)
def test_limit_is_hertz(joint):
    shallow, r2_star = 1e-10, joint[0]
    assert form.force_at(shallow, *joint) == pytest.approx(Hertz()(shallow, r2_star), rel=2e-4)
    angle, peak = form.half_angle_and_peak(shallow, *joint)
    assert angle == pytest.approx(np.degrees(shallow**0.5), rel=1e-4)
    first_order = 1.1 / r2_star + 1e-4  # which angle and pressure leave out
    assert peak == pytest.approx(2 / pi * shallow**0.5, rel=first_order)


@given(in_range)
def test_depth_and_force_are_inverse_and_grow(joint):
    depth = ROOTS**2
    force = form.force_at(depth, *joint)
    assert depth_at(force, *joint) == pytest.approx(depth, rel=1e-9)
    for grows in (force, *form.half_angle_and_peak(depth, *joint)):
        assert (np.diff(grows) > 0).all()


@given(in_range, st.floats(0.01, 1))
def test_force_by_hand(joint, depth):
    """Seven steps of the fixed-point iteration that notebook and article give."""
    r2_star, x = joint[0], depth**0.5
    scale = 4 / 3 * np.sqrt(r2_star * (r2_star - 1))
    largest = (form.force_at(1.0, *joint) / scale) ** (1 / 3)
    for _ in range(7):
        x = min(x, largest)
        x *= (depth / depth_at(scale * x**3, *joint)) ** 0.6
    assert scale * x**3 == pytest.approx(form.force_at(depth, *joint), rel=1e-3)


def typed_depth(x, r2_star, q, nu1, nu2, s):
    """Depth for x, typed from the article's section on the closed form."""
    h = 0.8026 * (1 - nu2) + 1 / (1.466 * (1 - nu2) * (q**1.5 - 1))
    w = 0.5496 - 0.7285 * nu2 + 1 / (1.229 + (1.473 - 2.783 * nu2) * q**3)
    g = h * x / (1 + (h * x / w) ** 1.313) ** (1 / 1.313)
    b = x * (0.2549 + (0.6836 * nu1 - 0.2757) * x)
    t = 1 - (1 - g) * (1 + 0.1279 * x**4 * (1 - g) ** 2)
    y = x**2 * (1 - s * b - (1 - s) * t + s * (1 - s) * t * (0.76 * b + 0.1376 * t))
    return y + (1 - 2 * s) * y**2 / r2_star


def test_the_typed_formula_on_the_validation_joints():
    rows = dataset.load(group="validation", ball_support="guided", rim="mirror")
    rows = rows.query("r2_star >= 50 and socket_ratio >= 1.25 and poisson_ball <= 0.4")
    errors = []
    for _, case in rows.groupby("case"):
        one, depth = case.iloc[0], case.depth_star.to_numpy()
        of_ball, of_socket = 1 - one.poisson_ball**2, 1 - one.poisson_socket**2
        share = of_ball / (of_ball + of_socket / one.modulus_ratio)
        bodies = one.r2_star, one.socket_ratio, one.poisson_ball, one.poisson_socket, share
        x = np.sqrt(depth)
        for _ in range(7):
            x = x * (depth / typed_depth(x, *bodies)) ** 0.6
        force = 4 / 3 * x**3 * np.sqrt(one.r2_star * (one.r2_star - 1))
        errors.append(np.abs(force / case.force_star.to_numpy() - 1).max())
    assert len(errors) > 100
    assert max(errors) < 0.034  # as the article states
    assert np.median(errors) < 0.018


def test_at_most_16_numbers_of_4_digits():
    numbers = form.NUMBERS.values()
    assert len(numbers) <= 16
    assert all(float(f"{number:.4g}") == number for number in numbers)
