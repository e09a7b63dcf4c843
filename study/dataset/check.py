"""Checks the dataset: its files, that they have every case, and a sample of it solved again."""

import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from io import StringIO
from multiprocessing import get_context
from typing import Any

import numpy as np

from study import checks, paths
from study.dataset import cached, compare, design, store


def check(
    sample: int | None = 20, seed: int = 0, jobs: int | None = None
) -> Iterator[tuple[str, str]]:
    """Yield the name of each check of the dataset and what it found.

    ``sample`` is the number of cases that are solved again: force-depth curves of the design, and
    solutions that notebooks show, drawn with ``seed``. None is all of them, which takes some
    minutes. ``jobs`` is the number of processes, by default one for each core. Raises
    `DatasetError` for the first check that fails, with file, case and remedy.
    """
    if sample is not None:
        checks.whole("sample", sample, least=1)
    if jobs is not None:
        checks.whole("jobs", jobs, least=1)
    checks.whole("seed", seed, least=0)
    store.verify()
    yield "hashes", f"{len(store.files())} files agree with {paths.shown(store.HASHES)}"
    described = json.loads(store.PACKAGE.read_text(encoding="utf-8"))["resources"]
    for resource in (resource for resource in described if "schema" in resource):
        columns = list(store.read(paths.DATA / resource["path"]))
        fields = [field["name"] for field in resource["schema"]["fields"]]
        mend = f"restore it with: git checkout -- data/{resource['path']} data/SHA256SUMS"
        _same(resource["path"], "columns", columns, fields, mend)
    yield "description", f"{len(described)} files are described"
    curves = store.load()
    rows = {case.name: len(case.depths) for case in design.every_case()}
    mend = "build them with: study data build"
    _same("force_curves.csv", "cases", curves.groupby("case").size().to_dict(), rows, mend)
    for kind, path in store.SOLUTIONS.items():
        names = {case.name for case in cached.requests() if case.kind == kind}
        _same(f"solutions/{path.name}", "cases", set(store.read(path).case), names, mend)
    yield "cases", f"{len(rows)} curves with {len(curves)} rows; {len(cached.requests())} solutions"
    yield "solved again", _solve_again(sample, seed, jobs)


def _same(name, what, found, wanted, mend):
    """Raise `study.dataset.DatasetError` if the columns or cases of a file are not the wanted."""
    if found != wanted:
        lists = {
            "missing": [str(one) for one in wanted if one not in found],
            "not in the design": [str(one) for one in found if one not in wanted],
        }
        both = "; ".join(f"{of}: {', '.join(names)}" for of, names in lists.items() if names)
        how = both or ("in their order" if what == "columns" else "with all depths")
        raise store.DatasetError(f"data/{name} must have the {what} of the design, {how}; {mend}")


def _solve_again(sample, seed, jobs):
    """Solve cases again in several processes, and compare all of their numbers."""
    every: list[Any] = [*design.every_case(), *cached.requests()]
    drawn = every
    if sample is not None:
        numbers = np.random.default_rng(seed).choice(len(every), min(sample, len(every)), False)
        drawn = [every[k] for k in np.sort(numbers)]
    with ProcessPoolExecutor(jobs, get_context("spawn")) as executor:
        found = executor.map(_difference, drawn, chunksize=4 if sample is None else 1)
        for where in filter(None, found):
            executor.shutdown(wait=False, cancel_futures=True)
            raise store.DatasetError(f"{where}; solve all cases again with: study data build --all")
    return f"{len(drawn)} of {len(every)} cases agree"


def _difference(case):
    """Where the stored rows of a case differ from its solution, or None."""
    if isinstance(case, cached.Request):
        path, solved = store.SOLUTIONS[case.kind], cached.solve(case)
    else:
        path, solved = store.CURVES, design.solve(case)
    rows = store.read(path)
    tables = rows[rows.case == case.name], solved
    texts = (StringIO(store.as_csv(table, path.stem)) for table in tables)
    where = compare.differs(*texts, path.stem)
    return where and f"{paths.shown(path)}: case {case.name} solved again differs: {where}"
