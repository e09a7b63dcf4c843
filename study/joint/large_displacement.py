"""Contact at large displacements and rotations: the ``finite`` kinematics of `study.joint.Joint`.

Lengths are in socket radii R2, pressures in E* dR/R2 and depths in dR. Arguments are not checked
here.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from study.joint import complementarity
from study.joint.compliance import HatFunctions
from study.joint.contact_kinematics import linear, unresolved
from study.joint.definition import Joint
from study.joint.fem import MeshedBody
from study.threads import one_thread

Floats = NDArray[np.float64]

RELAXATIONS = (0.8, 0.5, 0.25)  # of the pressure's step, tried in turn: they damp modes as
# short as the elements, which are stronger for a softer socket
TOLERANCE = 1e-7  # of the force between two steps
MOST_STEPS = 60
LARGEST_R2_STAR = 1e8  # beyond it the gap is lost in the rounding of the surfaces' places
FEWEST = 4  # nodes in a contact at large displacements: fewer do not converge


@one_thread
def solve(
    joint: Joint, depths: Floats, ball: MeshedBody, socket: MeshedBody
) -> tuple[Floats, Floats, Floats]:
    """Pressures (k, n) and forces (k,) at large displacements, and forces of ``linear`` kinematics.

    At each depth the `linear` contact problem is solved some ten times, with the gap of the
    deformed surfaces. Loads are what internal forces, and pressures along deformed normals, have
    beyond the linear ones. They are of order 1/R2*, so that one factorisation is enough. Pressure
    is per area of the unloaded ball.
    """
    problem, axial = linear(joint, ball.compliance, socket.compliance)
    surfaces = _Surfaces(joint, ball, socket)
    pressure = np.zeros((len(depths), len(ball.compliance.angles)))
    force, of_linear, current = np.zeros(len(depths)), np.zeros(len(depths)), pressure[0]
    for k in np.argsort(depths, kind="stable"):
        if depths[k] > 0:
            matrix, parts = problem(depths[k])
            gap = depths[k] ** np.arange(3) @ parts
            first, active = complementarity.solve(matrix, gap)
            if np.count_nonzero(active) < FEWEST:
                raise unresolved(depths[k], ball.compliance.angles)
            of_linear[k] = joint.r2_star * axial @ first
            current, force[k] = _iterate(surfaces, depths[k], matrix, current)
            pressure[k] = current
    return pressure, force, of_linear


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
        f"the contact with finite kinematics did not converge at depth_star {depth:g}, because the "
        "strains (of the order of depth_star/R2*) are too large or the socket is too soft; use "
        "smaller depths or linear kinematics"
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
