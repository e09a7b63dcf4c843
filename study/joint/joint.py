"""The spherical clearance joint, and what can be asked of it.

A `Joint` is made of sizes and materials in SI units, of ratios, or of named values as commands and
tables have them. `reference_joint` is the paper's, as far as it can be known. The elastic solution
is found by `study.joint.axial` along the axis of the socket, and by `study.joint.tilted` in other
directions.
"""

from __future__ import annotations  # so that help() shows ArrayLike and not its definition

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from study import checks, parameters
from study.contact import SOCKET_RATIO, DimensionalLaw, Material, Table
from study.contact.laws import AnyLaw, find
from study.contact.materials import in_words
from study.contact.power_fit import DEPTHS, USUAL_RANGE, PowerFit, fit_power
from study.joint import axial, stress, tilted
from study.joint.compliance import THICKEST_RATIO, THINNEST_RATIO, layer_steps
from study.joint.description import (
    LARGEST_MODULUS_RATIO,
    LARGEST_R2_STAR,
    LEAST_R2_STAR,
    SUPPORTS,
    TOO_LOOSE,
    UNIT,
    JointDescription,
    Layer,
    Liner,
    read_layer,
)
from study.joint.kinematics import UnresolvedError
from study.joint.solution import Solution
from study.joint.supports import ClampedPlate
from study.parameters import Parameter

_AROUND = 2.0  # maximum depth of a power law over that of the loads, and so for the minimum
_STEP, _NARROWEST = 1.1, 0.02  # from one maximum depth of a narrow socket to the next; the last one


class Joint(JointDescription):
    """A spherical clearance joint, in SI units.

    `solve` gives the elastic solution at given depths or under given forces, `curve` the
    force-depth curve, `law` a contact law, and `power_law` the constants of F = k d^n.
    `of` makes a joint from texts or from the dimensions of a bearing catalogue, and `from_ratios`
    one without dimensions from ratios.

    Parameters
    ----------
    socket_radius, clearance, wall : float
        Inner radius of the socket, that radius less the radius of the ball, and wall thickness of
        the socket including its liners, in m.
    ball, socket : Material or str, default "bearing steel" and "steel"
        A name, or Young's modulus, Poisson's ratio and yield stress, as in "210GPa,0.3,500MPa".
    liner : tuple of Liner or str, default ()
        Liners from the inside out, as in "0.5mm,PTFE", separated by semicolons in a text.
    ball_support : BallSupport or str, default "guided"
        Half a ball on a plate: "guided" or "clamped". A whole ball: "core:0.2" (over its radius),
        "neck:30" (deg), "pin:6mm,16mm" (radius, width of the ball) or "bore:0.5,45".
    rim : {"mirror", "free"}, optional
        Edge of the socket. By default "mirror" for half a ball in a hemisphere, else "free".
    kinematics : {"linear", "small"}, default "linear"
        Points of the surfaces that are paired: after the ball has moved, or at equal polar angles.
    opening : Opening, float or str, default 90
        Polar angle of the rim in deg, 20 to 170; or those of both rims of a ring, "55:125".
    socket_support : SocketSupport or str, default "outside"
        Where the socket is held: "outside", "rim", or "sector:0,30" (polar angles in deg).

    Raises
    ------
    ValueError
        If a value is outside its range.

    Examples
    --------
    >>> joint = Joint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="bronze")
    >>> solution = joint.solve(force=3000)
    >>> print(f"{solution.depth[0]:.4g} m, {solution.peak_pressure[0] / 1e6:.4g} MPa")
    4.232e-06 m, 74.38 MPa
    """

    @classmethod
    @parameters.describe(
        r2_star=Parameter(
            "Radius of the socket divided by the clearance, R2/dR",
            limits={"least": LEAST_R2_STAR, "most": LARGEST_R2_STAR},
            otherwise="200",
        ),
        socket_ratio=Parameter(
            "Outer radius of the socket divided by its inner radius",
            limits={"least": THINNEST_RATIO, "most": THICKEST_RATIO},
            otherwise="1.298",
        ),
        modulus_ratio=Parameter(
            "Young's modulus of the socket divided by that of the ball",
            limits={"least": 1 / LARGEST_MODULUS_RATIO, "most": LARGEST_MODULUS_RATIO},
            otherwise="1",
        ),
        poisson=Parameter(
            "Poisson's ratio of the ball", limits={"above": -1, "below": 0.5}, otherwise="0.3"
        ),
        socket_poisson=Parameter(
            "Poisson's ratio of the socket",
            limits={"above": -1, "below": 0.5},
            otherwise="that of the ball",
        ),
        layers=Parameter(
            "Layer of the socket, as three numbers N,N,N: its outer radius divided by R2, its "
            "Young's modulus divided by that of the ball, and its Poisson's ratio; may be repeated "
            "for several layers, from the inside out",
            parse=read_layer,
            kind=Layer,
            several=";",
        ),
    )
    def from_ratios(
        cls,
        r2_star: float = 200.0,
        socket_ratio: float | None = None,
        *,
        modulus_ratio: float | None = None,
        poisson: float | None = None,
        socket_poisson: float | None = None,
        layers: tuple[Layer, ...] = (),
        ball: Material | None = None,
        socket: Material | None = None,
        **supports: Any,
    ) -> Joint:
        """Joint described by ratios: R2 is 1 m, and Young's modulus of the ball 2e11 Pa.

        Parameters
        ----------
        r2_star : float, default 200
            Radius of the socket divided by the clearance.
        socket_ratio, modulus_ratio : float, default 1.298 and 1
            Outer over inner radius of the socket, and its Young's modulus over that of the ball.
        poisson, socket_poisson : float, default 0.3
            Poisson's ratios of ball and socket; the socket's is that of the ball if not given.
        layers : tuple of Layer or str, default ()
            Layers of the socket instead of its ratios, as in "1.1,0.01,0.4;1.5,1,0.3".
        ball, socket : Material, optional
            Materials that replace the ratios of the materials.
        **supports
            The arguments of `Joint` from ``ball_support`` on.

        Raises
        ------
        ValueError
            If a value is outside its range, or does not apply to a socket with layers.

        Examples
        --------
        >>> joint = Joint.from_ratios(200, modulus_ratio=0.5, ball_support="clamped")
        >>> joint.rim, joint.socket.youngs_modulus
        ('mirror', 100000000000.0)
        """
        if checks.number("r2_star", r2_star, scalar=True) < LEAST_R2_STAR:
            raise checks.RangeError(
                f"r2_star must be >= {LEAST_R2_STAR:g}, got {r2_star:g}; {TOO_LOOSE}"
            )
        about = parameters.described(cls.from_ratios)
        values = r2_star, socket_ratio, modulus_ratio, poisson, socket_poisson
        given: dict[str, Any] = dict(zip(about, values, strict=False))
        given = {n: about[n].taken(n, value) for n, value in given.items() if value is not None}
        layers = about["layers"].taken("layers", layers)
        for name in ("modulus_ratio", "socket_poisson", "socket_ratio"):
            if layers and name in given:
                raise ValueError(
                    f"{name} does not apply to a joint with layers, which describe the socket; "
                    "remove it"
                )
        if ball is None:
            ball = Material(UNIT, given.get("poisson", 0.3))
        if socket is None:
            modulus = given.get("modulus_ratio", 1.0) * ball.youngs_modulus
            poisson = given.get("socket_poisson", ball.poisson)
            socket = Material(modulus, poisson, ball.yield_stress)
        outer = [given.get("socket_ratio", SOCKET_RATIO)]
        if layers:
            outer, socket = [of.outer_ratio for of in layers], layers[-1].material
            steps = layer_steps(np.array(outer))
            name = "outer radius of a layer divided by its inner radius"
            checks.number(name, steps, least=THINNEST_RATIO, most=THICKEST_RATIO)
        thick = np.diff([1.0, *outer[:-1]]).tolist()
        liner = tuple(Liner(t, of.material) for t, of in zip(thick, layers, strict=False))
        sizes = 1.0, 1 / given["r2_star"], outer[-1] - 1.0
        return cls(*sizes, ball, socket, liner, **supports, has_dimensions=False)

    @classmethod
    def of(cls, **values: Any) -> Joint:
        """Joint from the values of options, which include the dimensions of catalogues.

        Parameters
        ----------
        **values
            Options of ``study joint`` that describe a joint, with underscores in their names, as
            numbers in SI units or as texts such as "29mm": arguments of `Joint` or `from_ratios`,
            or the dimensions of a catalogue (`study.joint.bearings.FROM_CATALOGUE`).

        Raises
        ------
        ValueError
            If a value is missing or outside its range, or if two values contradict each other.

        Examples
        --------
        >>> sizes = {"ball_diameter": "29mm", "outer_diameter": "35mm", "outer_width": "12mm"}
        >>> joint = Joint.of(**sizes, bore="20mm", inner_width="16mm", play="61um")
        >>> print(f"{joint.clearance:g}", joint.opening)
        3.05e-05 65.611317:114.388683
        >>> Joint.of(bearing="GE 20 E", socket="steel") == joint
        True
        """
        from study.joint.options import joint_of  # late: it makes options from this class

        return joint_of(values)

    def arguments(self) -> dict[str, Any]:
        """Arguments of `Joint` or `from_ratios` that are not the default.

        They are texts, and numbers of 9 digits. Materials are given by their numbers, because the
        table of materials may change.
        """
        about, default = parameters.described(Joint), parameters.defaults(Joint)
        if self.has_dimensions:
            given = {name: getattr(self, name) for name in about}
        else:
            given = {"r2_star": self.r2_star, "poisson": self.ball.poisson}
            if self.liner:
                given["layers"] = self.columns()["layers"]
            else:
                given |= {name: getattr(self, name) for name in ("socket_ratio", "modulus_ratio")}
                given["socket_poisson"] = self.socket.poisson
            default = {"r2_star": 200.0, "poisson": 0.3} | {n: default[n] for n in SUPPORTS}
            order = parameters.described(Joint.from_ratios)
            given = {name: given[name] for name in order if name in given} | self.supports
        written: dict[str, Any] = {}
        for name, value in given.items():
            if value is None or value == default.get(name, ...):
                continue
            is_number = isinstance(value, float)
            of = about.get(name, about["rim"])
            written[name] = float(f"{value:.9g}") if is_number else of.written(value)
        return written

    def __str__(self) -> str:
        shown = {name: str(value) for name, value in self.arguments().items()}
        made = "Joint"
        if self.has_dimensions:
            shown |= {name: in_words(getattr(self, name)) for name in ("ball", "socket")}
        else:
            made, shown = "Joint.from_ratios", {"r2_star": f"{self.r2_star:.9g}"} | shown
        return f"{made}({', '.join(f'{name}={text}' for name, text in shown.items())})"

    def solve(
        self,
        *,
        depth: ArrayLike | None = None,
        force: ArrayLike | None = None,
        depth_star: ArrayLike | None = None,
        tilt: ArrayLike | None = None,
        resolution: int | None = None,
        solver: axial.Solver | None = None,
        stresses: bool = False,
    ) -> Solution:
        """Elastic solution at given penetration depths or under given contact forces.

        New bodies take a tenth of a second by the series and some seconds by finite elements. A
        depth then takes some milliseconds along the axis, and a tenth of a second off it.

        Parameters
        ----------
        depth, force, depth_star
            Penetration depths in m, forces in N, or depths divided by the clearance, > 0: one
            number or shape (k,). Exactly one of the three must be given.
        tilt
            Angle in deg between the axis and the displacement, if depths are given, or the force,
            if forces are given, from 0 to 170: one number or shape (k,). The default is a load
            along the axis, or 90 deg for a ring or a ball with a bore.
        resolution
            Elements along a quarter circle. Along the axis it is a multiple of 32, by default 320
            for the series and 160 for finite elements. Off the axis it is a multiple of 16 from 32
            to 96, by default 48. Half of it is solved too.
        solver
            Along the axis: ``series`` for the Legendre series, or finite elements with six-node
            (``quadratic``) or three-node (``linear``) triangles. Forces of three-node triangles,
            which Yao et al. use, are not extrapolated, to show what such a mesh gives. The default
            is the series where it applies (ball support ``guided``, rim ``mirror``), else six-node
            triangles.
        stresses
            Whether the maximum von Mises stress in each body is computed.

        Raises
        ------
        ValueError
            If the contact along the axis would reach the rim of the socket, if it is too small for
            the elements to resolve, if the joint or a value is not suited to the load, or if not
            exactly one of depth, force and depth_star is given.
        study.joint.complementarity.ComplementarityError
            If the contact problem does not converge.

        Examples
        --------
        >>> joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
        >>> joint.solve(depth=[2e-6, 4e-6]).force.round()
        array([ 859., 2730.])
        """
        scales = {"depth": self.clearance, "force": self.force_unit, "depth_star": 1.0}
        values: dict[str, Any] = {"depth": depth, "force": force, "depth_star": depth_star}
        names = [name for name, value in values.items() if value is not None]
        if len(names) != 1:
            raise ValueError(
                "exactly one of depth, force and depth_star must be given, got "
                f"{' and '.join(names) or 'none'}"
            )
        (name,), tilt = names, self.default_tilt if tilt is None else tilt
        unit = {"depth": "m", "force": "N"}.get(name, "")
        asked = np.atleast_1d(checks.number(name, values[name], unit, above=0))
        if asked.ndim != 1 or asked.size == 0:
            raise ValueError(f"{name} must be one number or a list, got shape {asked.shape}")
        star, is_force = asked / scales[name], name == "force"
        if tilt is not None and solver is not None:
            raise ValueError("solver does not apply to a load off the axis; remove it")
        try:
            if tilt is None:
                solution = axial.solve(self, star, is_force, resolution, solver)
                return stress.added(solution) if stresses else solution
            found = tilted.solve(self, star, is_force, resolution, tilt, stresses)
            return stress.added_off_axis(found) if stresses else found.solution
        except checks.RangeError as error:  # which is in clearances
            text = str(error)
            if name != "depth_star" and not text.startswith(f"{name} must"):
                text += f" ({name} given: {', '.join(f'{one:g}' for one in asked)} {unit})"
            raise type(error)(" ".join([*self.warnings, text])) from None

    def curve(
        self,
        deepest: float | None = None,
        tilt: float | None = None,
        resolution: int | None = None,
        *,
        stresses: bool = False,
    ) -> Solution:
        """Force-depth curve up to a maximum depth, with pressures.

        Along the axis there are 48 depths from a contact of 8 elements on (at 0.0004 clearances by
        the series), and off it 9 from a sixteenth of the maximum on, in equal steps of sqrt(depth).

        Parameters
        ----------
        deepest
            Maximum depth in clearances. The default is 1, or less if the contact of a narrow socket
            cannot be so deep.
        tilt, resolution, stresses
            As in `solve`; one tilt.
        """
        tilt = self.default_tilt if tilt is None else tilt
        last = self.default_depth if deepest is None else deepest
        while tilt is None:  # the rim of a narrow socket may be nearer than one clearance
            try:
                self.solve(depth_star=last, resolution=resolution)
                break
            except checks.RangeError as error:
                is_rim = deepest is None and not isinstance(error, UnresolvedError)
                if not is_rim or last < _NARROWEST:
                    raise
                last /= _STEP
        depths = (axial if tilt is None else tilted).depths_of_curve(self, last, resolution)
        return self.solve(depth_star=depths, tilt=tilt, resolution=resolution, stresses=stresses)

    def table(
        self,
        deepest: float | None = None,
        tilt: float | None = None,
        resolution: int | None = None,
    ) -> Table:
        """Table of the elastic solution as a contact law; arguments are those of `curve`.

        Along the axis it has the depths at which nodes of the mesh close (`axial.at_nodes`), off it
        those of `curve`. Its ``curve`` is the `Solution` there. Its ``error`` is the relative error
        of the interpolated force: an eighth of the maximum difference at every second depth to the
        table of the others, because halved intervals reduce a cubic spline's error by at least 8.
        """
        return table_of(self, deepest, tilt, resolution)

    def law(self, law: AnyLaw = "tabulated", tilt: float | None = None) -> DimensionalLaw:
        """Contact law of this joint, in SI units.

        Parameters
        ----------
        law
            Name of a law, or a law itself. By default it is the `table` of the elastic solution of
            this joint. ``stiffened_hertz`` is looked up for the joint and ``power`` fitted to it;
            the coefficients of the other laws are those of the reference joint of the study.
        tilt
            Angle in deg between displacement and axis. The law is then the table of the force along
            a displacement in this direction.

        Examples
        --------
        >>> joint = Joint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3)
        >>> law = joint.law("stiffened_hertz")
        >>> print(f"{law.force(4e-6):.0f} N, {law.stiffness(4e-6):.3g} N/m")
        3479 N, 1.42e+09 N/m
        """
        tilt = self.default_tilt if tilt is None else tilt
        if tilt is not None and law != "tabulated":
            raise ValueError(
                "law must be the table of the elastic solution for a load off the axis, got "
                f"{law}; remove law, or use the fitted power law of power_law"
            )
        return DimensionalLaw(
            find(law, self) if tilt is None else self.table(tilt=tilt),
            ball_radius=self.ball_radius,
            socket_radius=self.socket_radius,
            composite_modulus=self.composite_modulus,
            joint=self,
        )

    def depths_around(self, depth: ArrayLike) -> tuple[float, float]:
        """Range for a power law around depths in m: half the minimum to twice the maximum.

        The ends have 4 digits. The upper end is limited to the default maximum depth of the joint,
        or to the maximum of the given depths if this is larger.
        """
        depth = checks.number("depth", depth, "m", above=0)
        if np.size(depth) == 0:
            raise ValueError("depth must have one value or more, got none")
        last = np.max(depth)
        high = max(last, min(_AROUND * last, self.default_depth * self.clearance))
        return float(f"{np.min(depth) / _AROUND:.4g}"), float(f"{high:.4g}")

    def power_law(
        self, depths: tuple[float, float] | None = None, tilt: float | None = None
    ) -> PowerFit:
        """Power law F = k d^n, fitted to the elastic solution (`study.contact.power_fit`).

        Parameters
        ----------
        depths
            Minimum and maximum penetration depth in m, such as those of `depths_around`. The
            default is 0.05 and 0.5 clearances.
        tilt
            Angle in deg between displacement and axis; F is then the force along the displacement.

        Examples
        --------
        >>> joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
        >>> fit = joint.power_law()
        >>> print(f"k = {fit.coefficient:.7g} N/m^n, n = {fit.exponent:.7g}, {fit.error:.2%}")
        k = 2.272481e+12 N/m^n, n = 1.652578, 1.04%
        """
        unit = self.clearance
        low, high = depths or (share * unit for share in USUAL_RANGE)
        low = checks.number("minimum depth", low, "m", above=0, scalar=True)
        high = checks.number("maximum depth", high, "m", above=low, scalar=True)
        tilt = self.default_tilt if tilt is None else tilt
        law = self.table(tilt=tilt)
        if law.deepest < high / unit:
            law = self.table(high / unit, tilt)
        places = np.geomspace(low, high, DEPTHS)
        return fit_power(places, self.force_unit * law(places / unit))


REFERENCE_SUPPORTS: dict[str, Any] = {"ball_support": ClampedPlate(), "rim": "free"}
"""How the paper's finite elements hold ball and socket: identified from its Table 2."""


def reference_joint(r2_star: float = 200, **changes: Any) -> Joint:
    """The reference joint: the configuration inferred from Table 2 of Yao et al.

    It has a clamped ball, a free rim, a socket ratio of 1.298, linear kinematics and Poisson's
    ratio 0.3 of both bodies. These were inferred from Table 2 and Fig. 14 (notebook 13), except
    for the rim, which follows from the text ("the entire external surface of the socket is fixed").

    Parameters
    ----------
    r2_star
        Radius of the socket divided by the clearance; 200 in Fig. 10 and Table 2.
    **changes
        Other arguments of `Joint.from_ratios`.
    """
    return Joint.from_ratios(r2_star, **(REFERENCE_SUPPORTS | changes))


@lru_cache(maxsize=16)
def table_of(
    joint: Joint, deepest: float | None, tilt: float | None, resolution: int | None
) -> Table:
    """Table of a joint: see `Joint.table`."""
    curve = None
    if tilt is None and joint.has_pole:
        last = joint.default_depth if deepest is None else deepest
        curve = axial.at_nodes(joint, last, resolution)
    if curve is None:
        curve = joint.curve(deepest, tilt, resolution)
    table = Table.of_curve(curve)
    if curve.depth_star[0] > curve.depth_star[-1] / 10:
        raise UnresolvedError(
            f"the maximum depth_star of a table must be >= {10 * curve.depth_star[0]:.3g}, so that "
            "elements of this size resolve the contact at a tenth of it, got "
            f"{curve.depth_star[-1]:.3g}"
        )
    half = Table.of_values(curve.depth_star[::2], curve.force_star[::2], joint.r2_star)
    apart = np.abs(half(curve.depth_star[1:-1:2]) / curve.force_star[1:-1:2] - 1)
    return replace(table, error=float(apart.max()) / 8)
