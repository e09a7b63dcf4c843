"""Output of the commands: JSON, CSV, tables, lines, and a bar during a simulation."""

import json
import sys
from contextlib import contextmanager
from shutil import get_terminal_size
from textwrap import fill, wrap
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


def show(told, as_json=False, *parts):
    """Print one JSON object, or its parts as text: lines, and tables of columns by head.

    The unit is below the head: the head's words after the first, or that of `UNITS`.
    """
    if as_json:
        print(json.dumps(told, allow_nan=False))
        return
    width = _terminal()
    lines = [
        prose(part) if isinstance(part, str) else "\n".join(_lines(part, width))
        for part in parts or [told]
    ]
    print("\n\n".join(lines))


def prose(text):
    """Sentences, on a terminal wrapped at words; a command to copy stays one line."""
    width, lines = _terminal(), text.splitlines()
    if width is None:
        return text
    return "\n".join(x if x.startswith("study ") else fill(x, width, **WHOLE) for x in lines)


def show_csv(frame):
    """Print a frame as plain CSV."""
    frame.to_csv(sys.stdout, index=False, float_format="%.9g", lineterminator="\n")


def split_constant(table):
    """A sentence on the columns that have one value in all rows, and the table of the others."""
    columns = {head: [_text(value) for value in table[head]] for head in table}
    same = {head: cells[0] for head, cells in columns.items() if len({*cells}) < 2 <= len(cells)}
    if not same or len(same) == len(columns):
        return "", table
    said = ", ".join(f"{head} {text}" for head, text in same.items())
    return f"In all rows: {said}.", {head: table[head] for head in table if head not in same}


def _lines(table, width):
    """A table as lines that break no number and no name.

    On a terminal, ``width`` characters wide, a table that is too wide is transposed if it has one
    row. Else a line above says what is the same in all rows. The other columns are in blocks below
    each other; each begins with the first column. A column that is still too wide is wrapped.
    """
    columns = [_column(head, table[head]) for head in table]
    if width is None or _wide(columns) <= width:
        return _block(columns)
    if all(len(table[head]) == 1 for head in table):
        return [paragraphs({head: _text(table[head][0]) for head in table})]
    said, table = split_constant(table)
    first, *rest = [_column(head, table[head]) for head in table]
    blocks = [[first]]
    for column in rest:
        if len(blocks[-1]) > 1 and _wide([*blocks[-1], column]) > width:
            blocks.append([first])
        blocks[-1].append(column)
    lines = [line for block in blocks for line in ["", *_block(_wrapped(block, width))]]
    return [*wrap(said, width, **WHOLE), *lines] if said else lines[1:]


def paragraphs(texts):
    """Texts beside their names, wrapped at words on a terminal."""
    wide = max(map(len, texts)) + 2 * len(GAP)
    place = {"initial_indent": GAP, "subsequent_indent": " " * wide, **WHOLE}
    lines = [f"{name:<{wide - len(GAP)}}{text}" for name, text in texts.items()]
    return "\n".join(fill(line, _terminal() or sys.maxsize, **place) for line in lines)


def _terminal():
    """Width of the terminal, or None if the output is not one."""
    return get_terminal_size().columns if sys.stdout.isatty() else None


def _column(head, values):
    """Head, unit and cells of a column, all of the same width."""
    name, _, unit = head.partition(" ")
    cells = [name, unit or UNITS.get(name, ""), *map(_text, values)]
    return [cell.ljust(max(map(len, cells))) for cell in cells]


def _wide(columns):
    return sum(len(column[0]) + len(GAP) for column in columns) - len(GAP)


def _wrapped(block, width):
    """A block in which no line is too wide: cells of its last column may take several lines."""
    *others, last = block
    room = max(width - _wide(others) - len(GAP), max(map(len, " ".join(last).split())))
    if _wide(block) <= width or not others:
        return block
    rows = []
    for *cells, text in zip(*block, strict=True):
        first, *more = wrap(text, room, **WHOLE) or [""]
        blank = [" " * len(cell) for cell in cells]
        rows += [[*cells, first], *([*blank, part] for part in more)]
    *others, last = map(list, zip(*rows, strict=True))
    return [*others, [cell.ljust(max(map(len, last))) for cell in last]]


def _block(columns):
    """Columns beside each other; without a line of units if no column has one."""
    heads, units, *rows = (GAP.join(cells).rstrip() for cells in zip(*columns, strict=True))
    return [heads, *([units] if units else []), "─" * _wide(columns), *rows]


def _text(value):
    if value is None or value == {}:
        return "-"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value.items())
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def named_fields(choice):
    """Attributes of a choice by name, without its function."""
    given = ("evaluate", "simulate")
    return {name: value for name, value in vars(choice).items() if name not in given}


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
