"""The cheapest law for a joint, and the simplest model for a mechanism.

`choose` solves the joint and compares every law with its curve. A bound of a law's error includes
3 times the error estimate of that curve. The cheapest law within the tolerance is chosen, or else
the table of the coarsest solution that is.

`choose_model` runs models of rigid links and compares them: each takes milliseconds. What flexible
links would change is estimated from their compliance, the largest force and their frequencies
(`links`). Random scenes show how far such estimates can be wrong. If the bound is too large,
links of particles are run on two meshes and with half the step. Impacts are chaotic: a finer mesh
need not be closer, so that three times the largest difference is the bound.
"""

from study.choose.law import Choice, choose, relative_costs
from study.choose.model import ModelChoice, ModelError, choose_model

__all__ = ["Choice", "ModelChoice", "ModelError", "choose", "choose_model", "relative_costs"]
