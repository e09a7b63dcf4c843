"""Commands for notebooks, their results, the paper and the report."""

import sys

import typer

from study.cli.options import command
from study.cli.output import fail, show


@command("run", "study.pages.tasks:build jobs force dask_address")
def run_notebooks(names: list[str] = (), settings: list[str] = (), **how):
    """Run the stale notebooks and compare their figures and tables with those in figures/.

    What agrees stays as it is; what differs is written anew and named, with exit status 1.
    """
    from study.pages import catalogue, execute

    selected = catalogue.select(names)
    parameters = execute.check_parameters(selected, settings)
    _compare(_make(selected, parameters, **how))


@command("verify")
def verify_results(names: list[str] = (), keep: bool = False):
    """Say which results, as made here last, are the kept ones; run nothing."""
    from study.pages import catalogue, kept

    selected = catalogue.select(names)
    if keep:
        for notebook in selected:
            kept.accept(notebook.files())
    _compare(selected)


def _compare(selected):
    """Say how many results are the kept ones, and which are not; fail if one differs."""
    from study.pages import execute, kept

    found = execute.compare(selected)
    differing = [comparison.where for comparison in found if comparison.state == "differs"]
    for where in differing:
        print(f"differs  {where}", file=sys.stderr)
    print(kept.summary(found))
    if differing:
        raise typer.Exit(1)


@command("paper")
def typeset_paper():
    """Typeset the paper, build/paper.pdf, from the results in figures/ as they are."""
    from study.pages.typeset import typeset

    typeset()
    print("made  build/paper.pdf")


@command("report", "study.pages.tasks:build jobs")
def write_report(**how):
    """Bring everything up to date: figures, tables, paper, and the report, build/report/."""
    from study.pages.catalogue import CATALOGUE

    selected = _make(CATALOGUE, {}, report=True, **how)
    print("Figures and tables are in figures/, the paper is build/paper.pdf.")
    print("The report to browse: build/report/index.html")
    _compare(selected)


def _make(selected, parameters, **how):
    """Run notebooks and tell what was made; return those asked for and those that ran."""
    from study import dataset
    from study.pages import catalogue, execute

    dataset.verify_files()
    catalogue.check_claims()
    built = execute.run(selected, parameters, **how)
    made, every = built.made(), catalogue.CATALOGUE
    for notebook in every:
        if notebook.name in made:
            for name, shows in notebook.results.items():
                suffix = "csv" if name in notebook.tables else "png"
                print(f"made  figures/{name}.{suffix:<4}  {shows}")
            print(f"      build/notebooks/{notebook.path.name}")
    for task, file in (("typeset", "paper.pdf"), ("report", "report/index.html")):
        if task in made:
            print(f"made  build/{file}")
    fail(built.failures)
    if not made:
        names = ", ".join(notebook.name for notebook in selected)
        of = f" of {names}" if len(selected) < len(every) else ""
        print(f"Nothing was stale: every figure and table{of} in figures/ is up to date.")
    return [notebook for notebook in every if notebook in selected or notebook.name in made]


@command("list")
def list_results():
    """List every figure and table: what it shows, its notebook, fresh or stale."""
    import pandas as pd

    from study.pages import catalogue, execute

    fresh = execute.run(catalogue.CATALOGUE, {}, dry=True).fresh()
    rows = [
        (name, "fresh" if notebook.name in fresh else "stale", notebook.name, shows)
        for notebook in catalogue.CATALOGUE
        for name, shows in notebook.results.items()
    ]
    show(pd.DataFrame(rows, columns=["name", "state", "notebook", "shows"]))
