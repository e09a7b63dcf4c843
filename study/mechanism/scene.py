"""The crank-slider of the paper's section 4.3: what the paper states, and what this study assumes.

Tables 3 and 4 state lengths, masses, clearance, material, restitution, friction and drive. Every
field of `Scene` has its unit, its range and its source.
"""

from collections import namedtuple
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from math import hypot, pi
from typing import TYPE_CHECKING, Any, Literal, get_args

from study import checks
from study.contact import Material, composite_modulus, material
from study.contact.damping import Damping, damping_factor, delivered_restitution

if TYPE_CHECKING:
    import pandas as pd

Body = Literal["crank", "coupler"]
PAPER_DAMPING: Damping = "lankarani-nikravesh"
ROD = "assumed, uniform rod about its centre, m L^2/12"
Constants = namedtuple(
    "Constants",
    "l1 l2 a11 a22 a12 m3 moment g1 g2 gravity r1 clearance damping friction v0 v1 steady "
    "j1 own_g1 m2 i2 crank_r1",
)
"""What compiled functions know of a scene, in SI units, with rigid links as a double pendulum.
``steady`` is 1 for a crank of constant speed. For free links: the crank's inertia about its axis
and the moment of its own weight, the coupler's mass and inertia, and the radius of the crank's
ball."""
Link = namedtuple("Link", "length mass_per_length rotary_per_length axial shear bending")
"""Beam properties of a flexible link, all SI: stiffnesses EA, k GA (k = 5/6), EI."""


def _quantity(default: Any, unit: str, source: str, **limits: float) -> Any:
    """Field of the scene; ``limits`` as for ``study.checks.number``."""
    return field(default=default, metadata={"unit": unit, "source": source, "limits": limits})


@dataclass(frozen=True)
class Scene:
    """A crank-slider in a plane, with its slide along +x through the crank's axis.

    The clearance joint is between coupler and slider. The ball is on the coupler's end, the socket
    in the slider, which does not turn. There may be a second one between crank and coupler, with
    the ball on the crank's end and the socket in the coupler. At t = 0 the balls are at rest in
    their sockets; by default nothing moves, and both links lie on +x. All is in SI units, see
    `parameters`. A value outside its range is a ``ValueError``.

    Attributes
    ----------
    crank_inertia, coupler_inertia
        Moment of inertia about the link's own centre; None: uniform rod.
    clearance, socket_radius
        The ball's radius is the difference.
    youngs_modulus, poisson
        Of ball, socket and links.
    ball, socket
        Materials of their own, or the name or numbers of one (`study.joint.material`); None:
        ``youngs_modulus`` and ``poisson``.
    link_modulus
        Young's modulus of the links alone; None: that of the material.
    damping
        Rule for the damping factor. Only ``exact`` delivers the restitution, of at least 0.001; the
        others are ``lankarani-nikravesh`` (the paper's), ``hunt-crossley`` and ``flores``.
    slow_speed, full_speed
        Tolerance speeds v0 and v1 of the friction law.
    gravity
        Acceleration along -y.
    crank_speed
        Constant speed at which the crank is driven, whatever moment this takes. Leave out
        ``driving_moment`` and ``initial_crank_speed`` then. None: driven by ``driving_moment``.
    initial_crank_angle, initial_crank_speed
        At t = 0, the angle from +x.
    crank_clearance
        Clearance of a second joint, between crank and coupler, for rigid links. Its socket radius,
        materials, damping and friction are those of the other joint. None: an ideal joint.
    initial_eccentricity
        Place of the ball's centre in the slider's socket at t = 0, inside the clearance.
    """

    crank_length: float = _quantity(0.05, "m", "Table 3", above=0)
    crank_mass: float = _quantity(0.3, "kg", "Table 3", above=0)
    coupler_length: float = _quantity(0.12, "m", "Table 3", above=0)
    coupler_mass: float = _quantity(0.21, "kg", "Table 3", above=0)
    slider_mass: float = _quantity(0.14, "kg", "Table 3", above=0)
    clearance: float = _quantity(5e-5, "m", "Table 3", above=0)
    youngs_modulus: float = _quantity(207e9, "Pa", "Table 4")
    poisson: float = _quantity(0.3, "1", "Table 4", above=-1, below=0.5)
    restitution: float = _quantity(0.5, "1", "Table 4")
    friction: float = _quantity(0.05, "1", "Table 4", least=0)
    slow_speed: float = _quantity(1e-4, "m/s", "Table 4", least=0)
    full_speed: float = _quantity(0.01, "m/s", "Table 4", above=0)
    driving_moment: float = _quantity(0.5, "N m", "Table 4", least=-1e6, most=1e6)
    socket_radius: float = _quantity(
        10e-3, "m", "assumed, R2* = 200, the paper's static case", above=0
    )
    crank_inertia: float | None = _quantity(None, "kg m^2", ROD, least=0)
    coupler_inertia: float | None = _quantity(None, "kg m^2", ROD, least=0)
    ball: Material | str | None = _quantity(None, "Pa, 1", "chosen here, of the ball alone")  # noqa: RUF009
    socket: Material | str | None = _quantity(None, "Pa, 1", "chosen here, of the socket alone")  # noqa: RUF009
    link_modulus: float | None = _quantity(None, "Pa", "assumed, that of ball and socket")
    density: float = _quantity(
        7850.0, "kg/m^3", "assumed, steel, with square sections from mass and length", above=0
    )
    damping: Damping = _quantity("exact", "", "chosen here, delivers the restitution")  # noqa: RUF009
    gravity: float = _quantity(0.0, "m/s^2", "assumed, none", least=-1e6, most=1e6)
    initial_eccentricity: tuple[float, float] = _quantity(
        (0.0, 0.0), "m", "assumed, concentric, and at rest"
    )
    initial_crank_angle: float = _quantity(
        0.0, "rad", "given by the paper: links on +x", least=-2 * pi, most=2 * pi
    )
    initial_crank_speed: float = _quantity(
        0.0, "rad/s", "given by the paper: from rest", least=-1e6, most=1e6
    )
    crank_speed: float | None = _quantity(None, "rad/s", "no such drive", least=-1e6, most=1e6)
    crank_clearance: float | None = _quantity(None, "m", "an ideal joint", above=0)

    def __post_init__(self) -> None:
        checks.plain_numbers(self)
        for parameter in fields(self):
            value, limits = getattr(self, parameter.name), parameter.metadata["limits"]
            name = parameter.name.replace("_", " ")
            unit = parameter.metadata["unit"].removeprefix("1")
            if value is None and parameter.default is None:
                continue
            if unit == "Pa":
                checks.youngs_modulus(name, value)
            elif limits:
                checks.number(name, value, unit, **limits, scalar=True)
            elif parameter.name in ("ball", "socket"):
                object.__setattr__(self, parameter.name, material(value))
        limits = {"least": 1e-9 * self.socket_radius, "below": self.socket_radius}
        checks.number("clearance", self.clearance, "m", **limits)
        if self.crank_clearance is not None:
            checks.number("crank clearance", self.crank_clearance, "m", **limits)
            checks.number("coupler inertia", self.inertias[1], "kg m^2", above=0)
        longest = self.coupler_length - self.clearance - (self.crank_clearance or 0.0)
        checks.number("crank length", self.crank_length, "m", below=longest)
        checks.number("slow speed", self.slow_speed, "m/s", least=0, below=self.full_speed)
        damping_factor(self.damping, self.restitution)
        for name in ("driving_moment", "initial_crank_speed"):
            if self.crank_speed is not None and getattr(self, name) != getattr(Scene, name):
                raise ValueError(f"{name.replace('_', ' ')} must be left out with a crank speed")
        pair = self.initial_eccentricity
        if not isinstance(pair, (tuple, list)) or len(pair) != 2:
            shown = checks.shown(pair)
            raise ValueError(f"initial eccentricity must be two numbers, in m, got {shown}")
        for axis, value in zip("xy", pair, strict=True):
            checks.number(f"{axis} of initial eccentricity", value, "m", scalar=True)
        inside = self.clearance - 4e-16 * self.socket_radius  # R2 - R1 is known no better
        checks.number("initial eccentricity", hypot(*pair), "m", below=inside)

    @property
    def ball_radius(self) -> float:
        """Radius of the ball, in m."""
        return self.socket_radius - self.clearance

    @property
    def materials(self) -> tuple[Material, Material]:
        """Materials of ball and socket."""
        usual = Material(self.youngs_modulus, self.poisson)
        ball, socket = (usual if own is None else material(own) for own in (self.ball, self.socket))
        return ball, socket

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
        """Restitution of a free impact with the scene's damping; ``exact``: that asked for."""
        exact = self.damping == "exact"
        return self.restitution if exact else delivered_restitution(self.damping_factor)

    @property
    def inertias(self) -> tuple[float, float]:
        """Moments of inertia of crank and coupler about their centres, in kg m^2."""
        crank = self.crank_mass * self.crank_length**2 / 12
        coupler = self.coupler_mass * self.coupler_length**2 / 12
        return (
            crank if self.crank_inertia is None else self.crank_inertia,
            coupler if self.coupler_inertia is None else self.coupler_inertia,
        )

    def has_none_of(self, *names: str) -> None:
        """Raise ``ValueError`` if a parameter is given that a model does not have."""
        for name in names:
            if getattr(self, name) != getattr(Scene, name):
                raise ValueError(f"{name.replace('_', ' ')} must be left out: this model has none")

    def link(self, body: Body) -> Link:
        """Beam of a flexible link.

        A moment of inertia below that of a thin rod, the least of a beam, is a ``ValueError``.
        """
        checks.choice("body", body, get_args(Body))
        length, mass = getattr(self, f"{body}_length"), getattr(self, f"{body}_mass")
        rod, own = mass * length**2 / 12, self.inertias[get_args(Body).index(body)]
        name, least = f"{body} inertia of a flexible link", rod * (1 - 1e-12)
        checks.number(name, own, "kg m^2", least=least)
        modulus, area = self.link_modulus or self.youngs_modulus, mass / (self.density * length)
        return Link(
            length=length,
            mass_per_length=mass / length,
            rotary_per_length=max(own - rod, 0.0) / length,
            axial=modulus * area,
            shear=5 / 6 * modulus / (2 * (1 + self.poisson)) * area,
            bending=modulus * area**2 / 12,
        )

    def constants(self) -> Constants:
        """Numbers of the scene for the compiled functions."""
        i1, i2 = self.inertias
        m1, m2, l1, l2 = self.crank_mass, self.coupler_mass, self.crank_length, self.coupler_length
        g = self.gravity
        rods = l1, l2, i1 + m1 * l1**2 / 4 + m2 * l1**2, i2 + m2 * l2**2 / 4, m2 * l1 * l2 / 2
        moment = self.driving_moment if self.crank_speed is None else 0.0
        loads = self.slider_mass, moment, (m1 / 2 + m2) * g * l1, m2 * g * l2 / 2, g
        joint = self.ball_radius, self.clearance, self.damping_factor, self.friction
        drive = self.slow_speed, self.full_speed, self.crank_speed is not None
        ball = self.socket_radius - (self.crank_clearance or 0.0)
        free = i1 + m1 * l1**2 / 4, loads[2] - m2 * g * l1, m2, i2, ball
        return Constants(*map(float, (*rods, *loads, *joint, *drive, *free)))

    def parameters(self) -> "pd.DataFrame":
        """Every parameter: where the paper states it, or what this study assumes instead.

        Columns parameter, value (as text), unit, table, source. What the scene does not have is
        left out: a second clearance joint, a constant speed, or the moment that this replaces.
        """
        import pandas as pd

        values = {parameter.name: getattr(self, parameter.name) for parameter in fields(self)}
        values["crank_inertia"], values["coupler_inertia"] = self.inertias
        values["link_modulus"] = self.link_modulus or self.youngs_modulus
        values["initial_eccentricity"] = hypot(*self.initial_eccentricity)
        if self.crank_speed is not None:
            values["driving_moment"] = values["initial_crank_speed"] = None
        rows = []
        for parameter, value in zip(fields(self), values.values(), strict=True):
            if value is None:  # what the scene does not have
                continue
            if isinstance(value, Material):
                value = f"{value.youngs_modulus:.9g}, {value.poisson:.9g}"
            text = value if isinstance(value, str) else f"{value:.9g}"
            unit, source = parameter.metadata["unit"], parameter.metadata["source"]
            if parameter.name == "damping" and value != parameter.default:
                source = "given by the paper, Eq. 31" if value == PAPER_DAMPING else "chosen here"
            where = (source, "given by the paper") if "Table" in source else ("-", source)
            rows.append((parameter.name.replace("_", " "), text, unit, *where))
        return pd.DataFrame(rows, columns=["parameter", "value", "unit", "table", "source"])

    @classmethod
    def read(cls, texts: Mapping[str, str], **others: Any) -> "Scene":
        """Scene from texts, such as a command's options or the cells of a table.

        ``others`` are values for parameters without a text.
        """
        kinds = {parameter.name: type(parameter.default) for parameter in fields(cls)}
        values = dict(others)
        for name, text in texts.items():
            if kinds[name] is tuple:
                values[name] = checks.read_several(name, text)
            elif kinds[name] is str or name in ("ball", "socket"):
                values[name] = text
            else:
                values[name] = checks.read(name, text)
        return cls(**values)

    def replace(self, **changes: Any) -> "Scene":
        """Copy with some attributes changed."""
        return replace(self, **changes)


def paper_scene(**changes: Any) -> Scene:
    """The paper's scene, whose damping delivers another restitution; ``changes`` are of `Scene`."""
    return Scene(**({"damping": PAPER_DAMPING} | changes))
