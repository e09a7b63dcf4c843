"""Error of rigid links relative to flexible ones: an estimate, and an empirical bound.

Flexible links change the motion of the slider in proportion to the compliance of the links and to
the maximum contact force, and its derivatives also with the natural frequencies of the links. The
change grows as the crank turns, because each changed impact changes its speed. The ratio of the
error of rigid links to this estimate is random: it varies by more than a factor of ten, and large
values are not rare. The bound is therefore the maximum ratio in many random mechanisms
(`LARGEST_RATIOS`) times a large factor (`SAFETY`). It is valid within the range of these mechanisms
only.
"""

from math import pi, sqrt
from typing import Any, Literal, get_args

import numpy as np

from study.contact import Material
from study.contact.forces import elastic_force
from study.mechanism.law_in_scene import in_scene
from study.mechanism.response import Response
from study.mechanism.scene import Scene

Quantity = Literal["slider_position", "slider_velocity", "slider_acceleration"]
QUANTITIES = get_args(Quantity)
LARGEST_RATIOS: dict[Quantity, float] = {
    "slider_position": 44.19,
    "slider_velocity": 0.0863,
    "slider_acceleration": 0.01488,
}
"""Maximum ratio of the error of rigid links to its estimate in the random mechanisms of
``data/links.csv`` (`study.choose.random_scenes`), rounded up. Their parameters have the following
ranges."""
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
"""SI units; the coefficient of restitution is that of a free impact. All other parameters are those
of the paper."""
SAFETY = 10.0
"""Factor on the maximum ratio; other mechanisms exceed this ratio by a factor of up to 5."""


def ratios(scene: Scene, depth: float) -> dict[str, Any]:
    """Links compared with Hertz's contact at a depth in m: two ratios, which are 0 without contact.

    ``compliance_ratio`` is the compliance of both links along their axes divided by that of the
    contact. ``frequency_ratio`` is the natural frequency of the slider on the contact divided by
    the lowest axial natural frequency of the crank.
    """
    contact = elastic_force(in_scene(scene, "hertz").packed(), depth)[1]
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
    """Estimated relative change by flexible links, for each quantity of `QUANTITIES`.

    For the position the change is the maximum contact force times the compliance of the links. For
    the velocity it is also multiplied by the bending frequency of the crank, and for the
    acceleration by the square of its axial frequency. Because position and velocity drift, their
    changes are multiplied by one plus the crank angle. Each change is divided by the RMS change of
    the quantity since t = 0. The response is that of rigid links with clearance; without contact
    the estimate is 0.
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
    """Bounds of the NRMS errors of rigid links, from their response with clearance."""
    shares = estimates(scene, response).items()
    return {quantity: share * SAFETY * LARGEST_RATIOS[quantity] for quantity, share in shares}


def outside(scene: Scene, duration: float) -> str:
    """Why a mechanism and a duration in s are outside the random ones; empty if they are not."""
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
