"""R2* and kinematics of the paper's curves; their joint is `study.joint.reference_joint`."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from study.joint import Kinematics

R2_STAR = 200
"""R2* of the paper's comparison of laws (Fig. 10 and Table 2), and of the joint's variations."""
PAPER_KINEMATICS: "Kinematics" = "linear"
"""Kinematics of the paper's finite elements, inferred from Table 2 (notebook 13). Only with these
kinematics does the relative RMSE of Fig. 14 rise, and its coefficient of determination fall, with
R2* (notebooks 06 and 12)."""
