"""Commands and their options. The library's docstrings explain options that are its parameters.

Checks that several commands share are here too.
"""

import os
import re
from dataclasses import fields
from inspect import Parameter, Signature, getdoc, signature
from pathlib import Path
from pkgutil import resolve_name
from types import UnionType
from typing import Annotated, Literal, Union, get_args, get_origin

import typer

from study.contact import LAWS, LawName

STYLE = {"add_completion": False, "rich_markup_mode": None, "pretty_exceptions_enable": False}
app = typer.Typer(
    help="Contact force laws for spherical clearance joints: rebuild, inspect, evaluate.",
    no_args_is_help=True,
    **STYLE,
)
data_app = typer.Typer(help="The cached force-depth curves.", no_args_is_help=True)
app.add_typer(data_app, name="data")

INTERRUPTED = 130  # typer's status after Ctrl-C
KEPT = "; what was finished is kept"
FLAGS = {"ball_drive": "--drive", "form": "--format", "dask_address": "--dask"}
FLAGS |= {"as_json": "--json", "settings": "-p"}
ARGUMENTS = {"name": "NAME", "names": "NAME", "kind": "KIND", "cases": "[FILE]"}
HELP = {
    "as_json": "Print one JSON object.",
    "cases": "CSV file with a row per case; or --random.",
    "case": "One case, with all of its depths.",
    "clearance": "Radius of the socket minus that of the ball, in m.",
    "depth": "Penetration depth in m; may be repeated.",
    "depth_star": "Penetration depth in clearances, d/dR; may be repeated.",
    "force": "Contact force in N; may be repeated.",
    "group": "Group of cases: paper, ratio, poisson, modulus, support, liner or judge.",
    "inertia": "Inertias of crank and coupler about their centres, in kg m^2: I1,I2 "
    "[default: rods].",
    "kind": "What the cases are: joints or scenes.",
    "keep": "Keep the results that differ, instead of those kept before.",
    "liner": "Thickness in m and material of a liner inside the socket, 0.5e-3,PTFE; may be "
    "repeated, from the inside out.",
    "model": "Links; auto: the simplest that is accurate enough.",
    "name": f"One of {', '.join(LAWS)}.",
    "names": "Figures, tables or notebooks; default all.",
    "output": "File to write.",
    "r2_star": "Radius of the socket in clearances, R2/dR, > 1.",
    "random": "Number of cases drawn at random from every --range.",
    "range": "Range of a column: NAME=LOW:HIGH, drawn evenly, NAME=LOW:HIGH:log, or the values to "
    "choose from, NAME=A,B,C; may be repeated.",
    "scene": "KEY=VALUE of the scene; may be repeated.",
    "seed": "Seed of the random numbers [default: 0]; the same seed gives the same cases.",
    "settings": "KEY=VALUE of a notebook's parameter; may be repeated.",
    "socket_radius": "Inner radius of the socket, in m.",
    "socket_ratio": "Outer over inner radius of the socket.",
    "tolerance": "For a joint with dimensions: largest relative error of the law that is chosen "
    "[default: 0.01].",
    "wall": "Thickness of the socket beyond its inner radius, liners included, in m.",
}
"""Help of options that the library's docstrings do not explain."""
PLAIN = {
    "ball_drive": "Equatorial plane of the half ball: moved along the axis and radially free "
    "(plane), clamped to a rigid plate (clamped), or moved at its centre alone (point).",
    "duration": "Simulated time, in s.",
    "kinematics": "Which points of the surfaces face each other. small: those at equal angles "
    "from the socket's centre; linear: those that the ball's points have moved to, as in a "
    "small-strain analysis with contact on moved surfaces; finite: large displacements.",
    "poisson": "Poisson's ratio of the ball, and of the socket unless it differs (no unit).",
    "quantity": "Part of the slider's motion that --tolerance is for.",
    "repeats": "Number of timed calls, after one that does not count.",
    "rim": "Edge of the socket at its equator: a mirror plane, or free of traction.",
    "socket_poisson": "Poisson's ratio of the socket, if it differs (no unit).",
}
"""Help that replaces the library's docstrings, which are longer or assume more."""
METAVARS = {bool: None, float: "NUMBER", int: "COUNT", str: "TEXT", Path: "FILE"}


class InterruptionError(Exception):
    """Ctrl-C in a command; says what is kept, if anything."""


def command(name, *library, group=app, defaults=True, keeps=False):
    """Decorate a function as a command: its annotated parameters become options.

    So do parameters of the library, as "module:function parameter parameter ...". The function gets
    those that are given. They are looked up when the command is called, so that ``study --help``
    imports no room. A command that ``keeps`` finished work when it is interrupted does so unless
    --output is given.
    """

    def decorate(function):
        def call(**given):
            given = {key: value for key, value in given.items() if value is not None}
            try:
                return function(**given)
            except KeyboardInterrupt:
                raise InterruptionError(KEPT if keeps and "output" not in given else "") from None

        class Command(typer.core.TyperCommand):
            def make_context(self, *args, **more):
                own = signature(function).parameters.values()
                given = [_option(p, _help(p.name)) for p in own if p.annotation is not p.empty]
                for entry in library:
                    source, *names = entry.split()
                    given += _options(resolve_name(source), names, defaults)
                call.__signature__ = Signature(given)
                one = typer.Typer(**STYLE)
                one.command(help=getdoc(function))(call)
                return typer.main.get_command(one).make_context(*args, **more)

        text = getdoc(function)
        short = " ".join(text.split("\n\n")[0].split())
        group.command(name, cls=Command, help=text, short_help=short)(lambda: None)
        return function

    return decorate


def _help(name):
    """Help of an option; that of a scene has its keys, with their units."""
    if name != "scene":
        return HELP[name]
    from study.mechanism import Scene

    units = {each.name: each.metadata["unit"].replace("1", "-") for each in fields(Scene)}
    keys = (f"{key} ({unit})" if unit else key for key, unit in units.items())
    return HELP[name].replace(".", f"; KEY (unit): {', '.join(keys)}.")


def _options(source, names, defaults):
    """Options for parameters of a function or dataclass, explained by its docstring."""
    entries = re.findall(r"^(\w[\w, ]*)(?: : .*)?\n((?: {4}.+\n?)+)", getdoc(source) or "", re.M)
    texts = HELP | {name: text for listed, text in entries for name in listed.split(", ")} | PLAIN
    known = signature(source, eval_str=True).parameters
    return [_option(known[name], texts.get(name, ""), defaults) for name in names]


def _option(parameter, text, defaults=False):
    """Typer's parameter: None unless given; its help is the first sentence of a text."""
    text = re.split(r"(?<=\.) (?=[A-Z])", " ".join(text.split()))[0]
    text = re.sub(r"`+|study\.[\w.]+\.", "", text)
    name, default, kind = parameter.name, parameter.default, parameter.annotation
    if get_origin(kind) in (Union, UnionType):
        kind = get_args(kind)[0]
    if name == "model":
        kind = Literal[kind, "auto"]
    elif name == "law" and kind is str:  # or a function
        kind = LawName
    elif get_origin(kind) is list and get_origin(*get_args(kind)) is Literal:
        text += f" One of {', '.join(get_args(*get_args(kind)))}."
        kind = list[str]  # as Typer knows no list of them; the library checks
    elif get_origin(kind) is tuple:
        kind, text = str, f"N,N: {text}"
    if defaults and default not in (Parameter.empty, None, False):
        text += f" [default: {default}]"
    of_one = kind
    if get_origin(kind) is list:
        (of_one,) = get_args(kind)
    made = typer.Option(flag(name), help=text, metavar=METAVARS.get(of_one))
    if name in ARGUMENTS:
        made = typer.Argument(help=text, metavar=ARGUMENTS[name])
    if default is not Parameter.empty:
        kind, default = kind | None, None
    hint = Annotated[kind, made]
    return Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=hint)


def flag(name):
    """Option of a parameter, as it is typed."""
    return FLAGS.get(name, f"--{name.replace('_', '-')}")


def left_out(names, given, why):
    """Refuse options that mean nothing here."""
    for name in names:
        if name in given:
            raise ValueError(f"{flag(name)} must be left out: {why}")


def check_output(output, suffix):
    """Refuse a file that has another suffix or cannot be written, before the work."""
    if output is None:
        return
    if output.suffix != suffix:
        raise ValueError(f"--output must end in {suffix}, got {output}")
    if not output.parent.is_dir() or not os.access(output.parent, os.W_OK | os.X_OK):
        raise ValueError(f"--output must be in a folder that can be written to, got {output}")
    if output.is_dir():
        raise ValueError(f"--output must be a file, got the folder {output}")
