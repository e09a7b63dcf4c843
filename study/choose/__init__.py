"""The cheapest law for a joint, and the simplest model for a mechanism.

`choose` compares every law with the elastic solution of the joint. `axial_law_suffices` checks
whether one law for the axial direction is accurate enough for loads off the axis. `fit_curve`
compares the laws with a curve of the user and fits unknown parameters of its joint, and `try_power`
compares constants of a power law that the user has. `study.choose.model.choose_model` runs models
of the crank-slider and takes the simplest one that differs little enough from a finer one.
"""

from study.choose.cheapest_law import Choice, OffAxis, axial_law_suffices, choose, relative_costs
from study.choose.own_curve import CurveFit, LawFit, TriedPower, fit_curve, try_power

__all__ = [
    "Choice",
    "CurveFit",
    "LawFit",
    "OffAxis",
    "TriedPower",
    "axial_law_suffices",
    "choose",
    "fit_curve",
    "relative_costs",
    "try_power",
]
