"""The truth: a joint of two elastic bodies, and its force-depth curve."""

from study.joint.compliance import Drive, Rim
from study.joint.curve import (
    ForceCurve,
    Joint,
    Kinematics,
    Material,
    Solver,
    UnresolvedError,
    force_curve,
    paper_joint,
)
from study.joint.growth import whole_curve

__all__ = [
    "Drive",
    "ForceCurve",
    "Joint",
    "Kinematics",
    "Material",
    "Rim",
    "Solver",
    "UnresolvedError",
    "force_curve",
    "paper_joint",
    "whole_curve",
]
