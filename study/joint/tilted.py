"""Ball pressed into the socket off its axis: contact on a grid of polar angle and azimuth.

The bodies are bodies of revolution about the socket's axis (`study.joint.modes`), and the ball is
displaced in a direction off that axis. Pressure is piecewise linear in both angles and symmetric
about the plane phi = 0 of the displacement. As along the axis, pressure and gap are complementary
in the weak sense. Two grids are solved.

Lengths are in socket radii R2, pressures in E* dR/R2 and displacements in dR inside this module.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import largest_depth
from study.joint import complementarity, stress
from study.joint.kinematics import UnresolvedError
from study.joint.solution import Solution
from study.joint.supports import Bore
from study.threads import one_thread

if TYPE_CHECKING:
    from study.joint.joint import Joint

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
# fractions of the pressures' mean difference that errors of 300 random contacts remain below
_FORCE_OF_PRESSURES, _PEAK_OF_PRESSURES = 0.15, 0.3
_GROWTH_AT_PUNCH = np.sqrt(2) - 1
_RADIAL_ELEMENTS = 0.15  # as in `study.joint.meridian`, for elements of equal angles
_MULTIPLE = 8  # of which the resolution of any grid is one
_TOGETHER = 16  # nodes around of which coarser rings leave all but one out
_BEYOND = 8.0  # minimum deg by which the ball's nodes go on beyond the rim
_LEAST_SHARE = 0.3  # of the deepest overlap: shallower ones are at first left out of the contact
_FEWEST = 12  # nodes of a contact of half the resolution
_WHOLE = 1e-9  # of an area or an angle: a smaller part that the ball does not face counts as none
_IN_PLANE = np.array([0, np.pi])  # angles phi of the plane of symmetry
_SEEN = 3  # nodes next to cut hats on which these are projected: a projection falls by 0.27 on each
_FITTED, _WINDOW = 8, 0.5  # nodes, and mean radii of the contact, of a parabola at the maximum


@one_thread
def solve(
    joint: Joint,
    asked: Floats,
    is_force: bool,
    stresses: bool,
    resolution: int | None,
    tilt: ArrayLike,
) -> Solution:
    """Solution at depths, or under forces, off the axis: see `study.joint.Joint.solve`.

    ``asked`` are normalised depths or forces, shape (k,). The tilt is that of the displacement, or
    of the force. Without friction no force can point out of the opening.
    """
    tilts, resolution = _checked(joint, asked, tilt, resolution)
    grids = [Contacts(joint, n, stresses) for n in (resolution, resolution // 2)]
    if not is_force:
        checks.number("depth_star", asked, above=0, below=largest_depth(joint.r2_star))
        found = [(of, [grid.solve(*of) for grid in grids]) for of in zip(asked, tilts, strict=True)]
        return _solution(grids, found, stresses)
    for outside in (one for one in tilts if not joint.opening.faces(one)):
        raise checks.RangeError(
            f"tilt of a force must be inside the socket's opening of {joint.opening} deg, got "
            f"{outside:g} deg: without friction no force points out of the opening. Give the depth "
            "of a displacement in this direction, or a socket that reaches further"
        )
    found = [_under_force(grids, *of) for of in zip(asked, tilts, strict=True)]
    return _solution(grids, found, stresses)


def curve(
    joint: Joint, tilt: float, deepest: float, resolution: int | None, stresses: bool
) -> Solution:
    """Solution at `DEPTHS` depths in one direction: see `study.joint.Joint.curve`.

    They are in equal steps of the root of the depth_star, from a sixteenth of the largest one, or
    from `SHALLOWEST`, to ``deepest`` or at least 0.5.
    """
    last = max(checks.number("deepest", deepest, above=0, scalar=True), 10 * SHALLOWEST)
    roots = np.linspace(np.sqrt(max(SHALLOWEST, last / 16)), np.sqrt(last), DEPTHS)
    return solve(joint, roots**2, False, stresses, resolution, tilt)


def _checked(joint, asked, tilt, resolution):
    """As many tilts as depths or forces, and the resolution; refuses unsuited joints."""
    if joint.ball_support.is_free_across:
        wanted = "clamped, core:NUMBER, neck:NUMBER or bore:NUMBER,NUMBER"
        why = f"the ball is free across the axis, got {joint.ball_support}"
        raise checks.RangeError(f"ball_support under a tilted load must be {wanted}: {why}")
    checks.choice("rim under a tilted load", joint.rim, ("free",))
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
        "force must be one that the ball bears inside the rim, got "
        f"{force * joint.force_unit:g} N at a tilt of {tilt:g} deg"
    )


def _extrapolated(fine, coarse=None):
    """A result of two grids, whose errors fall with order 2; that of one grid as it is."""
    return fine if coarse is None else fine + (fine - coarse) / 3


def _solution(grids, found, stresses):
    """What was solved on the finer and on the coarser grid at each depth and tilt, as arrays."""
    joint, solved = grids[0].joint, [of for _, of in found]
    fine = [f for f, _ in solved]
    force = np.array([_extrapolated(f.force, c.force) for f, c in solved])
    stiffness = np.array([_extrapolated(f.stiffness, c.stiffness) for f, c in solved])
    cut = np.array([f.reaches_rim for f in fine])
    peak = np.array([f.peak if f.reaches_rim else _extrapolated(f.peak, c.peak) for f, c in solved])
    low, high = np.array([f.edges for f in fine]).T
    depths, tilts = np.array([at for at, _ in found]).T
    solution = Solution(
        joint=joint,
        solver="modes",
        resolution=grids[0].resolution,
        depth_star=depths,
        tilt=tilts,
        force_star=force[:, 0],
        transverse_star=force[:, 1],
        stiffness_star=stiffness[:, 0, 0],
        transverse_stiffness_star=stiffness[:, 1, 1],
        contact_half_angle_deg=(high - low) / 2,
        contact_area_star=np.array([f.area for f in fine]),
        peak_pressure_star=peak,
        peak_error=np.array([_peak_error(*s, at) for s, at in zip(solved, peak, strict=True)]),
        peak_angle_deg=np.array([f.peak_angle for f in fine]),
        contact_from_deg=low,
        contact_to_deg=high,
        friction_radius_star=np.array([f.friction_radius for f in fine]),
        error_estimate=np.array([_force_error(*s, f) for s, f in zip(solved, force, strict=True)]),
        reaches_rim=cut,
        angle_deg=fine[0].profile[0],
        pressure_star=np.array([f.profile[1] for f in fine]),
    )
    if not stresses:
        return solution
    return replace(solution, stress=stress.largest_off_axis(solution, grids, solved))


def _force_error(fine, coarse, force):
    """Estimated relative error of a force that is extrapolated.

    It is the extrapolated correction, or a fraction of the difference of the pressures on the two
    grids if this is larger: two forces may agree by chance, their pressures do not.
    """
    correction = np.hypot(*(force - fine.force)) / np.hypot(*force)
    return max(correction, _FORCE_OF_PRESSURES * _pressures_apart(fine, coarse))


def _peak_error(fine, coarse, peak):
    """Estimated relative error of the peak pressure.

    Two grids that differ by chance put an extrapolated peak off by 4/3 of their difference, and
    pressures that ripple around the fitted parabola put it off by about their ripple. A pressure at
    an edge has no bound: from one grid to the next it grows by 41 % at the edge of a rigid punch,
    and here by at most twice what it grew between the two grids.
    """
    growth = 2 * abs(fine.edge_pressure - coarse.edge_pressure)
    growth = max(growth, _GROWTH_AT_PUNCH * fine.edge_pressure)
    off = (
        4 / 3 * abs(fine.peak - coarse.peak),
        2 * max(fine.ripple, coarse.ripple),
        fine.edge_pressure + growth - peak,
    )
    return max(max(off) / peak, _PEAK_OF_PRESSURES * _pressures_apart(fine, coarse))


def _pressures_apart(fine, coarse):
    """Mean difference of the pressures on two grids in the plane of symmetry, over their mean."""
    (angles, pressure), (at, of_coarse) = fine.profile, coarse.profile
    of_fine = np.interp(at, angles, pressure)
    return np.abs(of_fine - of_coarse).sum() / of_fine.sum()


@dataclass(frozen=True)
class GridContact:
    """Contact on one grid: force and stiffness along and across, the rest as in `Solution`.

    ``edge_pressure`` is the largest pressure at an edge that cuts the contact, or 0, and ``ripple``
    the root mean square by which pressures differ from the parabola at their maximum. ``pressure``
    is that on the socket, and ``of_ball`` that on the ball, at the nodes of their grids.
    ``profile`` is the pressure at signed polar angles in the plane of symmetry, in deg.
    """

    force: Floats
    stiffness: Floats
    area: float
    peak: float
    peak_angle: float
    edge_pressure: float
    ripple: float
    edges: tuple[float, float]
    reaches_rim: bool
    friction_radius: float
    profile: tuple[Floats, Floats]
    pressure: Floats
    of_ball: Floats


class _Gap(NamedTuple):
    """The undeformed gap of a displaced ball, at Gauss points and weighted by the socket's hats."""

    axes: Floats  # along the displacement and across it, (2, 3)
    centre: Floats  # of the ball, off that of the socket
    weighted: scipy.sparse.csr_array  # hats times areas, (nodes, points)
    size: Floats  # areas of the hats that the ball faces
    mass: scipy.sparse.csr_array
    gap: Floats  # at the nodes
    normal: Floats  # along which pressure acts, (points, 3)
    closing: Floats  # derivative of the gap by a displacement, (points, 3)
    acted_on: Floats  # area on which the force acts, over the socket's
    moved: (
        scipy.sparse.csr_array
    )  # products of the socket's hats with the ball's hats that they face


class Contacts:
    """Contacts of one joint on one grid of the socket."""

    def __init__(self, joint: Joint, resolution: int, stresses: bool = False):
        self.joint, self.resolution, support = joint, resolution, joint.ball_support
        self.ends_at_edge = support.is_half or isinstance(support, Bore)
        self.is_held_at_edges = "equator" in support.held and "rim" in joint.socket_body.held
        beyond = max(_BEYOND, np.degrees((1 + _DEEPEST) / joint.r2_star))
        self.ball = ball_surface(joint.ball_body, beyond, resolution)
        self.socket = socket_surface(joint.socket_body, resolution)
        for surface in (self.ball, self.socket):
            surface.solve(stresses)
        grid = self.socket.grid
        theta, self.phi, self.area = grid.points
        self.hats = grid.values(theta, self.phi)
        self.mass = self.hats.T @ (self.hats * self.area[:, None])
        self.normal = unit_vectors(theta, self.phi)
        self.node_normal = unit_vectors(grid.theta, grid.phi)
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
        cut_hats = self._cut_hats(gap.mass, overlap)
        nodes, pressure, factor = self._touching(gap, overlap, cut_hats)
        if len(nodes) < _FEWEST:
            raise UnresolvedError(
                "depth_star must be so large that the elements resolve the contact, got "
                f"{depth:.3g}: take a larger depth or a finer resolution"
            )
        return self._contact(gap, cut_hats, nodes, pressure, factor)

    def _gap(self, depth, tilt):
        """Where the surfaces face each other, and how far they are apart."""
        joint = self.joint
        axes = np.insert(axes_of(tilt), 1, 0.0, axis=1)
        centre = (1 + depth) / joint.r2_star * axes[0]
        hats, outward, area = self._faced(centre)
        # along the socket's normals the ball ends at a distance from the socket's centre
        along, r1 = outward @ centre, joint.radius_ratio
        distance = along + np.sqrt(np.maximum(r1**2 - centre @ centre + along**2, 1e-12))
        gap, facing = (1 - distance) * joint.r2_star, (distance[:, None] * outward - centre) / r1
        shrunk = (facing * outward).sum(axis=1)
        normal, acted_on = outward, np.ones(len(area))
        if joint.acts_on_ball:
            normal, acted_on = facing, (1 - gap / joint.r2_star) ** 2 / shrunk
        place = np.arccos(np.clip(normal[:, 2], -1, 1)), np.arctan2(normal[:, 1], normal[:, 0])
        met = self.ball.grid.faces(place[0])
        if not self.ends_at_edge and (gap[~met] < 0).any():
            raise checks.RangeError(
                f"depth_star must keep the ball's neck or back out of the opening, got {depth:g}"
            )
        weighted = scipy.sparse.csr_array((hats * (area * met)[:, None]).T)
        return _Gap(
            axes,
            centre,
            weighted,
            weighted.sum(axis=1),
            weighted @ hats,
            weighted @ gap,
            normal,
            facing / shrunk[:, None],
            acted_on,
            weighted @ self.ball.grid.values(*place),
        )

    def _touching(self, gap, overlap, cut_hats):
        """Nodes in contact, their pressures, and the factor of their flexibility.

        The problem begins with the deepest overlaps, and grows until no node next to the contact
        is left out.
        """
        joint, (share_of_ball, share_of_socket) = self.joint, self.joint.modulus_shares
        scale = share_of_ball * joint.radius_ratio ** (-1 if joint.acts_on_ball else 1)
        wanted, guess = overlap > _LEAST_SHARE * overlap.max(), overlap > 0.5 * overlap.max()
        while wanted.any():
            nodes = np.flatnonzero(wanted)
            by_ball = self._of_ball(nodes, gap.moved[nodes], gap.mass[nodes][:, nodes])
            matrix = share_of_socket * self._of_socket(nodes, cut_hats) + scale * by_ball
            pressure, active = complementarity.solve(matrix, gap.gap[nodes], guess[nodes])
            touching = np.zeros(len(wanted))
            touching[nodes[active]] = 1
            beside = gap.mass @ touching > 0
            if not (beside & ~wanted).any():
                factor = (
                    scipy.linalg.cho_factor(matrix[np.ix_(active, active)])
                    if active.any()
                    else None
                )
                return nodes[active], pressure[active], factor
            wanted, guess = wanted | (gap.mass @ (gap.mass @ beside) > 0), touching > 0
        return np.zeros(0, int), np.zeros(0), None

    def _contact(self, gap, cut_hats, nodes, pressure, factor):
        """What follows from the pressure: forces, stiffness, edges, peak and friction."""
        joint, grid, axes, weighted = self.joint, self.socket.grid, gap.axes, gap.weighted[nodes]
        loads = weighted @ (gap.normal @ axes.T)
        force, by_pressure = (
            loads.T @ pressure,
            scipy.linalg.cho_solve(factor, weighted @ (gap.closing @ axes.T)),
        )
        rims = [grid.ring[-1]] if grid.pole == 0 else [0, grid.ring[-1]]
        low, high = self._ends(gap.centre, grid.phi[nodes])
        beyond = (grid.theta[nodes] < low - _WHOLE) | (grid.theta[nodes] > high + _WHOLE)
        at_rim = np.isin(grid.ring[nodes], rims)
        reaches_rim = bool(at_rim.any() or beyond.any())
        if reaches_rim and self.is_held_at_edges:
            self._check_held_edges(high)
        scale = joint.radius_ratio**2 if joint.acts_on_ball else 1.0
        of_ball = gap.moved[nodes].T @ pressure / self.ball.areas / scale
        every = _on_whole_hats(nodes, pressure, grid.size, cut_hats)
        on_area = every[nodes] * gap.size[nodes] / (weighted @ gap.acted_on)
        at_edge = at_rim | np.isin(nodes, cut_hats[0])
        peak, peak_angle, edge_pressure, ripple = self._peak(nodes, on_area, gap.mass, at_edge)
        in_plane = grid.ends[nodes] < 1
        signed, ends = self.signed_angle[nodes[in_plane]], self._ends(gap.centre, _IN_PLANE)
        plane = np.flatnonzero(grid.ends < 1)
        plane = plane[np.argsort(self.signed_angle[plane], kind="stable")]
        return GridContact(
            force=2 * joint.r2_star * force,
            stiffness=2 * joint.r2_star * loads.T @ by_pressure,
            area=2 * float(gap.size[nodes].sum()),
            peak=peak,
            peak_angle=peak_angle,
            edge_pressure=edge_pressure,
            ripple=ripple,
            edges=_edges(signed, pressure[in_plane], grid, ends),
            reaches_rim=reaches_rim,
            friction_radius=self._friction(gap.normal, axes.T @ force, weighted, pressure),
            profile=(self.signed_angle[plane], np.maximum(every[plane], 0)),
            pressure=every,
            of_ball=of_ball,
        )

    def _peak(self, nodes, pressure, mass, at_edge):
        """Maximum pressure, its signed polar angle in deg, the pressure at edges, and the ripple.

        Pressures at single nodes ripple, and the ring beside the pole does so as a whole. The
        maximum is therefore sought in means over neighbours, taken twice. A parabola in both angles
        is fitted around it by the nodes' areas; the ripple is the root mean square of what is left.
        Where this parabola has no maximum, as at an edge, the maximum is that of the means.
        """
        grid, area = self.socket.grid, self.socket.areas[nodes]
        near = mass[nodes][:, nodes]
        near = near / near.sum(axis=1)[:, None]
        mean = near @ (near @ pressure)
        x, y, z = self.node_normal[nodes].T
        top = mean.argmax()
        along = np.arctan2(x, z) - np.arctan2(x[top], z[top])
        radius = max(_WINDOW * np.sqrt(area.sum() / (np.pi / 2)), 2 * grid.step)
        window = np.hypot(along, y - y[top]) < radius
        terms = np.column_stack([np.ones_like(along), along, along**2, y**2])[window]
        weight = np.sqrt(area[window])
        fitted, *_ = np.linalg.lstsq(weight[:, None] * terms, weight * pressure[window])
        left = weight * (pressure[window] - terms @ fitted)
        ripple = np.sqrt(left @ left / area[window].sum())
        level, slope, bend, _ = fitted
        shift = -slope / (2 * bend) if bend < 0 else np.inf
        peak, angle = mean[top], self.signed_angle[nodes[top]]
        if abs(shift) < radius / 2 and len(weight) >= _FITTED:
            peak = level + slope * shift / 2
            angle = np.degrees(np.arctan2(x[top], z[top]) + shift)
        return peak, angle, (near @ pressure)[at_edge].max(initial=0), ripple

    def _friction(self, normal, force, weighted, pressure):
        """Friction radius in R2 (`study.joint.Solution.friction_radius_star`)."""
        size = np.linalg.norm(force)
        radius = self.joint.radius_ratio if self.joint.acts_on_ball else 1.0
        sliding = np.sqrt(np.maximum(1 - (normal @ force / size) ** 2, 0))
        return radius * (weighted @ sliding) @ pressure / size

    def _check_held_edges(self, ball_end):
        """Refuse a contact where the held end of half a ball meets the held rim of a socket.

        If the two coincide, pressure grows like the inverse distance from them and its sum has no
        bound; with a gap between them that is narrower than the elements, it is not resolved.
        """
        grid = self.socket.grid
        step, gap = np.degrees([grid.step, np.abs(ball_end - grid.angles[-1]).min()])
        if gap < step:
            raise checks.RangeError(
                "tilt and depth_star must keep the contact of a clamped half ball off a rim that "
                f"is held {gap:.2g} deg from the ball's end, got a contact that reaches it "
                f"with elements of {step:.2g} deg: no force is finite where held edges touch. "
                "Take another socket_support, a smaller tilt or depth, or a finer resolution"
            )

    def _cut_hats(self, mass, overlap):
        """Hats that the ball faces in part: their nodes, and these parts in terms of whole hats.

        With them comes the mass matrix of what whole hats cannot follow. Parts are projected on
        the hats of their nodes and of those beside them, of which ``seen`` is the list.
        """
        missing = self.mass - mass
        cut = missing.sum(axis=1) > _WHOLE * self.socket.areas
        cut = np.flatnonzero(cut & (overlap > 0))
        around = np.zeros(len(overlap))
        around[cut] = 1
        for _ in range(_SEEN):
            around = self.mass @ around
        seen = np.flatnonzero(around > 0)
        missing = missing[seen][:, cut].toarray()
        lost = np.linalg.solve(self.mass[seen][:, seen].toarray(), missing)
        at = np.searchsorted(seen, cut)
        parts = -lost
        parts[at, np.arange(len(cut))] += 1
        return cut, seen, parts, missing[at] - missing.T @ lost

    def _of_socket(self, nodes, cut_hats):
        """Flexibility of the socket under those parts of its nodes' hats that the ball faces."""
        cut, seen, parts, unseen = cut_hats
        wanted = np.isin(cut, nodes)
        if not wanted.any():
            return self.socket.matrix(nodes)
        every = np.append(nodes, np.setdiff1d(seen, nodes))
        place = np.empty(self.socket.grid.size, int)
        place[every] = np.arange(len(every))
        at, among, parts = place[cut[wanted]], place[seen], parts[:, wanted]
        matrix = self.socket.matrix(every)
        matrix[:, at] = matrix[:, among] @ parts
        matrix[at] = parts.T @ matrix[among]
        local = self._half_space(self.joint.innermost, cut[wanted])
        matrix[np.ix_(at, at)] += local[:, None] * unseen[np.ix_(wanted, wanted)] * local
        return matrix[: len(nodes), : len(nodes)]

    def _of_ball(self, nodes, moved, mass):
        """Flexibility of the ball under hats of the socket, of a unit ball."""
        # displacements are wanted where points of the socket face the ball, whose hats are
        # lumped; what they do not see acts as on a half-space
        columns = np.unique(moved.indices)
        moved = moved[:, columns]
        spread = moved @ scipy.sparse.csr_array(np.diag(1 / self.ball.areas[columns]))
        unseen = (mass - spread @ moved.T).toarray()
        local = self._half_space(self.joint.ball, nodes)
        seen = spread @ (spread @ self.ball.matrix(columns)).T
        return seen + local[:, None] * unseen * local

    def _half_space(self, material, nodes):
        """Root of a half-space's displacement under unit pressure on the area of a node's hat.

        The area is that of the whole hat on both sides of the plane of symmetry, so that the rest
        of a hat that the ball's end cuts off does not carry a force.
        """
        whole = self.socket.areas[nodes] / self.socket.grid.ends[nodes]
        return np.sqrt(2 / np.pi * (1 - material.poisson**2) * np.sqrt(whole))

    def _ends(self, centre, phi):
        """Polar angles of the socket that face the ball's first and last edge, at angles phi."""
        first, last = np.radians(self.joint.ball_support.surface)
        low, high = np.full((2, len(phi)), [[-np.inf], [np.inf]])
        if not self.ends_at_edge:
            return low, high
        x, _, z = centre if self.joint.acts_on_ball else np.zeros(3)

        def facing(edge):
            radius, height = self.joint.radius_ratio * np.array([np.sin(edge), np.cos(edge)])
            across = x * np.cos(phi) + np.sqrt(np.maximum(radius**2 - (x * np.sin(phi)) ** 2, 0))
            return np.arctan2(across, z + height)

        return facing(first) if first > 0 else low, facing(last)

    def _faced(self, centre):
        """Hats, normals and areas at Gauss points of that part of the socket which faces the ball.

        Elements are cut where the ball ends. If they were left out point by point, the force would
        jump whenever the ball's end passes a point.
        """
        grid, whole = self.socket.grid, (self.hats, self.normal, self.area)
        if not self.ends_at_edge:
            return whole
        theta, phi, area = grid.points_between(*self._ends(centre, self.phi[: grid.around]))
        kept = np.abs(area - self.area) <= _WHOLE * self.area
        if kept.all():
            return whole
        part = ~kept & (area > 0)
        of_part = theta[part], phi[part]
        hats = scipy.sparse.csr_array(scipy.sparse.vstack([self.hats[kept], grid.values(*of_part)]))
        normal = np.vstack([self.normal[kept], unit_vectors(*of_part)])
        return hats, normal, np.append(self.area[kept], area[part])


def unit_vectors(theta: Floats, phi: Floats) -> Floats:
    """Unit vectors (x, y, z) of polar angles and angles around the axis z, in rad; (n, 3)."""
    sine = np.sin(theta)
    return np.column_stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)])


def direction(tilt: float) -> Floats:
    """Unit vector (x, z) at an angle in deg from the axis z."""
    return np.array([np.sin(np.radians(tilt)), np.cos(np.radians(tilt))])


def axes_of(tilt: float) -> Floats:
    """Unit vectors along a direction, and across it towards larger tilt, as rows (x, z)."""
    x, z = direction(tilt)
    return np.array([[x, z], [z, -x]])


def _on_whole_hats(nodes, pressure, size, cut_hats):
    """Pressure at all nodes of the socket, with parts of hats in terms of whole ones."""
    cut, seen, parts, _ = cut_hats
    every = np.zeros(size)
    every[nodes] = pressure
    of_parts = every[cut]
    every[cut] = 0
    every[seen] += parts @ of_parts
    return every


def _edges(angles, pressure, grid, ends):
    """Where contact ends in the plane of symmetry: signed angles in deg, minimum and maximum.

    Near an edge the pressure's square is linear. Ends are inside the grid's rims, and inside the
    ball's ``ends`` at phi = 0, where signed angles are positive, and at pi.
    """
    step = np.degrees(grid.step)
    first = np.degrees(np.maximum(ends[0], grid.angles[0]))
    last = np.degrees(np.minimum(ends[1], grid.angles[-1]))
    order = np.argsort(angles)
    angles, pressure = angles[order], pressure[order]
    if len(angles) < 2:
        angles, pressure = np.repeat(angles, 2), np.repeat(pressure, 2)
    found = []
    for side, (inner, outer) in ((-1, (1, 0)), (1, (-2, -1))):
        fall = pressure[inner] ** 2 - pressure[outer] ** 2
        share = min(pressure[outer] ** 2 / fall, 1.0) if fall > 0 else 0.5
        end = angles[outer] + side * share * step
        at = 0 if end > 0 else 1
        found.append(float(np.sign(end) * np.clip(abs(end), first[at], last[at])))
    return tuple(found)


def _angles(opening, resolution):
    """Polar angles of a socket's nodes, and the number of nodes around its largest ring."""
    count = 2 * round((opening.last - opening.first) / 180 * resolution)
    angles = np.radians(
        opening.first + (opening.last - opening.first) / count * np.arange(count + 1)
    )
    widest = np.sin(angles).max() if not opening.is_ring and opening.last < 90 else 1.0
    around = np.ceil(2 * np.pi * widest / (angles[1] - angles[0]) / _TOGETHER)
    return angles, _TOGETHER * int(around)


def _rings(resolution):
    """Density and multiple of a mesh's rings: the coarser grid has half as many."""
    return _RADIAL_ELEMENTS * resolution, resolution // _MULTIPLE


@lru_cache(maxsize=6)
def ball_surface(ball, beyond, resolution):
    """Surface of a ball, whose nodes go on some deg ``beyond`` the socket's rims."""
    from study.joint import modes

    (angles, around), (first, last) = _angles(ball.opening, resolution), ball.support.surface
    step = np.degrees(angles[1] - angles[0])
    if isinstance(ball.support, Bore):
        angles = np.radians(
            np.linspace(first, last, 8 * int(np.ceil((last - first) / step / 8)) + 1)
        )
    else:
        low = max(first, ball.opening.first - beyond)
        high = min(last, ball.opening.last + beyond)
        before = int(max(ball.opening.first - low, 0) / step + 1e-6)
        behind = int(max(high - ball.opening.last, 0) / step + 1e-6)
        angles = np.concatenate(
            [
                angles[0] - np.radians(step) * np.arange(before, 0, -1),
                angles,
                angles[-1] + np.radians(step) * np.arange(1, behind + 1),
            ]
        )
    return modes.Surface(modes.made(ball, angles, *_rings(resolution)), modes.Grid(angles, around))


@lru_cache(maxsize=6)
def socket_surface(socket, resolution):
    """Surface of a socket, at a resolution as of `study.joint.Joint.solve`."""
    from study.joint import modes

    angles, around = _angles(socket.opening, resolution)
    return modes.Surface(
        modes.made(socket, angles, *_rings(resolution)), modes.Grid(angles, around)
    )
