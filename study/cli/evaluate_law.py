"""The command that evaluates a law: study law."""

import typer

from study.cli import options as cli
from study.cli.output import show
from study.contact import LAWS, LawName


def _options():
    """Options of all laws, each with the laws that have it."""
    about, owners = {}, {}
    for law in LAWS.values():
        about |= law.options
        for name in law.options:
            owners.setdefault(name, []).append(law.name)
    return {name: cli.option_of(about[name], f"for {', '.join(owners[name])}") for name in about}


@cli.command("law")
def evaluate_law(
    name: LawName = typer.Argument(help=f"One of {', '.join(LAWS)}.", metavar="NAME"),
    r2_star: float = cli.required("Socket radius over clearance, R2/dR, > 1."),
    depth_star: list[float] = cli.required(cli.DEPTHS),
    as_json: bool = cli.JSON,
    **options: _options(),
):
    """Evaluate a contact law: dimensionless force P/(E* dR^2) at given depths.

    stiffened_hertz is for any two materials and four supports. The paper's laws have the
    coefficients of its own joint unless others are given.
    """
    cli.left_out(options, LAWS[name].options, f"{name} does not depend on it")
    force = LAWS[name](depth_star, r2_star, **options)
    show({"depth_star": depth_star, "force_star": force.tolist()}, as_json)
