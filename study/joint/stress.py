"""Stresses inside ball and socket.

The Legendre series gives stresses at any point, and finite elements give them at the nodes of the
mesh. All are those of linear elasticity under the pressure of a solved contact. Stresses are in
units of E* dR/R2; tension is positive.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.compiled import one_thread
from study.joint import series
from study.joint.compliance import graded
from study.joint.kinematics import socket_pressure
from study.joint.solution import LargestStress, Solution
from study.joint.supports import HEIGHT, ON
from study.joint.tilted import Solved

Floats = NDArray[np.float64]

_THICKNESS = 3.0  # of a socket, in radii, beyond which no largest stress is sought
_DEPTH_SCALE, _ANGLE_SCALE = 0.003, 0.01  # in radii and rad: the points' spacing grows from there
_RADII, _ANGLES = 48, 32  # points
_NEAR = 0.02  # of the contact's radius: depth that still counts as the surface
_AROUND = np.radians(np.arange(0, 181, 5))  # angles phi that are searched off the axis
_FELT = 30.0  # a mode that has decayed by exp(-30) is not felt


@one_thread
def stresses(curve: Solution, body: str, radius: ArrayLike, angle: ArrayLike) -> Floats:
    """Stresses inside a body of an exactly solved joint, at a grid of radii and polar angles.

    Parameters
    ----------
    curve
        Of the solver ``series``.
    body
        Its name in ``joint.materials``: ``ball``, ``liner 1`` and so on, and ``socket``.
    radius
        Distances from the body's centre over its surface's radius, > 0; shape (m,).
    angle
        Polar angles from the contact's axis, from 0 to pi/2, in rad; shape (n,).

    Returns
    -------
    ndarray, shape (4, k, m, n)
        Radial, polar, azimuthal and shear stress at every depth.

    Raises
    ------
    ValueError
        For a curve of finite elements, or a value outside its range.
    """
    if curve.solver != "series":
        raise ValueError(f"solver must be series for stresses at any point, got {curve.solver!r}")
    checks.choice("body", body, tuple(curve.joint.materials))
    ball, socket = _coefficients(curve)
    coefficients = ball if body == "ball" else socket
    solid = _solids(curve.joint, len(coefficients))[body]
    radii = checks.number("radius", radius, above=0, least=solid.inner, most=solid.outer)
    angles = checks.number("angle", angle, "rad", least=0, most=np.pi / 2)
    radii, angles = np.atleast_1d(radii), np.atleast_1d(angles)
    return _sum(solid, coefficients, radii, _legendre(angles, len(coefficients)))


@one_thread
def added(curve: Solution) -> Solution:
    """A solution along the axis with the largest von Mises stress in each body.

    Elements are searched from 0.1 radii above the equator of half a ball on, as far inside the rim,
    and as far from the ends of supports, where stresses have no bound; the ball on a neck is
    searched on the contact's side of half the neck's height.
    """
    sought = _of_series(curve) if curve.solver == "series" else _of_elements(curve)
    by_body, peak, support = {}, curve.peak_pressure_star, curve.joint.ball_support
    edge = np.sin(np.radians(curve.contact_half_angle_deg))
    *interfaces, outer = curve.joint.socket_body.layers[0]
    for body, (stress, radius, angle) in sought:
        place = np.full(len(stress), "below the surface", dtype=object)
        place[np.abs(radius - 1) <= _NEAR * edge] = "at the surface"
        place[np.isclose(radius[:, None], interfaces, atol=0).any(axis=1)] = "at an interface"
        place[np.isclose(radius, outer, atol=0)] = "outside"
        if body == "ball" and support.outline.core:
            place[np.isclose(radius, support.outline.core, atol=0)] = "at the core"
        by_body[body] = LargestStress(stress, stress / peak, radius, angle, tuple(place.tolist()))
    return replace(curve, stress=by_body)


def _solids(joint, count):
    """The joint's bodies by their names, under pressures of the first even orders."""
    orders = 2 * np.arange(count)
    solids = series.ball(orders, joint.ball.poisson), *series.socket(orders, joint.socket_body)
    return dict(zip(joint.materials, solids, strict=True))


def _coefficients(curve):
    """Legendre coefficients of the pressures on ball and on socket, (even orders, k) each."""
    elements = len(curve.angle_deg) - 1
    shares = series.hat_coefficients(elements, series.ORDERS * elements)
    return shares @ curve.pressure_star.T, shares @ _on_socket(curve).T


def _on_socket(curve):
    angles = np.radians(curve.angle_deg)
    return socket_pressure(curve.joint, curve.depth_star, angles, curve.pressure_star)


def _sum(solid, coefficients, radii, table):
    """Stresses (4, k, radii, angles) under pressures of given Legendre coefficients."""
    stress = np.empty((4, coefficients.shape[1], len(radii), table.shape[2]))
    for j, radius in enumerate(radii):
        distance = abs(np.log(radius))  # from the pressed surface
        count = len(coefficients)
        if distance > 0:  # a mode of order n = 2 k has decayed by exp(-n distance)
            count = min(count, int(1 + _FELT / distance / 2))
        legendre, parts = table[:, :count], _parts(solid, radius, count)
        radial, shear, hoop, apart = (
            (part[:, None] * coefficients[:count]).T @ legendre[k]
            for part, k in zip(parts, (0, 1, 0, 2), strict=True)
        )
        stress[:, :, j] = radial, hoop + apart, hoop - apart, shear
    return stress


def _parts(solid, radius, count):
    """Stresses at one radius under the pressures P_n, (4, count), by their functions of the angle.

    Radial (P_n), shear (P_n'), half the hoops' sum (P_n) and difference (P_n'' - P_n' cot(theta)).
    """
    n, nu, inner = solid.orders[:count], solid.poisson, solid.inner or 1.0
    radial, polar, normal, shear = solid.state(radius, count)
    strain = (2 * radial - n * (n + 1) * polar) * inner / radius  # both hoop strains
    hoop = strain / 2 + nu / (1 - nu) * (normal + strain)
    return solid.twice_shear * np.array([normal, shear, hoop, polar * inner / radius / 2])


def _legendre(angles, count):
    """P_n, P_n' and P_n'' - P_n' cot(theta), of the first even orders: (3, orders, angles)."""
    cosine, sine = np.cos(angles), np.sin(angles)
    n, off_axis = 2 * np.arange(count)[:, None], sine > 0
    every_order = legvander(cosine, 2 * count - 2).T
    value, order_below = every_order[::2], np.roll(every_order, 1, axis=0)[::2]
    slope, cotangent = np.zeros_like(value), np.zeros_like(sine)
    np.divide(n * (cosine * value - order_below), sine, out=slope, where=off_axis)
    np.divide(cosine, sine, out=cotangent, where=off_axis)
    # on the axis both hoop stresses are the same, and there is no shear
    bend = np.where(off_axis, -(n * (n + 1) * value + 2 * cotangent * slope), 0)
    return np.array([value, slope, bend])


@lru_cache(maxsize=2)
def _searched(count):
    """Polar angles of the points searched, and the Legendre functions there."""
    angles = graded(np.pi / 2, _ANGLE_SCALE, _ANGLES)
    return angles, _legendre(angles, count)


def _of_series(curve):
    """Bodies, and their largest von Mises stresses with radii and angles, of shape (k,)."""
    ball, socket = _coefficients(curve)
    angles, table = _searched(len(ball))
    for body, solid in _solids(curve.joint, len(ball)).items():
        radii = 1 - graded(0.999, _DEPTH_SCALE, _RADII)
        if body != "ball":
            thickness = min(solid.outer - solid.inner, _THICKNESS)
            radii = solid.inner + graded(thickness, _DEPTH_SCALE, _RADII)
        stress = von_mises(_sum(solid, ball if body == "ball" else socket, radii, table))
        k, size = np.arange(len(stress)), stress[0].size
        i, j = np.unravel_index(stress.reshape(-1, size).argmax(axis=1), stress[0].shape)
        # the largest of the grid, and of parabolas through its neighbours
        by_radius, radius = _top(stress[k, :, j], radii, i)
        by_angle, angle = _top(stress[k, i], angles, j)
        yield body, (by_radius + by_angle - stress[k, i, j], radius, angle)


def _of_elements(curve):
    """As `_of_series`, at the nodes of the bodies that the curve was solved with."""
    from study.joint import modes

    nodes = 3 if curve.solver == "linear" else 6
    joint, edge, resolution = curve.joint, curve.joint.opening.reach, len(curve.angle_deg) - 1
    of_socket, ratios = _on_socket(curve), joint.socket_body.layers[0]
    sought = [
        (joint.ball_body, curve.pressure_star, joint.ball_support.outline.lowest, 0.0, np.inf)
    ]
    for inner, outer in pairwise([1.0, *ratios]):
        sought.append((joint.socket_body, of_socket, HEIGHT, inner, outer))
    for name, (solid, pressure, lowest, *layer) in zip(joint.materials, sought, strict=True):
        body = modes.meshed(solid, resolution, nodes)
        r, z = body.mesh.doflocs
        radius, angle = np.hypot(r, z), np.arctan2(r, z)
        searched = far_from(solid.corners, r, z) & (z > lowest)
        if edge < np.pi / 2:
            searched &= angle < edge - HEIGHT
        stress = np.where(searched, von_mises(body.nodal_stresses(pressure, *layer)), 0)
        at = stress.argmax(axis=1)
        yield name, (stress.max(axis=1), radius[at], angle[at])


def far_from(corners: Floats, r: Floats, z: Floats) -> NDArray[np.bool_]:
    """Whether places (r, z) are at least `HEIGHT` from corners, (n, 2), in the meridian."""
    apart = np.hypot(r[:, None] - corners[:, 0], z[:, None] - corners[:, 1])
    return np.all(apart >= HEIGHT, axis=1)


def _top(values, places, at):
    """Top of the parabola through the largest value of each row and its neighbours."""
    k, last = np.arange(len(at)), len(places) - 1
    before, after = values[k, np.maximum(at - 1, 0)], values[k, np.minimum(at + 1, last)]
    bend = before - 2 * values[k, at] + after
    inside = (at > 0) & (at < last) & (bend < 0)
    shift = np.divide(before - after, 2 * bend, out=np.zeros_like(bend), where=inside)
    top = values[k, at] - (before - after) * shift / 4
    return top, np.interp(at + shift, np.arange(last + 1), places)


@one_thread
def added_off_axis(solved: Solved) -> Solution:
    """A solution off the axis with the largest von Mises stress in each body, as `added`.

    Stresses are sought at some angles around the axis. The ``angle`` is the polar angle from the
    axis, negative on the other side of it, and the ``error`` is the relative difference between
    the stresses on both grids.
    """
    solution, grids, contacts = solved
    by_body = {}
    for body in solution.joint.materials:
        fine, coarse = (
            [_largest_at(body, grid, of) for of in on_grid]
            for grid, on_grid in zip(grids, zip(*contacts, strict=True), strict=True)
        )
        stress, radius, angle, place = (np.array(of) for of in zip(*fine, strict=True))
        error = np.abs([of_coarse for of_coarse, *_ in coarse] / stress - 1)
        over_peak = stress / solution.peak_pressure_star
        by_body[body] = LargestStress(
            stress, over_peak, radius, angle, tuple(place.tolist()), error
        )
    return replace(solution, stress=by_body)


def _largest_at(body, contacts, contact):
    """Stress, radius, polar angle and place of the largest stress in one body."""
    joint, is_ball = contacts.joint, body == "ball"
    surface = contacts.ball if is_ball else contacts.socket
    r, z = surface.places
    radius, support = np.hypot(r, z), joint.ball_support
    held, outside = np.zeros((2, len(r)), bool)
    if is_ball:
        pressure, corners = contact.of_ball, joint.ball_body.corners
        outline = support.outline
        inside = z > outline.lowest
        if outline.core or outline.bore:
            held = np.abs((radius - outline.core) if outline.core else (r - outline.bore)) < ON
    else:
        pressure, corners = contact.pressure, joint.socket_body.corners
        layer, ratios = [*joint.materials].index(body) - 1, joint.socket_body.layers[0]
        inside = np.searchsorted(ratios + ON, radius) == layer
        outside = radius > ratios[-1] - ON
    at = np.flatnonzero(far_from(corners, r, z) & inside)
    stress = von_mises(surface.stresses(pressure, _AROUND, at))
    where, around = np.unravel_index(stress.argmax(), stress.shape)
    where = at[where]
    place = "at the surface" if abs(radius[where] - 1) < ON else "below the surface"
    place = "outside" if outside[where] else place
    place = f"at the {support.word}" if held[where] else place
    side = 1 if _AROUND[around] <= np.pi / 2 else -1
    return stress.max(), radius[where], side * np.arctan2(r[where], z[where]), place


def von_mises(stress: Sequence[Floats]) -> Floats:
    """Von Mises stress of the three normal and one or three shear stresses, shape (4 or 6, ...)."""
    a, b, c, *shear = stress
    normal = (a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2
    return np.sqrt(normal / 2 + 3 * sum(part**2 for part in shear))
