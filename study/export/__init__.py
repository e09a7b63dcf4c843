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
from study.joint import Joint, force_curve
from study.joint.compliance import RESOLUTION

Exported = Literal["stiffened_hertz", "tabulated"]
Format = Literal["c", "json", "csv"]
EXPORTED: tuple[Exported, ...] = get_args(Exported)
FORMATS: tuple[Format, ...] = get_args(Format)
ROOTS = 40  # depths of a table, in equal steps of sqrt(depth_star)

_SOURCE = "Spherical clearance joint study; see CITATION.cff there."
_SCOPE = "For a radially free ball, a mirror plane at the socket's rim and equal materials."


def export(law: Exported, form: Format, joint: Joint) -> str:
    """Text of a law in one of the formats.

    Parameters
    ----------
    law
        ``tabulated`` is made from the force-depth curve of ``joint``.
    form
        C function; coefficients or table with formula and range (JSON); force over depth (CSV).
    joint
        Its kinematics choose the coefficients of ``stiffened_hertz``; CSV, and everything of
        ``tabulated``, is for this joint alone.

    Raises
    ------
    ValueError
        For an unknown law or format, or a joint that ``stiffened_hertz`` is not for: unequal
        materials, another drive or rim, for CSV also values outside its range.
    """
    checks.choice("law", law, EXPORTED)
    checks.choice("format", form, FORMATS)
    checks.instance("joint", joint, Joint)
    if law == "stiffened_hertz":
        if joint.ball != joint.socket or joint.layers:
            raise ValueError("materials of ball and socket must be equal for stiffened_hertz")
        checks.choice("ball_drive of stiffened_hertz", joint.ball_drive, ("plane",))
        checks.choice("rim of stiffened_hertz", joint.rim, ("mirror",))
        return {"c": _stiffened_c, "json": _stiffened_json, "csv": _stiffened_csv}[form](joint)
    return {"c": _tabulated_c, "json": _tabulated_json, "csv": _tabulated_csv}[form](joint)


def _stiffened_json(joint):
    fit = _matrices(joint)
    ranges = {name: [low, high] for name, (low, high) in laws.STIFFENED_RANGES.items()} | {
        "depth_star": [0, shapes.LIMITS[shapes.stiffened]]
    }
    content = {
        "law": "stiffened_hertz",
        "source": _SOURCE,
        "formula": _formula(),
        "scope": _SCOPE,
        "kinematics": joint.kinematics,
        "range": ranges,
        "coefficients": ["a1", "a2", "b1", "b2", "b3"],
        "limit": fit[0].tolist(),
        "first_order": fit[1].tolist(),
    }
    return json.dumps(content, indent=2) + "\n"


def _formula():
    fit = laws.fitted_coefficients()["stiffened_hertz"]
    return (
        "P = E* dR^2 (4/3) sqrt(R2* (R2* - 1)) ds^(3/2) S, S = 1 + a1 u + a2 u^2 + b1 ds + b2 ds^2 "
        f"+ b3 ds^3; ds = depth/dR, R2* = R2/dR, s = sqrt(ds), u = s/(s + {fit['reach']} (q - 1)); "
        "(a1, a2, b1, b2, b3) = (limit + first_order/R2*) t, t the products of (1, 1/q, 1/q^4) and "
        f"(1, nu, 1/(1 - {fit['pole']} nu)); q socket ratio, nu Poisson's ratio, "
        "E* composite modulus"
    )


def _matrices(joint):
    fit = laws.fitted_coefficients()["stiffened_hertz"]
    checks.choice("kinematics", joint.kinematics, tuple(fit["first_order"]))
    return np.array([fit["limit"], fit["first_order"][joint.kinematics]])


def _stiffened_csv(joint):
    options = {"socket_ratio": joint.socket_ratio, "poisson": joint.ball.poisson}
    options["kinematics"] = joint.kinematics
    deepest = shapes.LIMITS[shapes.stiffened]
    return _table(contact.stiffened_hertz, joint.r2_star, deepest, **options)


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
    depths = np.linspace(0, 1, ROOTS + 1)[1:] ** 2
    finer = 2 * RESOLUTION["series"] if joint.series_applies else None  # for it costs little
    curve = force_curve(joint, depths, resolution=finer)
    return contact.tabulated(curve), float(curve.error_estimate[depths >= 0.005].max())


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
        "root_depth_star": np.linspace(0, 1, len(constants) // 2).tolist(),
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
        "layers": joint.layers_text,
        "ball_drive": joint.ball_drive,
        "rim": joint.rim,
        "kinematics": joint.kinematics,
    }


def _stiffened_c(joint):
    (least_r2_star, _), (thin, thick), (low, high) = laws.STIFFENED_RANGES.values()
    limit, first_order = _matrices(joint)
    fit = laws.fitted_coefficients()["stiffened_hertz"]
    return _filled(
        "stiffened_hertz",
        scope=_SCOPE,
        kinematics=joint.kinematics,
        formula=_comment(_formula()),
        least_r2_star=f"{least_r2_star:g}",
        double_r2_star=float(least_r2_star),
        thin=thin,
        thick=f"{thick:g}",
        double_thick=float(thick),
        low=low,
        high=high,
        limit=_braces(limit),
        first_order=_braces(first_order),
        deepest=shapes.LIMITS[shapes.stiffened],
        reach=fit["reach"],
        pole=fit["pole"],
    )


def _tabulated_c(joint):
    law, error = _tabulated(joint)
    scale, _, constants = law.parts(joint.r2_star)
    described = ", ".join(f"{key} {value}" for key, value in _described(joint).items())
    described += f"; relative error about {error:.1g} from depth/clearance = 0.005 on"
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
