"""The simplest model of the crank-slider that is accurate enough, with the evidence.

The models in order of detail are an ideal joint, which needs no data of the contact; rigid links
with Hertz's law; rigid links with an accurate law for the joint; and links of particles. Models
with rigid links take milliseconds, so that all are simulated and compared. The effect of flexible
links is first bounded from their compliance and frequencies (`study.choose.links`). Particles are
simulated only if this bound is too large, on two meshes and with two steps. Because impacts are
chaotic, a finer mesh need not give a smaller error; the bound is therefore three times the maximum
difference.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache, partial
from math import inf
from operator import itemgetter
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from study import checks
from study.checks import StudyError
from study.choose import links
from study.choose.cheapest_law import SHALLOWEST, choose
from study.choose.links import Quantity
from study.contact import SOCKET_RATIO, Hertz
from study.joint import Joint
from study.mechanism import simulate
from study.mechanism.compare import motion_nrms
from study.mechanism.law_in_scene import in_scene
from study.mechanism.particles import usual_step
from study.mechanism.response import Response
from study.mechanism.scene import Scene

LAW_TOLERANCE = 0.01
"""Maximum relative error of the force of the law that is used instead of the elastic solution."""
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
FINEST_TOLERANCE = 1e-10
"""Tolerance of the reference for the steps of rigid links; those of `TOLERANCES` are tried."""
STEP_SHARE = 0.1  # of the tolerance, for the error of the steps
COARSE, FINE = (2, 4), (4, 8)
"""Elements of crank and coupler of flexible links."""
HERTZ = ("hertz", ())
"""A law, and the names and values of its options."""
SAFETY = 3.0
"""Factor on the maximum difference by mesh and step of flexible links."""
STEPPERS = {"rigid": "collocation of order 9", "particles": "central difference"}
WARM_UP = 1e-5  # s, simulated once before a model is timed


class ModelError(StudyError):
    """No model is known to be within the tolerance; ``known`` is the minimum error bound."""

    def __init__(self, message: str, known: float) -> None:
        super().__init__(message)
        self.known = known


@dataclass(frozen=True)
class ModelChoice:
    """The chosen model of a mechanism, with the evidence.

    Attributes
    ----------
    model, joint, law
        Model of the links, joint (``clearance`` or ``ideal``), and contact law (``none`` for an
        ideal joint).
    settings
        Time integration, and its tolerance, or its step in s and the number of elements.
    error_bound
        Bound of the NRMS error of the slider's motion over the duration. It is not proved but
        estimated with a margin (`SAFETY` here and in `links`), because impacts of flexible links
        are chaotic.
    relative_cost
        Computing time relative to that of rigid links with Hertz's law, measured during the choice.
    links
        How the contribution of flexible links to the bound is known: ``bounded`` or ``compared``.
    quantity
        The part of the slider's motion whose error is bounded.
    compliance_ratio, frequency_ratio
        Ratios of `links.ratios` at the maximum depth.
    depth_star
        Maximum penetration depth with rigid links and Hertz's law, in clearances.
    note
        Why this mechanism is outside the range of the random ones on which ``bounded`` is based;
        empty if it is not.
    evidence
        The attributes from ``model`` to ``links`` of every model that was compared, in order of
        detail.
    simulate
        Function that simulates the mechanism; it accepts ``progress`` as
        `study.mechanism.simulate` does.
    """

    model: str
    joint: str
    law: str
    settings: dict
    error_bound: float
    relative_cost: float
    links: str
    quantity: Quantity
    compliance_ratio: float
    frequency_ratio: float
    depth_star: float
    note: str
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
    socket_ratio: float = SOCKET_RATIO,
) -> ModelChoice:
    """Simplest model whose motion of the slider is known to be within a tolerance.

    Parameters
    ----------
    scene
        Mechanism parameters.
    tolerance
        Maximum NRMS error, > 0 and <= 1: the RMS error of the quantity divided by the RMS of its
        change since t = 0.
    duration, outputs
        Simulated time in s and number of output intervals, as in `study.mechanism.simulate`.
    quantity
        The part of the slider's motion to which the tolerance applies.
    socket_ratio
        Outer radius of the socket divided by its inner radius. The supports are the defaults of
        `study.joint.Joint`.

    Raises
    ------
    ValueError
        If a value is outside its range.
    ModelError
        If no model is known to be within the tolerance.
    study.checks.StudyError
        If no law is known to give the contact force within `LAW_TOLERANCE`, or a simulation fails.

    Examples
    --------
    >>> choice = choose_model(Scene(), tolerance=0.01, duration=0.05)
    >>> choice.model, choice.joint
    ('rigid', 'ideal')
    """
    checks.number("tolerance", tolerance, above=0, most=1, scalar=True)
    checks.choice("quantity", quantity, links.QUANTITIES)
    run = partial(_run, scene, duration, outputs)

    def difference(compared, reference):
        return motion_nrms(reference.response, compared.response, quantity)

    with_hertz = run("rigid", HERTZ, tolerance=FINEST_TOLERANCE)
    if not all(np.ptp(getattr(with_hertz.response, name)) > 0 for name in links.QUANTITIES):
        raise ValueError(
            f"duration must be long enough for the slider to move, got {duration:g} s; increase it"
        )
    depth = float(with_hertz.response.impact_rows["peak_depth"].max(initial=0.0))
    law, law_share = _law(scene, depth, socket_ratio)
    with_law = run("rigid", law, tolerance=FINEST_TOLERANCE)
    of_law = law_share * difference(with_hertz, with_law)

    loosest = partial(_loosest, run, difference, STEP_SHARE * tolerance)
    runs = [run("rigid", HERTZ, joint="ideal"), loosest(HERTZ, with_hertz), loosest(law, with_law)]
    unit, how, changes = runs[1].seconds, "bounded", {}
    from_law = [difference(rigid, with_law) for rigid in runs]
    note = links.outside(scene, duration)
    of_links = inf if note else links.bounds(scene, with_hertz.response)[quantity]
    bounds = [error + of_law + of_links for error in from_law]
    if min(bounds) > tolerance:
        coarse, fine = (run("particles", law, elements=pair) for pair in (COARSE, FINE))
        half = run("particles", law, step_share=0.5, elements=FINE)
        changes = {
            "refining the mesh": difference(coarse, fine),
            "halving the step": difference(half, fine),
        }
        doubt, how = SAFETY * max(changes.values()) + of_law, "compared"
        of_links = difference(with_law, fine) + doubt
        bounds = [min(b, error + of_links) for b, error in zip(bounds, from_law, strict=True)]
        runs, bounds = [*runs, coarse, fine], [*bounds, doubt, doubt]

    evidence = tuple(
        of.description | {"error_bound": bound, "relative_cost": of.seconds / unit, "links": how}
        for of, bound in zip(runs, bounds, strict=True)
    )
    within = [n for n, bound in enumerate(bounds) if bound <= tolerance]
    if not within:
        cause, change = max(changes.items(), key=itemgetter(1))
        known = min(bounds)
        raise ModelError(
            f"no model is known to give the {quantity.replace('_', ' ')} within the tolerance "
            f"{tolerance:g}: the minimum error bound is {known:.2g}, because {cause} of flexible "
            f"links changes the result by {change:.2g} over {duration:g} s; give a larger "
            "tolerance or a shorter duration",
            known,
        )
    return ModelChoice(
        **evidence[within[0]],
        **links.ratios(scene, depth),
        quantity=quantity,
        depth_star=depth / scene.clearance,
        note=note,
        evidence=evidence,
        simulate=runs[within[0]].simulate,
    )


def _law(scene, depth, socket_ratio):
    """Law in place of the elastic solution, its options, and its error over that of Hertz's law."""
    r2_star = scene.socket_radius / scene.clearance
    ball, socket = scene.materials
    joint = Joint.from_ratios(r2_star, socket_ratio, ball=ball, socket=socket)
    choice = choose(joint, 1.0, LAW_TOLERANCE)
    law = choice.law, ()
    at = max(depth / scene.clearance, SHALLOWEST), r2_star
    of_hertz = abs(Hertz()(*at) / choice.law(*at) - 1)
    return law, choice.error_bound / of_hertz if of_hertz > 0 else 1.0


def _loosest(run, difference, allowed, law, finest):
    """Rigid links with the largest tolerance whose steps change the motion little enough."""
    looser = (run("rigid", law, tolerance=tolerance) for tolerance in TOLERANCES)
    return next((rigid for rigid in looser if difference(rigid, finest) <= allowed), finest)


@lru_cache(maxsize=32)
def _run(scene, duration, outputs, model, law, joint="clearance", step_share=1.0, **settings):
    """Run a model once for all tolerances; ``step_share`` is of the particles' usual step."""
    function = law[0]
    name, stepper = function if isinstance(function, str) else function.name, STEPPERS[model]
    if joint == "ideal":
        name, stepper = "none", "DOP853"
    if model == "particles":
        packed = in_scene(scene, function).packed()
        settings["step"] = step_share * usual_step(scene, packed, settings["elements"])
    run = partial(simulate, scene, model=model, joint=joint, law=function, duration=duration)
    run = partial(run, outputs=outputs, **settings)
    run(duration=min(WARM_UP, duration), outputs=1)
    start = perf_counter()
    response = run()
    seconds = perf_counter() - start
    description = {"model": model, "joint": joint, "law": name}
    description["settings"] = {"stepper": stepper} | settings
    return _Run(description, response, seconds, run)
