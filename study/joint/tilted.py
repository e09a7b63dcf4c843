"""A joint pressed off its axis: the forces along and across, from contact on (theta, phi).

The bodies are those of revolution of `study.joint.fem`, about the socket's axis. The ball is
displaced in a direction off that axis, in the plane phi = 0. Pressure is piecewise linear in both
angles and symmetric about that plane. Its flexibility comes from the modes of
`study.joint.fourier`. As along the axis, pressure and gap are complementary in the weak sense, and
`study.joint.complementarity` finds the contact in a few steps, however fine the grid.

Lengths are in socket radii R2, pressures in E* dR/R2 and displacements in dR inside this module.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_array

from study import checks
from study.contact import largest_depth
from study.joint import complementarity
from study.joint.contact_kinematics import UnresolvedError
from study.joint.definition import Joint
from study.joint.supports import KINEMATICS, Bore
from study.threads import one_thread

Floats = NDArray[np.float64]
RESOLUTION = 48
"""Default elements along a quarter circle; half of it is solved too."""
FINEST_RESOLUTION = 96
LARGEST_TILT = 170.0
"""In deg: beyond it no socket has a surface."""
_RADIAL_ELEMENTS = 0.2  # as in `study.joint.fem`, for elements of equal angles
_TOGETHER = 16  # nodes around of which coarser rings leave all but one out
_BEYOND = 8.0  # least deg by which the ball's nodes go on beyond the rim
_DEEPEST = 1.0  # depth_star at which they still face the whole rim; largest first guess
_LEAST_SHARE = 0.3  # of the deepest overlap: shallower ones are at first left out of the contact
_FEWEST = 12  # nodes of a contact of half the resolution
_MOST_STEPS = 40
_TOLERANCE = 1e-6  # of the force that is asked for


@dataclass(frozen=True)
class TiltedContact:
    """Contact of a ball that is displaced off the socket's axis, at some depths; arrays (k,).

    Forces are those of the ball on the socket, over E* dR^2, and extrapolated from two grids.

    Attributes
    ----------
    depth_star, tilt
        Displacement beyond first touch over dR, and its direction off the axis in deg.
    force_star, transverse_star
        Force along the displacement, and across it in the plane of symmetry: positive towards
        larger tilt. Where the rim cuts the contact it is negative.
    stiffness_star, transverse_stiffness_star
        Derivatives of the two by a displacement along and across, over E* dR.
    peak_pressure_star, peak_angle_deg
        Largest pressure, in E* dR/R2, and its signed polar angle in the plane of symmetry. At the
        edge of the rim it grows with the resolution.
    contact_edges_deg
        Signed polar angles at which the contact ends in the plane of symmetry; shape (2, k).
    reaches_rim
        Whether the contact is cut by the rim.
    error_estimate
        Estimated relative error of the force, as of `study.joint.ForceCurve`. The peak pressure
        has another: at the default resolution it ripples by up to 2 % from node to node.
    """

    joint: Joint
    depth_star: Floats
    tilt: Floats
    force_star: Floats
    transverse_star: Floats
    stiffness_star: Floats
    transverse_stiffness_star: Floats
    peak_pressure_star: Floats
    peak_angle_deg: Floats
    contact_edges_deg: Floats
    reaches_rim: NDArray[np.bool_]
    error_estimate: Floats


@one_thread
def tilted_contact(
    joint: Joint, depth_star: ArrayLike, tilt: ArrayLike, resolution: int = RESOLUTION
) -> TiltedContact:
    """Contact at given depths of a ball displaced in given directions.

    New bodies take some seconds, then a depth takes a tenth of a second.

    Parameters
    ----------
    depth_star
        Displacement over dR, less one: > 0 and < sqrt(2 R2* - 1) - 1; shape (k,).
    tilt
        Direction of the displacement off the axis, from 0 to 170 deg; one number or shape (k,).
    resolution
        Elements along a quarter circle, from 32 to 96, a multiple of 16; half of it is solved too.

    Raises
    ------
    ValueError
        For a joint whose ball is free across the axis (``guided`` and ``centre``), whose rim is a
        mirror plane, or whose kinematics are ``finite``; for a value outside its range; for a
        contact that is too small to be resolved, or a tilt that leaves none.
    """
    depths, tilts, resolution = _checked(joint, depth_star, tilt, "depth_star", resolution)
    checks.number("depth_star", depths, below=largest_depth(joint.r2_star))
    fine, coarse = (_Contacts(joint, n) for n in (resolution, resolution // 2))
    solved = [(fine.solve(*at), coarse.solve(*at)) for at in zip(depths, tilts, strict=True)]
    return _result(joint, depths, tilts, solved)


@one_thread
def under_force(
    joint: Joint, force_star: ArrayLike, tilt: ArrayLike, resolution: int = RESOLUTION
) -> TiltedContact:
    """`tilted_contact` under forces that point off the axis by a tilt; displacements follow.

    Without friction no force can point out of the opening: its tilt is inside the opening. Other
    arguments and errors are those of `tilted_contact`; a force that no displacement inside the
    joint bears is a ``ValueError`` too.
    """
    forces, tilts, resolution = _checked(joint, force_star, tilt, "force_star", resolution)
    for outside in (one for one in tilts if not joint.opening.faces(one)):
        raise checks.RangeError(
            f"tilt of a force must be inside the socket's opening of {joint.opening} deg, got "
            f"{outside:g} deg: without friction no force points out of the opening. Give the depth "
            "of a displacement in this direction, or a socket that reaches further"
        )
    fine, coarse = (_Contacts(joint, n) for n in (resolution, resolution // 2))
    found = [_pressed(joint, fine, coarse, *at) for at in zip(forces, tilts, strict=True)]
    depths, directions = np.array([at for at, _ in found]).T
    return _result(joint, depths, directions, [solved for _, solved in found])


def _checked(joint, values, tilt, name, resolution):
    """Depths or forces, as many tilts, and the resolution; refuses a joint that is not for them."""
    checks.instance("joint", joint, Joint)
    if joint.ball_support.is_free_across:
        wanted = "clamped, core:NUMBER, neck:NUMBER or bore:NUMBER,NUMBER"
        why = f"the ball is free across the axis, got {joint.ball_support}"
        raise checks.RangeError(f"ball_support under a tilted load must be {wanted}: {why}")
    checks.choice("rim under a tilted load", joint.rim, ("free",))
    checks.choice("kinematics under a tilted load", joint.kinematics, KINEMATICS[:2])
    values = np.atleast_1d(checks.number(name, values, above=0))
    tilts = np.atleast_1d(checks.number("tilt", tilt, "deg", least=0, most=LARGEST_TILT))
    if values.ndim != 1 or values.size == 0 or tilts.shape not in ((1,), values.shape):
        shapes = f"{values.shape} and {tilts.shape}"
        raise ValueError(f"{name} must be a list, and tilt one number or as many, got {shapes}")
    checks.whole("resolution", resolution, least=32, most=FINEST_RESOLUTION)
    if resolution % 16:
        raise ValueError(f"resolution must be a multiple of 16, got {resolution}")
    return values, np.broadcast_to(tilts, values.shape), resolution


def _pressed(joint, fine, coarse, force, tilt):
    """Depth and tilt of the displacement under a force, and what is solved there, by Newton."""
    wanted, reached = force * _direction(tilt), None
    first = min((3 * force / (4 * joint.r2_star)) ** (2 / 3), _DEEPEST)  # Hertz's law, about
    displacement = (1 + first) * _direction(tilt)
    for _ in range(_MOST_STEPS):
        towards = max(np.degrees(np.arctan2(*displacement)), 0.0)  # not -1e-15
        depth = np.hypot(*displacement) - 1
        try:
            checks.number("depth_star", depth, below=largest_depth(joint.r2_star))
            solved = fine.solve(depth, towards), coarse.solve(depth, towards)
        except checks.RangeError:
            if reached is None:
                raise
            displacement = (displacement + reached) / 2  # half the step
            continue
        axes, reached = _axes(towards), displacement
        missing = axes @ wanted - _extrapolated(*(s.force for s in solved))
        if np.hypot(*missing) < _TOLERANCE * force:
            return (depth, towards), solved
        step = np.linalg.solve(solved[0].stiffness, missing)
        step[0] = np.clip(step[0], -0.6 * depth, 2 * depth)
        displacement = displacement + axes.T @ step
    raise checks.RangeError(
        "force_star must be one that the ball bears inside the rim, got "
        f"{force:g} at a tilt of {tilt:g} deg"
    )


def _direction(tilt):
    """Unit vector (x, z) at an angle in deg from the axis z."""
    return np.array([np.sin(np.radians(tilt)), np.cos(np.radians(tilt))])


def _axes(tilt):
    """Unit vectors along a direction, and across it towards larger tilt, as rows (x, z)."""
    x, z = _direction(tilt)
    return np.array([[x, z], [z, -x]])


def _extrapolated(fine, coarse):
    return fine + (fine - coarse) / 3  # errors fall with order 2


def _result(joint, depths, tilts, solved):
    """What was solved on the finer and on the coarser grid at each depth, as arrays."""
    fine = [f for f, _ in solved]
    force = np.array([_extrapolated(f.force, c.force) for f, c in solved])
    stiffness = np.array([_extrapolated(f.stiffness, c.stiffness) for f, c in solved])
    off = np.array([np.hypot(*(f.force - c.force)) for f, c in solved]) / np.hypot(*force.T)
    return TiltedContact(
        joint=joint,
        depth_star=depths,
        tilt=tilts,
        force_star=force[:, 0],
        transverse_star=force[:, 1],
        stiffness_star=stiffness[:, 0, 0],
        transverse_stiffness_star=stiffness[:, 1, 1],
        peak_pressure_star=np.array([f.peak for f in fine]),
        peak_angle_deg=np.array([f.peak_angle for f in fine]),
        contact_edges_deg=np.array([f.edges for f in fine]).T,
        reaches_rim=np.array([f.reaches_rim for f in fine]),
        error_estimate=off,
    )


@dataclass(frozen=True)
class _Solved:
    """Contact on one grid: force and stiffness along and across, the rest as in `TiltedContact`."""

    force: Floats
    stiffness: Floats
    peak: float
    peak_angle: float
    edges: tuple[float, float]
    reaches_rim: bool


class _Contacts:
    """Contacts of one joint on one grid of the socket."""

    def __init__(self, joint, resolution):
        self.joint = joint
        beyond = max(_BEYOND, np.degrees((1 + _DEEPEST) / joint.r2_star))
        self.ball = _ball(joint.ball_body, beyond, resolution)
        self.socket = _socket(joint.socket_body, resolution)
        grid = self.socket.grid
        theta, phi, self.area = grid.points
        self.hats = grid.values(theta, phi)
        sine = np.sin(theta)
        self.normal = np.column_stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)])

    def solve(self, depth, tilt):
        """`_Solved` at a depth_star, of a displacement at a tilt in deg."""
        joint, grid = self.joint, self.socket.grid
        r1, (share_of_ball, share_of_socket) = joint.ball_radius, joint.modulus_shares
        axes = np.insert(_axes(tilt), 1, 0.0, axis=1)
        gap, facing = _rigid_ball(joint, self.normal, (1 + depth) / joint.r2_star * axes[0])
        moves = joint.kinematics == "linear"
        normal = facing if moves else self.normal
        place = np.arccos(np.clip(normal[:, 2], -1, 1)), np.arctan2(normal[:, 1], normal[:, 0])
        met = self.ball.grid.faces(place[0])
        ends_at_edge = joint.ball_support.is_half or isinstance(joint.ball_support, Bore)
        if not ends_at_edge and (gap[~met] < 0).any():
            raise checks.RangeError(
                f"depth_star must keep the ball's neck or back out of the opening, got {depth:g}"
            )
        area = self.area * met
        weighted = csr_array((self.hats * area[:, None]).T)
        size, gap, cut = weighted.sum(axis=1), weighted @ gap, self.hats.T @ ~met
        mass = weighted @ self.hats
        moved = weighted @ self.ball.grid.values(*place)
        overlap = np.divide(-gap, size, out=np.zeros_like(gap), where=size > 0)
        if overlap.max() <= 0 and joint.opening.faces(tilt) and met.any():
            raise _unresolved(depth)
        if overlap.max() <= 0:
            raise checks.RangeError(
                f"tilt must leave a contact inside the opening of {joint.opening} deg and on the "
                f"ball's surface, got {tilt:g} deg at a depth_star of {depth:g}"
            )
        wanted, guess = overlap > _LEAST_SHARE * overlap.max(), overlap > 0.5 * overlap.max()
        while True:
            nodes = np.flatnonzero(wanted)
            by_socket = share_of_socket * self.socket.matrix(nodes)
            whole = size[nodes] / grid.ends[nodes]
            by_ball = self._of_ball(moved[nodes], mass[nodes][:, nodes], whole)
            scale = share_of_ball * (1 / r1 if moves else r1)
            matrix = by_socket + scale * by_ball
            pressure, active = complementarity.solve(matrix, gap[nodes], guess[nodes])
            touching = np.zeros(grid.size)
            touching[nodes[active]] = 1
            beside = mass @ touching > 0
            if not (beside & ~wanted).any():
                break
            wanted, guess = wanted | (mass @ (mass @ beside) > 0), touching > 0
        nodes, pressure = nodes[active], pressure[active]
        if len(nodes) < _FEWEST:
            raise _unresolved(depth)
        loads = (weighted @ (normal @ axes.T))[nodes]
        closing = facing / (facing * self.normal).sum(axis=1)[:, None]  # the gap's derivative
        by_pressure = cho_solve(
            cho_factor(matrix[np.ix_(active, active)]), (weighted @ (closing @ axes.T))[nodes]
        )
        signed = np.where(grid.phi < np.pi / 2, 1, -1) * np.degrees(grid.theta)
        rims = [grid.ring[-1]] if grid.pole == 0 else [0, grid.ring[-1]]
        in_plane = grid.ends[nodes] < 1
        return _Solved(
            force=2 * joint.r2_star * loads.T @ pressure,
            stiffness=2 * joint.r2_star * loads.T @ by_pressure,
            peak=float(pressure.max()),
            peak_angle=float(signed[nodes[pressure.argmax()]]),
            edges=_edges(signed[nodes[in_plane]], pressure[in_plane], grid),
            reaches_rim=bool(np.isin(grid.ring[nodes], rims).any() or cut[nodes].any()),
        )

    def _of_ball(self, moved, mass, whole):
        """Flexibility of the ball under hats of the socket, of a unit ball.

        The integrals ``whole`` of the hats are those on both sides of the plane of symmetry.
        """
        # displacements are wanted where points of the socket face the ball, whose hats are
        # lumped; what they do not see acts as on a half-space
        columns = np.unique(moved.indices)
        moved = moved[:, columns]
        spread = moved @ csr_array(np.diag(1 / self.ball.areas[columns]))
        unseen = (mass - spread @ moved.T).toarray()
        local = np.sqrt(2 / np.pi * (1 - self.joint.ball.poisson**2) * np.sqrt(whole))
        seen = spread @ (spread @ self.ball.matrix(columns)).T
        return seen + local[:, None] * unseen * local


def _rigid_ball(joint, normal, centre):
    """Gap in dR between a socket's points and a rigid ball, and the ball's normals that face them.

    Along the socket's ``normal`` (n, 3) the ball, with a ``centre`` off the socket's, ends at a
    distance from the latter.
    """
    along, r1 = normal @ centre, joint.ball_radius
    distance = along + np.sqrt(np.maximum(r1**2 - centre @ centre + along**2, 1e-12))
    return (1 - distance) * joint.r2_star, (distance[:, None] * normal - centre) / r1


def _unresolved(depth):
    return UnresolvedError(
        "depth_star must be so large that the elements resolve the contact, got "
        f"{depth:.3g}: press along the axis, or take a finer resolution"
    )


def _edges(angles, pressure, grid):
    """Where contact ends in the plane of symmetry: signed angles in deg, minimum and maximum.

    Near an edge the pressure's square is linear. Ends are inside the grid's rims.
    """
    step, (first, last) = np.degrees(grid.step), np.degrees(grid.angles[[0, -1]])
    order = np.argsort(angles)
    angles, pressure = angles[order], pressure[order]
    if len(angles) < 2:
        angles, pressure = np.repeat(angles, 2), np.repeat(pressure, 2)
    found = []
    for side, (inner, outer) in ((-1, (1, 0)), (1, (-2, -1))):
        fall = pressure[inner] ** 2 - pressure[outer] ** 2
        share = min(pressure[outer] ** 2 / fall, 1.0) if fall > 0 else 0.5
        end = angles[outer] + side * share * step
        found.append(float(np.sign(end) * np.clip(abs(end), first, last)))
    return tuple(found)


def _angles(opening, resolution):
    """Polar angles of a socket's nodes, and the number of nodes around its largest ring."""
    count = 2 * round((opening.last - opening.first) / 180 * resolution)
    angles = np.radians(opening.first + (opening.last - opening.first) / count * np.arange(count + 1))
    widest = np.sin(angles).max() if not opening.is_ring and opening.last < 90 else 1.0
    around = np.ceil(2 * np.pi * widest / (angles[1] - angles[0]) / _TOGETHER)
    return angles, _TOGETHER * int(around)


@lru_cache(maxsize=6)
def _ball(ball, beyond, resolution):
    """Surface of a ball, whose nodes go on some deg ``beyond`` the socket's rims."""
    from study.joint import fem, fourier

    (angles, around), (first, last) = _angles(ball.opening, resolution), ball.support.surface
    step = np.degrees(angles[1] - angles[0])
    if isinstance(ball.support, Bore):
        angles = np.radians(np.linspace(first, last, 8 * int(np.ceil((last - first) / step / 8)) + 1))
    else:
        low = max(first, ball.opening.first - beyond)
        high = min(last, ball.opening.last + beyond)
        before = int(max(ball.opening.first - low, 0) / step + 1e-6)
        behind = int(max(high - ball.opening.last, 0) / step + 1e-6)
        angles = np.concatenate([
            angles[0] - np.radians(step) * np.arange(before, 0, -1),
            angles,
            angles[-1] + np.radians(step) * np.arange(1, behind + 1),
        ])
    mesh = fem.meridian_of_ball(ball, angles, radial=_RADIAL_ELEMENTS)
    return fourier.Surface(mesh, fem.lame_of(ball, mesh), ball.held, fourier.Grid(angles, around))


@lru_cache(maxsize=6)
def _socket(socket, resolution):
    from study.joint import fem, fourier

    angles, around = _angles(socket.opening, resolution)
    mesh = fem.meridian_of_socket(socket, angles, radial=_RADIAL_ELEMENTS)
    lame, grid = fem.lame_of(socket, mesh), fourier.Grid(angles, around)
    return fourier.Surface(mesh, lame, socket.held, grid)
