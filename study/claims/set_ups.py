"""Random crank-sliders, to find one that satisfies the statements of the paper on Figs. 17 to 21.

Lengths, masses, clearance, material and the magnitude of the moment are those of Table 3 and
Sec. 4.3.1. All parameters that the paper leaves open vary together. In half of the mechanisms
friction, restitution and the first crank angle vary too, although the paper states them. Friction
between slider and slide is left out, because no model of this study contains it. `run` makes
``data/set_ups.csv``, and `study.claims.search` evaluates it.
"""

from collections.abc import Iterable, Iterator
from math import cos, pi, sin
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from study.claims.motion_quantities import motion_quantities
from study.mechanism import MechanismError, Scene, simulate, stable_step
from study.mechanism.compare import motion_nrms, phase_lead
from study.mechanism.simulate import Model

MECHANISMS = 64
JOINTS = {"rigid": 16, "both": 1, "particles": 4, "schemes": 8}
"""Number of joints of each mechanism, by the models of the links with which they are simulated:
rigid links, both flexible models, particles only, and particles in a scheme that may add energy.
They are powers of 2, as Sobol points require."""
ELEMENTS = (2, 4)
MODELS: dict[Model, dict[str, Any]] = {
    "rigid": {},
    "particles": {"elements": ELEMENTS},
    "beams": {"elements": ELEMENTS, "step": 4e-6},
}
"""Models of the links, with the mesh and the step of the flexible models."""
OF_KIND: dict[str, tuple[Model, ...]] = {
    "rigid": ("rigid",),
    "both": ("particles", "beams"),
    "particles": ("particles",),
    "schemes": ("particles",),
    "found": ("rigid", "particles", "beams"),
}
PER_SECOND = 10_000
"""Number of output times per second."""
RANGES = {
    "duration": (0.05, 1.0),
    "crank_inertia_factor": (1.0, 2.0),
    "coupler_inertia_factor": (1.0, 1.5),
    "density": (1400.0, 8000.0),
    "link_modulus": (2e9, 207e9),
    "restitution": (0.1, 1.0),
    "friction": (0.0, 0.3),
    "socket_radius": (2e-3, 30e-3),
    "eccentricity": (0.0, 0.98),
    "crank_clearance": (1e-5, 1e-4),
    "step_share": (0.3, 1.0),
}
"""SI units. Inertias are divided by those of thin rods. Density and modulus determine the cross
section of flexible links. The eccentricity at the start is in clearances, and the step is a
fraction of the stability limit."""
LOGARITHMIC = ("duration", "density", "link_modulus", "socket_radius", "crank_clearance")
CHOICES: dict[str, tuple] = {
    "as_stated": (True, False),
    "driving_moment": (0.5, -0.5),
    "gravity": (0.0, 9.81),
    "damping": ("lankarani-nikravesh", "hunt-crossley", "flores", "exact"),
    "law": ("hyperbolic_winkler", "hertz", "stiffened_hertz"),
    "method": ("lagged", "unguarded", "centred"),
}
OF_MECHANISM = (
    *("as_stated", "duration", "crank_inertia_factor", "coupler_inertia_factor", "density"),
    *("link_modulus", "driving_moment", "gravity", "initial_crank_angle"),
)
OF_JOINT = (
    *("restitution", "damping", "friction", "socket_radius", "law"),
    *("eccentricity", "direction", "crank_clearance", "method", "step_share"),
)
_FLEXIBLE = ("density", "link_modulus")
_SCHEME = ("method", "step_share")


class SetUp(NamedTuple):
    """Parameters drawn for a mechanism, and for each of its joints, by the kind of their runs."""

    number: int
    mechanism: dict[str, Any]
    joints: dict[str, list[dict[str, Any]]]


FOUND = tuple(
    SetUp(
        number,
        {"as_stated": stated} | dict(zip(OF_MECHANISM[1:], mechanism, strict=True)),
        {"found": [dict(zip(OF_JOINT[:-2], joint, strict=True))]},
    )
    for number, (stated, mechanism, joint) in enumerate(
        (
            (
                False,
                (0.062, 1.894, 1.208, 1902.0, 6.215e9, -0.5, 9.81, 4.2423),
                (0.4537, "flores", 0.0117, 5.299e-3, "hertz", 0.4763, 26.53, 1.703e-5),
            ),
            (
                True,
                (0.05, 2.0, 1.125, 7386.0, 2.043e11, -0.5, 9.81, pi),
                (0.5, "lankarani-nikravesh", 0.05, 0.01518, "stiffened_hertz", 0.9094, 18.1, None),
            ),
            (
                False,
                (0.051, 1.735, 1.447, 2208.0, 1.766e10, -0.5, 9.81, 4.0404),
                (0.5, "hunt-crossley", 0.05, 3.112e-3, "hertz", 0.9773, 22.84, 6.45e-5),
            ),
        ),
        start=MECHANISMS,
    )
)
"""Results of three directed searches with rigid links. Differential evolution and then random steps
minimised the sum of the amounts by which the statements miss their bounds. In the first search all
parameters were free; in the second, those that the paper states were fixed, including Eq. 31; in
the third, friction and restitution were fixed, and the first crank angle was free."""


def draw(seed: int = 0, count: int = MECHANISMS) -> Iterator[SetUp]:
    """Set-ups evenly distributed over all ranges (Sobol points); a seed always gives the same."""
    from scipy.stats import qmc

    def points(names, number, start):
        shares = qmc.Sobol(len(names), rng=np.random.default_rng(start)).random(number)
        return [{n: _value(n, float(u)) for n, u in zip(names, p, strict=True)} for p in shares]

    joints = {
        kind: points(OF_JOINT, count * size, [seed, 1 + k])
        for k, (kind, size) in enumerate(JOINTS.items())
    }
    stated = {name: getattr(Scene, name) for name in ("friction", "restitution")}
    for number, mechanism in enumerate(points(OF_MECHANISM, count, [seed, 0])):
        own = {kind: joints[kind][number * size :][:size] for kind, size in JOINTS.items()}
        if mechanism["as_stated"]:
            mechanism["initial_crank_angle"] = (0.0, pi)[mechanism["initial_crank_angle"] > pi]
            own = {kind: [joint | stated for joint in some] for kind, some in own.items()}
        yield SetUp(number, mechanism, own)


def _value(name, share):
    """The value of a parameter at a fraction from 0 to 1 of its range."""
    if name in CHOICES:
        return CHOICES[name][int(share * len(CHOICES[name]))]
    if name == "initial_crank_angle":
        return round(2 * pi * share, 4)
    if name == "direction":
        return round(360 * share, 2)
    if name == "crank_clearance":  # half without
        if share < 0.5:
            return None
        share = 2 * share - 1
    low, high = RANGES[name]
    value = low * (high / low) ** share if name in LOGARITHMIC else low + (high - low) * share
    return round(value, 3) if name == "duration" else float(f"{value:.4g}")


def scene(mechanism: dict[str, Any], joint: dict[str, Any], model: Model) -> Scene:
    """The scene of a set-up; only rigid links have a second clearance."""
    usual, angle = Scene(), joint["direction"] * pi / 180
    rods = dict(zip(("crank_inertia", "coupler_inertia"), usual.inertias, strict=True))
    out = joint["eccentricity"] * usual.clearance
    return Scene(
        **{name: rod * mechanism[f"{name}_factor"] for name, rod in rods.items()},
        **{k: v for k, v in mechanism.items() if k in vars(usual)},
        **{n: joint[n] for n in ("restitution", "damping", "friction", "socket_radius")},
        initial_eccentricity=(out * cos(angle), out * sin(angle)),
        crank_clearance=joint["crank_clearance"] if model == "rigid" else None,
    )


def run(set_ups: Iterable[SetUp]) -> pd.DataFrame:
    """Simulate set-ups: a row for each run, with the parameters drawn and `motion_quantities`.

    If a simulation does not finish, its row has no results.
    """
    return pd.DataFrame([row for one in set_ups for row in _rows(one)])


def _rows(one):
    """Rows of one set-up; its joints share the responses with an ideal joint."""
    duration = one.mechanism["duration"]
    usual = {"duration": duration, "outputs": round(duration * PER_SECOND)}

    def respond(drawn, model, **options):
        own = scene(one.mechanism, drawn, model)
        if "method" in options:
            options["step"] = drawn["step_share"] * stable_step(own, ELEMENTS)
        try:
            return simulate(own, model=model, **usual, **MODELS[model], **options)
        except MechanismError:
            return None

    some = next(iter(one.joints.values()))[0] | {"crank_clearance": None}
    needed = dict.fromkeys(model for kind in one.joints for model in OF_KIND[kind])
    ideal = {model: respond(some, model, joint="ideal") for model in needed}
    for kind, joint in [(kind, joint) for kind, some in one.joints.items() for joint in some]:
        options = {"law": joint["law"]}
        if kind == "schemes":
            options["method"] = joint["method"]
        found = {model: respond(joint, model, **options) for model in OF_KIND[kind]}
        apart = _apart(ideal, found) if "beams" in found else {}
        for model, response in found.items():
            without = _FLEXIBLE if model == "rigid" else ("crank_clearance",)
            without += _SCHEME if kind != "schemes" else ()
            drawn = one.mechanism | joint | dict.fromkeys(without)
            row = {"set_up": one.number, "kind": kind, "model": model} | drawn
            if response is not None and ideal[model] is not None:
                numbers = motion_quantities(response, ideal[model]) | _energy(
                    response, ideal[model]
                )
                numbers |= apart if model != "rigid" else {}
                row |= {name: float(f"{number:.4g}") for name, number in numbers.items()}
            yield row


def _apart(*pairs):
    """Difference of the two methods, with an ideal joint and with clearance: the larger."""
    names = {f"{q} of the slider": f"slider_{q}" for q in ("position", "velocity", "acceleration")}
    if any(pair[model] is None for pair in pairs for model in OF_KIND["both"]):
        return {}
    return {
        f"difference of the two methods, {name}": 100
        * max(motion_nrms(pair["beams"], pair["particles"], column) for pair in pairs)
        for name, column in names.items()
    }


def _energy(response, ideal):
    """Phase lead of the crank, the lag that the lost energy explains, and the balance of energy.

    A lost energy E reduces the speed of the crank by the fraction E/(2 T), where T is the kinetic
    energy.
    """
    lost, kinetic = response.lost_damping + response.lost_friction, response.kinetic
    share = np.divide(lost, 2 * kinetic, out=np.zeros_like(lost), where=kinetic > 0)
    ahead, work = 1e3 * phase_lead(response, ideal), response.work[-1]
    unexplained = kinetic[-1] + response.elastic[-1] + lost[-1] - kinetic[0] - work
    return {
        "lead_ms": ahead[-1],
        "largest_lead_ms": ahead.max(),
        "turns": abs(ideal.crank_angle[-1] - ideal.crank_angle[0]) / (2 * pi),
        "lag_of_losses_ms": 1e3 * np.trapezoid(share, response.time),
        "lost_percent": 100 * lost[-1] / work,
        "fed_in_percent": 100 * unexplained / work,
        "energy_error": response.energy_error,
    }
