"""Commands for the law of a joint: choose, export."""

from pathlib import Path
from typing import Literal

from study import checks, choose, paths
from study.cli import options as cli
from study.cli.output import named_fields, show, working
from study.cli.solve_joint import OF_SIZED, RELATIVE, SIZED, needed, sized, typed
from study.contact import LawName
from study.joint import RatioJoint, applicability, first_yield, force_curve

YIELDS = (
    "The {body} yields, {place}, from {depth_star:.4g} clearances on "
    "(force_star {force_star:.4g}). All errors are for joints that do not yield."
)

DIRECTIONS = {True: "One law serves", False: "No one law is known to serve"}
KNOWN = {"rule": "by the rule that the rim is far, and all else the same all round"}
OFF_AXIS = (
    "{} all directions up to {:g} deg: the force differs from that along the axis by at most "
    "{:.2g} of it ({})."
)
TABLE = " A table of depth and tilt does:\nstudy export --law tabulated --tilt {:g} --format c {}"


@cli.command("choose")
def choose_law(
    depth_star: float = cli.required("Largest depth of the scene, in clearances."),
    tolerance: float = cli.required("Largest relative error of the force, from 1e-5 to 1."),
    yield_stress: float = cli.option(
        "Yield stress of ball and socket in Pa, where the ball's modulus is 2e11 Pa."
    ),
    tilt: float = cli.option(
        "Largest direction of a displacement off the axis, in deg: does one law serve all?"
    ),
    as_json: bool = cli.JSON,
    **joint: RELATIVE,
):
    """Choose the cheapest law that is accurate enough for a joint, with the evidence.

    For a whole mechanism: study simulate --model auto --tolerance ... .
    """
    needed(("r2_star",), joint)
    joint = cli.under_tilt(tilt, joint)
    asked, costs = RatioJoint(**joint).joint(yield_stress), choose.relative_costs()
    with working("Solving the joint"):
        off_axis = tilt is not None and choose.axial_law_suffices(
            asked, depth_star, tilt, tolerance
        )
        choice = choose.choose(asked, depth_star, tolerance)
        first = first_yield(asked, depth_star) if yield_stress else None
        contact = force_curve(asked, [depth_star])
    laws = sorted(choice.errors, key=costs.get)
    names = ("law", "error_bound", "relative_cost", "options")
    sentences = ["For depths of {:g} to {:g} clearances.".format(*choice.depths)]
    exceeded = applicability.of_curve(contact)
    sentences += [f"Beyond a limit: {text}" for text in applicability.worst(exceeded)]
    if first:
        sentences.append(YIELDS.format(**vars(first)))
    if off_axis:
        serves, error, known_by = vars(off_axis).values()
        how = KNOWN.get(known_by, "solved at the largest depth")
        sentences.append(OFF_AXIS.format(DIRECTIONS[serves], tilt, error, how))
        if not serves:
            table = joint | {"depth_star": depth_star}
            sentences[-1] += TABLE.format(tilt, typed(table))
    show(
        {"next_cheaper": next(iter(choice.rejected), None)}
        | named_fields(choice)
        | {"first_yield": vars(first) if first else None}
        | {"applicability": applicability.in_short(exceeded[0])}
        | (vars(off_axis) if off_axis else {}),
        as_json,
        {name: [getattr(choice, name)] for name in names},
        *sentences,
        "Largest error of each law, and time of a call over that of Hertz's law:",
        {
            "law": laws,
            "error": [choice.errors[law] for law in laws],
            "relative_cost": [costs[law] for law in laws],
        },
    )


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
