"""The choice of a law against joints solved anew, and of a model against finer ones."""

from itertools import islice, product

import numpy as np
import pandas as pd
import pytest

from study import choose, contact, paths
from study.checks import StudyError
from study.choose import links, random_scenes
from study.choose.cheapest_law import SHALLOWEST
from study.choose.model import ModelError, choose_model
from study.contact.damping import DAMPINGS
from study.joint import Joint, Layer, Material
from study.mechanism import Scene, compare, paper_scene, simulate

MATERIALS = 4
PER_MATERIAL = 8


def joint(r2_star=200.0, ratio=1.19, poisson=0.3, **options):
    return Joint.from_ratios(r2_star, ratio, poisson=poisson, **options)


def random_joints():
    """Joints at random in the dataset's range, largest depths, tolerances, exact curves."""
    draw = np.random.default_rng(11)
    for _ in range(MATERIALS):
        ratio, poisson = 1.1 * (3 / 1.1) ** draw.random(), draw.uniform(0.2, 0.45)
        for _ in range(PER_MATERIAL):
            scene = joint(20 * 500 ** draw.random(), ratio, poisson)
            deepest = SHALLOWEST * (1 / SHALLOWEST) ** draw.random()
            tolerance = 0.003 * 170 ** draw.random()
            depths = np.linspace(np.sqrt(SHALLOWEST), np.sqrt(deepest), 12) ** 2
            yield scene, deepest, tolerance, scene.solve(depth_star=depths)


def true_error(name, scene, curve):
    options = scene.law_options(contact.LAWS[name])
    force = contact.LAWS[name](curve.depth_star, scene.r2_star, **options)
    return np.abs(force / curve.force_star - 1).max()


def test_choice_is_within_tolerance_and_rarely_too_dear():
    """On random scenes that were not used to set the bounds."""
    costs, missed, laws = choose.relative_costs(), 0, set()
    for scene, deepest, tolerance, curve in random_joints():
        choice = choose.choose(scene, deepest, tolerance)
        laws.add(choice.law)
        if choice.law in contact.LAWS:
            assert true_error(choice.law, scene, curve) <= choice.error_bound
        elif choice.law == "tabulated":
            force = choice.evaluate(curve.depth_star)
            assert np.abs(force / curve.force_star - 1).max() <= tolerance
        cheaper = [name for name in contact.LAWS if costs[name] < costs[choice.law]]
        missed += any(true_error(name, scene, curve) <= tolerance for name in cheaper)
    assert missed <= 0.05 * MATERIALS * PER_MATERIAL
    assert {"hertz", "stiffened_hertz"} <= laws


@pytest.mark.parametrize(
    ("scene", "deepest"),
    [
        (joint(10.0), 0.3),
        (joint(ratio=1.05), 0.3),
        (joint(poisson=0.1), 0.3),
        (joint(), 1.1),
        (joint(), 0.003),
        (joint(ball_support="clamped"), 0.3),
        (Joint.from_ratios(200, modulus_ratio=0.35), 0.3),
        (Joint.from_ratios(200, layers=(Layer(1.2, Material()), Layer(1.4, Material(7e10)))), 0.3),
    ],
)
def test_choice_for_other_joints(scene, deepest):
    choice = choose.choose(scene, deepest, 0.03)
    depths = np.linspace(choice.depths[0], deepest, 7)
    exact = scene.solve(depth_star=depths).force_star
    force = choice.evaluate(depths, scene.r2_star)
    assert np.abs(force / exact - 1).max() <= 0.03


def test_mesh_gets_finer_with_the_tolerance():
    resolutions = [
        choose.choose(joint(poisson=0.1), 0.3, tolerance).options["resolution"]
        for tolerance in (0.0025, 0.0005)
    ]
    assert resolutions[0] < resolutions[1]


@pytest.mark.parametrize(("deepest", "tolerance"), [(0.02, 0.03), (1.5, 0.03)])
def test_table_of_a_hard_joint_keeps_its_bound_at_every_depth(deepest, tolerance):
    of_socket = {"modulus_ratio": 0.0164, "socket_poisson": 0.1}
    scene = Joint.from_ratios(123.07, 1.02, poisson=0.49, **of_socket)
    choice = choose.choose(scene, deepest, tolerance)
    depths = np.linspace(np.sqrt(choice.depths[0]), np.sqrt(deepest), 67) ** 2
    exact = scene.solve(depth_star=depths, resolution=640).force_star
    assert choice.law == "tabulated"
    assert np.abs(choice.evaluate(depths) / exact - 1).max() <= choice.error_bound


def test_a_law_without_a_measured_cost_is_not_chosen(monkeypatch):
    monkeypatch.setitem(contact.LAWS, "mine", contact.hertz)
    choice = choose.choose(joint(), 0.3, 0.01)
    assert "mine" not in choice.errors


def test_evidence_names_what_is_cheaper_and_fails():
    choice = choose.choose(joint(), 0.3, 0.01)
    assert choice.law == "stiffened_hertz"
    assert choice.error_bound < 0.01
    costs = [row["relative_cost"] for row in choice.rejected]
    assert costs == sorted(costs, reverse=True)
    assert max(costs) < choice.relative_cost
    assert all(row["error_bound"] > 0.01 for row in choice.rejected)
    assert set(choice.errors) == set(contact.LAWS)


def test_three_tilts_bound_the_change_of_the_force():
    scene = joint(ball_support="neck:30", opening=100)
    found = choose.axial_law_suffices(scene, 0.3, 30, 0.1)
    tilted, along = (
        scene.solve(depth_star=[0.3] * 4, tilt=[4, 12, 18, 27]),
        scene.solve(depth_star=0.3),
    )
    off = np.hypot(tilted.force / along.force - 1, tilted.transverse / along.force)
    assert 0.5 * found.direction_error < off.max() <= found.direction_error
    for name in ("force", "stiffness"):
        change = getattr(tilted, name) / getattr(along, name) - 1
        assert np.abs(change).max() <= abs(getattr(found, f"{name}_change"))
    assert found.one_law_for_all_directions == (found.direction_error <= 0.1)


@pytest.mark.parametrize(
    ("deepest", "tolerance", "message"),
    [
        (0.0, 0.1, "depth_star must be > 0, got 0"),
        (0.3, 0.0, "tolerance must be >= 1e-05 and <= 1, got 0"),
        (30.0, 0.1, "depth_star must be < 18.07"),
        (1e-7, 0.05, "deepest must be large enough for a contact of >= 16 elements, got 1e-07"),
    ],
)
def test_bad_input_is_refused(deepest, tolerance, message):
    with pytest.raises(ValueError, match=message):
        choose.choose(joint(), deepest, tolerance)


def test_a_tolerance_that_nothing_meets_says_what_is_known():
    with pytest.raises(StudyError, match="no law is known to be within the tolerance 0.0001"):
        choose.choose(joint(ball_support="clamped"), 0.3, 1e-4)


def test_the_largest_ratios_are_those_of_the_random_scenes():
    scenes = pd.read_csv(paths.DATA / "links.csv")
    drawn = [scene for scene, _ in random_scenes.draw(0)]
    assert {scene.link_modulus for scene in drawn} >= set(scenes.link_modulus)
    for quantity, stated in links.LARGEST_RATIOS.items():
        ratios = scenes[f"{quantity}_error"] / scenes[f"{quantity}_estimate"]
        assert ratios.max() <= stated <= 1.001 * ratios.max()


def test_bounds_of_rigid_links_hold_on_scenes_not_used_for_them():
    short = (pair for pair in random_scenes.draw(5) if pair[1] < 0.04)
    scenes = random_scenes.measure(islice(short, 3))
    assert len(scenes) == 3
    for quantity, largest in links.LARGEST_RATIOS.items():
        ratios = scenes[f"{quantity}_error"] / scenes[f"{quantity}_estimate"]
        assert ratios.max() <= 0.6 * links.SAFETY * largest


def test_scenes_unlike_those_of_the_bounds_are_named():
    assert links.outside(paper_scene(), 0.1) == ""
    assert links.outside(Scene(restitution=1.0), 0.1).startswith("restitution 1 is outside")
    gravity = paper_scene(gravity=9.81)
    assert links.outside(gravity, 0.1).startswith("gravity 9.81 is not that")
    assert links.outside(paper_scene(), 1.0).startswith("duration 1 is outside")
    choice = choose_model(gravity, 0.2, duration=0.05)
    assert choice.links == "compared"
    assert "gravity" in choice.note


@pytest.mark.parametrize("damping", DAMPINGS)
def test_restitution_is_within_the_random_scenes_if_the_one_delivered_is(damping):
    least, most = links.RANGES["restitution"]
    for asked in np.linspace(0.05, 1.0, 20):
        scene = Scene(damping=damping, restitution=asked)
        inside = least <= scene.delivered_restitution <= most  # whatever is asked for
        assert (links.outside(scene, 0.1) == "") == inside
    assert links.outside(Scene(restitution=0.05), 0.1).startswith("restitution 0.05 is outside")


@pytest.mark.parametrize("seed", [2, 5])
def test_chosen_model_is_within_tolerance_of_finer_particles(seed):
    kinds = set()
    for scene, duration in random_scenes.draw(seed, count=2):
        duration = min(duration, 0.05)
        reference = {"model": "particles", "elements": (6, 12), "law": "stiffened_hertz"}
        finer = simulate(scene, duration=duration, outputs=500, **reference)
        for quantity, tolerance in product(links.QUANTITIES, (0.5, 0.03)):
            options = {"duration": duration, "outputs": 500, "quantity": quantity}
            try:
                choice = choose_model(scene, tolerance, **options)
            except ModelError as error:
                kinds.add("none" if error.known > tolerance else "known, but refused")
                continue
            kinds.add(choice.joint)
            assert compare.motion_nrms(finer, choice.simulate(), quantity) <= tolerance
    assert {"none", "ideal"} <= kinds <= {"none", "ideal", "clearance"}


@pytest.mark.parametrize(
    ("scene", "duration", "message"),
    [
        (Scene(), 1e-6, "duration must be long enough .* got 1e-06 s"),
        (Scene(clearance=5e-3), 0.05, "r2_star must be >= 10, got 2; such a loose ball"),
    ],
)
def test_a_scene_that_nothing_can_be_said_of_is_refused(scene, duration, message):
    with pytest.raises(ValueError, match=message):
        choose_model(scene, 0.1, duration=duration)


def test_a_choice_runs_what_it_chose():
    loose = choose_model(paper_scene(), 0.06, duration=0.05)
    assert (loose.model, loose.joint) == ("rigid", "ideal")
    tight = choose_model(paper_scene(), 1e-3, duration=0.05)
    assert (tight.model, tight.joint) == ("rigid", "clearance")
    assert tight.error_bound <= 1e-3 < max(row["error_bound"] for row in tight.evidence)
    assert len(tight.simulate().impacts) > 0
    flexible = choose_model(paper_scene(link_modulus=1e9), 0.2, duration=0.05, socket_ratio=1.5)
    assert flexible.compliance_ratio > 10
    assert flexible.links == "compared"
