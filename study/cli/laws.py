"""Commands for the law of a joint: choose, export."""

from pathlib import Path
from typing import Literal

import numpy as np

from study import checks, choose, paths
from study.choose import cheapest_law
from study.cli import options as cli
from study.cli.output import named_fields, show, working
from study.cli.solve_joint import (
    OF_SIZED,
    RELATIVE,
    SIZED,
    WITH_DIMENSIONS,
    needed,
    sized,
    typed,
)
from study.contact import LAWS, LawName
from study.contact.power_fit import USUAL_RANGE, fit_power
from study.joint import RatioJoint, applicability, first_yield, force_curve, tilted_contact
from study.joint.directional_law import LEAST_DEEPEST

YIELDS = (
    "Warning: The {body} yields {place} at depths above {depth_star:.4g} clearances (force_star "
    "{force_star:.4g}). All errors are for elastic bodies."
)

ONE_LAW = "One law for the axial direction is accurate enough for all tilts up to {:g} deg"
NOT_ONE_LAW = (
    "One law for the axial direction is not known to be accurate enough for all tilts up to {:g} "
    "deg"
)
KNOWN = {"rule": "by the rule that the rim is distant and the supports are the same all round"}
DIFFERS = "the force differs from that along the axis by a fraction of at most {:.2g} ({})."
REST = "Along the axis, the law below is within the remaining tolerance of {:.2g}."
NO_AXIS = (
    "No law for the axial direction applies to {}, which is loaded across its axis. For a "
    "displacement at a tilt of {:g} deg, the fitted power law {} is within {:.2g} % at depths "
    "{}, which is {} the tolerance of {:.2g} %."
)
_PLACES = 8  # depths at which k and n are fitted off the axis
TABLE = "Use a table of depth and tilt instead. Command that exports it:\n{}"


@cli.command(
    "choose",
    sections={
        "Accuracy and range": ("tolerance", "depth_star", "depth", "force", "tilt", "yield_stress"),
    }
    | cli.SECTIONS
    | {
        "Output": ("as_json",),
    },
    examples=[
        "choose --r2-star 200 --depth-star 0.3 --tolerance 0.01",
        "choose --socket-radius 12.5e-3 --clearance 40e-6 --wall 6e-3 \\\n"
        "      --socket bronze --force 3000 --tolerance 0.05",
    ],
)
def choose_law(
    tolerance: float = cli.required("Maximum relative error of the force (1e-05 to 1)."),
    depth_star: float = cli.option("Maximum penetration depth, in clearances."),
    depth: float = cli.option("Maximum penetration depth in m, for a joint with dimensions."),
    force: float = cli.option("Maximum contact force in N, for a joint with dimensions."),
    yield_stress: float = cli.option(
        "Yield stress of ball and socket in Pa, for a ball with a Young's modulus of 2e11 Pa. The "
        "materials of a joint with dimensions have their own."
    ),
    tilt: float = cli.option(
        "Also check whether one law is accurate enough for all tilts up to this angle, in deg "
        "between displacement and axis."
    ),
    as_json: bool = cli.JSON,
    **joint: RELATIVE | SIZED,
):
    """Choose the fastest contact law that is accurate enough for a joint.

    The joint is described as for study joint, with dimensions or without. The answer lists the
    error of every law relative to the elastic solution, and its computing time relative to that of
    Hertz's law.

    With --tilt, the answer begins with whether one law for the axial direction is accurate enough
    for all tilts up to the given angle. If it is not, and for a ring or a ball with a bore, to
    which no axial law applies, the answer is a table of depth and tilt.

    To choose the model of a whole mechanism, use: study simulate --model auto --tolerance ...
    """
    joint = cli.under_tilt(tilt, joint)
    of_depth = {"depth_star": depth_star, "depth": depth, "force": force}
    of_depth = {name: value for name, value in of_depth.items() if value is not None}
    asked, dimensions = _asked(joint, of_depth, yield_stress)
    least, most = cheapest_law.TOLERANCES
    checks.number("tolerance", tolerance, least=least, most=most)
    with working("Solving the joint"):
        deepest = _depth(dimensions, tilt, *of_depth.popitem())
        if not asked.has_pole:
            tilt = asked.default_tilt if tilt is None else tilt
            text = typed(joint | {"depth_star": deepest})
            line = f"study export --law tabulated --direction {tilt:g} --format c {text}"
            _show_no_axis(as_json, asked, dimensions, deepest, tilt, tolerance, line)
            return
        off_axis = tilt is not None and choose.axial_law_suffices(asked, deepest, tilt, tolerance)
        left = tolerance - (off_axis.direction_error if off_axis else 0)
        serves = left >= least  # else no law is known well enough
        choice = cheapest_law.choose_beside(asked, deepest, left if serves else tolerance)
        first = first_yield(asked, deepest) if yield_stress else None
        if dimensions is None:
            exceeded = applicability.of_curve(force_curve(asked, [deepest]))
        else:
            exceeded = dimensions.solve(depth=deepest * dimensions.clearance).limits
    axial = {"next_cheaper": next(iter(choice.rejected), None)} | named_fields(choice)
    axial["export"] = None
    if choice.law != "solver":
        ends = choice.depths if choice.law == "power" else choice.depths[1:]
        text = typed(joint | {"depth_star": list(ends)})
        axial["export"] = f"study export --law {choice.law} --format c {text}"
    axial["first_yield"] = vars(first) if first else None
    axial["applicability"] = applicability.in_short(exceeded[0])
    parts = list(_of_choice(choice, dimensions, exceeded, axial))
    if not off_axis:
        show(axial, as_json, *parts)
        return
    how = KNOWN.get(off_axis.known_by, "solved at the maximum depth")
    differs = DIFFERS.format(off_axis.direction_error, how)
    values = vars(off_axis) | {"one_law_for_all_directions": serves}
    if serves:
        head = f"{ONE_LAW.format(tilt)}: {differs} {REST.format(left)}"
        show(values | axial, as_json, head, *parts)
        return
    line = _table_line(joint | {"depth_star": deepest}, tilt)
    head = f"{NOT_ONE_LAW.format(tilt)}: {differs} {TABLE.format(line)}"
    values |= {"law": None, "export": line, "along_the_axis": axial}
    show(values, as_json, head, "For the axial direction alone, the fastest law is:", *parts)


def _asked(joint, of_depth, yield_stress):
    """Joint without dimensions, and with them or None, after checks of what is given."""
    if not any(name in joint for name in OF_SIZED):
        cli.left_out(of_depth, ("depth_star",), "a joint without dimensions")
        needed(("r2_star",), joint, WITH_DIMENSIONS)
        needed(("depth_star",), of_depth)
        return RatioJoint(**joint).joint(yield_stress), None
    if yield_stress is not None:
        raise ValueError(
            "--yield-stress does not apply to a joint with dimensions, whose materials have their "
            "own; remove it"
        )
    if len(of_depth) != 1:
        raise ValueError(
            "exactly one of --depth, --force and --depth-star must be given, got "
            f"{' and '.join(map(cli.flag, of_depth)) or 'none'}"
        )
    dimensions = sized(joint)
    return dimensions.joint, dimensions


def _depth(dimensions, tilt, name, value):
    """Maximum depth in clearances, which is given as such, in m, or by a force in N."""
    checks.number(name, value, {"depth": "m", "force": "N"}.get(name, ""), above=0)
    if name == "depth_star":
        return value
    if name == "force":  # off the axis only where there is none
        value = dimensions.solve(force=value, tilt=None if dimensions.has_pole else tilt).depth[0]
    return float(value / dimensions.clearance)


def _table_line(joint, tilt):
    """Command that exports a table of depth and tilt, of at least the minimum depth."""
    joint = joint | {"depth_star": max(joint["depth_star"], LEAST_DEEPEST)}
    return f"study export --law tabulated --tilt {tilt:g} --format c {typed(joint)}"


def _show_no_axis(as_json, asked, dimensions, deepest, tilt, tolerance, line):
    """Show the fitted power law and the table for a joint that has no law along its axis."""
    places = np.geomspace(USUAL_RANGE[0], max(USUAL_RANGE[1], deepest), _PLACES)
    if dimensions is None:
        fit = fit_power(places, tilted_contact(asked, places, tilt).force_star)
        found = "force_star = {:.5g} depth_star^{:.5g}".format(*fit[:2])
        ends = "from {:.3g} to {:.3g} clearances".format(*fit.depths)
    else:
        solution = dimensions.solve(depth=dimensions.clearance * places, tilt=tilt)
        fit = fit_power(solution.depth, solution.force)
        found = "F = k d^n with k = {:.5g} N/m^n and n = {:.5g}".format(*fit[:2])
        ends = "from {:.4g} to {:.4g} um".format(*(1e6 * depth for depth in fit.depths))
    body = "a ring" if asked.opening.is_ring else "a ball with a bore about its axis"
    within = "within" if fit.error <= tolerance else "not within"
    values = {"law": None, "one_law_for_all_directions": False, "export": line}
    show(
        values | {"power_law": fit._asdict() | {"tilt": tilt}},
        as_json,
        NO_AXIS.format(body, tilt, found, 100 * fit.error, ends, within, 100 * tolerance),
        "A table of the force along this direction follows the elastic solution within the error "
        f"that it states. Command that exports it:\n{line}",
    )


def _of_choice(choice, dimensions, exceeded, axial):
    """Parts of the text on a choice for the axial direction."""
    names, costs = ("law", "error_bound", "relative_cost", "options"), choose.relative_costs()
    yield {name: [getattr(choice, name)] for name in names}
    depths = "For depths of {:g} to {:g} clearances".format(*choice.depths)
    if dimensions is not None:
        ends = (1e6 * dimensions.clearance * depth for depth in choice.depths)
        depths += " ({:.4g} to {:.4g} um)".format(*ends)
    yield f"{depths}."
    yield from (f"Warning: {text}" for text in applicability.worst(exceeded))
    if axial["first_yield"]:
        yield YIELDS.format(**axial["first_yield"])
    yield (
        "Maximum relative error of each law, and its computing time relative to that of Hertz's "
        "law:"
    )
    laws = sorted(choice.errors, key=costs.get)
    yield {
        "law": laws,
        "error": [choice.errors[law] for law in laws],
        "relative_cost": [costs[law] for law in laws],
    }
    if axial["export"]:
        yield f"Command that exports the law for another program:\n{axial['export']}"


@cli.command(
    "export",
    sections={
        "Law": ("law", "depth_star", "depth", "tilt", "direction"),
    }
    | cli.SECTIONS
    | {
        "Output": ("form", "name", "output"),
    },
    examples=[
        "export --law stiffened_hertz --format c --r2-star 200",
        "export --law power --format adams --output joint.txt \\\n"
        "      --socket-radius 12.5e-3 --clearance 40e-6 --wall 6e-3",
    ],
)
def export_law(
    law: Literal[LawName, "tabulated"] = cli.required(
        f"Contact law: {', '.join(LAWS)}; or tabulated, a table of the joint's elastic solution."
    ),
    form: Literal[
        "c", "matlab", "modelica", "json", "csv", "exudyn", "adams", "mujoco"
    ] = cli.required(
        "Form of the export: a function for C, for MATLAB and Octave (matlab), or for Modelica; "
        "the formula and its numbers (json); a table of the force over the depth (csv); or an "
        "element of Exudyn, Adams or MuJoCo. Modelica, Exudyn, Adams and MuJoCo need a joint with "
        "dimensions.",
        "--format",
    ),
    depth_star: list[float] = cli.option(
        "Maximum penetration depth of the export, in clearances. If it is given twice, these are "
        "the minimum and the maximum: the range over which the law power is fitted and errors are "
        "stated. Default: 1, or the maximum depth of the joint if that is less; for power 0.05 and "
        "0.5."
    ),
    depth: list[float] = cli.option(
        "The same as --depth-star, but in m, for a joint with dimensions."
    ),
    tilt: float = cli.option(
        "Maximum tilt, in deg between displacement and axis: with it, tabulated is a table over "
        "depth and tilt of the forces along and across the displacement."
    ),
    direction: float = cli.option(
        "Tilt of a single direction of displacement, in deg from the axis: with it, tabulated and "
        "power give the force along this direction. Default: 90 for a ring or a ball with a bore, "
        "else 0."
    ),
    name: str = cli.option(
        "Name of the function or element, so that one model can contain several joints. Default: "
        "the name of the law or of the program's element; for MATLAB the name of the file."
    ),
    output: Path = cli.OUTPUT,
    **joint: RELATIVE | SIZED,
):
    """Export the contact law of one joint for use in another program.

    The joint is described as for study joint, with dimensions or without. The export states the
    joint, the valid range of depths, the units, and the maximum error of the law relative to the
    elastic solution. It is printed on standard output, or written to the file --output.
    """
    from study.export import SUFFIXES, export

    cli.check_output(output, SUFFIXES[form])
    if form == "matlab" and output is not None:  # MATLAB finds a function by its file
        name = name or output.stem
        checks.choice(f"name of the function in {output.name}", name, [output.stem])
    joint = cli.under_tilt(tilt if direction is None else direction, joint)
    if any(name in joint for name in OF_SIZED):
        asked = sized(joint)
        depths = [value / asked.clearance for value in depth or ()]
        if depth and depth_star:
            raise ValueError("--depth and --depth-star must not both be given; remove one of them")
        depth_star = depth_star or depths
    else:
        if depth:
            raise ValueError(
                "--depth does not apply to a joint without dimensions; use --depth-star"
            )
        asked = RatioJoint(**joint).joint()
    with working("Solving the joint and computing the error of the law"):
        depths = sorted(depth_star or ()) or None
        text = export(law, form, asked, depths, tilt=tilt, direction=direction, name=name)
    if output is None:
        print(text, end="")
    else:
        with paths.whole(output) as temporary:
            temporary.write_text(text, encoding="utf-8")
