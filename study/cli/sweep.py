"""The command for parameter studies: sweep."""

import sys
import time
from pathlib import Path
from typing import Literal

import typer

from study.cli.options import InterruptionError, check_output, command
from study.cli.output import bar, paragraphs

PLAIN_EVERY = 10.0  # s between lines of progress if the output is not a terminal


@command("sweep", "study.sweep:sweep jobs dask_address")
def sweep_cases(
    kind: Literal["joints", "scenes"],
    output: Path,
    cases: Path | None = None,
    random: int | None = None,
    seed: int | None = None,
    range: list[str] = (),  # noqa: A002  (the option's name)
    **how,
):
    """Solve many joints, or simulate many scenes, from a CSV file of cases or at random.

    A file has a row for each case. Its columns are the options of study joint, such as
    socket_radius or ball_drive, or those of study simulate and the parameters of the scene. Several
    depths, forces, layers or liners of a case are separated by semicolons. Without depths or forces
    the whole curve is solved. After an interruption the same command goes on.
    """
    from study.sweep import random_cases, sweep

    check_output(output, ".csv")
    given = cases
    if random is not None:
        given = random_cases(random, _ranges(range), 0 if seed is None else seed)
    if (cases is None) == (random is None):
        raise ValueError("a FILE of cases or --random must be given, and not both")
    if cases is not None and (range or seed is not None):
        raise ValueError("--range and --seed must be left out: a FILE has the cases")
    started, done = time.monotonic(), [0, 0, 0]
    with bar("{task.completed:g} of {task.total:g} cases") as shown:
        task, told = shown.add_task("", total=0, visible=False), started

        def progress(*numbers):
            nonlocal told
            done[:] = numbers
            shown.update(task, completed=numbers[0], total=numbers[1], visible=True)
            if shown.disable and time.monotonic() > told + PLAIN_EVERY:
                told = time.monotonic()
                print("{} of {} cases, {} failed".format(*numbers), file=sys.stderr, flush=True)

        try:
            found = sweep(given, kind, output, progress=progress, **how)
        except KeyboardInterrupt:
            kept = f"; {done[0]} of {done[1]} cases are kept, the same command goes on"
            raise InterruptionError(kept if done[0] else "") from None
    seconds = time.monotonic() - started
    print(f"{found.cases} cases in {seconds:.3g} s, {found.rows} rows in {output}. Its results:")
    columns = found.columns.items()
    units = {name: f"{text}{f', {unit}' * (unit != '1')}" for name, (unit, text) in columns}
    print(paragraphs(units))
    if found.failures:
        (name, why), *_ = found.failures.items()
        what = f"{len(found.failures)} of {found.cases} cases failed, see the column error"
        print(f"failed: {what}; the first is {name}: {why}", file=sys.stderr)
        raise typer.Exit(1)


def _ranges(texts):
    """Ranges by column, of ``NAME=RANGE``."""
    ranges = {}
    for text in texts:
        name, equals, of = text.partition("=")
        if not equals or name in ranges:
            raise ValueError(f"--range must be NAME=RANGE, once for each name, got {text!r}")
        ranges[name.strip()] = of
    return ranges
