"""What the commands print: JSON, tables, lines, and a bar while something is simulated."""

import json
import sys

import typer


def show(told, as_json=False, *parts):
    """Print one JSON object, or its parts as text: lines, and tables of columns by name.

    A table has its full width where the output is no terminal.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Column, Table

    if as_json:
        print(json.dumps(told, allow_nan=False))
        return
    console = Console(width=None if sys.stdout.isatty() else 200)
    for part in parts or [told]:
        if isinstance(part, str):
            print(part)
        else:
            columns = (Column(name, overflow="fold") for name in part)
            table = Table(*columns, box=box.SIMPLE_HEAD, pad_edge=False)
            for row in zip(*(part[name] for name in part), strict=True):
                table.add_row(*map(_text, row))
            console.print(table)


def _text(value):
    if value is None or value == {}:
        return "-"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_text(item)}" for key, item in value.items())
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def named_fields(choice):
    """What a choice knows by name, without the function that it gives."""
    given = ("evaluate", "simulate")
    return {name: value for name, value in vars(choice).items() if name not in given}


def bar():
    """Bar of simulated time on standard error, gone at the end; none off the terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    text = TextColumn("simulated {task.completed:.4g} of {task.total:g} s")
    columns, console = (text, BarColumn(), TimeRemainingColumn()), Console(stderr=True)
    hidden = not console.is_terminal
    return Progress(*columns, console=console, transient=True, disable=hidden)


def fail(failures):
    """Say what failed, and end with status 1 if something did."""
    for failure in failures:
        print(f"failed: {' '.join(failure.split())}", file=sys.stderr)
    if failures:
        raise typer.Exit(1)
