"""Solves the cases of a parameter study in processes or on Dask, and writes one table.

Rows are appended to a part file in the folder of the table as soon as a case is finished, so that
an interrupted study can be continued. The table is written from this file at the end, in the order
of the cases, with the same bytes for any number of processes.
"""

from __future__ import annotations  # so that help() shows names and not what they stand for

import csv
import json
import signal
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import closing, nullcontext, suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import joblib

from study import checks, paths
from study.checks import StudyError
from study.joint.joint import Joint
from study.joint.options import load as load_joint
from study.joint.options import values_of as values_of_joint
from study.parameters import Quantity
from study.sweep import cases as of_cases
from study.sweep.cases import COLUMNS, ERROR, NAME, Kind

ANSWERS_WITHIN = 30.0  # s, of a Dask scheduler
_PACKAGES = ("numpy", "scipy", "numba", "scikit-fem")
Rows = list[list[str]]


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
    joint: str | Path | Joint | None = None,
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
        study simulate and mechanism parameters, and optionally ``case`` with a name. Numbers are
        in SI units or have their unit, behind them or in the head of the column. Several depths,
        forces, layers or liners are a list, or are separated by semicolons. An empty cell or None
        is the default. NaN is an error of its case. Other columns are copied to the table.
    kind
        ``joints`` or ``scenes`` (mechanisms).
    output
        CSV file to write. A file with the additional suffix ``.part`` exists until the table is
        complete, and its cases are not solved again unless they or the code have changed.
    joint
        A joint, or a file that study joint --save wrote, whose values the columns replace.
    jobs, dask_address
        Number of processes, by default one for each core; or the address of a Dask scheduler, whose
        workers then solve the cases.
    progress
        Function that is called with three numbers of cases: finished, all, and failed.
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
    checks.choice("kind", kind, ("joints", "scenes"))
    if jobs is not None:
        checks.whole("jobs", jobs, least=1)
    if checks.flag("twice", twice) and kind != "scenes":
        raise ValueError(f"twice applies to scenes only, got {kind}; remove it")
    cases, output = Path(cases) if isinstance(cases, str) else cases, Path(output)
    if isinstance(cases, Path) and cases.resolve() == output.resolve():
        raise ValueError(f"output must be another file than the cases, got {output}")
    given = of_cases.load(cases)
    saved: dict[str, Any] = {}
    if joint is not None:
        saved = values_of_joint(joint) if isinstance(joint, Joint) else load_joint(Path(joint))
    form = of_cases.form_of(kind, given, saved)
    names = [case.get(NAME, str(row)) for row, case in enumerate(given, 1)]
    keys = _keys(form, given, saved, twice)
    rows, tasks = _checked(form, given, saved, keys)
    part = output.with_name(f"{output.name}.part")
    rows |= _finished(part, {*keys})
    tasks = [(key, values) for key, values in tasks if key not in rows]
    output.parent.mkdir(parents=True, exist_ok=True)
    times = Counter(keys)  # a case may be given several times
    done = sum(times[key] for key in rows)
    bad = sum(times[key] for key in rows if rows[key][0][-1])

    def report():
        if progress is not None:
            progress(done, len(keys), bad)

    try:
        with part.open("a", encoding="utf-8") as file:
            report()
            with closing(_solved(form, tasks, twice, jobs, dask_address)) as solved:
                for key, found in solved:
                    rows[key] = found
                    file.write(json.dumps([key, found]) + "\n")
                    file.flush()
                    done, bad = done + times[key], bad + times[key] * bool(found[0][-1])
                    report()
        _write(output, form, given, names, [rows[key] for key in keys])
    except OSError as error:
        kept = f"{len(rows)} of {len(keys)} cases are kept"
        why = f"{error.strerror or error}; {kept}, and the same command continues from there"
        raise OSError(error.errno, why, str(output)) from None
    finally:
        if part.is_file() and not part.stat().st_size:
            part.unlink()  # nothing to go on with
    part.unlink(missing_ok=True)
    reasons = {name: rows[key][0][-1] for name, key in zip(names, keys, strict=True)}
    failures = {name: reason for name, reason in reasons.items() if reason}
    columns = dict.fromkeys(name for case in given for name in case)
    own = [name for name in columns if name not in (NAME, *of_cases.inputs(form))]
    return Swept(len(given), sum(len(rows[key]) for key in keys), COLUMNS[form], failures, own)


def _keys(form, cases, saved, twice):
    """Key of each case: its values, the library, and the packages that decide a result."""
    packages = ("", "contact", "joint", "mechanism", "sweep")
    library = paths.sources(*packages, suffixes=(".py", ".csv", ".json", ".toml"))
    code = paths.digest(library, saved, twice, *(version(package) for package in _PACKAGES))
    known = of_cases.inputs(form)
    values = (sorted(cell for cell in case.items() if cell[0] in known) for case in cases)
    return [paths.digest([], code, form, of_case) for of_case in values]


def _checked(form, cases, saved, keys):
    """Rows of invalid cases by key, and keys and values of the others, sorted by their bodies.

    Raises ``ValueError`` if no case is valid.
    """
    failed, valid, reasons = {}, {}, []
    for row, (key, case) in enumerate(zip(keys, cases, strict=True), 1):
        try:
            values = of_cases.values_of(form, case, saved)
            valid[key] = of_cases.bodies_of(form, values), values
        except ValueError as error:
            reasons.append(f"row {row}: {error}")
            failed[key] = [of_cases.failed(form, str(error))]
    if not valid:
        raise ValueError(reasons[0])
    tasks = [(bodies, key, values) for key, (bodies, values) in valid.items()]
    return failed, [(key, values) for _, key, values in sorted(tasks, key=lambda task: task[0])]


def _finished(part: Path, keys: set[str]) -> dict[str, Rows]:
    """Rows of finished cases by key, without damaged lines of a part file and other cases."""
    finished: dict[str, Rows] = {}
    text = part.read_bytes() if part.is_file() else b""
    for line in text.splitlines():
        with suppress(ValueError, TypeError):  # cut by the end of a process
            key, rows = json.loads(line)
            if key in keys:
                finished[key] = rows
    if text and not text.endswith(b"\n"):
        with part.open("ab") as file:
            file.write(b"\n")
    return finished


def _solved(
    form: str,
    tasks: list[tuple[str, dict[str, Any]]],
    twice: bool,
    jobs: int | None,
    dask_address: str | None,
) -> Generator[tuple[str, Rows]]:
    """Keys and rows of cases, as they are finished."""
    count = min(jobs or joblib.cpu_count(), len(tasks))
    if dask_address is None and count < 2:  # here, without the start of a process
        for task in tasks:
            yield _solve(form, *task, twice)
        return
    client, backend = nullcontext(), {"backend": "loky", "initializer": _leave_interrupts}
    if dask_address is not None:
        client, backend = _dask_client(dask_address), {"backend": "dask"}
    with client, joblib.parallel_config(**backend):
        parallel = joblib.Parallel(-1 if dask_address else count, return_as="generator_unordered")
        try:
            with closing(
                parallel(joblib.delayed(_solve)(form, *of, twice) for of in tasks)
            ) as results:
                yield from results
        except joblib.externals.loky.process_executor.TerminatedWorkerError as error:
            raise StudyError(
                "a worker process ended, perhaps because memory was short; use fewer --jobs; "
                "finished cases are kept"
            ) from error


def _solve(form, key, values, twice):
    return key, of_cases.solve(form, values, twice)


def _leave_interrupts():
    """Let a worker ignore Ctrl-C, which reaches it too: its runner stops it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _write(output, form, cases, names, rows_of_cases):
    """Write the table: parameters in SI units, and texts that no spreadsheet takes for formulas."""
    columns = dict.fromkeys(name for case in cases for name in case)
    given = [name for name in columns if name not in (NAME, *COLUMNS[form])]
    known = of_cases.inputs(form)

    def cell(case, column):
        text, about = case.get(column, ""), known.get(column)
        with suppress(ValueError):
            if text and about and about.unit:
                return about.written(about.read(column, text))
        return text

    with paths.whole(output) as temporary, temporary.open("w", encoding="utf-8", newline="") as to:
        table = csv.writer(to, lineterminator="\n")
        table.writerow([NAME, *given, *COLUMNS[form], ERROR])
        for name, case, rows in zip(names, cases, rows_of_cases, strict=True):
            before = [_plain(text) for text in (name, *(cell(case, column) for column in given))]
            table.writerows([*before, *row] for row in rows)


def _plain(text):
    """A text that no spreadsheet takes for a formula: after an apostrophe, unless a number."""
    if text.startswith(checks.FORMULA):
        try:
            float(text)
        except ValueError:
            return f"'{text}"
    return text


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
