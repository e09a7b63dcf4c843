"""README's numbers are those of the kept results, and its example runs.

Kept results are files: that they are also what the study computes is for `study report`, which
compares every one that it makes with the kept one.
"""

import re

import numpy as np
import pandas as pd
import pytest

from study import cli, contact, dataset, paths
from study.claims import identification
from study.dataset.design import case_name
from study.measure import speed
from study.mechanism import compare, simulate

README = " ".join((paths.ROOT / "README.md").read_text(encoding="utf-8").split())


def claimed(pattern):
    found = re.search(pattern, README)
    assert found, pattern
    return [float(number) for number in found.groups()]


def test_table_2_as_claimed():
    table = pd.read_csv(paths.FIGURES / "table2.csv").set_index(["law", "quantity"])
    rms, most, *correct = claimed(
        r"Eight numbers are within ([\d.]+) % \(RMS, largest ([\d.]+) %\).*?"
        r"Correctly, the coefficient is ([\d.]+) for Hertz, ([\d.]+) for Steuermann, "
        r"([\d.]+) for Winkler and ([\d.]+) for"
    )
    keys = [
        (law, quantity) for law in identification.ROWS for quantity in ("1 - determination", "RMSE")
    ]
    off = 100 * table.relative_difference[keys]
    assert np.sqrt((off**2).mean()) == pytest.approx(rms, abs=0.005)
    assert off.abs().max() == pytest.approx(most, abs=0.005)
    found = table.correct[[(law, "determination") for law in identification.ROWS]]
    assert found.to_numpy() == pytest.approx(correct, abs=0.006)
    (ratio,) = claimed(r"a socket of outer ratio ([\d.]+), 21 depths")
    assert ratio == contact.SOCKET_RATIO
    candidates = pd.read_csv(paths.FIGURES / "candidates.csv")
    best = candidates[candidates.resolution == 160].iloc[0]
    assert best[["drive", "kinematics", "area"]].tolist() == ["clamped", "linear", "flat"]
    assert best.sampling == "21, from 0"
    assert best.best_ratio == pytest.approx(ratio, abs=0.0006)


def test_liu_as_claimed():
    forms = pd.read_csv(paths.FIGURES / "liu_forms.csv").set_index("form").difference_percent
    (percent,) = claimed(r"reconstructed from two published numbers \(RMSE within ([\d.]+) %\)")
    assert abs(forms.iloc[0]) < percent < 2 * abs(forms.iloc[0])


def judged():
    """Rows of judged.csv, and the largest error of each joint at random."""
    table = pd.read_csv(paths.FIGURES / "judged.csv").set_index("group")
    errors = pd.read_csv(paths.FIGURES / "stiffening.csv")
    random = errors[errors.group.str.startswith("judge")]
    return table, random.relative_error_percent.abs().groupby(random.case).max()


def test_stiffened_hertz_as_claimed():
    table, random = judged()
    within, count, cost, paper = claimed(
        r"nine numbers of a joint once and is within ([\d.]+) % on (\d+) joints that had no part "
        r"in its table, for ([\d.]+) times the cost of Hertz's law\. In the paper's joint it is "
        r"within ([\d.]+) %"
    )
    assert random.max() == pytest.approx(within, abs=0.006)
    assert len(random) == count
    assert table.largest_percent["paper linear"] == pytest.approx(paper, abs=0.006)
    relative = pd.read_csv(paths.FIGURES / "speed_laws.csv").set_index("method").relative
    assert relative["stiffened_hertz"] == pytest.approx(cost, abs=0.05)
    again, median, finite = claimed(
        r"Its largest error on the \d+ random joints is ([\d.]+) %, the median ([\d.]+) %.*?"
        r"in the paper's joint by up to ([\d.]+) % at"
    )
    assert [random.max(), random.median()] == pytest.approx([again, median], abs=0.006)
    assert table.largest_percent["paper finite"] == pytest.approx(finite, abs=0.06)
    assert table.at_r2_star["paper finite"] == 20


def test_law_on_paper_as_claimed():
    numbers = contact.laws.fitted_coefficients()["printed_hertz"]
    firsts = {"b": 0, "c": 1, "h": 0, "w": 0, "p": 1}
    for letter, first in firsts.items():
        for k, value in enumerate(numbers[letter]):
            assert claimed(rf"{letter}{first + k}\s+(-?[\d.]+)") == [value]
    assert claimed(r"k\s+([\d.]+)\s+n\s+([\d.]+)") == numbers["kn"]
    table = pd.read_csv(paths.FIGURES / "printed_numbers.csv").set_index(["what", "name"]).value
    stated = claimed(
        r"16 printed numbers is within ([\d.]+) %.*?half-angle is within ([\d.]+) %, "
        r"the peak pressure within ([\d.]+) %"
    )
    found = [table["error", of] for of in ("force", "half-angle", "peak pressure")]
    assert found == pytest.approx(stated, abs=0.06)


def test_range_of_the_law_as_claimed():
    errors = pd.read_csv(paths.FIGURES / "fig13.csv")
    low, high, at_tenth, relative = claimed(
        r"it is within 10 % for depths of ([\d.]+) to ([\d.]+) clearances and (\d+) % off at 0.1; "
        r"its relative RMSE is ([\d.]+) %"
    )
    worst = errors.relative_error_percent.abs().groupby(errors.depth_star).max()
    good = worst.index[worst <= 10]
    assert (good.min(), good.max()) == pytest.approx((low, high))
    judged = pd.read_csv(paths.FIGURES / "claims.csv").set_index("claim")
    assert judged.highest["small_error"] == pytest.approx(relative, abs=0.05)
    table = pd.read_csv(paths.FIGURES / "trend.csv").set_index("depth_star")
    assert 100 * (1 - table.hyperbolic_winkler / table.exact)[0.1] == pytest.approx(
        at_tenth, abs=0.5
    )
    (crossing,) = claimed(r"beats Hertz and Steuermann beyond ([\d.]+) clearances")
    assert judged.highest["crossing"] == pytest.approx(crossing, abs=0.0005)
    angles, slope = claimed(r"half-angle is ([\d.]+) to"), claimed(r"five at (\d+) % of the depths")
    assert judged.lowest["half_angle"] == pytest.approx(*angles, abs=0.005)
    assert judged.highest["curve_trend"] == pytest.approx(*slope, abs=0.5)
    assert judged.highest["best_exponent"] == 0
    reach = pd.read_csv(paths.FIGURES / "reach.csv").set_index("law").within_10_percent
    sphere = claimed(r"within 10 % for depths of ([\d.]+) to ([\d.]+) clearances\. 4\.")
    assert reach["hyperbolic_winkler_sphere"] == "{:g} to {:g}".format(*sphere)


def test_rim_as_claimed():
    rims = pd.read_csv(paths.FIGURES / "truth.csv")
    value = rims[rims.panel == "rim"].set_index(["series", "x"]).value
    least, most = claimed(
        r"by less than ([\d.]+) % up to a ratio of 1.5 at a Poisson's ratio of 0.3, "
        r"but by ([\d.]+) %"
    )
    assert value["0.3", 1.5] < least < 2 * value["0.3", 1.5]
    assert value["0.45", 1.5] == pytest.approx(most, abs=0.05)


def test_socket_ratio_as_claimed():
    cases = pd.read_csv(paths.FIGURES / "assumptions.csv").set_index("case")
    force = cases.force_at_largest_depth
    percent, clamping, factor = claimed(
        r"changes the force by up to (\d+) % \(ratio 1.1 to 3\). Clamping the ball adds (\d+) %, "
        r"unequal moduli change it by a factor of up to ([\d.]+) at"
    )
    change = 1 - force[case_name("ratio-3")] / force[case_name("ratio-1.1")]
    assert 100 * change == pytest.approx(percent, abs=0.5)
    clamped = force[case_name("paper")] / force[case_name("plane-free")]
    assert 100 * (clamped - 1) == pytest.approx(clamping, abs=0.5)
    moduli = dataset.load(group=["modulus", "paper"], r2_star=200, kinematics="linear")
    shown = moduli[moduli.depth_star == 0.5].set_index("modulus_ratio").force_star
    assert shown.max() / shown[1.0] == pytest.approx(factor, abs=0.05)


def test_coefficient_and_relative_rmse_as_claimed():
    table = pd.read_csv(paths.FIGURES / "fig09.csv")
    (bound,) = claimed(r"a straight line in R2\\\* within ([\d.]+) %")
    assert 0.5 * bound < table.relative_error_percent.abs().max() < bound
    judged = pd.read_csv(paths.FIGURES / "fig14.csv")
    limit, first, middle, end = claimed(
        r"settles at ([\d.]+) %, .*? falls from ([\d.]+) over ([\d.]+) at 300 to ([\d.]+);"
    )
    last = judged[judged.r2_star == judged.r2_star.max()].relative_RMSE_percent
    assert (last - limit).abs().max() < 0.05
    square = judged[judged.kinematics == "linear"].set_index("r2_star").determination_adjusted
    assert square[[20, 300, 10_000]].to_numpy() == pytest.approx([first, middle, end], abs=0.0015)


def test_accuracy_as_claimed():
    series, calculix = claimed(
        r"within ([\d.]+) % of independent ones, and finite elements within ([\d.]+) % of CalculiX"
    )
    accuracy = pd.read_csv(paths.FIGURES / "accuracy.csv")
    error = 100 * accuracy.relative_difference.abs()
    legendre = accuracy.source.str.startswith("Legendre")
    assert error[legendre].max() < series + 0.0005
    assert error[~legendre & (accuracy.depth_star >= 0.5)].max() < calculix + 0.005


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
    ahead = (response.slider_position - ideal.slider_position) * ideal.slider_velocity > 0
    assert 100 * (1 - ahead.mean()) == pytest.approx(percent, abs=0.5)
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
    assert f"{frame.case.nunique()} cases with {len(frame)} rows" in text


def test_python_example_runs():
    text = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    sized, example = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    names = {}
    exec(compile(sized, "README.md", "exec"), names)
    assert names["found"].force.tolist() == [3000, 8000]
    exec(compile(example, "README.md", "exec"), names)
    assert names["force"] > 0
    assert names["curve"].force_star.shape == (2,)
    assert len(names["response"].impacts) > 5


def measured(chart, **wanted):
    """Rows of the measured times, by columns' values."""
    rows = dataset.measured(chart)
    for column, value in wanted.items():
        rows = rows[rows[column] == value]
    return rows


def test_speed_of_laws_as_claimed():
    table, error, paper, off, own, soft = claimed(
        r"its curve costs ([\d.]+) times Hertz's law in a compiled loop and is right within "
        r"([\d.]+) %; the paper's law costs ([\d.]+) times and is off by up to (\d+) %, "
        r"`stiffened_hertz` ([\d.]+) times and up to ([\d.]+) %"
    )
    for law, cost, percent in (
        ("tabulated", table, error),
        ("hyperbolic_winkler", paper, off),
        ("stiffened_hertz", own, soft),
    ):
        row = measured("laws", method=law).iloc[0]
        assert row.relative == pytest.approx(cost, abs=0.05)
        assert 100 * row.largest_error == pytest.approx(percent, rel=0.01, abs=0.006)


def test_speed_of_solvers_as_claimed():
    names = ("series", "six-node triangles", "CAX6")
    times = claimed(
        r"20 depths of a radially free ball within 0.1 % \(RMS\) takes the series ([\d.]+) s, "
        r"six-node triangles ([\d.]+) s, CalculiX (\d+) s"
    )
    for name, seconds in zip(names, times, strict=True):
        rows = measured("solvers", method=name)
        best = rows[rows.rms_error <= 1e-3].time.min()
        assert best == pytest.approx(seconds, rel=0.03)
    others = measured("solvers", program="CalculiX")
    assert others[others.rms_error <= 1e-3].time.min() == pytest.approx(times[-1], rel=0.03)


def test_speed_of_steppers_as_claimed():
    own, seconds, loose, tight, python = claimed(
        r"an error of 1e-4 takes ([\d.]+) ms, and central differences take ([\d.]+) s for 1e-5\. "
        r"At equal error SUNDIALS' CVODE, in a C program with the same equations, takes ([\d.]+) "
        r"times as long at 1e-4 and ([\d.]+) times at 1e-8\.\s+"
        r"Methods that are called from Python take at least (\d+) times as long at 1e-4"
    )
    rows = measured("steppers")
    table = speed.at_equal_error(rows)
    others = table[table.method != speed.OURS]
    least = others.groupby(["called", "error"]).ratio.min()
    assert 1e3 * table.time[(table.method == speed.OURS) & (table.error == 1e-4)].item() == (
        pytest.approx(own, abs=0.05)
    )
    in_c = others[others.method.str.startswith("CVODE in C")].groupby("error").ratio.min()
    assert [in_c[1e-4], in_c[1e-8]] == pytest.approx([loose, tight], abs=0.05)
    assert least["compiled", 1e-8] == in_c[1e-8]
    assert least["from Python", 1e-4] == pytest.approx(python, abs=0.5)
    central = rows[rows.method.isin(["centred", "lagged"]) & (rows.rms_error <= 1e-5)]
    assert central.time.min() == pytest.approx(seconds, abs=0.05)


def test_choice_as_claimed():
    table = pd.read_csv(paths.FIGURES / "choice.csv")
    (share,) = claimed(r"`stiffened_hertz` is the cheapest law at (\d+) % of the places")
    within = table[table.tolerance == 0.01].law
    assert 100 * (within == "stiffened_hertz").mean() == pytest.approx(share, abs=0.5)
    ratio, depth = claimed(
        r"there only for socket ratios above ([\d.]+) and depths below ([\d.]+) clearances"
    )
    hertz = table[(table.law == "hertz") & (table.tolerance == 0.1)]
    assert hertz.socket_ratio.min() == pytest.approx(ratio, abs=0.1)
    assert hertz.depth_star.max() == pytest.approx(depth, abs=0.0015)
    models = pd.read_csv(paths.FIGURES / "choice_mechanism.csv").set_index(
        ["quantity", "tolerance"]
    )
    assert models.joint["slider_position", 0.01] == "ideal"
    assert models.law["slider_position", 0.001] == "hertz"
    assert models.model["slider_position", 0.001] == "rigid"
    (percent,) = claimed(r"of its acceleration no model is known to be within (\d+) %")
    assert models.model["slider_acceleration", percent / 100] == "none"


def test_limits_as_claimed():
    table = pd.read_csv(paths.FIGURES / "stability_limits.csv")
    limits, percent, step = claimed(
        r"(\d+) limits of explicit steps are within ([\d.]+) % of 2/ω .*?"
        r"with the approach speed, to ([\d.]+) µs at 0.1 mm/s"
    )
    steps = pd.read_csv(paths.FIGURES / "stability_steps.csv")
    keys = ["series", "x"]
    predicted, observed = (
        steps[(steps.panel == "a") & (steps.y_is == kind)].groupby(keys).y.first()
        for kind in ("predicted", "observed")
    )
    assert len(observed) == limits
    assert 100 * (observed / predicted - 1).abs().max() == pytest.approx(percent, abs=0.1)
    (percent,) = claimed(r"those by damping within (\d+) % of their prediction")
    keys = ["series", "x"]
    damped = steps[(steps.panel == "b") & (steps.series != "centred")]
    lines, seen = (
        damped[damped.y_is == kind].set_index(keys).y for kind in ("predicted", "observed")
    )
    assert 100 * (seen / lines - 1).abs().max() == pytest.approx(percent, abs=0.6)
    lagged = table[table.condition.str.contains("v0 = 1e-4") & table.what.str.endswith("lagged")]
    assert float(lagged.observed.iloc[0]) == pytest.approx(step, abs=0.05)
    (impacts,) = claimed(r"With restitution 0.99 a start 1 nm aside decides after (\d+) impacts")
    chaos = table[table.what.str.startswith("impacts until") & table.condition.str.contains("0.99")]
    assert float(chaos.observed.iloc[0]) == impacts


def test_first_yield_as_claimed():
    cases = pd.read_csv(paths.FIGURES / "yield.csv")
    low, high, weak, strong, elastic, count = claimed(
        r"in steel, R2\\\* from (\d+) to (\d+), yield stresses from (\d+) to (\d+) MPa, "
        r"(\d+) of (\d+) cases stay elastic to half a clearance"
    )
    assert (cases.elastic.sum(), len(cases)) == (elastic, count)
    assert cases[["r2_star", "yield_stress_mpa"]].agg(["min", "max"]).T.to_numpy().tolist() == [
        [low, high],
        [weak, strong],
    ]
    depth = cases.set_index(["r2_star", "yield_stress_mpa"]).elastic_to_depth_star
    assert depth.max() == 0.5
    *places, late = claimed(
        r"At R2\\\* = (\d+) even steel of (\d+) MPa yields from ([\d.]+) clearances on, at "
        r"R2\\\* = (\d+) steel of (\d+) MPa from ([\d.]+) on"
    )
    tight, hard, early, wide, soft = places
    assert depth[[(tight, hard), (wide, soft)]].to_numpy() == pytest.approx([early, late], abs=5e-3)
    yields = cases[~cases.elastic]
    deep = yields.elastic_to_depth_star > 0.15
    assert set(yields.yields_first[deep]) == {"socket, at the surface"}
    assert set(yields.yields_first[~deep]) == {"socket, below the surface"}


def test_liners_as_claimed():
    table = pd.read_csv(paths.FIGURES / "liner_winkler.csv")
    percent, thick, nu, thickest, fitted_nu = claimed(
        r"springs are within (\d+) % for thicknesses up to ([\d.]+) R2 and Poisson's ratios up to "
        r"([\d.]+), .*?all thicknesses up to ([\d.]+) R2 and Poisson's ratios up to ([\d.]+) \("
    )
    of_nu = table[table.poisson <= nu]
    thin, thicker = (of_nu[of_nu.thickness <= h].springs_percent for h in (thick, 2 * thick))
    assert thin.max() < percent < thicker.max()
    assert table.thickness.max() == thickest
    assert table.fitted_percent[table.poisson <= fitted_nu].max() < percent
    liners = pd.read_csv(paths.FIGURES / "liners.csv")
    found = claimed(r"best coefficient are ([\d.]+) to ([\d.]+) % off, .*?, (\d+) to (\d+) %\.")
    fits = liners[["springs_fitted_percent", "hyperbolic_fitted_percent"]].agg(["min", "max"])
    assert np.abs(fits.T.to_numpy().ravel() - found).max() < 0.5
    assert np.abs(fits.springs_fitted_percent - found[:2]).max() < 0.05
    assert len(liners) == 5


@pytest.mark.parametrize("command", [r"joint --socket.*?)\n", r"choose .*?) +#"])
def test_examples_are_what_they_print(command, monkeypatch, capsys):
    text = (paths.ROOT / "README.md").read_text(encoding="utf-8")
    at = re.search(rf"study ({command}", text)
    words = at[1].split()
    monkeypatch.setattr("sys.argv", ["study", *words])
    with pytest.raises(SystemExit):
        cli.main()
    printed = capsys.readouterr().out.split()
    shown = re.search(r"```text\n(.*?)```", text[at.end() :], re.DOTALL)[1].split()
    assert [word for word in printed if "─" not in word] == shown


def test_verdicts_as_claimed():
    claims = pd.read_csv(paths.FIGURES / "claims.csv").query("kind == 'stated'")
    verdicts = claims.verdict.value_counts()
    total, *counts = claimed(
        r"Of (\d+) statements that the paper states, (\d+) are reproduced, (\d+) are contradicted "
        r"and (\d+) cannot be decided"
    )
    assert [verdicts[n] for n in ("reproduced", "contradicted", "cannot be decided")] == counts
    assert verdicts.sum() == total


def test_shape_of_the_law_is_judged_as_another_way_of_fitting_says():
    judged = pd.read_csv(paths.FIGURES / "claims.csv").set_index("claim")
    table = pd.read_csv(paths.FIGURES / "trend.csv").query("0.01 < depth_star <= 0.5")
    left = [
        np.linalg.lstsq(table[[law]].to_numpy(), table.exact, rcond=None)[1][0]
        for law in ("hyperbolic_winkler", "hertz")
    ]
    assert np.sqrt(left[0] / left[1]) == pytest.approx(judged.lowest["shape_beats_hertz"], rel=1e-6)


def test_depths_of_the_example_as_claimed():
    durations = pd.read_csv(paths.FIGURES / "durations.csv")
    depth = durations.set_index(["socket_radius_mm", "duration_ms"]).largest_depth
    short, long, high, low = claimed(
        r"([\d.]+) clearances in 0.2 s with a socket of 10 mm, ([\d.]+) in 1 s with one of 2 mm. "
        r"There the law is (\d+) to (\d+) % off"
    )
    assert [depth[10, 200], depth[2, 1000]] == pytest.approx([short, long], abs=0.0006)
    example = pd.read_csv(paths.FIGURES / "claims.csv").set_index("claim")
    example = example.loc["example_proves_the_law"]
    assert [example.lowest, example.highest] == pytest.approx([low, high], abs=0.5)


def test_the_cached_curves_as_claimed():
    (count,) = claimed(r"(\d+) curves cached in")
    assert len(dataset.load().groupby(["group", "case"])) == count
