"""The truth: a joint of two elastic bodies, and its force-depth curve."""

from study.joint.compliance import Drive, Rim
from study.joint.curve import ForceCurve, Solver, UnresolvedError, force_curve
from study.joint.growth import curve_to, whole_curve
from study.joint.joint import Joint, Kinematics, Layer, Material, paper_joint
from study.joint.materials import material
from study.joint.sized import SizedJoint, SizedSolution
from study.joint.stress import FirstYield, LargestStress, first_yield

__all__ = [
    "Drive",
    "FirstYield",
    "ForceCurve",
    "Joint",
    "Kinematics",
    "LargestStress",
    "Layer",
    "Material",
    "Rim",
    "SizedJoint",
    "SizedSolution",
    "Solver",
    "UnresolvedError",
    "curve_to",
    "first_yield",
    "force_curve",
    "material",
    "paper_joint",
    "whole_curve",
]
