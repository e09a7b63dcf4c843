"""Runs tasks with pytask: what is outdated, in parallel, on this machine or on a Dask cluster.

pytask decides what is outdated and records it in ``pytask.lock``; nothing else reads its files. Of
its parts only documented ones are used, but for the scheduler that says whether a run was broken
off (`_is_interrupted`).
"""

import io
import os
import re
import warnings
from contextlib import contextmanager, nullcontext, redirect_stdout
from functools import partial
from pathlib import Path
from typing import NamedTuple

from study import checks, paths
from study.checks import StudyError
from study.workers import begin, check_limits, dask_client


class Built(NamedTuple):
    """Tasks that were run, and a message for each that failed."""

    made: list[str]
    failures: list[str]


def build(
    folders: list[Path],
    expression: str = "",
    *,
    jobs: int | None = None,
    force: bool = False,
    dask_address: str | None = None,
) -> Built:
    """Run the outdated tasks of some folders; with ``force`` those that are up to date too.

    The expression selects tasks as ``pytask -k`` does, with those that they need, by default all.
    They run in as many processes as ``jobs``, by default one per core, or on the workers of a Dask
    scheduler. Finished tasks stay finished after ``KeyboardInterrupt``; the next call resumes.

    Raises `study.checks.StudyError` if memory is limited too much, the folder has no task, another
    build is running, or the Dask scheduler does not answer or has no workers.
    """
    from loky import cpu_count, get_reusable_executor
    from pytask_parallel import ParallelBackend, registry

    paths.require_checkout(folders[0])
    check_limits()
    workers = cpu_count() if jobs is None else checks.whole("jobs", jobs, least=1)
    with _alone(), dask_client(dask_address) if dask_address else nullcontext() as client:
        paths.remove_abandoned()
        if client:
            workers = sum(client.nthreads().values())
        executor = client.get_executor if client else partial(_processes, workers)
        registry.register_parallel_backend(ParallelBackend.CUSTOM, lambda n_workers: executor())
        session = None
        try:
            session = _session(
                folders,
                expression,
                force=force,
                parallel_backend="custom" if client or workers > 1 else "none",
                n_workers=workers,
            )
        finally:
            if not client and (session is None or _is_interrupted(session)):
                # a worker left alone would keep the interpreter from ending
                get_reusable_executor(reuse=False, kill_workers=True).shutdown()
    if _is_interrupted(session):
        raise KeyboardInterrupt
    return Built(*_outcome(session))


def outdated(folders: list[Path], expression: str = "") -> list[str]:
    """Names of the tasks that `build` would run; of those that may stay as they are, too.

    These read what another one makes, which may come out as it was.
    """
    from pytask import TaskOutcome

    paths.require_checkout(folders[0])
    with redirect_stdout(io.StringIO()):
        session = _session(folders, expression, dry_run=True)
    would_be = [r for r in session.execution_reports if r.outcome != TaskOutcome.SKIP_UNCHANGED]
    return [_name(report) for report in would_be]


def _session(folders, expression, **options):
    """Session of pytask after a run."""
    import pytask

    session = pytask.build(
        paths=folders,
        config=paths.ROOT / "pyproject.toml",
        expression=expression,
        show_traceback=False,
        show_capture="no",
        **options,
    )
    if session.exit_code != 0 and not session.execution_reports:
        raise StudyError("the tasks could not be collected, as said above")
    if not session.tasks:
        raise StudyError(
            f"no task was found in {', '.join(map(str, folders))}: pytask skips every folder "
            "named build or dist, so rename the project's folder"
        )
    return session


def _is_interrupted(session):
    """Whether a run ended by Ctrl-C, of which pytask-parallel says nothing: tasks are left then."""
    errors = [report.exc_info[1] for report in session.execution_reports if report.exc_info]
    return session.scheduler.is_active() or any(isinstance(e, KeyboardInterrupt) for e in errors)


@contextmanager
def _alone():
    """Refuse to run beside another build, as both would write the same records and results.

    The lock ends with the process that holds it, however that ends.
    """
    paths.BUILD.mkdir(exist_ok=True)
    with (paths.BUILD / "running").open("a") as file:
        if os.name == "posix":
            import fcntl

            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise StudyError(
                    f"another build is running in {paths.ROOT}: wait until it ends"
                ) from None
        yield


def _processes(workers):
    """Processes of this machine, which Ctrl-C does not end (`begin`).

    Loky ends idle workers after 10 s by default. A build waited for ever when all of them had
    ended with a task left: so they stay.
    """
    from loky import get_reusable_executor

    warnings.filterwarnings("ignore", "A worker was restarted", module="loky")  # it had grown
    first = {"initializer": begin, "initargs": (os.getpid(),)}
    return get_reusable_executor(workers, timeout=None, **first)


def _name(report):
    return re.split(r"\[|::task_", report.task.name)[-1].rstrip("]")


def _outcome(session):
    """Names of the tasks that a session ran, and a message for each cause of a failure."""
    from pytask import TaskOutcome

    made, failures = [], []
    for report in session.execution_reports:
        if report.outcome == TaskOutcome.SUCCESS:
            made.append(_name(report))
        elif report.outcome == TaskOutcome.FAIL:
            error = report.exc_info[1]
            told = str(error) if isinstance(error, StudyError) else f"{_name(report)}: {error}"
            failures.append(told)
    return made, list(dict.fromkeys(failures))
