"""Which points of ball and socket face each other, and along which normals pressure acts.

There is one answer for each of the ``kinematics`` of `study.joint.Joint`. Lengths are in socket
radii R2, pressures in E* dR/R2 and depths in dR. Arguments are not checked here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular, solveh_banded

from study import checks
from study.joint import complementarity
from study.joint.compliance import Compliance, HatFunctions, surface_angles
from study.threads import one_thread

if TYPE_CHECKING:
    from study.joint.curve import ForceCurve
    from study.joint.definition import Joint
    from study.joint.fem import MeshedBody

Problem = Callable[[float], tuple[NDArray[np.float64], NDArray[np.float64]]]
"""Depth_star -> matrix (n, n), and gap (3, n): factors of 1, D and D^2, D = 1 + depth_star.

The matrix and the gap's last factor depend on the depth by terms of order 1/R2* only.
"""
Floats = NDArray[np.float64]

RELAXATIONS = (0.8, 0.5, 0.25)  # of the pressure's step, tried in turn: they damp modes as
# short as the elements, which are stronger for a softer socket
TOLERANCE = 1e-7  # of the force between two steps
MOST_STEPS = 60
BEYOND = 8  # nodes by which the contact at a smaller depth may reach farther
LARGEST_R2_STAR = 1e8  # beyond it the gap is lost in the rounding of the surfaces' places
FEWEST = 4  # nodes in a contact at large displacements: fewer do not converge


class UnresolvedError(checks.RangeError):
    """A contact smaller than the elements can resolve."""


def unresolved(depth: float, angles: Floats) -> UnresolvedError:
    """Error of a contact at a depth_star, with nodes at some angles."""
    return UnresolvedError(
        "depth_star must be 0 or so large that the elements resolve the contact, got "
        f"{depth:.3g} with elements of {np.degrees(angles[1]):.2g} deg"
    )


def small(joint: Joint, ball: Compliance, socket: Compliance) -> tuple[Problem, Floats]:
    """Contact problem with pairs at equal angles, and the axial force of unit nodal pressures.

    The gap is the rigid spheres' exact overlap.
    """
    of_ball, of_socket = joint.modulus_shares
    r1, r2_star = joint.ball_radius, joint.r2_star
    matrix = of_ball * r1 * ball.flexibility + of_socket * socket.flexibility
    hats = HatFunctions(ball.angles)

    constant, axial = hats.integrate(np.ones_like), hats.integrate(np.cos)

    def problem(depth):
        e = (1 + depth) / r2_star

        def beyond(theta):
            # beyond the ball's tangent there is no ball, and the root would be imaginary
            side = np.minimum(np.sin(theta) ** 2, (r1 / e) ** 2)
            return side / (r1 + np.sqrt(np.maximum(r1**2 - e**2 * side, 0))) / r2_star

        return matrix, np.array([constant, -axial, hats.integrate(beyond)])

    return problem, axial


def linear(joint: Joint, ball: Compliance, socket: Compliance) -> tuple[Problem, Floats]:
    """Contact problem with each point of the ball facing the point it has moved to, as `small`."""
    of_ball, of_socket = joint.modulus_shares
    of_pressure = of_ball * joint.ball_radius * ball.flexibility
    # the socket's hats do not see ripples of the pressure; these act as on a half-space
    width = np.convolve(np.diff(ball.angles), [0.5, 0.5])
    local = np.sqrt(2 / np.pi * (1 - joint.socket.poisson**2) * width)

    def problem(depth):
        moved, unseen, gap = _pairs(joint.r2_star, depth, len(width) - 1, ball.angles[-1])
        by_socket = moved @ (moved @ socket.between_nodes).T + local[:, None] * unseen * local
        return of_pressure + of_socket * by_socket, gap

    return problem, joint.ball_radius**2 * HatFunctions(ball.angles).integrate(np.cos)


PROBLEMS = {"small": small, "linear": linear}
"""Contact problems of linear bodies, by the joint's ``kinematics``."""


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
    unseen = r1 * hats.mass() - moved @ solveh_banded(within, moved.T.toarray())

    def beyond(phi):
        along, side = r1 + e * np.cos(phi), np.sin(phi) ** 2
        return -side / (along + np.sqrt(along**2 + e**2 * side)) / r2_star

    gap = [hats.integrate(np.ones_like), -hats.integrate(np.cos), hats.integrate(beyond)]
    return moved, unseen, np.array(gap)


def _faced(ball_radius, eccentricity, angles):
    """Polar angles of the socket's points that points of the ball have moved to."""
    return np.arctan2(ball_radius * np.sin(angles), ball_radius * np.cos(angles) + eccentricity)


def socket_pressure(curve: ForceCurve) -> Floats:
    """Pressure on the socket (k, n); facing areas of the ball carry equal forces."""
    joint, angles, pressure = curve.joint, curve.angles, curve.pressure
    if joint.kinematics == "small":
        return pressure
    r1, moved = joint.ball_radius, np.zeros_like(pressure)
    for k, depth in enumerate(curve.depth_star):
        e = (1 + depth) / joint.r2_star
        away = np.sqrt(r1**2 + e**2 + 2 * r1 * e * np.cos(angles))
        shrunk = away**3 / (r1 + e * np.cos(angles))  # the ball's area over the socket's
        moved[k] = np.interp(angles, _faced(r1, e, angles), pressure[k] * shrunk)
    return moved


@one_thread
def solve(
    joint: Joint, depths: Floats, problem: Problem, axial: Floats, times: Sequence[float] = (1.0,)
) -> tuple[Floats, Floats]:
    """Pressures (k, n) at the depths, and forces (m, k) at them ``times`` m factors, the first 1.

    For `small` or `linear` pairing, with linear bodies. All factors have the matrix of the depth
    itself.
    """
    pressure, force = np.zeros((len(depths), len(axial))), np.zeros((len(times), len(depths)))
    reach = len(axial)
    for k in np.argsort(-depths, kind="stable"):
        if depths[k] > 0:
            matrix, parts = problem(depths[k])
            gaps = (1 + np.outer(times, depths[k])) ** np.arange(3) @ parts
            pressure[k], force[:, k] = _contact(matrix, gaps, axial, reach)
            reach = min(int(1.02 * np.count_nonzero(pressure[k])) + BEYOND, len(axial))
    return pressure, joint.r2_star * force


def _contact(matrix, gaps, axial, reach):
    """Pressure under the first of the gaps, and the axial force under each.

    Contact grows from the pole, node by node: the leading part of one Cholesky factor is the factor
    of a smaller contact. It ends before the node that would be pulled, and is sought among the
    nodes in ``reach``. If pressure or gap is negative after all, pivoting finds it.
    """
    lower, solved = factor(matrix[:reach, :reach], np.vstack([gaps, axial])[:, :reach])
    pulled = np.column_stack([solved[:-1] >= 0, np.ones(len(gaps), dtype=bool)])
    ends, pressure = pulled.argmax(axis=1), np.zeros(len(axial))
    part, of_gap = lower[: ends[0], : ends[0]], solved[0, : ends[0]]
    pressure[: ends[0]] = solve_triangular(part, -of_gap, lower=True, trans=1, check_finite=False)
    gap = gaps[0] + matrix[:, : ends[0]] @ pressure[: ends[0]]
    zero = complementarity.TOLERANCE
    if pressure.min() < 0 or gap.min() < -zero * np.abs(gaps[0]).max():
        pressures = [complementarity.solve(matrix, gap, pressure > 0)[0] for gap in gaps]
        return pressures[0], pressures @ axial
    forces = np.cumsum(-solved[:-1] * solved[-1], axis=1)
    return pressure, np.where(ends > 0, forces[np.arange(len(gaps)), ends - 1], 0.0)


def factor(matrix: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Lower Cholesky factor of a contact matrix, and the rows of (m, n) solved with it."""
    lower = complementarity.factorised(partial(cholesky, lower=True), matrix)
    return lower, solve_triangular(lower, right.T, lower=True, check_finite=False).T


@one_thread
def solve_finite(
    joint: Joint, depths: Floats, ball: MeshedBody, socket: MeshedBody
) -> tuple[Floats, Floats]:
    """Pressures (k, n) and forces (k,) at large displacements.

    At each depth the `linear` contact problem is solved some ten times, with the gap of the
    deformed surfaces. Loads are what internal forces, and pressures along deformed normals, have
    beyond the linear ones. They are of order 1/R2*, so that the linear factorisation serves all
    steps. Pressure is per area of the unloaded ball. Steps that do not converge raise
    `study.joint.complementarity.ComplementarityError`.
    """
    problem, axial = linear(joint, ball.compliance, socket.compliance)
    surfaces = _Surfaces(joint, ball, socket)
    pressure = np.zeros((len(depths), len(ball.compliance.angles)))
    force, current = np.zeros(len(depths)), pressure[0]
    for k in np.argsort(depths, kind="stable"):
        if depths[k] > 0:
            matrix, parts = problem(depths[k])
            gap = (1 + depths[k]) ** np.arange(3) @ parts
            if np.count_nonzero(_contact(matrix, gap[None], axial, len(axial))[0]) < FEWEST:
                raise unresolved(depths[k], ball.compliance.angles)
            current, force[k] = _iterate(surfaces, depths[k], matrix, current)
            pressure[k] = current
    return pressure, force


def _iterate(surfaces, depth, matrix, pressure):
    """Pressure and force at one depth, from those of a smaller one."""
    start = surfaces.displacements
    for relaxation in RELAXATIONS:
        surfaces.displacements = start
        current, force, active = pressure, 0.0, None
        for _ in range(MOST_STEPS):
            gap, normals, angles = surfaces.face(depth)
            residual = surfaces.hats.T @ (surfaces.area * gap) - matrix @ current
            wanted, active = complementarity.solve(matrix, residual, active)
            current = current + relaxation * (wanted - current)
            last, force = force, surfaces.deform(current, normals, angles)
            if not np.isfinite(force):
                break
            if abs(force - last) < TOLERANCE * abs(force):
                return np.where(active, current, 0.0), force
    raise complementarity.ComplementarityError(
        f"contact with finite kinematics did not converge at depth_star {depth:g}: strains of the "
        "order of depth_star/R2* are too large, or the socket too soft; take smaller depths or "
        "linear kinematics"
    )


class _Surfaces:
    """Both bodies' surfaces as they deform, sampled at the ball's Gauss points."""

    def __init__(self, joint, ball, socket):
        self._joint, self._bodies = joint, (ball, socket)
        functions = HatFunctions(ball.compliance.angles)
        self._theta, self.area = functions.points, functions.areas
        self.hats = functions.values(self._theta)
        self._shapes = _quadratic_shapes(ball.angles, self._theta)
        self.displacements = np.zeros(ball.size), np.zeros(socket.size)

    def face(self, depth):
        """Gap in dR, normals of the socket and reference angles of the points faced."""
        from scipy.interpolate import CubicSpline  # a quarter of a second, for `finite` alone

        joint = self._joint
        ball, socket = (
            CubicSpline(body.angles, displacement[body.surface].T)
            for body, displacement in zip(self._bodies, self.displacements, strict=True)
        )
        place = joint.ball_radius * (_sphere(self._theta) + ball(self._theta))
        place[:, 1] += (1 + depth) / joint.r2_star
        angles = np.arctan2(*place.T)
        for _ in range(6):  # nearest points, by Gauss-Newton steps
            tangent = _tangent(angles) + socket(angles, 1)
            off = ((place - _sphere(angles) - socket(angles)) * tangent).sum(axis=1)
            angles = np.clip(angles + off / (tangent**2).sum(axis=1), 0, np.pi / 2)
        tangent = _tangent(angles) + socket(angles, 1)
        normals = np.column_stack([-tangent[:, 1], tangent[:, 0]])
        normals /= np.hypot(*normals.T)[:, None]
        gap = -((place - _sphere(angles) - socket(angles)) * normals).sum(axis=1)
        return gap * joint.r2_star, normals, angles

    def deform(self, pressure, normals, angles):
        """Displace the bodies under pressure along normals; returns the force P*."""
        joint = self._joint
        of_ball, of_socket = joint.modulus_shares
        traction = (self.area * (self.hats @ pressure))[:, None] * normals / joint.r2_star
        pull = _quadratic_shapes(self._bodies[1].angles, angles).T @ traction
        loads = -of_ball * self._shapes.T @ traction, of_socket * joint.ball_radius**2 * pull
        moved = []
        for body, displacement, load in zip(self._bodies, self.displacements, loads, strict=True):
            force = -body.excess_force(displacement)
            force[body.surface] += load.T
            moved.append(body.solve(force))
            if not np.abs(moved[-1]).max() < 1:  # a radius: diverging, the caller stops
                return np.nan
        self.displacements = tuple(moved)
        return joint.r2_star**2 * joint.ball_radius**2 * traction[:, 1].sum()


def _sphere(theta):
    return np.column_stack([np.sin(theta), np.cos(theta)])


def _tangent(theta):
    return np.column_stack([np.cos(theta), -np.sin(theta)])


def _quadratic_shapes(angles, theta):
    """Shape functions at ``theta`` of quadratic edges; ``angles`` of their ends and middles."""
    ends = angles[::2]
    edge = np.clip(np.searchsorted(ends, theta) - 1, 0, len(ends) - 2)
    x = (theta - ends[edge]) / np.diff(ends)[edge]
    shapes, rows = np.zeros((len(theta), len(angles))), np.arange(len(theta))
    shapes[rows, 2 * edge] = (1 - x) * (1 - 2 * x)
    shapes[rows, 2 * edge + 1] = 4 * x * (1 - x)
    shapes[rows, 2 * edge + 2] = x * (2 * x - 1)
    return shapes
