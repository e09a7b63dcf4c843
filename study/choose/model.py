"""The simplest model of the crank-slider that is accurate enough, by running finer ones.

The models in order of detail are rigid links with an ideal joint, rigid links with the clearance
joint, and links of particles on a coarse and on a fine mesh. The error of a model is the difference
between its motion of the slider and that of a finer model over the asked time: of the coarse
particles for rigid links, and of the fine ones for the coarse ones, which are run only if rigid
links are not accurate enough.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from time import perf_counter
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from study import checks
from study.checks import StudyError
from study.mechanism import simulate
from study.mechanism.compare import motion_nrms
from study.mechanism.law_in_scene import LAW, in_scene
from study.mechanism.response import Response
from study.mechanism.scene import Scene

Quantity = Literal["slider_position", "slider_velocity", "slider_acceleration"]
QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
COARSE, FINE = (2, 4), (4, 8)
"""Elements of crank and coupler of links of particles."""
WARM_UP = 1e-5  # s, simulated once before a model is timed


class ModelError(StudyError):
    """No model is known to be within the tolerance; ``known`` is the minimum error."""

    def __init__(self, message: str, known: float) -> None:
        super().__init__(message)
        self.known = known


@dataclass(frozen=True)
class ModelChoice:
    """The chosen model of a mechanism, with the evidence.

    Attributes
    ----------
    model, joint
        Model of the links, and joint (``clearance`` or ``ideal``).
    elements
        Elements of crank and coupler of links of particles, else None.
    error
        NRMS difference of the slider's motion to that of a finer model over the duration.
    relative_cost
        Computing time relative to that of rigid links with the clearance joint, measured during
        the choice.
    quantity
        The part of the slider's motion that was compared.
    evidence
        The attributes from ``model`` to ``relative_cost`` of every model that was compared, in
        order of detail.
    simulate
        Function that simulates the mechanism; it accepts ``progress`` as
        `study.mechanism.simulate` does.
    """

    model: str
    joint: str
    elements: tuple[int, int] | None
    error: float
    relative_cost: float
    quantity: Quantity
    evidence: tuple[dict, ...]
    simulate: Callable = field(repr=False, compare=False)


class _Run(NamedTuple):
    """A model that was run: what `ModelChoice` says of it, its response, and its time in s."""

    description: dict[str, Any]
    response: Response
    seconds: float
    simulate: Callable


def choose_model(
    scene: Scene,
    tolerance: float,
    duration: float = 0.1,
    outputs: int = 1000,
    quantity: Quantity = "slider_position",
    law: Any = LAW,
) -> ModelChoice:
    """Simplest model whose motion of the slider differs little enough from that of a finer one.

    Parameters
    ----------
    scene
        Mechanism parameters.
    tolerance
        Maximum NRMS difference, > 0 and <= 1: the RMS difference of the quantity divided by the RMS
        of its change since t = 0.
    duration, outputs
        Simulated time in s and number of output intervals, as in `study.mechanism.simulate`.
    quantity
        The part of the slider's motion to which the tolerance applies.
    law
        Contact law of all models, as in `study.mechanism.simulate`.

    Raises
    ------
    ValueError
        If a value is outside its range, or the slider does not move.
    ModelError
        If not even the coarse particles are within the tolerance.
    study.checks.StudyError
        If a simulation fails.

    Examples
    --------
    >>> choice = choose_model(Scene(), tolerance=0.01, duration=0.05)
    >>> choice.model, choice.joint
    ('rigid', 'ideal')
    """
    checks.number("tolerance", tolerance, above=0, most=1, scalar=True)
    checks.choice("quantity", quantity, QUANTITIES)
    law = in_scene(scene, law)
    run = partial(_run, scene, law=law, duration=duration, outputs=outputs)
    runs = [run("rigid", "ideal"), run("rigid", "clearance")]
    if not np.ptp(getattr(runs[0].response, quantity)) > 0:
        raise ValueError(
            f"duration must be long enough for the slider to move, got {duration:g} s; increase it"
        )
    runs.append(run("particles", "clearance", elements=COARSE))
    errors = [_difference(rigid, runs[2], quantity) for rigid in runs[:2]]
    if min(errors) > tolerance:
        runs.append(run("particles", "clearance", elements=FINE))
        errors.append(_difference(runs[2], runs[3], quantity))
    evidence = tuple(
        of.description | {"error": error, "relative_cost": of.seconds / runs[1].seconds}
        for of, error in zip(runs, errors, strict=False)  # the finest one is not judged
    )
    within = [n for n, error in enumerate(errors) if error <= tolerance]
    if not within:
        known = min(errors)
        raise ModelError(
            f"no model is known to give the {quantity.replace('_', ' ')} within the tolerance "
            f"{tolerance:g}: the minimum difference to a finer model is {known:.2g} over "
            f"{duration:g} s; give a larger tolerance or a shorter duration",
            known,
        )
    return ModelChoice(
        **evidence[within[0]],
        quantity=quantity,
        evidence=evidence,
        simulate=runs[within[0]].simulate,
    )


def _difference(coarse, fine, quantity):
    return motion_nrms(fine.response, coarse.response, quantity)


def _run(scene, model, joint, law, duration, outputs, **settings):
    """Run a model once, after its loops are compiled."""
    run = partial(simulate, scene, model=model, joint=joint, law=law, outputs=outputs, **settings)
    run(duration=min(WARM_UP, duration))
    start = perf_counter()
    response = run(duration=duration)
    description = {"model": model, "joint": joint, "elements": settings.get("elements")}
    return _Run(description, response, perf_counter() - start, partial(run, duration=duration))
