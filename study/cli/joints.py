"""Commands for laws and joints: evaluate, solve, choose, export."""

import math
from inspect import signature
from pathlib import Path
from typing import Literal

import typer

from study import checks, paths
from study.cli.options import (
    DEPTHS,
    DRIVE,
    JSON,
    NEEDED,
    OUTPUT,
    R2_STAR,
    RIM,
    JointOptions,
    MaterialOptions,
    Rim,
    check_output,
    command,
    flag,
    left_out,
    number,
    option,
    words,
)
from study.cli.output import named_fields, show, waiting
from study.contact import LAWS, LawName


class LawOptions(MaterialOptions):
    """What stiffened_hertz depends on."""

    ball_drive: Literal["plane", "clamped"] = DRIVE
    rim: Rim = RIM


@command("law", LawOptions)
def evaluate_law(
    name: LawName = typer.Argument(help=f"One of {', '.join(LAWS)}.", metavar="NAME"),
    r2_star: float = number(R2_STAR, default=NEEDED),
    depth_star: list[float] = number(DEPTHS, default=NEEDED),
    as_json: bool = JSON,
    **options,
):
    """Evaluate a contact law: dimensionless force P/(E* dR^2) at given depths.

    Only stiffened_hertz has options: it is for any two materials and four supports. The paper's
    laws have the coefficients of its own joint.
    """
    unknown = sorted(options.keys() - signature(LAWS[name]).parameters)
    left_out(unknown, options, f"{name} does not depend on it")
    force = LAWS[name](depth_star, r2_star, **options)
    show({"depth_star": depth_star, "force_star": force.tolist()}, as_json)


MATERIAL = (
    "Material by its name (listed by study data materials), or by Young's modulus in Pa, Poisson's "
    "ratio and perhaps yield stress in Pa: 210e9,0.3,5e8. [default: steel]"
)


class DimensionOptions:
    """A joint with dimensions."""

    socket_radius: float = number("Inner radius of the socket, in m.")
    clearance: float = number("Radius of the socket minus that of the ball, in m.")
    wall: float = number("Thickness of the socket beyond its inner radius, liners included, in m.")
    force: list[float] = number("Contact force in N; may be repeated.")
    depth: list[float] = number("Penetration depth in m; may be repeated.")
    ball: str = words(MATERIAL)
    socket: str = words(MATERIAL)
    liner: list[str] = words(
        "Thickness in m and material of a liner inside the socket, 0.5e-3,PTFE; may be repeated, "
        "from the inside out."
    )
    tolerance: float = number("Largest relative error of the law that is chosen. [default: 0.01]")


class EitherOptions(JointOptions, DimensionOptions):
    """A joint with dimensions, or without."""

    r2_star: float = number(R2_STAR)
    depth_star: list[float] = number(DEPTHS)
    solver: Literal["series", "quadratic", "linear"] = option(
        "Exact Legendre series of both bodies, or finite elements: six-node (quadratic) or "
        "three-node (linear) triangles."
    )


DIMENSIONS = tuple(DimensionOptions.__annotations__)
SIZES = ("socket_radius", "clearance", "wall")
"""Options that a joint with dimensions needs."""
OF_BOTH = ("ball_drive", "rim", "kinematics")


@command("joint", EitherOptions)
def solve_joint(as_json: bool = JSON, **options):
    """Solve one joint: force, depth, stiffness, pressure, half-angle, error, and stresses.

    With dimensions: --socket-radius, --clearance, --wall and --force or --depth, in SI units, with
    materials by name. Without: --r2-star and --depth-star. Stresses are then in E* dR/R2, and their
    radius is relative to that of the body's surface.
    """
    if dimensions := [name for name in DIMENSIONS if name in options]:
        others = [name for name in options if name not in (*DIMENSIONS, *OF_BOTH)]
        left_out(others, options, f"{flag(dimensions[0])} is for a joint with its dimensions")
        _solve_dimensional(as_json, **options)
    else:
        _needed(("r2_star", "depth_star"), options, " or, with dimensions, --socket-radius, ...")
        _solve_dimensionless(as_json, **options)


def _needed(names, options, more=""):
    missing = [flag(name) for name in names if name not in options]
    if missing:
        raise ValueError(f"{' and '.join(missing)} must be given{more}")


def _solve_dimensional(as_json, force=None, depth=None, liner=(), tolerance=0.01, **of_joint):
    from study.choose.law import TOLERANCES
    from study.cli import dimensional
    from study.joint import DimensionalJoint, parsing

    _needed(SIZES, of_joint)
    checks.number("tolerance", tolerance, least=TOLERANCES[0], most=TOLERANCES[1])
    joint = DimensionalJoint(**of_joint, liner=tuple(map(parsing.liner, liner)))
    with waiting("Solving the joint"):
        solution = joint.solve(force=force, depth=depth)
        values, parts = dimensional.described(joint, solution, tolerance)
    show(values, as_json, *parts)


def _solve_dimensionless(as_json, r2_star, depth_star, solver=None, **joint):
    from study.joint import force_curve, parsing
    from study.joint.stress import largest as largest_stress

    solved_joint = parsing.joint(r2_star, **joint)
    with waiting("Solving the joint"):
        curve = force_curve(solved_joint, depth_star, solver=solver)
        stresses = largest_stress(curve)
    columns = curve.columns()
    names = ("force_star", "contact_half_angle_deg", "peak_pressure_star", "error_estimate")
    values = {"depth_star": depth_star} | {name: columns[name].tolist() for name in names}
    parts = [values]
    for body, largest in stresses.items():
        stress = {
            "von_mises_star": largest.von_mises.tolist(),
            "over_peak": largest.over_peak.tolist(),
            "radius": largest.radius.tolist(),
            "place": list(largest.place),
            "angle_deg": [math.degrees(angle) for angle in largest.angle],
        }
        parts += [f"Largest von Mises stress in the {body}:", {"depth_star": depth_star} | stress]
        prefix = f"von_mises_{body.replace(' ', '_')}_"
        named = {name.removeprefix("von_mises_"): column for name, column in stress.items()}
        values = values | {prefix + name: column for name, column in named.items()}
    show(values, as_json, *parts)


@command("choose", JointOptions)
def choose_law(
    r2_star: float = number(R2_STAR, default=NEEDED),
    depth_star: float = number("Largest depth of the scene, in clearances.", default=NEEDED),
    tolerance: float = number(
        "Largest relative error of the force, from 1e-5 to 1.", default=NEEDED
    ),
    yield_stress: float = number(
        "Yield stress of ball and socket in Pa, where the ball's modulus is 2e11 Pa."
    ),
    as_json: bool = JSON,
    **joint,
):
    """Choose the cheapest law that is accurate enough for a joint, with the evidence.

    For a whole mechanism: study simulate --model auto --tolerance ... .
    """
    from study.choose import choose, relative_costs
    from study.joint import parsing

    asked, costs = parsing.joint(r2_star, yield_stress=yield_stress, **joint), relative_costs()
    with waiting("Solving the joint"):
        choice = choose(asked, depth_star, tolerance)
    laws = sorted(choice.errors, key=costs.get)
    names = ("law", "error_bound", "relative_cost", "options")
    depths, first = "{:g} to {:g}".format(*choice.depths), choice.first_yield
    yields = (
        "The {body} yields, {place}, from {depth_star:.4g} clearances on (force_star "
        "{force_star:.4g}). All errors are for joints that do not yield."
    )
    show(
        {"next_cheaper": next(iter(choice.rejected), None)} | named_fields(choice),
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


@command("export", JointOptions)
def export_law(
    law: Literal[LawName, "tabulated"] = option(
        "Name of a law, or tabulated: the force-depth curve of the joint.", default=NEEDED
    ),
    form: Literal["c", "matlab", "json", "csv"] = option(
        "Function (C; MATLAB and Octave), formula and numbers (JSON), or force over depth (CSV).",
        "--format",
        default=NEEDED,
    ),
    depth_star: float = number(
        "Largest depth of the text, in clearances; by default 1, if the joint can go so deep."
    ),
    output: Path = OUTPUT,
    r2_star: float = number(R2_STAR, default=200.0),
    **joint,
):
    """Export a law, for one joint, to another program: to standard output or a file.

    The text states joint, range, units, and the law's largest error
    against the solved joint.
    """
    from study.export import SUFFIXES, export
    from study.joint import parsing

    check_output(output, SUFFIXES[form])
    asked = parsing.joint(r2_star, **joint)
    with waiting("Solving the joint, and its error"):
        text = export(law, form, asked, depth_star)
    if output is None:
        print(text, end="")
    else:
        with paths.whole(output) as temporary:
            temporary.write_text(text, encoding="utf-8")
