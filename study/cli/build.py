"""Commands for notebooks, their results, the paper and the report."""

import sys
from dataclasses import replace

import typer

from study import paths
from study.cli import options as cli
from study.cli.output import fail, say, show_table


@cli.command("run", keeps=True, examples=["run fig10", "run fig10 -p r2_star=100"])
def run_notebooks(
    names: list[str] = cli.NAMES,
    settings: list[str] = cli.option(
        "Change a parameter of the named notebook, as KEY=VALUE; may be repeated. study list NAME "
        "shows the parameters.",
        "-p",
        default=(),
    ),
    jobs: int = cli.JOBS,
    force: bool = cli.switch(
        "--force", "Run the notebooks even if they are up to date, and accept their results."
    ),
    dask_address: str = cli.option(
        "Address of a Dask scheduler, whose workers then run the notebooks.", "--dask"
    ),
):
    """Run the outdated notebooks and compare their figures and tables with those in figures/.

    A notebook is outdated if it, the code or the data that it uses has changed since its last run.

    A result that agrees with the kept one is not changed. A result that differs replaces the kept
    one and is named, and the exit status is 1; git diff shows the difference. To accept the new
    results as references, run the notebook again with --force. To reject them, use git checkout.
    Results of a run with other parameters (-p) are written to build/with/KEY=VALUE/ instead of
    figures/.
    """
    from study.pages import catalogue, execute

    if settings and not names:  # or every notebook that has the parameter would run with it
        raise ValueError(
            f"-p must be given with a NAME, for example: study run fig10 -p {settings[0]}"
        )
    selected = catalogue.select(names)
    chosen = execute.check_parameters(selected, settings)
    selected = [replace(notebook, settings=chosen[notebook.name]) for notebook in selected]
    compared = _make(selected, jobs=jobs, force=force, dask_address=dask_address)
    if compared:
        _compare(compared)


def _compare(selected):
    """Print how many results agree with those kept; name those that differ, and fail then."""
    from study.pages import baseline

    compared = baseline.compare(selected)
    differing = [comparison.where for comparison in compared if comparison.state == "differs"]
    for where in differing:
        print(f"differs  {where}", file=sys.stderr)
    print(baseline.summary(compared))
    if differing:
        raise typer.Exit(1)


@cli.command("paper", examples=["paper"])
def typeset_paper():
    """Typeset the paper and its supplement from the current results.

    The files are build/paper.pdf and build/supplement.pdf. The results in figures/ are used as they
    are, even if they are outdated; study report first brings them up to date.
    """
    from study.pages.typeset import typeset_all

    typeset_all()
    print("made  build/paper.pdf and build/supplement.pdf")


@cli.command("report", keeps=True, examples=["report --jobs 4"])
def write_report(jobs: int = cli.JOBS):
    """Bring everything up to date: figures, tables, the paper and the report.

    Only outdated notebooks are run. Figures and tables are in figures/, the paper is
    build/paper.pdf, and the report is a web site that begins with build/report/index.html.
    """
    from study.pages.catalogue import CATALOGUE

    selected = _make(CATALOGUE, report=True, jobs=jobs)
    print("Figures and tables are in figures/, and the paper is build/paper.pdf.")
    print("Open the report in a browser: build/report/index.html")
    _compare(selected)


def _make(selected, **how):
    """Run notebooks and print what was made; return those to compare, selected or run."""
    from study.pages import catalogue, execute
    from study.provenance import name

    paths.require_checkout(paths.NOTEBOOKS)
    built = execute.run(selected, **how)
    made, every = built.made, catalogue.CATALOGUE
    for notebook in (*every, *(notebook for notebook in selected if notebook.settings)):
        if notebook.identifier in made:
            folder = name(notebook.folder)
            for result in notebook.results.values():
                print(f"made  {folder}/{result.files[-1]:<{len(result.name) + 5}} {result.shows}")
            print(f"      {name(notebook.executed)}")
    both = "paper.pdf and build/supplement.pdf"
    for task, file in (("typeset", both), ("report", "report/index.html")):
        if task in made:
            print(f"made  build/{file}")
    fail(built.failures)
    if not made:
        names = ", ".join(notebook.name for notebook in selected)
        of = f" of {names}" if len(selected) < len(every) else ""
        folders = " and ".join(dict.fromkeys(f"{name(nb.folder)}/" for nb in selected))
        say(f"Nothing was outdated: all figures and tables{of} in {folders} are up to date.")
    return [notebook for notebook in every if notebook in selected or notebook.name in made]


@cli.command("list", examples=["list fig10", "list --outdated"])
def list_results(
    names: list[str] = cli.NAMES,
    outdated: bool = cli.switch(
        "--outdated",
        "List only the results that a run would make again, or may have to make again. This takes "
        "about two seconds.",
    ),
):
    """List the figures and tables of each notebook, with a description.

    With a NAME, the parameters of its notebook are listed too, with their defaults and ranges.
    Without a NAME, the output is CSV if it does not go to a terminal.
    """
    from study.pages import catalogue

    selected = catalogue.select(names)
    if outdated:
        from study.pages import execute

        found = execute.outdated(selected)
        selected = [notebook for notebook in selected if notebook.name in found]
    if names or sys.stdout.isatty():
        for notebook in selected:
            shown = [name for name in notebook.results if name in names] or notebook.results
            lines = [f"  {name}: {notebook.results[name].shows}" for name in shown]
            say("\n".join([f"{notebook.name}:", *lines]))
            if names:
                _show_parameters(notebook)
        return
    results = [result for notebook in selected for result in notebook.results.values()]
    heads = ("name", "notebook", "shows")
    show_table({head: [getattr(result, head) for result in results] for head in heads})


def _show_parameters(notebook):
    from study.pages import execute

    parameters = execute.parameters(notebook).items()
    lines = [f"  {name}: {entry}: {entry.meaning}" for name, entry in parameters]
    say(
        "\n".join(
            [f"Parameters (change one with: study run {notebook.name} -p NAME=VALUE):", *lines]
        )
    )
