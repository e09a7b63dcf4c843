"""Export of laws for other programs, as functions, tables and elements of these programs.

Each export is for one joint. It states the joint, the range of depths, the units, and the maximum
error of the law relative to the elastic solution. The dimensions of a joint are constants in the
export; that of a joint without dimensions takes them as arguments, and rejects those with another
R2*. The C function is C89 and needs the standard library only; the MATLAB function also runs in GNU
Octave.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

import json
import keyword
import re
from collections.abc import Sequence
from contextlib import suppress
from typing import Literal

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import linprog

from study import checks
from study.contact import LAWS, LawName, laws, shapes
from study.contact.materials import in_words
from study.contact.power_fit import DEPTHS, USUAL_RANGE
from study.export import formulas
from study.joint import Joint
from study.joint.table import table
from study.joint.tilted import LARGEST_TILT

Exported = Literal[LawName, "tabulated"]
Format = Literal["c", "matlab", "modelica", "json", "csv", "exudyn", "adams", "mujoco"]
SUFFIXES: dict[Format, str] = {
    "c": ".c",
    "matlab": ".m",
    "modelica": ".mo",
    "json": ".json",
    "csv": ".csv",
    "exudyn": ".py",
    "adams": ".txt",
    "mujoco": ".xml",
}
FUNCTIONS = {"power": "power_law"}
"""Law -> name of its function if this differs from the law: MATLAB has a function power."""
LAW_OF: dict[Format, str] = {"adams": "power", "mujoco": "tabulated"}
"""Formats of one law only: Adams has k and n; cubics for MuJoCo are fitted to the solution."""
ELEMENTS = {"exudyn": ("sphere.exudyn", "# "), "adams": ("impact.adams", "! ")}
"""Template, and sign of its comments, of an element with the parameters k and n of ``power``."""
SHALLOWEST = 0.005
"""Minimum depth_star of the stated error: below it, the force is below 1/1000 of that at 0.5."""
KNOTS = 0.0, 0.004, 0.08
"""Depths where the tendons of MuJoCo begin, divided by the maximum depth of the export."""
FIRST = 0.001
"""Minimum depth_star of the error of the tendons of MuJoCo."""
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,62}")
"""Names of functions and elements that are valid in every language."""
TURNED = 10.0
"""Angle in deg by which the tilt of an export is changed to state the change of the force."""
COARSE = 32  # elements along a quarter circle for this change
_PYTHON = r"\b(CLEARANCE|MODULUS|VALUES|KNOT|TABLE|contact_force|_force|solver_settings)\b"
ROWS = 400  # of a CSV after its first, in equal steps of sqrt(depth_star)
_BETWEEN = 8  # places between rows at which interpolation is checked
_SOURCE = "Spherical clearance joint study; see CITATION.cff there."
MILLI = 1e-3
_SI_UNITS = {"depth": "m", "force": "N", "stiffness": "N/m, of force over depth"}
_OF_SIZES = {
    "socket_radius": "m, R2",
    "clearance": "m, dR = R2 - R1",
    "wall": "m, from R2 to the outside of the socket",
    "composite_modulus": "Pa, E*",
}
_UNITS = {
    "depth_star": "depth/dR, dR = R2 - R1 the clearance",
    "force_star": "force/(E* dR^2), 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2",
    "stiffness_star": "stiffness/(E* dR), of force over depth",
}


def export(
    law: Exported,
    form: Format,
    joint: Joint,
    depth_star: float | Sequence[float] | None = None,
    tilt: float | None = None,
    name: str | None = None,
) -> str:
    """Export a law of one joint as text in a format of another program.

    Parameters
    ----------
    law
        Name of a law, or ``tabulated`` for a table of the joint's elastic solution.
    form
        A function (``c``, ``matlab`` for MATLAB and Octave, or ``modelica``, with a component), the
        formula and its numbers (``json``), a table of the force over the depth (``csv``), or an
        element of a program: the hollow sphere or a user function of `Exudyn`_, IMPACT of Adams, or
        a tendon of MuJoCo.
    joint
        The joint. For Modelica, Exudyn, Adams and MuJoCo it must not be made from ratios.
    depth_star
        Maximum normalised penetration depth of the export; or the minimum and the maximum, between
        which ``power`` and the cubics of MuJoCo are fitted and errors are stated. The default
        maximum is 1, or less if the contact cannot be so deep; for ``power`` 0.05 and 0.5.
    tilt
        Angle in deg between the axis and the displacement. With it, ``tabulated`` and ``power``
        give the force along this direction, and the text states by how much force and stiffness
        change in directions up to 10 deg from it. The default is 90 for a ring or a ball with a
        bore, else the axis.
    name
        Name of the function or element, so that one model can contain several joints. The default
        is the name of the law or of the program's element.

    Raises
    ------
    ValueError
        If the law or the format is unknown, if the law does not apply to the format or the joint,
        or if a depth is beyond the range of the law or the joint.

    Examples
    --------
    >>> text = export("stiffened_hertz", "c", Joint.from_ratios(r2_star=200))
    >>> "int stiffened_hertz(double depth" in text
    True

    .. _Exudyn: https://exudyn.readthedocs.io
    """
    checks.choice("law", law, [*LAWS, "tabulated"])
    checks.choice("format", form, SUFFIXES)
    if name is not None and (not NAME.fullmatch(name) or keyword.iskeyword(name)):
        wanted = (
            "name must begin with a letter and consist of at most 63 letters, digits and "
            "underscores, without being a keyword of Python"
        )
        raise ValueError(f"{wanted}, got {name!r}")
    if not checks.instance("joint", joint, Joint).has_dimensions:
        checks.choice("format of a joint without dimensions", form, formulas.DIMENSIONLESS)
    checks.choice(f"law in format {form}", law, [LAW_OF.get(form, law)])
    tilt = joint.default_tilt if tilt is None else tilt
    if tilt is not None:
        checks.choice("law for a displacement off the axis", law, ["tabulated", "power"])
    content = _Law(law, joint, depth_star, tilt, FIRST if form == "mujoco" else SHALLOWEST, name)
    if form == "json":
        return _json(content)
    if form == "csv":
        return _csv(content)
    if form == "mujoco":
        return _tendon(content)
    if form in ELEMENTS and law == "power":
        return _element(content, form)
    return _function(content, form)


class _Law:
    """A law for one joint, as every format needs it: its parts, its range and its errors."""

    def __init__(self, name, joint, depth_star, tilt, shallowest, called):
        self.name, self.joint, self.called = name, joint, called
        options = {} if name in ("power", "tabulated") else joint.law_options(name)
        least, deepest = _range(depth_star, name == "power", shallowest)
        # k and n are those of `study.joint.Joint.power_law`, from the same table and depths
        self.exact = table(joint, None if name == "power" else deepest, tilt)
        if deepest is not None and self.exact.deepest < deepest:
            self.exact = table(joint, deepest, tilt)
        curve = self.exact.curve
        self.deepest = deepest = min(1.0, self.exact.deepest) if deepest is None else deepest
        if name == "power":
            places = np.geomspace(least, deepest, DEPTHS)
            options = joint.law_options(name, places, self.exact(places))
        law = LAWS.get(name, self.exact)
        law(deepest, joint.r2_star, **options)  # raises an error for a depth beyond its range
        self.scale, self.shape, self.constants = law.parts(joint.r2_star, **options)
        first = float(curve.depth_star[0])
        self.least = min(max(least, first), deepest)
        depths = np.linspace(np.sqrt(self.least), np.sqrt(deepest), ROWS) ** 2
        self.error = float(np.abs(self.at(depths)[0] / self.exact(depths) - 1).max())
        inside = (curve.depth_star >= self.least) & (curve.depth_star <= max(1.05 * deepest, first))
        self.error_of_joint = float(curve.force_error[inside].max()) + self.exact.error
        self.load = "a load along the axis"
        if tilt is not None:
            self.load = f"a displacement {tilt:g} deg off the axis{_change(joint, deepest, tilt)}"

    def at(self, depth):
        """Force and stiffness, dimensionless, at depths > 0."""
        value, slope = self.shape(depth, self.constants)
        return self.scale * value, self.scale * slope

    def in_words(self, error=None):
        """Lines on joint, range and error; a given ``error`` is that of a fit to the law."""
        if error is None and self.name != "tabulated":
            error = self.error
        text = f"that of the elastic solution, about {_percent(self.error_of_joint)}."
        if error is not None:
            text = f"at most {_percent(error)} relative to the elastic solution, plus {text}"
        joint = self.joint
        units = {name: meaning.split(",")[0] for name, meaning in _OF_SIZES.items()}
        stated = [f"{name} {value:.9g} {units[name]}" for name, value in _sizes(joint).items()]
        if joint.has_dimensions:
            stated[1] += f" ({1e6 * joint.clearance:.4g} um)"
            stated += [f"{body} of {material}" for body, material in _materials(joint).items()]
        for name, value in _ratios(joint).items():
            several = value if isinstance(value, list) else [value]
            shown = (f"{x:.9g}" if isinstance(x, float) else x for x in several)
            stated.append(f"{name} {' and '.join(shown)}")
        return [
            f"Joint: {', '.join(stated)}.",
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
        f"to {_percent(force)} and the stiffness by up to {_percent(stiffness)}"
    )


def _function(law, language):
    name = law.called or FUNCTIONS.get(law.name, law.name)
    if language == "modelica":
        name = law.called or "ClearanceJoint"
    text = formulas.text(
        language,
        law.shape,
        law.constants,
        [*law.in_words(), "", f"Formula: {formulas.words(law.shape, law.constants)}."],
        law=name,
        title=f"Contact force of one spherical clearance joint: {law.name}.",
        source=_SOURCE,
        deepest=f"{law.deepest!r}",
        margin=laws.LIMIT_MARGIN,
        scale=f"{float(law.scale)!r}",
        **formulas.of_joint(language, name, law.joint),
    )
    return _named(text, law.called) if language == "exudyn" else text


def _named(text, name):
    """A text in Python in which the top-level names contain a name, if one is given."""
    if name is None:
        return text
    return re.sub(_PYTHON, rf"{name}_\1", text.replace("add_joint", f"add_{name}"))


def _element(law, form):
    """An element with k and n: a hollow sphere of Exudyn, or IMPACT of Adams in N and mm."""
    file, sign = ELEMENTS[form]
    joint, exponent = law.joint, float(law.constants[0])
    coefficient = float(law.scale * joint.force_unit / joint.clearance**exponent)
    text = formulas.filled(
        file,
        sign,
        law.in_words(),
        **_element_of(law),
        socket_radius=f"{joint.socket_radius!r}",
        ball_radius=f"{joint.ball_radius!r}",
        coefficient=f"{coefficient:.9g}",
        exponent=f"{exponent:.9g}",
        clearance_mm=f"{joint.clearance / MILLI:.9g}",
        coefficient_mm=f"{coefficient * MILLI**exponent:.9g}",
    )
    return _named(text, law.called) if form == "exudyn" else text


def _element_of(law):
    """Title, source and prefix of the names of an element."""
    title = f"A spherical clearance joint{f' named {law.called}' if law.called else ''}."
    prefix = f"{law.called}_" if law.called else ""
    return {"title": title, "source": _SOURCE, "prefix": prefix}


def _tendon(law):
    """Parallel spatial tendons of MuJoCo with cubics that are fitted to the elastic solution."""
    clearance, unit = law.joint.clearance, law.joint.force_unit
    knots = law.deepest * np.array(KNOTS)
    cubics, error = _cubics(law, knots)
    whole = sum(
        (np.polynomial.Polynomial([0, *c])(np.polynomial.Polynomial([-k, 1])))
        for c, k in zip(cubics, knots, strict=True)
    )
    turns = whole.deriv().roots()  # of the force beyond the last knot
    turn = turns[np.isreal(turns) & (turns.real > law.deepest)].real.min(initial=np.inf)
    outside = []
    for depth in law.least / np.array([2, 10]):
        exact, beyond = law.exact(depth), np.maximum(depth - knots, 0)
        off = (cubics * beyond[:, None] ** [1, 2, 3]).sum() / exact - 1
        outside.append(
            f"{clearance * depth:.2g} m it is {100 * abs(off):.2g} % too "
            f"{'large' if off > 0 else 'small'} ({unit * exact * abs(off):.2g} N)"
        )
    beyond = "it increases with depth at every depth."
    if turn < np.inf:
        beyond = f"it falls from {clearance * turn:.3g} m on, where it must not be used."
    outside = f"Outside: at {' and at '.join(outside)}; beyond the range {beyond}"
    names = _element_of(law)
    tendons = [
        _TENDON.format(
            name=f"{law.called or 'clearance_joint'}_{k}",
            starts=f"{clearance + clearance * knot:.12g}",
            stiffness=" ".join(f"{x:.9g}" for x in unit * cubic / clearance ** np.arange(1.0, 4)),
            prefix=names["prefix"],
        )
        for k, (cubic, knot) in enumerate(zip(cubics, knots, strict=True), 1)
    ]
    about = [*law.in_words(error), outside]
    return formulas.filled("tendon.mujoco", "", about, **names, tendons="\n".join(tendons))


_TENDON = """    <spatial name="{name}" springlength="0 {starts}" stiffness="{stiffness}">
      <site site="{prefix}socket"/>
      <site site="{prefix}ball"/>
    </spatial>"""


def _cubics(law, knots):
    """Coefficients of d, d^2, d^3 beyond each knot, (knots, 3), and their relative error.

    Its maximum is as small as it can be.
    """
    depth = np.geomspace(law.least, law.deepest, 4 * DEPTHS)
    depth = np.union1d(depth, knots[knots > law.least])  # where the error has a kink
    beyond = np.maximum(depth[:, None] - knots, 0)[..., None]
    columns = (beyond ** [1, 2, 3]).reshape(len(depth), -1) / law.exact(depth)[:, None]
    ones = np.ones((len(depth), 1))
    upper, lower = np.hstack([columns, -ones]), np.hstack([-columns, -ones])
    limits = np.append(ones, -ones)
    free = (None, None)  # but no pull where contact begins
    signs = [(0, None), (0, None), *[free] * (columns.shape[1] - 2), (0, None)]
    found = linprog([*[0] * columns.shape[1], 1], np.vstack([upper, lower]), limits, bounds=signs)
    return found.x[:-1].reshape(-1, 3), float(found.x[-1])


def _json(law):
    joint = law.joint
    content = {
        "law": law.name,
        **({"name": law.called} if law.called else {}),
        "source": _SOURCE,
        "formula": formulas.words(law.shape, law.constants),
        "units": _UNITS | (_OF_SIZES if joint.has_dimensions else {}),
        "joint": _ratios(joint),
        **({"materials": _materials(joint)} if joint.has_dimensions else {}),
        "load": law.load,
        "range": {"depth_star": [0, law.deepest]},
        "error": {
            "from_depth_star": law.least,
            "against_solved_joint": law.error,
            "of_solved_joint": law.error_of_joint,
        },
        "scale": float(law.scale),
        **_sizes(joint),
    }
    constants = np.asarray(law.constants, dtype=float)
    if law.shape is shapes.tabulated:
        content["root_depth_star"] = (np.arange(len(constants) // 2) / constants[0]).tolist()
        content |= {"stiffening": constants[1::2].tolist(), "slope": constants[2::2].tolist()}
    elif law.shape.polynomial:
        content["coefficients"] = constants[::-1].tolist()
    else:
        content |= dict(zip(law.shape.constants, constants.tolist(), strict=True))
    return json.dumps(content, indent=2) + "\n"


def _csv(law):
    depth = law.deepest * np.linspace(0, 1, ROWS + 1) ** 2
    force, stiffness = np.zeros((2, ROWS + 1))
    force[1:], stiffness[1:] = law.at(depth[1:])
    root = np.sqrt(depth)
    steps = (np.arange(1, _BETWEEN) / _BETWEEN)[:, None]
    between = np.sort((root[:-1] + steps * np.diff(root)).ravel() ** 2)
    between = between[between >= law.least]
    true = law.at(between)[0]
    linear, cubic = (
        _percent(np.abs(values / true - 1).max())
        for values in (
            np.interp(between, depth, force),
            CubicHermiteSpline(root, force, 2 * root * stiffness)(np.sqrt(between)),
        )
    )
    units, joint = _UNITS, law.joint
    if joint.has_dimensions:
        units, depth = _SI_UNITS, joint.clearance * depth
        force, stiffness = joint.force_unit * force, joint.stiffness_unit * stiffness
    names = list(units)
    lines = [
        f"Contact force of one spherical clearance joint: {law.called or law.name}. {_SOURCE}",
        *law.in_words(),
        f"Between rows, linear interpolation over depth adds an error of up to {linear}.",
        f"A cubic Hermite spline over sqrt({names[0]}), with the slopes 2 sqrt({names[0]}) "
        f"{names[2]}, adds {cubic}.",
        *(f"{name} = {meaning}" for name, meaning in units.items()),
    ]
    rows = (",".join(f"{x:.12g}" for x in row) for row in zip(depth, force, stiffness, strict=True))
    return "\n".join([*(f"# {line}" for line in lines), ",".join(names), *rows, ""])


def _ratios(joint):
    """What the normalised force depends on."""
    of = joint.columns()
    return {
        "r2_star": of["r2_star"],
        "socket_ratio": of["socket_ratio"],
        "poisson": [of["poisson_ball"], of["poisson_socket"]],
        "modulus_ratio": of["modulus_ratio"],
        **({"layers": of["layers"]} if of["layers"] else {}),
        **{name: str(value) for name, value in joint.supports.items()},
    }


def _materials(joint):
    return {body: in_words(material) for body, material in joint.materials.items()}


def _sizes(joint):
    """Dimensions of a joint in SI units, if it has any."""
    return {name: float(getattr(joint, name)) for name in _OF_SIZES if joint.has_dimensions}


def _percent(error):
    """An error with two digits, rounded up."""
    step = 10.0 ** (np.floor(np.log10(100 * error)) - 1) if error > 0 else 1.0
    return f"{np.ceil(100 * error / step) * step:.2g} %"
