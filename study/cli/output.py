"""Output of the commands: JSON, CSV, tables, lines, and a bar during a simulation."""

import csv
import json
import sys
from contextlib import contextmanager
from shutil import get_terminal_size
from textwrap import fill
from threading import Timer

import typer

WHOLE = {"break_long_words": False, "break_on_hyphens": False}  # of a number or a name
GAP = "  "
_DEPTH, _FORCE = "d/dR", "P/(E* dR^2)"
UNITS = {
    "r2_star": "R2/dR",
    "depth_star": _DEPTH,
    "largest_depth": _DEPTH,
    "force_star": _FORCE,
    "largest_force": _FORCE,
    "peak_pressure_star": "p R2/(E* dR)",
    "von_mises_star": "E* dR/R2",
}
"""Units of columns that have none in their head."""


def show(values, as_json=False, *parts):
    """Print one JSON object, or its parts as text: lines, and tables of columns by head.

    The unit is below the head: the head's words after the first, or that of `UNITS`.
    """
    if as_json:
        print(json.dumps(values, allow_nan=False))
        return
    parts = parts or [values]
    print("\n\n".join(prose(part) if isinstance(part, str) else _table(part) for part in parts))


def prose(text):
    """Sentences, on a terminal wrapped at words; a command to copy stays one line."""
    width, lines = _terminal(), text.splitlines()
    return "\n".join(x if x.startswith("study ") else fill(x, width, **WHOLE) for x in lines)


def show_csv(table):
    """Print a table of columns by head as plain CSV."""
    writer = csv.writer(sys.stdout, lineterminator="\n")
    writer.writerow(table)
    for row in zip(*table.values(), strict=True):
        writer.writerow(_cell(value) for value in row)


def _cell(value):
    if not isinstance(value, float):
        return value
    return "" if value != value else f"{value:.9g}"  # a number that is missing is NaN


def split_constant(table):
    """A sentence on the columns that have one value in all rows, and the table of the others."""
    columns = {head: [_text(value) for value in table[head]] for head in table}
    same = {head: cells[0] for head, cells in columns.items() if len({*cells}) < 2 <= len(cells)}
    if not same or len(same) == len(columns):
        return "", table
    constants = ", ".join(f"{head} {text}" for head, text in same.items())
    return f"In all rows: {constants}.", {head: table[head] for head in table if head not in same}


def _table(table):
    """A table as text that breaks no number and no name.

    On a terminal that is too narrow, a table of one row is transposed. Else a line above says what
    is the same in all rows. The other columns are in blocks below each other; each begins with the
    first column. A text beside it that is still too wide is wrapped.
    """
    width, columns = _terminal(), [_column(head, table[head]) for head in table]
    if _wide(columns) <= width:
        return _block(columns)
    if all(len(table[head]) == 1 for head in table):
        return paragraphs({head: _text(table[head][0]) for head in table})
    constants, table = split_constant(table)
    first, *others = [_column(head, table[head]) for head in table]
    blocks = [[first]]
    for column in others:
        if len(blocks[-1]) > 1 and _wide([*blocks[-1], column]) > width:
            blocks.append([first])
        blocks[-1].append(column)
    texts = [_block(b) if _wide(b) <= width else _hanging(zip(*b, strict=True)) for b in blocks]
    return "\n\n".join([prose(constants), *texts] if constants else texts)


def paragraphs(texts):
    """Texts beside their names, wrapped at words on a terminal."""
    return _hanging([(GAP + name, text) for name, text in texts.items()])


def _hanging(rows):
    """Rows of a name and a text; the text is wrapped at words, its lines below each other."""
    rows = [(name, text.split()) for name, text in rows if name.strip() or text.strip()]
    start = max(len(name) for name, _ in rows) + len(GAP)
    longest = max(len(word) for _, text in rows for word in text)
    width = max(_terminal(), start + longest)
    lines = (f"{name:<{start}}{' '.join(text)}" for name, text in rows)
    return "\n".join(fill(line, width, subsequent_indent=" " * start, **WHOLE) for line in lines)


def _terminal():
    """Width of the terminal; without one no line is too wide."""
    return get_terminal_size().columns if sys.stdout.isatty() else sys.maxsize


def _column(head, values):
    """Head, unit and cells of a column, all of the same width."""
    name, _, unit = head.partition(" ")
    cells = [name, unit or UNITS.get(name, ""), *map(_text, values)]
    return [cell.ljust(max(map(len, cells))) for cell in cells]


def _wide(columns):
    return sum(len(column[0]) + len(GAP) for column in columns) - len(GAP)


def _block(columns):
    """Columns beside each other; without a line of units if no column has one."""
    heads, units, *rows = (GAP.join(cells).rstrip() for cells in zip(*columns, strict=True))
    return "\n".join([heads, *([units] if units else []), "─" * _wide(columns), *rows])


def _text(value):
    if value is None or value == {}:
        return "-"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value.items())
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def named_fields(choice):
    """Attributes of a choice by name, without its function."""
    functions = ("evaluate", "simulate")
    return {name: value for name, value in vars(choice).items() if name not in functions}


@contextmanager
def waiting(what):
    """Say on a terminal what is being done, if it takes longer than a second."""
    timer = Timer(1.0, print, [f"{what} ..."], {"file": sys.stderr, "flush": True})
    timer.daemon = True
    if sys.stderr.isatty():
        timer.start()
    try:
        yield
    finally:
        timer.cancel()


def bar(text):
    """Progress bar on standard error, removed at the end; hidden if this is not a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn(text), BarColumn(), TimeRemainingColumn()
    console = Console(stderr=True)
    hidden = not console.is_terminal
    return Progress(*columns, console=console, transient=True, disable=hidden)


def fail(failures):
    """Say what failed, and end with status 1 if something did."""
    for failure in failures:
        print(f"failed: {' '.join(failure.split())}", file=sys.stderr)
    if failures:
        raise typer.Exit(1)
