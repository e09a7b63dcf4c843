"""Each law with the options that its tests try, and laws for the compiled functions."""

from study.contact import LAWS, DimensionalLaw

VARIANTS = [(name, dict(options)) for name, law in LAWS.items() for options in law.examples]
IN_SI_UNITS = {name: dict(law.examples[0]) for name, law in LAWS.items()}
"""Law -> options with which it may be given dimensions."""


def packed(law, ball_radius, socket_radius, composite_modulus, **options):
    """Record of a law in a joint."""
    sizes = {"ball_radius": ball_radius, "socket_radius": socket_radius}
    return DimensionalLaw(law, **sizes, composite_modulus=composite_modulus, **options).packed()
