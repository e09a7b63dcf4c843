"""The program, options that several commands share, and how a function becomes a command."""

import os
from functools import partial
from inspect import Parameter, Signature, getdoc, signature
from pathlib import Path
from typing import Literal, get_args, get_type_hints

import typer

from study import checks, paths
from study.checks import StudyError

app = typer.Typer(
    help="Contact force laws for spherical clearance joints: rebuild, inspect, evaluate.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
data_app = typer.Typer(help="The cached force-depth curves.", no_args_is_help=True)
app.add_typer(data_app, name="data")

INTERRUPTED = 130  # typer's status after Ctrl-C
KEPT = "; what was finished is kept"
NEEDED = ...  # the default of an option that must be given


METAVARS = {float: "NUMBER", int: "COUNT", str: "TEXT", Path: "FILE"}
"""What the help shows for the value of an option, by its type."""


def option(text, *flags, default=None):
    """Option with its help. Without a default it is None, or absent from a class of options."""
    return typer.Option(default, *flags, help=text)


Rim = Literal["mirror", "free"]
Kinematics = Literal["small", "linear", "finite"]
JSON = option("Print one JSON object.", "--json", default=False)
OUTPUT = option("File to write.")
JOBS = option("Processes, by default one per core.")
NAMES = typer.Argument((), help="Figures, tables or notebooks; default all.", metavar="NAME")
R2_STAR = "Radius of the socket in clearances, R2/dR, > 1."
DEPTHS = "Penetration depth in clearances, d/dR; may be repeated."
WALL = option(
    "Thickness of the socket beyond its inner radius, liners included, in m; its outside is held "
    "rigidly."
)
LINER = option(
    "Thickness in m and material of a liner inside the socket, 0.5e-3,PTFE; may be repeated, from "
    "the inside out."
)
RIM = option(
    "Edge of the socket: a mirror plane, or free of traction. [default: mirror for a hemispherical "
    "socket, fixed all over its outside, half a ball and a load along the axis; else free]"
)


class MaterialOptions:
    """Ball and socket, each of one material, without dimensions."""

    socket_ratio: float = option("Outer over inner radius of the socket. [default: 1.298]")
    modulus_ratio: float = option(
        "Young's modulus of the socket over that of the ball. [default: 1.0]"
    )
    poisson: float = option(
        "Poisson's ratio of the ball, and of the socket unless it differs (no unit). [default: 0.3]"
    )
    socket_poisson: float = option("Poisson's ratio of the socket, if it differs (no unit).")


class JointOptions(MaterialOptions):
    """A joint without dimensions."""

    layer: list[str] = option(
        "Outer radius over R2, Young's modulus over the ball's and Poisson's ratio of a layer of "
        "the socket: N,N,N; may be repeated, from the inside out."
    )
    ball_drive: str = option(
        "Equatorial plane of the half ball: moved along the axis and radially free (plane), "
        "clamped to a rigid plate (clamped), or moved at its centre alone (point). A whole ball: "
        "held at a rigid core of 0.2 of its radius (core:0.2), or on its surface within 30 deg of "
        "the top (neck:30). [default: plane]",
        "--drive",
    )
    rim: Rim = RIM
    opening: float = option(
        "Polar angle of the socket's mouth from its pole, in deg, 30 to 170. [default: 90.0]"
    )
    backing: str = option(
        "Where the socket is held: its outside all over (whole), the face of its rim alone (rim), "
        "or its outside between two polar angles in deg (0,30: a seat; 60,90: a flange). "
        "[default: whole]"
    )
    kinematics: Kinematics = option(
        "Which points of the surfaces face each other. small: those at equal angles from the "
        "socket's centre; linear: those that the ball's points have moved to, as in a small-strain "
        "analysis with contact on moved surfaces; finite: large displacements. [default: linear]"
    )


class InterruptionError(Exception):
    """Ctrl-C in a command; says what is kept, if anything."""


def command(name, group=app, keeps=False):
    """Decorate a function as a command; its parameters are the command's options.

    The annotation of ``**`` is a class of further options. The function gets those that are given.
    A command that ``keeps`` finished work when it is interrupted does so unless --output is given.
    """

    def decorate(function):
        own = signature(function).parameters

        def call(**values):
            values = {k: v for k, v in values.items() if k in own or v is not None}
            try:
                return function(**values)
            except KeyboardInterrupt:
                kept = KEPT if keeps and values.get("output") is None else ""
                raise InterruptionError(kept) from None
            except ModuleNotFoundError as error:
                if error.name.startswith("study"):
                    raise
                package = "." if paths.IS_CHECKOUT else "spherical-clearance-joint-study"
                raise StudyError(
                    f"study {'data ' * (group is data_app)}{name} needs {error.name}, of the extra "
                    f"[study]: pip install '{package}[study]'"
                ) from None

        call.__signature__ = Signature(list(_parameters(own.values())))
        text = getdoc(function)
        summary = " ".join(text.split("\n\n")[0].split())
        group.command(name, help=text, short_help=summary)(call)
        return function

    return decorate


def _parameters(own):
    """Parameters of a function, and those of the class that annotates its ``**``."""
    for parameter in own:
        if parameter.kind is parameter.VAR_KEYWORD:
            further = parameter.annotation
            yield from _parameters(
                Parameter(k, Parameter.KEYWORD_ONLY, annotation=v, default=getattr(further, k))
                for k, v in get_type_hints(further).items()
            )
        else:
            kind, *_ = *get_args(parameter.annotation), parameter.annotation  # that of a list
            parameter.default.metavar = parameter.default.metavar or METAVARS.get(kind)
            if kind in (float, int):
                parameter.default.parser = partial(_number, kind)
            yield parameter


def _number(kind, text):
    """Value of an option that is a number; a default is one already."""
    try:
        return checks.read("it", text, kind) if isinstance(text, str) else text
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


def flag(name):
    """Option of a parameter, as it is typed."""
    return "--drive" if name == "ball_drive" else f"--{name.replace('_', '-')}"


def left_out(options, allowed, why):
    """Refuse options that mean nothing here: all but those allowed."""
    for name in options:
        if name not in allowed:
            raise ValueError(f"{flag(name)} must be left out: {why}")


def under_tilt(tilt, options):
    """Options of a joint; beside a tilt the socket's edge is free unless it is given."""
    return options if tilt is None else {"rim": "free"} | options


def check_output(output, *suffixes, name="output"):
    """Refuse a file that has another suffix or cannot be written, before the work."""
    if output is None:
        return
    if output.suffix not in suffixes:
        raise ValueError(f"{flag(name)} must end in {' or '.join(suffixes)}, got {output}")
    if not output.parent.is_dir() or not os.access(output.parent, os.W_OK | os.X_OK):
        raise ValueError(f"{flag(name)} must be in a folder that can be written to, got {output}")
    if output.is_dir():
        raise ValueError(f"{flag(name)} must be a file, got the folder {output}")
