"""The dataset's tasks: curves of each set-up, then table, description and fitted laws."""

import json
import time
from pathlib import Path
from typing import Annotated

import pandas as pd
from pytask import Product, PythonNode, task

from study import contact, dataset, fitting, paths, tasks

PARTS = [paths.BUILD / "curves" / f"{s.name}.csv" for s in dataset.DESIGN]
TIMES = [part.with_suffix(".json") for part in PARTS]

for set_up, part, seconds in zip(dataset.DESIGN, PARTS, TIMES, strict=True):

    @task(id=set_up.name)
    def task_curves(
        design: Annotated[
            str, PythonNode(value=repr((set_up, dataset.DEPTHS.tolist())), hash=True)
        ],
        set_up: dataset.SetUp = set_up,
        code: tuple[Path, ...] = dataset.SOURCES,
        part: Annotated[Path, Product] = part,
        seconds: Annotated[Path, Product] = seconds,
    ):
        tasks.leave_interrupts_to_the_runner()
        start = time.perf_counter()
        dataset.write_curves(dataset.solve_set_up(set_up), part)
        seconds.write_text(json.dumps(time.perf_counter() - start))


def task_table(parts: list[Path] = PARTS, table: Annotated[Path, Product] = dataset.CURVES):
    frames = [pd.read_csv(part) for part in parts]
    dataset.write_curves(pd.concat(frames), table)


def task_coefficients(
    table: Path = dataset.CURVES, coefficients: Annotated[Path, Product] = contact.laws.COEFFICIENTS
):
    frame = pd.read_csv(table)
    paper = frame[frame.case.str.startswith(f"paper-{dataset.PAPER_KINEMATICS}-")]
    with paths.whole(coefficients) as temporary:
        fits = fitting.fit_laws(paper)
        temporary.write_text(json.dumps(fits, indent=2) + "\n", encoding="utf-8")


def task_description(
    table: Path = dataset.CURVES,
    coefficients: Path = contact.laws.COEFFICIENTS,
    code: tuple[Path, ...] = dataset.SOURCES,
    times: list[Path] = TIMES,
    published: tuple[Path, ...] = tuple(paths.DATA / name for name in dataset.PUBLISHED),
    description: Annotated[Path, Product] = dataset.PACKAGE,
):
    dataset.write_package(sum(json.loads(path.read_text()) for path in times))
