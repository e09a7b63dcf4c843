"""Commands for laws and joints: evaluate, solve, choose, export."""

import math
from inspect import signature
from pathlib import Path

from study import checks, paths
from study.cli.options import check_output, command, flag, left_out
from study.cli.output import named_fields, show, waiting
from study.contact import LAWS, LawName

MATERIALS = (
    "study.joint:Material poisson",
    "study.joint.described:described modulus_ratio socket_poisson layer",
)
JOINT = ("study.joint:Joint socket_ratio ball_drive rim kinematics", *MATERIALS)


@command(
    "law",
    "study.contact:stiffened_hertz socket_ratio modulus_ratio poisson socket_poisson",
    "study.contact:stiffened_hertz ball_drive rim",
)
def evaluate_law(
    name: LawName, r2_star: float, depth_star: list[float], as_json: bool = False, **of_law
):
    """Evaluate a contact law: dimensionless force P/(E* dR^2) at given depths.

    Only stiffened_hertz has options: it is for any two materials and four supports. The paper's
    laws have the coefficients of its own joint.
    """
    unknown = sorted(of_law.keys() - signature(LAWS[name]).parameters)
    left_out(unknown, of_law, f"{name} does not depend on it")
    force = LAWS[name](depth_star, r2_star, **of_law)
    show({"depth_star": depth_star, "force_star": force.tolist()}, as_json)


SIZES = ("socket_radius", "clearance", "wall")
"""Options of study joint that a joint with its dimensions needs."""
OF_SIZED = (*SIZES, "force", "depth", "ball", "socket", "liner", "tolerance")
OF_BOTH = ("ball_drive", "rim", "kinematics")


@command(
    "joint", "study.joint:DimensionalJoint ball socket", *JOINT, "study.joint:force_curve solver"
)
def solve_joint(
    socket_radius: float | None = None,
    clearance: float | None = None,
    wall: float | None = None,
    force: list[float] = (),
    depth: list[float] = (),
    liner: list[str] = (),
    tolerance: float | None = None,
    r2_star: float | None = None,
    depth_star: list[float] = (),
    as_json: bool = False,
    **joint,
):
    """Solve one joint: force, depth, stiffness, pressure, half-angle, error, and stresses.

    With dimensions: --socket-radius, --clearance, --wall and --force or --depth, in SI units, with
    materials by name. Without: --r2-star and --depth-star. Stresses are then in E* dR/R2, and their
    radius is relative to that of the body's surface.
    """
    given = {"socket_radius": socket_radius, "clearance": clearance, "wall": wall}
    given |= {"force": force, "depth": depth, "liner": liner, "tolerance": tolerance}
    given |= {"r2_star": r2_star, "depth_star": depth_star}
    given = {name: value for name, value in given.items() if value not in (None, ())} | joint
    if sized := [name for name in OF_SIZED if name in given]:
        others = [name for name in given if name not in (*OF_SIZED, *OF_BOTH)]
        left_out(others, given, f"{flag(sized[0])} is for a joint with its dimensions")
        _solve_sized(as_json, **given)
    else:
        _needed(("r2_star", "depth_star"), given, " or, with dimensions, --socket-radius, ...")
        _solve_dimensionless(as_json, **given)


def _needed(names, given, more=""):
    missing = [flag(name) for name in names if name not in given]
    if missing:
        raise ValueError(f"{' and '.join(missing)} must be given{more}")


def _solve_sized(as_json, force=None, depth=None, liner=(), tolerance=0.01, **of_joint):
    from study.choose.law import TOLERANCES
    from study.cli import dimensional
    from study.joint import DimensionalJoint
    from study.joint.described import liner as read_liner

    _needed(SIZES, of_joint)
    checks.number("tolerance", tolerance, least=TOLERANCES[0], most=TOLERANCES[1])
    joint = DimensionalJoint(**of_joint, liner=tuple(map(read_liner, liner)))
    with waiting("Solving the joint"):
        told, parts = dimensional.told(joint, joint.solve(force=force, depth=depth), tolerance)
    show(told, as_json, *parts)


def _solve_dimensionless(as_json, r2_star, depth_star, solver=None, **joint):
    from study.joint import force_curve
    from study.joint.described import described

    solved_joint = described(r2_star, **joint)
    with waiting("Solving the joint"):
        curve = force_curve(solved_joint, depth_star, solver=solver)
        stresses = curve.largest_stress
    found = curve.columns()
    names = ("force_star", "contact_half_angle_deg", "peak_pressure_star", "error_estimate")
    solved = {"depth_star": depth_star} | {name: found[name].tolist() for name in names}
    named, parts = solved, [solved]
    for body, largest in stresses.items():
        stress = {
            "von_mises_star": largest.von_mises.tolist(),
            "over_peak": largest.over_peak.tolist(),
        }
        stress |= {"radius": largest.radius.tolist(), "place": list(largest.place)}
        stress |= {"angle_deg": [math.degrees(angle) for angle in largest.angle]}
        parts += [f"Largest von Mises stress in the {body}:", {"depth_star": depth_star} | stress]
        body = f"von_mises_{body.replace(' ', '_')}"
        stress = {name.removeprefix("von_mises_"): column for name, column in stress.items()}
        named = named | {f"{body}_{name}": column for name, column in stress.items()}
    show(named, as_json, *parts)


@command(
    "choose",
    *JOINT,
    "study.joint.described:described yield_stress",
    "study.choose:choose depth_star tolerance",
)
def choose_law(r2_star: float, depth_star, tolerance, as_json: bool = False, **joint):
    """Choose the cheapest law that is accurate enough for a joint, with the evidence.

    For a whole mechanism: study simulate --model auto --tolerance ... .
    """
    from study.choose import choose
    from study.choose.law import relative_costs
    from study.joint.described import described

    asked, costs = described(r2_star, **joint), relative_costs()
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


@command("export", "study.export:export law form depth_star", *JOINT)
def export_law(
    law, form, depth_star=None, output: Path | None = None, r2_star: float | None = None, **joint
):
    """Export a law, for one joint, to another program: to standard output or a file.

    R2/dR is 200 by default. The text states joint, range, units, and the law's largest error
    against the solved joint.
    """
    from study.export import SUFFIXES, export
    from study.joint.described import described

    joint |= {} if r2_star is None else {"r2_star": r2_star}
    check_output(output, SUFFIXES[form])
    asked = described(**joint)
    with waiting("Solving the joint, and its error"):
        text = export(law, form, asked, depth_star)
    if output is None:
        print(text, end="")
    else:
        with paths.whole(output) as temporary:
            temporary.write_text(text, encoding="utf-8")
