"""The command that compares models of the crank-slider."""

import click

from study.cases import scenes
from study.choose import compare_models
from study.cli.options import OUTPUT, case_of, options_of, show
from study.mechanism import Scene, simulate
from study.parameters import Quantity


def models(output, as_json, **options):
    """Compare models of the crank-slider, each with a finer one.

    The errors of the slider's position, velocity and acceleration are the RMS difference to the
    finer model, divided by the RMS of the change since t = 0; relative_cost is the computing time
    over that of rigid links with clearance. The models are in order of detail: take the first one
    that is accurate enough, and give it to study simulate.

    Example: study models --duration 0.1
    """
    scene, arguments = scenes.scene_and_arguments(case_of(options))
    show(compare_models(scene, **arguments), ERRORS, output, as_json)


ERRORS = {
    f"{name}_error": Quantity(f"NRMS error of the slider's {name}", read="%")
    for name in ("position", "velocity", "acceleration")
}
COMPARED = {n: of for n, of in scenes.PARAMETERS.items() if n not in scenes.ARGUMENTS} | {
    name: scenes.ARGUMENTS[name] for name in ("duration", "outputs", "law")
}
"""Parameters of study models."""
models_command = click.Command(
    "models",
    callback=models,
    params=[*options_of(COMPARED, Scene, simulate), *OUTPUT],
    help=models.__doc__,
)
