"""The function `simulate`, which runs every model of the crank-slider, with checked arguments.

`study.choose.compare_models` compares the models.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

import warnings
from collections.abc import Callable
from math import sqrt
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.lib.recfunctions import repack_fields

from study import checks
from study.contact import DimensionalLaw
from study.contact.laws import AnyLaw
from study.mechanism import beams, events, ideal, law_in_scene, particles, response
from study.mechanism.law_in_scene import LAW
from study.mechanism.response import ALL_COLUMNS, COLUMNS, EVENTS, Response
from study.mechanism.rigid import add_free_durations
from study.mechanism.scene import Scene
from study.mechanism.stepping import START, MechanismError, add_stored_energy
from study.parameters import Parameter, describe, described

if TYPE_CHECKING:
    from study.joint import Joint

Model = Literal["rigid", "particles", "beams"]
JointKind = Literal["clearance", "ideal", "ideal_with_friction"]
TOLERANCE, LEAST_TOLERANCE = 1e-8, 1e-12
BEAM_STEP, ELEMENTS, MOST_STEPS = 1e-6, (4, 8), 1e10
MOST_TURNED = 1e6
"""Largest angle in rad by which drive and gravity alone would turn the crank: some minutes of
computing for rigid links. A crank far too short or light for its drive does nothing but turn."""


@describe(
    scene=Parameter("Mechanism parameters", otherwise="`Scene()`"),
    model=Parameter(
        "Model of the links: rigid links, links of particles (the finite particle method of Yao "
        "et al.), or beams",
        choices=get_args(Model),
    ),
    joint=Parameter(
        "Joint between coupler and slider: with clearance, ideal, or ideal with the friction of "
        "the mechanism parameters, for rigid links only",
        choices=get_args(JointKind),
    ),
    law=Parameter(
        "Contact law: its name, or tabulated for a table of the joint's elastic solution. In "
        "Python it may also be a law such as Steuermann(n=2), a table of the values of a "
        "function (`study.contact.Table.of_values`), a law in SI units, or a `study.joint.Joint`; "
        "the last two must have the dimensions of the scene's joint, and its materials unless the "
        "scene has the default ones",
        kind=str,
    ),
    duration=Parameter("Simulated time", "s", {"above": 0, "most": 1e9}),
    outputs=Parameter(
        "Number of equal intervals between the output times",
        limits={"least": 1, "most": 10**6},
        whole=True,
    ),
    tolerance=Parameter(
        "Maximum local error of eccentricities and speeds, relative to the clearance, the depth of "
        "the impact and the speed that the drive gives, for rigid links with clearance",
        limits={"least": LEAST_TOLERANCE, "most": 0.01},
        otherwise=f"{TOLERANCE:g}",
    ),
    step=Parameter(
        "Flexible links: maximum time step",
        "s",
        {"above": 0},
        otherwise=f"{BEAM_STEP:g} for beams, half the stability limit for particles",
    ),
    elements=Parameter(
        "Flexible links: number of elements of crank and coupler, as N,N",
        limits={"least": 1, "most": 500},
        whole=True,
        several=",",
        count=2,
        otherwise="4,8",
    ),
    method=Parameter(
        "Particles: velocity that is used for damping and friction in the joint, either centred "
        "or half a step old (lagged); unguarded is lagged without checks of stability",
        choices=get_args(particles.Method),
        otherwise="centred",
    ),
    progress=Parameter(
        "Function that is called with the simulated time in s about every tenth of a second"
    ),
)
def simulate(
    scene: Scene | None = None,
    *,
    model: Model = "rigid",
    joint: JointKind = "clearance",
    law: AnyLaw | DimensionalLaw | Joint = LAW,
    duration: float = 0.1,
    outputs: int = 1000,
    tolerance: float | None = None,
    step: float | None = None,
    elements: tuple[int, int] | None = None,
    method: particles.Method | None = None,
    progress: Callable[[float], Any] | None = None,
) -> Response:
    """Simulate the crank-slider.

    The laws ``stiffened_hertz`` and ``tabulated`` are those of the scene's materials, in a socket
    with the wall of the reference joint. For another socket, give the law of its joint, for example
    ``clearance_joint(scene, wall=3e-3).law("stiffened_hertz")``
    (`study.mechanism.clearance_joint`).

    Returns
    -------
    Response
        After Ctrl-C it has the results up to then, and its attribute ``complete`` is False.

    Warns
    -----
    EnergyWarning
        If the energy balance shows an unstable contact, whose force may be wrong
        (`Response.energy_warning`). That there is no warning does not prove that it is right.

    Raises
    ------
    ValueError
        If a name is unknown, a value is outside its range, an argument does not apply to the model,
        or the law is for another socket radius or other materials than those of the scene.
    MechanismError
        If the simulation cannot continue. The message states the time, the step and the limit that
        was exceeded, and the attribute ``response`` has the results up to then.

    Examples
    --------
    >>> response = simulate(Scene(restitution=0.9), law="hertz", duration=0.005)
    >>> len(response.impacts), f"{response.impacts.peak_force.max():.0f} N"
    (2, '229 N')
    """
    scene = Scene() if scene is None else checks.instance("scene", scene, Scene)
    model, joint = _taken("model", model), _taken("joint", joint)
    duration, outputs = _taken("duration", duration), _taken("outputs", outputs)
    tolerance, step = _taken("tolerance", tolerance), _taken("step", step)
    elements, method = _taken("elements", elements), _taken("method", method)
    flexible, gapless = model != "rigid", joint != "clearance"
    for name, value, used in (
        ("tolerance", tolerance, not flexible and not gapless),
        ("step", step, flexible),
        ("elements", elements, flexible),
        ("method", method, model == "particles"),
    ):
        if value is not None and not used:
            which = f"model {model} with joint {joint}"
            raise ValueError(f"{name} does not apply to {which}; remove it")
    if flexible and joint == "ideal_with_friction":
        raise ValueError(f"joint must be clearance or ideal for model {model}, got {joint}")
    p = scene.constants()
    turned = abs(p.moment) * duration**2 / (2 * (p.a11 - p.m2 * p.l1**2))
    turned += abs(scene.starting_speed) * duration
    turned += sqrt(abs(scene.gravity) / scene.crank_length) * duration
    what = "angle by which the crank turns within the duration"
    checks.number(what, turned, "rad", most=MOST_TURNED)
    if step is not None:
        checks.number("step", step, "s", least=duration / MOST_STEPS)
    if gapless and isinstance(law, str) and law == LAW:
        law = "hertz"  # nothing touches: the range of the default law does not matter
    of_joint = law_in_scene.in_scene(scene, law)
    packed = of_joint.packed()
    times = duration * np.arange(outputs + 1) / outputs
    pair, tolerance = elements or ELEMENTS, tolerance or TOLERANCE
    if model == "particles":
        blocks = particles.blocks(scene, packed, times, gapless, step, pair, method or "centred")
    elif model == "beams":
        blocks = beams.blocks(scene, packed, times, gapless, step or BEAM_STEP, pair)
    elif gapless:
        blocks = ideal.blocks(scene, times, joint == "ideal_with_friction")
    else:
        blocks = events.blocks(scene, packed, times, tolerance)
    restitution = scene.restitution, scene.delivered_restitution
    stated = None if flexible or gapless else tolerance
    told = None if gapless else of_joint, *restitution, stated
    columns = COLUMNS if flexible else ALL_COLUMNS
    response = _gather(blocks, scene, packed, columns, told, progress)
    if response.energy_warning:
        warnings.warn(response.energy_warning, checks.EnergyWarning, stacklevel=2)
    return response


def _taken(name, value):
    """Argument of `simulate`, checked; None stays."""
    return None if value is None else described(simulate)[name].taken(name, value)


def _gather(blocks, scene, law, columns, told, progress):
    """Run a model to its end or to an interruption; ``told`` are further fields of the response."""
    rows, complete, failed = None, True, None
    try:
        for rows, impacts, own in blocks:  # noqa: B007
            if progress is not None:
                progress(rows["time"][-1])
    except (KeyboardInterrupt, MechanismError) as error:
        if rows is None:
            raise
        complete, failed = False, error if isinstance(error, MechanismError) else None
    starts = own[:, START].copy()  # of one layout, with impacts or without
    add_free_durations(*(t.view(np.recarray) for t in (starts, impacts)), scene.constants(), law)
    happened = own["time"] <= rows["time"][-1]  # the others are NaN, or come after an interruption
    names = np.broadcast_to(EVENTS, happened.shape)
    own, kinds = own[happened], tuple(names[happened].tolist())
    first = rows["work"][0]
    for table in (own, rows):
        table["work"] -= first
        add_stored_energy(table.view(np.recarray), law)
    own, rows = (repack_fields(table[list(columns)]) for table in (own, rows))
    impact_rows = np.zeros(len(impacts), response.IMPACT_ROW)
    for name in response.IMPACT_COLUMNS:
        impact_rows[name] = impacts[name]
    is_sustained = impacts["duration"] > response.SUSTAINED * impacts["free_duration"]
    impact_rows["kind"] = np.where(is_sustained, "sustained", "impact")
    result = Response(rows, impact_rows, own, kinds, complete, *told)
    if failed is None:
        return result
    failed.response = result
    raise failed
