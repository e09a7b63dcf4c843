"""A joint pressed off its axis: the forces along and across, from contact on (theta, phi).

The bodies are those of revolution of `study.joint.fem`, about the socket's axis. The ball is
displaced in a direction off that axis. Their flexibility comes from the modes of
`study.joint.fourier`, and `study.joint.grid_contact` finds the contact on two grids.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import largest_depth
from study.joint.definition import Joint
from study.joint.grid_contact import Contacts, GridContact, axes_of, direction
from study.joint.supports import KINEMATICS
from study.threads import one_thread

Floats = NDArray[np.float64]
RESOLUTION = 48
"""Default elements along a quarter circle; half of it is solved too."""
FINEST_RESOLUTION = 96
LARGEST_TILT = 170.0
"""In deg: beyond it no socket has a surface."""
SHALLOWEST = 0.05
"""Minimum depth_star of a curve or a table: elements hardly resolve shallower contacts."""
DEPTHS = 9
"""Depths of a curve."""
_DEEPEST = 1.0  # depth_star of the largest first guess under a force
MOTIONS = "spin", "tilt", "turn"
_MOST_STEPS = 40
_TOLERANCE = 1e-6  # of the force that is asked for
# fractions of the pressures' mean difference that errors of 300 random contacts remain below
_FORCE_OF_PRESSURES, _PEAK_OF_PRESSURES = 0.15, 0.3
_GROWTH_AT_PUNCH = np.sqrt(2) - 1


@dataclass(frozen=True)
class TiltedContact:
    """Contact of a ball that is displaced off the socket's axis, at some depths; arrays (k,).

    Forces are those of the ball on the socket, over E* dR^2. They are extrapolated from two grids,
    and so is the peak pressure unless an edge cuts the contact.

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
        Largest pressure, in E* dR/R2, and its signed polar angle in the plane of symmetry. Where
        an edge cuts the contact it may be there; it then grows with the resolution.
    peak_error
        Estimated relative error of the peak pressure, as of `error_estimate`. Where an edge cuts
        the contact it is that to be expected on a grid with twice the resolution.
    contact_edges_deg
        Signed polar angles at which the contact ends in the plane of symmetry; shape (2, k).
    reaches_rim
        Whether the contact is cut by a rim, or by the edge of a ball's face.
    friction_radius_star
        Friction radii in R2, as of `study.joint.curve.friction_radii`: of a ball that turns
        about the force (``spin``), about the normal of the plane of symmetry (``tilt``), and about
        the axis in this plane across the force (``turn``), which is that of a ring's socket if the
        force is across it.
    angle_deg, pressure_star
        Signed polar angles in the plane of symmetry in deg, shape (n,), and the pressure on the
        socket there, shape (k, n).
    error_estimate
        Estimated relative error of the force, from the difference between the two grids. Of 300
        random contacts it covers the difference to twice the resolution in 99 %.
    resolution, grids
        Elements along a quarter circle, and contacts on this grid and on the coarser one, k pairs.
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
    peak_error: Floats
    contact_edges_deg: Floats
    reaches_rim: NDArray[np.bool_]
    friction_radius_star: dict[str, Floats]
    angle_deg: Floats
    pressure_star: Floats
    error_estimate: Floats
    resolution: int
    grids: tuple[tuple[GridContact, GridContact], ...] = field(repr=False)

    @property
    def contact_half_angle_deg(self) -> Floats:
        """Half the angle between the contact's ends in the plane of symmetry, in deg; (k,)."""
        low, high = self.contact_edges_deg
        return (high - low) / 2

    @property
    def to_rim_deg(self) -> Floats:
        """Angle from the contact's end to the nearest rim or face, in deg; 0 if it is cut; (k,)."""
        (low, high), joint = self.contact_edges_deg, self.joint
        (first, last), opening = joint.ball_support.surface, joint.opening
        to_rim = min(last, opening.last) - np.maximum(np.abs(low), high)
        if not joint.has_pole:
            to_rim = np.minimum(to_rim, low - max(first, opening.first))
        return np.where(self.reaches_rim, 0.0, np.maximum(to_rim, 1e-9))


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
    fine, coarse = (Contacts(joint, n) for n in (resolution, resolution // 2))
    solved = [(fine.solve(*at), coarse.solve(*at)) for at in zip(depths, tilts, strict=True)]
    return _result(joint, depths, tilts, solved, resolution)


@one_thread
def under_force(
    joint: Joint, force_star: ArrayLike, tilt: ArrayLike, resolution: int = RESOLUTION
) -> TiltedContact:
    """`tilted_contact` under forces that point off the axis by a tilt; displacements follow.

    Without friction no force can point out of the opening: its tilt is inside the opening. Other
    arguments and errors are those of `tilted_contact`; a force that no displacement inside the
    joint causes is a ``ValueError`` too.
    """
    forces, tilts, resolution = _checked(joint, force_star, tilt, "force_star", resolution)
    for outside in (one for one in tilts if not joint.opening.faces(one)):
        raise checks.RangeError(
            f"tilt of a force must be inside the socket's opening of {joint.opening} deg, got "
            f"{outside:g} deg: without friction no force points out of the opening. Give the depth "
            "of a displacement in this direction, or a socket that reaches further"
        )
    fine, coarse = (Contacts(joint, n) for n in (resolution, resolution // 2))
    found = [_pressed(joint, fine, coarse, *at) for at in zip(forces, tilts, strict=True)]
    depths, directions = np.array([at for at, _ in found]).T
    return _result(joint, depths, directions, [solved for _, solved in found], resolution)


@one_thread
def tilted_curve(joint: Joint, tilt: float, deepest: float = 1.0) -> TiltedContact:
    """Contacts in one direction at `DEPTHS` depths, for a table of the force along it.

    They are in equal steps of the root of the depth_star, from a sixteenth of the largest one, or
    from `SHALLOWEST`, to ``deepest`` or at least 0.5. Other arguments and errors are those of
    `tilted_contact`.
    """
    last = max(checks.number("deepest", deepest, above=0, scalar=True), 10 * SHALLOWEST)
    roots = np.linspace(np.sqrt(max(SHALLOWEST, last / 16)), np.sqrt(last), DEPTHS)
    return tilted_contact(joint, roots**2, tilt)


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
    wanted, reached = force * direction(tilt), None
    first = min((3 * force / (4 * joint.r2_star)) ** (2 / 3), _DEEPEST)  # Hertz's law, about
    displacement = (1 + first) * direction(tilt)
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
        axes, reached = axes_of(towards), displacement
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


def _extrapolated(fine, coarse):
    return fine + (fine - coarse) / 3  # errors fall with order 2


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


def _result(joint, depths, tilts, solved, resolution):
    """What was solved on the finer and on the coarser grid at each depth, as arrays."""
    fine = [f for f, _ in solved]
    force = np.array([_extrapolated(f.force, c.force) for f, c in solved])
    stiffness = np.array([_extrapolated(f.stiffness, c.stiffness) for f, c in solved])
    cut = np.array([f.reaches_rim for f in fine])
    peak = np.array([_extrapolated(f.peak, c.peak) for f, c in solved])
    peak = np.where(cut, [f.peak for f in fine], peak)
    return TiltedContact(
        joint=joint,
        depth_star=depths,
        tilt=tilts,
        force_star=force[:, 0],
        transverse_star=force[:, 1],
        stiffness_star=stiffness[:, 0, 0],
        transverse_stiffness_star=stiffness[:, 1, 1],
        peak_pressure_star=peak,
        peak_angle_deg=np.array([f.peak_angle for f in fine]),
        peak_error=np.array([_peak_error(*s, at) for s, at in zip(solved, peak, strict=True)]),
        contact_edges_deg=np.array([f.edges for f in fine]).T,
        reaches_rim=cut,
        friction_radius_star=dict(
            zip(MOTIONS, np.array([f.friction for f in fine]).T, strict=True)
        ),
        angle_deg=fine[0].profile[0],
        pressure_star=np.array([f.profile[1] for f in fine]),
        error_estimate=np.array([_force_error(*s, f) for s, f in zip(solved, force, strict=True)]),
        resolution=resolution,
        grids=tuple(solved),
    )
