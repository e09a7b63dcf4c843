"""Laws as text that other programs can use: C, MATLAB, JSON or CSV.

Each text is for one joint. It states the joint, the range of depths, the units, and the law's
largest error there against the solved joint. The functions take SI units and check their arguments.
The C function is C89 and needs the standard library only; the MATLAB one runs in GNU Octave too.
"""

import json
from typing import Any, Literal

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from study import checks, contact
from study.contact import LAWS, LawName, laws, shapes
from study.export import formulas
from study.joint import DirectionalLaw, Joint, directional_law, whole_curve
from study.joint.dimensional import usual_depth
from study.joint.supports import SUPPORTS

Exported = Literal[LawName, "tabulated"]
Format = Literal["c", "matlab", "json", "csv"]
SUFFIXES: dict[Format, str] = {"c": ".c", "matlab": ".m", "json": ".json", "csv": ".csv"}
SHALLOWEST = 0.005
"""Least depth_star of the stated error: below, the force is less than 1/1000 of that at 0.5."""
ROWS = 400  # of a CSV beside its first, in equal steps of sqrt(depth_star)
_BETWEEN = 8  # places between rows at which interpolation is checked
_SOURCE = "Spherical clearance joint study; see CITATION.cff there."
_UNITS = {
    "depth_star": "depth/dR, dR = R2 - R1 the clearance",
    "force_star": "force/(E* dR^2), 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2",
    "stiffness_star": "stiffness/(E* dR), of force over depth",
}
_DIRECTION_UNITS = {
    "depth_star": _UNITS["depth_star"],
    "tilt": "direction of the displacement off the axis, in deg",
    "force_star": f"{_UNITS['force_star']}, along the displacement",
    "transverse_star": "the same across it, towards larger tilt; at -tilt it has the other sign",
}


def export(
    law: Exported,
    form: Format,
    joint: Joint,
    depth_star: float | None = None,
    tilt: float | None = None,
) -> str:
    """Text of a law in one of the formats.

    Parameters
    ----------
    law
        Name of a law, or ``tabulated``: the force-depth curve of the joint.
    form
        Function (C; MATLAB and Octave), formula and numbers (JSON), or force over depth (CSV).
    joint
        The one joint that the text is for.
    depth_star
        Largest depth of the text, in clearances; by default 1, if the joint can go so deep.
    tilt
        Largest direction of a displacement off the axis, in deg: ``tabulated`` is then the table of
        depth and tilt of `study.joint.directional_law`, and gives forces along and across.

    Raises
    ------
    ValueError
        For an unknown law or format, a joint that ``stiffened_hertz`` is not for, or a depth beyond
        the range of the law or the joint.
    """
    checks.choice("law", law, [*LAWS, "tabulated"])
    checks.choice("format", form, SUFFIXES)
    checks.instance("joint", joint, Joint)
    if law == "stiffened_hertz":
        checks.choice("kinematics of stiffened_hertz", joint.kinematics, ("linear",))
        joint.correction_options()  # refused before the joint is solved
    deepest = usual_depth(joint)
    if depth_star is not None:
        deepest = checks.number("depth_star", depth_star, above=0, scalar=True)
    if tilt is not None:
        checks.choice("law beside tilt", law, ["tabulated"])
        checks.choice("format beside tilt", form, ["c", "matlab", "csv"])
        return _directions(directional_law(joint, deepest, tilt), form)
    content = _Law(law, joint, deepest)
    if form == "json":
        return _json(content)
    return _csv(content) if form == "csv" else _function(content, form)


class _Law:
    """What every format has of a law: its parts for the joint, its range, its error."""

    def __init__(self, name, joint, deepest):
        self.name, self.joint, self.deepest = name, joint, deepest
        options = joint.correction_options() if name == "stiffened_hertz" else {}
        if name != "tabulated":
            LAWS[name](deepest, joint.r2_star, **options)  # refuses a depth beyond its range
        curve = whole_curve(joint, deepest)
        exact = contact.tabulated(curve)
        law = exact if name == "tabulated" else LAWS[name]
        self.scale, self.shape, self.constants = law.parts(joint.r2_star, **options)
        self.least = min(SHALLOWEST, deepest / 12)
        estimates = curve.error_estimate[curve.depth_star >= self.least]
        depths = np.linspace(np.sqrt(self.least), np.sqrt(deepest), ROWS) ** 2
        self.error = float(np.abs(self.at(depths)[0] / exact(depths) - 1).max())
        self.error_of_joint = float(estimates.max())

    def at(self, depth):
        """Force and stiffness, dimensionless, at depths > 0."""
        value, slope = self.shape(depth, self.constants)
        return self.scale * value, self.scale * slope

    def in_words(self):
        """Joint, range and error, a line each."""
        error = f"the joint is solved within about {_percent(self.error_of_joint)}."
        if self.name != "tabulated":
            against = f"at most {_percent(self.error)} against the solved joint."
            error = f"{against} {error.capitalize()}"
        return [
            _joint_in_words(self.joint),
            f"Range: depths from 0 to {self.deepest:g} clearances.",
            f"Error of the force, from {self.least:g} clearances on: {error}",
        ]


def _function(law, language):
    return formulas.text(
        language,
        law.shape,
        law.constants,
        "\n".join([*law.in_words(), "", f"Formula: {formulas.words(law.shape)}."]),
        law=law.name,
        title=f"Contact force of one spherical clearance joint: {law.name}.",
        source=_SOURCE,
        deepest=f"{law.deepest!r}",
        margin=laws.LIMIT_MARGIN,
        scale=f"{float(law.scale)!r}",
    )


def _json(law):
    content = {
        "law": law.name,
        "source": _SOURCE,
        "formula": formulas.words(law.shape),
        "units": _UNITS,
        "joint": _parameters(law.joint),
        "range": {"depth_star": [0, law.deepest]},
        "error": {
            "from_depth_star": law.least,
            "against_solved_joint": law.error,
            "of_solved_joint": law.error_of_joint,
        },
        "scale": float(law.scale),
    }
    constants = np.asarray(law.constants, dtype=float)
    if law.shape is shapes.tabulated:
        content["root_depth_star"] = (np.arange(len(constants) // 2) / constants[0]).tolist()
        content |= {"stiffening": constants[1::2].tolist(), "slope": constants[2::2].tolist()}
    elif constants.size:  # from the highest power of the shape's polynomial
        content["coefficients"] = constants[::-1].tolist()
    return json.dumps(content, indent=2) + "\n"


def _csv(law):
    depth = law.deepest * np.linspace(0, 1, ROWS + 1) ** 2
    force, stiffness = np.zeros((2, ROWS + 1))
    force[1:], stiffness[1:] = law.at(depth[1:])
    errors = _interpolation_errors(law, depth, force, stiffness)
    linear, cubic = (_percent(np.abs(error).max()) for error in errors)
    lines = [
        f"Contact force of one spherical clearance joint: {law.name}. {_SOURCE}",
        *law.in_words(),
        f"Between rows, linear interpolation over depth adds an error of up to {linear}.",
        "A cubic Hermite spline over sqrt(depth_star), with the slopes 2 sqrt(depth_star) "
        f"stiffness_star, adds {cubic}.",
        *(f"{name} = {meaning}" for name, meaning in _UNITS.items()),
    ]
    rows = zip(depth, force, stiffness, strict=True)
    numbers = (",".join(f"{x:.12g}" for x in row) for row in rows)
    return "\n".join([*(f"# {line}" for line in lines), ",".join(_UNITS), *numbers, ""])


def _interpolation_errors(law, depth, force, stiffness):
    """Relative errors between rows: linear over the depth, and cubic over its square root."""
    root = np.sqrt(depth)
    steps = (np.arange(1, _BETWEEN) / _BETWEEN)[:, None]
    between = (root[:-1] + steps * np.diff(root)) ** 2
    between = np.sort(between[between >= law.least])
    linear = np.interp(between, depth, force)
    cubic = CubicHermiteSpline(root, force, 2 * root * stiffness)(np.sqrt(between))
    true = law.at(between)[0]
    return linear / true - 1, cubic / true - 1


def _directions(law: DirectionalLaw, form):
    """Text of a table of depth and tilt."""
    deepest, largest = float(law.depth_star[-1]), float(law.tilt[-1])
    title = "Contact force of one spherical clearance joint in all directions up to a tilt."
    words = [
        _joint_in_words(law.joint),
        f"Range: depths from 0 to {deepest:g} clearances, tilts from -{largest:g} to {largest:g} "
        "deg: the direction of the displacement off the socket's axis.",
        f"Error of the force, from {law.depth_star[0]:.3g} clearances on: the joint is solved, and "
        f"the table read, within about {_percent(law.error)}; below, it leads to Hertz's law.",
    ]
    if form in ("c", "matlab"):
        (row_steps, column_steps), scale = law.steps, contact.hertz(1.0, law.joint.r2_star)
        numbers = {"deepest": deepest, "largest": largest, "scale": scale}
        numbers |= {"row_steps": row_steps, "column_steps": column_steps}
        texts = {"law": "tabulated", "title": title, "source": _SOURCE}
        texts |= {"margin": laws.LIMIT_MARGIN} | {k: f"{x!r}" for k, x in numbers.items()}
        return formulas.of_directions(form, law.table, "\n".join(words), **texts)
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
        f"{title} {_SOURCE}",
        *words,
        "Between rows, linear interpolation over sqrt(depth_star) and tilt, of both forces over "
        f"depth_star^1.5, adds an error of up to {_percent(off.max())}.",
        *(f"{name} = {meaning}" for name, meaning in _DIRECTION_UNITS.items()),
    ]
    grid = np.broadcast_arrays(depth[:, None], tilt, along, across)
    numbers = (",".join(f"{x:.12g}" for x in row) for row in zip(*map(np.ravel, grid), strict=True))
    return "\n".join([*(f"# {line}" for line in lines), ",".join(_DIRECTION_UNITS), *numbers, ""])


def _joint_in_words(joint):
    texts = (f"{key} {_plain(value)}" for key, value in _parameters(joint).items())
    return f"Joint: {', '.join(texts)}."


def _percent(error):
    """An error with two digits, rounded up."""
    step = 10.0 ** (np.floor(np.log10(100 * error)) - 1) if error > 0 else 1.0
    return f"{np.ceil(100 * error / step) * step:.2g} %"


def _plain(value: Any) -> str:
    return " and ".join(f"{x:g}" for x in value) if isinstance(value, list) else f"{value}"


def _parameters(joint):
    return {
        "r2_star": joint.r2_star,
        "socket_ratio": joint.socket_ratio,
        "poisson": [joint.ball.poisson, joint.socket.poisson],
        "modulus_ratio": joint.modulus_ratio,
        **({"layers": joint.layers_text} if joint.layers else {}),
        **{name: getattr(joint, name) for name in SUPPORTS},
    }
