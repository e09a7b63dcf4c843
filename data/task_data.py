"""The dataset's tasks: curves of each set-up, then table, description and fitted laws."""

import json
import time
from pathlib import Path
from typing import Annotated

import pandas as pd
from pytask import Product, PythonNode, task

from study import contact, dataset, design, fitting, paths, tasks
from study.mechanism import links

SIZE = 10  # set-ups per task, at most

BATCHES = {
    f"{group}-{k // SIZE}": [s for s in design.DESIGN if s.group == group][k : k + SIZE]
    for group in design.GROUPS
    for k in range(0, sum(s.group == group for s in design.DESIGN), SIZE)
}
PARTS = [paths.BUILD / "curves" / f"{name}.csv" for name in BATCHES]
LINK_SOURCES = tuple(
    paths.ROOT / f"study/mechanism/{name}.py" for name in ("scene", "rigid", "particles", "links")
)
TIMES = [part.with_suffix(".json") for part in PARTS]

for (name, batch), part, seconds in zip(BATCHES.items(), PARTS, TIMES, strict=True):

    @task(id=name)
    def task_curves(
        members: Annotated[str, PythonNode(value=repr(batch), hash=True)],
        batch: list[design.SetUp] = batch,
        code: tuple[Path, ...] = dataset.SOURCES,
        part: Annotated[Path, Product] = part,
        seconds: Annotated[Path, Product] = seconds,
    ):
        tasks.leave_interrupts_to_the_runner()
        start = time.perf_counter()
        dataset.write_curves(pd.concat(map(dataset.solve_set_up, batch)), part)
        seconds.write_text(json.dumps(time.perf_counter() - start))


def task_table(parts: list[Path] = PARTS, table: Annotated[Path, Product] = dataset.CURVES):
    frames = [pd.read_csv(part) for part in parts]
    dataset.write_curves(pd.concat(frames), table)


def task_coefficients(
    table: Path = dataset.CURVES,
    published: Path = paths.DATA / "published/tables.csv",
    coefficients: Annotated[Path, Product] = contact.laws.COEFFICIENTS,
):
    frame = pd.read_csv(table)
    paper = frame[(frame.group == "paper") & (frame.kinematics == design.PAPER_KINEMATICS)]
    stated = pd.read_csv(published, index_col=["where", "row", "quantity"]).value
    fits = fitting.fit_laws(paper, -stated["Table 2", "liu", "R2"])  # printed without its sign
    fits["stiffened_hertz"] = fitting.fit_stiffening(frame[frame.group == "fit"])
    with paths.whole(coefficients) as temporary:
        temporary.write_text(fitting.format_coefficients(fits), encoding="utf-8")


def task_links(
    coefficients: Path = contact.laws.COEFFICIENTS,
    code: tuple[Path, ...] = LINK_SOURCES,
    table: Annotated[Path, Product] = dataset.LINKS,
):
    tasks.leave_interrupts_to_the_runner()
    dataset.write_curves(links.measure(), table)


def task_description(
    table: Path = dataset.CURVES,
    links: Path = dataset.LINKS,
    coefficients: Path = contact.laws.COEFFICIENTS,
    code: tuple[Path, ...] = dataset.SOURCES,
    times: list[Path] = TIMES,
    published: tuple[Path, ...] = tuple(paths.DATA / name for name in dataset.PUBLISHED),
    description: Annotated[Path, Product] = dataset.PACKAGE,
):
    dataset.write_package(sum(json.loads(path.read_text()) for path in times))
