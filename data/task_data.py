"""The dataset's tasks: curves of cases, their table, fitted laws, links, set-ups, description.

Only what is damaged, out of date or made from that has tasks: the rest need not be solved.
"""

import hashlib
import json
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import pandas as pd
from pytask import Product, PythonNode, mark, task

from study import paths, provenance
from study.choose import random_scenes
from study.claims import set_ups
from study.dataset import design, fitting, production, solutions, stiffening_fit, store

MADE = production.to_make()
CODE = {path: production.code(path) for path in production.GENERATED}
BATCHES = list(design.batches())
PARTS = [paths.BUILD / f"curves/{cases[0][1]}.csv" for cases in BATCHES]
LIMITS, CHANGES = (
    [paths.BUILD / f"stiffening/{name}-{k}.txt" for k in range(counts["socket_poisson"])]
    for name, counts in (("limit", stiffening_fit.LIMITS), ("change", stiffening_fit.CHANGES))
)
POISSON = stiffening_fit.grid(stiffening_fit.SIZE_COUNTS)["socket_poisson"]
SIZES = [paths.BUILD / f"contact_size/{k}.txt" for k in range(len(POISSON))]
DESIGN = [paths.ROOT / "study/dataset/design.py"]
DESCRIBED = [*production.GENERATED, store.CASES, store.MATERIALS, *store.PUBLISHED]
KEPT = solutions.batches()
SCENES, AT_ONCE = list(random_scenes.draw(0)), 10
LINKS = [paths.BUILD / f"links/scenes-{k:03d}.csv" for k in range(0, len(SCENES), AT_ONCE)]
DRAWN = [*set_ups.draw(), *set_ups.FOUND]
SET_UPS = [paths.BUILD / f"set_ups/{one.number:03d}.csv" for one in DRAWN]


def decided_by(path, value=None):
    """A value for a task, which is outdated if it or the code that decides a file changes.

    It is no default of the task: pytask takes all defaults for one, by the name of any of them.
    """
    return PythonNode(value=value, hash=partial(_digest, CODE[path]))


def _digest(code, value):
    return hashlib.sha256(repr((code, value)).encode()).hexdigest()


for cases, part in zip(BATCHES, PARTS, strict=True):
    if store.CURVES not in MADE:
        break

    @task(id=part.stem)
    def task_curves(
        cases: Annotated[list[tuple], decided_by(store.CURVES, cases)],
        part: Annotated[Path, Product] = part,
    ):
        with paths.whole(part) as temporary:
            curves = pd.concat([production.solve_case(*case) for case in cases])
            curves.to_csv(temporary, index=False)


if store.CURVES in MADE:

    def task_table(parts: list[Path] = PARTS, table: Annotated[Path, Product] = store.CURVES):
        production.write_table(pd.concat([pd.read_csv(part) for part in parts]), table)


if MADE & {store.COEFFICIENTS, store.RELATIVE_COSTS}:

    def task_laws(
        decided: Annotated[None, decided_by(store.COEFFICIENTS)],
        table: Path = store.CURVES,
        published: Path = store.TABLES,
        measured: Path = store.SPEED,
        coefficients: Annotated[Path, Product] = store.COEFFICIENTS,
        relative_costs: Annotated[Path, Product] = store.RELATIVE_COSTS,
    ):
        numbers = {
            coefficients: fitting.fit_laws(pd.read_csv(table), pd.read_csv(published)),
            relative_costs: fitting.relative_costs(pd.read_csv(measured)),
        }
        for path, values in numbers.items():
            with paths.whole(path) as temporary:
                temporary.write_text(json.dumps(values, indent=2) + "\n", encoding="utf-8")


for counts, parts in ((stiffening_fit.LIMITS, LIMITS), (stiffening_fit.CHANGES, CHANGES)):
    if store.TABLE not in MADE:
        break
    for nu, part in zip(stiffening_fit.grid(counts)["socket_poisson"], parts, strict=True):

        @mark.try_first  # they take the longest
        @task(id=part.stem)
        def task_stiffening(
            of: Annotated[tuple, decided_by(store.TABLE, (float(nu), counts))],
            part: Annotated[Path, Product] = part,
        ):
            with paths.whole(part) as temporary:
                np.savetxt(temporary, stiffening_fit.logarithms(*of).reshape(-1, 9))


if store.TABLE in MADE:

    def task_stiffening_table(
        decided: Annotated[None, decided_by(store.TABLE)],
        limits: list[Path] = LIMITS,
        changes: list[Path] = CHANGES,
        table: Annotated[Path, Product] = store.TABLE,
    ):
        solved = [[np.loadtxt(part) for part in parts] for parts in (limits, changes)]
        production.write_coefficients(stiffening_fit.table(*solved), table)


for nu, part in zip(POISSON, SIZES, strict=True):
    if store.CONTACT_SIZE not in MADE:
        break

    @mark.try_first
    @task(id=f"contact-size-{part.stem}")
    def task_contact_size(
        of: Annotated[float, decided_by(store.CONTACT_SIZE, float(nu))],
        part: Annotated[Path, Product] = part,
    ):
        with paths.whole(part) as temporary:
            np.savetxt(temporary, stiffening_fit.sizes(of).reshape(-1, 9))


if store.CONTACT_SIZE in MADE:

    def task_contact_size_table(
        decided: Annotated[None, decided_by(store.CONTACT_SIZE)],
        parts: list[Path] = SIZES,
        table: Annotated[Path, Product] = store.CONTACT_SIZE,
    ):
        solved = [np.loadtxt(part) for part in parts]
        production.write_coefficients(stiffening_fit.size_table(solved), table)


for kind, path in store.SOLUTIONS.items():
    if path not in MADE:
        continue
    parts = [paths.BUILD / f"solutions/{kind}-{name}.csv" for name in KEPT[kind]]
    for cases, part in zip(KEPT[kind].values(), parts, strict=True):

        @task(id=part.stem)
        def task_solutions(
            cases: Annotated[list[tuple], decided_by(path, cases)],
            part: Annotated[Path, Product] = part,
        ):
            with paths.whole(part) as temporary:
                pd.concat(map(solutions.solve, cases)).to_csv(temporary, index=False)

    @task(id=path.stem)
    def task_kept(parts: list[Path] = parts, table: Annotated[Path, Product] = path):
        production.write_table(pd.concat([pd.read_csv(part) for part in parts]), table)


for k, part in enumerate(LINKS):
    if store.LINKS not in MADE:
        break
    some = SCENES[AT_ONCE * k :][:AT_ONCE]

    @mark.try_last  # meanwhile coefficients are fitted to the curves
    @task(id=part.stem)
    def task_scenes(
        scenes: Annotated[list, decided_by(store.LINKS, some)],
        stiffening: Path = store.TABLE,
        part: Annotated[Path, Product] = part,
    ):
        with paths.whole(part) as temporary:
            random_scenes.measure(scenes).to_csv(temporary, index=False)


if store.LINKS in MADE:

    def task_links(parts: list[Path] = LINKS, table: Annotated[Path, Product] = store.LINKS):
        production.write_table(pd.concat([pd.read_csv(part) for part in parts]), table)


for one, part in zip(DRAWN, SET_UPS, strict=True):
    if store.SET_UPS not in MADE:
        break

    @mark.try_last
    @task(id=f"set-up-{part.stem}")
    def task_set_ups(
        one: Annotated[set_ups.SetUp, decided_by(store.SET_UPS, one)],
        coefficients: Path = store.COEFFICIENTS,
        stiffening: Path = store.TABLE,
        part: Annotated[Path, Product] = part,
    ):
        with paths.whole(part) as temporary:
            set_ups.run([one]).to_csv(temporary, index=False)


if store.SET_UPS in MADE:

    def task_runs(parts: list[Path] = SET_UPS, table: Annotated[Path, Product] = store.SET_UPS):
        production.write_table(pd.concat([pd.read_csv(part) for part in parts]), table)


def task_description(
    decided: Annotated[str, PythonNode(value=provenance.digest(DESIGN, *CODE.values()), hash=True)],
    files: list[Path] = DESCRIBED,
    description: Annotated[Path, Product] = store.PACKAGE,
):
    production.write_description()
