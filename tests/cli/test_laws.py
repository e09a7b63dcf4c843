"""The commands for laws: evaluate, choose, export."""

import json
import re

import numpy as np
import pytest

from study import contact
from study.joint import Joint, Material, first_yield

CHOOSE = ["choose", "--r2-star", 200, "--depth-star", 0.3]


@pytest.mark.parametrize("law", contact.LAWS)
def test_a_law_is_one_json_object_in_the_order_asked(run, law):
    words = ["--r2-star", 200, "--depth-star", 0.5, "--depth-star", 0.1]
    status, out, err = run("law", law, *words, "--json")
    assert (status, err) == (0, "")
    force = json.loads(out)["force_star"]
    assert force == pytest.approx(list(contact.LAWS[law](np.array([0.5, 0.1]), 200)))


def test_a_law_gets_its_options(run):
    words = ["--socket-ratio", 1.5, "--poisson", 0.4, "--modulus-ratio", 0.5]
    words += ["--socket-poisson", 0.3, "--ball-support", "clamped", "--rim", "free"]
    point = ["--r2-star", 50, "--depth-star", 0.3]
    _, out, _ = run("law", "stiffened_hertz", *point, *words, "--json")
    materials = {"poisson": 0.4, "modulus_ratio": 0.5, "socket_poisson": 0.3}
    supports = {"ball_support": "clamped", "rim": "free"}
    expected = contact.stiffened_hertz(0.3, 50, socket_ratio=1.5, **materials, **supports)
    assert json.loads(out)["force_star"] == pytest.approx([expected])
    status, _, err = run("law", "hertz", *point, "--ball-support", "clamped")
    told = "study: --ball-support must be left out: hertz does not depend on it\n"
    assert (status, err) == (2, told)


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
    assert all(law in out for law in contact.LAWS)


def test_choose_warns_beyond_yield(run):
    words = ("choose", "--r2-star", 200, "--depth-star", 0.4, "--tolerance", 0.5)
    text = run(*words, "--yield-stress", 2.5e8)[1]
    assert re.search(r"The socket yields, at the surface, from 0\.25\d* clearances on", text)
    assert "errors are for joints that do not yield" in text
    found = json.loads(run(*words, "--yield-stress", 2.5e8, "--json")[1])["first_yield"]
    steel = Material(yield_stress=2.5e8)
    assert found == pytest.approx(vars(first_yield(Joint(200, ball=steel, socket=steel), 0.4)))
    for more in ((), ("--yield-stress", 2e9)):
        assert json.loads(run(*words, *more, "--json")[1])["first_yield"] is None
        assert "yields" not in run(*words, *more)[1]


def test_choose_ends_with_status_1_where_no_law_is_known(run):
    status, out, err = run(*CHOOSE, "--tolerance", 1e-5, "--ball-support", "clamped")
    assert (status, out, err.count("\n")) == (1, "", 1)
    assert "no law is known to be within" in err


def test_export_takes_unequal_materials_and_one_unit_of_depth(run):
    words = ["--r2-star", 150, "--modulus-ratio", 0.35, "--socket-poisson", 0.33]
    for law in ("tabulated", "stiffened_hertz"):
        _, out, _ = run("export", "--law", law, "--format", "json", *words)
        assert json.loads(out)["joint"]["modulus_ratio"] == pytest.approx(0.35)
    words = ["export", "--law", "hertz", "--format", "c"]
    told = "study: --depth must be left out: it is for a joint with its dimensions\n"
    assert run(*words, "--depth", 1e-6) == (2, "", told)
    words += ["--socket-radius", 0.01, "--clearance", 1e-4, "--wall", 3e-3, "--depth", 1e-6]
    told = "study: either --depth or --depth-star must be given, not both\n"
    assert run(*words, "--depth-star", 0.1) == (2, "", told)
