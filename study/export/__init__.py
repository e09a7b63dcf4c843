"""Export of laws for other programs, as functions, tables and elements of these programs.

Each export is for one joint. It states the joint, the range of depths, the units, and the maximum
error of the law relative to the elastic solution. A law k depth^n is exported as that, and any
other as a table of force/depth^1.5: a cubic Hermite spline over the root of the depth. Adams has a
spline of its own, through points of the force. A joint without dimensions has depths in clearances
and forces in E* dR^2.

The texts are templates in this folder, such as ``power.c``. The C function is C89, and the MATLAB
function also runs in GNU Octave.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

import builtins
import keyword
import re
import textwrap
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from string import Template
from typing import Any, Literal, get_args

import numpy as np
import scipy
from numpy.typing import NDArray

from study import checks
from study.checks import percent
from study.contact import LAWS, Law, Power, Table, shapes
from study.contact.laws import AnyLaw, find
from study.contact.power_fit import DEPTHS, USUAL_RANGE
from study.joint import Joint
from study.joint.tilted import LARGEST_TILT

Format = Literal["c", "matlab", "modelica", "csv", "exudyn", "adams", "mujoco"]
FORMATS = get_args(Format)
DIMENSIONLESS = ("c", "matlab", "csv")  # also for a joint without dimensions
SHALLOWEST = 0.005  # minimum depth_star of the error: there the force is < 1/1000 of that at 0.5
KNOTS = 65, 129, 257, 513, 1025  # of a table: more until it follows the law
FOLLOWS = 5e-7  # maximum relative error of a table between its knots, relative to the law
POINTS = 20  # of a spline of Adams
TENDONS = 0.8, 0.366  # the second and third begin at these fractions of the range's logarithm
FIRST = 0.001  # minimum depth_star of the error of the tendons
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,62}")  # which is valid in every language
TURNED = 10.0  # deg, by which the tilt is changed to state the change of the force
COARSE = 32  # elements along a quarter circle for this change
BEYOND = "Beyond the range the force continues linearly, and its error is unknown"
ROWS = 400  # of a CSV after its first, by default, in equal steps of sqrt(depth_star)
WIDTH = 92
MILLI = 1e-3
_SOURCE = "Spherical clearance joint study; see CITATION.cff there."
_UNITS = ("unit_of_depth", "unit_of_force", "unit_of_stiffness")
_COMMENTS = {"c": " * ", "matlab": "% ", "modelica": "// ", "exudyn": "# ", "adams": "! "}
_ROW = {"c": "    {%s}", "modelica": "    {%s}", "matlab": "        %s", "exudyn": "    (%s)"}


def export(
    law: AnyLaw,
    form: Format,
    joint: Joint,
    depth_star: float | Sequence[float] | None = None,
    tilt: float | None = None,
    name: str | None = None,
    *,
    points: int | None = None,
    units: Literal["SI", "mm"] = "SI",
) -> str:
    """Export a law of one joint as text in a format of another program.

    Parameters
    ----------
    law
        Name of a law, or a law itself, as of `study.joint.Joint.law`.
    form
        A function (``c``, ``matlab`` or ``modelica``), a table of the force over the depth
        (``csv``), or an element of Exudyn, Adams or MuJoCo.
    joint
        The joint. For Modelica, Exudyn, Adams and MuJoCo it must not be made from ratios.
    depth_star
        Maximum normalised penetration depth of the export; or the minimum and the maximum, between
        which ``power`` and the cubics of MuJoCo are fitted and errors are stated. The default
        maximum is 1, or less if the contact cannot be so deep; for ``power`` 0.05 and 0.5.
    tilt
        Angle in deg between the axis and the displacement, along which ``tabulated`` and ``power``
        then give the force. The default is 90 for a ring or a ball with a bore, else the axis.
    name
        Name of the function or element. The default is that of the law or the program's element.
    points
        Number of rows of ``csv``, by default 401.
    units
        ``mm`` for mm, N and N/mm in ``c``, ``matlab`` and ``csv``.

    Raises
    ------
    ValueError
        If a value is unknown, outside the range of the law or the joint, or not for this format, or
        if the name is a keyword or a standard function of the language.

    Examples
    --------
    >>> text = export("stiffened_hertz", "c", Joint.from_ratios(r2_star=200))
    >>> "int stiffened_hertz_law(double depth" in text
    True
    """
    checks.choice("format", form, FORMATS)
    if isinstance(law, str):
        checks.choice("law", law, LAWS)
    if name is not None:
        check_name(name, form)
    if not checks.instance("joint", joint, Joint).has_dimensions:
        checks.choice("format of a joint without dimensions", form, DIMENSIONLESS)
    if form == "mujoco" and law != "tabulated":
        raise ValueError(f"law must be tabulated for the format mujoco, got {law!r}")
    if points is not None:
        checks.choice("format with points", form, ["csv"])
        checks.whole("points", points, least=3, most=10**6)
    if checks.choice("units", units, ("SI", "mm")) == "mm":
        checks.choice("format with units mm", form, DIMENSIONLESS)
        if not joint.has_dimensions:
            raise ValueError("units do not apply to a joint without dimensions; remove them")
    tilt = joint.default_tilt if tilt is None else tilt
    if tilt is not None and law not in ("tabulated", "power"):
        raise ValueError(f"law must be tabulated or power off the axis, got {law!r}")
    try:
        content = _Content(law, joint, depth_star, tilt, FIRST if form == "mujoco" else SHALLOWEST)
    except checks.RangeError as error:  # of a curve, whose maximum depth has another name
        raise checks.RangeError(str(error).replace("deepest must", "depth_star must")) from None
    if units == "mm":
        content.units, content.unit_of_depth = ("mm", "N", "N/mm"), joint.clearance / MILLI
    exponent = content.law.exponent_of_depth
    if form == "csv":
        return _csv(content, name, points or ROWS + 1)
    if form == "mujoco":
        return _tendon(content, name)
    return _function(content, form, name, exponent)


def check_name(name: str, form: Format) -> None:
    """Raise ``ValueError`` for a name that a function or element of a format cannot have."""
    if not NAME.fullmatch(name):
        wanted = "begin with a letter and consist of at most 63 letters, digits and underscores"
        raise ValueError(f"name must {wanted}, got {name!r}")
    import tomllib  # late: only few exports have a name

    reserved = {*keyword.kwlist, *dir(builtins)} if form == "exudyn" else set()
    text = Path(__file__).with_name("names.toml").read_text(encoding="utf-8")
    for words in tomllib.loads(text).get(form, {}).values():
        reserved.update(words.split())
    if form == "c":  # sinf and sinl, the functions of other precisions
        reserved.update([word + letter for word in reserved for letter in "fl"])
    if name in reserved:
        wanted = f"name must not be a keyword or a standard function of {form}"
        raise ValueError(f"{wanted}, got {name!r}; take another name, for example {name}_joint")


class _Content:
    """A law for one joint, as every format needs it: its range and its errors."""

    def __init__(self, law, joint, depth_star, tilt, shallowest):
        self.joint = joint
        kind = LAWS.get(law) if isinstance(law, str) else None
        fitted = kind is Power
        least, deepest = _range(depth_star, fitted, shallowest)
        self.exact = joint.table(None if fitted else deepest, tilt)
        if deepest is not None and self.exact.deepest < deepest:
            self.exact = joint.table(deepest, tilt)
        curve = self.exact.curve
        self.deepest = deepest = min(1.0, self.exact.deepest) if deepest is None else deepest
        self.law: Law = self.exact
        if fitted:
            places = np.geomspace(least, deepest, DEPTHS)
            self.law = Power.fit(joint, places, self.exact(places))
        elif kind is not Table:
            self.law = find(law, joint)
        self.first = first = float(curve.depth_star[0])
        if not fitted and deepest <= first * (1 + 1e-9):
            wanted = f"> {self._depth(first)}, because the elements resolve no shallower contact"
            got = self._depth(deepest)
            raise checks.RangeError(f"maximum depth_star must be {wanted}, got {got}")
        self.least = least if fitted else min(max(least, first), deepest)
        if not fitted:  # else the error is that of `Joint.power_law`, at the same depths
            places = np.linspace(np.sqrt(self.least), np.sqrt(deepest), ROWS) ** 2
        self.error = float(np.abs(self.law(places, joint.r2_star) / self.exact(places) - 1).max())
        inside = (curve.depth_star >= self.least) & (curve.depth_star <= max(1.05 * deepest, first))
        self.error_of_joint = float(curve.force_error[inside].max()) + self.exact.error
        self.load = "a load along the axis"
        if tilt is not None:
            self.load = f"a displacement {tilt:g} deg off the axis{_change(joint, deepest, tilt)}"
        self.units = ("clearances dR", "E* dR^2", "E* dR")
        self.unit_of_depth = self.unit_of_force = 1.0
        if joint.has_dimensions:
            self.units = ("m", "N", "N/m")
            self.unit_of_depth, self.unit_of_force = joint.clearance, joint.force_unit

    def at(self, depth_star: NDArray[np.float64]) -> tuple[Any, Any]:
        """Force and stiffness in the units of the export, at depths > 0 in clearances."""
        force, slope = (
            self.law(depth_star, self.joint.r2_star, derivative=of) for of in (False, True)
        )
        return self.unit_of_force * force, self.unit_of_force / self.unit_of_depth * slope

    def in_words(self, error: float | None = None) -> list[str]:
        """Lines on joint, range and error; a given ``error`` is that of a fit to the table."""
        if error is None and self.law is not self.exact:
            error = self.error
        text = f"that of the elastic solution, at most {percent(self.error_of_joint)} here."
        if self.least < self.first:
            text += f" Below {self._depth(self.first)} the elastic solution is extrapolated."
        if error is not None:
            text = f"at most {percent(error)} relative to the elastic solution, plus {text}"
        joint = self.joint
        modulus = f", E* = {joint.composite_modulus:.9g} Pa" if joint.has_dimensions else ""
        return [
            f"{joint}: R2* = {joint.r2_star:.9g}{modulus}.",
            f"Range: penetration depths from 0 to {self._depth(self.deepest)}.",
            f"Error of the force at depths >= {self._depth(self.least)}: {text}",
            f"The law is for smooth elastic bodies without friction and {self.load}.",
        ]

    def _depth(self, depth_star):
        """A depth in clearances, and in um if the clearance is known."""
        um = 1e6 * depth_star * self.joint.clearance
        return f"{depth_star:g} clearances" + self.joint.has_dimensions * f" ({um:.4g} um)"


def _range(depth_star, fitted, shallowest):
    """Minimum depth of the stated error, and maximum depth; None for the default of the joint."""
    if depth_star is None:
        return USUAL_RANGE if fitted else (shallowest, None)
    given = np.atleast_1d(checks.number("depth_star", depth_star, above=0))
    if given.shape not in ((1,), (2,)):
        wanted = "depth_star must be one depth, or the minimum and the maximum depth"
        raise ValueError(f"{wanted}, got {checks.shown(depth_star)}")
    deepest = float(given[-1])
    least = deepest / 10 if fitted else min(shallowest, deepest / 12)
    if len(given) == 2:
        least = checks.number("minimum depth_star", given[0], above=0, below=deepest, scalar=True)
    return least, deepest


def _change(joint, deepest, tilt):
    """How much force and stiffness change if the displacement turns from a tilt, as words."""
    solved = {}
    for turned in np.clip([tilt - TURNED, tilt, tilt + TURNED], 0, LARGEST_TILT):
        with suppress(checks.RangeError):  # no contact in this direction
            solved[turned] = joint.solve(depth_star=deepest, tilt=turned, resolution=COARSE)
    own = solved.pop(tilt, None)
    if own is None or not solved:
        return ""
    force, stiffness = (
        max(abs(getattr(of, name)[0] / getattr(own, name)[0] - 1) for of in solved.values())
        for name in ("force_star", "stiffness_star")
    )
    ends = min(tilt, *solved), max(tilt, *solved)
    return (
        f"; between {ends[0]:g} and {ends[1]:g} deg the force at the maximum depth changes by up "
        f"to {percent(force)} and the stiffness by up to {percent(stiffness)}"
    )


def _function(content, form, name, exponent):
    """A function, or an element with k and n, from the templates of a format."""
    joint, law, about = content.joint, content.law, content.in_words()
    values = {
        "name": name or ("ClearanceJoint" if form == "modelica" else f"{law.name}_law"),
        "prefix": f"{name}_" if name else "",
        "suffix": name or "joint",
        "title": f"Contact force of one spherical clearance joint: {law.name}.",
        **dict(zip(_UNITS, content.units, strict=True)),
        "clearance": f"{joint.clearance!r}",
        "clearance_mm": f"{joint.clearance / MILLI:.9g}",
        "beyond": BEYOND,
        "deepest": f"{content.deepest * content.unit_of_depth!r}",
    }
    if exponent is not None:
        kind, scale = "power", float(law.parts(joint.r2_star).scale)
        coefficient = scale * content.unit_of_force / content.unit_of_depth**exponent
        values |= {
            "coefficient": f"{coefficient:.9g}",
            "exponent": f"{exponent:.9g}",
            "coefficient_mm": f"{coefficient * MILLI**exponent:.9g}",
            "socket_radius": f"{joint.socket_radius!r}",
            "ball_radius": f"{joint.ball_radius!r}",
        }
    elif form == "adams":
        kind, ((values["x"], values["y"]), error) = "spline", _spline(content)
        about += [
            f"Between the points, Akima's interpolation adds an error of up to {percent(error)} at "
            "these depths, as computed with SciPy. Adams was not run.",
            f"{BEYOND}.",
        ]
    else:
        kind, (steps, rows) = "table", table_of(content)
        brackets = _ROW[form]
        values |= {
            "rows": ("\n" if form == "matlab" else ",\n").join(
                brackets % ", ".join(f"{x!r}" for x in row) for row in rows.tolist()
            ),
            "count": len(rows),
            "last": len(rows) - 2,
            "steps": f"{steps!r}",
        }
        about.append(f"{BEYOND}.")
    suffix = {"c": "c", "matlab": "m", "modelica": "mo"}.get(form, form)
    if form == "modelica":
        values["function"] = Template(_template(f"{kind}.mo")).substitute(values).rstrip()
        kind = "joint"
    return _filled(f"{kind}.{suffix}", _COMMENTS[form], about, values)


def table_of(content: _Content) -> tuple[float, NDArray[np.float64]]:
    """Knots per unit of s = sqrt(depth), and force/s^3 with its derivative by s at each knot.

    The derivative is (2 s stiffness - 3 force/s)/s^3. At depth 0 both are extrapolated from a
    thousandth of the first step, where force/s^3 is linear in s.
    """
    deepest = np.sqrt(content.deepest)
    for count in KNOTS:
        s = np.linspace(0, deepest, count)
        middle = (s[:-1] + s[1:]) / 2
        s[0] = 1e-3 * s[1]
        force, stiffness = content.at(s * s)
        s, unit = s * np.sqrt(content.unit_of_depth), np.sqrt(content.unit_of_depth)
        factor, slope = force / s**3, (2 * s * stiffness - 3 * force / s) / s**3
        factor[0] -= s[0] * slope[0]
        step = s[-1] / (count - 1)
        between, _ = shapes.cubic(0.5, factor[:-1], step * slope[:-1], factor[1:], step * slope[1:])
        asked = middle**2 >= SHALLOWEST / 10 * content.deepest
        off = between * (unit * middle) ** 3 / content.at(middle**2)[0] - 1
        if np.abs(off[asked]).max() < FOLLOWS:
            break
    return float(1 / step), np.column_stack([factor, slope])


def _filled(file, sign, about, values):
    """A template with its values, and lines about it as comments that begin with a sign."""
    comment = [part for line in about for part in textwrap.wrap(line, WIDTH) or [""]]
    described = "\n".join(f"{sign}{part}".rstrip() for part in comment)
    return Template(_template(file)).substitute(values, described=described, source=_SOURCE)


def _template(file):
    return Path(__file__).with_name(file).read_text(encoding="utf-8")


def _spline(content):
    """Depths in mm and forces in N of a spline of Adams, and the error of Akima's interpolation."""
    first = min(content.least / 2, content.deepest / 400)
    depth = np.append(0, np.geomspace(first, content.deepest, POINTS - 1))
    force = np.append(0, content.at(depth[1:])[0])
    places = np.geomspace(content.least, content.deepest, ROWS)
    interpolated = scipy.interpolate.Akima1DInterpolator(depth, force)(places)
    error = np.abs(interpolated / content.at(places)[0] - 1).max()
    rows = (content.joint.clearance / MILLI * depth, force)
    lines = ([", ".join(f"{x:.9g}" for x in part) for part in row.reshape(-1, 5)] for row in rows)
    return [", &\n        ".join(of) for of in lines], error


def _tendon(content, name):
    """Parallel spatial tendons of MuJoCo with cubics that are fitted to the elastic solution."""
    clearance, unit = content.joint.clearance, content.joint.force_unit
    knots = content.deepest * np.append(0, (content.least / content.deepest) ** np.array(TENDONS))
    cubics, error = _cubics(content, knots)
    whole = sum(
        (np.polynomial.Polynomial([0, *c])(np.polynomial.Polynomial([-k, 1])))
        for c, k in zip(cubics, knots, strict=True)
    )
    turns = whole.deriv().roots()  # of the force beyond the last knot
    turn = turns[np.isreal(turns) & (turns.real > content.deepest)].real.min(initial=np.inf)
    outside = []
    for depth in content.least / np.array([2, 10]):
        exact, beyond = content.exact(depth), np.maximum(depth - knots, 0)
        off = (cubics * beyond[:, None] ** [1, 2, 3]).sum() / exact - 1
        outside.append(
            f"{clearance * depth:.2g} m it is {100 * abs(off):.2g} % too "
            f"{'large' if off > 0 else 'small'} ({unit * exact * abs(off):.2g} N)"
        )
    beyond = "it increases with depth at every depth."
    if turn < np.inf:
        beyond = f"it falls from {clearance * turn:.3g} m on, where it must not be used."
    outside = (
        f"Outside: at {' and at '.join(outside)}; beyond the range its error is unknown, and "
        f"{beyond}"
    )
    title = f"A spherical clearance joint{f' named {name}' if name else ''}."
    prefix = f"{name}_" if name else ""
    tendons = [
        _TENDON.format(
            name=f"{name or 'clearance_joint'}_{k}",
            starts=f"{clearance + clearance * knot:.12g}",
            stiffness=" ".join(f"{x:.9g}" for x in unit * cubic / clearance ** np.arange(1.0, 4)),
            prefix=prefix,
        )
        for k, (cubic, knot) in enumerate(zip(cubics, knots, strict=True), 1)
    ]
    about = [*content.in_words(error), outside]
    values = {"title": title, "prefix": prefix, "tendons": "\n".join(tendons)}
    return _filled("tendon.mujoco", "", about, values)


_TENDON = """    <spatial name="{name}" springlength="0 {starts}" stiffness="{stiffness}">
      <site site="{prefix}socket"/>
      <site site="{prefix}ball"/>
    </spatial>"""


def _cubics(content, knots):
    """Coefficients of d, d^2, d^3 beyond each knot, (knots, 3), and their relative error.

    Its maximum is as small as it can be.
    """
    depth = np.geomspace(content.least, content.deepest, 4 * DEPTHS)
    depth = np.union1d(depth, knots[knots > content.least])  # where the error has a kink
    beyond = np.maximum(depth[:, None] - knots, 0)[..., None]
    columns = (beyond ** [1, 2, 3]).reshape(len(depth), -1) / content.exact(depth)[:, None]
    ones = np.ones((len(depth), 1))
    upper, lower = np.hstack([columns, -ones]), np.hstack([-columns, -ones])
    limits = np.append(ones, -ones)
    free = (None, None)  # but no pull where contact begins
    signs = [(0, None), (0, None), *[free] * (columns.shape[1] - 2), (0, None)]
    found = scipy.optimize.linprog(
        [*[0] * columns.shape[1], 1], np.vstack([upper, lower]), limits, bounds=signs
    )
    return found.x[:-1].reshape(-1, 3), float(found.x[-1])


def _csv(content, name, count):
    """Rows of depth, force and stiffness, with the errors of interpolation between them."""
    depth = content.deepest * np.linspace(0, 1, count) ** 2
    force, stiffness = np.zeros((2, count))
    force[1:], stiffness[1:] = content.at(depth[1:])
    between = (depth[1:] + depth[:-1]) / 2
    between = between[between >= content.least]
    exact = content.at(between)[0]
    linear = np.abs(np.interp(between, depth, force) / exact - 1).max()
    spline = np.abs(scipy.interpolate.CubicSpline(depth, force)(between) / exact - 1).max()
    heads = ("depth", "force", "stiffness")
    if not content.joint.has_dimensions:
        heads = tuple(f"{head}_star" for head in heads)
    lines = [
        f"Contact force of one spherical clearance joint: {name or content.law.name}. {_SOURCE}",
        *content.in_words(),
        f"Between rows, linear interpolation over depth adds an error of up to {percent(linear)}.",
        f"With a cubic spline (not-a-knot) this error is at most {percent(spline)}.",
        "Programs continue a table beyond its last row in different ways, with an unknown error.",
        *(f"{head} in {unit}" for head, unit in zip(heads, content.units, strict=True)),
    ]
    columns = content.unit_of_depth * depth, force, stiffness
    rows = (",".join(f"{x:.12g}" for x in row) for row in zip(*columns, strict=True))
    return "\n".join([*(f"# {line}" for line in lines), ",".join(heads), *rows, ""])
