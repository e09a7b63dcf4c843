"""The command line, study: notebooks, paper, report, dataset, laws, joints and simulations.

An option that is a parameter of the library has type, default and help from there (`command`).
A user's mistake is one line on standard error and exit status 2; a failure is exit status 1.
"""

import json
import math
import os
import re
import sys
from dataclasses import fields
from functools import partial
from inspect import Parameter, Signature, getdoc, signature
from pathlib import Path
from pkgutil import resolve_name
from types import UnionType
from typing import Annotated, Literal, Union, get_args, get_origin

import typer

from study import checks, paths
from study.contact import LAWS, LawName

STYLE = {"add_completion": False, "rich_markup_mode": None, "pretty_exceptions_enable": False}
app = typer.Typer(
    help="Contact force laws for spherical clearance joints: rebuild, inspect, evaluate.",
    no_args_is_help=True,
    **STYLE,
)
data_app = typer.Typer(help="The cached force-depth curves.", no_args_is_help=True)
app.add_typer(data_app, name="data")

SHOWN = 20  # impacts in a printed table
INTERRUPTED = 130  # typer's status after Ctrl-C
UsageError = typer.BadParameter.__base__  # of every wrong option or argument
FLAGS = {"ball_drive": "--drive", "form": "--format", "dask_address": "--dask"}
FLAGS |= {"as_json": "--json", "settings": "-p"}
ARGUMENTS = {"name": "NAME", "names": "[NAME]..."}
HELP = {
    "as_json": "Print one JSON object.",
    "case": "One case, every depth of it.",
    "depth_star": "Dimensionless penetration depth d/dR; may be repeated.",
    "group": "Group of cases: paper, ratio, poisson, fit, judge, ...",
    "inertia": "Of crank and coupler about their centres, in kg m^2: I1,I2 [default: rods].",
    "keep": "Take what differs as the kept results from now on.",
    "layer": "Outer radius over R2, Young's modulus over the ball's and Poisson's ratio of a layer "
    "of the socket: N,N,N; may be repeated, from the inside out.",
    "model": "Links; auto: as little as it needs.",
    "modulus_ratio": "Young's modulus of the socket over that of the ball, > 0 [default: 1.0].",
    "name": f"One of {', '.join(LAWS)}.",
    "names": "Figures, tables or notebooks; default all.",
    "output": "File to write.",
    "poisson": "Poisson's ratio of both bodies, in (-1, 0.5).",
    "r2_star": "Dimensionless socket radius R2/dR, > 1.",
    "scene": "KEY=VALUE of the scene, SI; may be repeated: restitution=0.9, link_modulus=2e9.",
    "settings": "KEY=VALUE of a notebook's parameter; may be repeated.",
    "socket_ratio": "Outer over inner radius of the socket.",
    "socket_poisson": "Poisson's ratio of the socket, if not that of the ball.",
    "yield_stress": "Yield stress of ball and socket in Pa, where the ball's modulus is 2e11 Pa.",
}
"""Of what the library's docstrings do not explain."""
MATERIALS = ("study.joint:Material poisson", "study.cli:_joint modulus_ratio socket_poisson layer")
JOINT = ("study.joint:Joint socket_ratio ball_drive rim kinematics", *MATERIALS)


def main():
    """Run the command line and exit with its status."""
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="replace")  # a line of "?" is better than none
    try:
        status = app(standalone_mode=False)
    except (UsageError, ValueError) as error:
        text = error.format_message() if isinstance(error, UsageError) else str(error)
        if text.startswith("Usage:"):  # a command group alone: its help is the answer
            print(text, file=sys.stderr)
            sys.exit(2)
        _complain(text, 2)
    except (checks.StudyError, OSError) as error:
        _complain(str(error), 1)
    if status == INTERRUPTED:
        _complain("interrupted; what was finished is kept", status)
    sys.exit(status or 0)


def _complain(text, status):
    print(f"study: {' '.join(text.split())}", file=sys.stderr)
    sys.exit(status)


def command(name, *library, group=app, defaults=True):
    """Decorate a function as a command: its annotated parameters become options.

    So do parameters of the library, as "module:function parameter parameter ...". Those that are
    given reach the function. They are looked up as the command is called, so that ``study
    --help`` imports no room.
    """

    def decorate(function):
        def call(**given):
            return function(**{key: value for key, value in given.items() if value is not None})

        class Command(typer.core.TyperCommand):
            def make_context(self, *args, **more):
                own = signature(function).parameters.values()
                given = [_option(p, HELP[p.name]) for p in own if p.annotation is not p.empty]
                for entry in library:
                    source, *names = entry.split()
                    given += _options(resolve_name(source), names, defaults)
                call.__signature__ = Signature(given)
                one = typer.Typer(**STYLE)
                one.command(help=getdoc(function))(call)
                return typer.main.get_command(one).make_context(*args, **more)

        group.command(name, cls=Command, help=getdoc(function))(lambda: None)
        return function

    return decorate


def _options(source, names, defaults):
    """Options for parameters of a function or dataclass, explained by its docstring."""
    entries = re.findall(r"^(\w[\w, ]*)(?: : .*)?\n((?: {4}.+\n?)+)", getdoc(source) or "", re.M)
    texts = HELP | {name: text for listed, text in entries for name in listed.split(", ")}
    known = signature(source, eval_str=True).parameters
    return [_option(known[name], texts.get(name, ""), defaults) for name in names]


def _option(parameter, text, defaults=False):
    """Typer's parameter: None unless given, with the first sentence of a text for its help."""
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
    made = typer.Option(FLAGS.get(name, f"--{name.replace('_', '-')}"), help=text)
    if name in ARGUMENTS:
        made = typer.Argument(help=text, metavar=ARGUMENTS[name])
    if default is not Parameter.empty:
        kind, default = kind | None, None
    hint = Annotated[kind, made]
    return Parameter(name, Parameter.KEYWORD_ONLY, default=default, annotation=hint)


def _left_out(names, given, why):
    """Refuse what was given though it means nothing here."""
    for name in names:
        if name in given:
            raise ValueError(f"--{name.replace('_', '-')} must be left out: {why}")


@command("run", "study.pages.tasks:build jobs force dask_address")
def run_notebooks(names: list[str] = (), settings: list[str] = (), **how):
    """Run the stale notebooks and compare their figures and tables with those in figures/.

    What agrees stays as it is; what differs is written anew and named, with exit status 1.
    """
    from study.pages import catalogue, execute

    selected = catalogue.select(names)
    parameters = execute.check_parameters(selected, settings)
    _compare(_make(selected, parameters, **how))


@command("verify")
def verify_results(names: list[str] = (), keep: bool = False):
    """Say which results, as made here last, are the kept ones; run nothing."""
    from study.pages import catalogue, kept

    selected = catalogue.select(names)
    if keep:
        for notebook in selected:
            kept.accept(notebook.files())
    _compare(selected)


def _compare(selected):
    """Say how many results are the kept ones, and which are not; fail if one differs."""
    from study.pages import execute, kept

    found = execute.compare(selected)
    differing = [comparison.where for comparison in found if comparison.state == "differs"]
    for where in differing:
        print(f"differs  {where}", file=sys.stderr)
    print(kept.summary(found))
    if differing:
        raise typer.Exit(1)


@command("paper")
def typeset_paper():
    """Typeset the paper, build/paper.pdf, from the results in figures/ as they are."""
    from study.pages.typeset import typeset

    typeset()
    print("made  build/paper.pdf")


@command("report", "study.pages.tasks:build jobs")
def write_report(**how):
    """Bring everything up to date: figures, tables, paper, and the report, build/report/."""
    from study.pages.catalogue import CATALOGUE

    selected = _make(CATALOGUE, {}, report=True, **how)
    print("Figures and tables are in figures/, the paper is build/paper.pdf.")
    print("The report to browse: build/report/index.html")
    _compare(selected)


def _make(selected, parameters, **how):
    """Run notebooks and tell what was made; return those asked for and those that ran."""
    from study import dataset
    from study.pages import catalogue, execute

    dataset.verify_files()
    catalogue.check_claims()
    built = execute.run(selected, parameters, **how)
    made, every = built.made(), catalogue.CATALOGUE
    for notebook in every:
        if notebook.name in made:
            for name, shows in notebook.results.items():
                suffix = "csv" if name in notebook.tables else "png"
                print(f"made  figures/{name}.{suffix:<4}  {shows}")
            print(f"      build/notebooks/{notebook.path.name}")
    for task, file in (("typeset", "paper.pdf"), ("report", "report/index.html")):
        if task in made:
            print(f"made  build/{file}")
    _fail(built)
    if not made:
        names = ", ".join(notebook.name for notebook in selected)
        of = f" of {names}" if len(selected) < len(every) else ""
        print(f"Nothing was stale: every figure and table{of} in figures/ is up to date.")
    return [notebook for notebook in every if notebook in selected or notebook.name in made]


def _fail(built):
    """Say what failed, and end if something did."""
    for failure in built.failures:
        print(f"failed: {' '.join(failure.split())}", file=sys.stderr)
    if built.failures:
        raise typer.Exit(1)


@command("list")
def list_results():
    """List every figure and table: what it shows, its notebook, fresh or stale."""
    import pandas as pd

    from study.pages import catalogue, execute

    fresh = execute.run(catalogue.CATALOGUE, {}, dry=True).fresh()
    rows = [
        (name, "fresh" if notebook.name in fresh else "stale", notebook.name, shows)
        for notebook in catalogue.CATALOGUE
        for name, shows in notebook.results.items()
    ]
    _print(pd.DataFrame(rows, columns=["name", "state", "notebook", "shows"]))


@command(
    "law",
    "study.contact:stiffened_hertz socket_ratio modulus_ratio poisson socket_poisson",
    "study.contact:stiffened_hertz ball_drive rim",
)
def evaluate_law(
    name: LawName, r2_star: float, depth_star: list[float], as_json: bool = False, **of_law
):
    """Evaluate a contact law: dimensionless force P/(E* dR^2) at given depths.

    stiffened_hertz alone has options: it is for any two materials and four supports. The laws of
    the paper are those of its own joint.
    """
    unknown = sorted(of_law.keys() - signature(LAWS[name]).parameters)
    _left_out(unknown, of_law, f"{name} does not depend on it")
    force = LAWS[name](depth_star, r2_star, **of_law)
    _print({"depth_star": depth_star, "force_star": force.tolist()}, as_json)


@command("joint", *JOINT, "study.joint:force_curve solver")
def solve_joint(
    r2_star: float, depth_star: list[float], as_json: bool = False, solver=None, **joint
):
    """Solve one joint: force, contact half-angle, error estimate, and largest von Mises stresses.

    Stresses are in E* dR/R2; their radius is over that of the body's surface.
    """
    from study.joint import force_curve

    curve = force_curve(_joint(r2_star, **joint), depth_star, solver=solver)
    found = curve.columns()
    found["contact_half_angle_deg"] = found["contact_half_angle"]
    names = ("force_star", "contact_half_angle_deg", "peak_pressure_star", "error_estimate")
    tables = [{"depth_star": depth_star} | {name: found[name].tolist() for name in names}]
    for body, largest in curve.largest_stress.items():
        stress = {"star": largest.von_mises.tolist(), "over_peak": largest.over_peak.tolist()}
        stress |= {"radius": largest.radius.tolist(), "place": list(largest.place)}
        stress |= {"angle_deg": [math.degrees(angle) for angle in largest.angle]}
        body = f"von_mises_{body.replace(' ', '_')}"
        named = {f"{body}_{name}": column for name, column in stress.items()}
        tables.append({"depth_star": depth_star} | named)
    _print({name: column for table in tables for name, column in table.items()}, as_json, *tables)


def _joint(
    r2_star=200.0,
    *,
    modulus_ratio: float | None = None,
    socket_poisson: float | None = None,
    layer: list[str] | None = None,
    yield_stress: float | None = None,
    **others,
):
    from study.joint import Joint, Layer, Material

    poisson = {"poisson": others.pop("poisson")} if "poisson" in others else {}
    ball = Material(**poisson, yield_stress=yield_stress)
    unit, of_one = ball.youngs_modulus, {"modulus_ratio": modulus_ratio}
    of_one |= {"socket_poisson": socket_poisson, "socket_ratio": others.get("socket_ratio")}
    if layer:
        of_one |= {"yield_stress": yield_stress}
        given = [name for name, value in of_one.items() if value is not None]
        _left_out(given, given, "--layer tells what the socket is")
        each = [_numbers("--layer", text, count=3) for text in layer]
        moduli = [unit * checks.number("modulus of --layer", e, above=0) for _, e, _ in each]
        layers = zip(each, moduli, strict=True)
        others["layers"] = tuple(Layer(q, Material(e, nu)) for (q, _, nu), e in layers)
    else:
        poisson = ball.poisson if socket_poisson is None else socket_poisson
        ratio = 1.0 if modulus_ratio is None else modulus_ratio
        modulus = unit * checks.number("--modulus-ratio", ratio, above=0)
        others["socket"] = Material(modulus, poisson, yield_stress)
    return Joint(r2_star, ball=ball, **others)


@command(
    "choose", *JOINT, "study.cli:_joint yield_stress", "study.choose:choose depth_star tolerance"
)
def choose_law(r2_star: float, depth_star, tolerance, as_json: bool = False, **joint):
    """Choose the cheapest law that is accurate enough for a joint, with the evidence.

    For a whole mechanism: study simulate --model auto --tolerance ... .
    """
    from study.choose import choose
    from study.choose.law import relative_costs

    choice, costs = choose(_joint(r2_star, **joint), depth_star, tolerance), relative_costs()
    laws = sorted(choice.errors, key=costs.get)
    names = ("law", "error_bound", "relative_cost", "options")
    depths, first = "{:g} to {:g}".format(*choice.depths), choice.first_yield
    yields = (
        "The {body} yields, {place}, from {depth_star:.4g} clearances on (force_star "
        "{force_star:.4g}): all errors are those of joints that do not yield."
    )
    _print(
        {"next_cheaper": next(iter(choice.rejected), None)} | _fields(choice),
        as_json,
        {name: [getattr(choice, name)] for name in names},
        f"For depths of {depths} clearances.",
        *([yields.format(**first)] if first else []),
        "Largest error of each law, and time of a call over that of Hertz's law:",
        {
            "law": laws,
            "error": [choice.errors[law] for law in laws],
            "relative_cost": [costs[law] for law in laws],
        },
    )


def _fields(choice):
    """What a choice knows by name, without the function that it gives."""
    given = ("evaluate", "simulate")
    return {name: value for name, value in vars(choice).items() if name not in given}


@command("export", "study.export:export law form", *JOINT)
def export_law(law, form, output: Path | None = None, r2_star: float | None = None, **joint):
    """Export a law of this study, for one joint, to another program: to standard output or a file.

    R2/dR is 200 by default.
    """
    from study.export import export

    joint |= {} if r2_star is None else {"r2_star": r2_star}
    _check_output(output, f".{form}")
    text = export(law, form, _joint(**joint))
    if output is None:
        print(text, end="")
    else:
        with paths.whole(output) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _check_output(output, suffix):
    if output is not None and output.suffix != suffix:
        raise ValueError(f"--output must end in {suffix}, got {output}")
    if output is not None and not os.access(output.parent, os.W_OK):
        raise ValueError(f"--output must be in a folder that can be written to, got {output}")


@command(
    "simulate",
    "study.mechanism:simulate model joint law duration outputs tolerance step elements method",
    "study.choose:choose_model quantity socket_ratio",
)
def simulate_mechanism(
    scene: list[str] = (),
    inertia: str = "rods",
    output: Path | None = None,
    as_json: bool = False,
    **given,
):
    """Simulate the crank-slider: where it is at the end, and every impact (SI units).

    --model auto takes no more than is needed for --tolerance, which is then the largest error of
    the --quantity: its RMS over that of the change since t = 0.
    """
    from study import mechanism
    from study.choose import choose_model
    from study.compiled import CACHE

    changed = _scene(scene, inertia)
    _check_output(output, ".csv")
    if "elements" in given:
        given["elements"] = _numbers("--elements", given["elements"], int)
    if sys.stderr.isatty() and not any(CACHE.rglob("*.nbi")):
        print("Compiling the stepping loops, once: some seconds ...", file=sys.stderr)
    auto = given.get("model") == "auto"
    options = signature(choose_model if auto else mechanism.simulate).parameters
    model = given.pop("model") if auto else given.get("model", options["model"].default)
    why = f"model {model} {'chooses it' if auto else 'has none'}"
    _left_out(sorted(given.keys() - options), given, why)
    if auto and "tolerance" not in given:
        raise ValueError("tolerance must be given: the largest error that model auto may make")
    choice = choose_model(changed, **given) if auto else None
    run = choice.simulate if auto else partial(mechanism.simulate, changed, **given)
    with _bar() as bar:
        task = bar.add_task("", total=given.get("duration", options["duration"].default))
        response = run(progress=lambda time: bar.update(task, completed=time))
    last = response.motion.iloc[-1]
    end = {
        "time": last.time,
        "theta": last.crank_angle,
        "x_slider": last.slider_position,
        "v_slider": last.slider_velocity,
        "a_slider": last.slider_acceleration,
        "contacts": len(response.impacts),
        "last_separation": response.last_separation,
        "energy_error": response.energy_error,
        "complete": response.complete,
    }
    impacts = response.impacts.astype(object).where(response.impacts.notna(), None)
    rest = len(impacts) - SHOWN
    _print(
        end
        | ({"choice": _fields(choice)} if choice else {})
        | {"impacts": impacts.to_dict("records")},
        as_json,
        *(_told(choice, last.time) if choice else []),
        {name: [value] for name, value in end.items()},
        impacts.head(SHOWN),
        f"SI units.{f' {rest} more contacts: --json prints all.' if rest > 0 else ''}",
    )
    if output is not None:  # last: what was computed is printed even if the disk is full
        response.save(output)
    return 0 if response.complete else INTERRUPTED


def _told(choice, duration):
    """What model was chosen, in words, and everything that was looked at."""
    names = ("model", "joint", "law", "settings", "error_bound", "relative_cost", "links")
    return [
        f"The least model whose {choice.quantity.replace('_', ' ')} is known well enough over "
        f"{duration:g} s:\n{choice.model} links, {choice.joint} joint, law {choice.law}, within "
        f"{choice.error_bound:.2g}. In order of detail (costs: times here):",
        {name: [row[name] for row in choice.evidence] for name in names},
        f"Links over contact: {choice.compliance_ratio:.2g} times its compliance, "
        f"{choice.frequency_ratio:.2g} of the crank's axial frequency, at a depth of "
        f"{choice.depth_star:.2g} clearances.",
        *([f"Particles were run, as {choice.note}."] if choice.note else []),
    ]


def _scene(settings, inertia):
    """The paper's scene with settings ``KEY=VALUE`` and the inertias changed."""
    from study.mechanism import Scene

    known, changes = {field.name: field.default for field in fields(Scene)}, {}
    if inertia != "rods":
        changes["crank_inertia"], changes["coupler_inertia"] = _numbers("--inertia", inertia)
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals or key not in known:
            names = ", ".join(known)
            raise ValueError(f"--scene must be KEY=VALUE with KEY one of {names}, got {setting!r}")
        kind = type(known[key])
        number = _numbers if kind is tuple else _number
        changes[key] = text if kind is str else number(key, text)
    return Scene(**changes)


def _numbers(name, text, kind=float, count=2):
    """Two or three numbers, separated by commas."""
    parts = text.split(",")
    if len(parts) != count:
        wanted = {2: "two numbers separated by a comma", 3: "three numbers separated by commas"}
        raise ValueError(f"{name} must be {wanted[count]}, got {text!r}")
    return tuple(_number(name, part, kind) for part in parts)


def _number(name, text, kind=float):
    try:
        return kind(text)
    except ValueError:
        what = "a whole number" if kind is int else "a number"
        raise ValueError(f"{name} must be {what}, got {text!r}") from None


def _bar():
    """Bar of simulated time on standard error, gone at the end; none off the terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    text = TextColumn("simulated {task.completed:.4g} of {task.total:g} s")
    columns, console = (text, BarColumn(), TimeRemainingColumn()), Console(stderr=True)
    hidden = not console.is_terminal
    return Progress(*columns, console=console, transient=True, disable=hidden)


@command("show", "study.joint:Joint ball_drive rim kinematics", group=data_app, defaults=False)
def show_data(
    r2_star: list[float] = (), socket_ratio: list[float] = (), group: str = "", case: str = "", **of
):
    """Show a summary of the cases with the values asked for (P/(E* dR^2), angles in deg)."""
    from study import dataset

    own = {"r2_star": r2_star, "socket_ratio": socket_ratio, "group": group, "case": case}
    frame = dataset.load(**{key: value for key, value in own.items() if value}, **of)
    _print(frame.loc[:, "depth_star":] if case else dataset.summary(frame))


@command("check", group=data_app)
def check_data():
    """Check files, schema and physics of the dataset, and solve one case anew."""
    from study.dataset import quality

    checked, found = zip(*quality.check(), strict=True)
    _print({"checked": checked, "found": found})


@command("build", "study.pages.tasks:build jobs", group=data_app)
def build_data(**how):
    """Build the dataset from nothing; an interrupted build resumes."""
    from study.pages import tasks

    _fail(tasks.build([paths.DATA], **how))
    print("The dataset is up to date: data/force_curves.csv, links.csv and datapackage.json.")


@command("measure", "study.measure.speed:measure chart repeats")
def measure_speed(output: Path | None = None, **how):
    """Time laws (a minute), solvers and steppers (ten minutes each) on this machine.

    The times are kept in data/published/peers.csv, where the charts and study choose take them
    from, if no other file is named. Charts that are not timed stay, and so do other programs that
    are not found here (ccx, scikit-sundae, exudyn).
    """
    import pandas as pd

    from study.dataset import store
    from study.measure import speed

    _check_output(output, ".csv")
    charts, frames = speed.measure(**how), []
    if output is None:
        store.verify_files()  # before ten minutes of timing
    for chart in charts:
        print(f"timed {chart.chart.iloc[0]}", file=sys.stderr)
        frames.append(chart)
        if output is None:
            store.keep_measured(chart)
    frame = pd.concat(frames)
    if output is not None:
        with paths.whole(output) as temporary:
            frame.to_csv(temporary, index=False)
    print(f"{len(frame)} rows, on {speed.machine()}")


def _print(told, as_json=False, *parts):
    """Print one JSON object, or its parts as text: lines, and tables of columns by name.

    A table has its full width where the output is no terminal.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Column, Table

    if as_json:
        print(json.dumps(told, allow_nan=False))
        return
    console = Console(width=None if sys.stdout.isatty() else 200)
    for part in parts or [told]:
        if isinstance(part, str):
            print(part)
        else:
            columns = (Column(name, overflow="fold") for name in part)
            table = Table(*columns, box=box.SIMPLE_HEAD, pad_edge=False)
            for row in zip(*(part[name] for name in part), strict=True):
                table.add_row(*map(_text, row))
            console.print(table)


def _text(value):
    if value is None or value == {}:
        return "-"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value.items())
    return f"{value:.6g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    main()
