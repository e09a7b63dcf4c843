"""The command that compares laws with a curve of the user: study fit."""

import re
from pathlib import Path

import numpy as np

from study import checks
from study.checks import percent
from study.cli import options as cli
from study.cli.output import (
    SAME_BYTES,
    check_output,
    digits,
    drawn,
    show,
    table_of,
    working,
)
from study.tables import read_table

NO_UNIT = "none"
SI = {"depth": "m", "force": "N"}
SHOWN = {"clearance": ("um", 1e6), "modulus": ("GPa", 1e-9), "offset": ("um", 1e6)}
"""Units in which fitted quantities are printed, and factors from SI units."""


@cli.command(
    "fit",
    {
        "Curve": [
            cli.option(
                "--depth-column", "Name of the column of depths, if it does not begin with 'depth'."
            ),
            cli.option(
                "--force-column", "Name of the column of forces, if it does not begin with 'force'."
            ),
            cli.option(
                "--depth-unit",
                "Unit of the depths, such as um or mm, if neither the name of their column nor the "
                "cells have it. 'none' means normalised depths d/dR.",
            ),
            cli.option(
                "--force-unit",
                "Unit of the forces, such as N or kN, if neither the name of their column nor the "
                "cells have it. 'none' means normalised forces P/(E* dR^2).",
            ),
        ],
        "Fit": [
            cli.option(
                "--fit",
                "Parameter to fit by least squares of the force: clearance (the search begins at "
                "--clearance), modulus (the composite modulus E*) or offset (the depth reading at "
                "first touch); may be repeated.",
                multiple=True,
            ),
            cli.option(
                "--try-power",
                "Constants k,n of a power law F = k d^n that you have, which are compared with the "
                "elastic solution of the joint and with the curve. k is in N/m^n, or in N/mm^n "
                "with --units mm.",
            ),
        ],
        "Output": [
            cli.UNITS,
            cli.JSON,
            cli.option(
                "--plot",
                "File for a figure of the curve and the laws, ending in .png, .svg or .pdf.",
                Path,
            ),
        ],
    },
    examples=[
        "fit examples/fit_your_curve.csv --fit clearance --fit offset \\\n"
        "      --socket-radius 12.5mm --clearance 40um --wall 6mm --socket bronze",
        "fit --try-power 2.5e7,1.65 --units mm \\\n"
        "      --socket-radius 12.5mm --clearance 40um --wall 6mm --socket bronze",
    ],
    arguments=[
        cli.argument(
            "curve",
            "CSV file with a line of column names and a row for each point. It needs a column of "
            "penetration depths and a column of forces, such as 'depth [um]' and 'force [N]', or "
            "depth_star and force_star. It may be left out with --try-power.",
            "[FILE]",
            Path,
            required=False,
        )
    ],
    joint=True,
)
def fit_own_curve(
    as_json,
    curve=None,
    depth_column=None,
    force_column=None,
    depth_unit=None,
    force_unit=None,
    fit=(),
    try_power=None,
    units="SI",
    plot=None,
    **options,
):
    """Compare the contact laws with your own force-depth curve, and fit unknown parameters.

    The curve may come from finite elements or a test rig, and is for a load along the axis.
    Describe its joint as for study joint: with dimensions for a curve with units, without for a
    curve in normalised depths and forces. If no joint is described, only the power law k d^n is
    fitted.

    With --try-power, constants k and n that you have are compared with the elastic solution of the
    joint, with a curve or without one.
    """
    from study.choose import own_curve

    check_output(plot, *SAME_BYTES, name="plot")
    joint, _ = cli.take_joint(options, required=False)
    power = None if try_power is None else _power_of(try_power, units)
    if power is not None and (joint is None or not joint.has_dimensions):
        raise ValueError("try_power must be given with a joint with dimensions; describe the joint")
    if curve is None:
        if power is None:
            raise ValueError("FILE or --try-power must be given")
        with working("Solving the joint"):
            tried = own_curve.try_power(joint, *power)
        values = tried._asdict() | {"best": tried.best._asdict(), "warnings": [*joint.warnings]}
        show(values, as_json, _tried(tried))
        return
    heads = {"depth": depth_column, "force": force_column}
    depth, force, has_units = read_curve(curve, heads, {"depth": depth_unit, "force": force_unit})
    if joint is not None and joint.has_dimensions and not has_units:
        depth, force, has_units = joint.clearance * depth, joint.force_unit * force, True
    elif joint is not None and has_units and not joint.has_dimensions:
        raise ValueError(
            "--socket-radius, --clearance and --wall must be given because the curve has units; "
            "--r2-star is for a curve in normalised depths and forces (--depth-unit none "
            "--force-unit none)"
        )
    with working("Comparing the laws"):
        found = own_curve.fit_curve(depth, force, joint, fit)
        ends = found.power.depths
        tried = power and own_curve.try_power(joint, *power, ends)
    if plot is not None:
        _draw(found, plot, has_units)
    values = {
        "points": len(found.depth),
        "laws": [{n: v for n, v in vars(of).items() if n != "force"} for of in found.laws],
        "power": found.power._asdict(),
        "left_out": found.left_out,
        "notes": list(found.notes),
        "warnings": [*joint.warnings] if joint else [],
    }
    parts = [*_parts(found, has_units, fit)]
    if tried:
        values["tried"] = tried._asdict() | {"best": tried.best._asdict()}
        parts.append(_tried(tried))
    show(values, as_json, *parts)


def _power_of(text, units):
    """Coefficient in SI units and exponent of ``k,n``."""
    coefficient, exponent = checks.read_several("--try-power", text, ("", ""))
    checks.number("coefficient of --try-power", coefficient, above=0)
    checks.number("exponent of --try-power", exponent, above=0)
    return coefficient * 1000**exponent if units == "mm" else coefficient, exponent


def _tried(tried):
    """A sentence on the constants of the user."""
    low, high = (1e6 * depth for depth in tried.depths)
    best = tried.best
    return (
        f"Your power law with k = {tried.coefficient:.5g} N/m^n and n = {tried.exponent:.5g} "
        f"differs from the elastic solution of the joint by at most {percent(tried.max_error)} "
        f"(RMS {percent(tried.rms_error)}) at depths from {low:.4g} to {high:.4g} um. The best "
        f"power law there is within {percent(best.error)}: n = {best.exponent:.5g} and k = "
        f"{best.coefficient:.5g} N/m^n = {best.coefficient_mm:.5g} N/mm^n."
    )


def read_curve(path, heads, units):
    """Depths and forces of a CSV file, of shape (n,), and whether they are in m and N.

    ``heads`` and ``units`` of ``depth`` and ``force`` are None where the head of the file has them.
    """
    table = read_table(path)
    if not table.rows:
        raise ValueError(f"{path} must have a line of column names and a row for each point")
    values, found = [], []
    for what, unit in SI.items():
        column = _column(table.names, what, heads[what])
        cells = [row[column] for row in table.rows]
        found.append(_unit(table.names[column], cells, what, units[what]))
        scale = 0 if found[-1] == NO_UNIT else checks.exponent_of(found[-1], unit)
        for k, text in enumerate(cells, 1):
            name = f"{what} in row {k}"
            if found[-1] != NO_UNIT and re.search(r"[0-9.] *[^\W\d_]+$", text):
                cells[k - 1] = checks.read(name, text, unit=unit)
            else:
                cells[k - 1] = checks.read(name, text) * 10.0**scale
            if not np.isfinite(cells[k - 1]):
                raise ValueError(f"{name} must be a finite number, got {text}; remove the row")
        values.append(np.array(cells))
    if NO_UNIT in found and found != [NO_UNIT, NO_UNIT]:
        raise ValueError(
            "depth and force must either both have units or both be normalised (unit none), got "
            f"the units {' and '.join(found)}"
        )
    return *values, NO_UNIT not in found


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
    if found:
        several = ", ".join(names[k] for k in found)
        why = f"several columns may be the {what}: {several}; select one"
    else:
        why = f"no column is named {wanted or what}; select one of {', '.join(names)}"
    raise ValueError(f"{why} with --{what}-column")


def _unit(head, cells, what, given):
    """Unit of a column: the given one, that at the end of its head, or that of its cells."""
    last = given or re.split(r"[\s_,/(\[]+", head.rstrip(")] "))[-1]
    if last in (NO_UNIT, "star"):
        return NO_UNIT
    names = {last, last.lower(), last.lower().replace("n", "N")}  # as in DEPTH_UM
    for name in sorted(names, reverse=True):
        if checks.exponent_of(name, SI[what]) is not None:
            return name
    if not given and all(cell[-1:].isalpha() for cell in cells):
        return SI[what]
    examples = {"depth": "um", "force": "N"}[what]
    got = f"got {given}" if given else f"or give it with --{what}-unit"
    raise ValueError(
        f"the unit of the column {head} must be {SI[what]} with or without a prefix, such as "
        f"{examples}, or none; write it in the column's name, for example {what} [{examples}], "
        f"{got}"
    )


def _parts(found, has_units, fit):
    """A fit as text: the table of the laws, and sentences."""
    force = " N" if has_units else ""
    rows = []
    for of in found.laws:
        row = {
            "law": of.law,
            f"rmse{force}": digits(of.rmse),
            f"max_error{force}": digits(of.max_error),
            "max_relative_error %": digits(100 * of.max_relative_error, 3),
            "R2": round(of.determination, 6),
            "R2_adjusted": round(of.determination_adjusted, 6),
            "fitted": len(of.parameters),
        }
        for name in fit:
            unit, factor = SHOWN[name] if has_units else ("", 1)
            for head, values in (("", of.parameters), ("_error", of.standard_errors)):
                value = digits(factor * values[name], 2 if head else 5) if name in values else None
                row[f"{name}{head} {unit}".rstrip()] = value
        rows.append(row)
    yield table_of(rows)
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


def _draw(found, path, has_units):
    """Draw a curve and the laws into a file."""
    depths = found.depth * (SHOWN["offset"][1] if has_units else 1)
    with drawn(path) as (left, right):
        left.plot(depths, found.force, "o", color="0.5", ms=3, label="your curve")
        for of in found.laws:
            (line,) = left.plot(depths, of.force, label=of.law)
            right.plot(depths, of.force - found.force, color=line.get_color())
        unit = (" (µm)", " (N)") if has_units else (" (clearances)", r" ($P/(E^*\Delta R^2)$)")
        left.set(xlabel=f"depth{unit[0]}", ylabel=f"force{unit[1]}")
        right.set(xlabel=f"depth{unit[0]}", ylabel=f"law minus curve{unit[1]}")
        left.legend(fontsize=7)


COMMANDS = {"fit": fit_own_curve}
