"""Contact laws: the force between ball and socket as a function of penetration depth."""

from study.contact.laws import (
    LAWS,
    composite_modulus,
    contact_force,
    contact_stiffness,
    hertz,
    hyperbolic_winkler,
    liu,
    steuermann,
    winkler,
)

__all__ = [
    "LAWS",
    "composite_modulus",
    "contact_force",
    "contact_stiffness",
    "hertz",
    "hyperbolic_winkler",
    "liu",
    "steuermann",
    "winkler",
]
