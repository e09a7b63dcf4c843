"""The command for a joint, with its dimensions in SI units or without: study joint."""

import shlex
from pathlib import Path
from typing import Literal

import numpy as np

from study import checks, parameters, paths
from study.choose import cheapest_law
from study.cli import options as cli
from study.cli.output import columns, show, working
from study.contact.power_fit import USUAL_RANGE
from study.joint import DimensionalJoint, RatioJoint, applicability, force_curve, tilted_contact
from study.joint.curve import SOLVERS
from study.joint.dimensional import usual_depth
from study.joint.stress import largest as largest_stress
from study.joint.supports import Configuration
from study.joint.tilted_stress import largest_off_axis

UNITS = {"um": 1e-6, "MPa": 1e6, "N/um": 1e6, "%": 0.01}
"""Units of printed numbers that are not those of the solution."""
HEADS = {
    "depth": "depth um",
    "tilt": "tilt deg",
    "force": "force N",
    "transverse": "transverse N",
    "stiffness": "stiffness N/um",
    "transverse_stiffness": "transverse_stiffness N/um",
    "contact_half_angle_deg": "half_angle deg",
    "peak_pressure": "peak_pressure MPa",
    "peak_error": "peak_error %",
    "peak_angle_deg": "peak_at deg",
    "contact_from_deg": "contact_from deg",
    "contact_to_deg": "contact_to deg",
    "error_estimate": "force_error %",
    "spin_torque": "spin_torque N m",
    "tilt_torque": "tilt_torque N m",
    "turn_torque": "turn_torque N m",
    "wear_depth": "wear_depth um",
    "body": "body",
    "von_mises": "von_mises MPa",
    "stress_error": "stress_error %",
    "place": "place",
    "yield_stress": "yield_stress MPa",
    "factor_to_yield": "factor_to_yield",
}
"""Values of a joint with its dimensions, in SI units -> heads of the printed table, in order."""
AROUND = 5.0  # deg beyond the ends of a contact off the axis that are shown
BEYOND = 1.25  # times the largest depth and half-angle that are shown in a figure
SAME_BYTES = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
DEFAULT_TOLERANCE = 0.01
LARGE = 1.0  # m: a socket's radius that is probably in mm
NO_LAW = {
    "tabulated": "tabulated, the table of the elastic solution of this joint",
    "solver": "none, so the joint has to be solved at every depth",
}
NO_STRESSES = (
    "No stresses of the {} are given, because their maximum is where the body is held and depends "
    "on the details of the support."
)
SIZED = cli.options_of(DimensionalJoint)
"""Options of a joint with its dimensions."""
RELATIVE = cli.options_of(RatioJoint)
"""Options of a joint without dimensions."""
ASKED = {
    "force": cli.further(list[float], "Contact force in N; may be repeated."),
    "depth": cli.further(list[float], "Penetration depth in m; may be repeated."),
    "tolerance": cli.further(
        float,
        "Maximum relative error of the contact law that is recommended. "
        f"Default: {DEFAULT_TOLERANCE:g}.",
    ),
    "friction": cli.further(
        float,
        "Coefficient of friction (no unit). Prints the friction torques of a ball that slides over "
        "the whole contact while it rotates about the load (spin_torque) or about an axis "
        "perpendicular to the load (tilt_torque). For a load off the axis, tilt_torque is about "
        "the normal of the plane of load and axis, and turn_torque about the axis perpendicular "
        "to both others, which for a ring loaded across its axis is the axis of the ring.",
    ),
    "wear": cli.further(
        float,
        "Wear coefficient in m^2/N. Prints Archard's wear depth at the peak of the pressure, which "
        "is assumed not to change with wear; --path is needed too.",
    ),
    "path": cli.further(float, "Sliding distance of the wear, in m."),
    "plot": cli.further(
        Path, "File for a figure of force and pressure, ending in .png, .svg or .pdf."
    ),
}
"""Options that only a joint with dimensions has: loads, and further results."""
EITHER = {
    **RELATIVE,
    **SIZED,
    **ASKED,
    "tilt": cli.further(
        float,
        "Tilt: angle in deg between the axis of the socket and the displacement of the ball, or, "
        "with --force, the force. Default: 90 for a ring or a ball with a bore, else a load along "
        "the axis.",
    ),
    "depth_star": cli.further(list[float], cli.DEPTHS),
    "solver": cli.further(
        Literal[SOLVERS],
        "Elastic solution: Legendre series of both bodies (series), or finite elements with "
        "six-node (quadratic) or three-node (linear) triangles. Default: series where it applies, "
        "else quadratic.",
    ),
}
CONFIGURATION = tuple(parameters.described(Configuration))
WITH_DIMENSIONS = (
    "; a joint with dimensions is described by --socket-radius, --clearance and --wall instead"
)
TWICE = " To fit another range, give --depth twice, for its minimum and its maximum."
SIZES = ("socket_radius", "clearance", "wall")
"""Options that a joint with dimensions needs."""
OF_SIZED = tuple(name for name in SIZED if name not in CONFIGURATION)
"""Options that only a joint with dimensions has."""
OF_PRESSURE = ("friction", "wear", "path")
ON_AXIS = ("force_star", "contact_half_angle_deg", "peak_pressure_star", "error_estimate")
OFF_AXIS = ("tilt", "force_star", "transverse_star", "stiffness_star", "transverse_stiffness_star")
OFF_AXIS += ("peak_pressure_star", "peak_error", "peak_angle_deg", "reaches_rim", "error_estimate")


@cli.command(
    "joint",
    sections={
        "Load or depth": ("force", "depth", "tilt", "depth_star"),
    }
    | cli.SECTIONS
    | {
        "Contact law": ("tolerance",),
        "Friction and wear": ("friction", "wear", "path"),
        "Output": ("as_json", "plot"),
    },
    examples=[
        "joint --socket-radius 12.5e-3 --clearance 40e-6 --wall 6e-3 \\\n"
        "      --socket bronze --force 3000",
        "joint --r2-star 200 --depth-star 0.3",
    ],
)
def solve_joint(as_json: bool = cli.JSON, **options: EITHER):
    """Solve one joint: force, depth, stiffness, contact half-angle, pressure and stresses.

    Describe the joint either with its dimensions in SI units (--socket-radius, --clearance, --wall
    and materials by name) and give --force or --depth, or without dimensions by --r2-star and give
    --depth-star. Each result has the estimated error of its force.

    A joint with dimensions is answered with the fastest contact law within --tolerance, the
    command that exports it, and a fitted power law F = k d^n. Stresses of a joint without
    dimensions are in units of E* dR/R2, and their radius is relative to the surface of the body.

    With --tilt, and always for a ring or a ball with a bore, the ball is pressed off the axis.
    Force and stiffness are then the components along the displacement; the transverse ones are
    perpendicular to it, and positive towards larger tilt.
    """
    if dimensions := [name for name in (*OF_SIZED, *ASKED) if name in options]:
        _only_sizes(options, dimensions[0], (*OF_SIZED, *ASKED, "tilt"))
        solve = _solve_dimensional
    else:
        needed(("r2_star", "depth_star"), options, WITH_DIMENSIONS)
        solve = _solve_dimensionless
    solve(as_json, **cli.under_tilt(options.get("tilt"), options))


def needed(names, options, more=""):
    """Raise ``ValueError`` if one of some options is missing."""
    missing = [cli.flag(name) for name in names if name not in options]
    if missing:
        raise ValueError(f"{' and '.join(missing)} must be given{more}")


def _only_sizes(options, first, allowed):
    """Raise ``ValueError`` for an option that a joint with dimensions does not have."""
    for name in options:
        if name not in (*allowed, *CONFIGURATION):
            raise ValueError(
                f"{cli.flag(name)} is for a joint without dimensions and {cli.flag(first)} for a "
                "joint with dimensions; remove one of them"
            )


def sized(options):
    """Joint with dimensions from the options `SIZED` of a command."""
    first = next((name for name in OF_SIZED if name in options), SIZES[0])
    _only_sizes(options, first, OF_SIZED)
    needed(SIZES, options)
    return DimensionalJoint(**options)


def _solve_dimensional(
    as_json, force=None, depth=None, tolerance=None, tilt=None, plot=None, **of_joint
):
    of_pressure = {name: of_joint.pop(name) for name in OF_PRESSURE if name in of_joint}
    if "wear" in of_pressure or "path" in of_pressure:
        needed(("wear", "path"), of_pressure)
    if plot is not None:
        cli.check_output(plot, *SAME_BYTES, name="plot")
    for name, value in of_pressure.items():
        checks.number(name, value, "m" if name == "path" else "", least=0)
    joint = sized(of_joint)
    tilt = joint.default_tilt if tilt is None else tilt
    _only_along_axis(tilt, tolerance=tolerance)
    tolerance = DEFAULT_TOLERANCE if tolerance is None else tolerance
    least, most = cheapest_law.TOLERANCES
    checks.number("tolerance", tolerance, least=least, most=most)
    with working("Solving the joint"):
        solution = joint.solve(force=force, depth=depth, tilt=tilt)
        of_power = None if depth is None else solution.depth
        asked = tolerance, typed(of_joint), of_pressure, of_power
        values, parts = _described(joint, solution, tilt, *asked)
        if plot is not None:
            draw(joint, solution, tilt, plot)
    show(values, as_json, *parts)


def _only_along_axis(tilt, **options):
    """Raise ``ValueError`` for options that do not apply to a load off the axis."""
    for name, value in options.items():
        if tilt is not None and value is not None:
            raise ValueError(f"{cli.flag(name)} does not apply to a load off the axis; remove it")


def _solve_dimensionless(as_json, r2_star, depth_star, solver=None, tilt=None, **joint):
    solved_joint = RatioJoint(r2_star=r2_star, **joint).joint()
    tilt = solved_joint.default_tilt if tilt is None else tilt
    _only_along_axis(tilt, solver=solver)
    with working("Solving the joint"):
        if tilt is None:
            solved = force_curve(solved_joint, depth_star, solver=solver)
            stresses, exceeded = largest_stress(solved), applicability.of_curve(solved)
            values, parts = _without_dimensions(solved, ON_AXIS, stresses, exceeded)
        else:
            solved = tilted_contact(solved_joint, depth_star, tilt)
            stresses, exceeded = largest_off_axis(solved), applicability.of_contact(solved)
            values, parts = _without_dimensions(solved, OFF_AXIS, stresses, exceeded, tilt)
    show(values, as_json, *parts)


def _without_dimensions(solved, names, stresses, exceeded, tilt=None):
    """One JSON object of what is solved without dimensions, and its parts as text."""
    depths = {"depth_star": solved.depth_star.tolist()}
    values = depths | {name: getattr(solved, name).tolist() for name in names}
    if tilt is not None:
        values |= _ends(solved)
    table = {{"error_estimate": "force_error"}.get(name, name): x for name, x in values.items()}
    parts = [table]
    for body, largest in stresses.items():
        stress = {
            "star": largest.von_mises.tolist(),
            "over_peak": largest.over_peak.tolist(),
            "radius": largest.radius.tolist(),
            "place": list(largest.place),
            **({} if largest.error is None else {"error": largest.error.tolist()}),
            "angle_deg": np.degrees(largest.angle).tolist(),
        }
        values |= {f"{_prefix(body)}_{name}": stress[name] for name in stress}
        table = depths | {"von_mises_star": stress.pop("star")} | stress
        parts += [f"Maximum von Mises stress in the {body}:", table]
    for body in [name for name in solved.joint.materials if name not in stresses]:
        parts.append(NO_STRESSES.format(body))
    values["applicability"] = [applicability.in_short(found) for found in exceeded]
    return values, [*parts, *_limits(solved.joint, solved.depth_star, exceeded, tilt)]


def _ends(solved):
    """Where a contact off the axis ends, in deg."""
    low, high = solved.contact_edges_deg.tolist()
    return {"contact_from_deg": low, "contact_to_deg": high}


def _printed(values):
    """A table of values, in the units of `HEADS`."""
    return {
        head: [_rounded(value, head.partition(" ")[2]) for value in values[name]]
        for name, head in HEADS.items()
        if name in values
    }


def _rounded(value, unit):
    """A number in a unit with 4 digits, or 2 of an error; another value as it is."""
    if value is None or isinstance(value, str):
        return value
    digits = 2 if unit == "%" else 4
    return float(f"{value / UNITS.get(unit, 1):.{digits}g}")


def _prefix(body):
    """Beginning of the names of a body's stresses in JSON."""
    return f"von_mises_{body.replace(' ', '_')}"


def typed(options):
    """Options of a joint, as they are typed on the command line."""
    words = []
    for name, value in options.items():
        for one in value if isinstance(value, list) else [value]:
            words += [cli.flag(name), f"{one:.9g}" if isinstance(one, float) else shlex.quote(one)]
    return " ".join(words)


def _described(joint, solution, tilt, tolerance, typed, of_pressure, of_power):
    """One JSON object of a solved joint, and its parts as text."""
    plain, limits = joint.joint, _limits_of(joint, solution, **of_pressure)
    names = ("depth", "force", "stiffness", "contact_half_angle_deg", "peak_pressure")
    if tilt is not None:
        names += ("tilt", "transverse", "transverse_stiffness", "peak_angle_deg", "peak_error")
    values = {name: getattr(solution, name).tolist() for name in (*names, "error_estimate")}
    if tilt is not None:
        values |= _ends(solution) | {"reaches_rim": solution.reaches_rim.tolist()}
    for body, stress in solution.von_mises.items():
        name, factor = _prefix(body), solution.yield_factor[body]
        values[name] = stress.tolist()
        values[f"{name}_place"] = list(solution.von_mises_place[body])
        if tilt is not None:
            values[f"{name}_error"] = solution.von_mises_error[body].tolist()
        values[name.replace("von_mises", "yield_factor")] = (
            None if factor is None else factor.tolist()
        )
    values |= {name: getattr(joint, name) for name in SIZES}
    values["materials"] = {body: vars(material) for body, material in joint.materials.items()}
    without = ("r2_star", "socket_ratio", "modulus_ratio", "composite_modulus")
    values |= {name: getattr(plain, name) for name in without}
    values["depth_star"] = (solution.depth / joint.clearance).tolist()
    values["applicability"] = [applicability.in_short(found) for found in limits]
    if tilt is None:
        law, text = _law(joint, float(solution.depth.max()), tolerance, typed)
    else:
        tilt = float(f"{solution.tilt[solution.depth.argmax()]:.4g}")  # of the displacement
        line = f"study export --law tabulated --direction {tilt:g} --format c {typed}"
        law = {"law": "tabulated", "direction": tilt, "export": line}
        text = (
            f"Command that exports a table of the force along {tilt:g} deg for another program:\n"
            f"{line}"
        )
    power, two_numbers = _power(joint, tilt, of_power)
    more = _of_pressure(solution, **of_pressure)
    parts = [_printed(values)]
    if more:
        parts.append(_printed({"depth": solution.depth} | more))
    parts += [*_stresses(joint, solution, tilt), text, two_numbers]
    parts += _limits(plain, solution.depth, limits, tilt)
    if joint.socket_radius >= LARGE:
        parts.append(
            f"Warning: The radius of the socket is {joint.socket_radius:g} m; check that all "
            "dimensions are in m, not in mm."
        )
    return values | power | law | more, parts


def _limits(joint, depth, limits, tilt):
    """The assumptions of the solution, and the model limits that are exceeded."""
    held, load = joint.socket_support.in_words(), "the load is along the axis"
    if tilt is not None:
        load = f"the displacement is {tilt:g} deg off the axis"
    yield f"{held} Bodies are smooth and elastic, without friction; {load}."
    ordered = [limits[k] for k in np.argsort(depth)]
    for sentence in applicability.worst(ordered):
        yield f"Warning: {sentence}"


def _power(joint, tilt, depths=None):
    """The fitted power law, as JSON and as a sentence.

    It is fitted from 0.05 to 0.5 clearances, or between the given depths. A single given depth is
    the maximum, and the minimum is then a tenth of it.
    """
    if depths is None:
        least, most = joint.clearance * np.minimum(USUAL_RANGE, usual_depth(joint.joint))
    else:
        least, most = float(depths.min()), float(depths.max())
    least = least if least <= most / 2 else most / 10
    law = joint.power_law((least, most), tilt)
    names = ("coefficient", "coefficient_mm", "exponent", "error", "depths")
    low, high = _rounded(least, "um"), _rounded(most, "um")
    return {"power_law": {name: getattr(law, name) for name in names}}, (
        f"Fitted power law F = k d^n, within {_percent(law.error)} at depths from {low:g} to "
        f"{high:g} um: n = {law.exponent:.5g} and k = {law.coefficient:.5g} N/m^n = "
        f"{law.coefficient_mm:.5g} N/mm^n."
        + (
            ""
            if depths is not None
            else " To fit another range, give --depth twice, for its minimum and its maximum."
        )
    )


def _limits_of(joint, solution, friction=0.0, wear=0.0, path=0.0):
    """Model limits that each contact exceeds, with those of its friction and wear."""
    shares = friction * solution.friction_radius["spin"] / joint.socket_radius
    worn = solution.wear_depth(wear, path).max(axis=1) / joint.clearance
    return [
        found | applicability.friction_limit(share) | applicability.wear_limit(depth)
        for found, share, depth in zip(solution.limits, shares, worn, strict=True)
    ]


def _of_pressure(solution, friction=None, wear=None, path=None):
    """Friction torques and wear depths, if their coefficients are given."""
    values = {}
    if friction is not None:
        for motion, torque in solution.friction_torque(friction).items():
            values[f"{motion}_torque"] = torque.tolist()
    if wear is not None:
        values["wear_depth"] = solution.wear_depth(wear, path).max(axis=1).tolist()
    return values


def _stresses(joint, solution, tilt):
    """Table with a row for each body at each depth, and a sentence on bodies without stresses."""
    factors = solution.yield_factor
    errors = None if tilt is None else solution.von_mises_error
    if left_out := [body for body in joint.materials if body not in solution.von_mises]:
        yield NO_STRESSES.format(" and the ".join(left_out))
    rows = [
        {
            "depth": depth,
            "body": body,
            "von_mises": stress[k],
            **({"stress_error": errors[body][k]} if errors else {}),
            "place": solution.von_mises_place[body][k],
            "yield_stress": joint.materials[body].yield_stress,
            "factor_to_yield": None if factors[body] is None else factors[body][k],
        }
        for k, depth in enumerate(solution.depth)
        for body, stress in solution.von_mises.items()
    ]
    if rows:
        yield _printed(columns(rows))


def _percent(error):
    return f"{error / UNITS['%']:.2g} %"


def _law(joint, largest, tolerance, typed):
    """The cheapest law within the tolerance up to a depth, as JSON and as sentences."""
    plain = joint.joint
    try:
        choice = cheapest_law.choose_beside(plain, largest / joint.clearance, tolerance)
    except (checks.StudyError, ValueError) as error:  # no law is known well enough
        none = {"law": None, "law_error_bound": None, "export": None}
        return none, f"No contact law is recommended: {error}"
    depths = [joint.clearance * depth for depth in choice.depths]
    least, most = (_rounded(depth, "um") for depth in depths)
    text = (
        f"The fastest contact law within {_percent(tolerance)} of the elastic solution at depths "
        f"from {least:g} to {most:g} um is {NO_LAW.get(choice.law, choice.law)}. Its relative "
        f"error is at most {_percent(choice.error_bound)}."
    )
    best = min(choice.errors, key=choice.errors.__getitem__)
    if choice.errors[best] > tolerance:
        text += (
            f" No closed-form law is within this tolerance: the best is {best}, with an error of "
            f"up to {_percent(choice.errors[best])}."
        )
    line = None
    if choice.law != "solver":
        line = f"study export --law {choice.law} --format c {typed}"
        if choice.depths[1] > usual_depth(plain):
            line += f" --depth {joint.clearance * choice.depths[1]:.9g}"
        text += f"\nCommand that exports it for another program:\n{line}"
    values = {"law": choice.law, "law_error_bound": choice.error_bound, "law_depths": depths}
    return values | {"law_errors": choice.errors, "export": line}, text


def draw(joint, solution, tilt, path):
    """Draw the solved curve of a joint, the given depths and the pressure at each into a file."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from study.pages.figures import STYLE

    micro, mega = UNITS["um"], UNITS["MPa"]
    depths, forces = solution.depth / micro, solution.force
    law = joint.law(tilt=tilt)
    along = np.linspace(0, min(BEYOND * solution.depth.max(), law.deepest), 200)
    ends = 0, min(BEYOND * solution.contact_half_angle_deg.max(), solution.angle_deg[-1])
    if tilt is not None:
        ends = np.clip(
            [solution.contact_edges_deg.min() - AROUND, solution.contact_edges_deg.max() + AROUND],
            *solution.angle_deg[[0, -1]],
        )
    with mpl.rc_context(STYLE | {"svg.hashsalt": path.stem}):
        figure = Figure(figsize=(8.4, 3.4))
        left, right = figure.subplots(1, 2)
        left.plot(along / micro, law.force(along), color="0.5", label="elastic solution")
        for depth, force, pressure in zip(depths, forces, solution.pressure / mega, strict=True):
            label = f"{depth:.4g} µm, {float(f'{force:.4g}'):g} N"
            (point,) = left.plot(depth, force, "o", label=label)
            right.plot(solution.angle_deg, pressure, color=point.get_color())
        left.set(xlabel="penetration depth (µm)", ylabel="contact force (N)", xlim=0, ylim=0)
        right.set(xlabel="polar angle (deg)", ylabel="pressure (MPa)", xlim=ends, ylim=0)
        left.legend()
        with paths.whole(path) as temporary:
            figure.savefig(temporary, metadata=SAME_BYTES[path.suffix])
