"""Contact laws: the force between ball and socket as a function of penetration depth."""

from study.contact.dimensional_law import DimensionalLaw
from study.contact.laws import (
    CLOSED_FORM,
    LAWS,
    PAPER_LAWS,
    Hertz,
    HyperbolicWinkler,
    Law,
    Liu,
    Power,
    Steuermann,
    StiffenedHertz,
    Table,
    Winkler,
)
from study.contact.materials import (
    SOCKET_RATIO,
    Material,
    composite_modulus,
    hertz_factor,
    largest_depth,
    material,
)
