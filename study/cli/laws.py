"""Commands for the law of a joint: choose, export."""

from pathlib import Path
from typing import Literal

import numpy as np

from study import checks, choose, paths
from study.choose import cheapest_law
from study.cli import options as cli
from study.cli.output import named_fields, show, working
from study.cli.solve_joint import OF_SIZED, RELATIVE, SIZED, needed, sized, typed
from study.contact import LawName
from study.contact.power_fit import USUAL_RANGE, fit_power
from study.joint import RatioJoint, applicability, first_yield, force_curve, tilted_contact
from study.joint.directional_law import LEAST_DEEPEST

YIELDS = (
    "The {body} yields, {place}, from {depth_star:.4g} clearances on "
    "(force_star {force_star:.4g}). All errors are for joints that do not yield."
)

SERVES = "One law along the axis serves all directions up to {:g} deg"
SERVES_NOT = "No one law along the axis is known to serve all directions up to {:g} deg"
KNOWN = {"rule": "by the rule that the rim is far, and all else the same all round"}
DIFFERS = "the force differs from that along the axis by at most {:.2g} of it ({})."
REST = "The law below is within the rest of the tolerance, {:.2g}, along the axis."
NO_AXIS = (
    "No law along the axis applies to {}, which is loaded across its axis. Along a displacement at "
    "{:g} deg off the axis, {} {} is within {:.2g} %, which is {} the tolerance of {:.2g} %."
)
_PLACES = 8  # depths at which k and n are fitted off the axis
TABLE = "Take a table of depth and tilt:\n{}"


@cli.command("choose")
def choose_law(
    tolerance: float = cli.required("Largest relative error of the force, from 1e-5 to 1."),
    depth_star: float = cli.option("Largest depth of the scene, in clearances."),
    depth: float = cli.option("The same in m, for a joint with its dimensions."),
    force: float = cli.option("Or the largest force in N, for a joint with its dimensions."),
    yield_stress: float = cli.option(
        "Yield stress of ball and socket in Pa, where the ball's modulus is 2e11 Pa; materials of "
        "a joint with its dimensions have their own."
    ),
    tilt: float = cli.option(
        "Largest direction of a displacement off the axis, in deg: does one law serve all?"
    ),
    as_json: bool = cli.JSON,
    **joint: RELATIVE | SIZED,
):
    """Choose the cheapest law that is accurate enough for a joint, with the evidence.

    The joint is described as for study joint, with its dimensions or without. With --tilt the
    answer says first whether one law along the axis serves all directions up to it; if not, and for
    a ring or a bored ball, which no such law is for, it names the table of depth and tilt.

    For a whole mechanism: study simulate --model auto --tolerance ... .
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
    how = KNOWN.get(off_axis.known_by, "solved at the largest depth")
    differs = DIFFERS.format(off_axis.direction_error, how)
    values = vars(off_axis) | {"one_law_for_all_directions": serves}
    if serves:
        head = f"{SERVES.format(tilt)}: {differs} {REST.format(left)}"
        show(values | axial, as_json, head, *parts)
        return
    line = _table_line(joint | {"depth_star": deepest}, tilt)
    head = f"{SERVES_NOT.format(tilt)}: {differs} {TABLE.format(line)}"
    values |= {"law": None, "export": line, "along_the_axis": axial}
    show(values, as_json, head, "Along the axis alone, the cheapest law is:", *parts)


def _asked(joint, of_depth, yield_stress):
    """Joint without dimensions, and with them or None, after checks of what is given."""
    if not any(name in joint for name in OF_SIZED):
        cli.left_out(of_depth, ("depth_star",), "it is for a joint with its dimensions")
        needed(("r2_star",), joint, " or, with dimensions, --socket-radius, ...")
        needed(("depth_star",), of_depth)
        return RatioJoint(**joint).joint(yield_stress), None
    if yield_stress is not None:
        raise ValueError("--yield-stress must be left out: materials of the joint have their own")
    if len(of_depth) != 1:
        raise ValueError("one of --depth, --force and --depth-star must be given")
    dimensions = sized(joint)
    return dimensions.joint, dimensions


def _depth(dimensions, tilt, name, value):
    """Largest depth in clearances, where it is given so, in m, or by a force in N."""
    checks.number(name, value, {"depth": "m", "force": "N"}.get(name, ""), above=0)
    if name == "depth_star":
        return value
    if name == "force":  # off the axis only where there is none
        value = dimensions.solve(force=value, tilt=None if dimensions.has_pole else tilt).depth[0]
    return float(value / dimensions.clearance)


def _table_line(joint, tilt):
    """Command that exports a table of depth and tilt, of at least the depth that it must have."""
    joint = joint | {"depth_star": max(joint["depth_star"], LEAST_DEEPEST)}
    return f"study export --law tabulated --tilt {tilt:g} --format c {typed(joint)}"


def _show_no_axis(as_json, asked, dimensions, deepest, tilt, tolerance, line):
    """Say what to use for a joint that has no law along its axis: k and n, or a table."""
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
        NO_AXIS.format(body, tilt, found, ends, 100 * fit.error, within, 100 * tolerance),
        f"The table of the force along this direction is exact within its stated error:\n{line}",
    )


def _of_choice(choice, dimensions, exceeded, axial):
    """Parts of the text on a choice along the axis."""
    names, costs = ("law", "error_bound", "relative_cost", "options"), choose.relative_costs()
    yield {name: [getattr(choice, name)] for name in names}
    depths = "For depths of {:g} to {:g} clearances".format(*choice.depths)
    if dimensions is not None:
        ends = (1e6 * dimensions.clearance * depth for depth in choice.depths)
        depths += " ({:.4g} to {:.4g} um)".format(*ends)
    yield f"{depths}."
    yield from (f"Beyond a limit: {text}" for text in applicability.worst(exceeded))
    if axial["first_yield"]:
        yield YIELDS.format(**axial["first_yield"])
    yield "Largest error of each law, and time of a call over that of Hertz's law:"
    laws = sorted(choice.errors, key=costs.get)
    yield {
        "law": laws,
        "error": [choice.errors[law] for law in laws],
        "relative_cost": [costs[law] for law in laws],
    }
    if axial["export"]:
        yield f"To take it into another program:\n{axial['export']}"


@cli.command("export")
def export_law(
    law: Literal[LawName, "tabulated"] = cli.required(
        "Name of a law, or tabulated: the force-depth curve of the joint."
    ),
    form: Literal[
        "c", "matlab", "modelica", "json", "csv", "exudyn", "adams", "mujoco"
    ] = cli.required(
        "Function (C; MATLAB and Octave; Modelica), formula and numbers (JSON), force over depth "
        "(CSV), or an element of Exudyn, Adams or MuJoCo; these and Modelica need dimensions.",
        "--format",
    ),
    depth_star: list[float] = cli.option(
        "Largest depth of the text, in clearances, or given twice its range: that of power's fit "
        "and of the errors. [default: 1, if the joint can go so deep; for power 0.05 and 0.5]"
    ),
    depth: list[float] = cli.option("The same in m, for a joint with its dimensions."),
    tilt: float = cli.option(
        "Largest direction of a displacement off the axis, in deg: tabulated is then a table of "
        "depth and tilt, with the forces along and across."
    ),
    direction: float = cli.option(
        "Angle off the axis, in deg, of the one displacement that the law is for: tabulated and "
        "power give the force along it. [default: 90 for a ring or a ball with a bore, else 0]"
    ),
    name: str = cli.option(
        "Name of the function or element, so that several joints fit into one model. [default: "
        "that of the law or of the program's element; for MATLAB that of the file]"
    ),
    output: Path = cli.OUTPUT,
    **joint: RELATIVE | SIZED,
):
    """Export a law, for one joint, to another program: to standard output or a file.

    The joint is described as for study joint, with its dimensions or without. The text states
    joint, range, units, and the law's largest error against the solved joint.
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
            raise ValueError("either --depth or --depth-star must be given, not both")
        depth_star = depth_star or depths
    else:
        if depth:
            raise ValueError("--depth must be left out: it is for a joint with its dimensions")
        asked = RatioJoint(**joint).joint()
    with working("Solving the joint, and its error"):
        depths = sorted(depth_star or ()) or None
        text = export(law, form, asked, depths, tilt=tilt, direction=direction, name=name)
    if output is None:
        print(text, end="")
    else:
        with paths.whole(output) as temporary:
            temporary.write_text(text, encoding="utf-8")
