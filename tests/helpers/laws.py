"""Laws that tests try, each by the R2* of its joint, and laws for the compiled functions."""

from study import contact
from study.contact import DimensionalLaw, HyperbolicWinkler, Steuermann, StiffenedHertz
from study.joint import Joint


def _stiffened(**ratios):
    return lambda r2_star: StiffenedHertz.of(Joint.from_ratios(r2_star, **ratios))


_MIXED = {"socket_ratio": 3.0, "modulus_ratio": 0.01, "ball_support": "clamped", "rim": "mirror"}
_LAWS = [
    *(contact.Hertz(), contact.Liu(), contact.Winkler(), contact.Winkler(3.0)),
    *(contact.Power(), contact.Power(600.0, 1.7)),
    *(Steuermann(), Steuermann(3), Steuermann(2, "profile")),
    *(HyperbolicWinkler(), HyperbolicWinkler(3.0), HyperbolicWinkler(area="sphere")),
]
VARIANTS = {
    **{repr(law): lambda r2_star, law=law: law for law in _LAWS},
    "stiffened_hertz": _stiffened(),
    "stiffened_hertz, thin": _stiffened(socket_ratio=1.1, poisson=0.45),
    "stiffened_hertz, mixed": _stiffened(**_MIXED),
    "stiffened_hertz, free": _stiffened(socket_poisson=0.46, modulus_ratio=30.0, rim="free"),
}
"""Description of a law -> the law as a function of R2*."""


def packed(law, ball_radius, socket_radius, composite_modulus):
    """Record of a law in a joint."""
    sizes = {"ball_radius": ball_radius, "socket_radius": socket_radius}
    return DimensionalLaw(law, **sizes, composite_modulus=composite_modulus).packed()
