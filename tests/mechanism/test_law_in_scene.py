"""The scene's materials, and laws of other materials, which are refused."""

import re
from dataclasses import replace
from functools import partial

import pytest
from helpers.with_hertz import simulate
from other_programs import odes

from study import contact, mechanism
from study.choose import choose, choose_model
from study.joint import Joint, Layer, Material
from study.measure import explicit
from study.mechanism import Scene, compare, paper_scene

BRONZE, STEEL = Material(1.1e11, 0.34), Material(2.07e11, 0.3)
PAPER, MIXED = paper_scene(), paper_scene(socket=BRONZE)
BRIEF = {"duration": 2e-3, "outputs": 20}
OPTIONS = {"modulus_ratio": 1.1 / 2.07, "poisson": 0.3, "socket_poisson": 0.34}


def table(**joint):
    return contact.Table.of_curve(Joint.from_ratios(200, **joint).curve())


def test_materials_are_those_of_all_bodies_or_a_bodys_own():
    assert PAPER.materials == (STEEL, STEEL)
    assert MIXED.materials == (STEEL, BRONZE)
    assert PAPER.replace(ball=BRONZE, poisson=0.25).materials == (BRONZE, Material(2.07e11, 0.25))
    expected = contact.composite_modulus(2.07e11, 0.3, 1.1e11, 0.34)
    assert MIXED.composite_modulus == expected
    assert PAPER.replace(ball=STEEL, socket=STEEL).composite_modulus == PAPER.composite_modulus
    assert MIXED.link("crank") == PAPER.link("crank")


def test_parameters_name_a_material_only_where_one_was_given():
    usual = PAPER.parameters().parameter
    assert not usual.isin(["ball", "socket"]).any()
    row = MIXED.parameters().set_index("parameter").loc["socket"]
    assert (row.value, row.unit, row.table) == ("1.1e+11,0.34", "Pa, 1", "-")


@pytest.mark.parametrize("name", ["youngs_modulus", "link_modulus"])
def test_a_modulus_in_another_unit_is_a_hint(name):
    message = f"{name} must be >= 100000 Pa, got 210 Pa: did you mean 210e9?"
    with pytest.raises(ValueError, match=re.escape(message) + "$"):
        Scene(**{name: 210})


def test_stiffened_hertz_takes_materials_from_the_scene():
    found, stated = (
        simulate(MIXED, law="stiffened_hertz", **given, **BRIEF) for given in ({}, OPTIONS)
    )
    assert found.impacts.equals(stated.impacts)
    assert found.law == (
        "stiffened_hertz: socket_ratio 1.298 (that of the reference joint), "
        "modulus_ratio 0.531400966, poisson 0.3, socket_poisson 0.34, "
        "ball_support guided, rim mirror"
    )
    law = contact.DimensionalLaw(
        "stiffened_hertz",
        ball_radius=MIXED.ball_radius,
        socket_radius=MIXED.socket_radius,
        composite_modulus=MIXED.composite_modulus,
        socket_ratio=contact.SOCKET_RATIO,
        **OPTIONS,
    )
    force = law.force(found.impacts.peak_depth[0])
    # damping adds to it: the force's peak is before the depth's
    assert force < found.impacts.peak_force[0] < 1.5 * force


@pytest.mark.parametrize(("name", "other"), [(name, 1.01 * OPTIONS[name]) for name in OPTIONS])
def test_options_of_other_materials_are_refused(name, other):
    message = f"{name} of law stiffened_hertz must be {OPTIONS[name]:.9g}, "
    with pytest.raises(ValueError, match=re.escape(message)):
        simulate(MIXED, law="stiffened_hertz", **BRIEF, **{name: other})


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({}, "modulus_ratio of law tabulated must be 0.531400966, .* got 1"),
        (
            {"ball": STEEL, "socket": replace(BRONZE, poisson=0.3)},
            "socket_poisson of law tabulated",
        ),
    ],
)
def test_a_curve_of_other_materials_is_refused(joint, message):
    with pytest.raises(ValueError, match=message):
        simulate(MIXED, law=table(**joint), **BRIEF)


def test_a_curve_of_the_scenes_materials_drives_it():
    response = simulate(MIXED, law=table(ball=STEEL, socket=BRONZE), **BRIEF)
    assert len(response.impacts) == 1
    assert response.law.startswith(
        "tabulated: r2_star 200, socket_ratio 1.298, ball_support guided"
    )
    layers = Layer(1.1, BRONZE), Layer(1.4, STEEL)
    lined = table(ball=STEEL, layers=layers)
    assert "layers 1.1,0.531400966,0.34" in simulate(MIXED, law=lined, **BRIEF).law


@pytest.mark.parametrize("law", ["liu", "winkler", "hyperbolic_winkler"])
def test_fitted_laws_say_that_their_joint_was_another(law):
    note = "its coefficient is that of the reference joint, which has other materials"
    assert note in simulate(MIXED, law=law, **BRIEF).law
    assert note in simulate(PAPER.replace(poisson=0.4), law=law, **BRIEF).law
    assert note not in simulate(PAPER, law=law, **BRIEF).law
    if law != "liu":
        assert simulate(MIXED, law=law, coefficient=3.0, **BRIEF).law.endswith("coefficient 3")


def test_laws_without_materials_say_what_they_are():
    for law, told in (("hertz", "hertz"), ("steuermann", "steuermann: n 1, radius geometric")):
        assert simulate(MIXED, law=law, **BRIEF).law == told
    assert simulate(MIXED, joint="ideal", **BRIEF).law == "none"


def in_si_units(law, scene=PAPER, **options):
    radii = {"ball_radius": scene.ball_radius, "socket_radius": scene.socket_radius}
    modulus = {"composite_modulus": scene.composite_modulus}
    return contact.DimensionalLaw(law, **(radii | modulus | options))


@pytest.mark.parametrize("model", ["rigid", "particles", "beams"])
def test_a_law_with_dimensions_is_the_law_by_its_name(model):
    given = {"hertz": {}, "stiffened_hertz": OPTIONS | {"socket_ratio": 1.5}}
    for name, options in given.items():
        ours = simulate(MIXED, law=in_si_units(name, MIXED, **options), model=model, **BRIEF)
        ratio = {"socket_ratio": 1.5} if options else {}
        named = simulate(MIXED, law=name, model=model, **BRIEF, **ratio)
        assert ours.rows.tobytes() == named.rows.tobytes()
        assert ours.law == named.law


def test_the_table_of_the_scenes_joint_is_that_of_a_joint_with_dimensions():
    run = partial(simulate, MIXED, law="tabulated", wall=3e-3, **BRIEF)
    by_name = run()
    assert by_name.law.startswith("tabulated: r2_star 200, socket_ratio 1.3, ball_support guided")
    joint = Joint(10e-3, 5e-5, 3e-3, STEEL, BRONZE)
    for law in (joint, joint.law()):
        response = simulate(MIXED, law=law, **BRIEF)
        assert response.rows.tobytes() == by_name.rows.tobytes()
        assert response.law == by_name.law
    usual = simulate(MIXED, law="tabulated", **BRIEF)
    assert "socket_ratio 1.298" in usual.law
    stiffened = simulate(MIXED, law="stiffened_hertz", **BRIEF).impacts
    assert usual.impacts.peak_force[0] == pytest.approx(stiffened.peak_force[0], rel=2e-3)
    assert compare.second_run(by_name, run).lasts


def test_a_liner_is_softer_and_counts_with_its_own_modulus():
    liner = ("0.5e-3,PTFE",)
    lined = Joint(10e-3, 5e-5, 3e-3, STEEL, BRONZE, liner)
    bare = simulate(MIXED, law="tabulated", wall=3e-3, **BRIEF).impacts
    modulus = lined.composite_modulus
    for scene in (PAPER, MIXED):  # without materials, and with those of ball and socket
        response = simulate(scene, law=lined, **BRIEF)
        assert response.impacts.peak_force[0] < 0.6 * bare.peak_force[0]
        assert response.impacts.peak_depth[0] > 1.5 * bare.peak_depth[0]
        assert response.law.endswith(f"; with its own composite modulus, {modulus:.9g} Pa")
    by_name = simulate(MIXED, law="tabulated", wall=3e-3, liner=liner, **BRIEF)
    assert by_name.rows.tobytes() == response.rows.tobytes()


@pytest.mark.parametrize(
    ("scene", "law", "message"),
    [
        (PAPER, {"ball_radius": 9e-3}, "Scene(socket_radius=0.01, clearance=0.001)"),
        (MIXED, {"composite_modulus": 1e11}, "modulus E* of law must be 8.04"),
    ],
)
def test_a_law_of_another_joint_is_refused(scene, law, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        simulate(scene, law=in_si_units("hertz", **law), **BRIEF)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"n": 2}, "option of tabulated must be one of socket_ratio, liner, got 'n'"),
        ({"wall": 3e-3, "socket_ratio": 1.3}, "must be one of wall, liner, got 'socket_ratio'"),
        ({"socket_ratio": 0.9}, "wall must be >= 1e-06 and <= 9999.99 m, got -0.001 m"),
        ({"liner": "PTFE"}, "liner must be a thickness in m and a material"),
    ],
)
def test_options_of_the_scenes_joint(options, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        simulate(MIXED, law="tabulated", **options, **BRIEF)


def test_a_scene_outside_the_range_of_the_default_law_is_told_what_to_take():
    scene = Scene(poisson=0.1)
    told = "poisson of stiffened_hertz must be >= 0.2 and <= 0.46, got 0.1; use the law tabulated"
    with pytest.raises(ValueError, match=re.escape(told)):
        mechanism.simulate(scene, **BRIEF)
    assert len(mechanism.simulate(scene, law="tabulated", **BRIEF).impacts) == 1
    assert mechanism.simulate(scene, joint="ideal", **BRIEF).law == "none"


def test_a_law_with_options_inside_is_refused():
    inner = choose(Joint.from_ratios(200), 0.3, 0.01).evaluate
    with pytest.raises(ValueError, match="law must be a law without options"):
        simulate(PAPER, law=inner, **BRIEF)


def test_choice_of_a_model_solves_the_joint_of_the_scenes_materials():
    choice = choose_model(MIXED, 1.0, duration=3e-3, outputs=100)
    laws = {row["law"] for row in choice.evidence}
    assert laws == {"none", "hertz", "stiffened_hertz"}
    assert choice.note == "socket material is not that of the random scenes"


def test_models_that_measure_refuse_what_they_do_not_have():
    numbers = explicit.packed(PAPER, "hertz")
    options = {"duration": 1e-4, "outputs": 10, "step": 1e-6, "scheme": "RK4"}
    for name, value in (("crank_speed", 10.0), ("crank_clearance", 1e-5)):
        with pytest.raises(ValueError, match=f"{name} does not apply to this"):
            explicit.integrate(PAPER.replace(**{name: value}), numbers, **options)


def test_explicit_steps_begin_where_the_scene_does():
    scene = PAPER.replace(initial_crank_angle=1.0, initial_crank_speed=30.0)
    numbers = explicit.packed(scene, "hertz")
    _, depth = explicit.integrate(scene, numbers, 3e-3, 30, 1e-6, "RK4")
    ours = simulate(scene, duration=3e-3, outputs=30)
    before = ours.time < ours.impacts.time[0]
    assert before.sum() > 3
    assert depth[before] == pytest.approx(ours.depth[before], abs=1e-11)


def test_other_integrators_begin_where_the_scene_does():
    scene = PAPER.replace(initial_crank_angle=1.0, initial_crank_speed=30.0)
    numbers = explicit.packed(scene, "hertz")
    found = odes.slider_acceleration("DOP853", scene, numbers, 3e-3, 300, 1e-8)
    ours = simulate(scene, duration=3e-3, outputs=300, tolerance=1e-8).slider_acceleration
    assert abs(ours).max() > 100
    assert found == pytest.approx(ours[1:], abs=1e-3 * abs(ours).max())


def test_a_packed_law_is_that_of_the_scenes_materials():
    numbers = [explicit.packed(scene, "stiffened_hertz").tolist() for scene in (PAPER, MIXED)]
    assert numbers[0] != numbers[1]
