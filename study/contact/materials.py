"""Materials by name, with their sources in ``materials.csv``, and what laws need of two bodies.

The properties of castings, heat treatments and polymers differ by tens of percent. For a design,
give the values of its data sheets as a `Material`.
"""

import csv
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from study import checks, parameters
from study.parameters import parameter

MATERIALS = Path(__file__).with_name("materials.csv")


@dataclass(frozen=True)
class Material:
    """An isotropic, linear elastic material.

    Materials that differ only in their yield stress compare as equal, because forces do not depend
    on it.

    Parameters
    ----------
    youngs_modulus : float, default 2e11
        Young's modulus in Pa.
    poisson : float, default 0.3
        Poisson's ratio, > -1 and < 0.5.
    yield_stress : float, optional
        Yield stress in Pa, to predict yield.

    Examples
    --------
    >>> Material(youngs_modulus=110e9, poisson=0.34, yield_stress=160e6).poisson
    0.34
    """

    youngs_modulus: float = parameter(2e11, "Young's modulus", "Pa", above=0)
    poisson: float = parameter(0.3, "Poisson's ratio", above=-1, below=0.5)
    yield_stress: float | None = parameter(None, "Yield stress", "Pa", above=0, compare=False)

    def __post_init__(self):
        parameters.take(self)

    def __str__(self):
        numbers = self.youngs_modulus, self.poisson, self.yield_stress
        return ",".join(f"{number:.9g}" for number in numbers if number is not None)


def in_words(of: Material) -> str:
    """Name of a material with these numbers, if `table` has one; else the numbers."""
    numbers = of.youngs_modulus, of.poisson, of.yield_stress
    for row in table():
        if numbers == (row["youngs_modulus"], row["poisson"], row["yield_stress"]):
            return row["name"]
    return f"{of.youngs_modulus:g} Pa and Poisson's ratio {of.poisson:g}"


def material(given: str | Material, name: str = "material") -> Material:
    """Material from its name or its numbers; ``name`` is that of the body, for error messages.

    Parameters
    ----------
    given
        A name of `table`, where upper case, hyphens and spaces are ignored; or Young's modulus,
        Poisson's ratio and, optionally, yield stress as a text such as ``210GPa,0.3,500MPa``
        (plain numbers are in Pa); or a `Material`, which is checked and returned.

    Raises
    ------
    ValueError
        If the name is unknown, or Young's modulus is below `study.checks.SOFTEST`.

    Examples
    --------
    >>> material("bronze").youngs_modulus
    110000000000.0
    """
    given = read_material(name, given) if isinstance(given, str) else given
    modulus = checks.instance(name, given, Material).youngs_modulus
    checks.youngs_modulus(f"Young's modulus of {name}", modulus)
    return given


def read_material(name: str, text: str) -> Material:
    """Material of a text, as in `material`; ``name`` is that of the parameter."""
    known = {_plain(row["name"]): row for row in table()}
    if row := known.get(_plain(text)):
        return Material(row["youngs_modulus"], row["poisson"], row["yield_stress"])
    try:
        values = checks.read_several(name, text, ("Pa", "", "Pa")[: text.count(",") + 1])
    except ValueError:
        values = ()
    if len(values) < 2:
        names = ", ".join(row["name"] for row in table())
        raise ValueError(
            f"{name} must be one of {names}, or Young's modulus and Poisson's ratio, "
            f"for example 210GPa,0.3, got {checks.shown(text)}"
        )
    checks.youngs_modulus(f"Young's modulus of {name}", values[0])
    return Material(*values)


def _plain(name):
    """A name without case, spaces and hyphens."""
    return "".join(c for c in name.lower() if c not in " -_")


@lru_cache(maxsize=1)
def table() -> tuple[dict[str, Any], ...]:
    """Rows of ``materials.csv``, in Pa; the yield stress is None if the material has no usual one.

    Raises `study.checks.StudyError` if the file is missing or damaged.
    """
    rows: list[dict[str, Any]] = []
    with checks.intact("study/contact/materials.csv"):
        for row in csv.DictReader(MATERIALS.read_text(encoding="utf-8").splitlines()):
            constants = "youngs_modulus", "poisson", "yield_stress"
            rows.append(row | {of: float(row[of]) if row[of] else None for of in constants})
        if not rows:
            raise ValueError("no material")
    return tuple(rows)


SOCKET_RATIO = 1.298
"""Outer radius divided by inner radius of the reference joint. The paper does not state it; with
this value a fine mesh agrees best with Table 2 (notebook 13)."""
LIMIT_MARGIN = 1e-9  # by rounding, d/dR and R2/dR from radii in m may exceed a limit


def composite_modulus(
    ball_modulus: float, ball_poisson: float, socket_modulus: float, socket_poisson: float
) -> float:
    """Composite modulus E* in Pa, from 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2.

    E1 and E2 are Young's moduli in Pa, > 0, and nu1 and nu2 Poisson's ratios, > -1 and < 0.5; else
    ``ValueError``.

    Examples
    --------
    >>> print(f"{composite_modulus(2.1e11, 0.3, 1.1e11, 0.34):.4g}")
    8.082e+10
    """
    bodies = {"ball": (ball_modulus, ball_poisson), "socket": (socket_modulus, socket_poisson)}
    compliance = 0.0
    for body, (modulus, poisson) in bodies.items():
        e = checks.number(f"{body} Young's modulus", modulus, "Pa", above=0, scalar=True)
        nu = checks.number(f"{body} Poisson's ratio", poisson, above=-1, below=0.5, scalar=True)
        compliance += (1 - nu**2) / e
    return 1 / compliance


def hertz_factor(r2_star: ArrayLike) -> Any:
    """Factor of ds^(3/2) in Hertz's law, P* = (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) (Eqs. 4-6)."""
    socket = np.asarray(r2_star, dtype=float)
    return 4 / 3 * np.sqrt(socket * (socket - 1))


def largest_depth(r2_star: float) -> float:
    """Depth d/dR = sqrt(2 R2* - 1) - 1 at which the spheres intersect at the ball's equator."""
    return np.sqrt(2 * r2_star - 1) - 1
