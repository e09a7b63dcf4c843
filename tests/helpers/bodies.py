"""What tests ask of an elastic body beside its compliance."""

import numpy as np

from study.joint import series
from study.joint.compliance import Socket


def reaction(body):
    """Axial reaction of a body's supports to the pressure of each hat function."""
    load = body._hat_loads
    unbalanced = body._stiffness @ body.solve(load.toarray()) - load.toarray()
    axial = body._basis.get_dofs(elements=True).all(["u^2"])
    return np.abs(unbalanced[axial].sum(axis=0))


def of_socket(orders, *constants):
    """Outward displacement of a socket's inner surface under the pressures P_n(cos theta)."""
    return series.socket(orders, Socket(*constants))[0].state(1.0)[0]
