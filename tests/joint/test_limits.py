"""Limits of the solution: each is told where it is passed, and only there."""

from dataclasses import replace

import numpy as np
import pytest

from study.checks import UnitWarning
from study.joint import Joint, Material
from study.joint.limits import NEAR_RIM, in_short, limits
from study.mechanism import Scene, simulate
from study.mechanism.response import exceeded_limits

SIZES = 12.5e-3, 40e-6, 6e-3


@pytest.mark.parametrize(
    ("key", "inside", "beyond"),
    [
        ("yield", {"yield_factor": {"ball": 1.01}}, {"yield_factor": {"ball": 0.99}}),
        ("depth", {"depth_star": 1.0}, {"depth_star": 1.01}),
        ("strain", {"strain": 0.049}, {"strain": 0.051}),
        ("rim", {"to_rim": 6}, {"to_rim": 4}),
        ("wall", {"wall": 0.36, "half_angle_deg": 20}, {"wall": 0.34, "half_angle_deg": 20}),
        ("roughness", {"depth": 2.1e-6}, {"depth": 1.9e-6}),
    ],
)
def test_each_limit_alone(key, inside, beyond):
    usual = {"depth_star": 0.5}
    assert limits(**(usual | inside)) == {}
    found = limits(**(usual | beyond))
    assert list(found) == [key]
    assert in_short(found) == key


@pytest.mark.parametrize(
    ("ball_support", "opening", "edges", "to_rim"),
    [
        ("core:0.2", 110, (-66, 104), 6),
        ("core:0.2", "55:125", (61, 101), 6),
        ("core:0.2", "55:125", (79, 121), 4),
        ("bore:0.3,40", "45:135", (76, 131), 4),
    ],
)
def test_a_contact_off_the_axis_near_a_rim_or_the_edge_of_a_bored_ball(
    ball_support, opening, edges, to_rim
):
    joint = Joint.from_ratios(200, 3.0, ball_support=ball_support, opening=opening)
    solved = joint.solve(depth_star=0.1, tilt=60 if opening == 110 else 90, resolution=32)
    first, last = np.array(edges, float)[:, None]
    moved = replace(
        solved, contact_from_deg=first, contact_to_deg=last, reaches_rim=np.array([False])
    )
    assert moved.to_rim_deg == pytest.approx([to_rim])
    (found,) = moved.limits
    assert list(found) == (["rim"] if to_rim < NEAR_RIM else [])


def test_a_solution_tells_each_of_its_depths():
    found = Joint(*SIZES, socket="bronze").solve(depth=[1e-6, 4e-6, 60e-6], stresses=True)
    said = [in_short(each) for each in found.limits]
    assert said == ["roughness", "inside", "yield; depth; wall"]
    assert found.yield_factor["socket"][2] < 1
    without = replace(found, stress=None).limits
    assert [in_short(each) for each in without] == ["roughness", "inside", "depth; wall"]


def test_soft_bodies_are_solved_and_asked_about():
    with pytest.warns(UnitWarning):
        cup = Joint(*SIZES, "steel", "5e5,0.45")
    (found,) = cup.solve(force=0.2).limits
    assert "Young's modulus of the socket is 500000 Pa" in found["modulus"]
    hard, soft = (Joint(*SIZES, "steel", f"{e},0.45").law().force(4e-6) for e in (2e6, 5e5))
    assert soft == pytest.approx(hard * 5e5 / 2e6, rel=1e-3)


def test_limits_of_a_simulation(run):
    pressed = Scene(youngs_modulus=1.5e8, driving_moment=0.8)
    found = exceeded_limits(pressed, simulate(pressed, law="power", outputs=10))
    assert "to which the law power was fitted" in " ".join(found.values())
    response = simulate(duration=0.01, outputs=10)
    soft = Scene(socket=Material(5e5, 0.45, yield_stress=10.0))
    assert in_short(exceeded_limits(soft, response)) == "modulus; roughness; yield"
    unlike = Scene(ball="1e5,0.3", socket="1e22,0.3")
    assert "joint" in exceeded_limits(unlike, response)


def test_strains_are_those_of_the_softest_body():
    cup = Joint(16e-3, 1e-3, 8e-3, ball="steel", socket="UHMWPE").solve(depth=0.6e-3)
    strain = cup.peak_pressure[0] / 8e8
    assert 0.05 < strain < 1
    assert f"The peak pressure is {strain:.2g} times Young's modulus" in cup.limits[0]["strain"]
