"""What the paper's own curves are of: its joint is `study.joint.paper_joint`."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from study.joint import Kinematics

R2_STAR = 200
"""Of the paper's comparison of laws, Fig. 10 and Table 2, and of the changes to its joint."""
PAPER_KINEMATICS: "Kinematics" = "linear"
"""Of the paper's finite elements, inferred from Table 2 (notebook 32). Only with these, the
relative RMSE of Fig. 14 rises and its coefficient of determination falls with R2* (notebooks 06,
12)."""
