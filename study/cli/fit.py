"""The command that compares laws with a curve of the user: study fit."""

import csv
import re
from pathlib import Path
from typing import Literal

import numpy as np
import typer

from study import checks, paths
from study.cli import options as cli
from study.cli.output import columns, show, working
from study.cli.solve_joint import RELATIVE, SAME_BYTES, SIZED, joint_of

NO_UNIT = "none"
UNITS = {
    "depth": {"um": 1e-6, "mm": 1e-3, "m": 1.0, NO_UNIT: 1.0},
    "force": {"N": 1.0, "kN": 1e3, NO_UNIT: 1.0},
}
"""Units of a curve -> their size in m or N."""
_ALSO = {"µm": "um", "star": NO_UNIT}  # at the end of a head, as in depth_star
SHOWN = {"clearance": ("um", 1e6), "modulus": ("GPa", 1e-9), "offset": ("um", 1e6)}
"""Units in which fitted quantities are printed, and factors from SI units."""


@cli.command(
    "fit",
    sections={
        "Curve": ("depth_column", "force_column", "depth_unit", "force_unit"),
        "Fit": ("fit",),
    }
    | cli.SECTIONS
    | {
        "Output": ("as_json", "plot"),
    },
    examples=[
        "fit examples/fit_your_curve.csv --fit clearance --fit offset \\\n"
        "      --socket-radius 12.5e-3 --clearance 40e-6 --wall 6e-3 --socket bronze",
    ],
)
def fit_own_curve(
    curve: Path = typer.Argument(
        help="CSV file with a line of column names and a row for each point. It needs a column of "
        "penetration depths and a column of forces, such as 'depth [um]' and 'force [N]', or "
        "depth_star and force_star.",
        metavar="FILE",
    ),
    depth_column: str = cli.option(
        "Name of the column of depths, if it does not begin with 'depth'."
    ),
    force_column: str = cli.option(
        "Name of the column of forces, if it does not begin with 'force'."
    ),
    depth_unit: Literal["m", "mm", "um", "none"] = cli.option(
        "Unit of the depths, if the name of their column has none. 'none' means normalised depths "
        "d/dR."
    ),
    force_unit: Literal["N", "kN", "none"] = cli.option(
        "Unit of the forces, if the name of their column has none. 'none' means normalised forces "
        "P/(E* dR^2)."
    ),
    fit: list[str] = cli.option(
        "Parameter to fit by least squares of the force: clearance (the search begins at "
        "--clearance), modulus (the composite modulus E*) or offset (the depth reading at first "
        "touch); may be repeated."
    ),
    plot: Path = cli.option(
        "File for a figure of the curve and the laws, ending in .png, .svg or .pdf."
    ),
    as_json: bool = cli.JSON,
    **joint: RELATIVE | SIZED,
):
    """Compare the contact laws with your own force-depth curve, and fit unknown parameters.

    The curve may come from finite elements or a test rig, and is for a load along the axis.
    Describe its joint as for study joint: with dimensions for a curve with units, without for a
    curve in normalised depths and forces. If no joint is described, only the power law k d^n is
    fitted.
    """
    from study.choose.own_curve import fit_curve

    if plot is not None:
        cli.check_output(plot, *SAME_BYTES, name="plot")
    heads = {"depth": depth_column, "force": force_column}
    units = {"depth": depth_unit, "force": force_unit}
    depth, force, has_units = read_curve(curve, heads, units)
    asked = joint_of(joint) if joint else None
    if asked is not None and asked.has_dimensions and not has_units:
        depth, force, has_units = asked.clearance * depth, asked.force_unit * force, True
    elif asked is not None and has_units and not asked.has_dimensions:
        raise ValueError(
            "--socket-radius, --clearance and --wall must be given because the curve has units; "
            "--r2-star is for a curve in normalised depths and forces (--depth-unit none "
            "--force-unit none)"
        )
    with working("Comparing the laws"):
        found = fit_curve(depth, force, asked, fit or ())
    if plot is not None:
        _draw(found, plot, has_units)
    show(_values(found), as_json, *_parts(found, has_units, fit or ()))


def read_curve(path, heads, units):
    """Depths and forces of a CSV file, of shape (n,), and whether they are in m and N.

    ``heads`` and ``units`` of ``depth`` and ``force`` are None where the head of the file has them.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
        lines = [line for line in text.splitlines() if line.strip(" ,;\t")]
        separator = max(",;\t", key="".join(lines[:1]).count)
        rows = list(csv.reader(lines, delimiter=separator, strict=True))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        why = getattr(error, "strerror", None) or "it is not CSV text in UTF-8"
        raise ValueError(f"FILE must be a CSV file, got {path}: {why}") from None
    if len(rows) < 2:
        raise ValueError(
            f"{path} must have a line of column names and a row for each point, got {len(rows)} "
            "line(s)"
        )
    names, values, found = [name.strip() for name in rows[0]], [], {}
    for what, head in heads.items():
        column = _column(names, what, head)
        found[what] = units[what] or _unit(names[column], what)
        values.append(_numbers(rows, column, what) * UNITS[what][found[what]])
    if (found["depth"] == NO_UNIT) != (found["force"] == NO_UNIT):
        raise ValueError(
            "depth and force must either both have units or both be normalised (unit none), got "
            f"the units {found['depth']} and {found['force']}"
        )
    return *values, found["depth"] != NO_UNIT


def _column(names, what, head):
    """Index of the column of depths or forces."""
    wanted = head.strip() if head else None
    found = [
        k
        for k, name in enumerate(names)
        if (name == wanted if wanted else re.match(rf"{what}(?![a-z])", name, re.IGNORECASE))
    ]
    if len(found) == 1:
        return found[0]
    option, listed = f"--{what}-column", ", ".join(names)
    if not found:
        raise ValueError(
            f"no column is named {wanted or what}; select one of {listed} with {option}"
        )
    several = ", ".join(names[k] for k in found)
    raise ValueError(
        f"several columns may be the {what}: {several}; select one with {option}, and give each "
        "column a different name"
    )


def _unit(head, what):
    """Unit that the head of a column ends with."""
    last = re.split(r"[\s_,/(\[]+", head.rstrip(")] "))[-1]
    known = {name.casefold(): name for name in UNITS[what]}
    known |= {name.casefold(): also for name, also in _ALSO.items() if also in UNITS[what]}
    if last.casefold() not in known:
        raise ValueError(
            f"the unit of the column {head} must be one of {', '.join(UNITS[what])}; write it in "
            f"the column's name, for example {what} [{next(iter(UNITS[what]))}], or give it with "
            f"--{what}-unit"
        )
    return known[last.casefold()]


def _numbers(rows, column, what):
    values = []
    for k, row in enumerate(rows[1:], 1):
        if len(row) != len(rows[0]):
            raise ValueError(
                f"row {k} must have {len(rows[0])} cells, as many as there are column names, got "
                f"{len(row)}"
            )
        name, text = f"{what} in row {k}", row[column].strip()
        values.append(checks.read(name, text))
        if not np.isfinite(values[-1]):
            raise ValueError(f"{name} must be a finite number, got {text}; remove the row")
    return np.array(values)


def _values(found):
    """One JSON object of a fit."""
    laws = [{n: v for n, v in vars(of).items() if n != "force"} for of in found.laws]
    return {
        "points": len(found.depth),
        "laws": laws,
        "power": found.power._asdict(),
        "left_out": found.left_out,
        "notes": list(found.notes),
    }


def _parts(found, has_units, fit):
    """A fit as text: the table of the laws, and sentences."""
    force = " N" if has_units else ""
    rows = []
    for of in found.laws:
        row = {
            "law": of.law,
            f"rmse{force}": _digits(of.rmse),
            f"max_error{force}": _digits(of.max_error),
            "max_relative_error %": _digits(100 * of.max_relative_error, 3),
            "R2": round(of.determination, 6),
            "R2_adjusted": round(of.determination_adjusted, 6),
            "fitted": len(of.parameters),
        }
        for name in fit:
            unit, factor = SHOWN[name] if has_units else ("", 1)
            for head, values in (("", of.parameters), ("_error", of.standard_errors)):
                value = _digits(factor * values[name], 2 if head else 5) if name in values else None
                row[f"{name}{head} {unit}".rstrip()] = value
        rows.append(row)
    yield columns(rows)
    yield (
        f"The errors are over {len(found.depth)} points; relative errors only where the force is "
        "at least 1 % of its maximum. R2 = 1 - SSE/SST, and R2_adjusted takes the number of fitted "
        "parameters into account: winkler and hyperbolic_winkler always have one (their "
        "coefficient) and power has two. tabulated is the elastic solution of the joint."
    )
    yield _power(found, has_units)
    reasons = {}
    for law, why in found.left_out.items():
        reasons.setdefault(why, []).append(law)
    if reasons:
        yield "\n".join(f"Not fitted: {', '.join(of)}: {why}." for why, of in reasons.items())
    yield from found.notes


def _power(found, has_units):
    """A sentence with the fitted power law."""
    power, (law,) = found.power, [of for of in found.laws if of.law == "power"]
    unit, factor = SHOWN["offset"] if has_units else ("", 1)
    low, high = (f"{factor * depth:.4g}" for depth in power.depths)
    coefficient = f"{power.coefficient:.5g}"
    if has_units:
        coefficient += f" N/m^n = {power.coefficient_mm:.5g} N/mm^n"
    by = "The maximum relative error was minimised, as study joint does."
    if "exponent" in law.standard_errors:
        error = law.standard_errors["exponent"]
        by = (
            "The sum of squared force errors was minimised; the standard error of n is "
            f"{error:.2g}."
        )
    return (
        f"Fitted power law F = k d^n, within {100 * power.error:.2g} % at depths from {low} to "
        f"{high} {unit}".rstrip()
        + f": n = {power.exponent:.5g} and k = {coefficient}. {by}"
    )


def _digits(value, digits=4):
    return float(f"{value:.{digits}g}")


def _draw(found, path, has_units):
    """Draw a curve and the laws into a file."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from study.pages.figures import STYLE

    depths = found.depth * (SHOWN["offset"][1] if has_units else 1)
    with mpl.rc_context(STYLE | {"svg.hashsalt": path.stem}):
        figure = Figure(figsize=(8.4, 3.4))
        left, right = figure.subplots(1, 2)
        left.plot(depths, found.force, "o", color="0.5", ms=3, label="your curve")
        for of in found.laws:
            (line,) = left.plot(depths, of.force, label=of.law)
            right.plot(depths, of.force - found.force, color=line.get_color())
        unit = (" (µm)", " (N)") if has_units else (" (clearances)", r" ($P/(E^*\Delta R^2)$)")
        left.set(xlabel=f"depth{unit[0]}", ylabel=f"force{unit[1]}")
        right.set(xlabel=f"depth{unit[0]}", ylabel=f"law minus curve{unit[1]}")
        left.legend(fontsize=7)
        with paths.whole(path) as temporary:
            figure.savefig(temporary, metadata=SAME_BYTES[path.suffix])
