"""The command that evaluates a law: study law."""

import typer

from study.cli import options as cli
from study.cli.output import show
from study.contact import LAWS, LawName


def _options():
    """Options of all laws; the help of each names the laws that have it."""
    about, owners = {}, {}
    for law in LAWS.values():
        about |= law.options
        for name in law.options:
            owners.setdefault(name, []).append(law.name)
    return {
        name: cli.option_of(about[name], f"It applies to: {', '.join(owners[name])}.")
        for name in about
    }


OPTIONS = _options()


@cli.command(
    "law",
    sections={
        "Joint and depth": ("r2_star", "depth_star"),
        "Options of the laws": tuple(OPTIONS),
        "Output": ("as_json",),
    },
    examples=["law stiffened_hertz --r2-star 200 --depth-star 0.1 --depth-star 0.3"],
)
def evaluate_law(
    name: LawName = typer.Argument(help=f"Contact law: {', '.join(LAWS)}.", metavar="NAME"),
    r2_star: float = cli.required("Socket radius divided by the clearance, R2/dR (> 1)."),
    depth_star: list[float] = cli.required(cli.DEPTHS),
    as_json: bool = cli.JSON,
    **options: OPTIONS,
):
    """Evaluate a contact law: the normalised force P/(E* dR^2) at given penetration depths.

    Here P is the contact force, E* the composite modulus of ball and socket, R2 the radius of the
    socket and dR the clearance, which is R2 less the radius of the ball.

    stiffened_hertz is valid for any pair of materials and for the supports listed below. winkler,
    hyperbolic_winkler and power have coefficients that are fitted to one joint; the defaults are
    those of the reference joint of the study.
    """
    cli.left_out(options, LAWS[name].options, f"the law {name}")
    force = LAWS[name](depth_star, r2_star, **options)
    show({"depth_star": depth_star, "force_star": force.tolist()}, as_json)
