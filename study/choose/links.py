"""How far rigid links are from flexible ones: an estimate, and a bound from random scenes.

The slider's motion changes with the links' compliance times the largest contact force, and its
rates with the links' frequencies too. The change grows as the crank turns, because other impacts
leave it with another speed. The rest is chance: the ratio of the error of rigid links to this
estimate scatters by more than a decade, with a heavy tail. The bound is therefore the largest ratio
of ``data/links.csv`` times a large `SAFETY`, and holds within the range of those scenes only.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from functools import partial
from math import pi, sqrt
from typing import Any, Literal, get_args

import numpy as np
import pandas as pd

from study.contact import LawName, Material
from study.contact.forces import elastic_force, pack
from study.mechanism.compare import motion_nrms
from study.mechanism.response import Response
from study.mechanism.scene import Scene
from study.mechanism.simulate import simulate
from study.mechanism.stepping import MechanismError

Quantity = Literal["slider_position", "slider_velocity", "slider_acceleration"]
QUANTITIES = get_args(Quantity)
ELEMENTS = (4, 8)
SAFETY = 10.0
"""Factor on the largest ratio; other scenes exceed that ratio by a factor of up to 5."""
COUNT = 160
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
}
"""Drawn evenly in the logarithm."""
EVEN_RANGES = {"restitution": (0.1, 0.95), "friction": (0.0, 0.2)}
"""Drawn evenly. All other parameters are as in the paper's scene."""


@dataclass(frozen=True)
class Stiffness:
    """Links beside the contact, at the largest depth of a response.

    ``compliance`` is that of both links along their axes, in m/N. The frequencies are the lowest of
    the crank, in rad/s: simply supported, and with one end held. ``compliance_ratio`` is the links'
    compliance over the contact's; ``frequency_ratio`` is the slider's frequency on the contact over
    the crank's axial one. Both are 0 without contact.
    """

    compliance: float
    bending_frequency: float
    axial_frequency: float
    compliance_ratio: float
    frequency_ratio: float


def stiffness(scene: Scene, depth: float) -> Stiffness:
    """Stiffness of the links of a scene, and of Hertz's contact at a depth in m."""
    crank, coupler = scene.link("crank"), scene.link("coupler")
    compliance = crank.length / crank.axial + coupler.length / coupler.axial
    bending = (pi / crank.length) ** 2 * sqrt(crank.bending / crank.mass_per_length)
    axial = pi / (2 * crank.length) * sqrt(crank.axial / crank.mass_per_length)
    law = pack("hertz", scene.ball_radius, scene.socket_radius, scene.composite_modulus)
    contact = elastic_force(law, depth)[1]
    return Stiffness(
        compliance=compliance,
        bending_frequency=bending,
        axial_frequency=axial,
        compliance_ratio=compliance * contact,
        frequency_ratio=sqrt(contact / scene.slider_mass) / axial,
    )


def estimates(scene: Scene, response: Response) -> dict[Quantity, float]:
    """Estimated change by flexible links, as a share of each quantity of `QUANTITIES`.

    For the position it is the largest contact force times the links' compliance. For the velocity
    the crank's bending frequency is a factor too, for the acceleration its axial frequency squared.
    Position and velocity drift: one plus the crank's angle is another factor of theirs. The
    response is of rigid links with clearance; without contact the estimate is 0.
    """
    if len(response.impacts) == 0:
        return dict.fromkeys(QUANTITIES, 0.0)
    links = stiffness(scene, float(response.impacts.peak_depth.max()))
    change = links.compliance * float(response.impacts.peak_force.max())
    drift = 1 + np.abs(response.crank_angle).max()
    factors = (drift, drift * links.bending_frequency, links.axial_frequency**2)
    found = {}
    for quantity, factor in zip(QUANTITIES, factors, strict=True):
        values = getattr(response, quantity)
        size = np.sqrt(np.mean((values - values[0]) ** 2))
        found[quantity] = float(change * factor / size)
    return found


def bounds(scene: Scene, response: Response, seen: pd.DataFrame) -> dict[Quantity, float]:
    """Largest NRMS error of rigid links: `estimates` times the largest ratio `seen`."""
    return {
        quantity: float(estimate * SAFETY * largest_ratio(seen, quantity))
        for quantity, estimate in estimates(scene, response).items()
    }


def largest_ratio(seen: pd.DataFrame, quantity: Quantity) -> float:
    """Largest ratio of error to estimate in a table of `measure`."""
    return (seen[f"{quantity}_error"] / seen[f"{quantity}_estimate"]).max()


def outside(scene: Scene, duration: float) -> str:
    """Why a scene and a duration, in s, are outside the random scenes; empty if they are not."""
    given = {field.name: getattr(scene, field.name) for field in fields(scene)}
    given |= {"link_modulus": scene.link_modulus or scene.youngs_modulus, "duration": duration}
    usual = {field.name: field.default for field in fields(scene)}
    for name, value in given.items():
        low, high = (RANGES | EVEN_RANGES).get(name, (None, None))
        if low is None and value != usual[name]:
            what = "material" if isinstance(value, Material) else value
            return f"{name.replace('_', ' ')} {what} is not that of the random scenes"
        if low is not None and not low <= value <= high:
            return f"{name.replace('_', ' ')} {value:g} is outside the range of the random scenes"
    return ""


def random_scenes(seed: int, count: int = COUNT) -> Iterator[tuple[Scene, float]]:
    """Scenes and durations (s) at random places of the ranges, the same for the same seed."""
    draw = np.random.default_rng(seed)
    for _ in range(count):
        values: dict[str, Any] = {
            name: float(f"{low * (high / low) ** draw.random():.4g}")
            for name, (low, high) in RANGES.items()
        }
        duration = values.pop("duration")
        values |= {name: round(draw.uniform(*ends), 3) for name, ends in EVEN_RANGES.items()}
        yield Scene(**values), duration


def measure(
    scenes: Iterable[tuple[Scene, float]], law: LawName = "stiffened_hertz"
) -> pd.DataFrame:
    """Errors of rigid links against particles on `random_scenes`, beside their estimates.

    Scenes that a model cannot finish, and those without an impact, are left out.
    """
    rows = []
    for scene, duration in scenes:
        run = partial(simulate, scene, law=law, duration=duration, outputs=1000)
        try:
            rigid = run(model="rigid")
            flexible = run(model="particles", elements=ELEMENTS)
        except MechanismError:
            continue
        if len(rigid.impacts) == 0:
            continue
        links = stiffness(scene, float(rigid.impacts.peak_depth.max()))
        drawn = [name for name in (RANGES | EVEN_RANGES) if name != "duration"]
        row = {"duration": duration} | {name: getattr(scene, name) for name in drawn}
        row["compliance_ratio"] = links.compliance_ratio
        row["frequency_ratio"] = links.frequency_ratio
        for quantity, estimate in estimates(scene, rigid).items():
            row[f"{quantity}_estimate"] = estimate
            row[f"{quantity}_error"] = motion_nrms(flexible, rigid, quantity)
        rows.append(row)
    return pd.DataFrame(rows)
