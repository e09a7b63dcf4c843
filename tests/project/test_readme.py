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
EXAMPLES = (paths.ROOT / "examples/README.md").read_text(encoding="utf-8")
FRONT_PAGE = (paths.ROOT / "study/pages/report/index.md").read_text(encoding="utf-8")
of_both = pytest.mark.parametrize("text", [README, FRONT_PAGE], ids=["README", "front page"])


def kept(name, *index):
    table = pd.read_csv(paths.FIGURES / f"{name}.csv")
    return table.set_index(list(index)) if index else table


def claimed(pattern, text=README):
    found = re.search(pattern, " ".join(text.split()))
    assert found, pattern
    return [float(number) for number in found.groups()]


def test_where_the_hyperbolic_law_is_accurate():
    low, high = claimed(r"10 % of the elastic solution only for depths from (\S+) to (\S+) clear")
    span = kept("ratio_span", "quantity").at_convention  # rounded to the inside
    ends = span["minimum depth within 10 %"], span["maximum depth within 10 %"]
    assert [np.ceil(100 * ends[0]) / 100, np.floor(100 * ends[1]) / 100] == [low, high]


def test_how_wrong_hertz_is():
    soft, infinite, angle = claimed(
        r"its force is (\d+) % too low\. In an infinitely thick socket it would still be (\d+) % "
        r"too low, because the contact extends to about (\d+)° from the axis"
    )
    causes = kept("hertz_causes").query("ball_support == 'clamped' and rim == 'free'")
    causes = causes.set_index("socket_ratio")
    stated = {1.298: soft, 1000: infinite}
    for q, percent in stated.items():
        assert causes.relative_error_percent[q] == pytest.approx(-percent, abs=0.5)
    assert causes.contact_half_angle_deg[1000] == pytest.approx(angle, abs=0.5)


def test_which_law_is_right():
    most, joints = claimed(r"fitted terms: within (\S+) % on (\d+) joints to which it was not")
    terms = pd.read_csv(paths.STUDY / "contact/stiffening.csv")
    assert f"a formula with {len(terms):,} fitted terms" in README
    judged = kept("judged").query("group.str.startswith('validation')")
    assert most - 0.01 < judged.largest_percent.max() <= most  # rounded upwards
    assert judged.cases.sum() == joints
    (ends,) = claimed(r"ends of these ranges it is within (\S+) %")
    largest = kept("judged", "group").largest_percent["ends of the ranges"]
    assert ends - 0.01 < largest <= ends


def test_the_closed_form_gives_the_depth():
    (formula,) = re.findall(r"```python\n(.*?)```", EXAMPLES, re.DOTALL)
    (percent,) = claimed(r"not fitted, the force at a given depth is within (\S+) %\.", EXAMPLES)
    elastic = joint.Joint.from_ratios(200, 1.5).solve(depth_star=[0.1, 0.5, 1.0])
    bodies = {"r2_star": 200, "q": 1.5, "nu1": 0.3, "nu2": 0.3, "s": 0.5}
    given = bodies | {"force_star": elastic.force_star}
    exec(formula, given)
    # the force grows at least with the power 1.5 of the depth
    assert given["depth_star"] == pytest.approx(elastic.depth_star, rel=percent / 150)
    errors = kept("closed_form_numbers", "what", "name").value["error"]
    assert percent - 0.1 < errors["force"] <= percent


@of_both
def test_what_accuracy_costs(text):
    most, hertz, *costs = claimed(
        r"errors of at most (\S+) %, where Hertz's law has (\d+) %, and take (\S+) and (\S+) times",
        text,
    )
    rows = kept("speed_accuracy").query("panel == 'a'").set_index("method")
    assert 100 * rows.error["hertz"] == pytest.approx(hertz, abs=0.5)
    laws = ["stiffened_hertz", "tabulated"]
    assert most - 0.001 < 100 * rows.error[laws].max() <= most
    assert rows.relative[laws].round(1).tolist() == costs


@of_both
def test_what_the_energy_balance_detects(text):
    stated = claimed(
        r"in (\d+) test runs .*? (\d+) of (\d+) forces .*? with (\d+) false alarms", text
    )
    counts = kept("energy_test_counts").groupby("set").sum(numeric_only=True)
    columns = ["runs", "detected_by_energy", "wrong", "false_alarms_by_energy"]
    assert counts.loc["test", columns].tolist() == stated
    assert counts.detected_by_energy["sensitive"] == 0 < counts.wrong["sensitive"]


@of_both
def test_how_long_an_ideal_joint_is_enough(text):
    ideal, first, rubbing, second = claimed(
        r"within (\S+) % \(RMS\) for (\S+) s, and an ideal joint with friction within (\S+) % for "
        r"(\S+) s",
        text,
    )
    errors = kept("ladder_durations", "change", "duration_s").position_percent
    assert errors["ideal joint", first] == ideal
    assert errors["ideal joint with friction", second] == rubbing


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
    (more,) = re.findall(r"([\d.]+) % under 30 kN", README)
    rows.append(("--bearing GE20E --force 30kN", more))
    return [(shlex.split(options), float(percent)) for options, percent in rows]


def test_the_power_law_of_the_first_joint():
    """The joint in the first example of the command and of Python."""
    start, end, percent = claimed(
        r"at depths from (\S+) to (\S+) clearances: within (\S+) % in the"
    )
    bronze = joint.Joint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="bronze")
    error = 100 * bronze.power_law((start * 40e-6, end * 40e-6)).error
    assert percent - 0.1 < error <= percent


def test_the_power_law_of_random_joints():
    (percent,) = claimed(r"within (\S+) % in the worst of 100 joints")
    worst = kept("power_errors", "depth_star", "ratio").worst_percent[0.5, 10]
    assert percent - 0.1 < worst <= percent


def test_large_displacements():
    claim = claimed(
        r"reduce the force at a depth of half a clearance by (\S+) % if R2 is 20 clearances, and "
        r"by (\S+) % if it is 10"
    )
    forces = pd.read_csv(paths.DATA / "published/large_displacements.csv")
    forces = forces[(forces.joint == "reference") & (forces.depth_star == 0.5)].set_index("r2_star")
    decrease = 100 * (1 - forces.force_large / forces.force_small)
    assert decrease[[20, 10]].to_numpy() == pytest.approx(claim, abs=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(("options", "percent"), printed_errors())
def test_the_force_errors_of_other_joints(run, options, percent):
    base, *_ = re.findall(r"^study (joint .*)$", README, re.MULTILINE)
    words = base.split()
    if "--bearing" in options:
        words = ["joint"] if "--force" in options else ["joint", "--force", "3kN"]
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
    load, most, below, above, housing = claimed(
        r"in GE 20 E, a force of (\S+) kN is .*? For all 16, .*? is within (\S+) % of the elastic "
        r"solution at depths from half .*? changes the depth under 100 MPa by -(\S+) to \+(\S+) %"
        r"\. If the housing holds .*? this depth is (\S+) % larger"
    )
    bearings = kept("bearings", "bearing")
    error = bearings.error_around_percent
    assert (len(error), most - 0.1 < error.max() <= most) == (16, True)
    assert bearings.load_kn["GE 20 E"] == load
    drawn = kept("bearing_band").query("panel in ('low', 'high')")
    effects = drawn.pivot_table("y", "x", "panel", aggfunc=lambda of: float(of.iloc[0]))
    (play,) = (of for of in effects.index if of.startswith("play"))
    assert effects.loc[play, ["low", "high"]].to_numpy() == pytest.approx([-below, above], abs=0.5)
    assert effects.high["housing rigid or free"] == pytest.approx(housing, abs=0.5)


@pytest.mark.slow
def test_the_exported_laws_of_the_bearing_have_the_stated_errors(run):
    power, spline, elastic = claimed(
        r"power law is within (\S+) % of the elastic solution and the spline within (\S+) %, while "
        r"the elastic solution itself has an estimated error of at most (\S+) %"
    )
    lines = re.findall(r"^study (export \w+ adams --bearing .*)$", README, re.MULTILINE)
    of_power, of_spline = (
        run(*shlex.split(line, comments=True))[1].replace("\n! ", " ") for line in lines
    )
    assert f"at most {power:g} % relative to the elastic solution" in of_power
    assert f"adds an error of up to {spline:g} %" in of_spline
    assert f"that of the elastic solution, at most {elastic:g} % here" in of_spline


@pytest.mark.slow
def test_the_example_of_many_joints_is_solved(run, tmp_path):
    (cases,) = re.findall(r"```text\n(name,.*?)```", EXAMPLES, re.DOTALL)
    (tmp_path / "cases.csv").write_text(cases, encoding="utf-8")
    status, out, _ = run("joint", tmp_path / "cases.csv", "--json")
    assert status == 0
    assert [row["name"] for row in json.loads(out)] == ["rod end", "rod end", "hip"]


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
