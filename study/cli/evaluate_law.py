"""The command that evaluates a law: study law."""

import typer

from study import parameters
from study.cli import options as cli
from study.cli.output import show
from study.cli.solve_joint import RELATIVE, joint_of
from study.contact import LAWS, LawName


def _numbers():
    """Numbers of all laws; the help of each names the laws that have it."""
    about, owners = {}, {}
    for law in LAWS.values():
        for name, of in parameters.described(law).items():
            about[name] = of
            owners.setdefault(name, []).append(law.name)
    return {
        name: cli.option_of(of, f"It applies to: {', '.join(owners[name])}.")
        for name, of in about.items()
    }


NUMBERS = _numbers()
JOINT = {name: option for name, option in RELATIVE.items() if name != "r2_star"}


@cli.command(
    "law",
    sections={
        "Joint and depth": ("r2_star", "depth_star"),
        "Numbers of the laws": tuple(NUMBERS),
    }
    | cli.SECTIONS
    | {"Output": ("as_json",)},
    examples=["law stiffened_hertz --r2-star 200 --depth-star 0.1 --depth-star 0.3"],
)
def evaluate_law(
    name: LawName = typer.Argument(help=f"Contact law: {', '.join(LAWS)}.", metavar="NAME"),
    r2_star: float = cli.required("Socket radius divided by the clearance, R2/dR (> 1)."),
    depth_star: list[float] = cli.required(cli.DEPTHS),
    as_json: bool = cli.JSON,
    **options: NUMBERS | JOINT,
):
    """Evaluate a contact law: the normalised force P/(E* dR^2) at given penetration depths.

    Here P is the contact force, E* the composite modulus of ball and socket, R2 the radius of the
    socket and dR the clearance, which is R2 less the radius of the ball.

    stiffened_hertz and tabulated are laws of one joint, which the options of a joint describe.
    winkler, hyperbolic_winkler and power have coefficients that are fitted to one joint; the
    defaults are those of the reference joint of the study.
    """
    law = LAWS[name]
    known = JOINT if law.needs_joint else parameters.described(law)
    cli.left_out(options, known, f"the law {name}")
    made = law.of(joint_of(options | {"r2_star": r2_star})) if law.needs_joint else law(**options)
    force = made(depth_star, r2_star)
    show({"depth_star": depth_star, "force_star": force.tolist()}, as_json)
