"""The design of the dataset: its joints in groups, and the purpose of each group."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import groupby
from typing import NamedTuple

import numpy as np
import pandas as pd

from study.contact.stiffening import RANGES
from study.dataset.store import PAPER_KINEMATICS, R2_STAR
from study.joint import Joint, Kinematics, Layer, Material
from study.joint.joint import REFERENCE_SUPPORTS

DEPTHS = tuple(np.round(np.arange(1, 41) * 0.025, 3).tolist())
ROOT_DEPTHS = tuple(np.round(np.linspace(0.005**0.5, 1, 32) ** 2, 6).tolist())
"""Depths from 0.005 to 1, in equal steps of sqrt(depth_star)."""
PAPER_R2_STARS = tuple(range(20, 301, 20))
WIDER_R2_STARS = (400, 600, 1000, 2000, 5000, 10_000)


class Case(NamedTuple):
    """One force-depth curve of the dataset."""

    group: str
    name: str
    joint: Joint
    depths: tuple[float, ...]


def case_name(
    set_up: str, kinematics: Kinematics = PAPER_KINEMATICS, r2_star: float = R2_STAR
) -> str:
    """Name of a case of a set-up, for example ``paper-linear-200``."""
    return f"{set_up}-{kinematics}-{r2_star:g}"


@dataclass(frozen=True)
class SetUp:
    """Joints with the same elastic bodies; the cases are all combinations of R2* and kinematics.

    ``group`` is a key of `GROUPS`, ``joint`` has arguments of `study.joint.Joint.from_ratios`, and
    ``depths`` are values of ``depth_star``. ``poisson`` is Poisson's ratio of both bodies, or of
    the ball alone if ``joint`` describes the socket or its layers. ``modulus_ratio`` is Young's
    modulus of the socket divided by that of the ball.
    """

    group: str
    name: str
    joint: dict = field(default_factory=dict)
    poisson: float = 0.3
    modulus_ratio: float = 1.0
    r2_stars: tuple[float, ...] = (R2_STAR,)
    kinematics: tuple[Kinematics, ...] = (PAPER_KINEMATICS,)
    depths: tuple[float, ...] = DEPTHS

    def cases(self) -> Iterator[tuple[str, Joint]]:
        """Yield name and joint of every case."""
        given: dict = {"poisson": self.poisson} | self.joint
        if "layers" not in given and "socket" not in given:
            given["modulus_ratio"] = self.modulus_ratio
        for kinematics in self.kinematics:
            for r2_star in self.r2_stars:
                name = case_name(self.name, kinematics, r2_star)
                yield name, Joint.from_ratios(r2_star, kinematics=kinematics, **given)


GROUPS = {
    "paper": "the reference joint, R2* from 20 to 300, and the wider range of Figs. 13 to 15",
    "ratio": "the effect of the socket ratio in the reference joint",
    "poisson": "the effect of Poisson's ratio in the reference joint",
    "modulus": "the effect of unequal Young's moduli in the reference joint",
    "support": "the effect of the supports in the reference joint",
    "liner": "thin liners: between rigid bodies, and real liners in their housings",
    "validation": "random joints in the range of stiffened_hertz, to validate it",
}
FREE_VALIDATION, HELD_VALIDATION, REFERENCE_VALIDATION = 300, 36, 40
HELD = (("clamped", "mirror"), ("guided", "free"), ("clamped", "free"))
LINER_THICKNESSES = (0.003, 0.015, 0.04, 0.1, 0.2, 0.3)
LINER_POISSONS = (0.1, 0.3, 0.4, 0.45, 0.475, 0.49)
REAL_LINERS = {
    "ptfe-steel": (80, (1.125, 5e8, 0.46), (1.5, 2e11, 0.3)),
    "fabric-steel": (200, (1.025, 3.1e9, 0.3), (1.4, 2e11, 0.3)),
    "fabric-steel-0.45": (200, (1.025, 3.1e9, 0.45), (1.4, 2e11, 0.3)),
    "hip-4mm": (100, (1.25, 1e9, 0.4), (1.4375, 1.1e11, 0.3)),
    "hip-8mm": (100, (1.5, 1e9, 0.4), (1.6875, 1.1e11, 0.3)),
}
"""Liners in their housings: R2*, then outer radius over R2, Young's modulus in Pa and Poisson's
ratio of liner and housing. The ball is steel. Notebook 22 has the sources."""


def _liners():
    """A rigid ball in thin liners in a rigid housing, and a steel ball in real ones."""
    for h in LINER_THICKNESSES:
        for nu in LINER_POISSONS:
            ratio = {"socket_ratio": round(1 + h, 3)}
            name = f"liner-{h:g}-{nu:g}"
            yield SetUp("liner", name, ratio, nu, 1e-8, (10_000,), depths=ROOT_DEPTHS[1::2])
    for name, (r2_star, *bodies) in REAL_LINERS.items():
        layers = tuple(Layer(q, Material(modulus, nu)) for q, modulus, nu in bodies)
        joint, depths = {"layers": layers}, ROOT_DEPTHS[1::2]
        yield SetUp("liner", name, joint, r2_stars=(r2_star,), depths=depths)


def _validation_set():
    """Random joints in the range of stiffened_hertz, which are the same in every run.

    The first `FREE_VALIDATION` have a guided ball and a mirror rim. The next `HELD_VALIDATION` have
    other supports; as they are solved by finite elements, they combine a few balls and sockets. The
    last `REFERENCE_VALIDATION` have the supports of the reference joint, and a ball and a socket
    each. One socket in ten is practically infinitely thick.
    """
    draw = np.random.default_rng(2024)
    (low, high), (thin, _) = RANGES["poisson"], RANGES["socket_ratio"]

    def ball():
        return round(draw.uniform(low, high), 3)

    def socket():
        thickness = (thin - 1) * (9 / (thin - 1)) ** draw.random()
        return round(1 + thickness, 3) if draw.random() < 0.9 else 1000.0, ball()

    balls, sockets = [ball() for _ in range(3)], [socket() for _ in range(6)]
    for k in range(FREE_VALIDATION + HELD_VALIDATION + REFERENCE_VALIDATION):
        held = 0 <= k - FREE_VALIDATION < HELD_VALIDATION
        nu = balls[k % 3] if held else ball()
        ratio, socket_nu = sockets[k // 3 % 6] if held else socket()
        support, rim = ("guided", "mirror") if k < FREE_VALIDATION else ("clamped", "free")
        if held:
            support, rim = HELD[draw.integers(3)]
        share = draw.random() ** draw.choice([0.5, 1, 2])
        modulus = 2e11 * share / (1 - share) * (1 - socket_nu**2) / (1 - nu**2)
        joint = {"socket": Material(float(f"{modulus:.4g}"), socket_nu), "socket_ratio": ratio}
        r2_star = float(f"{20 * 500 ** draw.random() ** 2:.3g}")
        supports = {"ball_support": support, "rim": rim}
        case = {"poisson": nu, "r2_stars": (r2_star,), "depths": ROOT_DEPTHS[1::6]}
        yield SetUp("validation", f"validation-{k:03d}", joint | supports, **case)


DESIGN = (
    SetUp(
        "paper",
        "paper",
        REFERENCE_SUPPORTS,
        r2_stars=PAPER_R2_STARS + WIDER_R2_STARS,
        kinematics=("linear", "small"),
    ),
    *(
        SetUp("ratio", f"ratio-{ratio:g}", REFERENCE_SUPPORTS | {"socket_ratio": ratio})
        for ratio in (1.05, 1.1, 1.15, 1.2, 1.25, 1.4, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 5.0)
    ),
    *(
        SetUp("poisson", f"poisson-{nu:g}", REFERENCE_SUPPORTS, poisson=nu)
        for nu in (0.0, 0.1, 0.2, 0.25, 0.35, 0.4, 0.45, 0.48)
    ),
    *(
        SetUp("modulus", f"modulus-{ratio:g}", REFERENCE_SUPPORTS, modulus_ratio=ratio)
        for ratio in (0.05, 0.1, 0.2, 0.333, 0.5, 2.0, 3.0, 5.0, 10.0, 20.0)
    ),
    *(
        SetUp("support", f"{support}-{rim}", {"ball_support": support, "rim": rim})
        for support, rim in (("clamped", "mirror"), ("guided", "free"), ("guided", "mirror"))
    ),
    *_liners(),
    *_validation_set(),
)


def every_case() -> list[Case]:
    """All cases of the design."""
    return [Case(s.group, name, joint, s.depths) for s in DESIGN for name, joint in s.cases()]


def solve(case: Case) -> pd.DataFrame:
    """Rows of a case, in the columns of the dataset."""
    solution = case.joint.solve(depth_star=case.depths)
    solved = ["solver", "depth_star", "force_star", "contact_half_angle_deg"]
    solved += ["peak_pressure_star", "error_estimate"]
    columns = {"group": case.group, "case": case.name} | case.joint.columns()
    return pd.DataFrame(columns | {of: getattr(solution, of) for of in solved})


def batches(cases: Iterable[Case]) -> Iterator[list[Case]]:
    """Cases in lists of cases with the same bodies, each of which takes some seconds."""
    by_kind = groupby(cases, lambda case: (case.group, case.joint.series_applies))
    for (_, by_series), of_kind in by_kind:
        batch, size = list(of_kind), 12 if by_series else 36
        for k in range(0, len(batch), size):
            yield batch[k : k + size]
