"""The command for a joint, with its dimensions in SI units or without: study joint."""

from typing import Literal

import numpy as np

from study import checks
from study.cli import options as cli
from study.cli.output import show, working

MICRO, MEGA, PERCENT = 1e-6, 1e6, 0.01
LARGE = 1.0  # m: a socket's radius that is probably in mm
NO_LAW = {
    "tabulated": "tabulated, the table of this joint's own curve",
    "solver": "none: the joint has to be solved at every depth",
}
HELD = "they are largest where that is held, and depend on its details."
MATERIAL = (
    "Material by its name (listed by study data materials), or by Young's modulus in Pa, Poisson's "
    "ratio and perhaps yield stress in Pa: 210e9,0.3,5e8. [default: steel]"
)


class DimensionOptions:
    """A joint with dimensions."""

    socket_radius: float = cli.option("Inner radius of the socket, in m.")
    clearance: float = cli.option("Radius of the socket minus that of the ball, in m.")
    wall: float = cli.option(
        "Thickness of the socket beyond its inner radius, liners included, in m."
    )
    force: list[float] = cli.option("Contact force in N; may be repeated.")
    depth: list[float] = cli.option("Penetration depth in m; may be repeated.")
    ball: str = cli.option(MATERIAL)
    socket: str = cli.option(MATERIAL)
    liner: list[str] = cli.option(
        "Thickness in m and material of a liner inside the socket, 0.5e-3,PTFE; may be repeated, "
        "from the inside out."
    )
    tolerance: float = cli.option(
        "Largest relative error of the law that is chosen. [default: 0.01]"
    )


class EitherOptions(cli.JointOptions, DimensionOptions):
    """A joint with dimensions, or without."""

    tilt: float = cli.option(
        "Angle off the axis, in deg, of the displacement; with --force that of the force."
    )
    r2_star: float = cli.option(cli.R2_STAR)
    depth_star: list[float] = cli.option(cli.DEPTHS)
    solver: Literal["series", "quadratic", "linear"] = cli.option(
        "Exact Legendre series of both bodies, or finite elements: six-node (quadratic) or "
        "three-node (linear) triangles."
    )


DIMENSIONS = tuple(DimensionOptions.__annotations__)
SIZES = ("socket_radius", "clearance", "wall")
"""Options that a joint with dimensions needs."""


@cli.command("joint")
def solve_joint(as_json: bool = cli.JSON, **options: EitherOptions):
    """Solve one joint: force, depth, stiffness, pressure, half-angle, error, and stresses.

    With dimensions: --socket-radius, --clearance, --wall and --force or --depth, in SI units, with
    materials by name. Without: --r2-star and --depth-star. Stresses are then in E* dR/R2, and their
    radius is relative to that of the body's surface. With --tilt the ball is pressed off the axis:
    forces along and across its displacement, positive towards larger tilt, and no stresses.
    """
    from study.joint.supports import SUPPORTS

    if dimensions := [name for name in DIMENSIONS if name in options]:
        why = f"{cli.flag(dimensions[0])} is for a joint with its dimensions"
        cli.left_out(options, (*DIMENSIONS, *SUPPORTS, "tilt"), why)
        solve = _solve_dimensional
    else:
        _needed(("r2_star", "depth_star"), options, " or, with dimensions, --socket-radius, ...")
        solve = _solve_dimensionless
    options = cli.under_tilt(options.get("tilt"), options)
    if "tilt" in options:
        for name in ("solver", "tolerance"):
            if name in options:
                raise ValueError(f"{cli.flag(name)} must be left out beside --tilt")
    solve(as_json, **options)


def _needed(names, options, more=""):
    missing = [cli.flag(name) for name in names if name not in options]
    if missing:
        raise ValueError(f"{' and '.join(missing)} must be given{more}")


def _solve_dimensional(
    as_json, force=None, depth=None, liner=(), tolerance=0.01, tilt=None, **of_joint
):
    from study.choose.law import TOLERANCES
    from study.joint import DimensionalJoint, parsing

    _needed(SIZES, of_joint)
    checks.number("tolerance", tolerance, least=TOLERANCES[0], most=TOLERANCES[1])
    joint = DimensionalJoint(**of_joint, liner=tuple(map(parsing.liner, liner)))
    with working("Solving the joint"):
        if tilt is None:
            solution = joint.solve(force=force, depth=depth)
            values, parts = _described(joint, solution, tolerance)
        else:
            values, parts = _tilted(joint.solve_tilted(tilt, force=force, depth=depth))
    show(values, as_json, *parts)


def _solve_dimensionless(as_json, r2_star, depth_star, solver=None, tilt=None, **joint):
    from study.joint import force_curve, parsing, tilted_contact
    from study.joint.stress import largest as largest_stress

    solved_joint = parsing.joint(r2_star, **joint)
    if tilt is not None:
        with working("Solving the joint"):
            values, parts = _tilted(tilted_contact(solved_joint, depth_star, tilt))
        show(values, as_json, *parts)
        return
    with working("Solving the joint"):
        curve = force_curve(solved_joint, depth_star, solver=solver)
        stresses = largest_stress(curve)
    names = ("force_star", "contact_half_angle_deg", "peak_pressure_star", "error_estimate")
    depths = {"depth_star": depth_star}
    values = depths | {name: getattr(curve, name).tolist() for name in names}
    parts = [values]
    for body, largest in stresses.items():
        stress = {
            "star": largest.von_mises.tolist(),
            "over_peak": largest.over_peak.tolist(),
            "radius": largest.radius.tolist(),
            "place": list(largest.place),
            "angle_deg": np.degrees(largest.angle).tolist(),
        }
        values = values | {f"{_prefix(body)}_{name}": stress[name] for name in stress}
        table = depths | {"von_mises_star": stress.pop("star")} | stress
        parts += [f"Largest von Mises stress in the {body}:", table]
    for body in [name for name in solved_joint.materials if name not in stresses]:
        parts.append(f"Without stresses of the {body}: {HELD}")
    show(values, as_json, *parts)


def _tilted(contact):
    """One JSON object of a contact off the axis, whose fields are arrays, and its parts as text."""
    values = {name: x.tolist() for name, x in vars(contact).items() if name != "joint"}
    low, high = values.pop("contact_edges_deg")
    values |= {"contact_from_deg": low, "contact_to_deg": high}
    if "depth_star" in values:
        table = values
    else:
        table = {
            "depth um": _rounded(contact.depth / MICRO),
            "tilt deg": _rounded(contact.tilt),
            "force N": _rounded(contact.force),
            "transverse N": _rounded(contact.transverse),
            "stiffness N/um": _rounded(contact.stiffness * MICRO),
            "transverse_stiffness N/um": _rounded(contact.transverse_stiffness * MICRO),
            "peak_pressure MPa": _rounded(contact.peak_pressure / MEGA),
            "peak_at deg": _rounded(contact.peak_angle_deg),
            "contact_from deg": _rounded(low),
            "contact_to deg": _rounded(high),
            "error %": _rounded(contact.error_estimate / PERCENT, 2),
        }
    cut = bool(contact.reaches_mouth.any())
    told = ["The mouth cuts the contact: the pressure has no bound at its edge."] if cut else []
    return values, [table, *told]


def _prefix(body):
    """Beginning of the names of a body's stresses in JSON."""
    return f"von_mises_{body.replace(' ', '_')}"


def _described(joint, solution, tolerance):
    """One JSON object of a solved joint, and its parts as text."""
    plain = joint.joint
    columns = ("depth", "force", "stiffness", "contact_half_angle_deg", "peak_pressure")
    values = {name: getattr(solution, name).tolist() for name in (*columns, "error_estimate")}
    for body, stress in solution.von_mises.items():
        name, factor = _prefix(body), solution.yield_factor[body]
        values[name] = stress.tolist()
        values[f"{name}_place"] = list(solution.von_mises_place[body])
        values[name.replace("von_mises", "yield_factor")] = (
            None if factor is None else factor.tolist()
        )
    values |= {name: getattr(joint, name) for name in SIZES}
    values["materials"] = {body: vars(material) for body, material in joint.materials.items()}
    without = ("r2_star", "socket_ratio", "modulus_ratio", "composite_modulus")
    values |= {name: getattr(plain, name) for name in without}
    values["depth_star"] = (solution.depth / joint.clearance).tolist()
    law, text = _law(joint, float(solution.depth.max()), tolerance)
    parts = [_contact(solution), *_stresses(joint, solution), text]
    if joint.socket_radius >= LARGE:
        parts.append(f"The socket's radius is {joint.socket_radius:g} m: are the sizes in m?")
    return values | law, parts


def _contact(solution):
    return {
        "depth um": _rounded(solution.depth / MICRO),
        "force N": _rounded(solution.force),
        "stiffness N/um": _rounded(solution.stiffness * MICRO),
        "half_angle deg": _rounded(solution.contact_half_angle_deg),
        "peak_pressure MPa": _rounded(solution.peak_pressure / MEGA),
        "error %": _rounded(solution.error_estimate / PERCENT, 2),
    }


def _stresses(joint, solution):
    """Table with a row for each body at each depth, and which bodies it leaves out."""
    strengths = {body: material.yield_stress for body, material in joint.materials.items()}
    rows = [(k, body) for k in range(len(solution.depth)) for body in solution.von_mises]
    if left_out := [body for body in strengths if body not in solution.von_mises]:
        yield f"Without stresses of the {' and the '.join(left_out)}: {HELD}"
    if not rows:
        return
    yield {
        "depth um": _rounded(solution.depth[k] / MICRO for k, _ in rows),
        "body": [body for _, body in rows],
        "von_mises MPa": _rounded(solution.von_mises[body][k] / MEGA for k, body in rows),
        "place": [solution.von_mises_place[body][k] for k, body in rows],
        "yield_stress MPa": _rounded(
            strengths[body] and strengths[body] / MEGA for _, body in rows
        ),
        "factor_to_yield": _rounded(
            strengths[body] and solution.yield_factor[body][k] for k, body in rows
        ),
    }


def _rounded(values, digits=4):
    return [None if value is None else float(f"{value:.{digits}g}") for value in values]


def _percent(error):
    return f"{error / PERCENT:.2g} %"


def _law(joint, largest, tolerance):
    """The cheapest law within the tolerance up to a depth, as JSON and in words."""
    from study.choose.law import choose_beside

    plain = joint.joint
    try:
        choice = choose_beside(plain, largest / joint.clearance, tolerance)
    except (checks.StudyError, ValueError) as error:  # no checkout, or no law is known well enough
        none = {"law": None, "law_error_bound": None, "export": None}
        return none, f"No law is chosen: {error}"
    depths = [joint.clearance * depth for depth in choice.depths]
    least, most = _rounded(depth / MICRO for depth in depths)
    text = (
        f"The cheapest law that is within {_percent(tolerance)} from {least:g} to {most:g} um: "
        f"{NO_LAW.get(choice.law, choice.law)}. Its error is at most "
        f"{_percent(choice.error_bound)}."
    )
    best = min(choice.errors, key=choice.errors.__getitem__)
    if choice.errors[best] > tolerance:
        text += (
            f" No closed law is within it: {best} is the best, with an error up to "
            f"{_percent(choice.errors[best])}."
        )
    line = None
    if choice.law != "solver":
        line = f"study export --law {choice.law} --format c {described(plain, choice.depths[1])}"
        text += (
            f"\nTo take it into another program, with the clearance {joint.clearance:g} m and the "
            f"composite modulus {plain.composite_modulus:.9g} Pa:\n{line}"
        )
    values = {"law": choice.law, "law_error_bound": choice.error_bound, "law_depths": depths}
    return values | {"law_errors": choice.errors, "export": line}, text


def described(joint, deepest):
    """Options of study export that describe a joint without its dimensions."""
    from study.joint import Joint
    from study.joint.dimensional import usual_depth
    from study.joint.supports import SUPPORTS

    numbers = {"r2_star": joint.r2_star, "poisson": joint.ball.poisson}
    if not joint.layers:
        numbers |= {"socket_ratio": joint.socket_ratio, "modulus_ratio": joint.modulus_ratio}
        numbers |= {"socket_poisson": joint.socket.poisson}
    if deepest > usual_depth(joint):
        numbers["depth_star"] = deepest
    options = [f"{cli.flag(name)} {value:.9g}" for name, value in numbers.items()]
    usual = Joint(joint.r2_star, ball_drive=joint.ball_drive)
    supports = {name: getattr(joint, name) for name in SUPPORTS}
    for name, value in supports.items():
        if value != getattr(Joint if name == "ball_drive" else usual, name):
            options.append(f"{cli.flag(name)} {value}")
    layers = filter(None, joint.layers_text.split(";"))
    return " ".join([*options, *(f"--layer {layer.replace(':', ',')}" for layer in layers)])
