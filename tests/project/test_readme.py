"""README's numbers are those of the accepted results, its commands and examples run.

Accepted results are files: that they are also what the study computes is for `study run`, which
compares every result that it makes with the accepted one.
"""

import doctest
import json
import re
import shlex

import numpy as np
import pandas as pd
import pytest

import study
from study import checks, contact, joint, paths
from study.pages import catalogue

README = (paths.ROOT / "README.md").read_text(encoding="utf-8")


def kept(name, *index):
    table = pd.read_csv(paths.FIGURES / f"{name}.csv")
    return table.set_index(list(index)) if index else table


def claimed(pattern):
    found = re.search(pattern, " ".join(README.split()))
    assert found, pattern
    return [float(number) for number in found.groups()]


def test_where_the_hyperbolic_law_is_accurate():
    low, high = claimed(r"10 % of the elastic solution only for depths from (\S+) to (\S+) clear")
    span = kept("ratio_span", "quantity").at_convention  # rounded to the inside
    ends = span["minimum depth within 10 %"], span["maximum depth within 10 %"]
    assert [np.ceil(100 * ends[0]) / 100, np.floor(100 * ends[1]) / 100] == [low, high]


def test_how_wrong_hertz_is():
    soft, ratio, thick, infinite, angle = claimed(
        r"its force is (\d+) % too low\. If the outer radius were (\d+) times the inner one, it "
        r"would still be (\d+) % too low, and in an infinitely thick socket (\d+) %.*? extends to "
        r"about (\d+)° from the axis"
    )
    causes = kept("hertz_causes").query("ball_support == 'clamped' and rim == 'free'")
    causes = causes.set_index("socket_ratio")
    stated = {1.298: soft, ratio: thick, 1000: infinite}
    for q, percent in stated.items():
        assert causes.relative_error_percent[q] == pytest.approx(-percent, abs=0.5)
    assert causes.contact_half_angle_deg[1000] == pytest.approx(angle, abs=0.5)


def test_which_law_is_right():
    most, joints, of_reference, count = claimed(
        r"fitted terms: within (\S+) % on (\d+) joints to which it was not fitted, and within "
        r"(\S+) % on the (\d+) of them"
    )
    judged = kept("judged").query("group.str.startswith('validation')")
    as_reference = judged.set_index("group").loc["validation clamped free"]
    for stated, largest in (
        (most, judged.largest_percent.max()),
        (of_reference, as_reference.largest_percent),
    ):
        assert stated - 0.01 < largest <= stated  # rounded upwards
    assert [judged.cases.sum(), as_reference.cases] == [joints, count]
    (ends,) = claimed(r"ends of these ranges it is within (\S+) %")
    largest = kept("judged", "group").largest_percent
    assert largest["ends of the ranges"] == pytest.approx(ends, abs=0.05)


def test_the_closed_form_gives_the_depth():
    _, formula = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    (percent,) = claimed(r"was not fitted it is within (\S+) %; it is for depths")
    elastic = joint.Joint.from_ratios(200, 1.5).solve(depth_star=[0.1, 0.5, 1.0])
    bodies = {"r2_star": 200, "q": 1.5, "nu1": 0.3, "nu2": 0.3, "s": 0.5}
    given = bodies | {"force_star": elastic.force_star}
    exec(formula, given)
    # the force grows at least with the power 1.5 of the depth
    assert given["depth_star"] == pytest.approx(elastic.depth_star, rel=percent / 150)
    errors = kept("closed_form_numbers", "what", "name").value["error"]
    assert percent - 0.1 < errors["force"] <= percent


def test_the_verdicts_on_the_statements():
    counts = claimed(
        r"of (\d+) statements .*? (\d+) are reproduced, (\d+) are contradicted, and (\d+) are und"
    )
    verdicts = kept("claims").query("kind == 'stated'").verdict.value_counts()
    kinds = ["reproduced", "contradicted", "undecided"]
    assert [verdicts.sum(), *verdicts.reindex(kinds, fill_value=0)] == counts


def test_what_a_mechanism_needs():
    stated = claimed(
        r"is (\S+) % over 0\.1 s, (\S+) % over 0\.2 s, (\S+) % over 0\.5 s and (\S+) % over 1 s\. "
        r".*?ost of .*? with friction it is (\S+), (\S+), (\S+) and (\S+) %\."
    )
    errors = kept("ladder_durations", "change", "duration_s").position_percent
    joints, durations = ("ideal joint", "ideal joint with friction"), (0.1, 0.2, 0.5, 1.0)
    assert stated == [errors[joint, until] for joint in joints for until in durations]
    mechanisms, right, cases, wrong = claimed(
        r"On (\d+) random crank.sliders.*? right in (\d+) of (\d+) cases, wrong in (\d+), and"
    )
    motion = kept("ladder").query("rule == 'B' and quantity != 'peak force'")
    assert [motion.right.sum(), motion.wrong.sum()] == [right, wrong]
    assert mechanisms * len(motion) == cases
    found = claimed(r"rigid links was right for .*? in (\d+) cases and wrong in (\d+)")
    always = kept("ladder").query("rule == 'always clearance' and quantity != 'peak force'")
    assert found == [always.right.sum(), always.wrong.sum()]


def test_what_accuracy_costs():
    hertz, own, *costs, seconds = claimed(
        r"Hertz's law has an error of (\d+) %; .*? have errors of at most (\S+) %, and a call in "
        r"compiled code takes (\S+) and (\S+) times as long\. The table needs a set-up of (\S+) s"
    )
    rows = kept("speed_accuracy").query("panel == 'a'").set_index("method")
    assert 100 * rows.error["hertz"] == pytest.approx(hertz, abs=0.5)
    laws = ["stiffened_hertz", "tabulated"]
    assert own - 0.01 < 100 * rows.error[laws].max() <= own
    assert rows.relative[laws].round(1).tolist() == costs
    times = kept("speed_laws").query("chart == 'laws'").set_index("method")
    assert times.setup["tabulated"] == pytest.approx(seconds, abs=0.05)


def test_what_a_second_costs():
    loose, most, default = claimed(
        r"takes (\d+) ms with `tolerance=0\.01`, for an error of the largest force below (\S+) %, "
        r"and (\d+) ms with the default tolerance\. For the same error LSODA and CVODE .* about "
        r"four times"
    )
    second = kept("speed_accuracy").query("panel == 'b'").set_index("method")
    own = second.loc["collocation, events"].set_index("setting")
    assert 1e3 * own.time["tolerance 0.01"] == pytest.approx(loose, abs=0.5)
    assert 100 * own.error["tolerance 0.01"] < most
    whole = kept("speed_accuracy").query("panel == 'c' and method == 'collocation, events'")
    assert 1e3 * whole.set_index("setting").time["tolerance 1e-08"] == pytest.approx(default, abs=5)
    for method in ("LSODA, compiled", "CVODE in C, contact coordinates"):
        rows = second.loc[method]
        needed = rows.time[rows.error <= most / 100].min()
        assert 3.5 < needed / own.time["tolerance 0.01"] < 5


def test_what_the_energy_balance_detects():
    runs, detected, wrong, alarms, euler, sensitive, hidden = claimed(
        r"in (\d+) test runs it detected (\d+) of (\d+) forces .*? with (\d+) false alarms "
        r"\((\d+) by symplectic Euler.*? in (\d+) further runs.*?, (\d+) forces were wrong and none"
    )
    counts = kept("energy_test_counts")
    total = counts.groupby("set").sum(numeric_only=True)
    columns = ["runs", "detected_by_energy", "wrong", "false_alarms_by_energy"]
    assert total.loc["test", columns].tolist() == [runs, detected, wrong, alarms]
    columns = ["runs", "wrong", "detected_by_energy"]
    assert total.loc["sensitive", columns].tolist() == [sensitive, hidden, 0]
    at = (counts.set == "test") & (counts.method == "symplectic Euler")
    assert counts.false_alarms_by_energy[at].tolist() == [euler]


def test_how_often_the_rule_knows_the_force():
    right, cases, wrong, none = claimed(
        r"For the largest force it was right in (\d+) of (\d+) cases, wrong in (\d+), and chose "
        r"no model in (\d+)"
    )
    force = kept("ladder").query("rule == 'B' and quantity == 'peak force'")
    assert force[["right", "wrong", "none"]].sum().tolist() == [right, wrong, none]
    assert right + wrong + none == cases


def test_how_much_the_supports_matter():
    at_rim, on_neck = claimed(
        r"force is (\d+) % of that in the reference joint .*? and (\d+) % if the ball is held at"
    )
    ratio = 100 * kept("held_cases", "held").force_ratio
    assert ratio["socket held at its rim's face"] == pytest.approx(at_rim, abs=0.5)
    assert ratio["ball at a neck of 30°"] == pytest.approx(on_neck, abs=0.5)


def test_where_things_are():
    (ratio,) = claimed(r"outer radius is ([\d.]+) times its inner radius")
    assert ratio == contact.SOCKET_RATIO
    (notebook,) = catalogue.select(["fig14"])
    assert f"Fig. 14 of Yao et al.: `{notebook.name}`" in README
    for path in re.findall(r"\]\((?!https:)([^)#]+)", README):
        assert (paths.ROOT / path).exists(), path


def test_the_command_prints_what_is_shown(run, monkeypatch):
    at = re.search(r"^study (joint .*)$", README, re.MULTILINE)
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    _, out, err = run(*at[1].split())
    shown = re.search(r"```text\n(.*?)\n```", README[at.end() :], re.DOTALL)[1]
    for part in shown.split("\n...\n"):  # in README, some lines are left out
        assert part in f"{out}{err}"


def printed_errors():
    """Options of the joints in the table, and the error of the elastic solution in percent."""
    rows = re.findall(r"^\|[^|]*\| `(--[^`]*)`[^|]*\|[^|]*\| ([\d.]+) %", README, re.MULTILINE)
    assert len(rows) == 4
    return [(shlex.split(options), float(percent)) for options, percent in rows]


def test_the_power_law_of_random_joints():
    (percent,) = claimed(r"within (\S+) % in the worst of 100 joints")
    worst = kept("power_errors", "depth_star", "ratio").worst_percent[0.5, 10]
    assert percent - 0.1 < worst <= percent


def test_large_displacements():
    claim = claimed(
        r"reduce the force at a depth of half a clearance by (\S+) %, and at 10 .*? (\S+) %"
    )
    forces = pd.read_csv(paths.DATA / "published/large_displacements.csv")
    forces = forces[(forces.joint == "reference") & (forces.depth_star == 0.5)].set_index("r2_star")
    decrease = 100 * (1 - forces.force_large / forces.force_small)
    assert decrease[[20, 10]].to_numpy() == pytest.approx(claim, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("options", "percent"), printed_errors())
def test_the_force_errors_of_other_joints(run, options, percent):
    base, *_ = re.findall(r"^study (joint .*)$", README, re.MULTILINE)
    words = ["joint", "--force", "3kN"] if "--bearing" in options else base.split()
    (row,) = json.loads(run(*words, *options, "--json")[1])
    assert checks.percent(row["force_error"]) == f"{percent:g} %"


def test_the_name_and_the_dimensions_of_a_bearing_are_the_same_joint():
    lines = re.findall(r"^study joint (--b.*) --force 30kN --power-law", README, re.MULTILINE)
    words = [shlex.split(line.replace("-", "_").replace("__", "")) for line in lines]
    by_name, by_dimensions = (
        study.Joint.of(**dict(zip(of[::2], of[1::2], strict=True))) for of in words
    )
    assert by_name == by_dimensions


def test_the_power_law_of_bearings():
    around, best, wide, best_wide, below, above, free = claimed(
        r"is within (\S+) % of the elastic solution at depths from half .*? and in the best one "
        r"within (\S+) %\. At depths .*? it is within (\S+) %, and in the best one within (\S+) "
        r"%\. .*? changes the depth under this load by -(\S+) to \+(\S+) %, and a housing that "
        r"holds only the middle of the ring increases it by (\S+) %"
    )
    table = kept("bearings")
    for name, bounds in (("around", (best, around)), ("wide", (best_wide, wide))):
        error = table[f"error_{name}_percent"]
        for bound, value in zip(bounds, (error.min(), error.max()), strict=True):
            assert bound - 0.1 < value <= bound
    drawn = kept("bearing_band").query("panel in ('low', 'high')")
    effects = drawn.pivot_table("y", "x", "panel", aggfunc=lambda of: float(of.iloc[0]))
    (play,) = (of for of in effects.index if of.startswith("play"))
    assert effects.loc[play, ["low", "high"]].to_numpy() == pytest.approx([-below, above], abs=0.5)
    assert effects.high["housing rigid or free"] == pytest.approx(free, abs=0.5)


def test_the_example_runs():
    example, _ = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    names = {}
    exec(compile(example, "README.md", "exec"), names)
    assert names["law"].force(names["law"].depth(3000)) == pytest.approx(3000)
    assert isinstance(names["law"], contact.DimensionalLaw)


def test_the_librarys_examples_print_what_they_show():
    failed, run = doctest.testmod(study, optionflags=doctest.NORMALIZE_WHITESPACE)
    assert run > 10
    assert not failed
