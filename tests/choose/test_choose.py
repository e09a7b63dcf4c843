"""The choice of a law against joints solved anew, and of a model against finer ones."""

import numpy as np
import pytest

from study import choose
from study.checks import StudyError
from study.choose import cheapest_law
from study.choose.cheapest_law import SHALLOWEST
from study.choose.model import ModelError, choose_model
from study.contact import CLOSED_FORM, LAWS
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


def true_error(law, curve):
    return np.abs(law(curve.depth_star, curve.joint.r2_star) / curve.force_star - 1).max()


@pytest.mark.slow
def test_choice_is_within_tolerance_and_rarely_too_dear():
    """On random scenes that were not used to set the bounds."""
    costs, missed, chosen = choose.relative_costs(), 0, set()
    for scene, deepest, tolerance, curve in random_joints():
        choice = choose.choose(scene, deepest, tolerance)
        chosen.add(choice.law.name)
        # the table's is a bound of an estimate
        bound = tolerance if choice.law.name == "tabulated" else choice.error_bound
        assert true_error(choice.law, curve) <= bound
        cheaper = [name for name in choice.errors if costs[name] < costs[choice.law.name]]
        laws = [LAWS[name].fit(scene, curve.depth_star, curve.force_star) for name in cheaper]
        missed += any(true_error(law, curve) <= tolerance for law in laws)
    assert missed <= 0.05 * MATERIALS * PER_MATERIAL
    assert {"hertz", "stiffened_hertz"} <= chosen


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
    assert true_error(choice.law, scene.solve(depth_star=depths)) <= 0.03


def test_mesh_gets_finer_with_the_tolerance():
    resolutions = [
        choose.choose(joint(poisson=0.1), 0.3, tolerance).law.curve.resolution
        for tolerance in (0.0025, 0.0005)
    ]
    assert resolutions[0] < resolutions[1]


@pytest.mark.parametrize(("deepest", "tolerance"), [(0.02, 0.03), (1.5, 0.03)])
def test_table_of_a_hard_joint_keeps_its_bound_at_every_depth(deepest, tolerance):
    of_socket = {"modulus_ratio": 0.0164, "socket_poisson": 0.1}
    scene = Joint.from_ratios(123.07, 1.02, poisson=0.49, **of_socket)
    choice = choose.choose(scene, deepest, tolerance)
    depths = np.linspace(np.sqrt(choice.depths[0]), np.sqrt(deepest), 67) ** 2
    exact = scene.solve(depth_star=depths, resolution=640)
    assert choice.law.name == "tabulated"
    assert true_error(choice.law, exact) <= choice.error_bound


def test_a_law_without_a_measured_cost_is_not_chosen(monkeypatch):
    costs = choose.relative_costs()
    known = {name: cost for name, cost in costs.items() if name != "stiffened_hertz"}
    monkeypatch.setattr(cheapest_law, "relative_costs", lambda: known)
    choice = choose.choose(joint(), 0.3, 0.01)
    assert choice.law.name == "tabulated"
    assert choice.errors.keys() == set(CLOSED_FORM) - {"stiffened_hertz"}


def test_evidence_names_what_is_cheaper_and_fails():
    choice = choose.choose(joint(), 0.3, 0.01)
    assert choice.law.name == "stiffened_hertz"
    assert choice.error_bound < 0.01
    costs = [row["relative_cost"] for row in choice.rejected]
    assert costs == sorted(costs, reverse=True)
    assert max(costs) < choice.relative_cost
    assert all(row["error_bound"] > 0.01 for row in choice.rejected)
    assert choice.errors.keys() == set(CLOSED_FORM)


@pytest.mark.slow
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


FINER = {("rigid", None): (2, 4), ("particles", (2, 4)): (4, 8)}
"""Model and its elements -> elements of the particles that judge it."""
MODEL = {"duration": 0.02, "outputs": 400, "law": "hertz"}


def test_a_model_is_judged_by_the_next_finer_one():
    scene = paper_scene(link_modulus=1e9)
    choice = choose_model(scene, 0.01, **MODEL)
    assert (choice.model, choice.elements) == ("particles", (2, 4))
    assert [row["joint"] for row in choice.evidence] == ["ideal", "clearance", "clearance"]
    for row in choice.evidence:
        finer = FINER[row["model"], row["elements"]]
        finer = simulate(scene, model="particles", elements=finer, **MODEL)
        given = {name: row[name] for name in ("model", "joint", "elements")}
        error = compare.motion_nrms(finer, simulate(scene, **given, **MODEL), "slider_position")
        assert row["error"] == pytest.approx(error, rel=1e-12)
    motion = simulate(scene, model="particles", elements=(2, 4), **MODEL)
    assert choice.simulate().rows.tobytes() == motion.rows.tobytes()


def test_the_simplest_model_within_the_tolerance_is_taken():
    tight = choose_model(paper_scene(), 0.01, **MODEL)
    assert (tight.model, tight.joint, tight.relative_cost) == ("rigid", "clearance", 1)
    errors = [row["error"] for row in tight.evidence]
    assert errors[1] == tight.error <= 0.01 < errors[0]
    loose = choose_model(paper_scene(), 1.01 * errors[0], **MODEL)
    assert (loose.model, loose.joint, loose.error) == ("rigid", "ideal", errors[0])


def test_a_tolerance_that_no_model_meets_names_the_least_difference():
    with pytest.raises(
        ModelError, match=r"minimum difference to a finer model is \S+ over"
    ) as told:
        choose_model(paper_scene(link_modulus=1e9), 1e-6, **MODEL)
    assert f"{told.value.known:.2g}" in str(told.value)
    assert told.value.known > 1e-6


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"duration": 1e-6}, "duration must be long enough .* got 1e-06 s"),
        ({"scene": Scene(clearance=5e-3)}, "clearance must be <= 0.001 m, .* got 0.005 m"),
        ({"tolerance": 0.0}, "tolerance must be > 0 and <= 1, got 0"),
        ({"quantity": "crank_angle"}, "quantity must be one of slider_position, slider_velocity"),
    ],
)
def test_a_scene_that_nothing_can_be_said_of_is_refused(arguments, message):
    given = {"scene": Scene(), "tolerance": 0.1, "duration": 0.01} | arguments
    with pytest.raises(ValueError, match=message):
        choose_model(**given)
