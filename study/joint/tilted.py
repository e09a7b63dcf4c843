"""Whole ball pressed into the socket off its axis: contact on a grid of polar angle and azimuth.

The bodies are bodies of revolution about the socket's axis (`study.joint.surface`). The centre of
the ball is displaced by e = (1 + depth_star)/R2* d, where d is a direction off that axis. Along the
outward normal n of the socket, the ball ends at the distance::

    r(n) = n . e + sqrt(R1^2 - e . e + (n . e)^2),    so that the gap is (1 - r(n)) R2*

The pressure p is a sum of hat functions h_i of the socket's nodes, symmetric about the plane of d
and the axis. As along the axis, pressure and gap are complementary in the weak sense::

    p_i >= 0,    w_i = A_ij p_j + g_i >= 0,    p_i w_i = 0,

where g_i is the integral of h_i times the gap, and A the sum of the flexibilities of socket and
ball. The ball's own hats b_k are lumped: with M_ik, the integral of h_i b_k where they face each
other, and the areas a_k of the ball's hats, the pressure p_i h_i acts on the ball as the pressures
M_ik p_i/a_k, and the displacement comes back in the same way. What no b_k can follow of a hat h_i
acts as on a half-space.

Two grids are solved, and their forces, which have errors of order 2, are extrapolated. Lengths are
in socket radii R2, pressures in E* dR/R2 and displacements in dR inside this module.
"""

from __future__ import annotations  # SciPy's packages are loaded when they are used

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.compiled import one_thread
from study.contact import largest_depth
from study.joint import complementarity, surface
from study.joint.description import JointDescription
from study.joint.kinematics import UnresolvedError
from study.joint.solution import Solution

Floats = NDArray[np.float64]
RESOLUTION, FINEST_RESOLUTION = 48, 96
"""Default and maximum elements along a quarter circle; half of them are solved too."""
LARGEST_TILT = 170.0
"""In deg: beyond it no socket has a surface."""
SHALLOWEST = 0.05
"""Minimum depth_star of a curve or a table: elements hardly resolve shallower contacts."""
DEPTHS = 9
"""Depths of a curve."""
_STEPS, _TOLERANCE = 60, 1e-7  # of the search for a displacement; of the force that is asked for
_NEARLY = 1e-3  # the same on the coarser grid
_DEEPEST = 1.0  # depth_star of the largest first guess, and at which ball's nodes face the rim
_NEAR = 0.15  # of the depth: change of the displacement from which the stiffness follows
_FORCE_OF_PRESSURES = 0.15  # share of the pressures' mean difference above errors of the force
_GROWTH = 1.03  # of the pressure at a rim, on elements of half the size, that has no bound
_BEYOND = 8.0  # minimum deg by which the ball's nodes go on beyond the rim
_LEAST_SHARE = 0.3  # of the deepest overlap: shallower ones are at first left out of the contact
_FEWEST = 12  # nodes of a contact of half the resolution
_WHOLE = 1e-9  # share of a hat: the ball may leave out less than this
_FITTED, _WINDOW = 8, 0.5  # nodes, and mean radii of the contact, of a parabola at the maximum


class Solved(NamedTuple):
    """A solution, and the grids and contacts (finer, coarser) of each of its depths."""

    solution: Solution
    grids: list[Contacts]
    contacts: list[list[GridContact]]


@one_thread
def solve(
    joint: JointDescription,
    asked: Floats,
    is_force: bool,
    resolution: int | None,
    tilt: ArrayLike,
    stresses: bool = False,
) -> Solved:
    """Solution at depths, or under forces, off the axis: see `study.joint.Joint.solve`.

    ``asked`` are normalised depths or forces, shape (k,). The tilt is that of the displacement, or
    of the force. Without friction no force can point out of the opening. Surfaces are solved with
    what ``stresses`` need.
    """
    tilts, resolution = _checked(joint, asked, tilt, resolution)
    grids = [Contacts(joint, n, stresses) for n in (resolution, resolution // 2)]
    if is_force:
        for outside in (one for one in tilts if not joint.opening.faces(one)):
            raise checks.RangeError(
                f"tilt of a force must be inside the socket's opening of {joint.opening} deg, got "
                f"{outside:g} deg: without friction no force points out of the opening. Give the "
                "depth of a displacement in this direction, or a socket that reaches further"
            )
        found = [_under_force(grids, *of) for of in zip(asked, tilts, strict=True)]
    else:
        checks.number("depth_star", asked, above=0, below=largest_depth(joint.r2_star))
        found = [(of, [grid.solve(*of) for grid in grids]) for of in zip(asked, tilts, strict=True)]
    contacts = [of for _, of in found]
    return Solved(_solution(joint, resolution, found), grids, contacts)


def depths_of_curve(joint: JointDescription, deepest: float, resolution: int | None) -> Floats:
    """Depths of `study.joint.Joint.curve`, in equal steps of the root of the depth_star.

    They are from a sixteenth of the largest one, or from `SHALLOWEST`, to ``deepest`` or at least
    0.5.
    """
    last = max(checks.number("deepest", deepest, above=0, scalar=True), 10 * SHALLOWEST)
    return np.linspace(np.sqrt(max(SHALLOWEST, last / 16)), np.sqrt(last), DEPTHS) ** 2


def _checked(joint, asked, tilt, resolution):
    """As many tilts as depths or forces, and the resolution; refuses unsuited joints."""
    if joint.ball_support.is_half:
        raise checks.RangeError(
            "ball_support under a tilted load must be core:NUMBER, neck:NUMBER, bore:NUMBER,NUMBER "
            f"or pin:NUMBER,NUMBER, which hold a whole ball, got {joint.ball_support}; half a ball "
            "can be loaded along the axis only"
        )
    tilts = np.atleast_1d(checks.number("tilt", tilt, "deg", least=0, most=LARGEST_TILT))
    if tilts.shape not in ((1,), asked.shape):
        wanted = "tilt must be one number or as many as there are depths or forces"
        raise ValueError(f"{wanted}, got {len(tilts)} and {len(asked)}")
    resolution = RESOLUTION if resolution is None else resolution
    checks.whole("resolution", resolution, least=32, most=FINEST_RESOLUTION)
    if resolution % 16:
        raise ValueError(f"resolution must be a multiple of 16, got {resolution}")
    return np.broadcast_to(tilts, asked.shape), resolution


def _under_force(grids, force, tilt):
    """Depth and tilt of the displacement under a force, and what is solved there.

    The displacement is sought on the coarser grid first, where a contact takes little time.
    """
    first = min((3 * force / (4 * grids[0].joint.r2_star)) ** (2 / 3), _DEEPEST)  # Hertz's, about
    displacement, _, _ = _sought(grids[1:], force, tilt, (1 + first) * direction(tilt), _NEARLY)
    _, at, solved = _sought(grids, force, tilt, displacement, _TOLERANCE)
    return at, solved


def _sought(grids, force, tilt, displacement, tolerance):
    """Displacement under a force, its depth and tilt, and what is solved there, by Newton.

    While no contact has been solved, a depth that is not resolved or is refused narrows a bracket.
    """
    joint, wanted, reached = grids[0].joint, force * direction(tilt), None
    low, high, refused = 0.0, float(largest_depth(joint.r2_star)), None
    for _ in range(_STEPS):
        towards = max(np.degrees(np.arctan2(*displacement)), 0.0)  # not -1e-15
        depth = np.hypot(*displacement) - 1
        try:
            checks.number("depth_star", depth, below=largest_depth(joint.r2_star))
            solved = [grid.solve(depth, towards) for grid in grids]
        except checks.RangeError as error:
            if reached is not None:
                refused = error if depth < np.hypot(*reached) - 1 else None
                displacement = (displacement + reached) / 2  # half the step
                continue
            is_shallow = isinstance(error, UnresolvedError)
            low, high = (depth, high) if is_shallow else (low, depth)
            if high < 1.01 * low:
                raise
            depth = min(2 * depth, (depth + high) / 2) if is_shallow else (low + depth) / 2
            displacement = (1 + depth) * direction(tilt)
            continue
        axes, reached, refused = axes_of(towards), displacement, None
        missing = axes @ wanted - _extrapolated(*(s.force for s in solved))
        if np.hypot(*missing) < tolerance * force:
            return displacement, (depth, towards), solved
        step = np.linalg.solve(solved[0].stiffness, missing)
        step[0] = np.clip(step[0], -0.6 * depth, 2 * depth)
        displacement = displacement + axes.T @ step
    if isinstance(refused, UnresolvedError):
        raise refused
    raise checks.RangeError(
        "force must be one that the contact transmits inside the rim, got "
        f"{force * joint.force_unit:g} N at a tilt of {tilt:g} deg"
    )


def _extrapolated(fine, coarse=None):
    """A result of two grids, whose errors fall with order 2; that of one grid as it is."""
    return fine if coarse is None else fine + (fine - coarse) / 3


def _solution(joint, resolution, found):
    """What was solved on the finer and on the coarser grid at each depth and tilt, as arrays."""
    solved = [of for _, of in found]
    fine = [f for f, _ in solved]
    force = np.array([_extrapolated(f.force, c.force) for f, c in solved])
    cut = np.array([f.reaches_rim for f in fine])
    low, high = np.array([f.edges for f in fine]).T
    error = np.array([_force_error(*s, f) for s, f in zip(solved, force, strict=True)])
    peaks = [_peak(*s, of) for s, of in zip(solved, error, strict=True)]
    peak, peak_error, peak_angle, at_rim = (np.array(of) for of in zip(*peaks, strict=True))
    depths, tilts = np.array([at for at, _ in found]).T
    return Solution(
        joint=joint,
        solver="modes",
        resolution=resolution,
        depth_star=depths,
        tilt=tilts,
        force_star=force[:, 0],
        transverse_star=force[:, 1],
        stiffness_star=np.array([f.stiffness[0, 0] for f in fine]),
        transverse_stiffness_star=np.array([f.stiffness[1, 1] for f in fine]),
        contact_half_angle_deg=(high - low) / 2,
        contact_area_star=np.array([f.area for f in fine]),
        peak_pressure_star=peak,
        peak_error=peak_error,
        peak_angle_deg=peak_angle,
        contact_from_deg=low,
        contact_to_deg=high,
        friction_radius_star=np.array([f.friction_radius for f in fine]),
        error_estimate=error,
        reaches_rim=cut,
        peak_at_rim=at_rim,
        angle_deg=fine[0].profile[0],
        pressure_star=np.array([f.profile[1] for f in fine]),
    )


def _force_error(fine, coarse, force):
    """Estimated relative error of a force that is extrapolated.

    It is the extrapolated correction, or a fraction of the mean difference of the pressures on the
    two grids if this is larger: two forces may agree by chance, their pressures do not.
    """
    correction = np.hypot(*(force - fine.force)) / np.hypot(*force)
    (angles, pressure), (at, of_coarse) = fine.profile, coarse.profile
    of_fine = np.interp(at, angles, pressure)
    apart = np.abs(of_fine - of_coarse).sum() / of_fine.sum()
    return max(correction, _FORCE_OF_PRESSURES * apart)


def _peak(fine, coarse, error_of_force):
    """Peak pressure, its estimated error, its angle, and whether it has no bound at a rim.

    In the latter case, the pressure at the middle of the contact is given. An extrapolated peak may
    be off by 4/3 of the difference of two grids, and pressures that ripple put the fitted maximum
    off by less than what the largest of them exceeds it. The error is at least that of the force,
    because pressures on two grids may agree by chance.
    """
    peak, of_coarse, angle = fine.peak, coarse.peak, fine.peak_angle
    is_at_rim = fine.at_rim >= fine.peak
    if is_at_rim:
        peak, of_coarse, angle = fine.at_rim, coarse.at_rim, fine.rim_angle
    grows = is_at_rim and peak > _GROWTH * of_coarse
    if grows:
        peak, of_coarse, angle = fine.middle, coarse.middle, fine.middle_angle
    error = 4 / 3 * abs(peak - of_coarse)
    if not fine.reaches_rim:
        peak = _extrapolated(peak, of_coarse)
    if not is_at_rim:
        error = max(error, fine.highest - peak)
    return peak, max(error / peak, error_of_force), angle, grows


@dataclass(frozen=True)
class GridContact:
    """Contact on one grid: force and stiffness along and across, the rest as in `Solution`.

    ``middle`` is the pressure at the middle of the contact, ``at_rim`` the largest of a node at a
    rim, or 0 if no rim cuts the contact, and ``highest`` that of the other nodes. ``pressure`` is
    that on the socket, and ``of_ball`` that on the ball, at the nodes of their grids. ``profile``
    is the pressure at signed polar angles in deg in the plane of symmetry.
    """

    force: Floats
    stiffness: Floats
    area: float
    peak: float
    peak_angle: float
    middle: float
    middle_angle: float
    at_rim: float
    rim_angle: float
    highest: float
    edges: tuple[float, float]
    reaches_rim: bool
    friction_radius: float
    profile: tuple[Floats, Floats]
    pressure: Floats
    of_ball: Floats


class _Gap(NamedTuple):
    """The undeformed gap of a displaced ball, at Gauss points and weighted by the socket's hats."""

    axes: Floats  # along the displacement and across it, (2, 3)
    weighted: scipy.sparse.csr_array  # hats times areas, (nodes, points)
    size: Floats  # areas of the hats that the ball faces
    mass: scipy.sparse.csr_array  # products of two hats of the socket
    gap: Floats  # g_i
    normal: Floats  # along which pressure acts, (points, 3)
    closing: Floats  # what the gap loses per displacement along and across, (points, 2)
    turning: Floats  # change of the normal per displacement along and across, (2, points, 3)
    acted_on: Floats  # area on which the force acts, over the socket's
    moved: scipy.sparse.csr_array  # M_ik


class _Touching(NamedTuple):
    """The contact problem of those nodes of the socket that may touch, and its solution."""

    nodes: NDArray[np.intp]
    matrix: Floats  # A_ij
    pressure: Floats
    active: NDArray[np.bool_]


class Contacts:
    """Contacts of one joint on one grid of the socket."""

    def __init__(self, joint: JointDescription, resolution: int, stresses: bool = False):
        self.joint = joint
        beyond = max(_BEYOND, np.degrees((1 + _DEEPEST) / joint.r2_star))
        self.ball = surface.of_ball(joint.ball_body, beyond, resolution)
        self.socket = surface.of_socket(joint.socket_body, resolution)
        for of in (self.ball, self.socket):
            of.solve(stresses)
        grid = self.socket.grid
        theta, phi, self.area = grid.points
        self.hats = grid.values(theta, phi)
        self.normal = surface.unit_vectors(theta, phi)
        self.node_normal = surface.unit_vectors(grid.theta, grid.phi)
        side = np.where(grid.phi < np.pi / 2, 1, -1)
        self.signed_angle = side * np.degrees(grid.theta)

    def solve(self, depth: float, tilt: float) -> GridContact:
        """Contact at a depth_star, of a displacement at a tilt in deg."""
        gap = self._gap(depth, tilt)
        overlap = np.divide(-gap.gap, gap.size, out=np.zeros_like(gap.gap), where=gap.size > 0)
        if overlap.max() <= 0 and not (self.joint.opening.faces(tilt) and gap.size.any()):
            raise checks.RangeError(
                f"tilt must leave a contact inside the opening of {self.joint.opening} deg and on "
                f"the ball's surface, got {tilt:g} deg at a depth_star of {depth:g}"
            )
        touching = self._touching(gap, overlap)
        if touching is None or np.count_nonzero(touching.active) < _FEWEST:
            raise UnresolvedError(
                "depth_star must be so large that the elements resolve the contact, got "
                f"{depth:.3g}: take a larger depth or a finer resolution"
            )
        nodes = touching.nodes[touching.active]
        if (gap.size[nodes] < (1 - _WHOLE) * self.socket.areas[nodes]).any():
            raise self._outside(depth, tilt)
        return self._contact(gap, touching, _NEAR * depth, tilt)

    def _outside(self, depth, tilt):
        """Error of a contact that reaches what is not the ball's spherical surface."""
        first, last = self.joint.ball_support.outline.surface
        return checks.RangeError(
            "tilt and depth_star must keep the contact on the surface of the ball, which ends at "
            f"polar angles of {first:g} and {last:g} deg, got a tilt of {tilt:.4g} deg and a "
            f"depth_star of {depth:.3g}; take a smaller depth, or a tilt closer to its middle"
        )

    def _gap(self, depth, tilt):
        """Where the surfaces face each other, and how far they are apart: see the module."""
        joint, outward = self.joint, self.normal
        axes = np.insert(axes_of(tilt), 1, 0.0, axis=1)
        centre = (1 + depth) / joint.r2_star * axes[0]
        along, r1 = outward @ centre, joint.radius_ratio
        distance = along + np.sqrt(np.maximum(r1**2 - centre @ centre + along**2, 1e-12))
        gap, facing = (1 - distance) * joint.r2_star, (distance[:, None] * outward - centre) / r1
        shrunk = (facing * outward).sum(axis=1)
        closing = facing / shrunk[:, None] @ axes.T
        normal, acted_on, turning = outward, np.ones(len(outward)), np.zeros((2, *outward.shape))
        if joint.acts_on_ball:
            normal, acted_on = facing, (1 - gap / joint.r2_star) ** 2 / shrunk
            turning = (closing.T[:, :, None] * outward - axes[:, None]) / r1 / joint.r2_star
        place = np.arccos(np.clip(normal[:, 2], -1, 1)), np.arctan2(normal[:, 1], normal[:, 0])
        met = self.ball.grid.faces(place[0])
        if (gap[~met] < 0).any():
            raise self._outside(depth, tilt)
        weighted = scipy.sparse.csr_array((self.hats * (self.area * met)[:, None]).T)
        return _Gap(
            axes=axes,
            weighted=weighted,
            size=weighted.sum(axis=1),
            mass=weighted @ self.hats,
            gap=weighted @ gap,
            normal=normal,
            closing=closing,
            turning=turning,
            acted_on=acted_on,
            moved=weighted @ self.ball.grid.values(*place),
        )

    def _touching(self, gap, overlap):
        """The contact problem of the nodes that may touch, solved; None if no node does.

        The problem begins with the deepest overlaps, and grows until no node next to the contact
        is left out.
        """
        joint, (share_of_ball, share_of_socket) = self.joint, self.joint.modulus_shares
        scale = share_of_ball * joint.radius_ratio ** (-1 if joint.acts_on_ball else 1)
        wanted, guess = overlap > _LEAST_SHARE * overlap.max(), overlap > 0.5 * overlap.max()
        while wanted.any():
            nodes = np.flatnonzero(wanted)
            by_ball = self._of_ball(nodes, gap.moved[nodes], gap.mass[nodes][:, nodes])
            matrix = share_of_socket * self.socket.matrix(nodes) + scale * by_ball
            pressure, active = complementarity.solve(matrix, gap.gap[nodes], guess[nodes])
            touching = np.zeros(len(wanted))
            touching[nodes[active]] = 1
            beside = gap.mass @ touching > 0
            if not (beside & ~wanted).any():
                return _Touching(nodes, matrix, pressure, active)
            wanted, guess = wanted | (gap.mass @ (gap.mass @ beside) > 0), touching > 0
        return None

    def _of_ball(self, nodes, moved, mass):
        """Flexibility of a unit ball under hats of the socket: see the module."""
        columns = np.unique(moved.indices)
        moved = moved[:, columns]
        spread = moved @ scipy.sparse.csr_array(np.diag(1 / self.ball.areas[columns]))
        unseen = (mass - spread @ moved.T).toarray()
        # root of a half-space's displacement under unit pressure on the area of a whole hat, on
        # both sides of the plane of symmetry
        whole = self.socket.areas[nodes] / self.socket.grid.ends[nodes]
        local = np.sqrt(2 / np.pi * (1 - self.joint.ball.poisson**2) * np.sqrt(whole))
        seen = spread @ (spread @ self.ball.matrix(columns)).T
        return seen + local[:, None] * unseen * local

    def _contact(self, gap, touching, step, tilt):
        """What follows from the pressure: forces, stiffness, edges, peak and friction."""
        joint, grid, axes = self.joint, self.socket.grid, gap.axes
        is_symmetric = joint.is_plane_of_symmetry(tilt)
        force = axes @ gap.normal.T @ (touching.pressure @ gap.weighted[touching.nodes])
        stiffness = _stiffness(gap, touching, step)
        if is_symmetric:
            force[1] = stiffness[0, 1] = stiffness[1, 0] = 0.0
        nodes, pressure = (of[touching.active] for of in (touching.nodes, touching.pressure))
        weighted = gap.weighted[nodes]
        rims = [grid.ring[-1]] if grid.pole == 0 else [0, grid.ring[-1]]
        at_rim = np.isin(grid.ring[nodes], rims)
        scale = joint.radius_ratio**2 if joint.acts_on_ball else 1.0
        every = np.zeros(grid.size)
        every[nodes] = pressure
        on_area = pressure * gap.size[nodes] / (weighted @ gap.acted_on)
        in_plane, plane = grid.ends[nodes] < 1, np.flatnonzero(grid.ends < 1)
        edges = _edges(self.signed_angle[nodes[in_plane]], pressure[in_plane], grid)
        middle_angle = tilt if is_symmetric else sum(edges) / 2
        peak, peak_angle, middle = self._peak(nodes, on_area, gap.mass, np.radians(middle_angle))
        if is_symmetric and abs(peak_angle - tilt) < np.degrees(grid.step):
            peak_angle = tilt  # without the rounding of the parabola's coefficients
        rim = np.where(at_rim, on_area, 0.0)
        plane = plane[np.argsort(self.signed_angle[plane], kind="stable")]
        return GridContact(
            force=2 * joint.r2_star * force,
            stiffness=2 * joint.r2_star * stiffness,
            area=2 * float(gap.size[nodes].sum()),
            peak=peak,
            peak_angle=peak_angle,
            middle=middle,
            middle_angle=middle_angle,
            at_rim=rim.max(),
            rim_angle=self.signed_angle[nodes[rim.argmax()]],
            highest=(on_area - rim).max(),
            edges=edges,
            reaches_rim=bool(at_rim.any()),
            friction_radius=self._friction(gap.normal, axes.T @ force, weighted, pressure),
            profile=(self.signed_angle[plane], every[plane]),
            pressure=every,
            of_ball=gap.moved[nodes].T @ pressure / self.ball.areas / scale,
        )

    def _peak(self, nodes, pressure, mass, middle):
        """Maximum pressure, its signed polar angle in deg, and the pressure at a middle angle.

        Pressures at single nodes ripple, and the ring beside the pole does so as a whole. The
        maximum is therefore sought in means over neighbours, taken twice. A parabola in both angles
        is fitted around it by the nodes' areas. Where this parabola has no maximum, as at an edge,
        the maximum is that of the means. A parabola around the middle gives the pressure there.
        """
        grid, area = self.socket.grid, self.socket.areas[nodes]
        near = mass[nodes][:, nodes]
        near = near / near.sum(axis=1)[:, None]
        mean = near @ (near @ pressure)
        x, y, z = self.node_normal[nodes].T
        angle, top = np.arctan2(x, z), mean.argmax()
        radius = max(_WINDOW * np.sqrt(area.sum() / (np.pi / 2)), 2 * grid.step)

        def parabola(along, across):
            window = np.hypot(angle - along, y - across) < radius
            terms = np.column_stack(
                [np.ones_like(angle), angle - along, (angle - along) ** 2, y**2]
            )
            weight = np.sqrt(area[window])
            fit = np.linalg.lstsq(weight[:, None] * terms[window], weight * pressure[window])
            return *fit[0][:3], len(weight)

        at_middle, *_ = parabola(middle, 0.0)
        level, slope, bend, count = parabola(angle[top], y[top])
        shift = -slope / (2 * bend) if bend < 0 else np.inf
        if abs(shift) < radius / 2 and count >= _FITTED:
            return level + slope * shift / 2, np.degrees(angle[top] + shift), at_middle
        return mean[top], self.signed_angle[nodes[top]], at_middle

    def _friction(self, normal, force, weighted, pressure):
        """Friction radius in R2 (`study.joint.Solution.friction_radius_star`)."""
        size = np.linalg.norm(force)
        radius = self.joint.radius_ratio if self.joint.acts_on_ball else 1.0
        sliding = np.sqrt(np.maximum(1 - (normal @ force / size) ** 2, 0))
        return radius * (weighted @ sliding) @ pressure / size


def _stiffness(gap, touching, step):
    """Derivatives of the forces along and across by a displacement along and across, (2, 2).

    The change of the pressure is a difference over displacements by ``step`` to both sides, in
    which the edge of the contact moves by about an element: with the edge held, a derivative jumps
    by some percent from one node at the edge to the next. Which nodes touch after the displacement
    follows from the rates of pressure and gap. To it comes the change of the normals. What faces
    each other is taken as constant, which neglects terms of order 1/R2*.
    """
    _, matrix, pressure, active = touching
    weighted, before, columns = gap.weighted[touching.nodes], gap.gap[touching.nodes], []
    closing, left = weighted @ gap.closing, before + matrix @ pressure
    rates = _pressures(matrix, -closing, active)
    for k, rate in enumerate(rates.T):
        found = []
        for s in (step, -step):
            opening = left + s * (matrix @ rate - closing[:, k])
            touches = np.where(active, pressure + s * rate > 0, opening < 0)
            found.append(_pressures(matrix, before - s * closing[:, k], touches))
        change = gap.normal.T @ ((found[0] - found[1]) / (2 * step) @ weighted)
        columns.append(gap.axes @ (change + gap.turning[k].T @ (pressure @ weighted)))
    return np.array(columns).T


def _pressures(matrix, gap, touches):
    """Pressures that close the gaps of the nodes that touch; shape of ``gap``."""
    pressure = np.zeros_like(gap)
    factor = scipy.linalg.cho_factor(matrix[np.ix_(touches, touches)])
    pressure[touches] = scipy.linalg.cho_solve(factor, -gap[touches])
    return pressure


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


def direction(tilt: float) -> Floats:
    """Unit vector (x, z) at an angle in deg from the axis z."""
    return np.array([np.sin(np.radians(tilt)), np.cos(np.radians(tilt))])


def axes_of(tilt: float) -> Floats:
    """Unit vectors along a direction, and across it towards larger tilt, as rows (x, z)."""
    x, z = direction(tilt)
    return np.array([[x, z], [z, -x]])
