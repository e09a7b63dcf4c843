# Every notebook, the article with its supplement, and the report; with --config dataset=new or
# dataset=all also the generated tables of data/. `study run`, `study report`, `study paper` and
# `study data build` call Snakemake with this file, and compare the results with those in figures/.

import sys

from study import paths
from study.pages.catalogue import CATALOGUE
from study.pages.typeset import PDFS

PYTHON = sys.executable
JOB = "exec {PYTHON:q} -m study.pages.workflow"


def relative(files):
    return [path.relative_to(paths.ROOT).as_posix() for path in files]


def found(folder, *suffixes):
    return relative(sorted(p for p in folder.rglob("*.*") if p.suffix in suffixes))


def results(notebooks):
    return relative(paths.RESULTS / name for notebook in notebooks for name in notebook.files())


SURFACE = ("study/cli/", "study/pages/report/")  # no result depends on them
LIBRARY = [f for f in found(paths.STUDY, ".py", ".csv", ".json") if not f.startswith(SURFACE)]
DATA = found(paths.DATA, ".csv", ".json")
READ = {name for notebook in CATALOGUE for name in notebook.reads}
EXECUTED = relative(notebook.executed for notebook in CATALOGUE)


rule report:
    input:
        results(CATALOGUE),
        EXECUTED,
        relative(PDFS),
        relative(paths.DOCUMENTS),
        "notebooks/catalogue.toml",
        "build/checked",
        found(paths.STUDY, ".py", ".md", ".rst", ".html", ".css", ".js", ".csv", ".json"),
    output:
        "build/report/index.html",
    threads: 2
    message:
        "Report"
    shell:
        JOB + " report"


rule article:
    input:
        results(CATALOGUE),
        found(paths.PAPER, ".typ", ".yml"),
        DATA,
        LIBRARY,
    output:
        relative(PDFS),
    message:
        "Article and supplement"
    shell:
        JOB + " typeset"


# Damaged data are found, and named once, before a notebook runs
rule checked:
    input:
        "data/SHA256SUMS",
        DATA,
        found(paths.STUDY, ".csv", ".json"),
    output:
        touch("build/checked"),
    message:
        "Check of the data"
    shell:
        JOB + " check"


# Notebooks that take long and those that others read begin first
for notebook in CATALOGUE:

    rule:
        name:
            notebook.name
        input:
            relative([notebook.path]),
            "build/checked",
            LIBRARY,
            DATA,
            relative(paths.RESULTS / f"{name}.csv" for name in notebook.reads),
        output:
            relative([notebook.executed]),
            results([notebook]),
        params:
            notebook=notebook.name,
        priority: 1 if notebook.long or READ & notebook.results.keys() else 0
        message:
            "Notebook {params.notebook}"
        shell:
            JOB + " notebook {params.notebook}"


# The dataset: each table is solved in parts; with dataset=new they have the missing cases only
if "dataset" in config:
    sys.path.insert(0, str(paths.DATA))
    from build import TABLES

    EVERYTHING = config["dataset"] == "all"
    MADE = {name: table for name, table in TABLES.items() if EVERYTHING or table.extensible}

    rule dataset:
        input:
            expand("build/data/{table}.made", table=MADE),

    for name, table in MADE.items():

        rule:
            name:
                f"{name}_part"
            input:
                LIBRARY,
                [f"build/data/{after}.made" for after in table.after],
            output:
                f"build/data/{name}/{{part}}.csv",
            params:
                table=name,
            message:
                "Part {wildcards.part} of {params.table}"
            shell:
                "exec {PYTHON:q} data/build.py part {params.table} {wildcards.part} {output}"

        rule:
            name:
                f"{name}_table"
            input:
                [f"build/data/{after}.made" for after in table.after],
                parts=[f"build/data/{name}/{part}.csv" for part in table.parts(EVERYTHING)],
            output:
                touch(f"build/data/{name}.made"),
            params:
                table=name,
            message:
                "Table {params.table}"
            shell:
                "exec {PYTHON:q} data/build.py table {params.table} {input.parts}"
