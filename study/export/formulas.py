"""Each shape of force over depth as text for C and MATLAB.

A formula has lines ``name = expression``, from ``ds`` = depth/dR > 0 to the ``value`` and ``slope``
of `study.contact.shapes`. It is written for MATLAB's arrays; C gets it without the dots before *
and /. The templates around it are ``law.c`` and ``law.m``.
"""

import re
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from string import Template
from typing import Any, Literal

import numpy as np

from study.contact import shapes

Language = Literal["c", "matlab"]
WIDTH = 92
_TEMPLATES = {"c": "law.c", "matlab": "law.m"}
_COMMENTS = {"c": " * ", "matlab": "% "}
_WORDS = {
    shapes.hertz: "ds^(3/2)",
    shapes.winkler: "ds^2",
    shapes.chord: "ds sin(eps), cos(eps) = 1/(1 + ds)",
    shapes.liu: "ds sin(eps) sin(eps/2), cos(eps) = 1/(1 + ds)",
    shapes.hyperbolic: "ds (b0 + b1 ds + b2 ds^2 + ...)",
    shapes.stiffened: "ds^(3/2) S, S = 1 + c1 u + ... + c9 u^9, u = s/(1 + s), s = sqrt(ds)",
    shapes.tabulated: "ds^(3/2) S, S a cubic Hermite spline over sqrt(ds)",
}


def words(shape: Callable) -> str:
    """Formula of a shape for a reader."""
    return f"P = E* dR^2 scale {_WORDS[shape]}; ds = depth/dR"


def text(language: Language, shape: Callable, constants: Any, about: str, **values: Any) -> str:
    """Source of one function: ``about`` is its comment, ``values`` fill the template."""
    lines, tables = _FORMULAS[shape](constants)
    if language == "c":
        lines = [re.sub(r" \.([*/])", r" \1", line) for line in lines]
    names = dict.fromkeys(line.split(" = ")[0] for line in lines)
    indented = [part for line in lines for part in _wrapped(line, language)]
    sign = _COMMENTS[language]
    told = [part for line in about.split("\n") for part in textwrap.wrap(line, WIDTH) or [""]]
    template = Path(__file__).with_name(_TEMPLATES[language]).read_text(encoding="utf-8")
    return Template(template).substitute(
        values,
        body="\n".join(indented),
        names=", ".join(names),
        tables=_tables(language, tables),
        described="\n".join(f"{sign}{part}".rstrip() for part in told),
    )


def _wrapped(line: str, language: Language) -> list[str]:
    """One statement, on as many lines as it needs."""
    room = {"width": WIDTH, "initial_indent": "    ", "subsequent_indent": "        "}
    parts = textwrap.wrap(f"{line};", **room, break_long_words=False)
    return [f"{part} ..." for part in parts[:-1]] + parts[-1:] if language == "matlab" else parts


def _polynomial(coefficients: Sequence[float], x: str) -> str:
    """Horner's scheme of coefficients from the highest power to the lowest."""
    first, *rest = (f"{float(c)!r}" for c in coefficients)
    for c in rest:
        first = f"{c} + {x} .* ({first})"
    return first


def _derived(coefficients: Sequence[float]) -> list[float]:
    """Coefficients of the derivative."""
    return np.polyder(np.array(coefficients, dtype=float)).tolist()


def _hyperbolic(constants):
    bracket, steepness = _polynomial(constants, "ds"), _polynomial(_derived(constants), "ds")
    lines = [f"bracket = {bracket}", "value = ds .* bracket"]
    return [*lines, f"slope = bracket + ds .* ({steepness})"], None


def _stiffened(constants):
    powers = [*constants, 1.0]
    lines = ["s = sqrt(ds)", "u = s ./ (1 + s)", f"factor = {_polynomial(powers, 'u')}"]
    lines += [f"steepness = {_polynomial(_derived(powers), 'u')}", "value = ds .* s .* factor"]
    return [*lines, "slope = 1.5 * s .* factor + ds .* steepness .* (1 - u) .* (1 - u) / 2"], None


def _tabulated(constants):
    steps = f"{float(constants[0])!r}"
    lines = [
        "s = sqrt(ds)",
        f"x = s * {steps}",
        "k = KNOT(x)",
        "x = x - k",
        "left = TABLE(k, 0)",
        "rise = TABLE(k + 1, 0) - left",
        f"m0 = TABLE(k, 1) / {steps}",
        f"m1 = TABLE(k + 1, 1) / {steps}",
        "c2 = 3 * rise - 2 * m0 - m1",
        "c3 = m0 + m1 - 2 * rise",
        "factor = left + x .* (m0 + x .* (c2 + x .* c3))",
        f"steepness = (m0 + x .* (2 * c2 + x .* (3 * c3))) * {steps}",
        "value = ds .* s .* factor",
        "slope = 1.5 * s .* factor + ds .* steepness / 2",
    ]
    return lines, np.reshape(constants[1:], (-1, 2))


def _tables(language: Language, table: Any) -> str:
    """The table of a spline, and how the formula reads it, with indices from 0 on."""
    if table is None:
        return ""
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
    body = "\n".join(f"        {row}" for row in rows)
    return (
        f"    % stiffening over Hertz and its slope, at equal steps of sqrt(ds)\n"
        f"    table = [\n{body}\n    ];\n"
        f"    KNOT = @(x) min(floor(x), {last});\n"
        f"    TABLE = @(k, column) table(k + 1, column + 1);"
    )


_FORMULAS: dict[Callable, Callable] = {
    shapes.hertz: lambda _: (["s = sqrt(ds)", "value = ds .* s", "slope = 1.5 * s"], None),
    shapes.winkler: lambda _: (["value = ds .* ds", "slope = 2 * ds"], None),
    shapes.chord: lambda _: (
        [
            "root = sqrt(ds .* (2 + ds))",
            "sine = root ./ (1 + ds)",
            "value = ds .* sine",
            "slope = sine + ds ./ (root .* (1 + ds) .* (1 + ds))",
        ],
        None,
    ),
    shapes.liu: lambda _: (
        [
            "share = ds ./ (1 + ds)",
            "value = ds .* share .* sqrt(1 - share / 2)",
            "slope = value .* (2 ./ ds + 0.5 ./ (2 + ds) - 1.5 ./ (1 + ds))",
        ],
        None,
    ),
    shapes.hyperbolic: _hyperbolic,
    shapes.stiffened: _stiffened,
    shapes.tabulated: _tabulated,
}
"""Shape -> function of its constants, which gives the lines and the table that they read."""
