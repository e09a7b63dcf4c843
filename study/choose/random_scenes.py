"""Random mechanisms for the bound of `study.choose.links`; their results are ``data/links.csv``.

The choice of a model does not need this module: `links.LARGEST_RATIOS` states the results.
"""

from collections.abc import Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from study.choose.links import RANGES, estimates, ratios
from study.mechanism.compare import motion_nrms
from study.mechanism.scene import Scene
from study.mechanism.simulate import simulate
from study.mechanism.stepping import MechanismError

COUNT = 160
ELEMENTS, LAW = (4, 8), "stiffened_hertz"
EVENLY = ("restitution", "friction")  # the others are drawn uniformly in the logarithm


def draw(seed: int, count: int = COUNT) -> Iterator[tuple[Scene, float]]:
    """Random mechanisms and durations (s) within the ranges; a seed always gives the same."""
    numbers = np.random.default_rng(seed)
    for _ in range(count):
        values: dict[str, Any] = {
            name: round(numbers.uniform(low, high), 3)
            if name in EVENLY
            else float(f"{low * (high / low) ** numbers.random():.4g}")
            for name, (low, high) in RANGES.items()
        }
        duration = values.pop("duration")
        yield Scene(**values), duration


def measure(scenes: Iterable[tuple[Scene, float]]) -> pd.DataFrame:
    """Errors of rigid links, relative to particles, in mechanisms of `draw`, with their estimates.

    Mechanisms that cannot be simulated to the end, and those without an impact, are left out.
    """
    rows = []
    for scene, duration in scenes:
        run = partial(simulate, scene, law=LAW, duration=duration, outputs=1000)
        try:
            rigid = run(model="rigid")
            flexible = run(model="particles", elements=ELEMENTS)
        except MechanismError:
            continue
        if len(rigid.impact_rows) == 0:
            continue
        drawn = {name: getattr(scene, name, duration) for name in RANGES}
        row = {"duration": duration} | drawn
        row |= ratios(scene, rigid.impact_rows["peak_depth"].max())
        for quantity, estimate in estimates(scene, rigid).items():
            row[f"{quantity}_estimate"] = estimate
            row[f"{quantity}_error"] = motion_nrms(flexible, rigid, quantity)
        rows.append(row)
    return pd.DataFrame(rows)
