"""Parameters that are described once: defaults, ranges, texts, options and columns agree."""

import math
import re

import numpy as np
import pytest

from study import checks
from study.cases.joints import JOINTS
from study.cases.scenes import SCENES
from study.cli import main
from study.contact import Material
from study.joint import Joint, Layer, Liner
from study.joint.supports import Core, Neck, Sector
from study.mechanism import Scene
from study.mechanism.simulate import simulate
from study.parameters import defaults, described

RATIOS = Joint.from_ratios
OWNERS = (Joint, Scene, Material, Liner, Core, Neck, Sector, RATIOS, simulate)
RENAMED = {"layers": "layer"}
"""Arguments of `Joint.from_ratios` whose option and column have another name."""
EVERY = [
    pytest.param(owner, name, about, id=f"{owner.__name__}.{name}")
    for owner in OWNERS
    for name, about in described(owner).items()
]
every_parameter = pytest.mark.parametrize(("owner", "name", "about"), EVERY)
OUTSIDE = {"above": -math.inf, "least": -math.inf, "below": math.inf, "most": math.inf}
"""Limit -> where the next number outside it is."""
GIVEN = {
    Joint: {"socket_radius": 0.01, "clearance": 1e-4, "wall": 3e-3},
    Liner: {"thickness": 1e-3, "material": Material()},
    Core: {"radius": 0.2},
    Neck: {"half_angle": 30.0},
    Sector: {"first": 0.0, "last": 30.0},
}
"""What an object needs."""
COMMANDS = [
    (RATIOS, "joint", JOINTS),
    (Joint, "export", JOINTS),
    (Scene, "simulate", SCENES),
    (simulate, "simulate", SCENES),
]
"""Owner of parameters, a command that has them as options, and the cases that have them."""
OF_PYTHON = {"scene", "progress"}
"""Arguments of `simulate` that have no text."""
OTHERS = {
    "liner": (Liner(0.5e-3, Material(5e8, 0.46)), Liner(1e-3, Material(7e10, 0.33))),
    "ball_support": Neck(25.0),
    "socket_support": Sector(10.0, 60.0),
    "ball": Material(7e10, 0.33),
    "elements": (3, 5),
    "initial_eccentricity": (1e-5, 0.0),
    "law": "winkler",
    "half_angle": 25.0,
    "link_modulus": 7e10,
    "socket_ratio": 1.5,
    "tolerance": 1e-7,
}
"""Values of parameters other than their defaults."""


def a_value(owner, name, about):
    """A value of a parameter that has a text: another one than the default where one is known."""
    if name in OTHERS:
        return OTHERS[name]
    default = defaults(owner).get(name)
    if about.choices:
        return about.choices[-1]
    if default not in (None, ()):
        return about.taken(name, default)
    return None if about.kind is not object else (2 if about.whole else 0.25)


@every_parameter
def test_a_default_is_allowed_and_a_text_reads_back_to_its_value(owner, name, about):
    assert about.meaning
    default = defaults(owner).get(name)
    for value in (default, a_value(owner, name, about)):
        if value in (None, ()) or about.kind is Layer or name in OF_PYTHON:
            continue
        taken = about.taken(name, value)
        assert about.taken(name, taken) == taken
        assert about.taken(name, about.written(taken)) == taken


@every_parameter
def test_a_value_outside_or_of_a_wrong_type_is_one_error_that_names_it(owner, name, about):
    outside = [np.nextafter(limit, OUTSIDE[sign]) for sign, limit in about.limits.items()]
    outside += [limit for sign, limit in about.limits.items() if sign in ("above", "below")]
    outside += ["of another kind"] if about.choices else []
    if about.whole:
        outside = [about.limits["least"] - 1]
    if name not in OF_PYTHON and (owner, name) != (simulate, "law"):
        outside += [np.nan, True, {}, [[0.1], [0.2, 0.3]], 10**400]
    for value in outside:
        wrong = (value,) * (about.count or 1) if about.several else value
        with pytest.raises(ValueError, match=f"{name}|{re.escape(about.meaning)}") as raised:
            owner(**GIVEN.get(owner, {}) | {name: wrong})
        assert "\n" not in str(raised.value)


@pytest.mark.parametrize(("owner", "word", "kind"), COMMANDS)
def test_every_parameter_is_an_option_and_a_column(owner, word, kind):
    options = {option.name for option in main.get_command(None, word).params}
    for name, about in described(owner).items():
        if name not in OF_PYTHON:
            assert kind.parameters[RENAMED.get(name, name)] is about
            assert RENAMED.get(name, name) in options


@pytest.mark.parametrize("kind", [np.float32, np.longdouble, np.int64, np.array])
def test_numpys_numbers_are_stored_as_pythons(kind):
    joint = Joint.from_ratios(kind(200), kind(2), ball=Material(kind(2**37), poisson=0.25))
    assert joint == Joint.from_ratios(200, 2, ball=Material(2**37, poisson=0.25))
    assert {type(joint.r2_star), type(joint.socket_ratio)} == {float}


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("ball_support", "edge", "neck:NUMBER, bore:NUMBER,NUMBER, pin:NUMBER,NUMBER, got 'edge'"),
        ("opening", "125:55", "LAST >= FIRST + 10 deg, for example 55:125, got 125:55"),
        ("socket_support", "sector:60", "must be two numbers separated by a comma, got '60'"),
        ("socket_support", "sector:90,60", "of the sector must be >= 95 deg, got 60 deg"),
        ("layers", "1.2,1", "layers must be three numbers separated by commas, got '1.2,1'"),
        ("rim", "held", "rim must be one of mirror, free, got 'held'"),
    ],
)
def test_a_wrong_text_is_one_error(name, text, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        Joint.from_ratios(**{name: text})


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("12.5 mm", "m", 12.5e-3),
        ("40\u00b5m", "m", 40e-6),
        ("40\u03bcm", "m", 40e-6),
        ("1in", "m", 0.0254),
        ("3kN", "N", 3000.0),
        ("2 lbf", "N", 8.896443230521),
        ("1psi", "Pa", 6894.757293168361),
        ("30e3ksi", "Pa", 2.0684271879505083e11),
        ("2kg", "kg", 2.0),
        ("5g", "kg", 0.005),
    ],
)
def test_a_number_with_its_unit_is_exactly_that_of_the_si_unit(text, unit, value):
    assert checks.read("name", text, unit=unit) == value


@pytest.mark.parametrize(
    ("text", "unit", "message"),
    [
        ("12.5Mm", "m", ", got '12.5Mm'; Mm is a megametre, and mm or um was probably meant"),
        ("2km", "m", ", got '2km'; km is a kilometre, and mm or um was probably meant"),
        ("2in", "N", "such as 3kN, got '2in'"),
        ("2kpsi", "Pa", "such as 110GPa, got '2kpsi'"),
        ("2MIN", "m", "such as 5mm, got '2MIN'"),
    ],
)
def test_a_wrong_unit_is_one_error(text, unit, message):
    with pytest.raises(ValueError, match=f"^name must be a number in {unit}, .*{message}$"):
        checks.read("name", text, unit=unit)


@pytest.mark.parametrize(
    ("error", "text"),
    [(0.01044, "1.1 %"), (0.01, "1 %"), (0.0996, "10 %"), (0.000131, "0.014 %"), (0, "0 %")],
)
def test_errors_in_percent_are_rounded_upwards(error, text):
    assert checks.percent(error) == text
