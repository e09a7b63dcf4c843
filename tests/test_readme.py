"""What README claims is what the study computes, and its example runs."""

import re

import numpy as np
import pandas as pd
import pytest

from study import dataset, paths
from study.joint import Joint, force_curve
from study.mechanism import compare, simulate

README = " ".join((paths.ROOT / "README.md").read_text(encoding="utf-8").split())


def claimed(pattern):
    found = re.search(pattern, README)
    assert found, pattern
    return [float(number) for number in found.groups()]


def test_table_2_as_claimed():
    table = pd.read_csv(paths.FIGURES / "table2.csv").set_index(["law", "quantity"])
    difference = 100 * table.relative_difference.abs()
    bounds = claimed(r"RMSE of Hertz within ([\d.]+) %, of Steuermann within ([\d.]+) %")
    bounds += claimed(r"of the proposed law within (\d) %.* Winkler law only within (\d+) %")
    laws = ("hertz", "steuermann", "hyperbolic_winkler", "winkler")
    for law, bound in zip(laws, bounds, strict=True):
        assert 0.5 * bound < difference[law, "RMSE"] < bound + 0.05


def test_range_of_the_law_as_claimed():
    errors = pd.read_csv(paths.FIGURES / "fig13.csv")
    low, high = claimed(r"within 10 % of the finite elements for depths of ([\d.]+) to ([\d.]+)")
    inside = errors[errors.depth_star.between(low - 1e-9, high + 1e-9)]
    assert inside.relative_error_percent.abs().max() <= 10
    before = errors[np.isclose(errors.depth_star, low - 0.025)]
    assert (before.relative_error_percent.abs() > 10).any()
    (at_tenth,) = claimed(r"and ([\d.]+) % off at 0.1")
    worst = errors[np.isclose(errors.depth_star, 0.1)].relative_error_percent.abs().max()
    assert worst == pytest.approx(at_tenth, abs=0.5)


def test_socket_ratio_as_claimed():
    cases = pd.read_csv(paths.FIGURES / "assumptions.csv").set_index("case")
    force = cases.force_at_largest_depth
    (percent,) = claimed(r"changes the force by up to (\d+) % \(ratio 1.1 to 3\)")
    change = 1 - force["ratio-3-linear-200"] / force["ratio-1.1-linear-200"]
    assert 100 * change == pytest.approx(percent, abs=0.5)


def test_coefficient_and_relative_rmse_as_claimed():
    table = pd.read_csv(paths.FIGURES / "fig09.csv")
    (bound,) = claimed(r"a straight line in R2\\\* within ([\d.]+) %")
    assert 0.5 * bound < table.relative_error_percent.abs().max() < bound
    judged = pd.read_csv(paths.FIGURES / "fig14.csv")
    (limit,) = claimed(r"settles at ([\d.]+) %")
    last = judged[judged.r2_star == judged.r2_star.max()].relative_RMSE_percent
    assert (last - limit).abs().max() < 0.05


def test_accuracy_as_claimed():
    series, calculix = claimed(r"([\d.]+) % from exact series values .*?, ([\d.]+) % from CalculiX")
    reference = pd.read_csv(paths.DATA / "published/joint.csv")
    reference = reference[reference.r2_star == 200]
    for kinematics, ratio, rim, bound in (
        ("small", 1.2, "mirror", series),
        ("linear", 1.25, "free", calculix),
    ):
        rows = reference[(reference.kinematics == kinematics) & (reference.rim == rim)]
        joint = Joint(200, ratio, rim=rim, kinematics=kinematics)
        force = force_curve(joint, rows.depth_star).force_star
        assert 100 * np.abs(force / rows.force_star - 1).max() < bound + 0.005


def test_agreement_of_the_models_as_claimed():
    table = pd.read_csv(paths.FIGURES / "agreement.csv")
    pair = table[(table.model == "particles") & (table.against == "beams")]
    place, percent = claimed(r"positions within (\S+) of the way, accelerations within ([\d.]+) %")
    assert 0.5 * place < pair.slider_position.max() < place
    assert 0.8 * percent < 100 * pair.slider_acceleration.max() < percent


def test_impacts_as_claimed():
    impacts = pd.read_csv(paths.FIGURES / "impacts.csv")
    last = (1e3 * (impacts.time + impacts.duration)).groupby(impacts.model).max()
    rigid, contacts, low, high = claimed(
        r"impacts end at (\d+) ms \(rigid links, (\d) contacts\) or (\d+) to (\d+) ms \(flexible\)"
    )
    assert last["rigid"] == pytest.approx(rigid, abs=0.5)
    assert (impacts.model == "rigid").sum() == contacts - 1  # the last contact does not end
    assert sorted(last[["particles", "beams"]]) == pytest.approx([low, high], abs=0.5)
    (delivered,) = claimed(r"a restitution of 0.5 delivers ([\d.]+\d)")
    assert impacts[impacts.model == "rigid"].delivered_restitution[0] == pytest.approx(
        delivered, abs=0.005
    )


def test_what_keeps_impacts_going_as_claimed():
    variants = pd.read_csv(paths.FIGURES / "variants.csv").set_index(["links", "variant"])
    for cr, end in zip(
        ("0.9", "0.99"), claimed(r"\(0.9: to (\d+) ms, 0.99: to (\d+) ms, with rigid"), strict=True
    ):
        found = variants.last_separation["rigid links", f"restitution {cr}"]
        assert 1e3 * found == pytest.approx(end, abs=0.6)
    true = variants[variants.energy_error < 1e-4]
    others = true[~true.index.get_level_values("variant").str.startswith("restitution")]
    assert others.last_separation.max() < 0.025
    broken = variants[variants.energy_error > 1e-3]
    assert broken.index.get_level_values("variant").str.contains("velocity").all()
    assert broken.largest_force.max() - broken.lowest_force.min() > 2000


def test_lead_as_claimed():
    (percent,) = claimed(r"slider lags behind the ideal one in (\d+) % of the first 200 ms")
    until, behind = claimed(r"crank is ahead for (\d+) ms; in the end the crank is ([\d.]+) ms")
    options = {"duration": 0.2, "outputs": 4000}
    ideal = simulate(joint="ideal", **options)
    response = simulate(law="hyperbolic_winkler", **options)
    assert 100 * (1 - compare.ahead(response, ideal).mean()) == pytest.approx(percent, abs=0.5)
    lead = compare.lead(response, ideal)
    assert -1e3 * lead[-1] == pytest.approx(behind, abs=0.05)
    assert 1e3 * ideal.time[lead > 0].max() == pytest.approx(until, abs=0.6)
    assert response.lost_friction[-1] > 0.99 * (response.lost_friction + response.lost_damping)[-1]
    variants = pd.read_csv(paths.FIGURES / "variants.csv").set_index(["links", "variant"])
    smooth = variants.lead_at_end["rigid links", "no friction"]
    assert smooth / variants.lead_at_end["rigid links", "as stated"] < 0.1


def test_dataset_size_as_claimed():
    text = (paths.DATA / "README.md").read_text(encoding="utf-8")
    frame = dataset.load()
    assert f"{frame.case.nunique()} cases of {frame.depth_star.nunique()} depths" in text


def test_python_example_runs():
    text = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    names = {}
    exec(compile(example, "README.md", "exec"), names)
    assert names["force"] > 0
    assert names["curve"].force_star.shape == (2,)
    assert len(names["response"].impacts) > 5
