"""The crank-slider with a clearance joint: scene, models of its links, responses."""

from study.mechanism.particles import stable_step
from study.mechanism.response import Response
from study.mechanism.scene import Scene
from study.mechanism.simulate import simulate
from study.mechanism.stepping import MechanismError

__all__ = ["MechanismError", "Response", "Scene", "simulate", "stable_step"]
