"""Commands for contact laws: law, choose, export."""

from dataclasses import replace

import numpy as np

from study import checks, choose, parameters, paths
from study.choose import cheapest_law
from study.cli import options as cli
from study.cli.joint import DEPTH
from study.cli.output import check_output, in_mm, show, working
from study.contact import LAWS
from study.contact.power_fit import USUAL_RANGE
from study.joint import first_yield, limits
from study.joint.options import joint_of

LAW = f"Contact law: {', '.join(LAWS)}. tabulated is a table of the joint's elastic solution."


def _numbers():
    """Options for the numbers of all laws; the help of each names the laws that have it."""
    about, owners = {}, {}
    for law in LAWS.values():
        for name, of in parameters.described(law).items():
            about[name] = of
            owners.setdefault(name, []).append(law.name)
    return [
        cli.option_of(name, of, f"It applies to: {', '.join(owners[name])}.")
        for name, of in about.items()
    ]


@cli.command(
    "law",
    {
        "Depth": [cli.DEPTHS, DEPTH],
        "Numbers of the laws": _numbers(),
        "Output": [cli.UNITS, cli.JSON],
    },
    examples=[
        "law stiffened_hertz --r2-star 200 --depth-star 0.1 --depth-star 0.3",
        "law hertz --socket-radius 12.5mm --clearance 40um --wall 6mm --depth 4um",
    ],
    arguments=[cli.argument("name", LAW, "NAME", cli.choice(LAWS))],
    joint=True,
)
def evaluate_law(name, as_json, units="SI", **options):
    """Evaluate a contact law at given penetration depths: the force, normalised and in N.

    The normalised force is P/(E* dR^2), where P is the contact force, E* the composite modulus of
    ball and socket, R2 the radius of the socket and dR the clearance, which is R2 less the radius
    of the ball. Describe the joint by --r2-star, or with its dimensions for forces in N.

    stiffened_hertz and tabulated are laws of one joint, which the options of a joint describe.
    winkler, hyperbolic_winkler and power have coefficients that are fitted to one joint; the
    defaults are those of the reference joint of the study.
    """
    law = LAWS[name]
    star, depth = (options.pop(key, None) for key in ("depth_star", "depth"))
    values, _ = cli.take_values(options)
    numbers = {n: options.pop(n) for n in tuple(options) if n in parameters.described(law)}
    cli.left_out(options, (), f"the law {name}")
    joint, r2_star = None, values.get("r2_star")
    if law.needs_joint or r2_star is None:
        joint = joint_of(values)
        r2_star = joint.r2_star
    else:  # any radius: a formula is no solution of a joint
        cli.left_out(values, ("r2_star",), f"the law {name}")
    has_dimensions = joint is not None and joint.has_dimensions
    if (star is None) == (depth is None) or (depth and not has_dimensions):
        either = "depth or depth_star" if has_dimensions else "depth_star"
        raise ValueError(f"{either} must be given")
    if star is None:
        star = [of / joint.clearance for of in depth]
    made = law.of(joint) if law.needs_joint else law(**numbers)
    force = np.asarray(made(star, r2_star))
    found = {"depth_star": list(star), "force_star": force.tolist()}
    if not has_dimensions:
        show(found, as_json)
        return
    length = "mm" if units == "mm" else "m"
    depths = in_mm([of * joint.clearance for of in star], "m", units)
    forces = (joint.force_unit * force).tolist()
    table = {f"depth {length}": depths, "force N": forces} | found
    found = {"depth": depths, "force": forces} | found
    found |= {"units": units, "warnings": [*joint.warnings]}
    show(found, as_json, table, *(f"Warning: {text}" for text in joint.warnings))


@cli.command(
    "choose",
    {
        "Accuracy and range": [
            cli.option(
                "--tolerance",
                "Maximum relative error of the force (1e-05 to 1).",
                float,
                required=True,
            ),
            cli.option("--depth-star", "Maximum penetration depth, in clearances.", float),
            cli.option(
                "--depth",
                "Maximum penetration depth in m, for a joint with dimensions.",
                float,
                "m",
            ),
            cli.option(
                "--force", "Maximum contact force in N, for a joint with dimensions.", float, "N"
            ),
            cli.option(
                "--tilt",
                "Also check whether one law is accurate enough for all tilts up to this angle, in "
                "deg between displacement and axis.",
                float,
                "deg",
            ),
            cli.option(
                "--yield-stress",
                "Yield stress of ball and socket in Pa, for a ball with a Young's modulus of 2e11 "
                "Pa. The materials of a joint with dimensions have their own.",
                float,
                "Pa",
            ),
        ],
        "Output": [cli.JSON],
    },
    examples=[
        "choose --r2-star 200 --depth-star 0.3 --tolerance 0.01",
        "choose --socket-radius 12.5mm --clearance 40um --wall 6mm \\\n"
        "      --socket bronze --force 3kN --tolerance 0.05",
    ],
    joint=True,
)
def choose_law(as_json, tolerance, yield_stress=None, tilt=None, **options):
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
    of_depth = {n: options.pop(n) for n in ("depth_star", "depth", "force") if n in options}
    joint, words = cli.take_joint(options, off_axis=tilt is not None)
    if yield_stress is not None:
        if joint.has_dimensions or joint.liner:
            raise ValueError(
                "yield_stress does not apply to a joint with dimensions or layers; remove it, or "
                "describe materials with their yield stresses by --ball, --socket and --liner"
            )
        bodies = joint.materials.items()
        joint = replace(joint, **{n: replace(of, yield_stress=yield_stress) for n, of in bodies})
    if not joint.has_dimensions:
        cli.left_out(of_depth, ("depth_star",), "a joint without dimensions")
    if len(of_depth) != 1:
        either = "exactly one of --depth, --force and --depth-star"
        raise ValueError(
            f"{either if joint.has_dimensions else '--depth-star'} must be given, got "
            f"{' and '.join(map(cli.flag, of_depth)) or 'none'}"
        )
    ((name, value),) = of_depth.items()
    checks.number(name, value, {"depth": "m", "force": "N"}.get(name, ""), above=0)
    least, most = cheapest_law.TOLERANCES
    checks.number("tolerance", tolerance, least=least, most=most)
    with working("Solving the joint"):
        deepest = value / joint.clearance if name == "depth" else value
        if name == "force":  # off the axis only where the joint has none
            solution = joint.solve(force=value, tilt=None if joint.has_pole else tilt)
            deepest = float(solution.depth_star[0])
        tilt = joint.default_tilt if tilt is None else tilt
        table = (
            f"study export --law tabulated --tilt {tilt or 0:g} --format c {words} "
            f"--depth-star {deepest:.9g}"
        )
        if not joint.has_pole:
            _show_across(as_json, joint, deepest, tilt, tolerance, table)
            return
        off_axis = tilt is not None and choose.axial_law_suffices(joint, deepest, tilt, tolerance)
        left = tolerance - (off_axis.direction_error if off_axis else 0)
        serves = left >= least  # else no law is known well enough
        choice = cheapest_law.choose_beside(joint, deepest, left if serves else tolerance)
        first = first_yield(joint, deepest) if yield_stress else None
        exceeded = joint.solve(depth_star=deepest, stresses=joint.has_dimensions).limits
    law = choice.law
    ends = choice.depths if len(law.fitted_constants) > 1 else choice.depths[1:]
    line = f"study export --law {law.name} --format c {words} "
    line += cli.typed({"depth_star": list(ends)})
    warned = [*joint.warnings, *limits.worst(exceeded)]
    axial = {
        "next_cheaper": next(iter(choice.rejected), None),
        **vars(choice),
        "law": law.name,
        "numbers": law.numbers,
        "export": line,
        "first_yield": vars(first) if first else None,
        "applicability": limits.in_short(exceeded[0]),
        "warnings": [*joint.warnings],
    }
    if first:
        warned.append(
            f"The {first.body} yields {first.place} at depths above {first.depth_star:.4g} "
            f"clearances (force_star {first.force_star:.4g}). All errors are for elastic bodies."
        )
    costs = choose.relative_costs()
    laws = sorted(choice.errors, key=costs.get)
    parts = [
        {
            "law": [law.name],
            "error_bound": [choice.error_bound],
            "relative_cost": [choice.relative_cost],
            "numbers": [law.numbers],
        },
        f"For depths of {_depths(joint, choice.depths)}.",
        *(f"Warning: {text}" for text in dict.fromkeys(warned)),
        "Maximum relative error of each law, and its computing time relative to that of Hertz's "
        "law:",
        {
            "law": laws,
            "error": [choice.errors[name] for name in laws],
            "relative_cost": [costs[name] for name in laws],
        },
        f"Command that exports the law for another program:\n{line}",
    ]
    if not off_axis:
        show(axial, as_json, *parts)
        return
    changes = off_axis.direction_error, off_axis.force_change, off_axis.stiffness_change
    differs = (
        "at the maximum depth and three tilts, the force as a vector differs from that along the "
        "axis by at most {:.2g} %. The largest change of the force along the displacement is "
        "{:+.2g} %, and that of the stiffness {:+.2g} %."
    ).format(*(100 * change for change in changes))
    values = vars(off_axis) | {"one_law_for_all_directions": serves}
    if serves:
        head = (
            "One law for the axial direction is accurate enough for all tilts up to "
            f"{tilt:g} deg: {differs} Along the axis, the law below is within the remaining "
            f"tolerance of {left:.2g}."
        )
        show(values | axial, as_json, head, *parts)
        return
    head = (
        "One law for the axial direction is not known to be accurate enough for all tilts up to "
        f"{tilt:g} deg: {differs} Use a table for each direction instead. Command that exports the "
        f"one for {tilt:g} deg:\n{table}"
    )
    values |= {"law": None, "export": table, "along_the_axis": axial}
    show(values, as_json, head, "For the axial direction alone, the fastest law is:", *parts)


def _depths(joint, ends):
    """Two depths in clearances, and in um if the joint has dimensions, as words."""
    text = "{:g} to {:g} clearances".format(*ends)
    if joint.has_dimensions:
        text += " ({:.4g} to {:.4g} um)".format(*(1e6 * joint.clearance * end for end in ends))
    return text


def _show_across(as_json, joint, deepest, tilt, tolerance, line):
    """Show the fitted power law and the table for a joint that has no law along its axis."""
    ends, clearance = (USUAL_RANGE[0], max(USUAL_RANGE[1], deepest)), joint.clearance
    fit = joint.power_law((ends[0] * clearance, ends[1] * clearance), tilt)
    if joint.has_dimensions:
        found = f"F = k d^n with k = {fit.coefficient:.5g} N/m^n and n = {fit.exponent:.5g}"
    else:
        coefficient = fit.coefficient * clearance**fit.exponent / joint.force_unit
        fit = fit._replace(coefficient=coefficient, depths=ends)
        found = f"force_star = {fit.coefficient:.5g} depth_star^{fit.exponent:.5g}"
    body = "a ring" if joint.opening.is_ring else "a ball with a bore about its axis"
    within = "within" if fit.error <= tolerance else "not within"
    values = {"law": None, "one_law_for_all_directions": False, "export": line}
    values |= {"power_law": fit._asdict() | {"tilt": tilt}, "warnings": [*joint.warnings]}
    show(
        values,
        as_json,
        f"No law for the axial direction applies to {body}, which is loaded across its axis. For a "
        f"displacement at a tilt of {tilt:g} deg, the fitted power law {found} is within "
        f"{100 * fit.error:.2g} % at depths from {_depths(joint, ends)}, which is {within} the "
        f"tolerance of {100 * tolerance:.2g} %.",
        "A table of the force along this direction follows the elastic solution within the error "
        f"that it states. Command that exports it:\n{line}",
        *(f"Warning: {text}" for text in joint.warnings),
    )


FORMATS = ("c", "matlab", "modelica", "csv", "exudyn", "adams", "mujoco")


@cli.command(
    "export",
    {
        "Law": [
            cli.option("--law", LAW, tuple(LAWS), required=True),
            cli.LAW_NUMBER,
            cli.option(
                "--depth-star",
                "Maximum penetration depth of the export, in clearances. If it is given twice, "
                "these are the minimum and the maximum: the range over which the law power is "
                "fitted and errors are stated. Default: 1, or the maximum depth of the joint if "
                "that is less; for power 0.05 and 0.5.",
                float,
                multiple=True,
            ),
            cli.option(
                "--depth",
                "The same as --depth-star, but in m, for a joint with dimensions.",
                float,
                "m",
                multiple=True,
            ),
            cli.option(
                "--tilt",
                "Angle in deg between the axis and the displacement: with it, tabulated and power "
                "give the force along this direction, and the text states by how much force and "
                "stiffness change within 10 deg of it. Default: 90 for a ring or a ball with a "
                "bore, else the axis.",
                float,
                "deg",
            ),
        ],
        "Output": [
            cli.option(
                "--format form",
                "Form of the export: a function for C, for MATLAB and Octave (matlab), or for "
                "Modelica; a table of the force over the depth (csv); or an element of Exudyn, "
                "Adams or MuJoCo. Modelica, Exudyn, Adams and MuJoCo need a joint with dimensions.",
                FORMATS,
                required=True,
            ),
            cli.option(
                "--points",
                "Number of rows of csv, for example 30 for a spline. Default: 401.",
                int,
            ),
            cli.UNITS,
            cli.option(
                "--name",
                "Name of the function or element, so that one model can contain several joints. "
                "Default: the name of the law or of the program's element; for MATLAB the name of "
                "the file.",
            ),
            cli.OUTPUT,
        ],
    },
    examples=[
        "export --law stiffened_hertz --format c --r2-star 200",
        "export --law power --format adams --output joint.txt \\\n"
        "      --socket-radius 12.5mm --clearance 40um --wall 6mm",
    ],
    joint=True,
)
def export_law(law, form, tilt=None, name="", output=None, option=(), **options):
    """Export the contact law of one joint for use in another program.

    The joint is described as for study joint, with dimensions or without. The export states the
    joint, the valid range of depths, the units, and the maximum error of the law relative to the
    elastic solution. It is printed on standard output, or written to the file --output.
    """
    from study.export import SUFFIXES, export

    check_output(output, SUFFIXES[form])
    if form == "matlab" and output is not None:  # MATLAB finds a function by its file
        name = name or output.stem
        checks.choice(f"name of the function in {output.name}", name, [output.stem])
    star, depth = (options.pop(key, ()) for key in ("depth_star", "depth"))
    joint, _ = cli.take_joint(options, off_axis=tilt is not None)
    if depth and not joint.has_dimensions:
        raise ValueError("depth does not apply to a joint without dimensions; use --depth-star")
    if depth and star:
        raise ValueError("depth and depth_star must not both be given; remove one of them")
    depths = sorted(star or [value / joint.clearance for value in depth]) or None
    with working("Solving the joint and computing the error of the law"):
        text = export(cli.law_of(law, option), form, joint, depths, tilt, name or None, **options)
    if output is None:
        print(text, end="")
    else:
        with paths.whole(output) as temporary:
            temporary.write_text(text, encoding="utf-8")


COMMANDS = {"law": evaluate_law, "choose": choose_law, "export": export_law}
