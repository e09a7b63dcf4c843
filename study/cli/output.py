"""Output of the commands: JSON, CSV, sentences, tables as text, and progress."""

import csv
import json
import os
import sys
from contextlib import contextmanager
from shutil import get_terminal_size
from textwrap import fill

from study.cli.options import flag
from study.parameters import READ
from study.threads import check_memory

GAP = "  "
SOLVER = 1_300_000  # KiB that the solution of any joint needs
UNITS = {
    "r2_star": "R2/dR",
    "depth_star": "d/dR",
    "largest_depth": "d/dR",
    "force_star": "P/(E* dR^2)",
    "largest_force": "P/(E* dR^2)",
    "peak_pressure_star": "p R2/(E* dR)",
    "youngs_modulus": "Pa",
    "yield_stress": "Pa",
}
"""Units of columns that have none in their head."""
MM = {"m": "mm", "m^2": "mm^2", "N/m": "N/mm", "Pa": "MPa", "N m": "N mm"}
"""SI unit -> unit of results in mm, N, MPa and s."""
_SIZES = READ | {"mm": 1e-3, "N/mm": 1e3, "N mm": 1e-3}
SAME_BYTES = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
"""Endings of figures -> metadata without which the same figure has the same bytes."""


def show(values, as_json=False, *parts):
    """Print one JSON object, or its parts as text: sentences, and tables of columns by head.

    The unit is below the head: the head's words after the first, or that of `UNITS`.
    """
    if as_json:
        print(json.dumps(values, allow_nan=False))
    else:
        say(*(parts or [values]))


def say(*parts):
    """Print sentences, and tables of columns by head, with a blank line between them."""
    print("\n\n".join(_prose(part) if isinstance(part, str) else _table(part) for part in parts))


def show_table(table, *sentences):
    """Print a table of columns by head: plain CSV if the output is not a terminal."""
    if sys.stdout.isatty():
        say(*sentences, table)
        return
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(table)
    for row in zip(*table.values(), strict=True):
        cells = (f"{value:.9g}" if isinstance(value, float) else value for value in row)
        writer.writerow("" if cell == "nan" else cell for cell in cells)  # a missing number


def table_of(rows):
    """Rows of a table, each a value by head, as columns by head."""
    return {head: [row[head] for row in rows] for head in rows[0]}


def _prose(text):
    """Lines wrapped on a terminal, never within a number or a name; a command stays one line."""
    return "\n".join(
        line
        if line.startswith("study ")
        else fill(
            line,
            _terminal(),
            subsequent_indent=GAP * 2 if line.startswith(GAP) else "",
            break_long_words=False,
            break_on_hyphens=False,
        )
        for line in text.splitlines()
    )


def _table(table):
    """A table as text; a paragraph for each row on a terminal that is too narrow."""
    names, _, units = zip(*(head.partition(" ") for head in table), strict=True)
    units = [unit or UNITS.get(name, "") for name, unit in zip(names, units, strict=True)]
    rows = [[text_of(value) for value in row] for row in zip(*table.values(), strict=True)]
    lines = [names, *([units] if any(units) else []), *rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    width = sum(widths) + len(GAP) * (len(widths) - 1)
    if rows and width > _terminal():
        cells = [zip(names, row, units, strict=True) for row in rows]
        return "\n\n".join(
            _prose(", ".join(f"{name}: {text} {unit}".rstrip() for name, text, unit in row if text))
            for row in cells
        )
    texts = [GAP.join(map(str.ljust, line, widths)).rstrip() for line in lines]
    texts.insert(len(lines) - len(rows), "─" * width)
    return "\n".join(texts)


def _terminal():
    """Width of the terminal; without one no line is too wide."""
    return get_terminal_size().columns if sys.stdout.isatty() else sys.maxsize


def text_of(value):
    """A value as a table shows it."""
    if value is None or value == {}:
        return "-"
    if isinstance(value, dict):
        return ", ".join(f"{key} {text_of(item)}" for key, item in value.items())
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def in_mm(value, unit, units):
    """A number, list or array in SI units, in mm, N, MPa and s if these are the ``units``."""
    if units != "mm" or unit not in MM or value is None:
        return value
    size = _SIZES[MM[unit]]
    return [of / size for of in value] if isinstance(value, list) else value / size


def read_unit(quantity, units):
    """Unit in which a person reads a `study.parameters.Quantity`, and its size in SI units."""
    unit = MM.get(quantity.unit, quantity.read) if units == "mm" else quantity.read
    return unit, _SIZES.get(unit, 1.0)


def digits(value, count=4):
    """A number with some significant digits."""
    return None if value is None else float(f"{value:.{count}g}")


def check_output(output, *suffixes, name="output"):
    """Raise ``ValueError`` before the work if a file cannot be written or has another suffix."""
    if output is None:
        return
    wanted = ""
    if output.suffix not in suffixes:
        wanted = f"end in {' or '.join(suffixes)}, got"
    elif output.is_dir():
        wanted = "be a file, got the folder"
    elif not output.parent.is_dir() or not os.access(output.parent, os.W_OK | os.X_OK):
        wanted = "be in an existing folder with write permission, got"
    if wanted:
        raise ValueError(f"{flag(name)} must {wanted} {output}")


@contextmanager
def drawn(path):
    """Two axes, side by side, which are drawn into a file at the end."""
    import matplotlib as mpl  # late: only figures need it
    from matplotlib.figure import Figure

    from study import paths
    from study.pages.figures import STYLE

    with mpl.rc_context(STYLE | {"svg.hashsalt": path.stem}):
        figure = Figure(figsize=(8.4, 3.4))
        yield figure.subplots(1, 2)
        with paths.whole(path) as temporary:
            figure.savefig(temporary, metadata=SAME_BYTES[path.suffix])


@contextmanager
def working(what):
    """Show on a terminal what is being done, on a line of standard error that vanishes at the end.

    The context is a function that replaces the text of this line, for example by the progress.
    """
    check_memory(SOLVER, "the solution of a joint")

    def tell(text):
        if sys.stderr.isatty():
            print(f"\r{text}\x1b[K", end="", file=sys.stderr, flush=True)  # and clears the rest

    tell(f"{what} ...")
    try:
        yield tell
    finally:
        tell("")
