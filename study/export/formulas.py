"""Each shape of force over depth as text for C, MATLAB, Modelica and Python.

A formula has lines ``name = expression``, from ``ds`` = depth/dR > 0 to the ``value`` and ``slope``
of `study.contact.shapes`. It is written for MATLAB's arrays; the others get it without the dots
before * and /. The templates around it are ``law.c``, ``law.m``, ``law.mo`` and ``law.exudyn``. A
table of directions fills ``directions.c`` or ``directions.m``.
"""

import re
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from string import Template
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from study.contact import shapes
from study.joint import DimensionalJoint, Joint

Language = Literal["c", "matlab", "modelica", "exudyn"]
DIMENSIONLESS = ("c", "matlab", "json", "csv")
"""Formats of a joint without dimensions."""
SAME_R2_STAR = 1e-6
"""Largest relative difference of R2*, of a text without dimensions, and of its arguments."""
WIDTH = 92
_SUFFIXES = {"c": ".c", "matlab": ".m", "modelica": ".mo", "exudyn": ".exudyn"}
_COMMENTS = {"c": " * ", "matlab": "% ", "modelica": "// ", "exudyn": "# "}
_INPUTS = {
    "c": "double socket_radius, double clearance,\n    double composite_modulus,",
    "matlab": ", socket_radius, clearance, composite_modulus",
}
_ABOUT_INPUTS = (
    "socket_radius      R2, m; R2/dR is {r2_star!r}, else it is another joint",
    "clearance          dR = R2 - R1, m",
    "composite_modulus  E*, Pa; 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2",
)
_CHECKS = {
    "c": """
    if (!(clearance > 0 && clearance <= DBL_MAX)) return {third};
    if (!(fabs(socket_radius / clearance / {r2_star!r} - 1) <= {same})) return {second};
    if (!(composite_modulus > 0 && composite_modulus <= DBL_MAX)) return {fourth};""",
    "matlab": """
    if ~(isscalar(clearance) && clearance > 0 && isfinite(clearance))
        error('{law}:clearance', 'clearance must be one number > 0 m');
    end
    if ~(isscalar(socket_radius) && abs(socket_radius / clearance / {r2_star!r} - 1) <= {same})
        error('{law}:radius', 'socket_radius must be {r2_star:.9g} clearances: another joint');
    end
    if ~(isscalar(composite_modulus) && composite_modulus > 0 && isfinite(composite_modulus))
        error('{law}:modulus', 'composite_modulus must be one number > 0 Pa');
    end""",
}
_CONSTANTS = {
    "c": "\n    const double clearance = {c!r}, composite_modulus = {e!r}; /* m, Pa */",
    "matlab": "\n    clearance = {c!r}; % m\n    composite_modulus = {e!r}; % Pa",
}
_FORMULAS: dict[Callable, tuple[str, ...]] = {
    shapes.hertz: ("ds^(3/2)", "s = sqrt(ds)", "value = ds .* s", "slope = 1.5 * s"),
    shapes.winkler: ("ds^2", "value = ds .* ds", "slope = 2 * ds"),
    shapes.power: (
        "ds^$exponent",
        "value = exp($exponent * log(ds))",
        "slope = $exponent * value ./ ds",
    ),
    shapes.chord: (
        "ds sin(eps), cos(eps) = 1/(1 + ds)",
        "root = sqrt(ds .* (2 + ds))",
        "sine = root ./ (1 + ds)",
        "value = ds .* sine",
        "slope = sine + ds ./ (root .* (1 + ds) .* (1 + ds))",
    ),
    shapes.liu: (
        "ds sin(eps) sin(eps/2), cos(eps) = 1/(1 + ds)",
        "share = ds ./ (1 + ds)",
        "value = ds .* share .* sqrt(1 - share / 2)",
        "slope = value .* (2 ./ ds + 0.5 ./ (2 + ds) - 1.5 ./ (1 + ds))",
    ),
    shapes.hyperbolic: (
        "ds (b0 + b1 ds + b2 ds^2 + ...)",
        "bracket = $polynomial",
        "value = ds .* bracket",
        "slope = bracket + ds .* ($derivative)",
    ),
    shapes.stiffened: (
        "ds^(3/2) S, S = 1 + c1 u + ... + c9 u^9, u = s/(1 + s), s = sqrt(ds)",
        "s = sqrt(ds)",
        "u = s ./ (1 + s)",
        "factor = $polynomial",
        "steepness = $derivative",
        "value = ds .* s .* factor",
        "slope = 1.5 * s .* factor + ds .* steepness .* (1 - u) .* (1 - u) / 2",
    ),
    shapes.tabulated: (
        "ds^(3/2) S, S a cubic Hermite spline over sqrt(ds)",
        "s = sqrt(ds)",
        "x = s * $steps",
        "k = KNOT(x)",
        "x = x - k",
        "left = TABLE(k, 0)",
        "rise = TABLE(k + 1, 0) - left",
        "m0 = TABLE(k, 1) / $steps",
        "m1 = TABLE(k + 1, 1) / $steps",
        "c2 = 3 * rise - 2 * m0 - m1",
        "c3 = m0 + m1 - 2 * rise",
        "factor = left + x .* (m0 + x .* (c2 + x .* c3))",
        "steepness = (m0 + x .* (2 * c2 + x .* (3 * c3))) * $steps",
        "value = ds .* s .* factor",
        "slope = 1.5 * s .* factor + ds .* steepness / 2",
    ),
}
"""Shape -> its formula for a reader, and its lines."""
_POLYNOMIALS: dict[Callable, tuple[str, list[float]]] = {
    shapes.hyperbolic: ("ds", []),
    shapes.stiffened: ("u", [1.0]),
}
"""Shape with a polynomial -> its variable, and the coefficients after the shape's constants."""


def words(shape: Callable, constants: Any) -> str:
    """Formula of a shape for a reader."""
    formula = Template(_FORMULAS[shape][0]).substitute(_numbers(shape, constants))
    return f"P = E* dR^2 scale {formula}; ds = depth/dR"


def of_joint(
    language: Language, law: str, joint: Joint, sized: DimensionalJoint | None, first: int = 2
) -> dict[str, str]:
    """Joint in a template: its dimensions as constants, or as arguments that are checked.

    ``first`` is the number of the first such argument, which C returns.
    """
    if sized is None:
        about = [line.format(r2_star=joint.r2_star) for line in _ABOUT_INPUTS]
        numbers = dict(zip(("second", "third", "fourth"), range(first, first + 3), strict=True))
        numbers |= {"law": law, "r2_star": joint.r2_star, "same": SAME_R2_STAR}
        return {
            "inputs": _INPUTS[language],
            "about_inputs": "\n".join(_COMMENTS[language] + line for line in about) + "\n",
            "sizes": "",
            "checks": _CHECKS[language].format(**numbers),
        }
    values = {"socket_radius": sized.socket_radius, "clearance": sized.clearance}
    values |= {"composite_modulus": float(joint.composite_modulus)}
    constants = _CONSTANTS.get(language, "").format(
        c=values["clearance"], e=values["composite_modulus"]
    )
    texts = {"inputs": "", "about_inputs": "", "checks": "", "sizes": constants}
    return texts | {name: f"{value!r}" for name, value in values.items()}


def text(language: Language, shape: Callable, constants: Any, about: str, **values: Any) -> str:
    """Source of one function: ``about`` is its comment, ``values`` fill the template."""
    numbers = _numbers(shape, constants)
    lines = [Template(line).substitute(numbers) for line in _FORMULAS[shape][1:]]
    names = dict.fromkeys(line.split(" = ")[0] for line in lines)
    if language != "matlab":
        lines = [re.sub(r" \.([*/])", r" \1", line) for line in lines]
    if language == "modelica":
        last = f"min(floor(x), {len(constants) // 2 - 2})"
        lines = [line.replace(" = ", " := ", 1).replace("KNOT(x)", last) for line in lines]
        lines = [
            re.sub(r"TABLE\((.*?), (\d)\)", r"table[integer(\1) + 1, \2 + 1]", s) for s in lines
        ]
    return filled(
        f"law{_SUFFIXES[language]}",
        _COMMENTS[language],
        about.split("\n"),
        **values,
        body="\n".join(part for line in lines for part in _wrapped(line, language)),
        names=", ".join(names),
        tables=_table(language, constants) if shape is shapes.tabulated else "",
    )


def of_directions(
    language: Language, tables: NDArray[np.float64], about: str, **values: Any
) -> str:
    """Source of the function of `study.joint.DirectionalLaw`, from its table."""
    begin, end, after = ("    {", "}", ",\n") if language == "c" else ("        ", "", "\n")
    along, across = (
        after.join(f"{begin}{', '.join(f'{x:.12g}' for x in row)}{end}" for row in table)
        for table in tables
    )
    _, rows, columns = tables.shape
    values |= {"rows": rows, "columns": columns, "along": along, "across": across}
    file, sign = f"directions{_SUFFIXES[language]}", _COMMENTS[language]
    return filled(file, sign, about.split("\n"), **values)


def filled(file: str, sign: str, about: Sequence[str], **values: Any) -> str:
    """A template with its values, and lines about it as comments that begin with a sign."""
    comment = [part for line in about for part in textwrap.wrap(line, WIDTH) or [""]]
    template = Path(__file__).with_name(file).read_text(encoding="utf-8")
    described = "\n".join(f"{sign}{part}".rstrip() for part in comment)
    return Template(template).substitute(values, described=described)


def _wrapped(line: str, language: Language) -> list[str]:
    """One statement, on as many lines as it needs."""
    room = {"width": WIDTH, "initial_indent": "    ", "subsequent_indent": "        "}
    end = "" if language == "exudyn" else ";"
    parts = textwrap.wrap(f"{line}{end}", **room, break_long_words=False)
    further = {"matlab": " ...", "exudyn": " \\"}.get(language, "")
    return [f"{part}{further}" for part in parts[:-1]] + parts[-1:]


def _numbers(shape: Callable, constants: Any) -> dict[str, str]:
    """Texts of a shape's constants in its formula."""
    if shape is shapes.tabulated:
        return {"steps": f"{float(constants[0])!r}"}
    if shape is shapes.power:
        return {"exponent": f"{float(constants[0])!r}"}
    if shape not in _POLYNOMIALS:
        return {}
    x, more = _POLYNOMIALS[shape]
    powers = [*constants, *more]
    derivative = np.polyder(np.array(powers, dtype=float)).tolist()
    return {"polynomial": _polynomial(powers, x), "derivative": _polynomial(derivative, x)}


def _polynomial(coefficients: Sequence[float], x: str) -> str:
    """Horner's scheme of coefficients from the highest power to the lowest."""
    scheme, *rest = (f"{float(c)!r}" for c in coefficients)
    for c in rest:
        scheme = f"{c} + {x} .* ({scheme})"
    return scheme


def _table(language: Language, constants: Any) -> str:
    """The table of a spline, and how the formula reads it, with indices from 0 on."""
    table = np.reshape(constants[1:], (-1, 2))
    last = len(table) - 2
    rows = [", ".join(f"{float(x)!r}" for x in row) for row in table]
    if language == "c":
        body = ",\n".join(f"    {{{row}}}" for row in rows)
        return (
            f"\n/* stiffening over Hertz and its slope, at equal steps of sqrt(ds) */\n"
            f"static const double table[{len(rows)}][2] = {{\n{body}\n}};\n"
            f"#define KNOT(x) floor((x) < {last} ? (x) : {last})\n"
            f"#define TABLE(k, column) table[(int)(k)][column]\n"
        )
    if language == "modelica":
        body = ",\n".join(f"    {{{row}}}" for row in rows)
        return (
            f"\n  constant Real table[{len(rows)}, 2] = {{\n{body}\n  }} "
            '"Stiffening over Hertz and its slope, at equal steps of sqrt(ds)";'
        )
    if language == "exudyn":
        body = ",\n".join(f"    ({row})" for row in rows)
        return (
            "\n# stiffening over Hertz and its slope, at equal steps of sqrt(ds)\n"
            f"VALUES = (\n{body},\n)\n\n\n"
            f"def KNOT(x):\n    return min(int(x), {last})\n\n\n"
            "def TABLE(k, column):\n    return VALUES[k][column]\n"
        )
    body = "\n".join(f"        {row}" for row in rows)
    return (
        f"    % stiffening over Hertz and its slope, at equal steps of sqrt(ds)\n"
        f"    table = [\n{body}\n    ];\n"
        f"    KNOT = @(x) min(floor(x), {last});\n"
        f"    TABLE = @(k, column) table(k + 1, column + 1);"
    )
