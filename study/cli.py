"""The command line ``study``: notebooks, paper, report, dataset, laws, joints and simulations.

A user's mistake is one line on standard error and exit status 2; a failure is exit status 1.
"""

import json
import os
import sys
from contextlib import contextmanager
from dataclasses import fields
from enum import StrEnum
from inspect import signature
from pathlib import Path
from typing import Annotated

import typer

from study.checks import StudyError
from study.contact import LAWS, SOCKET_RATIO

app = typer.Typer(
    help="Contact force laws for spherical clearance joints: rebuild, inspect, evaluate.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
data_app = typer.Typer(help="The cached force-depth curves.", no_args_is_help=True)
app.add_typer(data_app, name="data")

SHOWN = 20  # impacts in a printed table
INTERRUPTED = 130  # typer's status after Ctrl-C
UsageError = typer.BadParameter.__base__  # of every wrong option or argument
LawName = StrEnum("LawName", list(LAWS))
Drive = StrEnum("Drive", ["plane", "clamped", "point"])
Rim = StrEnum("Rim", ["mirror", "free"])
Kinematics = StrEnum("Kinematics", ["small", "linear", "finite"])
Solver = StrEnum("Solver", ["series", "quadratic", "linear"])
Exported = StrEnum("Exported", ["stiffened_hertz", "tabulated"])
Format = StrEnum("Format", ["c", "json", "csv"])
Model = StrEnum("Model", ["rigid", "particles", "beams", "auto"])
Chart = StrEnum("Chart", ["laws", "solvers", "steppers"])
Quantity = StrEnum("Quantity", ["slider_position", "slider_velocity", "slider_acceleration"])
MechanismJoint = StrEnum("MechanismJoint", ["clearance", "ideal"])
Method = StrEnum("Method", ["centred", "lagged", "unguarded"])

R2Star = Annotated[float, typer.Option("--r2-star", help="Dimensionless socket radius R2/dR, > 1.")]
DepthStars = Annotated[
    list[float],
    typer.Option("--depth-star", help="Dimensionless penetration depth d/dR; may be repeated."),
]
SocketRatio = Annotated[
    float, typer.Option(help="Outer over inner radius of the socket, >= 1.001.")
]
Poisson = Annotated[float, typer.Option(help="Poisson's ratio of both bodies, in (-1, 0.5).")]
ModulusRatio = Annotated[
    float, typer.Option(help="Young's modulus of the socket over that of the ball, > 0.")
]
SocketPoisson = Annotated[
    float | None, typer.Option(help="Poisson's ratio of the socket, if not that of the ball.")
]
WhichKinematics = Annotated[
    Kinematics, typer.Option(help="Pairing of the surfaces, see study.joint.Joint.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
Names = Annotated[
    list[str] | None,
    typer.Argument(metavar="[NAME]...", help="Figures, tables or notebooks; default all."),
]
Jobs = Annotated[
    int | None, typer.Option("--jobs", min=1, help="Processes; by default one per core.")
]


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
    except (StudyError, OSError) as error:
        _complain(str(error), 1)
    if status == INTERRUPTED:
        _complain("interrupted; what was finished is kept", status)
    sys.exit(status or 0)


def _complain(text, status):
    print(f"study: {' '.join(text.split())}", file=sys.stderr)
    sys.exit(status)


@app.command("run")
def run_notebooks(
    names: Names = None,
    jobs: Jobs = None,
    force: Annotated[bool, typer.Option("--force", help="Run fresh notebooks too.")] = False,
    settings: Annotated[
        list[str] | None,
        typer.Option("-p", metavar="KEY=VALUE", help="Set a notebook's parameter; repeatable."),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option("--dask", metavar="ADDRESS", help="Dask scheduler that runs the tasks."),
    ] = None,
):
    """Run the stale notebooks and compare their figures and tables with those in figures/.

    What agrees stays as it is; what differs is written anew and named, with exit status 1.
    """
    from study import dataset
    from study.pages import catalogue, execute

    selected = catalogue.select(names or [])
    parameters = execute.check_parameters(selected, settings or [])
    dataset.verify_files()
    catalogue.check_claims()
    built = execute.run(selected, parameters, jobs=jobs, force=force, dask_address=dask)
    _compare(_tell(selected, built))


@app.command("verify")
def verify_results(
    names: Names = None,
    keep: Annotated[
        bool, typer.Option("--keep", help="Take what differs as the kept results from now on.")
    ] = False,
):
    """Say which results, as made here last, are the kept ones; run nothing."""
    from study.pages import catalogue, kept

    selected = catalogue.select(names or [])
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


@app.command("paper")
def typeset_paper():
    """Typeset the paper, build/paper.pdf, from the results in figures/ as they are."""
    from study.pages.typeset import typeset

    typeset()
    print("made  build/paper.pdf")


@app.command("report")
def write_report(jobs: Jobs = None):
    """Bring everything up to date: figures, tables, paper, and the report, build/report/."""
    from study import dataset
    from study.pages import catalogue, execute

    dataset.verify_files()
    catalogue.check_claims()
    built = execute.run(catalogue.CATALOGUE, {}, report=True, jobs=jobs)
    _tell(catalogue.CATALOGUE, built)
    print("Figures and tables are in figures/, the paper is build/paper.pdf.")
    print("The report to browse: build/report/index.html")
    _compare(catalogue.CATALOGUE)


def _tell(selected, built):
    """Say what was made, or what failed; return the notebooks asked for and those that ran."""
    from study.pages.catalogue import CATALOGUE

    made = built.made()
    ran = [notebook for notebook in CATALOGUE if notebook.name in made]  # with those needed
    for notebook in ran:
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
        of = f" of {names}" if len(selected) < len(CATALOGUE) else ""
        print(f"Nothing was stale: every figure and table{of} in figures/ is up to date.")
    return [notebook for notebook in CATALOGUE if notebook in selected or notebook in ran]


def _fail(built):
    """Say what failed, and end if something did."""
    for failure in built.failures:
        print(f"failed: {' '.join(failure.split())}", file=sys.stderr)
    if built.failures:
        raise typer.Exit(1)


@app.command("list")
def list_results():
    """List every figure and table: what it shows, its notebook, fresh or stale."""
    from study.pages import catalogue, execute

    fresh = execute.run(catalogue.CATALOGUE, {}, dry=True).fresh()
    rows = [
        (name, "fresh" if notebook.name in fresh else "stale", notebook.name, shows)
        for notebook in catalogue.CATALOGUE
        for name, shows in notebook.results.items()
    ]
    _table(["name", "state", "notebook", "shows"], rows)


@app.command("law")
def evaluate_law(
    law: Annotated[LawName, typer.Argument(metavar="NAME", help=f"One of {', '.join(LawName)}.")],
    r2_star: R2Star,
    depth_star: DepthStars,
    socket_ratio: Annotated[
        float | None,
        typer.Option(help="stiffened_hertz: outer over inner radius of the socket [1.298]."),
    ] = None,
    poisson: Annotated[
        float | None, typer.Option(help="stiffened_hertz: Poisson's ratio of both bodies [0.3].")
    ] = None,
    kinematics: Annotated[
        Kinematics | None, typer.Option(help="stiffened_hertz: linear or finite [linear].")
    ] = None,
    as_json: AsJson = False,
):
    """Evaluate a contact law: dimensionless force P/(E* dR^2) at given depths.

    stiffened_hertz is for a radially free ball of the socket's material, the laws of the paper
    are those of its own joint.
    """
    given = {"socket_ratio": socket_ratio, "poisson": poisson}
    given["kinematics"] = None if kinematics is None else str(kinematics)
    options = {name: value for name, value in given.items() if value is not None}
    for name in options:
        if name not in signature(LAWS[law]).parameters:
            option = f"--{name.replace('_', '-')}"
            raise ValueError(f"{option} must be left out: {law} does not depend on it")
    force = LAWS[law](depth_star, r2_star, **options)
    _print_curve({"depth_star": depth_star, "force_star": force.tolist()}, as_json)


@app.command("joint")
def solve_joint(
    r2_star: R2Star,
    depth_star: DepthStars,
    socket_ratio: SocketRatio = SOCKET_RATIO,
    poisson: Poisson = 0.3,
    modulus_ratio: ModulusRatio = 1.0,
    socket_poisson: SocketPoisson = None,
    drive: Annotated[
        Drive,
        typer.Option(
            help="Ball's equatorial plane: radially free, clamped (the paper's), or its centre."
        ),
    ] = Drive.plane,
    rim: Annotated[
        Rim, typer.Option(help="Socket's edge: mirror plane, or free (the paper's).")
    ] = Rim.mirror,
    kinematics: WhichKinematics = Kinematics.linear,
    solver: Annotated[
        Solver | None,
        typer.Option(help="Series, or six-node (quadratic) or three-node (linear) triangles."),
    ] = None,
    as_json: AsJson = False,
):
    """Solve one joint: force, contact half-angle and error estimate."""
    import numpy as np

    from study.joint import force_curve

    materials = modulus_ratio, socket_poisson
    supports = {"ball_drive": str(drive), "rim": str(rim)}
    joint = _joint(r2_star, socket_ratio, poisson, kinematics, *materials, **supports)
    curve = force_curve(joint, depth_star, solver=None if solver is None else str(solver))
    columns = {
        "depth_star": depth_star,
        "force_star": curve.force_star.tolist(),
        "contact_half_angle_deg": np.degrees(curve.contact_half_angle).tolist(),
        "peak_pressure_star": curve.peak_pressure.tolist(),
        "error_estimate": curve.error_estimate.tolist(),
    }
    _print_curve(columns, as_json)


def _joint(r2_star, socket_ratio, poisson, kinematics, ratio=1.0, socket_poisson=None, **supports):
    from study import checks
    from study.joint import Joint, Material

    ball = Material(poisson=poisson)
    modulus = ball.youngs_modulus * checks.number("--modulus-ratio", ratio, above=0)
    socket = Material(modulus, poisson if socket_poisson is None else socket_poisson)
    return Joint(r2_star, socket_ratio, ball, socket, kinematics=str(kinematics), **supports)


@app.command("choose")
def choose_law(
    r2_star: R2Star,
    depth_star: Annotated[
        float, typer.Option("--depth-star", help="Largest depth d/dR of the scene.")
    ],
    tolerance: Annotated[
        float, typer.Option(help="Largest relative error of the force, from 1e-5 to 1.")
    ],
    socket_ratio: SocketRatio = SOCKET_RATIO,
    poisson: Poisson = 0.3,
    modulus_ratio: ModulusRatio = 1.0,
    socket_poisson: SocketPoisson = None,
    drive: Annotated[Drive, typer.Option(help="As for study joint.")] = Drive.plane,
    rim: Annotated[Rim, typer.Option(help="As for study joint.")] = Rim.mirror,
    kinematics: WhichKinematics = Kinematics.linear,
    as_json: AsJson = False,
):
    """Choose the cheapest law that is accurate enough for a joint, with the evidence.

    For a whole mechanism: study simulate --model auto --tolerance ... .
    """
    from study.choose import choose
    from study.choose.law import relative_costs

    materials = modulus_ratio, socket_poisson
    supports = {"ball_drive": str(drive), "rim": str(rim)}
    joint = _joint(r2_star, socket_ratio, poisson, kinematics, *materials, **supports)
    choice = choose(joint, depth_star, tolerance)
    told = {
        "law": choice.law,
        "options": choice.options,
        "error_bound": choice.error_bound,
        "relative_cost": choice.relative_cost,
        "depths": list(choice.depths),
        "source": choice.source,
        "note": choice.note,
        "next_cheaper": choice.rejected[0] if choice.rejected else None,
        "rejected": list(choice.rejected),
        "errors": choice.errors,
    }
    if as_json:
        print(json.dumps(told, allow_nan=False))
        return
    columns = ("law", "error_bound", "relative_cost", "options")
    _table(columns, [[_text(told[name]) for name in columns]])
    least, most = choice.depths
    print(f"For depths of {least:g} to {most:g} clearances, by the {choice.source}.")
    if choice.note:
        print(f"Solved, as {choice.note}.")
    costs = relative_costs()
    rows = [(law, choice.errors[law], costs[law]) for law in sorted(choice.errors, key=costs.get)]
    print("Largest error of each law, and time of a call over that of Hertz's law:")
    _table(("law", "error", "relative_cost"), [[_text(value) for value in row] for row in rows])


@app.command("export")
def export_law(
    law: Annotated[
        Exported, typer.Option(help="Closed form, or the curve of one joint as a table.")
    ],
    form: Annotated[
        Format, typer.Option("--format", help="C function, coefficients or table, force curve.")
    ],
    r2_star: Annotated[float | None, typer.Option(help="Of the joint [200].")] = None,
    socket_ratio: Annotated[float | None, typer.Option(help="Of the joint [1.298].")] = None,
    poisson: Annotated[float | None, typer.Option(help="Of both bodies [0.3].")] = None,
    modulus_ratio: ModulusRatio = 1.0,
    socket_poisson: SocketPoisson = None,
    kinematics: WhichKinematics = Kinematics.linear,
    output: Annotated[
        Path | None, typer.Option(help="File to write; by default the text is printed.")
    ] = None,
):
    """Export a law of this study for another program.

    The joint is that of csv and of everything of tabulated; the C function and the
    coefficients of stiffened_hertz hold for all joints, so that --kinematics alone counts.
    """
    from study import paths
    from study.export import export

    given = {"r2_star": r2_star, "socket_ratio": socket_ratio, "poisson": poisson}
    if law == Exported.stiffened_hertz and form != Format.csv:
        for name, value in given.items():
            if value is not None:
                option = f"--{name.replace('_', '-')}"
                raise ValueError(f"{option} must be left out: the {form} export takes any joint")
    usual = {"r2_star": 200.0, "socket_ratio": SOCKET_RATIO, "poisson": 0.3}
    given = {name: usual[name] if value is None else value for name, value in given.items()}
    if output is not None:
        _check_output(output, f".{form}")
    materials = {"ratio": modulus_ratio, "socket_poisson": socket_poisson}
    text = export(str(law), str(form), _joint(**given, kinematics=kinematics, **materials))
    if output is None:
        print(text, end="")
    else:
        with paths.whole(output) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _check_output(output, suffix):
    if output.suffix != suffix:
        raise ValueError(f"--output must end in {suffix}, got {output}")
    if not os.access(output.parent, os.W_OK):
        raise ValueError(f"--output must be in a folder that can be written to, got {output}")


@app.command("simulate")
def simulate_mechanism(
    model: Annotated[
        Model, typer.Option(help="Links: rigid, particles or beams; auto: as little as it needs.")
    ] = Model.rigid,
    joint: Annotated[
        MechanismJoint | None, typer.Option(help="Joint of coupler and slider [clearance].")
    ] = None,
    law: Annotated[LawName | None, typer.Option(help="Contact law [hertz].")] = None,
    duration: Annotated[float, typer.Option(help="Simulated time, in s.")] = 0.1,
    outputs: Annotated[int, typer.Option(help="Equal intervals between times of output.")] = 1000,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Rigid links with clearance: 1e-12 to 1e-2 [1e-8]. Model auto: largest error "
            "of the slider's motion, its RMS over that of the change since t = 0."
        ),
    ] = None,
    step: Annotated[
        float | None, typer.Option(help="Flexible links: largest time step, in s.")
    ] = None,
    elements: Annotated[
        str | None, typer.Option(metavar="N,N", help="Elements of crank and coupler [4,8].")
    ] = None,
    method: Annotated[
        Method | None, typer.Option(help="Particles: velocity in damping and friction [centred].")
    ] = None,
    quantity: Annotated[
        Quantity | None,
        typer.Option(help="auto: what the tolerance is for [slider_position]."),
    ] = None,
    socket_ratio: Annotated[
        float | None, typer.Option(help="auto: outer over inner radius of the socket [1.298].")
    ] = None,
    inertia: Annotated[
        str,
        typer.Option(
            metavar="rods|I1,I2",
            help="Moments of inertia of crank and coupler about their centres, in kg m^2.",
        ),
    ] = "rods",
    scene: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUE",
            help="Change the scene; may be repeated: restitution=0.9, link_modulus=2e9; SI.",
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Write the motion to this CSV file as well.")
    ] = None,
    as_json: AsJson = False,
):
    """Simulate the crank-slider: where it is at the end, and every impact (SI units)."""
    from study.choose import choose_model
    from study.compiled import CACHE
    from study.mechanism import simulate
    from study.mechanism.compare import last_separation

    changed = _scene(scene or [], inertia)
    if output is not None:
        _check_output(output, ".csv")
    pair = None if elements is None else _numbers("--elements", elements, int)
    if sys.stderr.isatty() and not any(CACHE.rglob("*.nbi")):
        print("Compiling the stepping loops, once: some seconds ...", file=sys.stderr)
    names = {"joint": joint, "law": law, "method": method}
    given = {name: str(value) for name, value in names.items() if value is not None}
    given |= {} if step is None else {"step": step}
    given |= {} if pair is None else {"elements": pair}
    of_auto = {} if socket_ratio is None else {"socket_ratio": socket_ratio}
    of_auto |= {} if quantity is None else {"quantity": str(quantity)}
    common = {"duration": duration, "outputs": outputs}
    chosen = None
    if model == Model.auto:
        for name in given:
            raise ValueError(f"{name} must be left out: model auto chooses it")
        if tolerance is None:
            raise ValueError("tolerance must be given: the largest error that model auto may make")
        chosen = choose_model(changed, tolerance, **common, **of_auto)
    else:
        for name in of_auto:
            raise ValueError(f"{name} must be left out: model {model} has none")
        given |= {"model": str(model), "tolerance": tolerance}
    with _progress(duration) as progress:
        common |= {"progress": progress}
        response = (
            chosen.simulate(progress=progress) if chosen else simulate(changed, **given, **common)
        )
    last = response.motion.iloc[-1]
    end = {
        "time": last.time,
        "theta": last.crank_angle,
        "x_slider": last.slider_position,
        "v_slider": last.slider_velocity,
        "a_slider": last.slider_acceleration,
        "contacts": len(response.impacts),
        "last_separation": last_separation(response),
        "energy_error": response.energy_error,
        "complete": response.complete,
    }
    choice = _model_choice(chosen)
    impacts = response.impacts.astype(object).where(response.impacts.notna(), None)
    if as_json:
        told = end | choice | {"impacts": impacts.to_dict("records")}
        print(json.dumps(told, allow_nan=False))
    else:
        if choice:
            _print_choice(chosen, duration)
        _table(list(end), [[_text(value) for value in end.values()]])
        shown = impacts.head(SHOWN)
        _table(impacts.columns, shown.map(_text).itertuples(index=False))
        rest = len(impacts) - len(shown)
        print(f"SI units.{f' {rest} more contacts: --json prints all.' if rest else ''}")
    if output is not None:  # last: what was computed is printed even if the disk is full
        response.save(output)
    return 0 if response.complete else INTERRUPTED


def _model_choice(choice):
    """What is told of a choice of model, if there was one, under the key ``choice``."""
    if choice is None:
        return {}
    names = [field.name for field in fields(choice) if field.name != "simulate"]
    return {"choice": {name: getattr(choice, name) for name in names}}


def _print_choice(choice, duration):
    """What was chosen, in words, and everything that was looked at."""
    names = ("model", "joint", "law", "settings", "error_bound", "relative_cost", "links")
    print(
        f"The least model whose {choice.quantity.replace('_', ' ')} is known well enough over "
        f"{duration:g} s:\n{choice.model} links, {choice.joint} joint, law {choice.law}, within "
        f"{choice.error_bound:.2g}. In order of detail (costs: times here):"
    )
    _table(names, [[_text(row[name]) for name in names] for row in choice.evidence])
    print(
        f"Links over contact: {choice.compliance_ratio:.2g} times its compliance, "
        f"{choice.frequency_ratio:.2g} of the crank's axial frequency, at a depth of "
        f"{choice.depth_star:.2g} clearances."
    )
    if choice.note:
        print(f"Particles were run, as {choice.note}.")


def _scene(settings, inertia):
    """The paper's scene with settings ``KEY=VALUE`` and the inertias changed."""
    from study.mechanism import Scene

    changes = {}
    if inertia != "rods":
        values = _numbers("--inertia", inertia, float)
        changes |= {"crank_inertia": values[0], "coupler_inertia": values[1]}
    known = {field.name: field.default for field in fields(Scene)}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals or key not in known:
            raise ValueError(
                f"--scene must be KEY=VALUE with KEY one of {', '.join(known)}, got {setting!r}"
            )
        if key == "damping":
            changes[key] = text
        elif key == "initial_eccentricity":
            changes[key] = _numbers(key, text, float)
        else:
            changes[key] = _number(key, text, float)
    return Scene(**changes)


def _numbers(name, text, kind):
    """Two numbers, separated by a comma."""
    parts = text.split(",")
    if len(parts) != 2:
        raise ValueError(f"{name} must be two numbers separated by a comma, got {text!r}")
    return tuple(_number(name, part, kind) for part in parts)


def _number(name, text, kind):
    try:
        return kind(text)
    except ValueError:
        what = "a whole number" if kind is int else "a number"
        raise ValueError(f"{name} must be {what}, got {text!r}") from None


@contextmanager
def _progress(duration):
    """Bar of simulated time on standard error, gone at the end; none off the terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    text = TextColumn("simulated {task.completed:.4g} of {task.total:g} s")
    columns = (text, BarColumn(), TimeRemainingColumn())
    console = Console(stderr=True)
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    with bar:
        task = bar.add_task("", total=duration)
        yield lambda time: bar.update(task, completed=time)


@data_app.command("show")
def show_data(
    r2_star: Annotated[
        list[float] | None, typer.Option("--r2-star", help="Keep these values of R2/dR.")
    ] = None,
    socket_ratio: Annotated[
        list[float] | None, typer.Option("--socket-ratio", help="Keep these socket ratios.")
    ] = None,
    drive: Annotated[Drive | None, typer.Option(help="Keep this drive.")] = None,
    rim: Annotated[Rim | None, typer.Option(help="Keep this rim.")] = None,
    kinematics: Annotated[Kinematics | None, typer.Option(help="Keep these kinematics.")] = None,
    group: Annotated[
        str | None, typer.Option(help="Keep this group: paper, ratio, poisson, fit, judge, ...")
    ] = None,
    case: Annotated[str | None, typer.Option("--case", help="One case, every depth of it.")] = None,
):
    """Show a summary of the dataset's cases (forces are P/(E* dR^2), angles in deg)."""
    from study import dataset

    chosen = {
        "r2_star": r2_star,
        "socket_ratio": socket_ratio,
        "ball_drive": drive,
        "rim": rim,
        "kinematics": kinematics,
        "group": group,
        "case": case,
    }
    frame = dataset.load(**{key: value for key, value in chosen.items() if value not in (None, [])})
    table = dataset.summary(frame) if case is None else frame.loc[:, "depth_star":]
    _table(table.columns, table.map(_text).itertuples(index=False))


@data_app.command("check")
def check_data():
    """Check files, schema and physics of the dataset, and solve one case anew."""
    from study.dataset import quality

    _table(["checked", "found"], quality.check())


@app.command("measure")
def measure_speed(
    chart: Annotated[
        list[Chart] | None, typer.Option(help="What to time; may be repeated [all].")
    ] = None,
    repeats: Annotated[int, typer.Option(min=1, help="Of each timing, after one not counted.")] = 5,
    output: Annotated[
        Path | None, typer.Option(help="CSV file to write instead of the kept one.")
    ] = None,
):
    """Time laws (a minute), solvers and steppers (ten minutes each) on this machine.

    The times are kept in data/published/peers.csv, where the charts and study choose take them
    from. Charts that are not timed stay, and so do other programs that are not found here (ccx,
    scikit-sundae, exudyn).
    """
    import pandas as pd

    from study import paths
    from study.dataset import store
    from study.measure import speed

    if output is None:
        store.verify_files()  # before ten minutes of timing
    else:
        _check_output(output, ".csv")
    frames = []
    for name in [str(name) for name in chart or speed.CHARTS]:
        print(name, file=sys.stderr)
        frames.append(speed.measure(name, repeats))
        if output is None:
            store.keep_measured(frames[-1])
    frame = pd.concat(frames)
    if output is not None:
        with paths.whole(output) as temporary:
            frame.to_csv(temporary, index=False)
    print(f"{len(frame)} rows, on {speed.machine()}")


@data_app.command("build")
def build_data(jobs: Jobs = None):
    """Build the dataset from nothing; an interrupted build resumes."""
    from study import paths
    from study.pages import tasks

    _fail(tasks.build([paths.DATA], jobs=jobs))
    print("The dataset is up to date: data/force_curves.csv, links.csv and datapackage.json.")


def _print_curve(columns, as_json):
    if as_json:
        print(json.dumps({key: columns[key] for key in columns}))
    else:
        rows = [[_text(value) for value in row] for row in zip(*columns.values(), strict=True)]
        _table(list(columns), rows)


def _text(value):
    if value is None or value == {}:
        return "-"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value.items())
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _table(header, rows):
    """Print a table; in full width when the output is not a terminal."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    console = Console(width=None if sys.stdout.isatty() else 200)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in header:
        table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*map(str, row))
    console.print(table)


if __name__ == "__main__":
    main()
