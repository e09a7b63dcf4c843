"""Commands for stored data: the dataset, materials, and times of laws, solvers and steppers."""

import json
import shutil
import sys
from itertools import takewhile
from pathlib import Path

import click

from study import paths
from study.cli import options as cli
from study.cli.output import check_output, say, show_table, table_of, text_of, working

ALL = cli.switch(
    "--all everything", "Solve all cases again; this takes more than ten minutes on two cores."
)
_NOT_OFFERED = ("centre",)  # a support that no case of the dataset has


def _case_options():
    """Options for the columns by which cases are selected, described in ``datapackage.json``."""
    try:
        package = json.loads((paths.DATA / "datapackage.json").read_text(encoding="utf-8"))
        fields = package["resources"][0]["schema"]["fields"]
        columns = {field["name"]: field for field in fields}
    except (OSError, ValueError, LookupError):  # loading the data says so
        return []
    options = []
    for name in takewhile(lambda name: name != "depth_star", columns):
        text, words = columns[name]["description"], columns[name]["constraints"].get("enum")
        if columns[name]["type"] == "number":
            text, kind, many = f"{text}; may be repeated", float, True
        else:
            words = [word for word in words or () if word not in _NOT_OFFERED]
            kind, many = tuple(words) or str, False
        options.append(cli.option(cli.flag(name), f"{text}.", kind, multiple=many))
    return options


@cli.command(
    "data show",
    {"Columns of the cases": _case_options()},
    examples=["data show --group paper --r2-star 200"],
)
def show_data(**values):
    """Show a summary of the solved cases with the given values, or all depths of one case.

    On a terminal, columns with the same value in all rows are stated above the table. The output is
    CSV if it does not go to a terminal.
    """
    from study import dataset

    cases, case = dataset.load(**values), "case" in values
    rows = cases.loc[:, "depth_star":] if case else dataset.summary(cases)
    sentence = f"{len(rows)} {'depths' if case else 'cases'}."
    if sys.stdout.isatty() and len(rows) > 1:
        same = [column for column in rows if rows[column].nunique() == 1]
        told = [
            f"{name} {text_of(rows[name].iloc[0])}" for name in same if rows[name].iloc[0] != ""
        ]
        sentence += f" All have: {', '.join(told)}." if told else ""
        rows = rows.drop(columns=same)
    show_table(rows.to_dict("list"), sentence)


@cli.command("data materials", {"Options": []}, examples=["data materials"])
def list_materials():
    """List the materials that can be given by name, with typical values and their sources.

    Young's modulus and yield stress are in Pa. The output is CSV if it does not go to a terminal.
    """
    from study.contact import materials

    show_table(table_of(materials.table()))


@cli.command(
    "data check",
    {
        "Options": [
            cli.option(
                "--sample",
                "Number of cases that are solved again. Default: 20.",
                int,
            ),
            cli.option("--seed", "Seed of the random sample. Default: 0.", int),
            ALL,
            cli.JOBS,
        ]
    },
    examples=["data check", "data check --sample 100"],
)
def check_data(everything, sample=20, seed=0, jobs=None):
    """Check the dataset: hashes, description, missing cases, and a sample that is solved again.

    The sample is drawn from the force-depth curves and from the solutions that notebooks show.
    """
    from study.dataset import check

    with working("Checking the dataset and solving some cases again"):
        results = [*check.check(None if everything else sample, seed, jobs)]
    checked, found = zip(*results, strict=True)
    say({"checked": checked, "found": found})


@cli.command(
    "data build",
    {"Options": [cli.JOBS, ALL]},
    examples=["data build", "data build --all"],
    arguments=[cli.SNAKEMAKE],
    keeps=True,
)
def build_data(everything, names=(), jobs=None):
    """Solve the cases that the dataset lacks, and fit the laws.

    These are new cases of the design (study/dataset/design.py), and solutions that notebooks asked
    for and that took longer than a second. After an interruption the same command continues. A
    table that agrees with the stored one is not changed. Words after -- are passed to Snakemake.
    """
    from study.dataset import solutions, store
    from study.pages import workflow

    more = cli.after_dashes(names)
    before = {path: paths.sha256(path) for path in store.files()}
    folder = paths.BUILD / "data"

    def prepare():
        store.verify()
        if new := solutions.adopt_asked():
            print(f"Notebooks asked for {new} new solutions.")
        for made in folder.glob("*.made"):
            made.unlink()  # tables are joined anew, as cases may have been dropped or restored

    which = f"dataset={'all' if everything else 'new'}"
    workflow.run(["dataset"], jobs=jobs, config=which, more=more, first=prepare)
    shutil.rmtree(folder, ignore_errors=True)  # what is finished need not be continued
    changed = [paths.shown(p) for p in store.files() if paths.sha256(p) != before.get(p)]
    print(f"Changed: {', '.join(changed)}." if changed else "No file of the dataset has changed.")


@cli.command(
    "data accept",
    {"Options": []},
    examples=["data accept data/published/claims.csv"],
    arguments=[cli.argument("files", "Data file; several may be given.", "FILE", Path, many=True)],
)
def accept_data(files):
    """Accept data files that were edited by hand: renew their hashes in data/SHA256SUMS."""
    from study.dataset import store

    known = {path.resolve(): path for path in store.files()}
    for file in files:
        if file.resolve() not in known:
            raise ValueError(f"FILE must be a file of the dataset, got {file}")
    store.write_hashes(known[file.resolve()] for file in files)
    print(f"{paths.shown(store.HASHES)} has the hashes of {', '.join(map(str, files))}.")


@cli.command(
    "measure",
    {
        "Options": [
            cli.option(
                "--chart",
                "What to time: laws, solvers, steppers or flexible (links); may be repeated. "
                "Default: all.",
                multiple=True,
            ),
            cli.option(
                "--method",
                "Law or method to time, by the name in the file; may be repeated. Default: all.",
                multiple=True,
            ),
            cli.option(
                "--repeats",
                "Number of timed calls; one more call before them is not counted. Default: 5.",
                int,
            ),
            cli.option(
                "--output", "CSV file for the times. Default: data/published/speed.csv.", Path
            ),
        ]
    },
    examples=["measure --method hertz", "measure --chart steppers"],
    keeps=True,
)
def measure_speed(chart=(), method=(), repeats=5, output=None):
    """Measure the speed of laws, solvers and steppers on this machine.

    The laws take a minute, the solvers and the steppers some minutes each. Without --output the
    times replace those in data/published/speed.csv, from which the charts of speed are drawn and
    from which study data build computes the costs that study choose compares. Rows of other
    methods are not changed (make speed times other programs too).
    """
    import pandas as pd

    from study.dataset import store
    from study.measure import charts

    check_output(output, ".csv")
    measured, frames = charts.measure(chart, repeats, method), []
    if output is None:
        store.verify([store.SPEED])  # before minutes of timing
    for timed in measured:
        print(f"finished: {timed.chart.iloc[0]}", file=sys.stderr)
        frames.append(timed)
        if output is None:
            store.keep_measured(timed)
    frame = pd.concat(frames)
    if output is not None:
        with paths.whole(output) as temporary:
            frame.to_csv(temporary, index=False)
    print(f"{len(frame)} times were measured on {frame.machine.iloc[0]}.")


class _Group(click.Group):
    """Commands, with their first sentences whole."""

    def format_commands(self, ctx, formatter):
        with formatter.section("Commands"):
            records = [(name, of.help.split("\n\n")[0]) for name, of in self.commands.items()]
            formatter.write_dl([(name, " ".join(text.split())) for name, text in records])


DATA = _Group(
    "data",
    commands=[show_data, list_materials, check_data, build_data, accept_data],
    help="Show, check or rebuild the dataset of solved force-depth curves.",
    no_args_is_help=True,
)
COMMANDS = {"data": DATA, "measure": measure_speed}
