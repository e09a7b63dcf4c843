"""The commands for laws: evaluate, choose, export."""

import json
import re
import shlex

import numpy as np
import pytest

from study import contact
from study.choose import choose
from study.export import export
from study.joint import Joint, Material, first_yield

SIZES = ["--socket-radius", 12.5e-3, "--clearance", 40e-6, "--wall", 6e-3, "--socket", "bronze"]
CHOOSE = ["choose", "--r2-star", 200, "--depth-star", 0.3]


@pytest.mark.parametrize("law", contact.LAWS)
def test_a_law_is_one_json_object_in_the_order_asked(run, law):
    words = ["--r2-star", 200, "--depth-star", 0.5, "--depth-star", 0.1]
    status, out, err = run("law", law, *words, "--json")
    assert (status, err) == (0, "")
    kind = contact.LAWS[law]  # the default of a law that is not of one joint is the paper's
    made = kind.of(Joint.from_ratios(200)) if kind.needs_joint else kind()
    assert json.loads(out)["force_star"] == pytest.approx(made(np.array([0.5, 0.1]), 200))


@pytest.mark.parametrize("law", ["stiffened_hertz", "tabulated"])
def test_a_law_of_a_joint_takes_its_options(run, law):
    words = ["--socket-ratio", 1.5, "--poisson", 0.4, "--modulus-ratio", 0.5]
    words += ["--socket-poisson", 0.3, "--ball-support", "clamped", "--rim", "free"]
    _, out, _ = run("law", law, "--r2-star", 50, "--depth-star", 0.3, *words, "--json")
    materials = {"poisson": 0.4, "modulus_ratio": 0.5, "socket_poisson": 0.3}
    joint = Joint.from_ratios(50, 1.5, **materials, ball_support="clamped", rim="free")
    expected = contact.LAWS[law].of(joint)(0.3)
    assert json.loads(out)["force_star"] == pytest.approx([expected])


def test_a_law_takes_its_numbers_and_no_others(run):
    point = ["--r2-star", 50, "--depth-star", 0.3]
    _, out, _ = run("law", "power", *point, "--coefficient", 600, "--exponent", 1.7, "--json")
    assert json.loads(out)["force_star"] == pytest.approx([contact.Power(600, 1.7)(0.3, 50)])


def test_a_law_takes_a_joint_with_dimensions(run):
    words = ["law", "hertz", *SIZES, "--depth", "4um", "--json"]
    found = json.loads(run(*words)[1])
    joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
    assert found["force"] == pytest.approx([joint.law("hertz").force(4e-6)])
    assert found["depth_star"] == pytest.approx([0.1])
    in_mm = json.loads(run(*words, "--units", "mm")[1])
    assert (in_mm["depth"], in_mm["force"]) == ([4e-3], found["force"])


def test_choose_prints_the_law_its_error_and_its_cost(run):
    words = ["--socket-ratio", 1.3, "--poisson", 0.3, "--tolerance", 0.01]
    status, out, err = run(*CHOOSE, *words, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["law"] == "stiffened_hertz"
    assert 1e-5 < found["error_bound"] < 0.01
    assert 1 < found["relative_cost"] < 5
    assert found["next_cheaper"]["error"] > 0.01
    _, out, _ = run(*CHOOSE, *words)
    assert "stiffened_hertz" in out
    assert all(law in out for law in contact.CLOSED_FORM)


def test_choose_warns_beyond_yield(run):
    words = ("choose", "--r2-star", 200, "--depth-star", 0.4, "--tolerance", 0.5)
    text = run(*words, "--yield-stress", 2.5e8)[1]
    assert re.search(r"The socket yields at the surface at depths above 0\.25\d* clearances", text)
    found = json.loads(run(*words, "--yield-stress", 2.5e8, "--json")[1])["first_yield"]
    steel = Material(yield_stress=2.5e8)
    joint = Joint.from_ratios(200, ball=steel, socket=steel)
    assert found == pytest.approx(vars(first_yield(joint, 0.4)))
    for more in ((), ("--yield-stress", 2e9)):
        assert json.loads(run(*words, *more, "--json")[1])["first_yield"] is None
        assert "yields" not in run(*words, *more)[1]


def test_choose_ends_with_status_1_where_no_law_is_known(run):
    status, out, err = run(*CHOOSE, "--tolerance", 1e-5, "--ball-support", "clamped")
    assert (status, out, err.count("\n")) == (1, "", 1)
    assert "no law is known to be within" in err


EXPORT = ["export", "--law", "hertz", "--format", "c"]


def test_choose_takes_a_joint_with_its_dimensions(run):
    joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
    depth = joint.solve(force=3000).depth[0]
    words = ["choose", *SIZES, "--tolerance", 0.01]
    found = [
        json.loads(run(*words, *largest, "--json")[1])
        for largest in (["--force", 3000], ["--depth", depth], ["--depth-star", depth / 40e-6])
    ]
    expected = choose(joint, depth / 40e-6, 0.01)
    for each in found:
        assert each["law"] == expected.law.name == "stiffened_hertz"
        assert each["depths"] == pytest.approx(expected.depths)
        assert each["error_bound"] == pytest.approx(expected.error_bound)
    text = run(*words, "--force", 3000)[1]
    assert "clearances (0.2 to 4.232 um)." in text
    line = text.splitlines()[-1]
    assert line == found[0]["export"]
    assert run(*shlex.split(line)[1:])[0] == 0
    _, text, _ = run(*words, "--force", 90000)
    assert "Warning: The socket yields" in text


@pytest.mark.slow
def test_choose_heads_its_answer_with_no_law_that_does_not_serve_all_directions(run):
    words = [*CHOOSE, "--ball-support", "neck:30", "--opening", 110, "--tilt", 20]
    (_, text, _), (_, out, _) = (
        run(*words, "--tolerance", 0.05, *more) for more in ([], ["--json"])
    )
    found = json.loads(out)
    assert (found["law"], found["one_law_for_all_directions"]) == (None, False)
    assert found["along_the_axis"]["law"] == "tabulated"
    first, command, *_ = text.splitlines()
    assert re.match(r"One law .* is not known to be accurate enough .* up to 20 deg", first)
    assert command == found["export"]
    assert "--law tabulated --tilt 20" in command
    loose = json.loads(run(*words, "--tolerance", 0.5, "--json")[1])
    assert loose["one_law_for_all_directions"] is True
    assert loose["law"] == "hertz"
    assert -loose["direction_error"] < loose["force_change"] < loose["stiffness_change"] < 0
    assert loose["error_bound"] + loose["direction_error"] <= 0.5
    first = run(*words, "--tolerance", 0.5)[1].splitlines()[0]
    assert re.match(r"One law .* is accurate enough for all tilts up to 20 deg: ", first)
    tight = json.loads(run(*words, "--tolerance", loose["direction_error"], "--json")[1])
    assert tight["law"] is None  # nothing is left for the law's own error


@pytest.mark.slow
def test_choose_says_what_to_use_where_no_law_along_the_axis_applies(run):
    ring = ["--ball-support", "bore:0.5,45", "--opening", "55:125", "--tolerance", 0.1]
    joint = Joint(
        12.5e-3, 40e-6, 6e-3, socket="bronze", ball_support="bore:0.5,45", opening="55:125"
    )
    status, out, _ = run("choose", *SIZES, *ring, "--force", 3000, "--json")
    found = json.loads(out)
    power = found["power_law"]
    assert (status, found["law"], power["tilt"]) == (0, None, 90)
    depth = power["depths"][1]
    assert depth == pytest.approx(0.5 * 40e-6)
    law = power["coefficient"] * depth ** power["exponent"]
    force = joint.solve(depth=depth, tilt=90).force[0]
    assert law == pytest.approx(force, rel=1.01 * power["error"])
    text = run("choose", *CHOOSE[1:], *ring)[1]
    assert re.match("No law .* applies to a ring", text)
    assert "which is within the tolerance of 10 %" in text
    last = text.splitlines()[-1]
    assert last.startswith("study export --law tabulated --tilt 90 --format c ")


def test_export_takes_unequal_materials(run):
    words = ["--r2-star", 150, "--modulus-ratio", 0.35, "--socket-poisson", 0.33]
    joint = Joint.from_ratios(150, modulus_ratio=0.35, socket_poisson=0.33)
    for law in ("tabulated", "stiffened_hertz"):
        _, out, _ = run("export", "--law", law, "--format", "csv", *words)
        assert out == export(law, "csv", joint)


def test_export_takes_the_numbers_of_a_law(run):
    words = ["export", "--format", "c", "--r2-star", 150, "--law"]
    _, out, _ = run(*words, "steuermann", "--option", "n=2", "--option", "radius=profile")
    assert out == export(contact.Steuermann(2, "profile"), "c", Joint.from_ratios(150))
