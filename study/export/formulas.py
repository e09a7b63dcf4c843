"""Each shape of force over depth as text for C, MATLAB, Modelica and Python.

A formula has lines ``name = expression``, from ``ds`` = depth/dR > 0 to ``value`` and ``slope``.
They are read from the function of a `study.contact.shapes.Shape`, unless the shape states them.
They are written for MATLAB's arrays; the other languages get them without the dots before * and /.
The templates around them are ``law.c``, ``law.m``, ``law.mo`` and ``law.exudyn``. A table of depth
and tilt fills ``tilted.c`` or ``tilted.m``.
"""

import ast
import re
import textwrap
from collections.abc import Sequence
from inspect import getsource
from pathlib import Path
from string import Template
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from study.contact import shapes
from study.contact.shapes import Shape
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
_SIGNS = {"@": ".*", "//": "./"}
"""Python's operators of the same rank as * and /, which stand for those between arrays."""


def words(shape: Shape, constants: Any) -> str:
    """Formula of a shape for a reader."""
    formula = Template(shape.formula).substitute(_numbers(shape, constants))
    return f"P = E* dR^2 scale {formula}; ds = depth/dR"


def lines(shape: Shape, constants: Any) -> list[str]:
    """Statements from ``ds`` to ``value`` and ``slope``, for MATLAB's arrays."""
    if shape.lines is not None:
        numbers = _numbers(shape, constants)
        return [Template(line).substitute(numbers) for line in shape.lines]
    (function,) = ast.parse(getsource(shape.function)).body
    statements = []
    for node in function.body:
        if isinstance(node, ast.Return):
            statements += zip(("value", "slope"), node.value.elts, strict=True)
        elif isinstance(node, ast.Assign):
            statements.append((node.targets[0].id, node.value))
    written = [(name, ast.unparse(_Translation(constants).visit(x))) for name, x in statements]
    text = "\n".join(f"{name} = {x}" for name, x in written if x != name)
    for operator, sign in _SIGNS.items():
        text = text.replace(operator, sign)
    return text.split("\n")


class _Translation(ast.NodeTransformer):
    """An expression of a shape's function, with numbers for constants, as MATLAB has it."""

    def __init__(self, constants):
        self._constants = constants

    def visit_Subscript(self, node):  # constants[k]
        return ast.Constant(float(self._constants[node.slice.value]))

    def visit_Attribute(self, node):  # np.sqrt
        return ast.Name(node.attr)

    def visit_BinOp(self, node):
        self.generic_visit(node)
        left, right = (isinstance(side, ast.Constant) for side in (node.left, node.right))
        if isinstance(node.op, ast.Pow) and right and node.right.value == 2:
            return ast.BinOp(node.left, ast.MatMult(), node.left)
        if isinstance(node.op, ast.Pow):  # of a base > 0
            power = ast.BinOp(node.right, ast.Mult(), ast.Call(ast.Name("log"), [node.left], []))
            return ast.Call(ast.Name("exp"), [power], [])
        if isinstance(node.op, ast.Mult) and not left and not right:
            node.op = ast.MatMult()
        if isinstance(node.op, ast.Div) and not right:
            node.op = ast.FloorDiv()
        return node


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


def text(language: Language, shape: Shape, constants: Any, about: str, **values: Any) -> str:
    """Source of one function: ``about`` is its comment, ``values`` fill the template."""
    body = lines(shape, constants)
    names = dict.fromkeys(line.split(" = ")[0] for line in body)
    if language != "matlab":
        body = [re.sub(r" \.([*/])", r" \1", line) for line in body]
    if language == "modelica":
        last = f"min(floor(x), {len(constants) // 2 - 2})"
        body = [line.replace(" = ", " := ", 1).replace("KNOT(x)", last) for line in body]
        body = [re.sub(r"TABLE\((.*?), (\d)\)", r"table[integer(\1) + 1, \2 + 1]", s) for s in body]
    return filled(
        f"law{_SUFFIXES[language]}",
        _COMMENTS[language],
        about.split("\n"),
        **values,
        body="\n".join(part for line in body for part in _wrapped(line, language)),
        names=", ".join(names),
        tables=_table(language, constants) if shape is shapes.tabulated else "",
    )


def of_tilt(language: Language, tables: NDArray[np.float64], about: str, **values: Any) -> str:
    """Source of the function of `study.joint.DirectionalLaw`, from its table."""
    begin, end, after = ("    {", "}", ",\n") if language == "c" else ("        ", "", "\n")
    along, across = (
        after.join(f"{begin}{', '.join(f'{x:.12g}' for x in row)}{end}" for row in table)
        for table in tables
    )
    _, rows, columns = tables.shape
    values |= {"rows": rows, "columns": columns, "along": along, "across": across}
    file, sign = f"tilted{_SUFFIXES[language]}", _COMMENTS[language]
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


def _numbers(shape: Shape, constants: Any) -> dict[str, str]:
    """Texts of a shape's constants in its formula."""
    if shape.polynomial:
        x, more = shape.polynomial
        powers = [*constants, *more]
        derivative = np.polyder(np.array(powers, dtype=float)).tolist()
        return {"polynomial": _polynomial(powers, x), "derivative": _polynomial(derivative, x)}
    names = ("steps",) if shape is shapes.tabulated else shape.constants or ()
    return {name: f"{float(c)!r}" for name, c in zip(names, constants, strict=False)}


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
