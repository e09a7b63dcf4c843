"""Options of the commands, made from the descriptions of parameters, and the class of a command."""

import re
import shlex
import sys
from pathlib import Path

import click

from study import checks, paths
from study.contact import LAWS
from study.parameters import default_of, described

KEPT = "; what was finished is kept"
METAVARS = {float: "NUMBER", int: "COUNT", str: "TEXT", Path: "FILE"}
"""What the help shows for the value of an option, by its type."""
LONGEST = 60  # characters of a list of choices that the help shows in its place


class InterruptionError(click.Abort):
    """Ctrl-C in a command; the message says what is kept, if anything."""


class Number(click.ParamType):
    """A number, which may be followed by its unit with an SI prefix."""

    name = "number"

    def __init__(self, kind=float, unit=""):
        self.kind, self.unit = kind, unit

    def convert(self, value, param, ctx):
        """Number of a text; a default is a number already."""
        return (
            checks.read(param.opts[0], value, self.kind, self.unit) if type(value) is str else value
        )


def flag(name):
    """Option of a parameter, as it is typed."""
    return f"--{name.replace('_', '-')}"


def option(flags, text, kind=str, unit="", **more):
    """Option with its help; ``kind`` is a type or a tuple of words. Without a value it is None."""
    if isinstance(kind, tuple):
        is_long = len("|".join(kind)) > LONGEST
        more = {"type": click.Choice(kind), "metavar": "NAME" if is_long else None} | more
    else:
        types = {str: str, Path: click.Path(path_type=Path)}
        more = {"type": types.get(kind) or Number(kind, unit), "metavar": METAVARS[kind]} | more
    return click.Option(flags.split(), help=text, **more)


def switch(flags, text):
    """Option without a value, which is off by default."""
    return click.Option(flags.split(), is_flag=True, help=text)


def option_of(name, about, note="", **more):
    """Option of a `study.parameters.Parameter`; a note is a further sentence."""
    limits = "" if about.choices else about.range
    details = ", ".join(filter(None, [about.unit and f"in {about.unit}", limits]))
    text = f"{about.meaning} ({details})." if details else f"{about.meaning}."
    kind = about.choices or (str if about.several == "," else about.typed)
    more = {"multiple": about.several == ";"} | more
    return option(flag(name), f"{text} {note}".rstrip(), kind, about.unit, **more)


def options_of(owner, *names):
    """Options of a class's or function's parameters (`study.parameters`), all or some of them."""
    every = described(owner)
    defaults = {name: default_of(owner, name) for name in names or every}
    return [
        option_of(name, every[name], default and f"Default: {default}.")
        for name, default in defaults.items()
    ]


LAW_NUMBER = option(
    "--option",
    "A number of the law, as KEY=VALUE, for example n=2 of steuermann or coefficient=900 of "
    "winkler; may be repeated. study law --help has them all.",
    multiple=True,
)
JSON = switch("--json as_json", "Print the results as one JSON object.")
UNITS = option(
    "--units", "Units of the results: SI, or mm, N, MPa and s. Default: SI.", ("SI", "mm")
)
OUTPUT = option("--output", "File to write.", Path)
JOBS = option("--jobs", "Number of processes. Default: one for each core.", int)
DEPTHS = option(
    "--depth-star",
    "Normalised penetration depth d/dR, relative to the clearance; may be repeated.",
    float,
    multiple=True,
)


def argument(name, text, metavar, kind=str, many=False, required=True, **more):
    """Argument of a command, with its help."""
    types = {"type": click.Path(path_type=Path) if kind is Path else kind}
    return click.Argument(
        [name],
        metavar=metavar,
        nargs=-1 if many else 1,
        required=required,
        help=text,
        **types | more,
    )


NAMES = argument(
    "names",
    "Name of a figure, a table or a notebook; several may be given. Default: all.",
    "[NAME]",
    many=True,
    required=False,
)
SNAKEMAKE = argument(
    "names", "Words for Snakemake, after --.", "[-- SNAKEMAKE]", many=True, required=False
)


def _of_joint(owner, names):
    """Options of a joint by its sections in the help of study joint."""
    defaults = {name: default_of(owner, name) for name in described(owner)}
    for name, about in names.items():
        default = defaults.get("layers" if name == "layer" else name)
        note = f"Default: {default}." if default and name != "r2_star" else ""  # which is needed
        yield option_of(name, about, note)


def joint_sections():
    """Options that describe a joint, by their headings in the help of study joint."""
    from study.joint import Joint  # late: commands without a joint do not load SciPy
    from study.joint.joint import SUPPORTS
    from study.joint.options import DIMENSIONS, PARAMETERS, RATIOS

    supports = {name: PARAMETERS[name] for name in SUPPORTS}
    return {
        "Joint with dimensions": [*_of_joint(Joint, DIMENSIONS)],
        "Joint without dimensions": [*_of_joint(Joint.from_ratios, RATIOS)],
        "Supports and contact kinematics": [*_of_joint(Joint, supports)],
    }


SAVED = option(
    "--joint",
    "Joint that study joint --save wrote. The options of study joint that describe a joint, such "
    "as --socket-radius, can be given here too, instead of this file or to change it.",
    Path,
)


class Command(click.Command):
    """A command whose help lists its options below headings, and whose errors name options.

    A command that ``keeps`` finished work when it is interrupted does so unless --output is given.
    ``hidden`` options are explained by study joint --help.
    """

    def __init__(self, function, name, sections, arguments, hidden, examples, keeps):
        shown = "\n".join(f"  study {example}" for example in examples)
        title = "Example:" if len(examples) == 1 else "Examples:"
        text = function.__doc__
        listed = [of for options in sections.values() for of in options]
        super().__init__(
            name.rpartition(" ")[2],
            params=[*arguments, *listed, *hidden],
            callback=function,
            help=text,
            epilog=f"\b\n{title}\n{shown}",
        )
        self.path, self.sections, self.arguments = name, sections, arguments
        self.keeps, self.examples = keeps, examples

    def format_options(self, ctx, formatter):
        """Write the options below their headings."""
        sections = {
            heading: [of.get_help_record(ctx) for of in options]
            for heading, options in self.sections.items()
        }
        *_, last = sections
        sections[last].append(self.get_help_option(ctx).get_help_record(ctx))
        for heading, records in sections.items():
            if records:
                with formatter.section(heading):
                    formatter.write_dl(records)

    def invoke(self, ctx):
        """Call the function with the options that are given."""
        switches = {of.name for of in self.params if getattr(of, "is_flag", False)}
        given = {n: v for n, v in ctx.params.items() if n in switches or v not in (None, ())}
        try:
            return self.callback(**given)
        except KeyboardInterrupt:
            kept = KEPT if self.keeps and "output" not in given else ""
            raise InterruptionError(kept) from None
        except ValueError as error:
            raise click.UsageError(self._in_options(str(error))) from None
        except ModuleNotFoundError as error:
            if error.name.startswith("study"):
                raise
            package = "." if paths.IS_CHECKOUT else "spherical-clearance-joint-study"
            raise checks.StudyError(
                f"study {self.path} needs the package {error.name}; install it with: pip install "
                f"'{package}[study]'"
            ) from None

    def _in_options(self, text):
        """A message with the options that were typed in place of the names of parameters.

        A name of one word, such as wall, is a parameter only where the message begins.
        """
        names = {of.name: of.opts[0] for of in self.params if isinstance(of, click.Option)}
        known = "|".join(sorted(map(re.escape, names), key=len, reverse=True))
        begin = rf"^(.* of )?({known})((, | and | or )({known}))*(?= (must|does|do|is for)\b)"
        several = "|".join(name for name in names if "_" in name) or "^$"
        for place in (begin, rf"\b({several})\b(?!=)"):
            text = re.sub(
                place,
                lambda part: re.sub(rf"(?<!-)\b({known})\b", lambda of: names[of[0]], part[0]),
                text,
            )
        return text


def command(name, sections, examples, arguments=(), joint=False, keeps=False):
    """Decorate a function as a command with options by heading; with those of a joint, hidden."""
    hidden = []
    if joint:
        hidden = [of for options in joint_sections().values() for of in options]
        shown = {of.name for options in sections.values() for of in options}
        hidden = [of for of in hidden if of.name not in shown]
        sections = {"Joint": [SAVED], **sections}

    def decorate(function):
        return Command(function, name, sections, arguments, hidden, examples, keeps)

    return decorate


def choice(words):
    """Type of an argument that is one of some words."""
    return click.Choice(tuple(words))


def take_joint(options, *, off_axis=False, required=True):
    """Joint of the options that describe one, which are removed; None if there are none."""
    from study.joint.options import joint_of

    values, words = take_values(options)
    if not values and not required:
        return None, words
    return joint_of(values, off_axis=off_axis), words


def take_values(options):
    """Values of a joint among options, which are removed, and the words that give them again."""
    from study.joint import options as of_joint

    given = {name: options.pop(name) for name in of_joint.PARAMETERS if name in options}
    words = typed(given)
    if (saved := options.pop("joint", None)) is not None:
        given = of_joint.merged(of_joint.load(saved), given)
        words = f"{typed({'joint': saved})} {words}".rstrip()
    return given, words


def typed(options):
    """Options as they are typed on the command line."""
    words = []
    for name, value in options.items():
        for one in value if isinstance(value, list | tuple) else [value]:
            text = f"{one:.9g}" if isinstance(one, float) else str(one)
            words += [flag(name), shlex.quote(text)]
    return " ".join(words)


def after_dashes(words):
    """Words after ``--``, which are for Snakemake; no others are allowed."""
    more = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if len(words) > len(more):
        raise ValueError(f"no name can be given here, got {words[0]!r}; remove it")
    return more


def left_out(options, allowed, what):
    """Raise ``ValueError`` for an option that does not apply to something: any not allowed."""
    for name in options:
        if name not in allowed:
            raise ValueError(f"{name} does not apply to {what}; remove it")


def key_values(name, texts, known):
    """Values of ``KEY=VALUE`` by key, read by the `study.parameters.Parameter` of each key."""
    values = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or key not in known:
            names = ", ".join(known) or "nothing, as this law has no numbers to choose"
            raise ValueError(f"{name} must be KEY=VALUE with KEY one of {names}, got {text!r}")
        values[key] = known[key].read(key, value)
    return values


def law_of(name, settings=()):
    """Law with the numbers of ``KEY=VALUE``, or its name without any."""
    if not settings:
        return name
    about = described(LAWS[name])
    return LAWS[name](**key_values(f"--option of the law {name}", settings, about))
