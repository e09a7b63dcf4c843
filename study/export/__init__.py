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
from typing import Any, Literal

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import linprog

from study import checks, contact
from study.contact import LAWS, LawName, laws, shapes
from study.contact.materials import in_words
from study.contact.power_fit import DEPTHS, USUAL_RANGE
from study.export import formulas
from study.joint import DimensionalJoint, DirectionalLaw, Joint, directional_law, whole_curve
from study.joint.dimensional import usual_depth
from study.joint.law_parameters import law_parameters
from study.joint.tilted import tilted_curve

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
_TILTED_UNITS = {
    "depth_star": _UNITS["depth_star"],
    "tilt": "direction of the displacement off the axis, in deg",
    "force_star": f"{_UNITS['force_star']}, along the displacement",
    "transverse_star": "the same across it, towards larger tilt; at -tilt it has the other sign",
}


def export(
    law: Exported,
    form: Format,
    joint: Joint | DimensionalJoint,
    depth_star: float | Sequence[float] | None = None,
    tilt: float | None = None,
    direction: float | None = None,
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
        The joint. Modelica, Exudyn, Adams and MuJoCo need its dimensions.
    depth_star
        Maximum normalised penetration depth of the export; or the minimum and the maximum, between
        which ``power`` and the cubics of MuJoCo are fitted and errors are stated. The default
        maximum is 1, or less if the contact cannot be so deep; for ``power`` 0.05 and 0.5.
    tilt
        Maximum angle in deg between displacement and axis. With it, ``tabulated`` is the table over
        depth and tilt of `study.joint.directional_law`, with forces along and across the
        displacement.
    direction
        Angle in deg between the axis and the only direction of displacement. With it, ``tabulated``
        and ``power`` give the force along this direction. The default is 90 for a ring or a ball
        with a bore, else 0.
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
    >>> text = export("stiffened_hertz", "c", Joint(r2_star=200))
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
    if isinstance(joint, DimensionalJoint):
        plain, sized = joint.joint, joint
    else:
        plain, sized = checks.instance("joint", joint, Joint), None
        checks.choice("format of a joint without dimensions", form, formulas.DIMENSIONLESS)
    checks.choice(f"law in format {form}", law, [LAW_OF.get(form, law)])
    if law == "stiffened_hertz":
        plain.check_linear(law)
        plain.correction_options()  # raises an error before the joint is solved
    shallowest = FIRST if form == "mujoco" else SHALLOWEST
    least, deepest = _range(depth_star, plain, law == "power", shallowest)
    if tilt is not None:
        if not plain.has_pole:
            raise ValueError(
                "tilt does not apply to a ring or a ball with a bore, because its table of depth "
                "and tilt would begin on the axis; give the direction of the displacement instead"
            )
        checks.choice("law with a tilt", law, ["tabulated"])
        checks.choice("format with a tilt", form, ["c", "matlab", "csv"])
        return _tilted(directional_law(plain, deepest, tilt), form, sized, name)
    direction = plain.default_tilt if direction is None else direction
    if direction is not None:
        checks.choice("law for a direction off the axis", law, ["tabulated", "power"])
    content = _Law(law, plain, sized, (least, deepest), direction, name)
    if form == "json":
        return _json(content)
    if form == "csv":
        return _csv(content)
    if form == "mujoco":
        return _tendon(content)
    if form in ELEMENTS and law == "power":
        return _element(content, form)
    return _function(content, form)


def _range(depth_star, joint, fitted, shallowest):
    if depth_star is None:
        least, deepest = USUAL_RANGE if fitted else (None, usual_depth(joint))
    else:
        given = np.atleast_1d(checks.number("depth_star", depth_star, above=0))
        if given.shape not in ((1,), (2,)):
            wanted = "depth_star must be one depth, or the minimum and the maximum depth"
            raise ValueError(f"{wanted}, got {checks.shown(depth_star)}")
        least, deepest = given[0] if len(given) == 2 else None, float(given[-1])
    if least is None:
        least = deepest / 10 if fitted else min(shallowest, deepest / 12)
    return checks.number("minimum depth_star", least, above=0, below=deepest, scalar=True), deepest


class _Law:
    """A law for one joint, as every format needs it: its parts, its range and its error."""

    def __init__(self, name, joint, sized, depths, direction, called):
        self.name, self.joint, self.sized, self.called = name, joint, sized, called
        self.least, self.deepest = least, deepest = depths
        if direction is None:
            self.load, curve = "along the axis", whole_curve(joint, deepest)
        else:
            self.load = f"along a displacement {direction:g} deg off the axis"
            curve = tilted_curve(joint, direction, deepest)
            self.least = max(least, float(curve.depth_star.min()))
        self.exact = contact.tabulated(curve)
        depths = np.linspace(np.sqrt(self.least), np.sqrt(deepest), ROWS) ** 2
        law, options = LAWS.get(name, self.exact), {}
        if name != "tabulated":
            options = law_parameters(law, joint, depths, self.exact(depths))
            law(deepest, joint.r2_star, **options)  # raises an error for a depth beyond its range
        self.scale, self.shape, self.constants = law.parts(joint.r2_star, **options)
        estimates = curve.error_estimate[curve.depth_star >= self.least]
        self.error = float(np.abs(self.at(depths)[0] / self.exact(depths) - 1).max())
        self.error_of_joint = float(estimates.max())

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
        return [
            _joint_in_words(self.joint, self.sized),
            f"Range: penetration depths from 0 to {_depth(self.deepest, self.sized)}.",
            f"Error of the force at depths >= {_depth(self.least, self.sized)}: {text}",
            f"The law is for smooth elastic bodies without friction and a load {self.load}.",
        ]


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
        **formulas.of_joint(language, name, law.joint, law.sized),
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
    sized, (exponent,) = law.sized, law.constants
    modulus = law.joint.composite_modulus
    coefficient = float(modulus * sized.clearance ** (2 - exponent) * law.scale)
    text = formulas.filled(
        file,
        sign,
        law.in_words(),
        **_element_of(law),
        prefix=f"{law.called}_" if law.called else "",
        socket_radius=f"{sized.socket_radius!r}",
        ball_radius=f"{sized.socket_radius - sized.clearance!r}",
        coefficient=f"{coefficient:.9g}",
        exponent=f"{float(exponent):.9g}",
        clearance_mm=f"{sized.clearance / MILLI:.9g}",
        coefficient_mm=f"{coefficient * MILLI ** float(exponent):.9g}",
    )
    return _named(text, law.called) if form == "exudyn" else text


def _element_of(law):
    """Title and source of an element."""
    title = f"A spherical clearance joint{f' named {law.called}' if law.called else ''}."
    return {"title": title, "source": _SOURCE}


def _tendon(law):
    """Parallel spatial tendons of MuJoCo with cubics that are fitted to the elastic solution."""
    clearance, modulus = law.sized.clearance, float(law.joint.composite_modulus)
    knots = law.deepest * np.array(KNOTS)
    cubics, error = _cubics(law, knots)
    whole = sum(
        (np.polynomial.Polynomial([0, *c])(np.polynomial.Polynomial([-k, 1])))
        for c, k in zip(cubics, knots, strict=True)
    )
    turns = whole.deriv().roots()  # of the force beyond the last knot
    turn = turns[np.isreal(turns) & (turns.real > law.deepest)].real.min(initial=np.inf)
    below = law.least / np.array([2, 10])
    off = (law.exact(below) ** -1) * _sum(cubics, knots, below) - 1
    unit, lengths = modulus * clearance**2, clearance * below
    told = [
        f"{d:.2g} m it is {100 * abs(e):.2g} % too {'large' if e > 0 else 'small'} "
        f"({unit * f:.2g} N)"
        for d, e, f in zip(lengths, off, law.exact(below) * np.abs(off), strict=True)
    ]
    beyond = "it increases with depth at every depth."
    if turn < np.inf:
        beyond = f"it falls from {clearance * turn:.3g} m on, where it must not be used."
    units = modulus * clearance ** np.array([1.0, 0.0, -1.0])
    prefix = f"{law.called}_" if law.called else ""
    tendons = [
        {
            "name": f"{law.called or 'clearance_joint'}_{k}",
            "starts": f"{clearance + clearance * knot:.12g}",
        }
        | {"stiffness": " ".join(f"{x:.9g}" for x in cubic * units)}
        for k, (cubic, knot) in enumerate(zip(cubics, knots, strict=True), 1)
    ]
    outside = f"Outside: at {' and at '.join(told)}; beyond the range {beyond}"
    return formulas.filled(
        "tendon.mujoco",
        "",
        [*law.in_words(error), outside],
        **_element_of(law),
        tendons="\n".join(_TENDON.format(**of, prefix=prefix) for of in tendons),
        prefix=prefix,
    )


_TENDON = """    <spatial name="{name}" springlength="0 {starts}" stiffness="{stiffness}">
      <site site="{prefix}socket"/>
      <site site="{prefix}ball"/>
    </spatial>"""


def _sum(cubics, knots, depth):
    """Dimensionless force of cubics that begin at knots."""
    beyond = np.maximum(depth - knots[:, None], 0)
    return sum(beyond**power * cubics[:, power - 1, None] for power in (1, 2, 3)).sum(axis=0)


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
    content = {
        "law": law.name,
        **({"name": law.called} if law.called else {}),
        "source": _SOURCE,
        "formula": formulas.words(law.shape, law.constants),
        "units": _UNITS | (_OF_SIZES if law.sized else {}),
        "joint": _parameters(law.joint),
        **({"materials": _materials(law.sized)} if law.sized else {}),
        "range": {"depth_star": [0, law.deepest]},
        "error": {
            "from_depth_star": law.least,
            "against_solved_joint": law.error,
            "of_solved_joint": law.error_of_joint,
        },
        "scale": float(law.scale),
        **_sizes(law.sized),
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
    linear, cubic = _interpolation_errors(law, depth, force, stiffness)
    units = _UNITS
    if law.sized:
        units, modulus = _SI_UNITS, law.joint.composite_modulus
        depth, stiffness = law.sized.clearance * depth, modulus * law.sized.clearance * stiffness
        force = modulus * law.sized.clearance**2 * force
    names = list(units)
    lines = [
        f"Contact force of one spherical clearance joint: {law.called or law.name}. {_SOURCE}",
        *law.in_words(),
        f"Between rows, linear interpolation over depth adds an error of up to {linear}.",
        f"A cubic Hermite spline over sqrt({names[0]}), with the slopes 2 sqrt({names[0]}) "
        f"{names[2]}, adds {cubic}.",
    ]
    return _table(lines, units, [depth, force, stiffness])


def _table(lines, units, columns):
    """Text of a table as CSV: comments, the meaning of each column, and the columns."""
    meanings = (f"{name} = {meaning}" for name, meaning in units.items())
    rows = (",".join(f"{x:.12g}" for x in row) for row in zip(*columns, strict=True))
    return "\n".join([*(f"# {line}" for line in (*lines, *meanings)), ",".join(units), *rows, ""])


def _interpolation_errors(law, depth, force, stiffness):
    """Largest errors between rows: linear over the depth, and cubic over its square root."""
    root = np.sqrt(depth)
    steps = (np.arange(1, _BETWEEN) / _BETWEEN)[:, None]
    between = (root[:-1] + steps * np.diff(root)) ** 2
    between = np.sort(between[between >= law.least])
    linear = np.interp(between, depth, force)
    cubic = CubicHermiteSpline(root, force, 2 * root * stiffness)(np.sqrt(between))
    true = law.at(between)[0]
    return [_percent(np.abs(values / true - 1).max()) for values in (linear, cubic)]


def _tilted(law: DirectionalLaw, form, sized, name):
    deepest, largest = float(law.depth_star[-1]), float(law.tilt[-1])
    title = "Contact force of one spherical clearance joint in all directions up to a tilt."
    words = [
        _joint_in_words(law.joint, sized),
        f"Range: penetration depths from 0 to {_depth(deepest, sized)}, tilts from -{largest:g} to "
        f"{largest:g} deg; the tilt is the angle between the displacement and the socket's axis.",
        f"Error of the force at depths >= {law.depth_star[0]:.3g} clearances: about "
        f"{_percent(law.error)}, of the elastic solution and the table together; at smaller depths "
        "the table approaches Hertz's law.",
    ]
    if form in ("c", "matlab"):
        (row_steps, column_steps), scale = law.steps, contact.hertz(1.0, law.joint.r2_star)
        numbers = {"deepest": deepest, "largest": largest, "scale": scale}
        numbers |= {"row_steps": row_steps, "column_steps": column_steps}
        called = name or "tabulated"
        texts = {"law": called, "title": title, "source": _SOURCE}
        texts |= {"margin": laws.LIMIT_MARGIN} | {k: f"{x!r}" for k, x in numbers.items()}
        texts |= formulas.of_joint(form, called, law.joint, sized, first=3)
        return formulas.of_tilt(form, law.table, words, **texts)
    _, rows, columns = law.table.shape
    depth = deepest * np.linspace(0, 1, rows - 2)[1:] ** 2
    tilt = np.linspace(0, largest, columns - 2)
    along, across = law.force(depth[:, None], tilt)
    middle = np.array([along, across]) / depth[:, None] ** 1.5
    middle = (middle[:, 1:] + middle[:, :-1]) / 2
    middle = (middle[..., 1:] + middle[..., :-1]) / 2
    between = (np.sqrt(depth[1:]) + np.sqrt(depth[:-1]))[:, None] ** 2 / 4
    true = np.array(law.force(between, (tilt[1:] + tilt[:-1]) / 2))
    off = np.hypot(*(middle * between**1.5 - true)) / np.hypot(*true)
    lines = [
        f"{f'{name}: ' if name else ''}{title} {_SOURCE}",
        *words,
        "Between rows, linear interpolation over sqrt(depth_star) and tilt, of both forces over "
        f"depth_star^1.5, adds an error of up to {_percent(off.max())}.",
    ]
    grid = np.broadcast_arrays(depth[:, None], tilt, along, across)
    return _table(lines, _TILTED_UNITS, map(np.ravel, grid))


def _depth(depth_star, sized):
    """A depth in clearances, and in um if the clearance is known."""
    in_um = f" ({1e6 * depth_star * sized.clearance:.4g} um)" if sized else ""
    return f"{depth_star:g} clearances{in_um}"


def _joint_in_words(joint, sized):
    units = {name: text.split(",")[0] for name, text in _OF_SIZES.items()}
    texts = [f"{name} {value:.9g} {units[name]}" for name, value in _sizes(sized).items()]
    if sized:
        texts[1] += f" ({1e6 * sized.clearance:.4g} um)"
        texts += [f"{body} of {material}" for body, material in _materials(sized).items()]
    texts += [f"{name} {_plain(value)}" for name, value in _parameters(joint).items()]
    return f"Joint: {', '.join(texts)}."


def _materials(sized):
    return {body: in_words(material) for body, material in sized.materials.items()}


def _sizes(sized):
    if sized is None:
        return {}
    values = {name: getattr(sized, name) for name in ("socket_radius", "clearance", "wall")}
    return values | {"composite_modulus": float(sized.joint.composite_modulus)}


def _percent(error):
    """An error with two digits, rounded up."""
    step = 10.0 ** (np.floor(np.log10(100 * error)) - 1) if error > 0 else 1.0
    return f"{np.ceil(100 * error / step) * step:.2g} %"


def _plain(value: Any) -> str:
    if isinstance(value, list):
        return " and ".join(f"{x:g}" for x in value)
    return f"{value:.9g}" if isinstance(value, float) else f"{value}"


def _parameters(joint):
    return {
        "r2_star": joint.r2_star,
        "socket_ratio": joint.socket_ratio,
        "poisson": [joint.ball.poisson, joint.socket.poisson],
        "modulus_ratio": joint.modulus_ratio,
        **({"layers": joint.columns()["layers"]} if joint.layers else {}),
        **{n: v if isinstance(v, float) else str(v) for n, v in joint.configuration.items()},
    }
