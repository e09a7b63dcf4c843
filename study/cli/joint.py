"""The command for a joint, with its dimensions or by its ratios: study joint."""

from pathlib import Path

import numpy as np

from study import checks
from study.checks import percent
from study.cli import options as cli
from study.cli.output import (
    SAME_BYTES,
    check_output,
    digits,
    drawn,
    in_mm,
    read_unit,
    show,
    working,
)
from study.contact.power_fit import USUAL_RANGE
from study.joint import limits
from study.joint import options as of_joint
from study.joint.axial import SOLVERS
from study.joint.solution import quantities
from study.parameters import READ, Quantity

HEADS = {"contact_half_angle_deg": "half_angle", "peak_angle_deg": "peak_at"}
"""Quantities with another head in the printed table."""
UNPRINTED = ("error_estimate", "formulation_error")
"""Quantities that are printed as their sum."""
AROUND = 5.0  # deg beyond the ends of a contact off the axis that are shown
BEYOND = 1.25  # times the largest depth and half-angle that are shown in a figure
DEFAULT_TOLERANCE, LEAST_TOLERANCE = 0.01, 1e-5
NEED_DIMENSIONS = ("force", "depth", "friction", "plot")
"""Options that need a joint with dimensions."""
ASKED = ("force", "depth", "depth_star", "tilt", "solver", "resolution")
"""Options that are arguments of `study.joint.Joint.solve`."""
FORCE = cli.option("--force", "Contact force in N; may be repeated.", float, "N", multiple=True)
DEPTH = cli.option("--depth", "Penetration depth in m; may be repeated.", float, "m", multiple=True)
TILT = cli.option(
    "--tilt",
    "Tilt: angle in deg between the axis of the socket and the displacement of the ball, or, with "
    "--force, the force. Default: 90 for a ring or a ball with a bore, else a load along the axis.",
    float,
    "deg",
)
SECTIONS = {
    "Load or depth": [FORCE, DEPTH, TILT, cli.DEPTHS],
    "Joint": [cli.SAVED],
    **cli.joint_sections(),
    "Elastic solution": [
        cli.option(
            "--solver",
            "Elastic solution: Legendre series of both bodies (series), or finite elements with "
            "six-node (quadratic) or three-node (linear) triangles. Default: series where it "
            "applies, else quadratic.",
            SOLVERS,
        ),
        cli.option(
            "--resolution",
            "Elements along a quarter circle. Default: 320 for the series, 160 for finite "
            "elements, 48 off the axis.",
            int,
        ),
    ],
    "Contact law": [
        cli.switch(
            "--law",
            "Also give the contact law of a joint without dimensions, or of a load off the axis, "
            "which takes some seconds.",
        ),
        cli.option(
            "--tolerance",
            "Maximum relative error of the contact law that is recommended. "
            f"Default: {DEFAULT_TOLERANCE:g}.",
            float,
        ),
    ],
    "Friction": [
        cli.option(
            "--friction",
            "Coefficient of friction (no unit). Prints the friction torques of a ball that slides "
            "over the whole contact while it rotates about the load (spin_torque) or about an axis "
            "perpendicular to the load (tilt_torque). For a load off the axis, tilt_torque is "
            "about the normal of the plane of load and axis, and turn_torque about the axis "
            "perpendicular to both others, which for a ring loaded across its axis is the axis of "
            "the ring.",
            float,
        )
    ],
    "Output": [
        cli.option(
            "--save",
            "TOML file for the joint, which --joint gives to the commands joint, law, choose, fit, "
            "export and sweep.",
            Path,
        ),
        cli.UNITS,
        cli.JSON,
        cli.option(
            "--plot", "File for a figure of force and pressure, ending in .png, .svg or .pdf.", Path
        ),
    ],
}


@cli.command(
    "joint",
    SECTIONS,
    examples=[
        "joint --socket-radius 12.5mm --clearance 40um --wall 6mm \\\n"
        "      --socket bronze --force 3kN",
        "joint --r2-star 200 --depth-star 0.3",
        "joint --socket-radius 12.5mm --play 80um --wall 6mm --save cup.toml",
    ],
)
def solve_joint(as_json, law, units="SI", **options):
    """Solve one joint: force, depth, stiffness, contact half-angle, pressure and stresses.

    Describe the joint either with its dimensions (--socket-radius, --clearance, --wall and
    materials by name) and give --force or --depth, or without dimensions by --r2-star and give
    --depth-star. A number may have its unit, such as 12.5mm, 40um, 3kN or 110GPa, and is in SI
    units without one. Each result has the estimated error of its force. The reference joint of the
    study is --r2-star 200 --ball-support clamped --rim free.

    For a joint with dimensions, the fastest contact law within --tolerance, the command that
    exports it, and a fitted power law F = k d^n are printed as well; for a load off the axis only
    with --law. Stresses of a joint without dimensions are in units of E* dR/R2.

    With --tilt, and always for a ring or a ball with a bore, the ball is pressed off the axis.
    Force and stiffness are then the components along the displacement; the transverse ones are
    perpendicular to it, and positive towards larger tilt.
    """
    asked = {name: options.pop(name) for name in ASKED if name in options}
    plot, friction, save = (options.pop(name, None) for name in ("plot", "friction", "save"))
    tolerance = options.pop("tolerance", None)
    check_output(plot, *SAME_BYTES, name="plot")
    check_output(save, ".toml", name="save")
    if friction is not None:
        checks.number("friction", friction, least=0)
    joint, words = cli.take_joint(options, off_axis="tilt" in asked)
    if not joint.has_dimensions:
        given = {"plot": plot, "friction": friction} | asked
        for name in NEED_DIMENSIONS:
            if given.get(name) is not None:
                raise ValueError(f"{name} is for a joint with dimensions, not for --r2-star")
    is_loaded = {"force", "depth", "depth_star"} & set(asked)
    if save is not None:
        of_joint.save(joint, save)
        if not is_loaded:
            print(f"The joint is in {save}; give it to other commands with: --joint {save}")
            return
    tilt = joint.default_tilt if asked.get("tilt") is None else asked["tilt"]
    for name, value in (("tolerance", tolerance), ("solver", asked.get("solver"))):
        if tilt is not None and value is not None:
            raise ValueError(f"{name} does not apply to a load off the axis; remove it")
    tolerance = DEFAULT_TOLERANCE if tolerance is None else tolerance
    checks.number("tolerance", tolerance, least=LEAST_TOLERANCE, most=1)
    if not is_loaded:
        raise ValueError(
            "force or depth must be given" if joint.has_dimensions else "depth_star must be given"
        )
    with working("Solving the joint"):
        solution = joint.solve(**asked | {"tilt": tilt}, stresses=True)
        values, parts = _described(solution, friction, units)
        if law or (joint.has_dimensions and tilt is None):
            found, texts = _laws(solution, tolerance, words, "depth" in asked)
            values, parts = values | found, [*parts, *texts]
        elif joint.has_dimensions:
            parts.append("For the contact law in this direction, add --law.")
        if plot is not None:
            draw(solution, plot)
    parts += [_assumptions(solution), *(f"Warning: {text}" for text in values["warnings"])]
    show(values, as_json, *parts)


def _described(solution, friction, units):
    """The solution as JSON, and as tables of what a person reads."""
    joint = solution.joint
    main = {
        name: (of, getattr(solution, name))
        for name, of in quantities(joint.has_dimensions).items()
        if getattr(solution, name) is not None
    }
    depth = {name: main[name] for name in ("depth", "depth_star") if name in main}
    tables, exceeded = [main], solution.limits
    if friction is not None:
        torque = Quantity("", "N m", "N m")
        torques = solution.friction_torque(friction).items()
        tables.append(depth | {f"{motion}_torque": (torque, of) for motion, of in torques})
        shares = friction * solution.friction_radius["spin"] / joint.socket_radius
        shares = map(limits.friction_limit, shares)
        exceeded = [of | more for of, more in zip(exceeded, shares, strict=True)]
    tables += [depth | _stresses(solution, body) for body in solution.stress]

    columns = {name: column for table in tables for name, column in table.items()}
    values = {name: in_mm(_listed(of), about.unit, units) for name, (about, of) in columns.items()}
    values["units"] = units
    values["materials"] = {
        body: vars(of)
        | {n: in_mm(getattr(of, n), "Pa", units) for n in ("youngs_modulus", "yield_stress")}
        for body, of in joint.materials.items()
    }
    values |= {name: getattr(joint, name) for name in ("r2_star", "socket_ratio", "modulus_ratio")}
    if joint.has_dimensions:
        sizes = ("socket_radius", "clearance", "wall")
        values |= {name: in_mm(getattr(joint, name), "m", units) for name in sizes}
    if solution.reaches_rim is not None:
        values["reaches_rim"] = solution.reaches_rim.tolist()
    values["composite_modulus"] = in_mm(joint.composite_modulus, "Pa", units)
    values["depth_star"] = solution.depth_star.tolist()
    values["applicability"] = [limits.in_short(found) for found in exceeded]
    sentences = limits.worst([exceeded[k] for k in np.argsort(solution.depth_star)])
    values["warnings"] = [*joint.warnings, *(of for of in sentences if of not in joint.warnings)]

    parts = [_printed(table, units) for table in tables]
    if left_out := [body for body in joint.materials if body not in solution.stress]:
        parts.append(
            f"No stresses of the {' and the '.join(left_out)} are given, because their maximum is "
            "where the body is held and depends on the details of the support."
        )
    return values, parts


def _stresses(solution, body):
    """Columns of the stresses of a body: their quantities and values by name."""
    largest, name = solution.stress[body], f"von_mises_{body.replace(' ', '_')}"
    columns = {f"{name}_place": (Quantity(""), list(largest.place))}
    if largest.error is not None:
        columns[f"{name}_error"] = Quantity("", read="%"), largest.error
    if solution.joint.has_dimensions:
        factor = name.replace("von_mises", "yield_factor")
        stress = Quantity("", "Pa", "MPa"), solution.von_mises[body]
        return {name: stress, factor: (Quantity(""), solution.yield_factor[body])} | columns
    return columns | {
        f"{name}_star": (Quantity("", read="E* dR/R2"), largest.von_mises),
        f"{name}_over_peak": (Quantity(""), largest.over_peak),
        f"{name}_radius": (Quantity(""), largest.radius),
        f"{name}_angle_deg": (Quantity("", "deg", "deg"), np.degrees(largest.angle)),
    }


def _listed(values):
    return values.tolist() if isinstance(values, np.ndarray) else values


def _printed(columns, units):
    """A table of values with their heads and in the units in which a person reads them."""
    table = {}
    for name, (about, values) in columns.items():
        if name in UNPRINTED or values is None:
            continue
        unit, size = read_unit(about, units)
        count = 2 if unit == "%" else 4
        head = f"{HEADS.get(name, name.removesuffix('_deg'))} {unit}".rstrip()
        table[head] = [of if isinstance(of, str) else digits(of / size, count) for of in values]
    return table


def _assumptions(solution):
    """The assumptions of the solution, and what the error of the force consists of."""
    load = "the load is along the axis"
    if solution.tilt is not None:
        load = f"the displacement is {solution.tilt.max():g} deg off the axis"
    of_r2_star = solution.formulation_error.max() * solution.joint.r2_star
    return (
        f"{solution.joint.socket_support.in_words()} Bodies are smooth and elastic, without "
        f"friction; {load}. The error of the force is the sum of the numerical error, at most "
        f"{percent(solution.error_estimate.max())}, and of the error of small displacements, "
        f"about {of_r2_star:.2g}/R2* or {percent(solution.formulation_error.max())}."
    )


def _laws(solution, tolerance, words, is_range):
    """Contact law and power law of the joint, as JSON and as sentences.

    The power law is fitted from 0.05 to 0.5 clearances, or between the given depths. A single given
    depth is the maximum, and the minimum is then a tenth of it.
    """
    joint, tilt = solution.joint, solution.direction_deg
    if tilt is None:
        values, text = _cheapest(joint, float(solution.depth_star.max()), tolerance, words)
    else:
        line = f"study export --law tabulated --tilt {tilt:g} --format c {words}"
        values = {"law": "tabulated", "tilt_of_law": tilt, "export": line}
        text = (
            f"Command that exports a table of the force along {tilt:g} deg for another program:\n"
            f"{line}"
        )
    if not joint.has_dimensions:
        return values, [text]
    least, most = joint.clearance * np.minimum(USUAL_RANGE, joint.default_depth)
    if is_range:
        least, most = float(solution.depth.min()), float(solution.depth.max())
    least = least if least <= most / 2 else most / 10
    power = joint.power_law((least, most), tilt)
    names = ("coefficient", "coefficient_mm", "exponent", "error", "depths")
    values["power_law"] = {name: getattr(power, name) for name in names}
    low, high = (digits(depth / READ["um"]) for depth in (least, most))
    sentence = (
        f"Fitted power law F = k d^n, within {percent(power.error)} at depths from {low:g} to "
        f"{high:g} um: n = {power.exponent:.5g} and k = {power.coefficient:.5g} N/m^n = "
        f"{power.coefficient_mm:.5g} N/mm^n."
    )
    if not is_range:
        sentence += " To fit another range, give its ends by --depth twice instead of the load."
    return values, [text, sentence]


def _cheapest(joint, deepest, tolerance, words):
    """The cheapest law within the tolerance up to a depth_star, as JSON and as sentences."""
    from study.choose import cheapest_law  # late: a load off the axis has no such law

    try:
        choice = cheapest_law.choose_beside(joint, deepest, tolerance)
    except (checks.StudyError, ValueError) as error:  # no law is known well enough
        none = {"law": None, "law_error_bound": None, "export": None}
        return none, f"No contact law is recommended: {error}"
    law, ends = choice.law.name, choice.depths
    depths, of_range = list(ends), "{:.4g} to {:.4g} clearances".format(*ends)
    if joint.has_dimensions:
        depths = [joint.clearance * depth for depth in ends]
        of_range = "{:g} to {:g} um".format(*(digits(depth / READ["um"]) for depth in depths))
    if law == "tabulated":
        law = "tabulated, the table of the elastic solution of this joint"
    line = f"study export --law {choice.law.name} --format c {words}"
    if ends[1] > joint.default_depth:
        line += f" --depth-star {ends[1]:.9g}"
    text = (
        f"The fastest contact law within {percent(tolerance)} of the elastic solution at depths "
        f"from {of_range} is {law}. Its relative error, with that of the solution, is at most "
        f"{percent(choice.error_bound)}."
        f"\nCommand that exports it for another program:\n{line}"
    )
    values = {"law": choice.law.name, "law_error_bound": choice.error_bound, "law_depths": depths}
    return values | {"law_errors": choice.errors, "export": line}, text


def draw(solution, path):
    """Draw the solved curve of a joint, the given depths and the pressure at each into a file."""
    micro, mega, tilt = READ["um"], READ["MPa"], solution.tilt
    law = solution.joint.law(tilt=None if tilt is None else float(tilt[0]))
    along = np.linspace(0, min(BEYOND * solution.depth.max(), law.deepest), 200)
    ends = 0, min(BEYOND * solution.contact_half_angle_deg.max(), solution.angle_deg[-1])
    if tilt is not None:
        low, high = solution.contact_from_deg.min(), solution.contact_to_deg.max()
        ends = np.clip([low - AROUND, high + AROUND], *solution.angle_deg[[0, -1]])
    with drawn(path) as (left, right):
        left.plot(along / micro, law.force(along), color="0.5", label="elastic solution")
        for depth, force, pressure in zip(
            solution.depth / micro, solution.force, solution.pressure / mega, strict=True
        ):
            label = f"{depth:.4g} µm, {digits(force):g} N"
            (point,) = left.plot(depth, force, "o", label=label)
            right.plot(solution.angle_deg, pressure, color=point.get_color())
        left.set(xlabel="penetration depth (µm)", ylabel="contact force (N)", xlim=0, ylim=0)
        right.set(xlabel="polar angle (deg)", ylabel="pressure (MPa)", xlim=ends, ylim=0)
        left.legend()


COMMANDS = {"joint": solve_joint}
