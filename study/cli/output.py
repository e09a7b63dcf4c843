"""Output of the commands: JSON, CSV, sentences, tables as text, and progress."""

import csv
import json
import sys
from contextlib import contextmanager
from itertools import zip_longest
from shutil import get_terminal_size
from textwrap import fill

from study.threads import check_memory

GAP = "  "
SOLVER = 1_300_000  # KiB that the solution of any joint needs
_DEPTH, _FORCE = "d/dR", "P/(E* dR^2)"
UNITS = {
    "r2_star": "R2/dR",
    "depth_star": _DEPTH,
    "largest_depth": _DEPTH,
    "force_star": _FORCE,
    "largest_force": _FORCE,
    "peak_pressure_star": "p R2/(E* dR)",
    "von_mises_star": "E* dR/R2",
    "youngs_modulus": "Pa",
    "yield_stress": "Pa",
}
"""Units of columns that have none in their head."""


def show(values, as_json=False, *parts):
    """Print one JSON object, or its parts as text: sentences, and tables of columns by head.

    The unit is below the head: the head's words after the first, or that of `UNITS`.
    """
    if as_json:
        print(json.dumps(values, allow_nan=False))
    else:
        say(*(parts or [values]))


def say(*parts):
    """Print sentences, and tables of columns by head, with a blank line between them.

    A line of a sentence is wrapped at words on a terminal. A command to copy stays one line.
    """
    print("\n\n".join(_prose(part) if isinstance(part, str) else _table(part) for part in parts))


def show_table(table, *sentences):
    """Print a table of columns by head: plain CSV if the output is not a terminal."""
    if sys.stdout.isatty():
        say(*sentences, table)
        return
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(table)
    for row in zip(*table.values(), strict=True):
        writer.writerow(_csv_cell(value) for value in row)


def columns(rows):
    """Rows of a table, each a value by head, as columns by head."""
    return {head: [row[head] for row in rows] for head in rows[0]}


def _csv_cell(value):
    if not isinstance(value, float):
        return value
    return "" if value != value else f"{value:.9g}"  # a number that is missing is NaN


def _prose(text):
    return "\n".join(
        line if line.startswith("study ") else _wrapped(line) for line in text.splitlines()
    )


def _wrapped(line):
    """A line wrapped on a terminal, never within a number or a name."""
    return fill(
        line,
        _terminal(),
        subsequent_indent=GAP * 2 if line.startswith(GAP) else "",
        break_long_words=False,
        break_on_hyphens=False,
    )


def _table(table):
    """A table as text; a paragraph for each row on a terminal that is too narrow."""
    names, _, units = zip(*(head.partition(" ") for head in table), strict=True)
    units = [unit or UNITS.get(name, "") for name, unit in zip(names, units, strict=True)]
    rows = [[text_of(value) for value in row] for row in zip(*table.values(), strict=True)]
    heads = [names, *([units] if any(units) else [])]
    if _width([*heads, *rows]) > _terminal():  # a word of a name below the other
        words = [name.split("_") for name in names]
        heads = [*zip_longest(*words, fillvalue=""), *heads[1:]]
    if rows and _width([*heads, *rows]) > _terminal():
        return "\n\n".join(_paragraph(names, units, row) for row in rows)
    lines = [*heads, *rows]
    widths = _widths(lines)
    texts = [GAP.join(map(str.ljust, line, widths)).rstrip() for line in lines]
    texts.insert(len(heads), "─" * _width(lines))
    return "\n".join(texts)


def _widths(lines):
    return [max(map(len, column)) for column in zip(*lines, strict=True)]


def _width(lines):
    widths = _widths(lines)
    return sum(widths) + len(GAP) * (len(widths) - 1)


def _paragraph(names, units, row):
    cells = [cell for cell in zip(names, row, units, strict=True) if cell[1]]
    return _wrapped(", ".join(f"{name}: {text} {unit}".rstrip() for name, text, unit in cells))


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


def named_fields(choice):
    """Attributes of a choice by name, without its function."""
    return {name: value for name, value in vars(choice).items() if name != "simulate"}


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
