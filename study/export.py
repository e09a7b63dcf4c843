"""The study's own laws as text that other programs can use: C, JSON or CSV.

The C functions are self-contained (C89, its standard library alone), take SI units, check
their arguments and return 0, or the number of one that is out of range with nothing written.
"""

import io
import json
import textwrap
from typing import Literal, get_args

import numpy as np
import pandas as pd

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


def export(law, form, joint):
    """Text of a law in one of the formats.

    Parameters
    ----------
    law : {"stiffened_hertz", "tabulated"}
        ``tabulated`` is made from the force-depth curve of ``joint``.
    form : {"c", "json", "csv"}
        C function; coefficients or table with formula and range; force over depth.
    joint : study.joint.Joint
        Its kinematics choose the coefficients of ``stiffened_hertz``; CSV, and everything of
        ``tabulated``, is for this joint alone.

    Returns
    -------
    str

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
        _check_stiffened(joint)
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


def _check_stiffened(joint):
    if joint.ball != joint.socket:
        raise ValueError("materials of ball and socket must be equal for stiffened_hertz")
    checks.choice("ball_drive of stiffened_hertz", joint.ball_drive, ("plane",))
    checks.choice("rim of stiffened_hertz", joint.rim, ("mirror",))


def _stiffened_csv(joint):
    options = {"socket_ratio": joint.socket_ratio, "poisson": joint.ball.poisson}
    options["kinematics"] = joint.kinematics
    deepest = shapes.LIMITS[shapes.stiffened]
    return _table(contact.stiffened_hertz, joint.r2_star, deepest, **options)


def _tabulated_csv(joint):
    law, _ = _tabulated(joint)
    return _table(law, joint.r2_star, 1.0)


def _table(law, r2_star, deepest, **options):
    depth = deepest * np.linspace(0, 1, ROOTS + 1) ** 2
    table = pd.DataFrame(
        {
            "depth_star": depth,
            "force_star": law(depth, r2_star, **options),
            "stiffness_star": law(depth, r2_star, derivative=True, **options),
        }
    )
    text = io.StringIO()
    table.to_csv(text, index=False, float_format="%.12g", lineterminator="\n")
    return text.getvalue()


def _tabulated(joint):
    """Law of a joint, and the largest error estimate of its curve from a depth of 0.005 on."""
    depths = np.linspace(0, 1, ROOTS + 1)[1:] ** 2
    curve = force_curve(joint, depths)
    if curve.solver == "series":  # finer than usual, for it costs little
        curve = force_curve(joint, depths, resolution=2 * RESOLUTION["series"])
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
        "ball_drive": joint.ball_drive,
        "rim": joint.rim,
        "kinematics": joint.kinematics,
    }


def _stiffened_c(joint):
    ranges = laws.STIFFENED_RANGES
    (least_r2_star, _), (thin, thick), (low, high) = ranges.values()
    limit, first_order = _matrices(joint)
    fit = laws.fitted_coefficients()["stiffened_hertz"]
    return f"""/* Contact force of a ball in a spherical socket: stiffened Hertz.
 * {_SOURCE}
 * {_SCOPE}
 * Kinematics: {joint.kinematics}.
{_comment(_formula())}
 *
 * depth              penetration depth, m; no force where it is negative; at most the clearance
 * ball_radius        R1, m
 * socket_radius      R2, m; R2/(R2 - R1) at least {least_r2_star:g}
 * composite_modulus  E*, Pa; 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
 * socket_ratio       outer over inner radius of the socket, {thin:g} to {thick:g}
 * poisson            Poisson's ratio of both bodies, {low:g} to {high:g}
 * force, stiffness   results, N and N/m
 *
 * Returns 0, or the number of an argument out of range (nothing is written then).
 */
#include <float.h>
#include <math.h>

int stiffened_hertz(double depth, double ball_radius, double socket_radius,
                    double composite_modulus, double socket_ratio, double poisson,
                    double *force, double *stiffness)
{{
    static const double limit[5][9] = {_braces(limit)};
    static const double first_order[5][9] = {_braces(first_order)};
    const double most = 1 + {laws.LIMIT_MARGIN}, least = 1 - {laws.LIMIT_MARGIN};
    double clearance, r2_star, ds, thickness[3], material[3], c[5];
    double s, u, factor, growth, scale;
    int i, j, k;

    if (!(ball_radius > 0)) return 2;
    clearance = socket_radius - ball_radius;
    r2_star = socket_radius / clearance;
    if (!(clearance > 0 && r2_star >= {least_r2_star:.1f} * least)) return 3;
    if (!(composite_modulus > 0 && composite_modulus <= DBL_MAX)) return 4;
    if (!(socket_ratio >= {thin} && socket_ratio <= {thick:.1f})) return 5;
    if (!(poisson >= {low} && poisson <= {high})) return 6;
    ds = depth / clearance;
    if (!(ds <= {shapes.LIMITS[shapes.stiffened]:.1f} * most)) return 1;
    if (ds <= 0) {{ *force = 0; *stiffness = 0; return 0; }}

    thickness[0] = 1; thickness[1] = 1 / socket_ratio; thickness[2] = pow(socket_ratio, -4);
    material[0] = 1; material[1] = poisson; material[2] = 1 / (1 - {fit["pole"]} * poisson);
    for (i = 0; i < 5; i++) {{
        c[i] = 0;
        for (j = 0; j < 3; j++)
            for (k = 0; k < 3; k++)
                c[i] += (limit[i][3*j + k] + first_order[i][3*j + k] / r2_star)
                        * thickness[j] * material[k];
    }}
    s = sqrt(ds);
    u = s / (s + {fit["reach"]} * (socket_ratio - 1));
    factor = 1 + u * (c[0] + u * c[1]) + ds * (c[2] + ds * (c[3] + ds * c[4]));
    growth = u * (1 - u) * (c[0] / 2 + u * c[1]) + ds * (c[2] + ds * (2 * c[3] + ds * 3 * c[4]));
    scale = composite_modulus * clearance * 4 / 3 * sqrt(r2_star * (r2_star - 1));
    *force = scale * clearance * ds * s * factor;
    *stiffness = scale * s * (1.5 * factor + growth);
    return 0;
}}
"""


def _tabulated_c(joint):
    law, error = _tabulated(joint)
    scale, _, constants = law.parts(joint.r2_star)
    described = ", ".join(f"{key} {value}" for key, value in _described(joint).items())
    described += f"; relative error about {error:.1g} from depth/clearance = 0.005 on"
    knots = constants[1:].reshape(-1, 2)
    return f"""/* Contact force of one spherical clearance joint, from its force-depth curve.
 * {_SOURCE}
{_comment(described)}
 *
 * depth              penetration depth, m; no force where it is negative; at most the clearance
 * clearance          R2 - R1, m
 * composite_modulus  E*, Pa; 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2
 * force, stiffness   results, N and N/m
 *
 * Returns 0, or the number of an argument out of range (nothing is written then).
 */
#include <float.h>
#include <math.h>

int tabulated(double depth, double clearance, double composite_modulus,
              double *force, double *stiffness)
{{
    /* stiffening over Hertz and its slope, at equal steps of sqrt(depth/clearance) */
    static const double table[{len(knots)}][2] = {_braces(knots)};
    double ds, s, x, rise, m0, m1, c2, c3, factor, slope, scale;
    int k;

    if (!(clearance > 0 && clearance <= DBL_MAX)) return 2;
    if (!(composite_modulus > 0 && composite_modulus <= DBL_MAX)) return 3;
    ds = depth / clearance;
    if (!(ds <= 1 + {laws.LIMIT_MARGIN})) return 1;
    if (ds <= 0) {{ *force = 0; *stiffness = 0; return 0; }}

    s = sqrt(ds);
    x = s * {constants[0]:.17g};
    k = x < {len(knots) - 2} ? (int)x : {len(knots) - 2};
    x -= k;
    rise = table[k + 1][0] - table[k][0];
    m0 = table[k][1] / {constants[0]:.17g};
    m1 = table[k + 1][1] / {constants[0]:.17g};
    c2 = 3 * rise - 2 * m0 - m1;
    c3 = m0 + m1 - 2 * rise;
    factor = table[k][0] + x * (m0 + x * (c2 + x * c3));
    slope = (m0 + x * (2 * c2 + x * 3 * c3)) * {constants[0]:.17g};
    scale = composite_modulus * clearance * {float(scale):.17g};
    *force = scale * clearance * ds * s * factor;
    *stiffness = scale * (1.5 * s * factor + ds * slope / 2);
    return 0;
}}
"""


def _comment(text, width=92):
    """Lines of a C comment."""
    return "\n".join(f" * {line}" for line in textwrap.wrap(text, width))


def _braces(matrix):
    rows = ("{" + ", ".join(f"{float(x)!r}" for x in row) + "}" for row in matrix)
    return "{\n        " + ",\n        ".join(rows) + "}"
