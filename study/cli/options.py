"""The program, options that several commands share, and how a function becomes a command.

A command's module is loaded when the command is called: `COMMANDS` has the modules, and the
sentences that ``study --help`` shows.
"""

import os
import sys
from copy import copy
from functools import partial
from importlib import import_module
from inspect import Parameter, Signature, getdoc, signature
from pathlib import Path
from typing import Literal, get_args

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command_from_info

from study import checks, parameters, paths
from study.checks import StudyError
from study.contact import LAWS

COMMANDS = {
    "run": (
        "build",
        "Run the outdated notebooks and compare their results with the accepted ones.",
    ),
    "accept": ("build", "Accept results that differ: copy them to figures/."),
    "paper": ("build", "Bring the article and its supplement up to date."),
    "report": ("build", "Bring figures, tables, article and report up to date."),
    "list": ("build", "List the figures and tables of the notebooks."),
    "data": ("stored", "Show, check or rebuild the dataset of solved force-depth curves."),
    "measure": ("stored", "Measure the speed of laws, solvers and steppers on this machine."),
    "joint": ("solve_joint", "Solve one joint: force, depth, stiffness, pressure and stresses."),
    "law": ("evaluate_law", "Evaluate a contact law at given penetration depths."),
    "choose": ("laws", "Choose the fastest contact law that is accurate enough for a joint."),
    "fit": ("fit", "Compare the contact laws with your own curve, and fit unknown parameters."),
    "export": ("laws", "Export the contact law of one joint for use in another program."),
    "simulate": ("mechanism", "Simulate the crank-slider and list the impacts in its joint."),
    "sweep": ("sweep", "Solve many joints, or simulate many mechanisms, and write one table."),
}
"""Command -> its module, and a sentence on what it does."""
SECTIONS = {
    "Joint with dimensions (SI units)": (
        "socket_radius",
        "clearance",
        "wall",
        "ball",
        "socket",
        "liner",
    ),
    "Joint without dimensions": (
        "r2_star",
        "socket_ratio",
        "modulus_ratio",
        "poisson",
        "socket_poisson",
        "layer",
    ),
    "Supports and contact model": (
        "ball_support",
        "socket_support",
        "opening",
        "rim",
        "kinematics",
        "solver",
        "resolution",
    ),
}
"""Headings in the help of commands that take a joint, and the options below each."""


class _Command(TyperCommand):
    """A command whose help lists its options in sections, by their ``rich_help_panel``.

    Typer itself shows these sections only as panels with frames, in which a narrow column is left
    for the explanations.
    """

    def format_options(self, ctx, formatter):
        sections = {}
        for parameter in self.get_params(ctx):  # the last one is --help
            is_argument = parameter.param_type_name == "argument"
            *_, last = "Options", *(heading for heading in sections if heading != "Arguments")
            heading = "Arguments" if is_argument else parameter.rich_help_panel or last
            shown, text = parameter.get_help_record(ctx)
            record = parameter.metavar if is_argument else shown, text  # its type is in the text
            sections.setdefault(heading, []).append(record)
        for heading, records in sections.items():
            with formatter.section(heading):
                formatter.write_dl(records)


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
    help="Contact force laws for spherical clearance joints: solve a joint, choose and export a "
    "law, simulate a mechanism, and rebuild the results of the study.",
    epilog="Help on one command, with its options and an example: study joint --help",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
data_app = typer.Typer(
    help="Show, check or rebuild the dataset of solved force-depth curves.",
    no_args_is_help=True,
    rich_markup_mode=None,
)

INTERRUPTED = 130  # typer's status after Ctrl-C
KEPT = "; what was finished is kept"
METAVARS = {float: "NUMBER", int: "COUNT", str: "TEXT", Path: "FILE"}
"""What the help shows for the value of an option, by its type."""
LONGEST = 60  # characters of a list of choices that the help shows in its place


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
        options[name] = option_of(every[name], default and f"Default: {default}.")
    return options


def option_of(about, note=""):
    """Type and option of a `study.parameters.Parameter`; a note is a further sentence."""
    kind = Literal[about.choices] if about.choices else about.typed
    kind = {",": str, ";": list[kind]}.get(about.several, kind)
    limits = "" if about.choices else about.range
    details = ", ".join(filter(None, [about.unit and f"in {about.unit}", limits]))
    text = f"{about.meaning} ({details})." if details else f"{about.meaning}."
    return further(kind, f"{text} {note}".rstrip())


OPTION = option(
    "A number of the law, as NAME=VALUE, for example n=2 of steuermann or coefficient=900 of "
    "winkler; may be repeated. study law --help has them all.",
    default=(),
)
JSON = switch("--json", "Print the results as one JSON object.")
OUTPUT = option("File to write.")
JOBS = option("Number of processes. Default: one for each core.")
NAMES, NAMED = (
    typer.Argument(
        default,
        help="Name of a figure, a table or a notebook; several may be given." + note,
        metavar="NAME",
    )
    for default, note in (((), " Default: all."), (..., ""))
)
FILES = typer.Argument(..., help="Data file; several may be given.", metavar="FILE")
SNAKEMAKE = typer.Argument((), help="Words for Snakemake, after --.", metavar="[-- SNAKEMAKE]")
DEPTHS = "Normalised penetration depth d/dR, relative to the clearance; may be repeated."


class InterruptionError(Exception):
    """Ctrl-C in a command; the message says what is kept, if anything."""


def command(name, group=app, keeps=False, sections=None, examples=()):
    """Decorate a function as a command; its parameters are the command's options.

    The annotation of ``**`` is a mapping of `further` options by name; the function gets those that
    are given. A command that ``keeps`` finished work when it is interrupted does so unless --output
    is given. The help shows the options in ``sections``, a mapping of headings to the options below
    each, and ends with the ``examples``, which are commands without the program's name.
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
                    f"study {'data ' * (group is data_app)}{name} needs the package {error.name}; "
                    f"install it with: pip install '{package}[study]'"
                ) from None

        headings = {of: heading for heading, names in (sections or {}).items() for of in names}
        rank = {option: number for number, option in enumerate(headings)}
        listed = _parameters(own.values(), headings)
        call.__signature__ = Signature(sorted(listed, key=lambda of: rank.get(of.name, -1)))
        text = getdoc(function)
        summary = " ".join(text.split("\n\n")[0].split())
        shown = "\n".join(f"  study {example}" for example in examples)
        title = "Example:" if len(examples) == 1 else "Examples:"
        group.command(
            name,
            cls=_Command,
            help=text,
            short_help=summary,
            epilog=f"\b\n{title}\n{shown}" if examples else None,
        )(call)
        return function

    return decorate


def _parameters(own, headings):
    """Keyword parameters of a function, and those of the options that annotate its ``**``.

    An option that several commands share is copied, as its heading differs between them.
    """
    for parameter in own:
        if parameter.kind is parameter.VAR_KEYWORD:
            yield from _parameters(
                (
                    Parameter(name, Parameter.KEYWORD_ONLY, annotation=kind, default=default)
                    for name, (kind, default) in parameter.annotation.items()
                ),
                headings,
            )
        else:
            parameter = parameter.replace(
                default=copy(parameter.default), kind=Parameter.KEYWORD_ONLY
            )
            parameter.default.rich_help_panel = headings.get(parameter.name)
            kind, *_ = *get_args(parameter.annotation), parameter.annotation  # that of a list
            is_long = len("|".join(map(str, get_args(parameter.annotation)))) > LONGEST
            metavar = "NAME" if is_long else METAVARS.get(kind)
            parameter.default.metavar = parameter.default.metavar or metavar
            if kind in (float, int):
                parameter.default.parser = partial(_number, kind)
            yield parameter


def _number(kind, text):
    """Value of an option that is a number; a default is one already."""
    try:
        return checks.read("the value", text, kind) if isinstance(text, str) else text
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


def after_dashes(words):
    """Words after ``--``, which are for Snakemake; no others are allowed."""
    more = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if len(words) > len(more):
        raise ValueError(f"no name can be given here, got {words[0]!r}; remove it")
    return more


def flag(name):
    """Option of a parameter, as it is typed."""
    return f"--{name.replace('_', '-')}"


def left_out(options, allowed, what):
    """Raise ``ValueError`` for an option that does not apply to something: any not allowed."""
    for name in options:
        if name not in allowed:
            raise ValueError(f"{flag(name)} does not apply to {what}; remove it")


def law_of(name, settings):
    """Law with the numbers of ``NAME=VALUE``, or its name without any."""
    if not settings:
        return name
    about, values = parameters.described(LAWS[name]), {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals or key not in about:
            known = ", ".join(about) or "nothing, as this law has no numbers to choose"
            raise ValueError(
                f"--option of the law {name} must be NAME=VALUE with NAME one of {known}, got "
                f"{setting!r}"
            )
        values[key] = about[key].read(key, text)
    return LAWS[name](**values)


def under_tilt(tilt, options):
    """Options of a joint; with a tilt the rim of the socket is free by default."""
    return options if tilt is None else {"rim": "free"} | options


def check_output(output, *suffixes, name="output"):
    """Raise ``ValueError`` before the work if a file cannot be written or has another suffix."""
    if output is None:
        return
    if output.suffix not in suffixes:
        raise ValueError(f"{flag(name)} must end in {' or '.join(suffixes)}, got {output}")
    if not output.parent.is_dir() or not os.access(output.parent, os.W_OK | os.X_OK):
        raise ValueError(
            f"{flag(name)} must be in an existing folder with write permission, got {output}"
        )
    if output.is_dir():
        raise ValueError(f"{flag(name)} must be a file, got the folder {output}")
