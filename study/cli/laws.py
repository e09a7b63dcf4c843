"""Commands for the law of a joint: choose, export."""

from dataclasses import replace
from pathlib import Path
from typing import Literal

from study import checks, choose, paths
from study.choose import cheapest_law
from study.cli import options as cli
from study.cli.output import named_fields, show, working
from study.cli.solve_joint import RELATIVE, SIZED, joint_of, typed
from study.contact import LAWS, LawName
from study.contact.power_fit import USUAL_RANGE
from study.joint import first_yield, limits

YIELDS = (
    "Warning: The {body} yields {place} at depths above {depth_star:.4g} clearances (force_star "
    "{force_star:.4g}). All errors are for elastic bodies."
)
ONE_LAW = "One law for the axial direction is accurate enough for all tilts up to {:g} deg"
NOT_ONE_LAW = (
    "One law for the axial direction is not known to be accurate enough for all tilts up to {:g} "
    "deg"
)
DIFFERS = (
    "at the maximum depth and three tilts, the force as a vector differs from that along the axis "
    "by at most {:.2g} %. The largest change of the force along the displacement is {:+.2g} %, and "
    "that of the stiffness {:+.2g} %."
)
REST = "Along the axis, the law below is within the remaining tolerance of {:.2g}."
NO_AXIS = (
    "No law for the axial direction applies to {}, which is loaded across its axis. For a "
    "displacement at a tilt of {:g} deg, the fitted power law {} is within {:.2g} % at depths "
    "{}, which is {} the tolerance of {:.2g} %."
)
TABLE = "Use a table for each direction instead. Command that exports the one for {:g} deg:\n{}"


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

    With --tilt, the joint is also solved at three tilts up to the given angle. The answer begins
    with whether one law for the axial direction is accurate enough for all of them, and with how
    much force and stiffness change. If it is not, and for a ring or a ball with a bore, to which no
    axial law applies, the answer is a table for one direction.

    To choose the model of a whole mechanism, use: study simulate --model auto --tolerance ...
    """
    joint = cli.under_tilt(tilt, joint)
    asked = joint_of(joint)
    if yield_stress is not None:
        asked = _yielding(asked, yield_stress)
    of_depth = {"depth_star": depth_star, "depth": depth, "force": force}
    of_depth = {name: value for name, value in of_depth.items() if value is not None}
    if not asked.has_dimensions:
        cli.left_out(of_depth, ("depth_star",), "a joint without dimensions")
    if len(of_depth) != 1:
        either = "exactly one of --depth, --force and --depth-star"
        raise ValueError(
            f"{either if asked.has_dimensions else '--depth-star'} must be given, got "
            f"{' and '.join(map(cli.flag, of_depth)) or 'none'}"
        )
    least, most = cheapest_law.TOLERANCES
    checks.number("tolerance", tolerance, least=least, most=most)
    with working("Solving the joint"):
        deepest = _depth(asked, tilt, *of_depth.popitem())
        tilt = asked.default_tilt if tilt is None else tilt
        table = (
            f"study export --law tabulated --tilt {tilt or 0:g} --format c "
            f"{typed(joint | {'depth_star': deepest})}"
        )
        if not asked.has_pole:
            _show_no_axis(as_json, asked, deepest, tilt, tolerance, table)
            return
        off_axis = tilt is not None and choose.axial_law_suffices(asked, deepest, tilt, tolerance)
        left = tolerance - (off_axis.direction_error if off_axis else 0)
        serves = left >= least  # else no law is known well enough
        choice = cheapest_law.choose_beside(asked, deepest, left if serves else tolerance)
        first = first_yield(asked, deepest) if yield_stress else None
        exceeded = asked.solve(depth_star=deepest, stresses=asked.has_dimensions).limits
    law = choice.law
    axial = {"next_cheaper": next(iter(choice.rejected), None)} | named_fields(choice)
    axial |= {"law": law.name, "numbers": law.numbers}
    ends = choice.depths if len(law.fitted_constants) > 1 else choice.depths[1:]
    text = typed(joint | {"depth_star": list(ends)})
    axial["export"] = f"study export --law {law.name} --format c {text}"
    axial["first_yield"] = vars(first) if first else None
    axial["applicability"] = limits.in_short(exceeded[0])
    parts = list(_of_choice(choice, asked, exceeded, axial))
    if not off_axis:
        show(axial, as_json, *parts)
        return
    changes = off_axis.direction_error, off_axis.force_change, off_axis.stiffness_change
    differs = DIFFERS.format(*(100 * change for change in changes))
    values = vars(off_axis) | {"one_law_for_all_directions": serves}
    if serves:
        head = f"{ONE_LAW.format(tilt)}: {differs} {REST.format(left)}"
        show(values | axial, as_json, head, *parts)
        return
    head = f"{NOT_ONE_LAW.format(tilt)}: {differs} {TABLE.format(tilt, table)}"
    values |= {"law": None, "export": table, "along_the_axis": axial}
    show(values, as_json, head, "For the axial direction alone, the fastest law is:", *parts)


def _yielding(joint, stress):
    """A joint without dimensions, with a yield stress of ball and socket in Pa."""
    if joint.has_dimensions or joint.liner:
        raise ValueError(
            "--yield-stress does not apply to a joint with dimensions or layers; remove it, or "
            "describe materials with their yield stresses by --ball, --socket and --liner"
        )
    bodies = {body: replace(of, yield_stress=stress) for body, of in joint.materials.items()}
    return replace(joint, **bodies)


def _depth(joint, tilt, name, value):
    """Maximum depth in clearances, which is given as such, in m, or by a force in N."""
    checks.number(name, value, {"depth": "m", "force": "N"}.get(name, ""), above=0)
    if name == "force":  # off the axis only where the joint has none
        return float(joint.solve(force=value, tilt=None if joint.has_pole else tilt).depth_star[0])
    return value / joint.clearance if name == "depth" else value


def _depths(joint, ends):
    """Two depths in clearances, and in um if the joint has dimensions, as words."""
    text = "{:g} to {:g} clearances".format(*ends)
    if joint.has_dimensions:
        text += " ({:.4g} to {:.4g} um)".format(*(1e6 * joint.clearance * end for end in ends))
    return text


def _show_no_axis(as_json, joint, deepest, tilt, tolerance, line):
    """Show the fitted power law and the table for a joint that has no law along its axis."""
    ends, clearance = (USUAL_RANGE[0], max(USUAL_RANGE[1], deepest)), joint.clearance
    fit = joint.power_law((ends[0] * clearance, ends[1] * clearance), tilt)
    if joint.has_dimensions:
        found = "F = k d^n with k = {:.5g} N/m^n and n = {:.5g}".format(*fit[:2])
    else:
        coefficient = fit.coefficient * clearance**fit.exponent / joint.force_unit
        fit = fit._replace(coefficient=coefficient, depths=ends)
        found = "force_star = {:.5g} depth_star^{:.5g}".format(*fit[:2])
    body = "a ring" if joint.opening.is_ring else "a ball with a bore about its axis"
    within = "within" if fit.error <= tolerance else "not within"
    depths = f"from {_depths(joint, ends)}"
    values = {"law": None, "one_law_for_all_directions": False, "export": line}
    show(
        values | {"power_law": fit._asdict() | {"tilt": tilt}},
        as_json,
        NO_AXIS.format(body, tilt, found, 100 * fit.error, depths, within, 100 * tolerance),
        "A table of the force along this direction follows the elastic solution within the error "
        f"that it states. Command that exports it:\n{line}",
    )


def _of_choice(choice, joint, exceeded, axial):
    """Parts of the text on a choice for the axial direction."""
    costs = choose.relative_costs()
    yield {
        "law": [choice.law.name],
        "error_bound": [choice.error_bound],
        "relative_cost": [choice.relative_cost],
        "numbers": [choice.law.numbers],
    }
    yield f"For depths of {_depths(joint, choice.depths)}."
    yield from (f"Warning: {text}" for text in limits.worst(exceeded))
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
    yield f"Command that exports the law for another program:\n{axial['export']}"


@cli.command(
    "export",
    sections={
        "Law": ("law", "option", "depth_star", "depth", "tilt"),
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
    law: LawName = cli.required(
        f"Contact law: {', '.join(LAWS)}. tabulated is a table of the joint's elastic solution."
    ),
    option: list[str] = cli.OPTION,
    form: Literal["c", "matlab", "modelica", "csv", "exudyn", "adams", "mujoco"] = cli.required(
        "Form of the export: a function for C, for MATLAB and Octave (matlab), or for Modelica; a "
        "table of the force over the depth (csv); or an element of Exudyn, Adams or MuJoCo. "
        "Modelica, Exudyn, Adams and MuJoCo need a joint with dimensions.",
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
        "Angle in deg between the axis and the displacement: with it, tabulated and power give the "
        "force along this direction, and the text states by how much force and stiffness change "
        "within 10 deg of it. Default: 90 for a ring or a ball with a bore, else the axis."
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
    asked = joint_of(cli.under_tilt(tilt, joint))
    if depth and not asked.has_dimensions:
        raise ValueError("--depth does not apply to a joint without dimensions; use --depth-star")
    if depth and depth_star:
        raise ValueError("--depth and --depth-star must not both be given; remove one of them")
    depths = depth_star or [value / asked.clearance for value in depth or ()]
    with working("Solving the joint and computing the error of the law"):
        text = export(cli.law_of(law, option), form, asked, sorted(depths) or None, tilt, name)
    if output is None:
        print(text, end="")
    else:
        with paths.whole(output) as temporary:
            temporary.write_text(text, encoding="utf-8")
