"""The crank-slider of the paper's section 4.3, in one place: what it states and what we assume.

Tables 3 and 4 state lengths, masses, clearance, material, restitution, friction and drive. The
rest is an assumption of this study, named in `ASSUMPTIONS` and open to change in `Scene`.
"""

from dataclasses import dataclass, fields, replace
from math import hypot

import pandas as pd

from study import checks
from study.contact import composite_modulus
from study.contact.damping import damping_factor

ROUNDING = 4e-16
LINKS = ("crank", "coupler")


@dataclass(frozen=True)
class Scene:
    """A crank-slider in a plane, its slide along +x, at rest at t = 0 with both links on +x.

    The clearance joint is between coupler and slider: the ball on the coupler's end, the
    socket in the slider, which does not turn. With an ideal joint the same scene has no gap.

    Attributes
    ----------
    crank_length, coupler_length : float
        In m, crank shorter than coupler by more than the clearance.
    crank_mass, coupler_mass, slider_mass : float
        In kg.
    crank_inertia, coupler_inertia : float or None
        Moment of inertia about the link's own centre, in kg m^2; None: uniform rod, m L^2/12.
    clearance, socket_radius : float
        In m; the ball's radius is the difference.
    youngs_modulus, poisson : float
        Of ball, socket and links; modulus in Pa.
    link_modulus : float or None
        Young's modulus of the links alone, in Pa; None: that of the material.
    density : float
        In kg/m^3: with mass and length it gives the links' square sections.
    restitution : float
        Coefficient of restitution, from 0 to 1.
    damping : str
        Rule for the damping factor, a key of ``study.contact.damping.DAMPINGS``.
    friction : float
        Coefficient of sliding friction, >= 0.
    slow_speed, full_speed : float
        Tolerance speeds v0 and v1 of the friction law, in m/s.
    driving_moment : float
        Constant moment on the crank, in N m.
    gravity : float
        Acceleration along -y, in m/s^2.
    initial_eccentricity : tuple of float
        Ball's centre from the socket's at t = 0, in m, inside the clearance.
    """

    crank_length: float = 0.05
    crank_mass: float = 0.3
    coupler_length: float = 0.12
    coupler_mass: float = 0.21
    slider_mass: float = 0.14
    clearance: float = 5e-5
    youngs_modulus: float = 207e9
    poisson: float = 0.3
    restitution: float = 0.5
    friction: float = 0.05
    slow_speed: float = 1e-4
    full_speed: float = 0.01
    driving_moment: float = 0.5
    socket_radius: float = 10e-3
    crank_inertia: float | None = None
    coupler_inertia: float | None = None
    link_modulus: float | None = None
    density: float = 7850.0
    damping: str = "lankarani-nikravesh"
    gravity: float = 0.0
    initial_eccentricity: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self):
        for name, unit in _POSITIVE.items():
            value = getattr(self, name)
            if value is not None or name != "link_modulus":
                checks.number(name.replace("_", " "), value, unit, above=0, scalar=True)
        for body in ("crank", "coupler"):
            inertia = getattr(self, f"{body}_inertia")
            if inertia is not None:
                checks.number(f"{body} inertia", inertia, "kg m^2", least=0, scalar=True)
        checks.poisson("poisson", self.poisson)
        smallest = 1e-9 * self.socket_radius
        checks.number("clearance", self.clearance, "m", least=smallest, below=self.socket_radius)
        longest = self.coupler_length - self.clearance
        checks.number("crank length", self.crank_length, "m", below=longest)
        checks.number("friction", self.friction, least=0, scalar=True)
        checks.number(
            "slow speed", self.slow_speed, "m/s", least=0, below=self.full_speed, scalar=True
        )
        moment = "driving moment", self.driving_moment, "N m"
        checks.number(*moment, least=-1e6, most=1e6, scalar=True)
        checks.number("gravity", self.gravity, "m/s^2", least=-1e6, most=1e6, scalar=True)
        damping_factor(self.damping, self.restitution)
        pair = self.initial_eccentricity
        if not isinstance(pair, (tuple, list)) or len(pair) != 2:
            raise ValueError(
                f"initial eccentricity must be two numbers, in m, got {checks.shown(pair)}"
            )
        for axis, value in zip("xy", pair, strict=True):
            checks.number(f"{axis} of initial eccentricity", value, "m", scalar=True)
        inside = self.clearance - ROUNDING * self.socket_radius  # R2 - R1 is known to no more
        checks.number("initial eccentricity", hypot(*pair), "m", below=inside)

    @property
    def ball_radius(self):
        """Radius of the ball, in m."""
        return self.socket_radius - self.clearance

    @property
    def composite_modulus(self):
        """Composite modulus of ball and socket, in Pa."""
        body = self.youngs_modulus, self.poisson
        return composite_modulus(*body, *body)

    @property
    def damping_factor(self):
        """Factor D of the damping term."""
        return damping_factor(self.damping, self.restitution)

    @property
    def inertias(self):
        """Moments of inertia of crank and coupler about their centres, in kg m^2."""
        links = (
            (self.crank_inertia, self.crank_mass, self.crank_length),
            (self.coupler_inertia, self.coupler_mass, self.coupler_length),
        )
        return tuple(m * l**2 / 12 if i is None else i for i, m, l in links)  # noqa: E741

    def link(self, body):
        """Beam that stands for a flexible link.

        Parameters
        ----------
        body : {"crank", "coupler"}

        Returns
        -------
        Link

        Raises
        ------
        ValueError
            If the link's moment of inertia is below that of a thin rod, which a beam has at least.
        """
        checks.choice("body", body, LINKS)
        length, mass = getattr(self, f"{body}_length"), getattr(self, f"{body}_mass")
        rod = mass * length**2 / 12
        own = self.inertias[("crank", "coupler").index(body)]
        if own < rod * (1 - 1e-12):
            raise ValueError(
                f"{body} inertia of a flexible link must be >= {rod:g} kg m^2, got {own:g} kg m^2"
            )
        modulus = self.link_modulus or self.youngs_modulus
        area = mass / (self.density * length)
        shear = 5 / 6 * modulus / (2 * (1 + self.poisson)) * area
        return Link(
            length=length,
            mass_per_length=mass / length,
            rotary_per_length=max(own - rod, 0.0) / length,
            axial=modulus * area,
            shear=shear,
            bending=modulus * area**2 / 12,
        )

    def parameters(self):
        """Every parameter: where the paper states it, or what this study assumes instead.

        Returns
        -------
        pandas.DataFrame
            Columns parameter, value (as text), unit, table, source.
        """
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        values["crank_inertia"], values["coupler_inertia"] = self.inertias
        values["link_modulus"] = self.link_modulus or self.youngs_modulus
        values["initial_eccentricity"] = hypot(*self.initial_eccentricity)
        rows = []
        for name, value in values.items():
            table = "Table 3" if name in _TABLE_3 else "Table 4" if name in _TABLE_4 else "-"
            source = ASSUMPTIONS.get(name, "given by the paper")
            text = value if isinstance(value, str) else f"{value:.9g}"
            rows.append((name.replace("_", " "), text, _UNITS.get(name, "1"), table, source))
        return pd.DataFrame(rows, columns=["parameter", "value", "unit", "table", "source"])

    def but(self, **changes):
        """Copy with some attributes changed."""
        return replace(self, **changes)


@dataclass(frozen=True)
class Link:
    """Beam properties of a flexible link, all SI: stiffnesses EA, k GA (k = 5/6), EI."""

    length: float
    mass_per_length: float
    rotary_per_length: float
    axial: float
    shear: float
    bending: float


def square_bar_inertia(scene, body):
    """Moment of inertia about its centre of a link as the square bar of the scene's density.

    Parameters
    ----------
    scene : Scene
    body : {"crank", "coupler"}

    Returns
    -------
    float
        m (L^2 + h^2) / 12 with the side h, in kg m^2.
    """
    checks.instance("scene", scene, Scene)
    checks.choice("body", body, LINKS)
    length, mass = getattr(scene, f"{body}_length"), getattr(scene, f"{body}_mass")
    return mass * (length**2 + mass / (scene.density * length)) / 12


_POSITIVE = {
    "crank_length": "m",
    "coupler_length": "m",
    "crank_mass": "kg",
    "coupler_mass": "kg",
    "slider_mass": "kg",
    "clearance": "m",
    "socket_radius": "m",
    "youngs_modulus": "Pa",
    "link_modulus": "Pa",
    "density": "kg/m^3",
    "full_speed": "m/s",
}
_UNITS = _POSITIVE | {
    "crank_inertia": "kg m^2",
    "coupler_inertia": "kg m^2",
    "slow_speed": "m/s",
    "driving_moment": "N m",
    "gravity": "m/s^2",
    "initial_eccentricity": "m",
    "damping": "",
}
_TABLE_3 = list(Scene.__dataclass_fields__)[:6]
_TABLE_4 = list(Scene.__dataclass_fields__)[6:13]
ASSUMPTIONS = {
    "socket_radius": "assumed, R2* = 200, the paper's static case",
    "crank_inertia": "assumed, uniform rod about its centre, m L^2/12",
    "coupler_inertia": "assumed, uniform rod about its centre, m L^2/12",
    "link_modulus": "assumed, that of ball and socket",
    "density": "assumed, steel, with square sections from mass and length",
    "damping": "given by the paper, Eq. 31",
    "gravity": "assumed, none",
    "initial_eccentricity": "assumed, concentric, and at rest",
}
