"""Contact laws: the force between ball and socket as a function of penetration depth."""

from study.contact.bodies import SOCKET_RATIO, composite_modulus, hertz_factor, largest_depth
from study.contact.dimensional_law import DimensionalLaw
from study.contact.laws import (
    COMPARED_LAWS,
    LAWS,
    PAPER_LAWS,
    Law,
    LawName,
    hertz,
    hyperbolic_winkler,
    liu,
    power,
    sampled,
    steuermann,
    stiffened_hertz,
    tabulated,
    winkler,
)
from study.contact.materials import Material, material
