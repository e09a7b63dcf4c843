"""How far rigid links are from flexible ones: an estimate, and the bound that was found for it.

The slider's motion changes with the links' compliance times the largest contact force, and its
rates with the links' frequencies too. The change grows as the crank turns, because other impacts
leave it with another speed. The rest is chance: the ratio of the error of rigid links to this
estimate scatters by more than a decade, with a heavy tail. The bound is therefore the largest ratio
of many random scenes (`LARGEST_RATIOS`) times a large `SAFETY`. It holds within the range of those
scenes only.
"""

from math import pi, sqrt
from typing import Any, Literal, get_args

import numpy as np

from study.contact import Material, hertz
from study.contact.forces import elastic_force
from study.mechanism.law_in_scene import in_joint
from study.mechanism.response import Response
from study.mechanism.scene import Scene

Quantity = Literal["slider_position", "slider_velocity", "slider_acceleration"]
QUANTITIES = get_args(Quantity)
LARGEST_RATIOS: dict[Quantity, float] = {
    "slider_position": 44.19,
    "slider_velocity": 0.0863,
    "slider_acceleration": 0.01488,
}
"""Largest ratio of the error of rigid links to its estimate, of the random scenes in
``data/links.csv`` (`study.choose.random_scenes`), rounded up. They have these ranges:"""
RANGES = {
    "link_modulus": (5e9, 2e12),
    "driving_moment": (0.05, 5.0),
    "clearance": (1e-5, 2e-4),
    "crank_mass": (0.1, 1.0),
    "coupler_mass": (0.1, 1.0),
    "slider_mass": (0.05, 1.0),
    "crank_length": (0.02, 0.07),
    "coupler_length": (0.1, 0.3),
    "duration": (0.02, 0.2),
    "restitution": (0.1, 0.95),
    "friction": (0.0, 0.2),
}
"""SI units; the restitution is the one delivered. All other parameters are the paper's."""
SAFETY = 10.0
"""Factor on the largest ratio; other scenes exceed that ratio by a factor of up to 5."""


def ratios(scene: Scene, depth: float) -> dict[str, Any]:
    """Links compared with Hertz's contact at a depth in m: two ratios, 0 without contact.

    ``compliance_ratio`` is that of both links along their axes over the contact's,
    ``frequency_ratio`` the slider's frequency on the contact over the crank's axial one.
    """
    contact = elastic_force(in_joint(scene, hertz, scene.clearance).packed(), depth)[1]
    compliance, _, axial = _compliance_and_frequencies(scene)
    frequency = sqrt(contact / scene.slider_mass)
    return {"compliance_ratio": compliance * contact, "frequency_ratio": frequency / axial}


def _compliance_and_frequencies(scene):
    """Compliance of both links along their axes (m/N), lowest frequencies of the crank (rad/s)."""
    crank, coupler = scene.link("crank"), scene.link("coupler")
    compliance = crank.length / crank.axial + coupler.length / coupler.axial
    # in bending simply supported, along its axis with one end held
    bending = (pi / crank.length) ** 2 * sqrt(crank.bending / crank.mass_per_length)
    axial = pi / (2 * crank.length) * sqrt(crank.axial / crank.mass_per_length)
    return compliance, bending, axial


def estimates(scene: Scene, response: Response) -> dict[Quantity, float]:
    """Estimated change by flexible links, as a share of each quantity of `QUANTITIES`.

    For the position it is the largest contact force times the links' compliance. For the velocity
    the crank's bending frequency is a factor too, for the acceleration its axial frequency squared.
    Position and velocity drift: one plus the crank's angle is another factor of theirs. The
    response is of rigid links with clearance; without contact the estimate is 0.
    """
    compliance, bending, axial = _compliance_and_frequencies(scene)
    change = compliance * response.impact_rows["peak_force"].max(initial=0.0)
    drift = 1 + np.abs(response.crank_angle).max()
    factors = (drift, drift * bending, axial**2)
    shares = {}
    for quantity, factor in zip(QUANTITIES, factors, strict=True):
        values = getattr(response, quantity)
        size = np.sqrt(np.mean((values - values[0]) ** 2))
        shares[quantity] = float(change * factor / size)
    return shares


def bounds(scene: Scene, response: Response) -> dict[Quantity, float]:
    """Bounds of the NRMS errors of rigid links, whose response with clearance is known."""
    shares = estimates(scene, response).items()
    return {quantity: share * SAFETY * LARGEST_RATIOS[quantity] for quantity, share in shares}


def outside(scene: Scene, duration: float) -> str:
    """Why a scene and a duration, in s, are outside the random scenes; empty if they are not."""
    others = {"link_modulus": scene.link_modulus or scene.youngs_modulus, "duration": duration}
    others |= {"restitution": scene.delivered_restitution}
    for name, value in (vars(scene) | others).items():
        words = name.replace("_", " ")
        if name in RANGES:
            low, high = RANGES[name]
            if not low <= value <= high:
                return f"{words} {value:g} is outside the range of the random scenes"
        elif name != "damping" and value != getattr(Scene, name):
            what = "material" if isinstance(value, Material) else value
            return f"{words} {what} is not that of the random scenes"
    return ""
