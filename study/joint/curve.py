"""Ball in socket: two elastic bodies and a gap become a force-depth curve.

For every depth the contact pressure solves a complementarity problem on the contact arc:
pressure >= 0, gap >= 0, pressure * gap = 0, all in the weak (Galerkin) sense of the pressure's
hat functions. Frictionless and elastic. Which points face each other: `study.joint.pairing`.

Lengths are in socket radii R2 and pressures in E* dR/R2 inside this module.
"""

from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from study import checks
from study.contact import SOCKET_RATIO, composite_modulus
from study.joint import fem, pairing, series
from study.joint.compliance import DRIVES, FINEST_RESOLUTION, RIMS, THICKEST_RATIO, Drive, Rim
from study.threads import one_thread

Kinematics = Literal["small", "linear", "finite"]
Solver = Literal["series", "quadratic", "linear"]
KINEMATICS: tuple[Kinematics, ...] = get_args(Kinematics)
SOLVERS: tuple[Solver, ...] = get_args(Solver)
FINITE_RESOLUTION = 96  # large displacements cost more
LARGEST_MODULUS_RATIO = 1e9
"""Of the bodies' Young's moduli, either way: a stiffer body is rigid, within 1e-9 of the force, and
one much softer than its ball leaves a contact matrix that is not positive definite once rounded."""
_BESIDE = (0.97, 1.03)  # neighbours of a depth at which its error is estimated too


class UnresolvedError(checks.RangeError):
    """A contact smaller than the elements can resolve."""


@dataclass(frozen=True)
class Material:
    """An isotropic, linear elastic material.

    Attributes
    ----------
    youngs_modulus : float
        Young's modulus, > 0, in Pa.
    poisson : float
        Poisson's ratio, in (-1, 0.5).
    """

    youngs_modulus: float = 2e11
    poisson: float = 0.3

    def __post_init__(self):
        checks.number("Young's modulus", self.youngs_modulus, "Pa", above=0, scalar=True)
        checks.poisson("Poisson's ratio", self.poisson)


@dataclass(frozen=True)
class Joint:
    """A spherical clearance joint, as far as its force-depth curve depends on it.

    The supports are by default those of a joint in general, not of the paper's (`paper_joint`):
    a ball that is free to spread at its equator and a socket that ends in a mirror plane. They
    are solved exactly, and it is for them that `study.contact.stiffened_hertz` is right.

    Attributes
    ----------
    r2_star : float
        Dimensionless socket radius R2/dR, > 1.
    socket_ratio : float
        Outer over inner radius of the socket, from 1.001 to 1e6; >= 1.02 for finite elements. By
        default the paper's.
    ball, socket : Material
        Materials of the two bodies, Young's moduli within a factor of 1e9.
    ball_drive : {"plane", "clamped", "point"}
        The half ball's equatorial plane is displaced axially and is radially free, or fixed;
        or its centre alone is displaced, as by a point load.
    rim : {"mirror", "free"}
        The socket's edge at the equator is a mirror plane, or traction-free. At Poisson's ratio
        0.3 and R2* = 200 the force differs by less than 1e-5 up to a socket ratio of 1.25, by
        0.7 % at 2 and 4 % at 3; at Poisson's ratio 0.45 by 0.4 % at 1.25 and 1.6 % at 1.5.
    kinematics : {"linear", "small", "finite"}
        ``small``: points face each other at equal angles seen from the socket's centre, the
        gap is the exact overlap of the rigid spheres, the force acts on the socket's area.
        ``linear``: every point of the ball faces the point of the socket it has moved to, and
        the force acts on the ball's area; as a small-strain analysis that searches contact on
        the moved surfaces does. ``finite``: large displacements and rotations, with the
        material of Saint Venant and Kirchhoff. They differ by terms of order 1/R2*.

    Raises
    ------
    ValueError
        For a value outside its range.
    """

    r2_star: float
    socket_ratio: float = SOCKET_RATIO
    ball: Material = field(default_factory=Material)
    socket: Material = field(default_factory=Material)
    ball_drive: Drive = "plane"
    rim: Rim = "mirror"
    kinematics: Kinematics = "linear"

    def __post_init__(self):
        checks.number("r2_star", self.r2_star, above=1, scalar=True)
        thickness = {"least": series.THINNEST_RATIO, "most": THICKEST_RATIO}
        checks.number("socket_ratio", self.socket_ratio, **thickness, scalar=True)
        for name in ("ball", "socket"):
            checks.instance(name, getattr(self, name), Material)
        moduli = {"least": 1 / LARGEST_MODULUS_RATIO, "most": LARGEST_MODULUS_RATIO}
        ratio = self.socket.youngs_modulus / self.ball.youngs_modulus
        checks.number("Young's modulus of the socket over that of the ball", ratio, **moduli)
        checks.choice("ball_drive", self.ball_drive, DRIVES)
        checks.choice("rim", self.rim, RIMS)
        checks.choice("kinematics", self.kinematics, KINEMATICS)

    @property
    def ball_radius(self):
        """Ball radius over socket radius, R1/R2."""
        return 1 - 1 / self.r2_star

    @property
    def modulus_shares(self):
        """E*/E of the ball and of the socket."""
        ball, socket = self.ball, self.socket
        composite = composite_modulus(
            ball.youngs_modulus, ball.poisson, socket.youngs_modulus, socket.poisson
        )
        return composite / ball.youngs_modulus, composite / socket.youngs_modulus


PAPER_SUPPORTS = {"ball_drive": "clamped", "rim": "free"}
"""How the paper's finite elements hold ball and socket: identified from its Table 2."""


def paper_joint(r2_star=200, **changes):
    """The joint of the paper's figures and tables, as far as it can be known.

    Clamped ball, free rim, socket ratio 1.298, linear kinematics, both bodies of Poisson's ratio
    0.3: identified from Table 2 and Fig. 14 (notebook 13), but for the rim, which follows from
    the text ("the entire external surface of the socket is fixed") and changes nothing there.

    Parameters
    ----------
    r2_star : float
        Dimensionless socket radius; 200 is that of Fig. 10 and Table 2.
    **changes
        Other attributes of `Joint`.

    Returns
    -------
    Joint

    Raises
    ------
    ValueError
        As for `Joint`.
    """
    return Joint(r2_star, **(PAPER_SUPPORTS | changes))


@dataclass(frozen=True)
class ForceCurve:
    """Force against depth of one joint, with what the contact looks like at each depth.

    Attributes
    ----------
    joint : Joint
    solver : str
        Which of `SOLVERS` made it.
    depth_star : ndarray, shape (k,)
        Dimensionless penetration depth d/dR, in the order asked for.
    force_star : ndarray, shape (k,)
        Dimensionless force P/(E* dR^2).
    contact_half_angle : ndarray, shape (k,)
        Polar angle of the contact's edge, in rad.
    peak_pressure : ndarray, shape (k,)
        Largest pressure, in E* dR/R2.
    error_estimate : ndarray, shape (k,)
        Estimated relative discretisation error of the force: its largest difference from the
        force at half the resolution, at this depth and 3 % to both sides of it (the
        error oscillates as the contact's edge passes the nodes).
    angles : ndarray, shape (n,)
        Polar angles of the pressure profile, in rad.
    pressure : ndarray, shape (k, n)
        Pressure profile per depth, in E* dR/R2.
    """

    joint: Joint
    solver: str
    depth_star: np.ndarray
    force_star: np.ndarray
    contact_half_angle: np.ndarray
    peak_pressure: np.ndarray
    error_estimate: np.ndarray
    angles: np.ndarray
    pressure: np.ndarray

    def columns(self):
        """The curve as columns of a table, a row per depth: those of `study.dataset.load`.

        Returns
        -------
        dict
            Column name -> value of all rows, or array of shape (k,).
        """
        joint = self.joint
        return {
            "r2_star": joint.r2_star,
            "socket_ratio": joint.socket_ratio,
            "poisson_ball": joint.ball.poisson,
            "poisson_socket": joint.socket.poisson,
            "modulus_ratio": joint.socket.youngs_modulus / joint.ball.youngs_modulus,
            "ball_drive": joint.ball_drive,
            "rim": joint.rim,
            "kinematics": joint.kinematics,
            "solver": self.solver,
            "depth_star": self.depth_star,
            "force_star": self.force_star,
            "contact_half_angle": np.degrees(self.contact_half_angle),
            "peak_pressure_star": self.peak_pressure,
            "error_estimate": self.error_estimate,
        }


@one_thread
def force_curve(joint, depth_star, resolution=None, solver=None):
    """Force-depth curve of a joint, at two resolutions.

    The bodies are cached: further curves with the same ones, whatever their R2*, moduli and
    depths, cost milliseconds (``finite`` kinematics: half a second per depth).

    Parameters
    ----------
    joint : Joint
    depth_star : float or array_like, shape (k,)
        Dimensionless penetration depths, >= 0 and < sqrt(2 R2* - 1) - 1.
    resolution : int, optional
        Elements along the surface, a multiple of 32, by default 320 for ``series``, 160 for
        finite elements and 96 for ``finite`` kinematics; the error estimate uses half of it.
    solver : {"series", "quadratic", "linear"}, optional
        Exact Legendre series of both bodies, or finite elements: six-node or three-node
        triangles. By default the series where it applies (``plane`` drive, ``mirror`` rim,
        kinematics other than ``finite``), and else six-node triangles.

    Returns
    -------
    ForceCurve

    Raises
    ------
    ValueError
        For a negative depth or NaN, contact that reaches the socket's rim, contact smaller
        than the elements can resolve, or a solver that cannot solve this joint.
    study.joint.complementarity.ComplementarityError
        If the contact does not converge; carries the residual.
    """
    checks.instance("joint", joint, Joint)
    finite = joint.kinematics == "finite"
    able = joint.ball_drive == "plane" and joint.rim == "mirror" and not finite
    if solver is None:
        solver = "series" if able else "quadratic"
    checks.choice("solver", solver, SOLVERS)
    if solver == "series" and not able:
        raise ValueError(
            "solver must be quadratic or linear for this joint: the series needs ball_drive "
            f"plane, rim mirror and kinematics small or linear, got {joint.ball_drive}, "
            f"{joint.rim} and {joint.kinematics}"
        )
    if solver == "linear" and finite:
        raise ValueError("solver must be quadratic for kinematics finite, got 'linear'")
    if solver != "series":
        checks.number("socket_ratio", joint.socket_ratio, least=fem.THINNEST_RATIO)
    if finite:
        checks.number("r2_star", joint.r2_star, most=pairing.LARGEST_R2_STAR)
    if resolution is None:
        usual = {"series": series.RESOLUTION}.get(solver, fem.RESOLUTION)
        resolution = FINITE_RESOLUTION if finite else usual
    depths = np.atleast_1d(checks.number("depth_star", depth_star, least=0))
    widest = np.sqrt(2 * joint.r2_star - 1) - 1  # beyond it the spheres' overlap gets narrower
    checks.number("depth_star", depths, below=widest)
    if depths.ndim != 1 or depths.size == 0:
        raise ValueError(f"depth_star must be a list of depths, got shape {depths.shape}")
    least = 64 if solver != "series" and joint.socket_ratio < 1.05 else 32
    most = FINEST_RESOLUTION if solver == "series" else fem.FINEST_RESOLUTION
    resolution = checks.whole("resolution", resolution, least=least, most=most)
    if resolution % 32:
        raise ValueError(f"resolution must be a multiple of 32, got {resolution}")
    beside = np.outer([1, *_BESIDE], depths)
    angles, pressure, fine = _solve(joint, solver, beside.ravel(), resolution)
    _, _, coarse = _solve(joint, solver, beside.ravel(), resolution // 2)
    pressure, force = pressure[: depths.size], fine[: depths.size]
    if pressure[:, -2:].any():
        least = depths[pressure[:, -2:].any(axis=1)].min()
        raise checks.RangeError(
            "depth_star must keep the contact off the socket's rim (half-angle < 90 deg), "
            f"got {least:g}"
        )
    unseen = (np.minimum(fine, coarse) == 0) & (beside.ravel() > 0)
    if unseen.any():
        raise UnresolvedError(
            "depth_star must be 0 or so large that the elements resolve the contact, got "
            f"{beside.ravel()[unseen].max():.3g} with elements of {np.degrees(angles[1]):.2g} deg"
        )
    relative = np.divide(np.abs(fine - coarse), fine, out=np.zeros_like(fine), where=fine > 0)
    return ForceCurve(
        joint=joint,
        solver=solver,
        depth_star=depths,
        force_star=force,
        contact_half_angle=np.array([_edge(angles, p) for p in pressure]),
        peak_pressure=pressure.max(axis=1),
        error_estimate=relative.reshape(beside.shape).max(axis=0),
        angles=angles,
        pressure=pressure,
    )


def _solve(joint, solver, depths, resolution):
    """Nodal angles, pressure profiles (k, n) and forces (k,) at one resolution."""
    if solver == "series":
        ball = series.ball_compliance(joint.ball.poisson, resolution)
        socket = series.socket_compliance(joint.socket_ratio, joint.socket.poisson, resolution)
    else:
        mesh = (resolution, 6 if solver == "quadratic" else 3)
        of_ball = (joint.ball.poisson, joint.ball_drive, *mesh)
        of_socket = (joint.socket_ratio, joint.socket.poisson, joint.rim, *mesh)
        if joint.kinematics == "finite":
            bodies = fem.ball(*of_ball), fem.socket(*of_socket)
            return bodies[0].compliance.angles, *pairing.solve_finite(joint, depths, *bodies)
        ball, socket = fem.ball_compliance(*of_ball), fem.socket_compliance(*of_socket)
    problem = {"small": pairing.small, "linear": pairing.linear}[joint.kinematics]
    return ball.angles, *pairing.solve(joint, depths, *problem(joint, ball, socket))


def _edge(angles, pressure):
    """Polar angle where the pressure ends: a root of its square, to about 0.3 %.

    Pressure falls like the square root of the distance to the edge, so that its square is
    smooth and a cubic in cos(angle) fits it; the last two nodes carry the discretisation's
    oscillation and are left out. A contact of few nodes gets a lower degree, one of very few
    the middle between its last node and the next.
    """
    last = np.count_nonzero(pressure) - 1
    if last < 0:
        return 0.0
    x = np.cos(angles) - np.cos(angles[last])
    inner = (angles >= 0.3 * angles[last]) & (np.arange(len(angles)) <= last - 2)
    degree = min(3, np.count_nonzero(inner) // 4)
    roots = np.array([x[last + 1] / 2])
    if degree > 0:
        fitted = np.polynomial.Polynomial.fit(x[inner], pressure[inner] ** 2, degree).roots()
        real = fitted[np.isreal(fitted)].real
        roots = real if real.size else roots
    nearest = roots[np.argmin(np.abs(roots))]
    inside = x[max(last - 1, 0)]
    return float(np.arccos(np.cos(angles[last]) + np.clip(nearest, x[last + 1], inside)))
