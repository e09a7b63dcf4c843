"""README's numbers are those of the accepted results, its commands and examples run.

Accepted results are files: that they are also what the study computes is for `study report`, which
compares every result that it makes with the accepted one.
"""

import doctest
import re

import numpy as np
import pandas as pd
import pytest

import study
from study import contact, dataset, paths
from study.joint import Joint
from study.pages import catalogue

README = (paths.ROOT / "README.md").read_text(encoding="utf-8")


def kept(name, *index):
    table = pd.read_csv(paths.FIGURES / f"{name}.csv")
    return table.set_index(list(index)) if index else table


def claimed(pattern):
    found = re.search(pattern, " ".join(README.split()))
    assert found, pattern
    return [float(number) for number in found.groups()]


def test_what_the_paper_computed():
    table = kept("table2").query("law != 'liu' and quantity in ('1 - kappa_as_printed', 'RMSE')")
    rms = 100 * np.sqrt((table.relative_difference**2).mean())
    assert len(table) == 8
    assert [rms] == pytest.approx(claimed(r"eight relative differences is ([\d.]+) %"), abs=0.005)


def test_how_good_its_law_is():
    low, high, soft = claimed(r"10 % only for depths from (\S+) to (\S+) .*? it is (\d+) % too")
    table = kept("trend", "depth_star")
    error = 100 * (table.hyperbolic_winkler / table.elastic_solution - 1)
    span = kept("ratio_span", "quantity").at_convention  # rounded to the inside
    ends = span["minimum depth within 10 %"], span["maximum depth within 10 %"]
    assert [np.ceil(100 * ends[0]) / 100, np.floor(100 * ends[1]) / 100] == [low, high]
    assert error[0.1] == pytest.approx(-soft, abs=0.5)


def test_which_law_is_right():
    most, joints = claimed(r"is within (\S+) % on (\d+) joints")
    judged = kept("judged").query("group.str.startswith('validation')")
    assert judged.largest_percent.max() == pytest.approx(most, abs=0.005)
    assert judged.cases.sum() == joints
    (ends,) = claimed(r"ends of these ranges it is within (\S+) %")
    largest = kept("judged", "group").largest_percent
    assert largest["ends of the ranges"] == pytest.approx(ends, abs=0.05)
    error, least, largest = claimed(
        r"is within (\S+) % in the reference joint for depths from (\S+) to (\S+) cl"
    )
    ranges = kept("power_ranges")
    (row,) = ranges[(ranges["from"] == least) & (ranges["to"] == largest)].itertuples()
    assert row.error_percent == pytest.approx(error, abs=0.005)


def test_how_accurate_the_stiffness_is():
    table = kept("trend")
    stiffened, low, high = claimed(r"its stiffness dP/dδ is within (\S+) % .*? from (\S+) to (\d)")
    curve = dataset.paper_curves("linear", r2_star=200.0)
    assert 100 * curve.error_estimate[curve.depth_star >= low].max() < stiffened / 3
    (power,) = claimed(r"its stiffness within (\S+) %")
    for law, percent, ends in (
        ("stiffened_hertz", stiffened, (low, high)),
        ("power", power, (0.05, 0.5)),
    ):
        inside = table[table.depth_star.between(*ends)]
        error = 100 * (inside[f"slope_{law}"] / inside.slope_elastic_solution - 1).abs().max()
        assert 0.9 * percent < error <= percent


def test_how_far_others_are():
    assert "Seven of nine published contact pressures" in README
    table = kept("others_compared")
    assert (len(table), (table.verdict == "agree").sum()) == (9, 7)
    assert table.gap_percent.abs().max() < 1


def test_which_statements_hold():
    *counts, ours, implied = claimed(
        r"Of (\d+) statements .*? (\d+) are reproduced, (\d+) are contradicted, and (\d+) are und"
        r".*? \((\d+) of them\) .*? Besides, (\d+) assumptions"
    )
    claims = kept("claims")
    stated = claims.query("kind == 'stated'")
    verdicts = stated.verdict.value_counts()
    chosen = stated.depends_on.str.contains("the tolerance, which this study chose", na=False)
    assert ours == chosen[stated.verdict == "undecided"].sum()
    assert implied == (claims.query("kind == 'implied only'").verdict == "contradicted").sum()
    kinds = ["reproduced", "contradicted", "undecided"]
    assert [verdicts.sum(), *verdicts.reindex(kinds, fill_value=0)] == counts


def test_what_a_mechanism_needs():
    (percent,) = claimed(r"an ideal joint gives the position of the slider within (\d+) %")
    least = kept("choice_mechanism", "quantity", "tolerance").joint
    assert least["slider_position", percent / 100] == "ideal"


def test_how_much_the_supports_matter():
    at_rim, on_neck = claimed(
        r"force is (\d+) % of that in the reference joint .*? and (\d+) % if the ball is held at"
    )
    ratio = 100 * kept("held_cases", "held").force_ratio
    assert ratio["socket held at its rim's face"] == pytest.approx(at_rim, abs=0.5)
    assert ratio["ball at a neck of 30°"] == pytest.approx(on_neck, abs=0.5)


def test_where_things_are():
    (ratio,) = claimed(r"with an outer radius of ([\d.]+) R2")
    assert ratio == contact.SOCKET_RATIO
    (notebook,) = catalogue.select(["fig14"])
    assert f"Fig. 14 of Yao et al.: `{notebook.name}`" in README
    for path in re.findall(r"\]\(([^)#]+)", README):
        assert (paths.ROOT / path).exists(), path


def test_the_command_prints_what_is_shown(run):
    at = re.search(r"^study (joint .*)$", README, re.MULTILINE)
    printed = run(*at[1].split())[1].splitlines()
    shown = re.search(r"```text\n(.*?)```", README[at.end() :], re.DOTALL)[1].splitlines()
    assert [line for line in printed if not line.startswith("─")] == shown


def test_the_other_support_is_as_much_stiffer():
    (percent,) = claimed(
        r"`--ball-support clamped` it may not, which here makes the joint (\d+) % stiffer"
    )
    sizes = {"socket_radius": 12.5e-3, "clearance": 40e-6, "wall": 6e-3, "socket": "bronze"}
    free, clamped = (
        Joint(**sizes, ball_support=drive).solve(force=3000).stiffness[0]
        for drive in ("guided", "clamped")
    )
    assert 100 * (clamped / free - 1) == pytest.approx(percent, abs=0.5)


def test_the_example_runs():
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    names = {}
    exec(compile(example, "README.md", "exec"), names)
    assert names["law"].force(names["law"].depth(3000)) == pytest.approx(3000)
    assert isinstance(names["law"], contact.DimensionalLaw)


def test_the_librarys_examples_print_what_they_show():
    failed, run = doctest.testmod(study, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert run > 10
    assert not failed
