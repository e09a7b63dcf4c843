"""Solves the cases of a parameter study in processes or on Dask, and writes one table.

Every result is written immediately to a part file in the folder of the table, so that memory use
stays small and an interrupted study can be continued. The table is written from this file at the
end, in the order of the cases, with the same bytes for any number of processes.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

import csv
import hashlib
import json
import os
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from concurrent.futures import Executor, as_completed
from contextlib import closing, contextmanager, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from loky import ProcessPoolExecutor, cpu_count

from study import checks, paths
from study.checks import StudyError
from study.parameters import Quantity
from study.sweep import cases as of_cases
from study.sweep.cases import COLUMNS, ERROR, NAME, Case, Kind, Rows

ANSWERS_WITHIN = 30.0  # s, of a Dask scheduler
_TASK = 16  # most cases that a process gets at once
_PACKAGES = ("numpy", "scipy", "numba", "scikit-fem")


class Swept(NamedTuple):
    """Summary of a parameter study.

    Attributes
    ----------
    cases, rows
        Number of cases, and of rows in the table.
    columns
        Unit and meaning of each column of results, by its name.
    failures
        Reason of each failed case, by its number or name.
    kept
        Columns that are not parameters, which were copied.
    """

    cases: int
    rows: int
    columns: dict[str, Quantity]
    failures: dict[str, str]
    kept: list[str]


def run_study(
    cases: str | Path | Iterable[Mapping[str, Any]],
    kind: Kind,
    output: str | Path,
    *,
    jobs: int | None = None,
    dask_address: str | None = None,
    progress: Callable[[int, int, int], Any] | None = None,
    twice: bool = False,
) -> Swept:
    """Solve many joints, or simulate many mechanisms, and write one table.

    A joint has a row for each of its depths or forces. If none are given, it has about 50 rows for
    its whole curve, or 9 rows up to one clearance if the load is off the axis. A mechanism
    has one row. The columns are the number or name of the case, the given values, the results
    (`COLUMNS`), and ``error``. A case with invalid values, or one that fails, has a single row with
    the reason in this column.

    A joint with a ``tilt`` is pressed off the axis (`study.joint.Joint.solve`), and so is a ring
    or a ball with a bore, for which the default tilt is 90 deg.

    Parameters
    ----------
    cases
        CSV file with a row for each case, or mappings of its columns, for example from
        ``to_dict("records")`` of a pandas table. Columns are options of study joint, or options of
        study simulate and mechanism parameters, and optionally ``case`` with a name. Several
        depths, forces, layers or liners are a list, or are separated by semicolons. For an empty
        cell or None, the table has the default that was used. NaN is an error of its case. Columns
        that are not parameters are copied to the table.
    kind
        ``joints`` or ``scenes`` (mechanisms).
    output
        CSV file to write. A file with the additional suffix ``.part`` exists until the table is
        complete, and its cases are not solved again unless they or the code have changed.
    jobs, dask_address
        Number of processes, by default one for each core; or the address of a Dask scheduler, whose
        workers then solve the cases.
    progress
        Function that is called with three numbers of different cases: finished, all, and failed.
    twice
        Repeat each simulation at a second tolerance, for the column ``agrees_until``
        (`study.mechanism.compare.second_run`). This takes about three times as long.

    Raises
    ------
    ValueError
        Before any work, if no case is valid (the message names row and column), or if a column is
        probably a misspelt parameter, is a parameter of another kind of cases, or has the name of a
        result.
    study.checks.StudyError
        If the Dask scheduler does not answer, or a worker process ends. Finished cases are kept, as
        they are if the disk is full (``OSError``) or after ``KeyboardInterrupt``.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     table = Path(folder) / "joints.csv"
    ...     case = {"r2_star": 50, "depth_star": [0.1, 0.3]}
    ...     summary = run_study([case], "joints", table, jobs=1)
    >>> summary.cases, summary.rows, summary.failures
    (1, 2, {})
    """
    if jobs is not None:
        checks.whole("jobs", jobs, least=1)
    cases = Path(cases) if isinstance(cases, str) else cases
    output = Path(output)
    if isinstance(cases, Path) and cases.resolve() == output.resolve():
        raise ValueError(f"output must be another file than the cases, got {output}")
    every_case = of_cases.load(cases)
    form, bodies, complete = of_cases.prepared(kind, every_case, twice)
    own = of_cases.own_columns(form, dict.fromkeys(name for case in every_case for name in case))
    keys = _keys(form, every_case, own)
    different = dict(zip(keys, zip(bodies, every_case, strict=True), strict=True))
    output.parent.mkdir(parents=True, exist_ok=True)
    with _Part(output.with_name(f"{output.name}.part"), set(keys)) as part:

        def report():
            if progress is not None:
                progress(len(part.places), len(different), len(part.failures))

        report()
        left = {key: case for key, case in different.items() if key not in part.places}
        names = [case.get(NAME, str(row)) for row, case in enumerate(every_case, 1)]
        try:
            with closing(_solved(form, _tasks(left), jobs, dask_address)) as solved:
                for key, rows in solved:
                    part.add(key, rows)
                    report()
            count = _write(output, form, complete, names, map(part.rows, keys))
        except OSError as error:
            kept = f"{len(part.places)} of {len(different)} cases are kept"
            why = f"{error.strerror or error}; {kept}, and the same command continues from there"
            raise OSError(error.errno, why, str(output)) from None
    named = zip(names, keys, strict=True)
    failures = {name: part.failures[key] for name, key in named if key in part.failures}
    return Swept(len(every_case), count, COLUMNS[form], failures, own)


def _code() -> str:
    """Digest of the library and of the versions of the packages that decide a result."""
    packages = ("", "contact", "joint", "mechanism", "sweep")
    library = paths.sources(*packages, suffixes=(".py", ".csv", ".json", ".toml"))
    return paths.digest(library, *(version(package) for package in _PACKAGES))


def _keys(form, cases, own):
    """Key of each case, whatever its number, name, own columns and the order of its columns."""
    code, no_value = _code(), {NAME, *own}
    values = (sorted(pair for pair in case.items() if pair[0] not in no_value) for case in cases)
    return [paths.digest([], code, form, of_case) for of_case in values]


class _Part:
    """File of finished cases, a line with a checksum for each; memory has the places of lines."""

    def __init__(self, path: Path, keys: set[str]):
        self.places: dict[str, int] = {}
        self.failures: dict[str, str] = {}
        try:
            self._path, self._file = path, path.open("a+b")
        except OSError as error:  # reported with the user's path
            raise OSError(error.errno, error.strerror, str(path.with_suffix(""))) from None
        self._file.seek(0)
        place, line = 0, b"\n"
        for line in self._file:
            key, rows = self._read(line)
            if key in keys:  # not of other cases or other code, and not damaged
                self._note(key, rows, place)
            place += len(line)
        if not line.endswith(b"\n"):
            self._file.write(b"\n")

    def __enter__(self):
        return self

    def __exit__(self, failure, *_):
        with suppress(OSError):  # a full disk, which was reported already
            self._file.close()
        if failure is None or not self.places:  # finished, or nothing to go on with
            self._path.unlink(missing_ok=True)

    def add(self, key: str, rows: Rows) -> None:
        """Append a case, at once."""
        content = json.dumps([key, rows]).encode()
        line = b"%s %s\n" % (self._checksum(content), content)
        self._file.write(line)
        self._file.flush()
        self._note(key, rows, self._file.tell() - len(line))

    def rows(self, key: str) -> Rows:
        """Rows of a case."""
        self._file.seek(self.places[key])
        return self._read(self._file.readline())[1]

    def _note(self, key, rows, place):
        self.places[key] = place
        if reason := rows[0][-1]:
            self.failures[key] = reason

    @staticmethod
    def _checksum(content):
        return hashlib.sha256(content).hexdigest()[:32].encode()

    def _read(self, line):
        checksum, _, content = line.rstrip(b"\n").partition(b" ")
        return json.loads(content) if self._checksum(content) == checksum else ("", [])


def _write(output, form, cases, names, rows_of_cases):
    columns = dict.fromkeys(name for case in cases for name in case)
    inputs = [name for name in columns if name not in (NAME, *COLUMNS[form])]
    count = 0
    with paths.whole(output) as temporary, temporary.open("w", encoding="utf-8", newline="") as to:
        table = csv.writer(to, lineterminator="\n")
        table.writerow([NAME, *inputs, *COLUMNS[form], ERROR])
        for name, case, rows in zip(names, cases, rows_of_cases, strict=True):
            before = [name, *(case.get(column, "") for column in inputs)]
            table.writerows([*before, *row] for row in rows)
            count += len(rows)
    return count


def _tasks(cases: dict[str, tuple[str, Case]]) -> list[dict[str, Case]]:
    """Tasks for a process: cases that share bodies, by their keys."""
    groups: dict[str, list[tuple[str, Case]]] = {}
    for key, (bodies, case) in cases.items():
        groups.setdefault(bodies, []).append((key, case))
    return [
        dict(group[start : start + _TASK])
        for _, group in sorted(groups.items())
        for start in range(0, len(group), _TASK)
    ]


def _solved(
    form: str, tasks: list[dict[str, Case]], jobs: int | None, dask_address: str | None
) -> Generator[tuple[str, Rows], None, None]:
    """Keys and rows of cases, as they are finished."""
    count = min(jobs or cpu_count(), len(tasks))
    if dask_address is None and count < 2:  # here, without the start of a process
        for key, case in (item for task in tasks for item in task.items()):
            yield key, of_cases.solve(form, [case])[0]
        return
    with _executor(count, dask_address) as executor:
        running = {executor.submit(of_cases.solve, form, [*task.values()]): task for task in tasks}
        for future in as_completed(running):
            try:
                results = future.result()
            except Exception as error:
                why = "a worker process ended, perhaps because memory was short; use fewer --jobs"
                kept = "finished cases are kept"
                raise StudyError(f"{why}; {kept} ({type(error).__name__}: {error})") from error
            yield from zip(running.pop(future), results, strict=True)


@contextmanager
def _executor(count: int, dask_address: str | None) -> Iterator[Executor]:
    if dask_address is not None:
        with _dask_client(dask_address) as client:
            yield client.get_executor(pure=False)
        return
    executor = ProcessPoolExecutor(count, initializer=_begin, initargs=(os.getpid(),))
    try:
        yield executor
    except BaseException:
        executor.shutdown(kill_workers=True)
        raise
    executor.shutdown()


def _begin(runner: int) -> None:
    """Prepare a worker: it ignores Ctrl-C, as its runner stops it, and ends soon after its runner.

    The runner, a process number, may be killed without ending its workers.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch():
        while os.getppid() == runner:
            time.sleep(1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _dask_client(address: str) -> Any:
    """Client of a Dask scheduler that answers and has workers, or raise `StudyError`."""
    try:
        from distributed import Client
    except ImportError:
        remedy = "install it with: pip install '.[dask]'"
        raise StudyError(f"--dask requires the package distributed; {remedy}") from None
    try:
        client = Client(address, timeout=ANSWERS_WITHIN)
    except (OSError, ValueError) as error:
        raise StudyError(
            f"no Dask scheduler answers at {address} ({error}); check its address and that it runs"
        ) from None
    if not client.nthreads():
        client.close()
        raise StudyError(
            f"the Dask scheduler at {address} has no workers; start one with: dask worker {address}"
        )
    return client
