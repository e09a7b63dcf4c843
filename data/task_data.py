"""The dataset's tasks: the curve of each case, then table, fitted laws, links and description."""

import json
import time
from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
from pytask import Product, PythonNode, mark, task

from study import paths
from study.choose import random_scenes
from study.contact.hertz_correction import TABLE
from study.contact.laws import COEFFICIENTS
from study.dataset import design, fitting, hertz_correction, store
from study.pages import tasks

BATCHES = list(design.batches())
PARTS = [paths.BUILD / f"curves/{cases[0][1]}.csv" for cases in BATCHES]
LIMITS, CHANGES = (
    [paths.BUILD / f"hertz_correction/{name}-{k}.txt" for k in range(counts["socket_poisson"])]
    for name, counts in (("limit", hertz_correction.LIMITS), ("change", hertz_correction.CHANGES))
)
SCENES, AT_ONCE = list(random_scenes.draw(0)), 10
LINKS = [paths.BUILD / f"links/scenes-{k:03d}.csv" for k in range(0, len(SCENES), AT_ONCE)]
TABLES = paths.DATA / "published/tables.csv"
DESCRIBED = tuple(paths.DATA / name for name in store.ORIGINS)

for cases, part in zip(BATCHES, PARTS, strict=True):

    @task(id=part.stem)
    def task_curves(
        resolved: Annotated[str, PythonNode(value=repr(cases), hash=True)],
        cases: list[tuple] = cases,
        code: list[Path] = store.sources(store.CURVES),
        part: Annotated[Path, Product] = part,
    ):
        tasks.leave_interrupts_to_the_runner()
        curves = []
        for case in cases:
            start = time.perf_counter()
            curve = store.solve_case(*case)
            curves.append(curve.assign(seconds=time.perf_counter() - start))
        with paths.whole(part) as temporary:
            pd.concat(curves).to_csv(temporary, index=False)


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
        temporary.write_text(json.dumps(fits, indent=2) + "\n", encoding="utf-8")


for counts, parts in ((hertz_correction.LIMITS, LIMITS), (hertz_correction.CHANGES, CHANGES)):
    for nu, part in zip(hertz_correction.grid(counts)["socket_poisson"], parts, strict=True):

        @mark.try_first  # they take the longest
        @task(id=part.stem)
        def task_hertz_correction(
            of: Annotated[tuple, PythonNode(value=(float(nu), (*counts.items(),)), hash=True)],
            code: list[Path] = store.sources(TABLE),
            part: Annotated[Path, Product] = part,
        ):
            tasks.leave_interrupts_to_the_runner()
            with paths.whole(part) as temporary:
                np.savetxt(
                    temporary, hertz_correction.logarithms(of[0], dict(of[1])).reshape(-1, 9)
                )


def task_hertz_correction_table(
    limits: list[Path] = LIMITS,
    changes: list[Path] = CHANGES,
    code: list[Path] = store.sources(TABLE),
    table: Annotated[Path, Product] = TABLE,
):
    found = [[np.loadtxt(part) for part in parts] for parts in (limits, changes)]
    store.write_hertz_correction(hertz_correction.table(*found))


for k, part in enumerate(LINKS):
    some = SCENES[AT_ONCE * k :][:AT_ONCE]

    @mark.try_last  # meanwhile coefficients are fitted to the curves
    @task(id=part.stem)
    def task_scenes(
        of: Annotated[str, PythonNode(value=repr(some), hash=True)],
        scenes: list = some,
        stiffening: Path = TABLE,
        code: list[Path] = store.sources(store.LINKS),
        part: Annotated[Path, Product] = part,
    ):
        tasks.leave_interrupts_to_the_runner()
        with paths.whole(part) as temporary:
            random_scenes.measure(scenes).to_csv(temporary, index=False)


def task_links(parts: list[Path] = LINKS, table: Annotated[Path, Product] = store.LINKS):
    store.write_table(pd.concat([pd.read_csv(part) for part in parts]), table)


def task_description(
    library: tuple[Path, ...] = store.LIBRARY,
    code: list[Path] = sorted({p for f in store.GENERATED for p in store.sources(f)}),
    design: Path = paths.ROOT / "study/dataset/design.py",
    parts: list[Path] = PARTS,
    described: tuple[Path, ...] = DESCRIBED,
    description: Annotated[Path, Product] = store.PACKAGE,
):
    times = pd.concat([pd.read_csv(part) for part in parts]).groupby("case").seconds.first()
    store.write_package(times.sum())
