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
    """Options for the columns by which cases are selected, described in ``datapackage.json``."""
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


@cli.command("show", group=cli.data_app, examples=["data show --group paper --r2-star 200"])
def show_data(**values: _case_options()):
    """Show a summary of the solved cases with the given values, or all depths of one case.

    If no case has a given number, the nearest number is used, and a message says so. On a terminal,
    columns with the same value in all rows are stated above the table. The output is CSV if it does
    not go to a terminal.
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
        sentence += f" All have: {', '.join(told)}." if told else ""
        rows = rows.drop(columns=same)
    show_table(rows.to_dict("list"), sentence)


def _nearest(values):
    """Cases that have the given words, and the given numbers or the nearest to them."""
    from study import dataset

    every, words = dataset.load(), {k: v for k, v in values.items() if isinstance(v, str)}
    if "case" in words:
        _check_case(words["case"], every.case.unique(), "show")
    cases = dataset.load(**words)
    for column in (column for column in values if column not in words):
        limits = {"least": every[column].min(), "most": every[column].max()}
        found = []
        for number in checks.number(column, values[column], **limits):
            found.append(cases[column][(cases[column] - number).abs().idxmin()])
            if found[-1] != number:
                nearest = f"the nearest value, {found[-1]:.9g}, is shown instead"
                print(f"study: no case has {column} = {number:.9g}; {nearest}", file=sys.stderr)
        cases = cases[cases[column].isin(found)]
    return cases


def _check_case(case, known, listing):
    if case not in known:
        near = " or ".join(get_close_matches(case, known, 3))
        hint = f": did you mean {near}?" if near else ""
        names = f"a name that study data {listing} lists"
        raise ValueError(f"--case must be {names}, got {case!r}{hint}")


@cli.command("solutions", group=cli.data_app, examples=["data solutions"])
def show_solutions(
    case: str = cli.option("Print the results of the case with this name.", default=None),
):
    """List the stored elastic solutions of the notebooks, or print the results of one.

    Each case is a joint (as JSON: its parameters that differ from the default) with the depths,
    tilts or forces for which it is solved. The output is CSV if it does not go to a terminal.
    """
    from study.dataset import solutions, store

    design = solutions.design()
    if case is None:
        show_table(design.to_dict("list"), f"{len(design)} cases.")
        return
    _check_case(case, list(design.case), "solutions")
    kind = design.kind[design.case == case].item()
    results = store.read(store.SOLUTIONS[kind])
    show_table(results[results.case == case].to_dict("list"))


@cli.command("record", group=cli.data_app, keeps=True, examples=["data record fig13"])
def record_solutions(names: list[str] = cli.NAMES):
    """Run notebooks, and record which elastic solutions they need in data/solutions/cases.csv.

    Use this command after a change of the joints that a notebook shows; study data build then
    solves the new cases.
    """
    from study.dataset import solutions
    from study.pages import catalogue, execute, tasks

    for notebook in catalogue.select(names):
        with tasks.alone(), paths.scratch() as folder:
            file = folder / "needed.jsonl"
            file.touch()
            os.environ[solutions.RECORD_VARIABLE] = str(file)
            try:
                execute.execute(notebook)
            finally:
                del os.environ[solutions.RECORD_VARIABLE]
            lines = file.read_text(encoding="utf-8").splitlines()
            needed = dict.fromkeys(solutions.Case(*json.loads(line)) for line in lines)
            solutions.record(notebook.name, needed)
        print(f"{notebook.name} needs {len(needed)} solution{'s' * (len(needed) != 1)}")


@cli.command("materials", group=cli.data_app, examples=["data materials"])
def list_materials():
    """List the materials that can be given by name, with typical values and their sources.

    Young's modulus and yield stress are in Pa. The output is CSV if it does not go to a terminal.
    """
    from study.contact import materials

    show_table(columns(materials.table()))


@cli.command("check", group=cli.data_app, examples=["data check"])
def check_data():
    """Check the dataset: files, schema, physical properties, and some cases that are solved again.

    One force-depth curve is solved again, and one random case of each kind of the stored solutions
    of the notebooks.
    """
    from study.dataset import production

    with working("Checking the dataset and solving some cases again"):
        checked, results = zip(*production.check(), strict=True)
    say({"checked": checked, "found": results})


@cli.command("build", group=cli.data_app, keeps=True, examples=["data build --jobs 4"])
def build_data(
    jobs: int = cli.JOBS,
    from_nothing: bool = cli.switch(
        "--from-nothing", "Also rebuild the files that are up to date; this takes some minutes."
    ),
):
    """Rebuild the outdated files of the dataset.

    A file is outdated if the code, the data or the design from which it is made has changed. After
    an interruption the solved cases are kept, and the same command continues from there.
    """
    from study.dataset import production

    if from_nothing:
        os.environ[production.FROM_NOTHING] = "1"
    if production.to_make():
        from study.pages import tasks

        fail(tasks.build([paths.DATA], jobs=jobs).failures)
    print("The dataset is up to date: data/force_curves.csv, links.csv, set_ups.csv and others.")


@cli.command("measure", keeps=True, examples=["measure --chart laws --output times.csv"])
def measure_speed(
    output: Path = cli.option("CSV file for the times. Default: data/published/speed.csv."),
    chart: list[str] = cli.option(
        "What to time: laws, solvers, steppers or flexible (links); may be repeated. Default: all."
    ),
    repeats: int = cli.option(
        "Number of timed calls; one more call before them is not counted.", default=5
    ),
):
    """Measure the speed of laws, solvers and steppers on this machine.

    The laws take a minute, the solvers and the steppers some minutes each. Without --output the
    times replace those in data/published/speed.csv, from which the charts of speed are drawn and
    from which study data build computes the costs that study choose compares. Charts that are not
    timed keep their values, and so do the rows of other programs (make speed times those too).
    """
    import pandas as pd

    from study.dataset import store
    from study.measure import charts

    cli.check_output(output, ".csv")
    measured, frames = charts.measure(chart, repeats), []
    if output is None:
        store.verify_files()  # before minutes of timing
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
