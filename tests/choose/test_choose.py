"""Tables of laws and of models, against joints that are solved anew and simulations."""

from collections import Counter

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binom

from study import paths
from study.choose import compare_laws, compare_models
from study.choose.laws import MODELS, model_errors, run_models
from study.contact import CLOSED_FORM, LAWS
from study.joint import Joint, Material, reference_joint
from study.mechanism import Scene, compare, paper_scene, simulate

BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
CORE = Joint.from_ratios(100, ball_support="core:0.5", rim="free", socket_ratio=1.2)


def solved_error(joint, law, first, last, tilt=None):
    """Maximum relative error of a law at some depths, where the joint is solved."""
    depths = np.linspace(np.sqrt(first), np.sqrt(last), 7) ** 2
    solution = joint.solve(depth_star=depths, tilt=tilt)
    return np.abs(law(depths, joint.r2_star) / solution.force_star - 1).max()


@pytest.mark.parametrize(
    ("joint", "deepest"),
    [
        (BRONZE, 0.3),
        (BRONZE, 0.01),
        (Joint.from_ratios(10), 0.3),
        (Joint.from_ratios(200, ball=Material(2e11, 0.1)), 1.1),
        (reference_joint(), 0.3),
        (CORE, 0.5),
    ],
)
def test_the_error_of_a_law_is_that_of_its_force(joint, deepest):
    table = compare_laws(joint, deepest).set_index("law")
    first = table.shallowest.iloc[0]
    for name in table.index.intersection(["hertz", "winkler", "liu", "stiffened_hertz"]):
        error = solved_error(joint, LAWS[name].of(joint), first, deepest)
        assert error <= table.error_bound[name]
        assert error == pytest.approx(table.error[name], rel=0.02, abs=table.error_bound.tabulated)
    made = joint.table(deepest)
    assert solved_error(joint, made, first, deepest) <= table.error_bound.tabulated
    assert (table.error < table.error_bound).all()


def test_the_first_law_that_is_accurate_enough_is_the_cheapest():
    table = compare_laws(Joint.from_ratios(200, 1.19), 0.3)
    assert table[table.error_bound <= 0.5].law.iloc[0] == "steuermann"
    costs = table.set_index("law").relative_cost.drop("tabulated")
    assert costs.is_monotonic_increasing
    assert costs.hertz == 1


def test_the_power_law_is_fitted_to_the_range_of_the_table():
    row = compare_laws(BRONZE, 0.4).set_index("law").loc["power"]
    fit = BRONZE.power_law((row.shallowest * BRONZE.clearance, 0.4 * BRONZE.clearance))
    assert row.error == pytest.approx(fit.error, rel=0.05)
    assert f"exponent={fit.exponent:.3f}"[:-1] in row.numbers


@pytest.mark.parametrize(
    ("joint", "deepest", "left_out"),
    [
        (BRONZE, 1.1, {"stiffened_hertz"}),
        (BRONZE, 1.4, {"stiffened_hertz", "hyperbolic_winkler"}),
        (CORE, 0.3, {"stiffened_hertz"}),
        (BRONZE, None, set()),
    ],
)
def test_a_law_that_does_not_apply_is_left_out(joint, deepest, left_out):
    table = compare_laws(joint, deepest)
    assert {*table.law} == {*CLOSED_FORM, "tabulated"} - left_out
    assert table.deepest[0] == (deepest or 1)


@pytest.mark.slow
def test_under_a_tilt_the_error_is_that_of_the_law_for_the_axis():
    table = compare_laws(CORE, 0.3, tilt=20).set_index("law")
    error = solved_error(CORE, LAWS["hertz"](), table.shallowest.iloc[0], 0.3, tilt=20)
    assert error == pytest.approx(table.error.hertz, abs=table.error_bound.tabulated)


@pytest.mark.parametrize(
    ("deepest", "message"),
    [
        (0.0, "deepest must be > 0 and < .*, got 0"),
        (30.0, "deepest must be > 0 and < .*, got 30"),
        (1e-7, "the maximum depth_star must be >= 7.25e-05, because elements do not resolve"),
    ],
)
def test_a_depth_that_cannot_be_solved(deepest, message):
    with pytest.raises(ValueError, match=message):
        compare_laws(BRONZE, deepest)


MODEL = {"duration": 0.02, "outputs": 400, "law": "hertz"}


def test_each_model_is_compared_with_the_next_two():
    scene = paper_scene(link_modulus=1e9)
    table = compare_models(scene, **MODEL)
    assert table.joint.tolist() == ["ideal", "ideal_with_friction", "clearance", "clearance"]
    assert table.elements.fillna("").tolist() == ["", "", "", "2,4"]
    assert table.relative_cost[2] == 1
    runs = [
        *(simulate(scene, joint=joint, **MODEL) for joint in table.joint[:3]),
        *(simulate(scene, model="particles", elements=e, **MODEL) for e in ("2,4", "4,8")),
    ]
    forces = [r.largest_force or r.normal_force.max() for r in runs]
    for n, (row, run) in enumerate(zip(table.itertuples(), runs[:-1], strict=True)):
        finer = slice(n + 1, n + 3)
        for name in ("position", "velocity", "acceleration"):
            errors = [compare.motion_nrms(other, run, f"slider_{name}") for other in runs[finer]]
            assert getattr(row, f"{name}_error") == pytest.approx(max(errors), rel=1e-12)
        error = max(abs(forces[n] / force - 1) for force in forces[finer])
        assert row.peak_force_error == pytest.approx(error, rel=1e-9)


def test_models_are_run_in_order_of_detail_at_the_same_times():
    scene = paper_scene(crank_speed=20.0)
    responses, seconds = run_models(scene, 0.02, 50, "hertz")
    assert len(responses) == len(seconds) == len(MODELS)
    assert all(np.array_equal(r.time, responses[0].time) for r in responses)
    assert min(seconds) > 0
    for given, response in zip(MODELS, responses, strict=True):
        same = simulate(scene, duration=0.02, outputs=50, law="hertz", **given)
        assert np.array_equal(same.rows, response.rows)
    # at a constant speed of the crank, friction does not change the motion of an ideal joint
    errors = model_errors(responses[1], responses[0])
    assert errors.pop("peak_force_error") > 1e-3
    assert max(errors.values()) < 1e-12


def test_errors_of_a_model_are_relative_to_the_finer_one():
    fine, coarse = (simulate(joint=joint, **MODEL) for joint in ("clearance", "ideal"))
    errors = model_errors(fine, coarse)
    moved = fine.slider_position - fine.slider_position[0]
    apart = coarse.slider_position - fine.slider_position
    expected = np.sqrt(np.mean(apart**2) / np.mean(moved**2))
    assert errors["position_error"] == pytest.approx(expected, rel=1e-12)
    # impacts, most of which are shorter than the interval between two outputs, count
    peak = max(fine.largest_force, fine.normal_force.max())
    expected = 1 - coarse.normal_force.max() / peak
    assert errors["peak_force_error"] == pytest.approx(expected, rel=1e-12)
    assert {*model_errors(fine, fine).values()} == {0.0}


LADDER = pd.read_csv(paths.FIGURES / "ladder.csv")


@pytest.mark.parametrize("rule", ["A", "B"])
def test_published_hit_rates_are_those_of_the_published_mechanisms(rule):
    table = pd.read_csv(paths.FIGURES / "ladder_mechanisms.csv").query("set == 'test'")
    for row in LADDER[LADDER.rule == rule].itertuples():
        outcomes = Counter()
        of_quantity = table[table.quantity == row.quantity]
        for _, models in of_quantity.groupby("mechanism"):
            limit = row.tolerance / row.factor
            for model in models.itertuples():  # from the simplest one
                second = model.to_second if row.compared_with == 2 else 0
                if max(model.to_next, second) <= limit:
                    outcomes[model.model if model.to_judge <= row.tolerance else "wrong"] += 1
                    break
            else:
                outcomes["none"] += 1
        names = "ideal", "ideal_with_friction", "clearance", "flexible", "wrong", "none"
        assert [outcomes[name] for name in names] == [getattr(row, name) for name in names]
        assert row.right + row.wrong + row.none + row.failed == 40
        assert row.finest == 0


@pytest.mark.parametrize(("name", "cost"), [("clearance", 0.07), ("flexible", 0.35), ("finest", 1)])
def test_published_baselines_are_those_of_the_published_mechanisms(name, cost):
    table = pd.read_csv(paths.FIGURES / "ladder_mechanisms.csv").query("set == 'test'")
    rows = LADDER[LADDER.rule == f"always {name}"]
    assert len(rows) == 9
    for row in rows.itertuples():
        of_quantity = table[table.quantity == row.quantity]
        if name == "finest":
            errors = of_quantity.groupby("mechanism").finest_to_judge.first()
        else:
            errors = of_quantity[of_quantity.model == name].to_judge
        right = (errors <= row.tolerance).sum()
        assert (row.right, row.wrong, row.none) == (right, 40 - row.failed - right, 0)
        assert getattr(row, name) == right
        assert row.cost == cost


def test_published_confidence_is_that_of_clopper_and_pearson():
    for _, rows in LADDER.groupby("rule"):
        (wrong,), (limit,) = rows.wrong_motion.unique(), rows.wrong_motion_limit.unique()
        done = 40 - rows.failed.iloc[0]
        # with this share, so few wrong ones would be seen in 5 % of all samples
        assert binom.cdf(wrong, done, limit) == pytest.approx(0.05, abs=0.001)


@pytest.mark.parametrize(
    ("scene", "arguments", "message"),
    [
        (Scene(), {"duration": 1e-6}, "duration must be long enough .* got 1e-06 s"),
        (Scene(clearance=5e-3), {}, "clearance must be <= 0.001 m, .* got 0.005 m"),
        (Scene(), {"law": "hooke"}, "law must be one of hertz, "),
    ],
)
def test_models_that_cannot_be_compared(scene, arguments, message):
    with pytest.raises(ValueError, match=message):
        compare_models(scene, **{"duration": 0.01} | arguments)
