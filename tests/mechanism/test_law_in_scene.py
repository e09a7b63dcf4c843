"""The materials of a scene, and the laws of its clearance joint."""

from functools import partial

import pytest
from helpers.with_hertz import simulate

from study import contact, mechanism
from study.joint import Joint, Material
from study.mechanism import Scene, compare, paper_scene
from study.mechanism.law_in_scene import clearance_joint, of_name

BRONZE, STEEL = Material(1.1e11, 0.34), Material(2.07e11, 0.3)
PAPER, MIXED = paper_scene(), paper_scene(socket=BRONZE)
BRIEF = {"duration": 2e-3, "outputs": 20}
RADII = "ball_radius", "socket_radius"


def test_materials_are_those_of_all_bodies_or_a_bodys_own():
    assert PAPER.materials == (STEEL, STEEL)
    assert MIXED.materials == (STEEL, BRONZE)
    assert PAPER.replace(ball=BRONZE, poisson=0.25).materials == (BRONZE, Material(2.07e11, 0.25))
    expected = contact.composite_modulus(2.07e11, 0.3, 1.1e11, 0.34)
    assert MIXED.composite_modulus == expected
    assert PAPER.replace(ball=STEEL, socket=STEEL).composite_modulus == PAPER.composite_modulus
    assert MIXED.link("crank") == PAPER.link("crank")


@pytest.mark.parametrize("model", ["rigid", "particles", "beams"])
@pytest.mark.parametrize("name", ["stiffened_hertz", "tabulated"])
def test_a_name_stands_for_the_law_of_the_scenes_joint(name, model):
    ratios = Joint.from_ratios(200, ball=STEEL, socket=BRONZE)
    laws = name, clearance_joint(MIXED).law(name), contact.LAWS[name].of(ratios)
    by_name, *given = (simulate(MIXED, law=law, model=model, **BRIEF) for law in laws)
    for response in given:
        for quantity in ("peak_force", "peak_depth"):
            found, expected = (of.impacts[quantity][0] for of in (response, by_name))
            assert found == pytest.approx(expected, rel=1e-6)
    first, force = by_name.impacts.iloc[0], by_name.law.force
    # damping adds to it: the force's peak is before the depth's
    assert force(first.peak_depth) < first.peak_force < 1.5 * force(first.peak_depth)
    assert repr(by_name.law).startswith(f"{name} of Joint(socket_radius=0.01, clearance=5e-05, ")


def test_a_law_without_a_joint_takes_the_dimensions_of_the_scene():
    sizes = {name: getattr(MIXED, name) for name in (*RADII, "composite_modulus")}
    for law, told in (
        ("hertz", "Hertz()"),
        (contact.Winkler(), "Winkler(coefficient=that of the reference joint)"),
        (contact.Steuermann(2, "profile"), "Steuermann(n=2, radius=profile)"),
    ):
        response = simulate(MIXED, law=law, **BRIEF)
        same = simulate(MIXED, law=contact.DimensionalLaw(law, **sizes), **BRIEF)
        assert response.rows.tobytes() == same.rows.tobytes()
        assert repr(response.law) == told
    assert simulate(MIXED, joint="ideal", **BRIEF).law is None


def test_a_joint_with_dimensions_is_a_law():
    run = partial(simulate, MIXED, law=clearance_joint(MIXED, wall=3e-3), **BRIEF)
    response, joint = run(), Joint(10e-3, 5e-5, 3e-3, STEEL, BRONZE)
    assert "wall=0.003" in repr(response.law)
    for law in (joint, joint.law(), of_name(MIXED, wall=3e-3)):
        assert simulate(MIXED, law=law, **BRIEF).rows.tobytes() == response.rows.tobytes()
    assert compare.second_run(response, run).lasts


def test_a_liner_is_softer_and_counts_with_its_own_modulus():
    liner = ("0.5e-3,PTFE",)
    lined = Joint(10e-3, 5e-5, 3e-3, STEEL, BRONZE, liner)
    bare = simulate(MIXED, law=of_name(MIXED, wall=3e-3), **BRIEF).impacts
    for scene in (PAPER, MIXED):  # without materials, and with those of ball and socket
        response = simulate(scene, law=lined, **BRIEF)
        assert response.impacts.peak_force[0] < 0.6 * bare.peak_force[0]
        assert response.impacts.peak_depth[0] > 1.5 * bare.peak_depth[0]
        assert response.law.composite_modulus == lined.composite_modulus
    by_name = simulate(MIXED, law=of_name(MIXED, wall=3e-3, liner=liner), **BRIEF)
    assert by_name.rows.tobytes() == response.rows.tobytes()


def test_the_default_law_of_a_socket():
    assert of_name(MIXED) == "stiffened_hertz"
    assert of_name(MIXED, socket_ratio=1.5).name == "stiffened_hertz"
    assert of_name(MIXED, wall=5e-3).name == "tabulated"


def test_a_scene_outside_the_range_of_the_default_law_has_its_table():
    scene = Scene(poisson=0.1)
    assert len(mechanism.simulate(scene, law="tabulated", **BRIEF).impacts) == 1
    assert mechanism.simulate(scene, joint="ideal", **BRIEF).law is None
