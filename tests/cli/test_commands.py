"""Each command makes the table of its function, in the form that its output needs."""

import json
import re
import shlex
from io import StringIO

import click
import pandas as pd
import pytest

from study import choose, dataset, paths
from study.cases.joints import JOINTS
from study.checks import percent
from study.cli import COMMANDS, data, main
from study.cli.options import for_reader
from study.contact import materials
from study.export import export
from study.joint import Joint

SIZED = ["--socket-radius", "12.5mm", "--clearance", "40um", "--wall", "6mm", "--socket", "bronze"]
BRONZE = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
CURVE = str(paths.ROOT / "examples/fit_your_curve.csv")
WITH_MANY_OPTIONS = ["joint", "laws", "fit", "export", "simulate", "models"]
OF_DATA = [f"data {name}" for name in data.data_command.commands]


@pytest.fixture
def output(run):
    """Standard output of a command that succeeds."""

    def output(*words):
        status, out, err = run(*words)
        assert status == 0, err
        return out

    return output


@pytest.fixture
def table(output):
    return lambda *words: pd.read_csv(StringIO(output(*words)))


@pytest.mark.parametrize("words", [*COMMANDS, *OF_DATA])
def test_every_option_is_explained(output, words):
    name, *of_group = words.split()
    command = main.get_command(None, name)
    for part in of_group:
        command = command.get_command(None, part)
    assert output(*words.split(), "--help").startswith(f"Usage: study {words}")
    for option in (of for of in command.params if isinstance(of, click.Option)):
        assert re.search(r"\w{3}.*\.$", option.help), option.name


@pytest.mark.parametrize("name", WITH_MANY_OPTIONS)
def test_help_has_the_common_options_and_help_all_has_every_option(output, name):
    brief, whole = output(name, "--help"), output(name, "--help-all")
    described = [of for of in main.get_command(None, name).params if isinstance(of, click.Option)]
    options = {name for of in described for name in of.opts if name.startswith("--")}
    assert len(brief.splitlines()) <= 45
    assert "--help-all" in brief
    assert options <= {*re.findall(r"^  (--[\w-]+)", whole, re.M)}
    for option in described:
        assert "".join(option.help.split()) in "".join(whole.split())
    assert len(re.findall(r"^  --", brief, re.M)) < len(options)
    assert output(name, "--help") == brief  # also after --help-all in the same process


def test_the_common_options_exist():
    commands = [main.get_command(None, name) for name in WITH_MANY_OPTIONS]
    names = {option.name for command in commands for option in command.params} | {"help"}
    assert [name for command in commands for name in command.common if name not in names] == []


def test_joint_is_the_elastic_solution(table, output):
    solution = BRONZE.solve(force=3e3)
    assert table("joint", *SIZED, "--force", "3kN").depth[0] == pytest.approx(solution.depth[0])
    (row,) = json.loads(output("joint", *SIZED, "--force", "3kN", "--json"))
    assert row["peak_pressure"] == pytest.approx(solution.peak_pressure[0])


def test_off_the_axis_the_power_law_is_added_on_request(table):
    words = ["joint", "--r2-star", "100", "--ball-support", "core:0.3", "--tilt", "20"]
    words += ["--depth-star", "0.2"]
    assert "power_exponent" not in table(*words)
    core = Joint.from_ratios(100, ball_support="core:0.3", rim="free")
    fit = core.power_law((0.1e-2, 0.4e-2), 20)
    assert table(*words, "--power-law").power_exponent[0] == pytest.approx(fit.exponent)


def test_a_terminal_has_the_units_of_a_reader():
    columns = {"depth": [4.2323e-6, None], "law": ["a", "b"], "warnings": ["It yields.", ""]}
    few = for_reader(columns, JOINTS.results).splitlines()
    assert few == ["depth um  4.232", "law           a  b", "", "Warning: It yields."]
    many = for_reader({"depth": [1e-6 * k for k in range(9)]}, JOINTS.results).splitlines()
    assert many[:3] == ["depth um", "       0", "       1"]


def test_the_line_for_adams_exports_the_same_k_and_n(run, output):
    for loads in (["--force", "3kN"], ["--depth", "1um", "--depth", "5um"]):
        _, out, err = run("joint", *SIZED, *loads, "--json")
        program, *words = shlex.split(err.splitlines()[-1])
        assert (program, words[:3]) == ("study", ["export", "power", "adams"])
        coefficient, exponent = output(*words).split(", ")[-4:-2]  # IMPACT(..., k, n, ...)
        row = json.loads(out)[0]
        assert float(exponent) == pytest.approx(row["power_exponent"], rel=1e-6)
        in_mm = row["power_coefficient"] * 1e-3 ** row["power_exponent"]
        assert float(coefficient) == pytest.approx(in_mm, rel=1e-6)


def test_a_bearing_has_the_same_k_and_n_in_every_command(run, output, table):
    words = ["--bearing", "GE 20 E", "--play", "60um"]
    _, out, err = run("joint", *words, "--force", "30kN", "--power-law", "--json")
    (row,) = json.loads(out)
    assert "clearance=3e-05, wall=0.00297, ball=bearing steel, socket=bearing steel" in err
    assert row["specific_load"] == pytest.approx(30e3 / 12e-3 / 29e-3, rel=1e-6)
    ends = (word for of in ("power_from", "power_to") for word in ("--depth", f"{row[of]:.9g}"))
    text = output("export", "power", "c", *words, *ends)
    k, n = re.search(r"k = (\S+), n = (\S+)", text).groups()
    assert float(k) == pytest.approx(row["power_coefficient"], rel=1e-6)
    assert float(n) == pytest.approx(row["power_exponent"], rel=1e-6)
    low, high = (f"({1e6 * row[of]:.4g} um)" for of in ("power_from", "power_to"))
    stated = " ".join(text.replace("\n * ", " ").split())
    assert re.search(
        rf"Range: penetration depths from 0 to \S+ clearances {re.escape(high)}", stated
    )
    assert f"{low}: at most {percent(row['power_error'])} relative to" in stated
    assert f"k = {k}, n = {n}" in output("export", "power", "c", *words, "--force", "30kN")
    listed = table("data", "bearings").set_index("name").loc["GE 20 E"]
    assert listed[["bore", "normal_max"]].tolist() == [0.02, 82e-6]


def test_options_replace_the_columns_of_a_file(run, tmp_path):
    (tmp_path / "cases.csv").write_text("part,force,clearance\na,3kN,1um\nb,-3kN,2um\n")
    words = ["joint", tmp_path / "cases.csv", *SIZED, "--jobs", 1]
    status, _, err = run(*words, "--output", tmp_path / "table.csv")
    assert status == 1
    assert "Columns that are no parameters are copied: part" in err
    assert "1 of 2 cases failed: force must be > 0 N, got -3000 N" in err
    made = pd.read_csv(tmp_path / "table.csv")
    assert made.depth[0] == pytest.approx(BRONZE.solve(force=3e3).depth[0])
    assert made.part.tolist() == ["a", "b"]


def test_a_file_with_one_row_is_a_joint(output, table, tmp_path):
    file = tmp_path / "cup.csv"
    file.write_text("socket_radius [mm];clearance [um];wall [mm];socket\n12,5;40;6;bronze\n")
    assert output("laws", file, "--force", "3kN") == output("laws", *SIZED, "--force", "3kN")
    assert output("export", "power", "c", file) == output("export", "power", "c", *SIZED)
    assert output("fit", CURVE, file) == output("fit", CURVE, *SIZED)
    assert len(table("joint", file, "--force", "3kN", "--plot", tmp_path / "joint.png")) == 1
    assert (tmp_path / "joint.png").read_bytes().startswith(b"\x89PNG")
    deeper = table("joint", file, "--clearance", "20um", "--force", "3kN").depth[0]
    smaller = Joint(12.5e-3, 20e-6, 6e-3, socket="bronze")
    assert deeper == pytest.approx(smaller.solve(force=3e3).depth[0])


def test_what_was_solved_before_ctrl_c_is_shown(run, tmp_path, monkeypatch):
    solve = JOINTS.solve

    def interrupted(case):
        if case["r2_star"] == "60":
            raise KeyboardInterrupt
        return solve(case)

    monkeypatch.setattr("study.cli.joint.JOINTS", JOINTS._replace(solve=interrupted))
    (tmp_path / "cases.csv").write_text("r2_star,depth_star\n50,0.1\n60,0.1\n")
    status, out, err = run("joint", tmp_path / "cases.csv", "--jobs", 1)
    assert (status, err.splitlines()[-1]) == (130, "interrupted")
    assert pd.read_csv(StringIO(out)).r2_star.tolist() == [50]


def test_laws_are_compared(table):
    found = table("laws", "--r2-star", 200, "--depth-star", 0.5)
    expected = choose.compare_laws(Joint.from_ratios(200), 0.5)
    assert found.law.tolist() == expected.law.tolist()
    assert found.error.to_numpy() == pytest.approx(expected.error.to_numpy())


def test_own_curve_is_fitted(table):
    found = table("fit", CURVE, "--fit", "clearance", "--fit", "offset", *SIZED)
    best = found.set_index("law").loc["tabulated"]
    assert (best.clearance, best.offset) == pytest.approx((43.876e-6, 1.5163e-6), rel=1e-4)


def test_export_is_that_of_the_function(run, tmp_path):
    depths = [2e-6, 8e-6]
    text = export("power", "adams", BRONZE, [depth / 40e-6 for depth in depths])
    words = ["export", "power", "adams", *SIZED, "--depth", "8um", "--depth", "2um"]
    assert run(*words) == (0, text, "")
    assert run(*words, "--output", tmp_path / "law.txt") == (0, "", "")
    assert (tmp_path / "law.txt").read_text() == text
    metres = ["--socket-radius", "12.5", "--clearance", "0.04", "--wall", "6", "--socket", "bronze"]
    assert "Warning: " in run("export", "power", "c", *metres)[2]


def test_simulation_has_three_tables(table, run, tmp_path):
    words = ["simulate", "--duration", "10ms"]
    found = table(*words)
    assert found.contacts[0] == len(table(*words, "--table", "impacts")) > 3
    assert found.agrees_until[0] == pytest.approx(0.01)
    assert "agrees_until" not in table(*words, "--once")
    assert table(*words, "--table", "motion").time.iloc[-1] == pytest.approx(0.01)
    (tmp_path / "cases.csv").write_text("clearance [um],duration [ms]\n50,10\n50,5\n")
    many = table("simulate", tmp_path / "cases.csv", "--jobs", 1)
    assert many.largest_force[0] == pytest.approx(found.largest_force[0])


def test_models_are_compared(table):
    found = table("models", "--duration", "10ms")
    assert found.joint.tolist() == ["ideal", "ideal_with_friction", "clearance", "clearance"]


@pytest.mark.parametrize("kind", ["summary", "impacts"])
def test_a_wrong_contact_force_is_reported(run, table, kind):
    words = ["simulate", "--model", "particles", "--method", "unguarded", "--elements", "2,4"]
    words += ["--step", "3.5us", "--duration", "120ms", "--law", "hertz", "--table", kind]
    if kind == "summary":
        found = table(*words).iloc[0]
        assert found.contact_energy_error > 1
        assert found.applicability.split("; ")[0] == "energy"
        assert "contact force may be wrong" in found.warnings
    else:
        status, _, err = run(*words)
        assert status == 0
        assert "the contact force may be wrong" in err


def test_dataset_is_selected(table):
    rows = table("data", "show", "--group", "paper", "--r2-star", 200, "--r2-star", 100)
    expected = dataset.summary(dataset.load(group="paper", r2_star=[200, 100]))
    assert rows.case.tolist() == expected.case.tolist()
    one = table("data", "show", "--case", "paper-small-200")
    assert len(one) == len(dataset.load(case="paper-small-200"))
    every = pd.read_csv(materials.MATERIALS)
    pd.testing.assert_frame_equal(table("data", "materials"), every)


def test_a_sample_of_the_dataset_is_solved_again(output):
    assert re.search(r"2 of \d+ cases agree", output("data", "check", "--sample", 2, "--jobs", 1))
