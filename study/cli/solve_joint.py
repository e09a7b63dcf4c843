"""The command for a joint, with its dimensions in SI units or by its ratios: study joint."""

import shlex
from pathlib import Path
from typing import Literal

import numpy as np

from study import checks, paths
from study.cli import options as cli
from study.cli.output import columns, show, working
from study.contact.power_fit import USUAL_RANGE
from study.joint import Joint, limits
from study.joint.axial import SOLVERS
from study.joint.joint import SUPPORTS
from study.joint.solution import quantities
from study.parameters import READ, Quantity

HEADS = {"contact_half_angle_deg": "half_angle", "peak_angle_deg": "peak_at"}
"""Quantities with another head in the printed table."""
UNPRINTED = ("error_estimate", "formulation_error")
"""Quantities that are printed as their sum."""
AROUND = 5.0  # deg beyond the ends of a contact off the axis that are shown
BEYOND = 1.25  # times the largest depth and half-angle that are shown in a figure
SAME_BYTES = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
DEFAULT_TOLERANCE, LEAST_TOLERANCE = 0.01, 1e-5
LARGE = 1.0  # m: a socket's radius that is probably in mm
TABULATED = "tabulated, the table of the elastic solution of this joint"
NO_STRESSES = (
    "No stresses of the {} are given, because their maximum is where the body is held and depends "
    "on the details of the support."
)
SIZES = ("socket_radius", "clearance", "wall")
"""Options that a joint with dimensions needs."""
OF_SIZED = (*SIZES, "ball", "socket", "liner")
"""Options that only a joint with dimensions has."""
SIZED = cli.options_of(Joint)
"""Options of a joint with its dimensions."""
OF_RATIOS = {"layers": "layer"}
"""Arguments of `Joint.from_ratios` whose option has another name."""
RELATIVE = {
    OF_RATIOS.get(name, name): option for name, option in cli.options_of(Joint.from_ratios).items()
} | {name: SIZED[name] for name in SUPPORTS}
"""Options of a joint without dimensions."""
ASKED = {
    "force": cli.further(list[float], "Contact force in N; may be repeated."),
    "depth": cli.further(list[float], "Penetration depth in m; may be repeated."),
    "depth_star": cli.further(list[float], cli.DEPTHS),
    "tilt": cli.further(
        float,
        "Tilt: angle in deg between the axis of the socket and the displacement of the ball, or, "
        "with --force, the force. Default: 90 for a ring or a ball with a bore, else a load along "
        "the axis.",
    ),
    "solver": cli.further(
        Literal[SOLVERS],
        "Elastic solution: Legendre series of both bodies (series), or finite elements with "
        "six-node (quadratic) or three-node (linear) triangles. Default: series where it applies, "
        "else quadratic.",
    ),
    "resolution": cli.further(
        int,
        "Elements along a quarter circle. Default: 320 for the series, 160 for finite elements, "
        "48 off the axis.",
    ),
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
    "plot": cli.further(
        Path, "File for a figure of force and pressure, ending in .png, .svg or .pdf."
    ),
}
"""Loads, and what else can be asked of a joint."""
NEED_SIZES = ("force", "depth", "friction", "plot")
"""Options that need a joint with dimensions."""
EITHER = {**RELATIVE, **SIZED, **ASKED}


@cli.command(
    "joint",
    sections={
        "Load or depth": ("force", "depth", "tilt", "depth_star"),
    }
    | cli.SECTIONS
    | {
        "Contact law": ("law", "tolerance"),
        "Friction": ("friction",),
        "Output": ("as_json", "plot"),
    },
    examples=[
        "joint --socket-radius 12.5e-3 --clearance 40e-6 --wall 6e-3 \\\n"
        "      --socket bronze --force 3000",
        "joint --r2-star 200 --depth-star 0.3",
    ],
)
def solve_joint(
    as_json: bool = cli.JSON,
    law: bool = cli.switch(
        "--law",
        "Also give the contact law of a joint without dimensions, or of a load off the axis, which "
        "takes some seconds.",
    ),
    **options: EITHER,
):
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
    asked = {name: options.pop(name) for name in ASKED if name in options}
    wanted = [n for n in (*NEED_SIZES, "depth_star") if n in asked] or ["depth_star"]
    plot, friction = asked.pop("plot", None), asked.pop("friction", None)
    tolerance = asked.pop("tolerance", None)
    if plot is not None:
        cli.check_output(plot, *SAME_BYTES, name="plot")
    if friction is not None:
        checks.number("friction", friction, least=0)
    joint = joint_of(cli.under_tilt(asked.get("tilt"), options), wanted[0])
    tilt = joint.default_tilt if asked.get("tilt") is None else asked["tilt"]
    for name, value in (("tolerance", tolerance), ("solver", asked.get("solver"))):
        if tilt is not None and value is not None:
            raise ValueError(f"{cli.flag(name)} does not apply to a load off the axis; remove it")
    tolerance = DEFAULT_TOLERANCE if tolerance is None else tolerance
    checks.number("tolerance", tolerance, least=LEAST_TOLERANCE, most=1)
    with working("Solving the joint"):
        solution = joint.solve(**asked | {"tilt": tilt}, stresses=True)
        values, parts = _described(solution, friction)
        if law or (joint.has_dimensions and tilt is None):
            found, texts = _laws(solution, tolerance, typed(options), "depth" in asked)
            values, parts = values | found, [*parts, *texts]
        elif joint.has_dimensions:
            parts.append("For the contact law in this direction, add --law.")
        values["warnings"] = _warnings(solution, friction)
        if plot is not None:
            draw(solution, plot)
    parts += [_assumptions(solution), *(f"Warning: {text}" for text in values["warnings"])]
    show(values, as_json, *parts)


def needed(names, options, more=""):
    """Raise ``ValueError`` if one of some options is missing."""
    missing = [cli.flag(name) for name in names if name not in options]
    if missing:
        raise ValueError(f"{' and '.join(missing)} must be given{more}")


def joint_of(options, *others):
    """Joint of its options, with dimensions or by ratios; ``others`` are further options given."""
    sized = [name for name in (*OF_SIZED, *NEED_SIZES) if name in (*options, *others)]
    by_ratios = [name for name in options if name not in (*OF_SIZED, *SUPPORTS)]
    if sized and by_ratios:
        raise ValueError(
            f"{cli.flag(by_ratios[0])} is for a joint without dimensions and {cli.flag(sized[0])} "
            "for a joint with dimensions; remove one of them"
        )
    if sized:
        needed(SIZES, options)
        return Joint(**options)
    needed(
        ("r2_star", *(name for name in others if name not in NEED_SIZES)),
        {*options, *others},
        "; a joint with dimensions is described by --socket-radius, --clearance and --wall instead",
    )
    names = {option: name for name, option in OF_RATIOS.items()}
    return Joint.from_ratios(**{names.get(name, name): of for name, of in options.items()})


def typed(options):
    """Options of a joint, as they are typed on the command line."""
    words = []
    for name, value in options.items():
        for one in value if isinstance(value, list) else [value]:
            words += [cli.flag(name), f"{one:.9g}" if isinstance(one, float) else shlex.quote(one)]
    return " ".join(words)


def _described(solution, friction):
    """One JSON object of a solution, and its parts as text."""
    joint, about = solution.joint, quantities(solution.joint.has_dimensions)
    about = {name: of for name, of in about.items() if getattr(solution, name) is not None}
    values = {name: getattr(solution, name).tolist() for name in about}
    parts = [_printed(values, {n: of for n, of in about.items() if n not in UNPRINTED})]
    if solution.reaches_rim is not None:
        values["reaches_rim"] = solution.reaches_rim.tolist()
    if friction is not None:
        torques = solution.friction_torque(friction).items()
        torques = {f"{motion}_torque": torque.tolist() for motion, torque in torques}
        depth = next(iter(about))
        newton_metre = dict.fromkeys(torques, Quantity("Friction torque", "N m", "N m"))
        parts.append(_printed(values | torques, {depth: about[depth]} | newton_metre))
        values |= torques
    values |= _stresses(solution)
    parts += _stress_tables(solution)
    if joint.has_dimensions:
        values |= {name: getattr(joint, name) for name in SIZES}
        values["materials"] = {body: vars(material) for body, material in joint.materials.items()}
    ratios = ("r2_star", "socket_ratio", "modulus_ratio", "composite_modulus")
    values |= {name: getattr(joint, name) for name in ratios}
    values["depth_star"] = solution.depth_star.tolist()
    exceeded = _exceeded(solution, friction)
    values["applicability"] = [limits.in_short(found) for found in exceeded]
    return values, parts


def _printed(values, about):
    """A table of values with their heads and in the units in which a person reads them."""
    table = {}
    for name, of in about.items():
        head = f"{HEADS.get(name, name.removesuffix('_deg'))} {of.read}".rstrip()
        table[head] = [_rounded(value, of) for value in values[name]]
    return table


def _rounded(value, quantity):
    """A number in the unit in which it is read, with 4 digits, or 2 of an error."""
    digits = 2 if quantity.read == "%" else 4
    return float(f"{value / quantity.scale:.{digits}g}")


def _micrometres(depth):
    return float(f"{depth / READ['um']:.4g}")


def _percent(error):
    return f"{100 * error:.2g} %"


def _stresses(solution):
    """Stresses as JSON, by the body."""
    values, factors = {}, solution.yield_factor
    for body, largest in solution.stress.items():
        name = f"von_mises_{body.replace(' ', '_')}"
        values[f"{name}_place"] = list(largest.place)
        if largest.error is not None:
            values[f"{name}_error"] = largest.error.tolist()
        if solution.joint.has_dimensions:
            factor = factors[body]
            values[name] = solution.von_mises[body].tolist()
            factor = None if factor is None else factor.tolist()
            values[name.replace("von_mises", "yield_factor")] = factor
        else:
            values[f"{name}_star"] = largest.von_mises.tolist()
            values[f"{name}_over_peak"] = largest.over_peak.tolist()
            values[f"{name}_radius"] = largest.radius.tolist()
            values[f"{name}_angle_deg"] = np.degrees(largest.angle).tolist()
    return values


def _stress_tables(solution):
    """Table with a row for each body at each depth, and a sentence on bodies without stresses."""
    joint, stress, factors = solution.joint, solution.stress, solution.yield_factor
    if left_out := [body for body in joint.materials if body not in stress]:
        yield NO_STRESSES.format(" and the ".join(left_out))
    rows = []
    for k, depth_star in enumerate(solution.depth_star):
        for body, of in stress.items():
            row = {"depth_star": float(depth_star), "body": body}
            if joint.has_dimensions:
                row = {"depth um": _micrometres(solution.depth[k]), "body": body}
                row["von_mises MPa"] = float(f"{solution.von_mises[body][k] / READ['MPa']:.4g}")
            else:
                row["von_mises_star"] = float(f"{of.von_mises[k]:.4g}")
            if of.error is not None:
                row["stress_error %"] = float(f"{100 * of.error[k]:.2g}")
            row["place"] = of.place[k]
            if joint.has_dimensions:
                strength, factor = joint.materials[body].yield_stress, factors[body]
                row["yield_stress MPa"] = strength and float(f"{strength / READ['MPa']:.4g}")
                row["factor_to_yield"] = None if factor is None else float(f"{factor[k]:.4g}")
            else:
                row["over_peak"] = float(f"{of.over_peak[k]:.4g}")
                row["radius"] = float(f"{of.radius[k]:.4g}")
                row["angle deg"] = float(f"{np.degrees(of.angle[k]):.4g}")
            rows.append(row)
    if rows:
        yield columns(rows)


def _exceeded(solution, friction):
    """Model limits that each contact exceeds, with that of friction."""
    found = solution.limits
    if friction is None:
        return found
    shares = friction * solution.friction_radius["spin"] / solution.joint.socket_radius
    return [of | limits.friction_limit(share) for of, share in zip(found, shares, strict=True)]


def _warnings(solution, friction):
    """A sentence for each model limit that a contact exceeds, and on sizes in another unit."""
    exceeded, radius = _exceeded(solution, friction), solution.joint.socket_radius
    found = limits.worst([exceeded[k] for k in np.argsort(solution.depth_star)])
    if solution.joint.has_dimensions and radius >= LARGE:
        found.append(
            f"The radius of the socket is {radius:g} m; check that all dimensions are in m, not in "
            "mm."
        )
    return found


def _assumptions(solution):
    """The assumptions of the solution, and what the error of the force consists of."""
    load = "the load is along the axis"
    if solution.tilt is not None:
        load = f"the displacement is {solution.tilt.max():g} deg off the axis"
    of_r2_star = solution.formulation_error.max() * solution.joint.r2_star
    return (
        f"{solution.joint.socket_support.in_words()} Bodies are smooth and elastic, without "
        f"friction; {load}. The error of the force is the sum of the numerical error, at most "
        f"{_percent(solution.error_estimate.max())}, and of the error of small displacements, "
        f"about {of_r2_star:.2g}/R2* or {_percent(solution.formulation_error.max())}."
    )


def _laws(solution, tolerance, words, is_range):
    """Contact laws for the joint, as JSON and as sentences."""
    joint, tilt = solution.joint, solution.direction_deg
    if tilt is None:
        law, text = _cheapest(joint, float(solution.depth_star.max()), tolerance, words)
    else:
        line = f"study export --law tabulated --tilt {tilt:g} --format c {words}"
        law = {"law": "tabulated", "tilt_of_law": tilt, "export": line}
        text = (
            f"Command that exports a table of the force along {tilt:g} deg for another program:\n"
            f"{line}"
        )
    if not joint.has_dimensions:
        return law, [text]
    power, sentence = _power(joint, tilt, solution.depth if is_range else None)
    return law | power, [text, sentence]


def _power(joint, tilt, depths):
    """The fitted power law, as JSON and as a sentence.

    It is fitted from 0.05 to 0.5 clearances, or between the given depths. A single given depth is
    the maximum, and the minimum is then a tenth of it.
    """
    if depths is None:
        least, most = joint.clearance * np.minimum(USUAL_RANGE, joint.default_depth)
    else:
        least, most = float(depths.min()), float(depths.max())
    least = least if least <= most / 2 else most / 10
    law = joint.power_law((least, most), tilt)
    names = ("coefficient", "coefficient_mm", "exponent", "error", "depths")
    text = (
        f"Fitted power law F = k d^n, within {_percent(law.error)} at depths from "
        f"{_micrometres(least):g} to {_micrometres(most):g} um: n = {law.exponent:.5g} and k = "
        f"{law.coefficient:.5g} N/m^n = {law.coefficient_mm:.5g} N/mm^n."
    )
    if depths is None:
        text += " To fit another range, give --depth twice, for its minimum and its maximum."
    return {"power_law": {name: getattr(law, name) for name in names}}, text


def _cheapest(joint, deepest, tolerance, words):
    """The cheapest law within the tolerance up to a depth_star, as JSON and as sentences."""
    from study.choose import cheapest_law  # late: a load off the axis has no such law

    try:
        choice = cheapest_law.choose_beside(joint, deepest, tolerance)
    except (checks.StudyError, ValueError) as error:  # no law is known well enough
        none = {"law": None, "law_error_bound": None, "export": None}
        return none, f"No contact law is recommended: {error}"
    depths, of_range = list(choice.depths), "{:.4g} to {:.4g} clearances".format(*choice.depths)
    if joint.has_dimensions:
        depths = [joint.clearance * depth for depth in depths]
        of_range = "{:g} to {:g} um".format(*map(_micrometres, depths))
    law = choice.law.name
    name = TABULATED if law == "tabulated" else law
    text = (
        f"The fastest contact law within {_percent(tolerance)} of the elastic solution at depths "
        f"from {of_range} is {name}. Its relative error is at most {_percent(choice.error_bound)}."
    )
    best = min(choice.errors, key=choice.errors.__getitem__)
    if choice.errors[best] > tolerance:
        text += (
            f" No closed-form law is within this tolerance: the best is {best}, with an error of "
            f"up to {_percent(choice.errors[best])}."
        )
    line = f"study export --law {law} --format c {words}"
    if choice.depths[1] > joint.default_depth:
        line += f" --depth-star {choice.depths[1]:.9g}"
    text += f"\nCommand that exports it for another program:\n{line}"
    values = {"law": law, "law_error_bound": choice.error_bound, "law_depths": depths}
    return values | {"law_errors": choice.errors, "export": line}, text


def draw(solution, path):
    """Draw the solved curve of a joint, the given depths and the pressure at each into a file."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from study.pages.figures import STYLE

    micro, mega, joint, tilt = READ["um"], READ["MPa"], solution.joint, solution.tilt
    law = joint.law(tilt=None if tilt is None else float(tilt[0]))
    along = np.linspace(0, min(BEYOND * solution.depth.max(), law.deepest), 200)
    ends = 0, min(BEYOND * solution.contact_half_angle_deg.max(), solution.angle_deg[-1])
    if tilt is not None:
        low, high = solution.contact_from_deg.min(), solution.contact_to_deg.max()
        ends = np.clip([low - AROUND, high + AROUND], *solution.angle_deg[[0, -1]])
    with mpl.rc_context(STYLE | {"svg.hashsalt": path.stem}):
        figure = Figure(figsize=(8.4, 3.4))
        left, right = figure.subplots(1, 2)
        left.plot(along / micro, law.force(along), color="0.5", label="elastic solution")
        for depth, force, pressure in zip(
            solution.depth / micro, solution.force, solution.pressure / mega, strict=True
        ):
            label = f"{depth:.4g} µm, {float(f'{force:.4g}'):g} N"
            (point,) = left.plot(depth, force, "o", label=label)
            right.plot(solution.angle_deg, pressure, color=point.get_color())
        left.set(xlabel="penetration depth (µm)", ylabel="contact force (N)", xlim=0, ylim=0)
        right.set(xlabel="polar angle (deg)", ylabel="pressure (MPa)", xlim=ends, ylim=0)
        left.legend()
        with paths.whole(path) as temporary:
            figure.savefig(temporary, metadata=SAME_BYTES[path.suffix])
