"""The crank-slider with a clearance joint: scene, models of its links, responses.

`simulate` is one call for all models. Each model yields blocks of output rows around one compiled
loop, ``advance``. A simulation can therefore show its progress, and keeps what it has when it is
interrupted. Each impact adds three output rows: at its start, largest force and end.

Rigid links are `rigid`; `events` steps them: in contact the depth is a coordinate. Flexible links
are `particles`, stepped explicitly, or `beams`, stepped implicitly. They start
straight, with the velocities of rigid links (`frame`). At constant crank speed the
crank's fixed end turns as given; the moment that this takes is an output. Its work is summed
by the trapezoidal rule, so that the energy balance closes with order 2.
"""

from study.mechanism.law_in_scene import clearance_joint
from study.mechanism.particles import stable_step
from study.mechanism.response import Response
from study.mechanism.scene import Scene, paper_scene
from study.mechanism.simulate import simulate
from study.mechanism.stepping import MechanismError

__all__ = [
    "MechanismError",
    "Response",
    "Scene",
    "clearance_joint",
    "paper_scene",
    "simulate",
    "stable_step",
]
