"""The command for parameter studies: sweep."""

import sys
import time
from pathlib import Path

from study.cli import options as cli
from study.cli.output import check_output, say, working

PLAIN_EVERY = 10.0  # s between lines of progress if the output is not a terminal


@cli.command(
    "sweep",
    {
        "Random cases": [
            cli.option(
                "--random",
                "Number of random cases, whose values are drawn from each --range.",
                int,
            ),
            cli.option(
                "--range ranges",
                "Range of a column of the random cases; may be repeated. NAME=LOW:HIGH draws "
                "uniformly, NAME=LOW:HIGH:log uniformly in the logarithm, and NAME=A,B,C one of "
                "the listed values.",
                multiple=True,
            ),
            cli.option(
                "--seed",
                "Seed of the random numbers; the same seed gives the same cases. Default: 0.",
                int,
            ),
        ],
        "Computation": [
            cli.option(
                "--joint",
                "Joint that study joint --save wrote: the columns replace its values in each row.",
                Path,
            ),
            cli.switch(
                "--twice",
                "Repeat the simulation of each scene at a second tolerance. A column of the table "
                "then has the time until which both agree. The run takes about three times as "
                "long.",
            ),
            cli.JOBS,
            cli.option(
                "--dask dask_address",
                "Address of a Dask scheduler, whose workers then solve the cases.",
            ),
        ],
        "Output": [
            cli.option("--output", "CSV file for the table of results.", Path, required=True)
        ],
    },
    examples=[
        "sweep joints --random 20 --range r2_star=20:300:log --range poisson=0.2:0.4 \\\n"
        "      --output joints.csv",
    ],
    arguments=[
        cli.argument(
            "kind",
            "Kind of the cases: joints to solve, or scenes (mechanisms) to simulate.",
            "KIND",
            cli.choice(("joints", "scenes")),
        ),
        cli.argument(
            "cases",
            "CSV file with a row for each case. It is not given with --random.",
            "[FILE]",
            Path,
            required=False,
        ),
    ],
)
def sweep_cases(
    kind,
    output,
    twice,
    cases=None,
    random=None,
    seed=None,
    ranges=(),
    joint=None,
    jobs=None,
    dask_address=None,
):
    """Solve many joints, or simulate many mechanisms, and write one table.

    The cases are read from a CSV file with a row for each case, or are drawn at random. The columns
    of the file are options of study joint, such as socket_radius, opening or tilt, or options of
    study simulate and mechanism parameters. Other columns are copied to the table. Several depths,
    forces, layers or liners of a case are separated by semicolons. For a joint without depths or
    forces the whole curve is solved, or 9 depths if the load is off the axis.

    If the values of a case are invalid, its row has the reason in the column error, the other cases
    are solved, and the exit status is 1. After an interruption the same command continues where it
    stopped.
    """
    from study.sweep import random_cases, run_study

    check_output(output, ".csv")
    if random is not None:
        drawn = random_cases(random, _ranges(ranges), seed or 0)
    if (cases is None) == (random is None):
        raise ValueError("either a FILE of cases or --random must be given, but not both")
    if cases is not None and (ranges or seed is not None):
        raise ValueError("--range and --seed do not apply to a FILE of cases; remove them")
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
            swept = run_study(
                source, kind, output, joint=joint, **processes, progress=progress, twice=twice
            )
        except KeyboardInterrupt:
            done, every = counts[-1] if counts else (0, 0)
            kept = f"; {done} of {every} cases are kept, and the same command continues from there"
            raise cli.InterruptionError(kept if done else "") from None
    seconds = time.monotonic() - started
    lines = [
        f"{swept.cases} cases were solved in {seconds:.3g} s; {output} has {swept.rows} rows. Its "
        "columns of results are:"
    ]
    for name, of in swept.columns.items():
        lines.append(f"  {name}: {of.meaning}{f', {of.unit}' if of.unit else ''}")
    if swept.kept:
        lines.append(f"Columns that are not parameters were copied: {', '.join(swept.kept)}.")
    say("\n".join(lines))
    if swept.failures:
        (name, why), *_ = swept.failures.items()
        what = (
            f"{len(swept.failures)} of {swept.cases} cases failed; the column error has the reasons"
        )
        print(f"failed: {what}. The first is case {name}: {why}", file=sys.stderr)
        return 1
    return 0


def _ranges(texts):
    ranges = {}
    for text in texts:
        name, equals, limits = text.partition("=")
        if not equals or name in ranges:
            raise ValueError(
                f"--range must be NAME=RANGE, and only once for each name, got {text!r}"
            )
        ranges[name.strip()] = limits
    return ranges


COMMANDS = {"sweep": sweep_cases}
