"""No more than a scene needs: the cheapest law, the least model."""

from study.choose.law import Choice, choose, relative_costs
from study.choose.model import ModelChoice, ModelError, choose_model

__all__ = ["Choice", "ModelChoice", "ModelError", "choose", "choose_model", "relative_costs"]
