"""The dataset's tasks: the curve of each case, then table, fitted laws, links and description."""

import time
from pathlib import Path
from typing import Annotated

import pandas as pd
from pytask import Product, PythonNode, task

from study import paths
from study.choose import links
from study.contact.laws import COEFFICIENTS
from study.dataset import design, fitting, store
from study.pages import tasks

CASES = [(s.group, name, joint, s.depths) for s in design.DESIGN for name, joint in s.cases()]
PARTS = [paths.BUILD / "curves" / f"{name}.csv" for _, name, _, _ in CASES]
TABLES = paths.DATA / "published/tables.csv"
DESCRIBED = tuple(paths.DATA / name for name in store.ORIGINS)

for case, part in zip(CASES, PARTS, strict=True):

    @task(id=case[1])
    def task_curve(
        resolved: Annotated[str, PythonNode(value=repr(case), hash=True)],
        case: tuple = case,
        code: list[Path] = store.sources(store.CURVES),
        part: Annotated[Path, Product] = part,
    ):
        tasks.leave_interrupts_to_the_runner()
        start = time.perf_counter()
        curve = store.solve_case(*case)
        with paths.whole(part) as temporary:
            curve.assign(seconds=time.perf_counter() - start).to_csv(temporary, index=False)


def task_table(parts: list[Path] = PARTS, table: Annotated[Path, Product] = store.CURVES):
    frames = [pd.read_csv(part) for part in parts]
    store.write_table(pd.concat(frames).drop(columns="seconds"), table)


def task_coefficients(
    table: Path = store.CURVES,
    published: Path = TABLES,
    code: list[Path] = store.sources(COEFFICIENTS),
    coefficients: Annotated[Path, Product] = COEFFICIENTS,
):
    fits = fitting.fit_all(pd.read_csv(table), pd.read_csv(published))
    with paths.whole(coefficients) as temporary:
        temporary.write_text(fitting.format_coefficients(fits), encoding="utf-8")


def task_links(
    coefficients: Path = COEFFICIENTS,
    code: list[Path] = store.sources(store.LINKS),
    table: Annotated[Path, Product] = store.LINKS,
):
    tasks.leave_interrupts_to_the_runner()
    store.write_table(links.measure(), table)


def task_description(
    coefficients: Path = COEFFICIENTS,
    code: list[Path] = sorted({p for f in store.GENERATED for p in store.sources(f)}),
    design: Path = paths.ROOT / "study/dataset/design.py",
    parts: list[Path] = PARTS,
    described: tuple[Path, ...] = DESCRIBED,
    description: Annotated[Path, Product] = store.PACKAGE,
):
    store.write_package(sum(pd.read_csv(part).seconds[0] for part in parts))
