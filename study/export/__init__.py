"""The study's own laws as text that other programs can use: C, JSON or CSV.

The C functions are self-contained (C89, its standard library alone), take SI units, check
their arguments and return 0, or the number of one that is out of range with nothing written. They
are the templates beside this file.
"""

import json
import textwrap
from pathlib import Path
from string import Template
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from study import checks, contact
from study.contact import laws, shapes
from study.joint import Joint, force_curve, whole_curve

Exported = Literal["stiffened_hertz", "tabulated"]
Format = Literal["c", "json", "csv"]
EXPORTED: tuple[Exported, ...] = get_args(Exported)
FORMATS: tuple[Format, ...] = get_args(Format)
ROOTS = 40  # depths of a table, in equal steps of sqrt(depth_star)

_SOURCE = "Spherical clearance joint study; see CITATION.cff there."


def export(law: Exported, form: Format, joint: Joint) -> str:
    """Text of a law in one of the formats.

    Parameters
    ----------
    law
        ``stiffened_hertz``, or ``tabulated`` from the force-depth curve of the joint.
    form
        C function; coefficients or table with formula and range (JSON); force over depth (CSV).
    joint
        The one joint that the text is for.

    Raises
    ------
    ValueError
        For an unknown law or format, or a joint that ``stiffened_hertz`` is not for.
    """
    checks.choice("law", law, EXPORTED)
    checks.choice("format", form, FORMATS)
    checks.instance("joint", joint, Joint)
    if law == "stiffened_hertz":
        checks.choice("kinematics of stiffened_hertz", joint.kinematics, ("linear",))
        return {"c": _stiffened_c, "json": _stiffened_json, "csv": _stiffened_csv}[form](joint)
    return {"c": _tabulated_c, "json": _tabulated_json, "csv": _tabulated_csv}[form](joint)


def _stiffened_json(joint):
    scale, _, constants = laws.stiffened_hertz.parts(joint.r2_star, **joint.stiffening_options())
    content = {
        "law": "stiffened_hertz",
        "source": _SOURCE,
        "formula": "P = E* dR^2 scale ds^(3/2) S, S = 1 + c1 u + ... + c9 u^9, u = s/(1 + s), "
        "s = sqrt(ds), ds = depth/dR",
        "joint": _described(joint),
        "range": {"depth_star": [0, shapes.LIMITS[shapes.stiffened]]},
        "scale": float(scale),
        "coefficients": constants[::-1].tolist(),
    }
    return json.dumps(content, indent=2) + "\n"


def _stiffened_csv(joint):
    deepest = shapes.LIMITS[shapes.stiffened]
    return _table(contact.stiffened_hertz, joint.r2_star, deepest, **joint.stiffening_options())


def _tabulated_csv(joint):
    return _table(_tabulated(joint)[0], joint.r2_star, 1.0)


def _table(law: laws.Law, r2_star: float, deepest: float, **options: Any) -> str:
    depth = deepest * np.linspace(0, 1, ROOTS + 1) ** 2
    force, slope = (law(depth, r2_star, derivative=d, **options) for d in (False, True))
    rows = zip(depth, force, slope, strict=True)
    lines = ["depth_star,force_star,stiffness_star"]
    return "\n".join([*lines, *(",".join(f"{x:.12g}" for x in row) for row in rows), ""])


def _tabulated(joint):
    """Law of a joint, and the largest error estimate of its curve from a depth of 0.005 on."""
    if joint.kinematics == "finite":
        curve = force_curve(joint, np.linspace(0, 1, ROOTS + 1)[1:] ** 2)
    else:
        curve = whole_curve(joint)
    return contact.tabulated(curve), float(curve.error_estimate[curve.depth_star >= 0.005].max())


def _tabulated_json(joint):
    law, error = _tabulated(joint)
    scale, _, constants = law.parts(joint.r2_star)
    content = {
        "law": "tabulated",
        "source": _SOURCE,
        "formula": "P = E* dR^2 scale ds^(3/2) S, S a cubic Hermite spline over sqrt(ds)",
        "joint": _described(joint),
        "range": {"depth_star": [0, 1]},
        "error_estimate_from_depth_0.005": error,
        "scale": float(scale),
        "root_depth_star": (np.arange(len(constants) // 2) / constants[0]).tolist(),
        "stiffening": constants[1::2].tolist(),
        "slope": constants[2::2].tolist(),
    }
    return json.dumps(content, indent=2) + "\n"


def _described(joint):
    return {
        "r2_star": joint.r2_star,
        "socket_ratio": joint.socket_ratio,
        "poisson": [joint.ball.poisson, joint.socket.poisson],
        "modulus_ratio": joint.modulus_ratio,
        **({"layers": joint.layers_text} if joint.layers else {}),
        "ball_drive": joint.ball_drive,
        "rim": joint.rim,
        "kinematics": joint.kinematics,
    }


def _stiffened_c(joint):
    scale, _, constants = laws.stiffened_hertz.parts(joint.r2_star, **joint.stiffening_options())
    return _filled(
        "stiffened_hertz",
        described=_comment(_listed(joint)),
        deepest=shapes.LIMITS[shapes.stiffened],
        coefficients=", ".join(f"{c:.17g}" for c in constants),
        scale=f"{float(scale):.17g}",
    )


def _listed(joint):
    return ", ".join(f"{key} {value}" for key, value in _described(joint).items())


def _tabulated_c(joint):
    law, error = _tabulated(joint)
    scale, _, constants = law.parts(joint.r2_star)
    described = f"{_listed(joint)}; relative error about {error:.1g} from ds = 0.005 on"
    knots = constants[1:].reshape(-1, 2)
    return _filled(
        "tabulated",
        described=_comment(described),
        knots=len(knots),
        last=len(knots) - 2,
        table=_braces(knots),
        steps=f"{constants[0]:.17g}",
        scale=f"{float(scale):.17g}",
    )


def _filled(law: str, **values: Any) -> str:
    template = Template(Path(__file__).with_name(f"{law}.c").read_text(encoding="utf-8"))
    return template.substitute(values, source=_SOURCE, margin=laws.LIMIT_MARGIN)


def _comment(text: str, width: int = 92) -> str:
    """Lines of a C comment."""
    return "\n".join(f" * {line}" for line in textwrap.wrap(text, width))


def _braces(matrix: NDArray[np.float64]) -> str:
    rows = ("{" + ", ".join(f"{float(x)!r}" for x in row) + "}" for row in matrix)
    return "{\n        " + ",\n        ".join(rows) + "}"
