"""Each shape of force over depth as text for C, MATLAB, Modelica and Python.

A formula has lines ``name = expression``, from ``ds`` = depth/dR > 0 to ``value`` and ``slope``.
They are read from the function of a `study.contact.shapes.Shape`, unless the shape states them.
They are written for MATLAB's arrays; the other languages get them without the dots before * and /.
The templates around them are ``law.c``, ``law.m``, ``law.mo`` and ``law.exudyn``. Parts of the
templates are in ``languages.toml``.
"""

import ast
import re
import textwrap
import tomllib
from collections.abc import Sequence
from inspect import getsource
from pathlib import Path
from string import Template
from typing import Any, Literal

import numpy as np

from study.contact import shapes
from study.contact.shapes import Shape
from study.joint import Joint

Language = Literal["c", "matlab", "modelica", "exudyn"]
DIMENSIONLESS = ("c", "matlab", "json", "csv")
"""Formats that are possible for a joint without dimensions."""
SAME_R2_STAR = 1e-6
"""Maximum relative difference of the R2* of an export without dimensions and of its arguments."""
WIDTH = 92
_LANGUAGES = tomllib.loads(Path(__file__).with_name("languages.toml").read_text(encoding="utf-8"))
_SIGNS = {"@": ".*", "//": "./"}
"""Operators of Python with the precedence of * and /, in place of those between arrays."""


def words(shape: Shape, constants: Any) -> str:
    """Formula of a shape as text."""
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


def of_joint(language: Language, law: str, joint: Joint) -> dict[str, str]:
    """Joint in a template: its dimensions as constants, or as arguments that are checked."""
    texts = dict.fromkeys(("inputs", "about_inputs", "checks", "sizes"), "")
    if joint.has_dimensions:
        names = ("socket_radius", "clearance", "composite_modulus")
        sizes = {name: f"{float(getattr(joint, name))!r}" for name in names}
        return texts | sizes | {"sizes": _part(language, "sizes", **sizes)}
    r2_star = {"r2_star": f"{joint.r2_star!r}", "ratio": f"{joint.r2_star:.9g}"}
    return texts | {
        name: _part(language, name, law=law, same=SAME_R2_STAR, **r2_star)
        for name in ("inputs", "about_inputs", "checks")
    }


def text(language: Language, shape: Shape, constants: Any, about: list[str], **values: Any) -> str:
    """Source of one function: ``about`` is its comment, ``values`` fill the template."""
    body = lines(shape, constants)
    names = dict.fromkeys(line.split(" = ")[0] for line in body)
    if language != "matlab":
        body = [re.sub(r" \.([*/])", r" \1", line) for line in body]
    if language == "modelica":
        last = f"min(floor(x), {len(constants) // 2 - 2})"
        body = [line.replace(" = ", " := ", 1).replace("KNOT(x)", last) for line in body]
        body = [re.sub(r"TABLE\((.*?), (\d)\)", r"table[integer(\1) + 1, \2 + 1]", s) for s in body]
    of, tables = _LANGUAGES[language], ""
    if shape is shapes.tabulated:
        table = np.reshape(constants[1:], (-1, 2)).tolist()
        rows = of["between_rows"].join(of["row"] % ", ".join(map(repr, row)) for row in table)
        tables = _part(language, "table", rows=rows, count=len(table), last=len(table) - 2)
    indents = {"initial_indent": "    ", "subsequent_indent": " " * 8}
    statements = (
        textwrap.wrap(f"{line}{of['end']}", WIDTH, break_long_words=False, **indents)
        for line in body
    )
    values["body"] = "\n".join(f"{of['continued']}\n".join(parts) for parts in statements)
    values |= {"names": ", ".join(names), "tables": tables}
    return filled("law" + of["suffix"], of["comment"], about, **values)


def filled(file: str, sign: str, about: Sequence[str], **values: Any) -> str:
    """A template with its values, and lines about it as comments that begin with a sign."""
    comment = [part for line in about for part in textwrap.wrap(line, WIDTH) or [""]]
    template = Path(__file__).with_name(file).read_text(encoding="utf-8")
    described = "\n".join(f"{sign}{part}".rstrip() for part in comment)
    return Template(template).substitute(values, described=described)


def _part(language: Language, name: str, **values: Any) -> str:
    return Template(_LANGUAGES[language].get(name, "")).substitute(values)


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
