"""Commands for notebooks, their results, the paper and the report."""

import sys

from study import paths
from study.checks import StudyError
from study.cli import options as cli
from study.cli.output import say, show_table


@cli.command(
    "run",
    {
        "Options": [
            cli.option(
                "-p settings",
                "Change a parameter of the named notebook, as KEY=VALUE; may be repeated. study "
                "list NAME shows the parameters.",
                multiple=True,
            ),
            cli.JOBS,
            cli.switch("--force", "Run the notebooks even if they are up to date."),
        ]
    },
    examples=["run fig10", "run fig10 -p r2_star=100", "run -- --executor slurm --jobs 20"],
    arguments=[cli.NAMES],
    keeps=True,
)
def run_notebooks(force, names=(), settings=(), jobs=None):
    """Run the outdated notebooks, and compare their figures and tables with the accepted ones.

    A notebook is outdated if it, the library, the data or a result that it reads has changed since
    its last run. The results are written to build/results/ and compared with those in figures/. If
    one differs by more than its tolerance, it is named and the exit status is 1; study accept NAME
    copies it to figures/.

    With -p the results are written to build/with/KEY=VALUE/ instead, and are not compared.

    Words after -- are passed to Snakemake, which runs the notebooks.
    """
    from study.pages import catalogue

    more = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    names = names[: len(names) - len(more)]
    selected = catalogue.select(names)
    if not settings:
        return _make(_files(selected), selected, jobs=jobs, force=force, more=more)
    if not names:  # or every notebook that has the parameter would run with it
        raise ValueError(
            f"-p must be given with a NAME, for example: study run fig10 -p {settings[0]}"
        )
    others = (("--force", force), ("--jobs", jobs is not None), ("words after --", more))
    for option, is_given in others:
        if is_given:
            raise ValueError(f"{option} cannot be used together with -p; remove it")
    from study import dataset
    from study.pages import execute
    from study.pages.workflow import MEMORY
    from study.threads import check_memory

    chosen = execute.check_parameters(selected, settings)
    check_memory(MEMORY, "a notebook")
    dataset.verify()
    for notebook in selected:
        folder = execute.folder_with(chosen[notebook.name])
        execute.execute(notebook, folder, folder / notebook.path.name, chosen[notebook.name])
        for result in notebook.results.values():
            print(f"made  {paths.shown(folder / result.files[-1])}  {result.shows}")
    return None


def _files(notebooks):
    """Every file that the jobs of notebooks make."""
    made = [paths.RESULTS / name for notebook in notebooks for name in notebook.files()]
    return [*made, *(notebook.executed for notebook in notebooks)]


def _make(targets, selected, *told, **options):
    """Run the workflow, print what is told, and return the status: 1 if a result differs.

    A run that fails is compared, too: its reason may be a damaged result, which is named then.
    """
    from study.pages import accepted, workflow

    failure = None
    try:
        workflow.run(map(paths.shown, targets), **options)
        print(*told, sep="\n", end="\n" if told else "")
    except StudyError as error:
        failure = error
    results = [result for notebook in selected for result in notebook.results.values()]
    compared = accepted.compare(result for result in results if result.is_made)
    for of in compared:
        if of.drawn_differently:
            print(f"drawn differently: build/results/{of.result.name}.png (its table is identical)")
        if of.state == "differs":
            again = f"make it again with: study run {of.result.name} --force"
            print(
                f"differs: {of.where}; accept it with: study accept {of.result.name}, or {again}",
                file=sys.stderr,
            )
    if failure:
        raise failure
    if {"-n", "--dry-run", "--dryrun"} & set(options.get("more", ())):
        return 0
    print(accepted.summary(compared))
    return int(any(of.state == "differs" for of in compared))


@cli.command(
    "accept",
    {"Options": []},
    examples=["accept fig10", "accept 03-force-against-depth"],
    arguments=[
        cli.argument(
            "names",
            "Name of a figure, a table or a notebook; several may be given.",
            "NAME",
            many=True,
        )
    ],
)
def accept_results(names):
    """Accept results: copy figures and tables from build/results/ to figures/.

    The name of a notebook stands for all of its results. Look at git diff afterwards.
    """
    from study.pages import accepted, catalogue

    results = [
        result
        for notebook in catalogue.select(names)
        for result in notebook.results.values()
        if notebook.name in names or result.name in names
    ]
    changed = accepted.accept(results)
    for name in changed:
        print(f"accepted  figures/{name}")
    if not changed:
        print("Nothing was copied: the files in figures/ are the same.")


@cli.command("paper", {"Options": [cli.JOBS]}, examples=["paper"], keeps=True)
def typeset_paper(jobs=None):
    """Typeset the article and its supplement, after an update of the results that they show.

    The files are build/paper.pdf and build/supplement.pdf.
    """
    from study.pages import catalogue, typeset

    told = "The article is build/paper.pdf, and its supplement build/supplement.pdf."
    return _make(
        [*typeset.PDFS, *_files(catalogue.CATALOGUE)], catalogue.CATALOGUE, told, jobs=jobs
    )


@cli.command(
    "report",
    {"Options": [cli.JOBS]},
    examples=["report --jobs 4"],
    arguments=[cli.SNAKEMAKE],
    keeps=True,
)
def write_report(names=(), jobs=None):
    """Update everything that is outdated: figures, tables, the article and the report.

    Figures and tables are in build/results/, the article is build/paper.pdf, and the report is a
    web site that begins with build/report/index.html. The results are compared with those in
    figures/, as by study run. Words after -- are passed to Snakemake.
    """
    from study.pages import catalogue

    every = [paths.BUILD / "report/index.html", *_files(catalogue.CATALOGUE)]
    told = (
        "Figures and tables are in build/results/, and the article is build/paper.pdf.",
        "Open the report in a browser: build/report/index.html",
    )
    return _make(every, catalogue.CATALOGUE, *told, jobs=jobs, more=cli.after_dashes(names))


@cli.command("list", {"Options": []}, examples=["list fig10"], arguments=[cli.NAMES])
def list_results(names=()):
    """List the figures and tables of each notebook, with a description.

    With a NAME, the parameters of its notebook are listed too, with their defaults and ranges.
    Without a NAME, the output is CSV if it does not go to a terminal.
    """
    from study.pages import catalogue, execute

    selected = catalogue.select(names)
    if not names and not sys.stdout.isatty():
        results = [result for notebook in selected for result in notebook.results.values()]
        heads = ("name", "notebook", "shows")
        show_table({head: [getattr(result, head) for result in results] for head in heads})
        return
    for notebook in selected:
        shown = [name for name in notebook.results if name in names] or notebook.results
        lines = [f"  {name}: {notebook.results[name].shows}" for name in shown]
        say("\n".join([f"{notebook.name}:", *lines]))
        if names:
            entries = execute.parameters(notebook).items()
            lines = [f"  {name}: {entry}: {entry.meaning}" for name, entry in entries]
            change = f"Parameters (change one with: study run {notebook.name} -p NAME=VALUE):"
            say("\n".join([change, *lines]))


COMMANDS = {
    "run": run_notebooks,
    "accept": accept_results,
    "paper": typeset_paper,
    "report": write_report,
    "list": list_results,
}
