"""The command that compares models of the crank-slider."""

import click

from study.cases import scenes
from study.choose import compare_models
from study.choose.models import QUANTITIES
from study.cli.options import OUTPUT, case_of, options_of, show
from study.mechanism import Scene, simulate


def models(quantity, output, as_json, **options):
    """Compare models of the crank-slider, each with a finer one.

    The error is the RMS difference of a quantity to that of the finer model, divided by the RMS of
    its change; relative_cost is the computing time over that of rigid links with clearance. Take
    the first model that is accurate enough, and give it to study simulate.

    Example: study models --duration 0.1
    """
    scene, arguments = scenes.scene_and_arguments(case_of(options))
    show(compare_models(scene, quantity, **arguments), {}, output, as_json)


COMPARED = {n: of for n, of in scenes.PARAMETERS.items() if n not in scenes.ARGUMENTS} | {
    name: scenes.ARGUMENTS[name] for name in ("duration", "outputs", "law")
}
"""Parameters of study models."""
models_command = click.Command(
    "models",
    callback=models,
    params=[
        click.Option(
            ["--quantity"],
            type=click.Choice(QUANTITIES),
            default=QUANTITIES[0],
            help=f"Quantity whose errors are compared. Default: {QUANTITIES[0]}.",
        ),
        *options_of(COMPARED, Scene, simulate),
        *OUTPUT,
    ],
    help=models.__doc__,
)
