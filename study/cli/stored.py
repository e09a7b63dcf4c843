"""Commands for what is stored: the dataset, and the times of laws, solvers and steppers."""

import sys
from pathlib import Path

from study import paths
from study.cli.options import check_output, command, data_app
from study.cli.output import fail, show, show_csv, split_constant, waiting


@command("show", "study.joint:Joint ball_drive rim kinematics", group=data_app, defaults=False)
def show_data(
    r2_star: list[float] = (), socket_ratio: list[float] = (), group: str = "", case: str = "", **of
):
    """Show a summary of the cases with the given values, or every depth of one case.

    Plain CSV if the output is not a terminal.
    """
    from study import dataset

    own = {"r2_star": r2_star, "socket_ratio": socket_ratio, "group": group, "case": case}
    frame = dataset.load(**{key: value for key, value in own.items() if value}, **of)
    found = frame.loc[:, "depth_star":] if case else dataset.summary(frame)
    if not sys.stdout.isatty():
        show_csv(found)
        return
    said, table = split_constant(found)
    show(None, False, f"{len(found)} {'depths' if case else 'cases'}. {said}", table)


@command("materials", group=data_app)
def list_materials():
    """List the materials that study joint knows by name: typical values, and sources.

    Plain CSV if the output is not a terminal.
    """
    import pandas as pd

    from study.contact import materials

    rows, units = materials.table(), {"youngs_modulus": " Pa", "yield_stress": " Pa"}
    if not sys.stdout.isatty():
        show_csv(pd.DataFrame(rows))
        return
    show({name + units.get(name, ""): [row[name] for row in rows] for name in rows[0]})


@command("check", group=data_app)
def check_data():
    """Check files, schema and physics of the dataset, and solve one case again."""
    from study.dataset import quality

    with waiting("Checking the data, and solving one case again"):
        checked, found = zip(*quality.check(), strict=True)
    show({"checked": checked, "found": found})


@command("build", "study.pages.tasks:build jobs", group=data_app, keeps=True)
def build_data(**how):
    """Build the dataset from nothing; an interrupted build resumes."""
    from study.pages import tasks

    fail(tasks.build([paths.DATA], **how).failures)
    print("The dataset is up to date: data/force_curves.csv, links.csv and datapackage.json.")


@command("measure", "study.measure.speed:measure chart repeats", keeps=True)
def measure_speed(output: Path | None = None, **how):
    """Time laws (a minute), solvers and steppers (some minutes each) on this machine.

    Without --output the times are kept in data/published/speed.csv, which the charts and study
    choose read. Charts that are not timed stay as they are, and so do programs that are not found
    here (ccx, gcc with SUNDIALS 6, scikit-sundae, exudyn).
    """
    import pandas as pd

    from study.dataset import store
    from study.measure import speed

    check_output(output, ".csv")
    charts, frames = speed.measure(**how), []
    if output is None:
        store.verify_files()  # before minutes of timing
    for chart in charts:
        print(f"timed {chart.chart.iloc[0]}", file=sys.stderr)
        frames.append(chart)
        if output is None:
            store.keep_measured(chart)
    frame = pd.concat(frames)
    if output is not None:
        with paths.whole(output) as temporary:
            frame.to_csv(temporary, index=False)
    print(f"{len(frame)} rows, on {frame.machine.iloc[0]}")
