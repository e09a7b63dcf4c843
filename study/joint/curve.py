"""Ball in socket: two elastic bodies and a gap become a force-depth curve.

For every depth the contact pressure solves a complementarity problem on the contact arc:
pressure >= 0, gap >= 0, pressure * gap = 0, all in the weak (Galerkin) sense of the pressure's
hat functions. Frictionless and elastic. Which points face each other: `study.joint.pairing`.

Lengths are in socket radii R2 and pressures in E* dR/R2 inside this module.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from study import checks
from study.contact import SOCKET_RATIO, composite_modulus, largest_depth
from study.joint import pairing, series
from study.joint.compliance import (
    DRIVES,
    FINEST_RESOLUTION,
    RESOLUTION,
    RIMS,
    THICKEST_RATIO,
    THINNEST_RATIO,
    Compliance,
    Drive,
    Rim,
    layer_ratios,
    layer_steps,
)
from study.threads import one_thread

if TYPE_CHECKING:
    from study.joint.stress import LargestStress

Kinematics = Literal["small", "linear", "finite"]
Solver = Literal["series", "quadratic", "linear"]
KINEMATICS: tuple[Kinematics, ...] = get_args(Kinematics)
SOLVERS: tuple[Solver, ...] = get_args(Solver)
LARGEST_MODULUS_RATIO = 1e9
"""Of the bodies' Young's moduli, either way: a stiffer body is rigid, within 1e-9 of the force, and
one much softer than its ball leaves a contact matrix that is not positive definite once rounded."""
_BESIDE = (0.97, 1.03)  # neighbours of a depth at which its error is estimated too


class UnresolvedError(checks.RangeError):
    """A contact smaller than the elements can resolve."""


@dataclass(frozen=True)
class Material:
    """An isotropic, linear elastic material: Young's modulus > 0, in Pa, Poisson's ratio < 0.5.

    Its yield stress, > 0, in Pa, is for `study.joint.first_yield`; materials that differ in it
    alone are equal, as forces do not depend on it.
    """

    youngs_modulus: float = 2e11
    poisson: float = 0.3
    yield_stress: float | None = field(default=None, compare=False)

    def __post_init__(self):
        checks.number("Young's modulus", self.youngs_modulus, "Pa", above=0, scalar=True)
        checks.poisson("Poisson's ratio", self.poisson)
        if self.yield_stress is not None:
            checks.number("yield stress", self.yield_stress, "Pa", above=0, scalar=True)


@dataclass(frozen=True)
class Layer:
    """A layer of a socket: its outer radius over the socket's inner radius, and its material."""

    outer_ratio: float
    material: Material

    def __post_init__(self):
        checks.number("outer_ratio", self.outer_ratio, above=1, most=THICKEST_RATIO, scalar=True)
        checks.instance("material", self.material, Material)


@dataclass(frozen=True)
class Joint:
    """A spherical clearance joint, as far as its force-depth curve depends on it.

    Its default supports, which are solved exactly and are those of
    `study.contact.stiffened_hertz`, are not the paper's (`paper_joint`). A value outside its range
    is a ``ValueError``.

    Attributes
    ----------
    r2_star
        Dimensionless socket radius R2/dR, > 1.
    socket_ratio
        Outer over inner radius, from 1.0001 to 1e6; >= 1.02 for finite elements.
    ball, socket
        Materials, Young's moduli within a factor of 1e9.
    layers
        Of a socket of several materials, bonded, from the inside out: a liner in its housing. Each
        is at least 0.0001 of its inner radius thick, 0.02 for finite elements. They are given
        instead of ``socket_ratio`` and ``socket``, which are then the outermost ratio and the
        innermost material: the composite modulus E* is that of ball and innermost layer.
    ball_drive
        The half ball's equatorial plane is displaced axially and is radially free (``plane``), or
        fixed (``clamped``); or its centre alone is displaced (``point``), as by a point load.
    rim
        The socket's edge at the equator is a mirror plane, or traction-free. At Poisson's ratio
        0.3 and R2* = 200 the force differs by less than 1e-5 up to a socket ratio of 1.25, by
        0.7 % at 2 and 4 % at 3; at Poisson's ratio 0.45 by 0.4 % at 1.25 and 1.6 % at 1.5.
    kinematics
        ``small``: points face each other at equal angles seen from the socket's centre, the
        gap is the exact overlap of the rigid spheres, the force acts on the socket's area.
        ``linear``: every point of the ball faces the point of the socket it has moved to, and
        the force acts on the ball's area; as a small-strain analysis that searches contact on
        the moved surfaces does. ``finite``: large displacements and rotations, with the
        material of Saint Venant and Kirchhoff. They differ by terms of order 1/R2*.
    """

    r2_star: float
    socket_ratio: float = SOCKET_RATIO
    ball: Material = field(default_factory=Material)
    socket: Material = field(default_factory=Material)
    ball_drive: Drive = "plane"
    rim: Rim = "mirror"
    kinematics: Kinematics = "linear"
    layers: tuple[Layer, ...] = ()

    def __post_init__(self):
        checks.number("r2_star", self.r2_star, above=1, scalar=True)
        thinnest, thickest = THINNEST_RATIO, THICKEST_RATIO
        checks.number("socket_ratio", self.socket_ratio, least=thinnest, most=thickest, scalar=True)
        for name in ("ball", "socket"):
            checks.instance(name, getattr(self, name), Material)
        self._take_layers()
        name, most = "Young's modulus of the socket over that of the ball", LARGEST_MODULUS_RATIO
        for material in (self.socket, *(layer.material for layer in self.layers)):
            ratio = material.youngs_modulus / self.ball.youngs_modulus
            checks.number(name, ratio, least=1 / most, most=most)
        checks.choice("ball_drive", self.ball_drive, DRIVES)
        checks.choice("rim", self.rim, RIMS)
        checks.choice("kinematics", self.kinematics, KINEMATICS)

    def _take_layers(self):
        """Check the layers, and set what follows from them."""
        if not isinstance(self.layers, tuple):
            raise ValueError(f"layers must be a tuple of Layer, got {checks.shown(self.layers)}")
        for layer in self.layers:
            checks.instance("each of layers", layer, Layer)
        if not self.layers:
            return
        layer_ratios(self.socket_layers[0])
        ratio, material = self.layers[-1].outer_ratio, self.layers[0].material
        for name, default, follows in (
            ("socket_ratio", SOCKET_RATIO, ratio),
            ("socket", Material(), material),
        ):
            given = getattr(self, name)
            if given not in (default, follows):
                raise ValueError(f"{name} must be left out beside layers, got {given}")
            object.__setattr__(self, name, follows)

    @property
    def socket_layers(self) -> tuple[tuple[float, ...], ...]:
        """Outer ratio, Poisson's ratio and Young's modulus of each layer of the socket.

        From the inside out, as three tuples; the modulus is over the innermost one's.
        """
        layers = self.layers or (Layer(self.socket_ratio, self.socket),)
        unit = layers[0].material.youngs_modulus
        each = ((k.outer_ratio, k.material.poisson, k.material.youngs_modulus) for k in layers)
        return tuple(zip(*((q, nu, e / unit) for q, nu, e in each), strict=True))

    @property
    def materials(self) -> dict[str, Material]:
        """Materials of ``ball`` and ``socket``, or ``layer 1`` and so on, from the inside out."""
        layers = {f"layer {k}": layer.material for k, layer in enumerate(self.layers, 1)}
        return {"ball": self.ball} | (layers or {"socket": self.socket})

    @property
    def ball_radius(self) -> float:
        """Ball radius over socket radius, R1/R2."""
        return 1 - 1 / self.r2_star

    @property
    def modulus_ratio(self) -> float:
        """Young's modulus of the socket over that of the ball."""
        return self.socket.youngs_modulus / self.ball.youngs_modulus

    @property
    def composite_modulus(self) -> float:
        """E*, in Pa."""
        ball, socket = self.ball, self.socket
        moduli = ball.youngs_modulus, socket.youngs_modulus
        return composite_modulus(moduli[0], ball.poisson, moduli[1], socket.poisson)

    @property
    def layers_text(self) -> str:
        """Layers as a table holds them, ``1.125:0.0025:0.46;1.5:1:0.3``; empty for one material.

        Outer ratio, Young's modulus over the ball's and Poisson's ratio of each.
        """
        unit = self.ball.youngs_modulus
        each = ((k.outer_ratio, k.material.youngs_modulus / unit, k.material) for k in self.layers)
        return ";".join(f"{q:.9g}:{e:.9g}:{material.poisson:.9g}" for q, e, material in each)

    @property
    def modulus_shares(self) -> tuple[float, float]:
        """E*/E of the ball and of the socket."""
        composite = self.composite_modulus
        return composite / self.ball.youngs_modulus, composite / self.socket.youngs_modulus

    def stiffening_options(self) -> dict[str, Any]:
        """Options of `study.contact.stiffened_hertz`; a joint it is not for is a ``ValueError``."""
        if self.layers or self.ball_drive == "point":
            what = "a socket of layers" if self.layers else "ball_drive point"
            raise checks.RangeError(f"stiffened_hertz is not for {what}")
        return {
            "socket_ratio": self.socket_ratio,
            "modulus_ratio": self.modulus_ratio,
            "poisson": self.ball.poisson,
            "socket_poisson": self.socket.poisson,
            "ball_drive": self.ball_drive,
            "rim": self.rim,
        }

    @property
    def series_applies(self) -> bool:
        """Whether the exact series does: symmetric about the equator, bodies that stay linear."""
        supports = self.ball_drive == "plane" and self.rim == "mirror"
        return supports and self.kinematics != "finite"


PAPER_SUPPORTS: dict[str, Any] = {"ball_drive": "clamped", "rim": "free"}
"""How the paper's finite elements hold ball and socket: identified from its Table 2."""


def paper_joint(r2_star: float = 200, **changes: Any) -> Joint:
    """The joint of the paper's figures and tables, as far as it can be known.

    Clamped ball, free rim, socket ratio 1.298, linear kinematics, both bodies of Poisson's ratio
    0.3: identified from Table 2 and Fig. 14 (notebook 13), but for the rim, which follows from
    the text ("the entire external surface of the socket is fixed") and changes nothing there.
    R2* = 200 is that of Fig. 10 and Table 2; ``changes`` are other attributes of `Joint`.
    """
    return Joint(r2_star, **(PAPER_SUPPORTS | changes))


@dataclass(frozen=True)
class ForceCurve:
    """Force against depth of one joint, with what the contact looks like at each depth.

    Attributes
    ----------
    depth_star, force_star
        Dimensionless depth d/dR, in the order asked for, and force P/(E* dR^2); shape (k,).
    contact_half_angle
        Polar angle of the contact's edge, in rad; shape (k,).
    peak_pressure
        Largest pressure, in E* dR/R2; shape (k,).
    error_estimate
        Estimated relative discretisation error of the force, shape (k,): its largest difference
        from the force at half the resolution, at this depth and 3 % to both sides of it (the
        error oscillates as the contact's edge passes the nodes).
    angles, pressure
        Polar angles in rad, shape (n,), and the pressure there in E* dR/R2, shape (k, n).
    """

    joint: Joint
    solver: Solver
    depth_star: NDArray[np.float64]
    force_star: NDArray[np.float64]
    contact_half_angle: NDArray[np.float64]
    peak_pressure: NDArray[np.float64]
    error_estimate: NDArray[np.float64]
    angles: NDArray[np.float64]
    pressure: NDArray[np.float64]

    @cached_property
    def largest_stress(self) -> "dict[str, LargestStress]":
        """`study.joint.stress.LargestStress` of each body, by its name; computed when asked for."""
        from study.joint import stress

        return stress.largest(self)

    def columns(self) -> dict[str, Any]:
        """The curve as columns of a table, a row per depth: those of `study.dataset.load`."""
        joint = self.joint
        return {
            "r2_star": joint.r2_star,
            "socket_ratio": joint.socket_ratio,
            "poisson_ball": joint.ball.poisson,
            "poisson_socket": joint.socket.poisson,
            "modulus_ratio": joint.modulus_ratio,
            "layers": joint.layers_text,
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
def force_curve(
    joint: Joint,
    depth_star: ArrayLike,
    resolution: int | None = None,
    solver: Solver | None = None,
) -> ForceCurve:
    """Force-depth curve of a joint, at two resolutions.

    The bodies are cached: further curves with the same ones, whatever their R2*, moduli and
    depths, cost milliseconds (``finite`` kinematics: half a second per depth).

    Parameters
    ----------
    depth_star
        Dimensionless penetration depths, >= 0 and < sqrt(2 R2* - 1) - 1; shape (k,).
    resolution
        Elements along the surface, a multiple of 32, by default 320 for ``series``, 160 for
        finite elements and 96 for ``finite`` kinematics; the error estimate uses half of it.
    solver
        Exact Legendre ``series`` of both bodies, or finite elements: six-node (``quadratic``) or
        three-node (``linear``) triangles. By default the series where it applies (``plane``
        drive, ``mirror`` rim, kinematics other than ``finite``), and else six-node triangles.

    Raises
    ------
    ValueError
        For contact that reaches the socket's rim or is too small for the elements to resolve, a
        solver that cannot solve this joint, or a value outside its range.
    study.joint.complementarity.ComplementarityError
        If the contact does not converge; carries the residual.
    """
    checks.instance("joint", joint, Joint)
    solver = chosen_solver(joint, solver)
    depths = np.atleast_1d(checks.number("depth_star", depth_star, least=0))
    checks.number("depth_star", depths, below=largest_depth(joint.r2_star))
    if depths.ndim != 1 or depths.size == 0:
        raise ValueError(f"depth_star must be a list of depths, got shape {depths.shape}")
    resolution = checked_resolution(joint, solver, resolution)
    beside = np.outer([1, *_BESIDE], depths).ravel()
    angles, pressure, fine = _solve(joint, solver, beside, resolution)
    _, _, coarse = _solve(joint, solver, beside, resolution // 2)
    pressure = pressure[: depths.size]
    at_rim = pressure[:, -2:].any(axis=1)
    if at_rim.any():
        raise checks.RangeError(
            "depth_star must keep the contact off the socket's rim (half-angle < 90 deg), "
            f"got {depths[at_rim].min():g}"
        )
    unseen = (np.minimum(fine, coarse) == 0) & (beside > 0)
    if unseen.any():
        raise UnresolvedError(
            "depth_star must be 0 or so large that the elements resolve the contact, got "
            f"{beside[unseen].max():.3g} with elements of {np.degrees(angles[1]):.2g} deg"
        )
    relative = np.divide(np.abs(fine - coarse), fine, out=np.zeros_like(fine), where=fine > 0)
    return ForceCurve(
        joint=joint,
        solver=solver,
        depth_star=depths,
        force_star=fine[: depths.size],
        contact_half_angle=np.array([_edge(angles, p) for p in pressure]),
        peak_pressure=pressure.max(axis=1),
        error_estimate=relative.reshape(-1, depths.size).max(axis=0),
        angles=angles,
        pressure=pressure,
    )


def chosen_solver(joint: Joint, solver: Solver | None) -> Solver:
    """The solver asked for, if it can solve this joint, or the best one that can."""
    if solver is None:
        solver = "series" if joint.series_applies else "quadratic"
    checks.choice("solver", solver, SOLVERS)
    if solver == "series" and not joint.series_applies:
        raise ValueError(
            "solver must be quadratic or linear for this joint: the series needs ball_drive "
            f"plane, rim mirror and kinematics small or linear, got {joint.ball_drive}, "
            f"{joint.rim} and {joint.kinematics}"
        )
    if solver == "linear" and joint.kinematics == "finite":
        raise ValueError("solver must be quadratic for kinematics finite, got 'linear'")
    return solver


def checked_resolution(joint: Joint, solver: Solver, resolution: int | None) -> int:
    """Elements along the surface, as asked for or as usual, if this joint can be solved so."""
    least, most = 32, FINEST_RESOLUTION
    kind: str = solver
    if solver != "series":
        from study.joint import fem

        ratios = layer_ratios(joint.socket_layers[0], fem.THINNEST_RATIO)
        least, most = 64 if layer_steps(ratios).min() < 1.05 else 32, fem.FINEST_RESOLUTION
        kind = "quadratic"
    if joint.kinematics == "finite":
        checks.number("r2_star", joint.r2_star, most=pairing.LARGEST_R2_STAR)
        kind = "finite"
    resolution = RESOLUTION[kind] if resolution is None else resolution
    resolution = checks.whole("resolution", resolution, least=least, most=most)
    if resolution % 32:
        raise ValueError(f"resolution must be a multiple of 32, got {resolution}")
    return resolution


def _solve(joint, solver, depths, resolution):
    """Nodal angles, pressure profiles (k, n) and forces (k,) at one resolution."""
    if joint.kinematics == "finite":
        from study.joint import fem

        of_ball, of_socket = meshed(joint, resolution)
        ball, socket = fem.ball(*of_ball), fem.socket(*of_socket)
        angles = ball.compliance.angles
        return angles, *pairing.solve_finite(joint, depths, ball, socket)
    ball, socket = compliances(joint, solver, resolution)
    paired = pairing.small if joint.kinematics == "small" else pairing.linear
    return ball.angles, *pairing.solve(joint, depths, *paired(joint, ball, socket))


def compliances(
    joint: Joint, solver: Solver | None, resolution: int, orders: int | None = None
) -> tuple[Compliance, Compliance]:
    """Compliances of ball and socket by a solver; by default of each by the series if it can be.

    The series ends at ``orders`` an element, by default at 10,000 or `series.ORDERS` an element.
    """
    usual = max(series.LAST_ORDER, series.ORDERS * resolution)
    last_order = orders * resolution if orders else usual
    ball: Compliance | None = None
    socket: Compliance | None = None
    if joint.ball_drive == "plane" and solver in (None, "series"):
        ball = series.ball_compliance(joint.ball.poisson, resolution, last_order)
    if joint.rim == "mirror" and solver in (None, "series"):
        ratio, poisson, modulus = joint.socket_layers
        socket = series.socket_compliance(ratio, poisson, resolution, last_order, modulus)
    if ball is None or socket is None:
        from study.joint import fem

        of_ball, of_socket = meshed(joint, resolution, 3 if solver == "linear" else 6)
        ball = fem.ball_compliance(*of_ball) if ball is None else ball
        socket = fem.socket_compliance(*of_socket) if socket is None else socket
    return ball, socket


def meshed(joint: Joint, resolution: int, nodes: int = 6) -> tuple[tuple, tuple]:
    """Arguments of the finite-element ball and socket."""
    ratio, poisson, modulus = joint.socket_layers
    return (
        (joint.ball.poisson, joint.ball_drive, resolution, nodes),
        (ratio, poisson, joint.rim, resolution, nodes, modulus),
    )


def _edge(angles, pressure):
    """Polar angle where the pressure ends: a root of its square, to about 0.3 %.

    Pressure falls like the square root of the distance to the edge, so that its square is
    smooth and a cubic in cos(angle) fits it, without the last two nodes, which oscillate. A
    contact of few nodes gets a lower degree, one of very few the middle beyond its last node.
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
