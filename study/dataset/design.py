"""Which joints the dataset holds, and why: its design, in groups of set-ups."""

from dataclasses import dataclass, field

import numpy as np

from study.joint import Joint, Material
from study.joint.curve import PAPER_SUPPORTS

DEPTHS = tuple(np.round(np.arange(1, 41) * 0.025, 3).tolist())
ROOT_DEPTHS = tuple(np.round(np.linspace(0.005**0.5, 1, 32) ** 2, 6).tolist())
"""In equal steps of sqrt(depth_star), from 0.005 to 1."""
PAPER_R2_STARS = tuple(range(20, 301, 20))
WIDER_R2_STARS = (400, 600, 1000, 2000, 5000, 10_000)
PAPER_KINEMATICS = "linear"
"""Of the paper's finite elements: identified from Table 2 (notebook 13), and the only ones of ours
with which the relative RMSE of Fig. 14 rises with R2* and R2 falls (notebooks 06, 12)."""


@dataclass(frozen=True)
class SetUp:
    """Joints that share their elastic bodies.

    Attributes
    ----------
    group : str
        What the study needs it for, a key of `GROUPS`.
    name : str
        Short name; first part of its cases' names.
    joint : dict
        Arguments of `study.joint.Joint` besides ``r2_star``, ``kinematics`` and materials.
    poisson : float
        Poisson's ratio of both bodies.
    modulus_ratio : float
        Young's modulus of the socket over that of the ball.
    r2_stars, kinematics : tuple
        Its cases are all combinations of these.
    depths : tuple
        Values of ``depth_star``.
    """

    group: str
    name: str
    joint: dict = field(default_factory=dict)
    poisson: float = 0.3
    modulus_ratio: float = 1.0
    r2_stars: tuple = (200,)
    kinematics: tuple = (PAPER_KINEMATICS,)
    depths: tuple = DEPTHS

    def cases(self):
        """Yield (case name, Joint) of every case."""
        ball = Material(2e11, self.poisson)
        socket = Material(2e11 * self.modulus_ratio, self.poisson)
        for kinematics in self.kinematics:
            for r2_star in self.r2_stars:
                name = f"{self.name}-{kinematics}-{r2_star:g}"
                materials = {"ball": ball, "socket": socket}
                yield name, Joint(r2_star, kinematics=kinematics, **materials, **self.joint)


GROUPS = {
    "paper": "the paper's joint and design, R2* = 20..300, and the wider sweep of Figs. 13-15",
    "ratio": "how much the socket ratio matters in the paper's joint",
    "poisson": "how much Poisson's ratio matters in it",
    "modulus": "how much unequal moduli matter in it",
    "support": "how much drive and rim matter in it",
    "fit": "what stiffened_hertz is fitted to: radially free ball, mirror rim",
    "judge": "what it is judged by: the same supports, drawn at random in its range",
}


def _sweep(group, values, set_up):
    """The paper's joint with one property changed."""
    for value in values:
        changes = set_up(value)
        joint = PAPER_SUPPORTS | changes.pop("joint", {})
        yield SetUp(group, f"{group}-{value:g}", joint, **changes)


def _judges():
    """Joints at random places of the range of stiffened_hertz, always the same.

    Every eighth has finite kinematics, every third is thin, nearly incompressible and of small
    R2*, where a law is hardest to find.
    """
    draw = np.random.default_rng(2024)
    for k in range(72):
        hard, finite = k % 3 == 0, k % 8 == 0
        width = 0.5 if hard else 1.0
        thickness = 0.1 * 20 ** (draw.random() * (0.25 if hard else 1))
        yield SetUp(
            "judge",
            f"judge-{k:02d}",
            {"socket_ratio": round(float(1 + thickness), 3)},
            poisson=round(float(0.45 - 0.25 * width * draw.random()), 3),
            r2_stars=(float(f"{20 * 500 ** (draw.random() * (0.3 if hard else 1)):.3g}"),),
            kinematics=("finite" if finite else "linear",),
            depths=ROOT_DEPTHS[2::4] if finite else ROOT_DEPTHS,
        )


DESIGN = (
    SetUp(
        "paper",
        "paper",
        PAPER_SUPPORTS,
        r2_stars=PAPER_R2_STARS + WIDER_R2_STARS,
        kinematics=("linear", "small"),
    ),
    SetUp(
        "paper",
        "paper",
        PAPER_SUPPORTS,
        r2_stars=(20, 60, 200, 600, 2000, 10_000),
        kinematics=("finite",),
        depths=DEPTHS[:20],
    ),
    *_sweep(
        "ratio",
        (1.05, 1.1, 1.15, 1.2, 1.25, 1.4, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 5.0),
        lambda ratio: {"joint": {"socket_ratio": ratio}},
    ),
    *_sweep(
        "poisson",
        (0.0, 0.1, 0.2, 0.25, 0.35, 0.4, 0.45, 0.48),
        lambda nu: {"poisson": nu},
    ),
    *_sweep(
        "modulus",
        (0.05, 0.1, 0.2, 0.333, 0.5, 2.0, 3.0, 5.0, 10.0, 20.0),
        lambda ratio: {"modulus_ratio": ratio},
    ),
    *(
        SetUp("support", f"{drive}-{rim}", {"ball_drive": drive, "rim": rim})
        for drive, rim in (("clamped", "mirror"), ("plane", "free"), ("plane", "mirror"))
    ),
    *(
        SetUp(
            "fit",
            f"fit-{ratio:g}-{nu:g}",
            {"socket_ratio": ratio},
            poisson=nu,
            r2_stars=(20, 40, 120, 10_000),
            depths=ROOT_DEPTHS,
        )
        for ratio in (1.1, 1.13, 1.19, 1.27, 1.38, 1.5, 1.7, 2.0, 2.5, 3.0)
        for nu in (0.2, 0.25, 0.3, 0.35, 0.4, 0.43, 0.45)
    ),
    *(
        SetUp(
            "fit",
            f"fit-{ratio:g}-{nu:g}",
            {"socket_ratio": ratio},
            poisson=nu,
            r2_stars=(20,),
            kinematics=("finite",),
            depths=ROOT_DEPTHS[3::4],
        )
        for ratio in (1.1, 1.19, 1.5, 3.0)
        for nu in (0.2, 0.3, 0.4, 0.45)
    ),
    *_judges(),
)
