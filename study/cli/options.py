"""The program, options that several commands share, and how a function becomes a command.

A command's module is loaded when the command is called: `COMMANDS` has the modules, and the
sentences that ``study --help`` shows.
"""

import os
from functools import partial
from importlib import import_module
from inspect import Parameter, Signature, getdoc, signature
from pathlib import Path
from typing import Literal, get_args

import typer
from typer.core import TyperGroup
from typer.main import get_command_from_info

from study import checks, parameters, paths
from study.checks import StudyError

COMMANDS = {
    "run": ("build", "Run outdated notebooks and compare their figures and tables."),
    "paper": ("build", "Typeset build/paper.pdf and build/supplement.pdf from the results."),
    "report": ("build", "Bring everything up to date: figures, tables, paper and report."),
    "list": ("build", "List every figure and table by notebook: what it shows."),
    "data": ("stored", "The cached force-depth curves."),
    "measure": ("stored", "Time laws, solvers and steppers on this machine."),
    "joint": ("solve_joint", "Solve one joint: force, depth, stiffness, pressure and stresses."),
    "law": ("evaluate_law", "Evaluate a contact law."),
    "choose": ("laws", "Choose the cheapest law that is accurate enough for a joint."),
    "fit": ("fit", "Compare every law with a curve of your own, and fit what is not known."),
    "export": ("laws", "Export a law, for one joint, to another program."),
    "simulate": ("mechanism", "Simulate the crank-slider: its motion and every impact."),
    "sweep": ("sweep", "Solve many joints, or simulate many scenes, into one table."),
}
"""Command -> its module, and what it does."""


class _LazyGroup(TyperGroup):
    """The program, which loads the module of a command when it is needed."""

    def list_commands(self, ctx):
        return list(COMMANDS)

    def get_command(self, ctx, name):
        if name not in COMMANDS:
            return None
        import_module(f"study.cli.{COMMANDS[name][0]}")
        if name == "data":
            return typer.main.get_group(data_app)
        (info,) = (info for info in app.registered_commands if info.name == name)
        return get_command_from_info(info, pretty_exceptions_short=True, rich_markup_mode=None)

    def format_commands(self, ctx, formatter):
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


app = typer.Typer(
    cls=_LazyGroup,
    help="Contact force laws for spherical clearance joints: rebuild, inspect, evaluate.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
data_app = typer.Typer(help="The cached force-depth curves.", no_args_is_help=True)

INTERRUPTED = 130  # typer's status after Ctrl-C
KEPT = "; what was finished is kept"
METAVARS = {float: "NUMBER", int: "COUNT", str: "TEXT", Path: "FILE"}
"""What the help shows for the value of an option, by its type."""


def option(text, *flags, default=None):
    """Option with its help. Without a default it is None, or absent from a command's ``**``."""
    return typer.Option(default, *flags, help=text)


def required(text, *flags):
    """Option that must be given."""
    return option(text, *flags, default=...)


def switch(flag, text):
    """Option without a value, which is off by default."""
    return option(text, flag, default=False)


def further(kind, text):
    """Type and option of a parameter among a command's ``**``."""
    return kind, option(text)


def options_of(owner, *names):
    """Options of a class's or function's parameters (`study.parameters`), all or some of them."""
    every, options = parameters.described(owner), {}
    for name in names or every:
        default = parameters.default_of(owner, name)
        options[name] = option_of(every[name], default and f"default: {default}")
    return options


def option_of(about, note=""):
    """Type and option of a `study.parameters.Parameter`, with a note in brackets."""
    kind = Literal[about.choices] if about.choices else about.typed
    kind = {",": str, ";": list[kind]}.get(about.several, kind)
    limits = "" if about.choices else about.range
    text = ", ".join(filter(None, [about.meaning, about.unit and f"in {about.unit}", limits]))
    return further(kind, f"{text}. [{note}]" if note else f"{text}.")


JSON = switch("--json", "Print one JSON object.")
OUTPUT = option("File to write.")
JOBS = option("Processes, by default one per core.")
NAMES = typer.Argument((), help="Figures, tables or notebooks; default all.", metavar="NAME")
DEPTHS = "Penetration depth in clearances, d/dR; may be repeated."


class InterruptionError(Exception):
    """Ctrl-C in a command; says what is kept, if anything."""


def command(name, group=app, keeps=False):
    """Decorate a function as a command; its parameters are the command's options.

    The annotation of ``**`` is a mapping of `further` options by name; the function gets those that
    are given. A command that ``keeps`` finished work when it is interrupted does so unless --output
    is given.
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
    """Parameters of a function, and those of the options that annotate its ``**``."""
    for parameter in own:
        if parameter.kind is parameter.VAR_KEYWORD:
            yield from _parameters(
                Parameter(name, Parameter.KEYWORD_ONLY, annotation=kind, default=default)
                for name, (kind, default) in parameter.annotation.items()
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
    return f"--{name.replace('_', '-')}"


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
