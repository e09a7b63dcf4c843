"""Commands for what is stored: the dataset, and the times of laws, solvers and steppers."""

import json
import os
import sys
from difflib import get_close_matches
from itertools import takewhile
from pathlib import Path
from typing import Literal

from study import checks, paths
from study.cli import options as cli
from study.cli.output import columns, fail, say, show_table, text_of, working


def _case_options():
    """Options of the columns by which cases are chosen, as ``datapackage.json`` describes them."""
    try:
        package = json.loads((paths.DATA / "datapackage.json").read_text(encoding="utf-8"))
        fields = package["resources"][0]["schema"]["fields"]
        columns = {field["name"]: field for field in fields}
    except (OSError, ValueError, LookupError):  # loading the data says so
        return {}
    options = {}
    for name in takewhile(lambda name: name != "depth_star", columns):
        text, words = columns[name]["description"], columns[name]["constraints"].get("enum")
        if columns[name]["type"] == "number":
            options[name] = cli.further(list[float], f"{text}; may be repeated.")
        else:
            options[name] = cli.further(Literal[tuple(words)] if words else str, f"{text}.")
    return options


@cli.command("show", group=cli.data_app)
def show_data(**values: _case_options()):
    """Show a summary of the cases with the given values, or every depth of one case.

    For a number that none of them has, the nearest one is shown, as standard error then says.
    On a terminal, columns whose values are all the same are named above the table.
    Plain CSV if the output is not a terminal.
    """
    from study import dataset

    cases, case = _nearest(values) if values else dataset.load(), "case" in values
    rows = cases.loc[:, "depth_star":] if case else dataset.summary(cases)
    sentence = f"{len(rows)} {'depths' if case else 'cases'}."
    if sys.stdout.isatty() and len(rows) > 1:
        same = [column for column in rows if rows[column].nunique() == 1]
        told = [
            f"{name} {text_of(rows[name].iloc[0])}" for name in same if rows[name].iloc[0] != ""
        ]
        sentence += f" The same for all: {', '.join(told)}." if told else ""
        rows = rows.drop(columns=same)
    show_table(rows.to_dict("list"), sentence)


def _nearest(values):
    """Cases that have the given words, and the given numbers or the nearest to them."""
    from study import dataset

    every, words = dataset.load(), {k: v for k, v in values.items() if isinstance(v, str)}
    if (case := words.get("case")) is not None and case not in set(every.case):
        near = " or ".join(get_close_matches(case, every.case.unique(), 3))
        hint = f": did you mean {near}?" if near else ""
        raise ValueError(f"case must be one that `study data show` lists, got {case!r}{hint}")
    cases = dataset.load(**words)
    for column in (column for column in values if column not in words):
        limits = {"least": every[column].min(), "most": every[column].max()}
        found = []
        for number in checks.number(column, values[column], **limits):
            found.append(cases[column][(cases[column] - number).abs().idxmin()])
            if found[-1] != number:
                told = f"no such case has {column} {number:.9g}: shown is the nearest"
                print(f"study: {told}, {found[-1]:.9g}", file=sys.stderr)
        cases = cases[cases[column].isin(found)]
    return cases


@cli.command("solutions", group=cli.data_app)
def show_solutions(
    case: str = cli.option("Name of a case, to show its results.", default=None),
):
    """Show which solutions are kept for the notebooks, or the results of one case.

    A case is a joint, as JSON of its parameters that are not the default, with the depths, tilts or
    forces that are solved. Plain CSV if the output is not a terminal.
    """
    from study.dataset import solutions, store

    design = solutions.design()
    if case is None:
        show_table(design.to_dict("list"), f"{len(design)} cases.")
        return
    checks.choice("case", case, tuple(design.case))
    kind = design.kind[design.case == case].item()
    results = store.read(store.SOLUTIONS[kind])
    show_table(results[results.case == case].to_dict("list"))


@cli.command("record", group=cli.data_app, keeps=True)
def record_solutions(names: list[str] = cli.NAMES):
    """Run notebooks, and record in the dataset's design which solutions they ask for.

    Afterwards study data build solves the new ones. Run it when a notebook asks for other joints.
    """
    from study.dataset import solutions
    from study.pages import catalogue, execute

    for notebook in catalogue.select(names):
        with paths.scratch() as folder:
            asked = folder / "asked.jsonl"
            os.environ[solutions.RECORD_VARIABLE] = str(asked)
            execute.execute(notebook)
            lines = asked.read_text(encoding="utf-8").splitlines() if asked.is_file() else []
        asked_for = dict.fromkeys(solutions.Case(*json.loads(line)) for line in lines)
        solutions.record(notebook.name, asked_for)
        print(f"{notebook.name} asks for {len(asked_for)} solutions")


@cli.command("materials", group=cli.data_app)
def list_materials():
    """List the materials that study joint knows by name: typical values, and sources.

    Plain CSV if the output is not a terminal.
    """
    from study.contact import materials

    show_table(columns(materials.table()))


@cli.command("check", group=cli.data_app)
def check_data():
    """Check files, schema and physics of the dataset, and solve one case again."""
    from study.dataset import production

    with working("Checking the data, and solving one case again"):
        checked, results = zip(*production.check(), strict=True)
    say({"checked": checked, "found": results})


@cli.command("build", group=cli.data_app, keeps=True)
def build_data(
    jobs: int = cli.JOBS,
    from_nothing: bool = cli.switch("--from-nothing", "Make files that are up to date too."),
):
    """Make the files of the dataset that are out of date; an interrupted build resumes."""
    from study.dataset import production

    if from_nothing:
        os.environ[production.FROM_NOTHING] = "1"
    if production.to_make():
        from study.pages import tasks

        fail(tasks.build([paths.DATA], jobs=jobs).failures)
    print("The dataset is up to date: data/force_curves.csv, links.csv, set_ups.csv and more.")


@cli.command("measure", keeps=True)
def measure_speed(
    output: Path = cli.OUTPUT,
    chart: list[str] = cli.option(
        "What to time: laws, solvers, steppers or flexible; may be repeated. [default: all]"
    ),
    repeats: int = cli.option("Number of timed calls, after one that does not count.", default=5),
):
    """Time laws (a minute), solvers and steppers (some minutes each) on this machine.

    Without --output the times are kept in data/published/speed.csv, which the charts draw; study
    data build then takes from them the costs that study choose compares. Charts that are not timed
    stay as they are, and so do the rows of other programs, which make speed times in a checkout.
    """
    import pandas as pd

    from study.dataset import store
    from study.measure import charts

    cli.check_output(output, ".csv")
    measured, frames = charts.measure(chart, repeats), []
    if output is None:
        store.verify_files()  # before minutes of timing
    for timed in measured:
        print(f"timed {timed.chart.iloc[0]}", file=sys.stderr)
        frames.append(timed)
        if output is None:
            store.keep_measured(timed)
    frame = pd.concat(frames)
    if output is not None:
        with paths.whole(output) as temporary:
            frame.to_csv(temporary, index=False)
    print(f"{len(frame)} rows, on {frame.machine.iloc[0]}")
