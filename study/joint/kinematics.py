"""Which points of ball and socket face each other, and along which normals pressure acts.

There are two contact problems, `small` and `linear`, which differ by terms of order 1/R2*. Lengths
are in socket radii R2, pressures in E* dR/R2 and depths in dR. Arguments are not checked here.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from study import checks
from study.joint.compliance import Compliance, HatFunctions, surface_angles
from study.joint.description import JointDescription

Problem = Callable[[float], tuple[NDArray[np.float64], NDArray[np.float64]]]
"""Depth_star -> matrix (n, n), and gap (3, n): its factors of 1, depth_star and depth_star^2.

The matrix and the gap's factors depend on the depth by terms of order 1/R2* only.
"""
Floats = NDArray[np.float64]


class UnresolvedError(checks.RangeError):
    """A contact smaller than the elements can resolve."""


def unresolved(depth: float, angles: Floats) -> UnresolvedError:
    """Error of a contact at a depth_star, with nodes at some angles."""
    return UnresolvedError(
        "depth_star must be 0 or large enough for the elements to resolve the contact, got "
        f"{depth:.3g} with elements of {np.degrees(angles[1]):.2g} deg; use a finer resolution or "
        "Hertz's law"
    )


def at_rim(name: str, joint: JointDescription, got: str) -> checks.RangeError:
    """Error of depths or forces at which contact reaches the socket's rim."""
    return checks.RangeError(
        f"{name} must be small enough that the contact does not reach the rim of the socket (at a "
        f"half-angle of {np.degrees(joint.opening.reach):g} deg), got {got}"
    )


def small(joint: JointDescription, ball: Compliance, socket: Compliance) -> tuple[Problem, Floats]:
    """Contact problem with pairs at equal angles, and the axial force of unit nodal pressures.

    The gap is the rigid spheres' exact overlap.
    """
    of_ball, of_socket = joint.modulus_shares
    r1, r2_star = joint.radius_ratio, joint.r2_star
    matrix = of_ball * r1 * ball.flexibility + of_socket * socket.flexibility
    hats = HatFunctions(ball.angles)

    apart, axial = hats.integrate(_apart), hats.integrate(np.cos)

    def problem(depth):
        e = (1 + depth) / r2_star

        def beyond(theta):
            # beyond the ball's tangent there is no ball, and the root would be imaginary
            side = np.minimum(np.sin(theta) ** 2, (r1 / e) ** 2)
            return side / (r1 + np.sqrt(np.maximum(r1**2 - e**2 * side, 0))) / r2_star

        return matrix, _in_powers(apart, axial, hats.integrate(beyond))

    return problem, axial


def linear(joint: JointDescription, ball: Compliance, socket: Compliance) -> tuple[Problem, Floats]:
    """Contact problem with each point of the ball facing the point it has moved to, as `small`."""
    of_ball, of_socket = joint.modulus_shares
    of_pressure = of_ball * joint.radius_ratio * ball.flexibility
    # the socket's hats do not see ripples of the pressure; these act as on a half-space
    width = np.convolve(np.diff(ball.angles), [0.5, 0.5])
    local = np.sqrt(2 / np.pi * (1 - joint.innermost.poisson**2) * width)

    def problem(depth):
        moved, unseen, gap = _pairs(joint.r2_star, depth, len(width) - 1, ball.angles[-1])
        by_socket = moved @ (moved @ socket.between_nodes).T + local[:, None] * unseen * local
        return of_pressure + of_socket * by_socket, gap

    return problem, joint.radius_ratio**2 * HatFunctions(ball.angles).integrate(np.cos)


def problem_of(
    joint: JointDescription, ball: Compliance, socket: Compliance
) -> tuple[Problem, Floats]:
    """Contact problem of a joint, `small` or `linear`."""
    return (linear if joint.acts_on_ball else small)(joint, ball, socket)


@lru_cache(maxsize=64)  # 20 depths on two meshes, and more
def _pairs(r2_star, depth, resolution, last):
    """What moves pressure to the socket's nodes, what this loses, and the gap, for all bodies."""
    # The socket's displacement is wanted where each Gauss point of the ball faces it, and the
    # ball's pressure acts there. ``seen`` has the socket's hats at the points faced, ``moved``
    # their products with the ball's hats. What of the ball's hats no socket's hat can follow is
    # ``unseen``: the ball's mass matrix less its projection on the hats seen.
    hats = HatFunctions(surface_angles(resolution, last))
    r1, e = 1 - 1 / r2_star, (1 + depth) / r2_star
    weights = (r1 * hats.areas)[:, None]
    seen = hats.values(_faced(r1, e, hats.points))
    moved = (hats.values(hats.points) * weights).T.tocsr() @ seen
    of_seen = seen.T @ (seen * weights)
    within = np.array([np.append(0, of_seen.diagonal(1)), of_seen.diagonal()])
    within[1, within[1] == 0] = 1.0  # beyond the last point faced
    unseen = r1 * hats.mass() - moved @ scipy.linalg.solveh_banded(within, moved.T.toarray())

    def beyond(phi):
        along, side = r1 + e * np.cos(phi), np.sin(phi) ** 2
        return -side / (along + np.sqrt(along**2 + e**2 * side)) / r2_star

    gap = _in_powers(*(hats.integrate(of) for of in (_apart, np.cos, beyond)))
    return moved, unseen, gap


def _apart(angles):
    """Gap at depth 0, but for its part of order 1/R2*: 1 - cos(angle), without cancellation."""
    return 2 * np.sin(angles / 2) ** 2


def _in_powers(apart, axial, beyond):
    """Factors of 1, depth and depth^2 of ``apart - depth axial + (1 + depth)^2 beyond``."""
    return np.array([apart + beyond, 2 * beyond - axial, beyond])


def _faced(ball_radius, eccentricity, angles):
    """Polar angles of the socket's points that points of the ball have moved to."""
    return np.arctan2(ball_radius * np.sin(angles), ball_radius * np.cos(angles) + eccentricity)


def socket_pressure(
    joint: JointDescription, depths: Floats, angles: Floats, pressure: Floats
) -> Floats:
    """Pressure on the socket (k, n) from that on the ball; facing areas carry equal forces."""
    if not joint.acts_on_ball:
        return pressure
    r1, moved = joint.radius_ratio, np.zeros_like(pressure)
    for k, depth in enumerate(depths):
        e = (1 + depth) / joint.r2_star
        away = np.sqrt(r1**2 + e**2 + 2 * r1 * e * np.cos(angles))
        shrunk = away**3 / (r1 + e * np.cos(angles))  # the ball's area over the socket's
        moved[k] = np.interp(angles, _faced(r1, e, angles), pressure[k] * shrunk)
    return moved
