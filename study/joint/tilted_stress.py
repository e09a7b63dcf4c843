"""Largest von Mises stresses of bodies that are pressed off the axis.

Stresses are those of the Fourier modes (`study.joint.fourier.Surface.stresses`), at some angles
around the axis from the plane of symmetry on. They are in E* dR/R2.
"""

import numpy as np
from numpy.typing import NDArray

from study.joint.grid_contact import Contacts
from study.joint.stress import LargestStress, far_from
from study.joint.supports import Bore, Core
from study.joint.tilted import TiltedContact
from study.threads import one_thread

Floats = NDArray[np.float64]
_AROUND = np.radians(np.arange(0, 181, 5))  # angles phi that are searched
_ON = 1e-3  # distance from a surface, in radii, of places that are on it


@one_thread
def largest_off_axis(contact: TiltedContact) -> dict[str, LargestStress]:
    """Largest von Mises stress in each body, by its name in ``joint.materials``.

    It is sought as by `study.joint.stress.largest`. The ``angle`` is the polar angle from the
    axis, negative on the other side of it, and the ``error`` is the relative difference between
    the stresses on both grids.
    """
    joint, by_body = contact.joint, {}
    on_grids = [Contacts(joint, n) for n in (contact.resolution, contact.resolution // 2)]
    of_grids = list(zip(*contact.grids, strict=True))
    for body in joint.materials:
        fine, coarse = (_largest(body, *grid) for grid in zip(on_grids, of_grids, strict=True))
        stress, radius, angle, place = zip(*fine, strict=True)
        by_body[body] = LargestStress(
            von_mises=np.array(stress),
            over_peak=stress / contact.peak_pressure_star,
            radius=np.array(radius),
            angle=np.array(angle),
            place=place,
            error=np.abs([of_coarse[0] for of_coarse in coarse] / np.array(stress) - 1),
        )
    return by_body


def _largest(body, contacts, solved):
    """Stress, radius, polar angle and place in one body, for each contact on one grid."""
    joint, is_ball = contacts.joint, body == "ball"
    surface = contacts.ball if is_ball else contacts.socket
    r, z = surface.places
    radius = np.hypot(r, z)
    names = np.full(len(r), "below the surface", dtype=object)
    names[np.abs(radius - 1) < _ON] = "at the surface"
    if is_ball:
        if isinstance(joint.ball_support, Core | Bore):
            of_held = r if isinstance(joint.ball_support, Bore) else radius
            held = np.abs(of_held - joint.ball_support.radius) < _ON
            names[held] = f"at the {joint.ball_support.word}"
        pressures = [of.of_ball for of in solved]
        searched = far_from(joint.ball_body.corners, r, z) & (z > joint.ball_support.lowest)
    else:
        pressures = [of.pressure for of in solved]
        layer, ratios = [*joint.materials].index(body) - 1, joint.socket_body.layers[0]
        names[radius > ratios[-1] - _ON] = "outside"
        inside = np.searchsorted(ratios + _ON, radius) == layer
        searched = far_from(joint.socket_body.corners, r, z) & inside
    at = np.flatnonzero(searched)
    found = []
    for pressure in pressures:
        stress = von_mises_in_space(surface.stresses(pressure, _AROUND, at))
        place, around = np.unravel_index(stress.argmax(), stress.shape)
        where = at[place]
        side = 1 if _AROUND[around] <= np.pi / 2 else -1
        angle = side * np.arctan2(r[where], z[where])
        found.append((stress.max(), radius[where], angle, names[where]))
    return found


def von_mises_in_space(stress: Floats) -> Floats:
    """Von Mises stress of the three normal and the three shear stresses, shape (6, ...)."""
    a, b, c, *shear = stress
    normal = (a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2
    return np.sqrt(normal / 2 + 3 * sum(part**2 for part in shear))
