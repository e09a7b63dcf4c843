"""The crank-slider with a clearance joint: scene, models of its links, responses.

`simulate` is one call for all models. Each model yields blocks of output rows around one compiled
loop, ``advance``. A simulation can therefore show its progress, and keeps what it has when it is
interrupted. Each impact adds three output rows: at its start, largest force and end.

Rigid links are `rigid`, which `events` steps. Flexible links are `particles`, stepped explicitly,
or `beams`, stepped implicitly; they start straight, with the velocities of rigid links (`frame`).
All models have the same `loads`, and the moment that holds a constant crank speed is an output.
"""

from study.checks import EnergyWarning
from study.mechanism.law_in_scene import clearance_joint
from study.mechanism.particles import stable_step
from study.mechanism.response import Response
from study.mechanism.scene import Scene, paper_scene
from study.mechanism.simulate import simulate
from study.mechanism.stepping import MechanismError

__all__ = [
    "EnergyWarning",
    "MechanismError",
    "Response",
    "Scene",
    "clearance_joint",
    "paper_scene",
    "simulate",
    "stable_step",
]
