"""Contact laws: the force between ball and socket as a function of penetration depth."""

from study.contact.bodies import SOCKET_RATIO, composite_modulus, largest_depth
from study.contact.joint_law import JointLaw
from study.contact.laws import (
    LAWS,
    PAPER_LAWS,
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
