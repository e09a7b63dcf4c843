"""The crank-slider of the paper's section 4.3: what its Tables 3 and 4 state, and assumptions."""

from collections import namedtuple
from dataclasses import dataclass, replace
from math import hypot, pi
from typing import Any, get_args

from study import checks, parameters
from study.contact import Material, composite_modulus, material
from study.contact.forces import Damping, damping_factor, delivered_restitution
from study.contact.materials import read_material
from study.mechanism import loads
from study.parameters import parameter

LINKS = ("crank", "coupler")
PAPER_DAMPING: Damping = "lankarani-nikravesh"
LARGE: dict[str, Any] = {"least": -1e6, "most": 1e6}  # limits of numbers of either sign
OF_ROD: dict[str, Any] = {
    "otherwise": "that of a thin uniform rod",
    "source": "assumed, thin uniform rod about its centre, m L^2/12",
}
_NUMBERS = "l1 l2 a11 a22 a12 m2 m3 moment g1 g2 r1 clearance damping friction v0 v1 steady"
_record: Any = namedtuple  # mypy knows no computed names of fields
Constants = _record("Constants", f"{_NUMBERS} {' '.join(loads.PARAMETERS)}")
"""What compiled functions know of a scene, in SI units, with rigid links as a double pendulum.
``steady`` is 1 for a crank of constant speed."""
Link = namedtuple("Link", "length mass_per_length rotary_per_length axial shear bending")
"""Beam properties of a flexible link, all SI: stiffnesses EA, k GA (k = 5/6), EI."""


def _material_of(body: str) -> Any:
    return parameter(
        None,
        f"Material of the {body}, by name or by Young's modulus and Poisson's ratio",
        "Pa, 1",
        kind=Material,
        parse=read_material,
        otherwise="youngs_modulus and poisson",
        source=f"chosen here, of the {body} alone",
    )


@dataclass(frozen=True)
class Scene:
    """Mechanism parameters of a planar crank-slider, in SI units.

    The slide lies along +x and passes through the axis of the crank. The clearance joint is between
    coupler and slider: the ball is at the end of the coupler, and the socket is in the slider,
    which does not rotate. The ball is at rest relative to its socket at t = 0. The defaults are
    those of Yao et al., and for what they do not state those of this study. ``study simulate
    --help`` explains each parameter, and its field has the source of the default.

    Parameters
    ----------
    crank_length, coupler_length : float, in m, default 0.05 and 0.12
    crank_mass, coupler_mass, slider_mass : float, in kg, default 0.3, 0.21 and 0.14
    clearance, socket_radius : float, in m, default 5e-5 and 0.01
    youngs_modulus, poisson : float, in Pa and without unit, default 207e9 and 0.3
    restitution, friction : float, default 0.5 and 0.05
    slow_speed, full_speed : float, in m/s, default 1e-4 and 0.01
    driving_moment : float, in N m, default 0.5
    crank_inertia, coupler_inertia : float, in kg m^2, optional
    ball, socket : Material or str, optional
    link_modulus, density : float, in Pa and kg/m^3, default youngs_modulus and 7850
    damping : {"exact", "lankarani-nikravesh", "hunt-crossley", "flores"}, default "exact"
    gravity : float, in m/s^2, default 0
    initial_eccentricity : tuple of two floats, in m, default (0, 0)
    initial_crank_angle, initial_crank_speed : float, in rad and rad/s, default 0
    crank_speed : float, in rad/s, optional

    Raises
    ------
    ValueError
        If a value is outside its range.

    Examples
    --------
    >>> scene = Scene(clearance=1e-4, restitution=0.9)
    >>> scene.replace(friction=0).clearance
    0.0001
    """

    crank_length: float = parameter(0.05, "Length of the crank", "m", above=0, source="Table 3")
    crank_mass: float = parameter(0.3, "Mass of the crank", "kg", above=0, source="Table 3")
    coupler_length: float = parameter(0.12, "Length of the coupler", "m", above=0, source="Table 3")
    coupler_mass: float = parameter(0.21, "Mass of the coupler", "kg", above=0, source="Table 3")
    slider_mass: float = parameter(0.14, "Mass of the slider", "kg", above=0, source="Table 3")
    clearance: float = parameter(
        5e-5, "Radius of the socket less that of the ball", "m", above=0, source="Table 3"
    )
    youngs_modulus: float = parameter(
        207e9, "Young's modulus of ball, socket and links", "Pa", source="Table 4"
    )
    poisson: float = parameter(
        0.3, "Poisson's ratio of ball, socket and links", above=-1, below=0.5, source="Table 4"
    )
    restitution: float = parameter(
        0.5,
        "Coefficient of restitution; at least 0.001 for damping exact and flores",
        least=0,
        most=1,
        source="Table 4",
    )
    friction: float = parameter(0.05, "Coefficient of friction", least=0, source="Table 4")
    slow_speed: float = parameter(
        1e-4, "Sliding speed v0, below which there is no friction", "m/s", least=0, source="Table 4"
    )
    full_speed: float = parameter(
        0.01, "Sliding speed v1, above which the friction is full", "m/s", above=0, source="Table 4"
    )
    driving_moment: float = parameter(
        0.5, "Moment that drives the crank", "N m", **LARGE, source="Table 4"
    )
    socket_radius: float = parameter(
        10e-3,
        "Radius of the socket",
        "m",
        above=0,
        source="assumed, R2* = 200, the paper's static case",
    )
    crank_inertia: float | None = parameter(
        None, "Moment of inertia of the crank about its centre", "kg m^2", least=0, **OF_ROD
    )
    coupler_inertia: float | None = parameter(
        None, "Moment of inertia of the coupler about its centre", "kg m^2", least=0, **OF_ROD
    )
    ball: Material | str | None = _material_of("ball")
    socket: Material | str | None = _material_of("socket")
    link_modulus: float | None = parameter(
        None,
        "Young's modulus of the links alone",
        "Pa",
        otherwise="youngs_modulus",
        source="assumed, that of ball and socket",
    )
    density: float = parameter(
        7850.0,
        "Density of the links, whose sections are squares",
        "kg/m^3",
        above=0,
        source="assumed, steel, with square sections from mass and length",
    )
    damping: Damping = parameter(
        "exact",
        "Model of the damping factor; with exact an impact has the given coefficient of "
        "restitution, and lankarani-nikravesh is the model of Yao et al.",
        choices=get_args(Damping),
        source="chosen here, delivers the restitution",
    )
    gravity: float = parameter(
        0.0, "Acceleration along -y", "m/s^2", **LARGE, source="assumed, none"
    )
    initial_eccentricity: tuple[float, float] = parameter(
        (0.0, 0.0),
        "Eccentricity at t = 0: vector from the centre of the slider's socket to the centre of the "
        "ball, shorter than the clearance",
        "m",
        several=",",
        count=2,
        source="assumed, concentric, and at rest",
    )
    initial_crank_angle: float = parameter(
        0.0,
        "Angle of the crank from +x at t = 0",
        "rad",
        least=-2 * pi,
        most=2 * pi,
        source="given by the paper: links on +x",
    )
    initial_crank_speed: float = parameter(
        0.0, "Speed of the crank at t = 0", "rad/s", **LARGE, source="assumed, from rest"
    )
    crank_speed: float | None = parameter(
        None,
        "Constant speed of the crank, which replaces driving_moment and initial_crank_speed",
        "rad/s",
        **LARGE,
        source="no such drive",
    )
    # parameters of further loads

    def __post_init__(self) -> None:
        parameters.take(self)
        for body in ("ball", "socket"):
            if getattr(self, body) is not None:
                material(getattr(self, body), body)
        largest = self.socket_radius
        checks.number("clearance", self.clearance, "m", least=1e-9 * largest, below=largest)
        longest = self.coupler_length - self.clearance
        checks.number("crank_length", self.crank_length, "m", below=longest)
        checks.number("slow_speed", self.slow_speed, "m/s", below=self.full_speed)
        damping_factor(self.damping, self.restitution)
        for name in ("driving_moment", "initial_crank_speed"):
            if self.crank_speed is not None and getattr(self, name) != getattr(Scene, name):
                raise ValueError(
                    f"{name} does not apply to a crank of constant crank_speed; remove one of them"
                )
        inside = self.clearance - 4e-16 * self.socket_radius  # R2 - R1 is known no better
        checks.number("initial_eccentricity", hypot(*self.initial_eccentricity), "m", below=inside)

    @property
    def ball_radius(self) -> float:
        """Radius of the ball, in m."""
        return self.socket_radius - self.clearance

    @property
    def materials(self) -> tuple[Material, Material]:
        """Materials of ball and socket."""
        usual = Material(self.youngs_modulus, self.poisson)
        return material(self.ball or usual), material(self.socket or usual)

    @property
    def starting_speed(self) -> float:
        """Speed of the crank at t = 0, in rad/s."""
        return self.initial_crank_speed if self.crank_speed is None else self.crank_speed

    @property
    def composite_modulus(self) -> float:
        """Composite modulus of ball and socket, in Pa."""
        ball, socket = self.materials
        bodies = ball.youngs_modulus, ball.poisson, socket.youngs_modulus, socket.poisson
        return composite_modulus(*bodies)

    @property
    def damping_factor(self) -> float:
        """Factor D of the damping term."""
        return damping_factor(self.damping, self.restitution)

    @property
    def delivered_restitution(self) -> float:
        """Coefficient of restitution of a free impact with the damping model of the scene."""
        exact = self.damping == "exact"
        return self.restitution if exact else delivered_restitution(self.damping_factor)

    @property
    def inertias(self) -> tuple[float, float]:
        """Moments of inertia of crank and coupler about their centres, in kg m^2."""
        crank = self.crank_inertia, self.crank_mass, self.crank_length
        coupler = self.coupler_inertia, self.coupler_mass, self.coupler_length
        i1, i2 = (m * size**2 / 12 if i is None else i for i, m, size in (crank, coupler))
        return i1, i2

    def link(self, body: str) -> Link:
        """Beam of a flexible link; an inertia below a thin rod's is a ``ValueError``."""
        length, mass = getattr(self, f"{body}_length"), getattr(self, f"{body}_mass")
        rod, own = mass * length**2 / 12, self.inertias[LINKS.index(body)]
        name, least = f"{body} inertia of a flexible link", rod * (1 - 1e-12)
        checks.number(name, own, "kg m^2", least=least)
        modulus, area = self.link_modulus or self.youngs_modulus, mass / (self.density * length)
        shear, bending = 5 / 6 * modulus / (2 * (1 + self.poisson)) * area, modulus * area**2 / 12
        masses = mass / length, max(own - rod, 0.0) / length
        return Link(length, *masses, axial=modulus * area, shear=shear, bending=bending)

    def constants(self) -> Any:
        """Numbers of the scene for the compiled functions."""
        i1, i2 = self.inertias
        m1, m2, l1, l2 = self.crank_mass, self.coupler_mass, self.crank_length, self.coupler_length
        g, steady = self.gravity, self.crank_speed is not None
        links = {"l1": l1, "l2": l2, "m2": m2, "m3": self.slider_mass, "r1": self.ball_radius}
        inertias = {"a11": i1 + m1 * l1**2 / 4 + m2 * l1**2, "a22": i2 + m2 * l2**2 / 4}
        weights = {"g1": (m1 / 2 + m2) * g * l1, "g2": m2 * g * l2 / 2}
        drive = {"moment": 0.0 if steady else self.driving_moment, "steady": float(steady)}
        joint = {"clearance": self.clearance, "damping": self.damping_factor}
        friction = {"friction": self.friction, "v0": self.slow_speed, "v1": self.full_speed}
        of_loads = {name: getattr(self, name) for name in loads.PARAMETERS}
        pendulum = inertias | weights | {"a12": m2 * l1 * l2 / 2}
        return Constants(**links, **pendulum, **drive, **joint, **friction, **of_loads)

    def replace(self, **changes: Any) -> "Scene":
        """Copy with some attributes changed."""
        return replace(self, **changes)


def paper_scene(**changes: Any) -> Scene:
    """Mechanism parameters with the damping model of Yao et al., and other ``changes``.

    With this model an impact delivers another coefficient of restitution than the given one.
    """
    return Scene(**({"damping": PAPER_DAMPING} | changes))
