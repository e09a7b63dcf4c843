"""Contact of ball and socket on a grid of the socket, for a displacement off the axis.

Pressure is piecewise linear in both angles and symmetric about the plane phi = 0, in which the ball
is displaced. As along the axis, pressure and gap are complementary in the weak sense, and
`study.joint.complementarity` finds the contact in a few steps, however fine the grid.

Lengths are in socket radii R2, pressures in E* dR/R2 and displacements in dR inside this module.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import csr_array, vstack

from study import checks
from study.joint import complementarity
from study.joint.contact_kinematics import UnresolvedError
from study.joint.supports import Bore

Floats = NDArray[np.float64]
_RADIAL_ELEMENTS = 0.15  # as in `study.joint.fem`, for elements of equal angles
_MULTIPLE = 8  # of which the resolution of any grid is one
_TOGETHER = 16  # nodes around of which coarser rings leave all but one out
_BEYOND = 8.0  # least deg by which the ball's nodes go on beyond the rim
_DEEPEST = 1.0  # depth_star at which they still face the whole rim
_LEAST_SHARE = 0.3  # of the deepest overlap: shallower ones are at first left out of the contact
_FEWEST = 12  # nodes of a contact of half the resolution
_WHOLE = 1e-9  # of an area or an angle: a smaller part that the ball does not face counts as none
_IN_PLANE = np.array([0, np.pi])  # angles phi of the plane of symmetry
_SEEN = 3  # nodes beside cut hats on which these are projected: a projection falls by 0.27 on each
_FITTED = 8  # nodes to which a parabola of four coefficients is fitted, at least
_WINDOW = 0.5  # of the contact's mean radius: around the maximum, where a parabola is fitted


@dataclass(frozen=True)
class GridContact:
    """Contact on one grid: force and stiffness along and across, the rest as in `TiltedContact`.

    ``edge_pressure`` is the largest pressure at an edge that cuts the contact, or 0, and ``ripple``
    the root mean square by which pressures differ from the parabola at their maximum. ``pressure``
    is that on the socket, and ``of_ball`` that on the ball, at the nodes of their grids.
    ``profile`` is the pressure at signed polar angles in the plane of symmetry, in deg.
    """

    force: Floats
    stiffness: Floats
    peak: float
    peak_angle: float
    edge_pressure: float
    ripple: float
    edges: tuple[float, float]
    reaches_rim: bool
    friction: Floats
    profile: tuple[Floats, Floats]
    pressure: Floats
    of_ball: Floats


class Contacts:
    """Contacts of one joint on one grid of the socket."""

    def __init__(self, joint, resolution):
        self.joint = joint
        support = joint.ball_support
        self.ends_at_edge = support.is_half or isinstance(support, Bore)
        self.is_held_at_edges = "equator" in support.held and "rim" in joint.socket_body.held
        beyond = max(_BEYOND, np.degrees((1 + _DEEPEST) / joint.r2_star))
        self.ball = ball_surface(joint.ball_body, beyond, resolution)
        self.socket = socket_surface(joint.socket_body, resolution)
        grid = self.socket.grid
        theta, self.phi, self.area = grid.points
        self.hats = grid.values(theta, self.phi)
        self.mass = self.hats.T @ (self.hats * self.area[:, None])
        self.normal = unit_vectors(theta, self.phi)
        self.node_normal = unit_vectors(grid.theta, grid.phi)
        side = np.where(grid.phi < np.pi / 2, 1, -1)
        self.signed_angle = side * np.degrees(grid.theta)

    def solve(self, depth, tilt):
        """`GridContact` at a depth_star, of a displacement at a tilt in deg."""
        joint, grid = self.joint, self.socket.grid
        r1, (share_of_ball, share_of_socket) = joint.ball_radius, joint.modulus_shares
        axes = np.insert(axes_of(tilt), 1, 0.0, axis=1)
        centre = (1 + depth) / joint.r2_star * axes[0]
        hats, outward, area = self._faced(centre)
        gap, facing = _rigid_ball(joint, outward, centre)
        moves = joint.kinematics == "linear"
        normal, acted_on = outward, np.ones(len(area))
        if moves:  # the force acts on the ball's area, which is this over the socket's
            normal = facing
            acted_on = (1 - gap / joint.r2_star) ** 2 / (facing * outward).sum(axis=1)
        place = np.arccos(np.clip(normal[:, 2], -1, 1)), np.arctan2(normal[:, 1], normal[:, 0])
        met = self.ball.grid.faces(place[0])
        if not self.ends_at_edge and (gap[~met] < 0).any():
            raise checks.RangeError(
                f"depth_star must keep the ball's neck or back out of the opening, got {depth:g}"
            )
        weighted = csr_array((hats * (area * met)[:, None]).T)
        size, gap = weighted.sum(axis=1), weighted @ gap
        mass = weighted @ hats
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
        cut_hats = self._cut_hats(mass, overlap)
        while True:
            nodes = np.flatnonzero(wanted)
            by_socket = share_of_socket * self._of_socket(nodes, cut_hats)
            by_ball = self._of_ball(nodes, moved[nodes], mass[nodes][:, nodes])
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
        closing = facing / (facing * outward).sum(axis=1)[:, None]  # the gap's derivative
        by_pressure = cho_solve(
            cho_factor(matrix[np.ix_(active, active)]), (weighted @ (closing @ axes.T))[nodes]
        )
        force = loads.T @ pressure
        rims = [grid.ring[-1]] if grid.pole == 0 else [0, grid.ring[-1]]
        low, high = self._ends(centre, grid.phi[nodes])
        beyond = (grid.theta[nodes] < low - _WHOLE) | (grid.theta[nodes] > high + _WHOLE)
        reaches_rim = bool(np.isin(grid.ring[nodes], rims).any() or beyond.any())
        if reaches_rim and self.is_held_at_edges:
            self._check_held_edges(high)
        of_ball = moved[nodes].T @ pressure / self.ball.areas / (r1**2 if moves else 1.0)
        every = _on_whole_hats(nodes, pressure, grid.size, cut_hats)
        on_area = every[nodes] * size[nodes] / (weighted @ acted_on)[nodes]
        in_plane = grid.ends[nodes] < 1
        signed = self.signed_angle[nodes[in_plane]]
        at_edge = np.isin(grid.ring[nodes], rims) | np.isin(nodes, cut_hats[0])
        peak, peak_angle, edge_pressure, ripple = self._peak(nodes, on_area, mass, at_edge)
        return GridContact(
            force=2 * joint.r2_star * force,
            stiffness=2 * joint.r2_star * loads.T @ by_pressure,
            peak=peak,
            peak_angle=peak_angle,
            edge_pressure=edge_pressure,
            ripple=ripple,
            edges=_edges(signed, pressure[in_plane], grid, self._ends(centre, _IN_PLANE)),
            reaches_rim=reaches_rim,
            friction=self._friction(normal, axes.T @ force, weighted[nodes], pressure),
            profile=self._profile(np.maximum(every, 0)),
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
        """Friction radii of a ball that turns about the force, and about two axes across it.

        As `study.joint.curve.friction_radii`; the second axis is the normal of the plane of
        symmetry, and the third is in this plane.
        """
        size, radius = np.linalg.norm(force), 1.0
        if self.joint.kinematics == "linear":
            radius = self.joint.ball_radius
        load = force / size
        axes = np.array([load, [0, 1, 0], np.cross(load, [0, 1, 0])])
        sliding = np.sqrt(np.maximum(1 - (normal @ axes.T) ** 2, 0))
        return radius * (weighted @ sliding).T @ pressure / size

    def _profile(self, pressure):
        """Signed polar angles in the plane of symmetry in deg, increasing, and pressures there."""
        in_plane = np.flatnonzero(self.socket.grid.ends < 1)
        order = in_plane[np.argsort(self.signed_angle[in_plane], kind="stable")]
        return self.signed_angle[order], pressure[order]

    def _check_held_edges(self, ball_end):
        """Refuse a contact where the held end of half a ball meets the held rim of a socket.

        If the two coincide, pressure grows like the inverse distance from them and its sum has no
        bound; with a gap between them that is narrower than the elements, it is not resolved.
        """
        grid = self.socket.grid
        step, gap = np.degrees([grid.step, np.abs(ball_end - grid.angles[-1]).min()])
        if gap < step:
            raise UnresolvedError(
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
        local = self._half_space(self.joint.socket, cut[wanted])
        matrix[np.ix_(at, at)] += local[:, None] * unseen[np.ix_(wanted, wanted)] * local
        return matrix[: len(nodes), : len(nodes)]

    def _of_ball(self, nodes, moved, mass):
        """Flexibility of the ball under hats of the socket, of a unit ball."""
        # displacements are wanted where points of the socket face the ball, whose hats are
        # lumped; what they do not see acts as on a half-space
        columns = np.unique(moved.indices)
        moved = moved[:, columns]
        spread = moved @ csr_array(np.diag(1 / self.ball.areas[columns]))
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
        x, _, z = centre if self.joint.kinematics == "linear" else np.zeros(3)

        def facing(edge):
            radius, height = self.joint.ball_radius * np.array([np.sin(edge), np.cos(edge)])
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
        hats = csr_array(vstack([self.hats[kept], grid.values(*of_part)]))
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
        f"{depth:.3g}: take a larger depth or a finer resolution"
    )


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
    from study.joint import fem, fourier

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
    mesh = fem.meridian_of_ball(ball, angles, *_rings(resolution))
    return fourier.Surface(mesh, fem.lame_of(ball, mesh), ball.held, fourier.Grid(angles, around))


@lru_cache(maxsize=6)
def socket_surface(socket, resolution):
    """Surface of a socket, at a resolution as of `study.joint.tilted_contact`."""
    from study.joint import fem, fourier

    angles, around = _angles(socket.opening, resolution)
    mesh = fem.meridian_of_socket(socket, angles, *_rings(resolution))
    lame, grid = fem.lame_of(socket, mesh), fourier.Grid(angles, around)
    return fourier.Surface(mesh, lame, socket.held, grid)
