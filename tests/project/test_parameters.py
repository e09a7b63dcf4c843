"""Parameters that are described once: defaults, ranges, texts, options and columns agree."""

import math
import re
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study.checks import RangeError
from study.cli.options import flag
from study.cli.program import PROGRAM
from study.contact import Material
from study.joint import Joint, Layer, Liner
from study.joint.supports import (
    BALL_SUPPORTS,
    SOCKET_SUPPORTS,
    Bore,
    Core,
    Neck,
    Opening,
    Pin,
    Sector,
)
from study.mechanism import Scene
from study.mechanism.simulate import simulate
from study.parameters import defaults, described
from study.sweep.cases import inputs

RATIOS = Joint.from_ratios
CLASSES = (Joint, Scene, Material, Liner, Core, Neck, Sector)
OWNERS = (*CLASSES, RATIOS, simulate)
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
COMMANDS = {
    RATIOS: ("joint", "choose", "export"),
    Joint: ("joint", "export"),
    simulate: ("simulate",),
}
COLUMNS = {
    RATIOS: "joints",
    Joint: "joints with dimensions",
    Scene: "scenes",
    simulate: "scenes",
}
OF_PYTHON = {"scene", "progress"}
"""Arguments of `simulate` that have no text."""


def numbers(about):
    """Numbers inside the limits of a parameter, with the 9 digits that a text has."""
    low, high = (
        next((about.limits[sign] for sign in signs if sign in about.limits), other)
        for signs, other in ((("above", "least"), -1e6), (("below", "most"), 1e6))
    )
    if about.unit == "Pa":
        low, high = 1e5, 1e13
    if about.whole:
        return st.integers(int(low), int(high))
    high = high if high > low else 2 * low
    return st.floats(0.001, 0.999).map(lambda x: float(f"{low + (high - low) * x:.9g}"))


def values(about):
    """Values of a parameter that have a text."""
    if about.choices:
        return st.sampled_from(about.choices)
    if about.kind is str:
        return st.sampled_from(["hertz", "tabulated"])
    if about.kind is object:
        return numbers(about)
    known = {Material: materials, Liner: liners, Opening: openings}
    return known.get(about.kind, partial(supports, about.kind))()


def objects(kind):
    return st.builds(kind, **{name: values(about) for name, about in described(kind).items()})


def materials():
    return objects(Material).map(lambda m: Material(m.youngs_modulus, m.poisson))


def liners():
    return st.builds(Liner, st.floats(1e-6, 1).map(lambda x: float(f"{x:.9g}")), materials())


def openings():
    cups = st.builds(Opening, st.integers(30, 170).map(float))
    return cups | st.builds(Opening, st.integers(80, 170).map(float), st.integers(5, 70).map(float))


def supports(kind):
    kinds = [each for each in (*BALL_SUPPORTS, *SOCKET_SUPPORTS) if issubclass(each, kind)]
    kinds = [each for each in kinds if each not in (Bore, Pin)]  # their numbers go together
    sectors = st.builds(Sector, st.integers(0, 80).map(float), st.integers(85, 170).map(float))
    return st.one_of(sectors if each is Sector else objects(each) for each in kinds)


def text_of(draw, about):
    """A value of a parameter, and its text."""
    value = draw(values(about))
    if about.several:
        value = (value,) * (about.count or draw(st.integers(1, 3)))
    return value, about.written(value)


@every_parameter
def test_a_default_is_allowed(owner, name, about):
    assert about.meaning
    default = defaults(owner).get(name)
    if default is not None:
        taken = about.taken(name, default)
        assert about.taken(name, taken) == taken


@every_parameter
@settings(max_examples=10)
@given(data=st.data())
def test_a_text_reads_back_to_its_value(owner, name, about, data):
    if name in OF_PYTHON or about.kind is Layer:
        return
    value, text = text_of(data.draw, about)
    assert about.taken(name, about.read(name, text)) == value
    assert about.taken(name, value) == value


@every_parameter
def test_a_value_outside_is_one_error_that_names_it(owner, name, about):
    outside = [np.nextafter(limit, OUTSIDE[sign]) for sign, limit in about.limits.items()]
    outside += [limit for sign, limit in about.limits.items() if sign in ("above", "below")]
    outside += ["of another kind"] if about.choices else []
    for value in outside:
        if about.whole:
            value = about.limits["least"] - 1
        wrong = (value,) * (about.count or 1) if about.several else value
        with pytest.raises(
            RangeError, match=rf"^({name}|{re.escape(about.meaning)}) must be "
        ) as raised:
            make(owner, name, wrong)
        assert "\n" not in str(raised.value)


WRONG = (np.nan, True, 1j, {}, [[0.1], [0.2, 0.3]], 10**400, np.ma.masked_array([0.1], [True]))


@every_parameter
def test_a_wrong_type_is_one_error_that_names_it(owner, name, about):
    if name in OF_PYTHON or (owner, name) == (simulate, "law"):
        return
    for value in (*WRONG, *(["x"] if about.kind is object else [])):
        with pytest.raises(ValueError, match=f"{name}|{re.escape(about.meaning)}") as raised:
            make(owner, name, value)
        assert "\n" not in str(raised.value)


def make(owner, name, value):
    """Object of a class, or simulation, with one value."""
    return owner(**GIVEN.get(owner, {}) | {name: value})


@pytest.mark.parametrize(
    ("owner", "word"), [(owner, word) for owner, words in COMMANDS.items() for word in words]
)
@settings(max_examples=3)
@given(data=st.data())
def test_every_parameter_is_an_option_that_takes_its_text(owner, word, data):
    command = PROGRAM.get_command(None, word)
    for option in command.params:
        option.required = False
    chosen, words = {}, []
    for name, about in described(owner).items():
        if name not in OF_PYTHON and about.kind is not Layer:
            chosen[name], text = text_of(data.draw, about)
            texts = text.split(";") if about.several == ";" else [text]
            words += [f"{flag(name)}={one}" for one in texts]
    found = command.make_context("study", words).params
    for name, value in chosen.items():
        about, typed = described(owner)[name], found[name]
        read = about.read(name, typed) if about.several == "," else typed
        assert about.taken(name, read) == value, name


@pytest.mark.parametrize("owner", COLUMNS)
def test_every_parameter_is_a_column(owner):
    columns = inputs(COLUMNS[owner])
    for name, about in described(owner).items():
        assert name in OF_PYTHON or columns[RENAMED.get(name, name)] is about


@pytest.mark.parametrize("owner", [Joint, RATIOS, Scene, Material, simulate])
def test_documentation_has_every_parameter_with_unit_and_range(owner):
    document = " ".join(owner.__doc__.split())
    for name, about in described(owner).items():
        unit = about.unit and f"in {about.unit}"
        assert f" {name} {' '.join(about.meaning.split())}" in document
        assert unit in document
        assert about.range in document


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.longdouble, np.int64, np.array])
def test_numpys_numbers_are_stored_as_pythons(kind):
    joint = Joint.from_ratios(kind(200), kind(2), ball=Material(kind(2**37), poisson=0.25))
    assert joint == Joint.from_ratios(200, 2, ball=Material(2**37, poisson=0.25))
    assert hash(joint) == hash(Joint.from_ratios(200, 2, ball=Material(2**37, poisson=0.25)))
    assert {type(joint.r2_star), type(joint.socket_ratio)} == {float}
    scene = Scene(coupler_length=kind(2), gravity=kind(9))
    assert (scene, type(scene.gravity)) == (Scene(coupler_length=2, gravity=9), float)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("ball_support", "edge", "neck:NUMBER, bore:NUMBER,NUMBER, pin:NUMBER,NUMBER, got 'edge'"),
        ("opening", "125:55", "LAST >= FIRST + 10 deg, for example 55:125, got 125:55"),
        ("socket_support", "sector:60", "must be two numbers separated by a comma, got '60'"),
        ("socket_support", "sector:90,60", "of the sector must be >= 95 deg, got 60 deg"),
        ("layers", "1.2,1", "layers must be three numbers separated by commas, got '1.2,1'"),
    ],
)
def test_a_wrong_text_is_one_error(name, text, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        Joint.from_ratios(**{name: text})
