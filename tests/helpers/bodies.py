"""What tests ask of an elastic body beside its compliance."""

import numpy as np

from study.joint import series
from study.joint.compliance import Socket


def reaction(body):
    """Axial reaction of a body's supports, along +z, to the pressure of each hat function."""
    load = 2 * np.pi * body.loads.toarray()
    unbalanced = body._constant @ body.axisymmetric(load) - load
    return unbalanced[body._basis.get_dofs(elements=True).all(["u^3"])].sum(axis=0)


def of_socket(orders, *constants):
    """Outward displacement of a socket's inner surface under the pressures P_n(cos theta)."""
    return series.socket(orders, Socket(*constants))[0].state(1.0)[0]
