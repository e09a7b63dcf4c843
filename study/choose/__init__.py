"""The cheapest law for a joint, and the simplest model for a mechanism.

`choose` compares every law with the elastic solution of the joint. `axial_law_suffices` checks
whether one law for the axial direction is accurate enough for loads off the axis. `fit_curve`
compares the laws with a curve of the user and fits unknown parameters of its joint, and `try_power`
compares constants of a power law that the user has. `choose_model` runs models of the crank-slider
and takes the simplest one that differs little enough from a finer one.
"""

from typing import TYPE_CHECKING, Any

from study.choose.cheapest_law import Choice, OffAxis, axial_law_suffices, choose, relative_costs
from study.choose.own_curve import CurveFit, LawFit, TriedPower, fit_curve, try_power

if TYPE_CHECKING:
    from study.choose.model import ModelChoice, ModelError, choose_model

__all__ = [
    "Choice",
    "CurveFit",
    "LawFit",
    "ModelChoice",
    "ModelError",
    "OffAxis",
    "TriedPower",
    "axial_law_suffices",
    "choose",
    "choose_model",
    "fit_curve",
    "relative_costs",
    "try_power",
]


def __getattr__(name: str) -> Any:
    """Import names of `model` when they are first used, because it imports the mechanism."""
    if name not in __all__:
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from study.choose import model

    return getattr(model, name)
