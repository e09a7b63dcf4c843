"""The command for parameter studies: sweep."""

import sys
import time
from pathlib import Path
from typing import Literal

import typer

from study.cli import options as cli
from study.cli.output import say, working

PLAIN_EVERY = 10.0  # s between lines of progress if the output is not a terminal


@cli.command("sweep")
def sweep_cases(
    kind: Literal["joints", "scenes"] = typer.Argument(
        help="What the cases are: joints or scenes.", metavar="KIND"
    ),
    output: Path = cli.required("File to write."),
    cases: Path = typer.Argument(
        None, help="CSV file with a row per case; or --random.", metavar="[FILE]"
    ),
    random: int = cli.option("Number of cases drawn at random from every --range."),
    seed: int = cli.option(
        "Seed of the random numbers; the same seed gives the same cases. [default: 0]"
    ),
    ranges: list[str] = cli.option(
        "Range of a column: NAME=LOW:HIGH, drawn evenly, NAME=LOW:HIGH:log, or the values to "
        "choose from, NAME=A,B,C; may be repeated.",
        "--range",
        default=(),
    ),
    jobs: int = cli.JOBS,
    dask_address: str = cli.option(
        "Dask scheduler whose workers solve the cases instead.", "--dask"
    ),
    twice: bool = cli.switch(
        "--twice",
        "Scenes: run each a second time, at another tolerance, for a column that says until when "
        "both are the same motion. It takes about three times as long.",
    ),
):
    """Solve many joints, or simulate many scenes, from a CSV file of cases or at random.

    A file has a row for each case. Its columns are the options of study joint, such as
    socket_radius, opening or tilt, or those of study simulate and the mechanism parameters. Other
    columns are kept as they are. Several depths, forces, layers or liners of a case are separated
    by semicolons. Without depths or forces the whole curve is solved, or 8 depths off the axis. A
    case whose values are not possible has the reason in the column error, and the others are
    solved; the exit status is then 1. After an interruption the same command goes on.
    """
    from study.sweep import random_cases, run_study

    cli.check_output(output, ".csv")
    if random is not None:
        drawn = random_cases(random, _ranges(ranges), seed or 0)
    if (cases is None) == (random is None):
        raise ValueError("a FILE of cases or --random must be given, and not both")
    if cases is not None and (ranges or seed is not None):
        raise ValueError("--range and --seed must be left out: a FILE has the cases")
    source = drawn if cases is None else cases
    counts, started, printed = [], time.monotonic(), time.monotonic()
    with working("Solving the cases") as tell:

        def progress(done, every, failed):
            nonlocal printed
            counts.append((done, every))
            solved, now = done - counts[0][0], time.monotonic()
            text = f"{done} of {every} cases, {failed} failed"
            left = f", {(now - started) / solved * (every - done):.0f} s left" if solved else ""
            tell(text + left)
            if not sys.stderr.isatty() and now > printed + PLAIN_EVERY:
                printed = now
                print(text, file=sys.stderr, flush=True)

        try:
            processes = {"jobs": jobs, "dask_address": dask_address}
            swept = run_study(source, kind, output, **processes, progress=progress, twice=twice)
        except KeyboardInterrupt:
            done, every = counts[-1] if counts else (0, 0)
            kept = f"; {done} of {every} cases are kept, the same command goes on"
            raise cli.InterruptionError(kept if done else "") from None
    seconds = time.monotonic() - started
    lines = [f"{swept.cases} cases in {seconds:.3g} s, {swept.rows} rows in {output}. Its results:"]
    for name, (unit, text) in swept.columns.items():
        lines.append(f"  {name}: {text}{f', {unit}' * (unit != '1')}")
    if swept.kept:
        lines.append(f"Kept as they are, because they are no parameters: {', '.join(swept.kept)}.")
    say("\n".join(lines))
    if swept.failures:
        (name, why), *_ = swept.failures.items()
        what = f"{len(swept.failures)} of {swept.cases} cases failed, see the column error"
        print(f"failed: {what}; the first is {name}: {why}", file=sys.stderr)
        raise typer.Exit(1)


def _ranges(texts):
    ranges = {}
    for text in texts:
        name, equals, limits = text.partition("=")
        if not equals or name in ranges:
            raise ValueError(f"--range must be NAME=RANGE, once for each name, got {text!r}")
        ranges[name.strip()] = limits
    return ranges
