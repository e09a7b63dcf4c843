"""The truth: a joint of two elastic bodies, and its force-depth curve."""

from study.joint.curve import (
    ForceCurve,
    Joint,
    Material,
    UnresolvedError,
    force_curve,
    paper_joint,
)

__all__ = ["ForceCurve", "Joint", "Material", "UnresolvedError", "force_curve", "paper_joint"]
