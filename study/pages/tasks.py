"""Runs tasks with pytask: what is stale, in parallel, on this machine or on a Dask cluster."""

import os
import re
import sys
import warnings
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import NamedTuple

from study import checks, paths
from study.checks import StudyError
from study.workers import begin, check_limits, check_several, dask_client


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
    """Run the stale tasks of some folders.

    Parameters
    ----------
    expression
        Tasks, as for ``pytask -k``, with those that they need; all by default.
    jobs
        Processes, by default one per core.
    force
        Run fresh ones too.
    dask_address
        Dask scheduler whose workers run the tasks.

    Raises
    ------
    study.checks.StudyError
        If memory or files are limited too much, the folder is read-only or has no task, another
        build is running, or the Dask scheduler does not answer or has no workers.
    KeyboardInterrupt
        If interrupted; finished tasks stay finished, and the next call resumes.
    """
    import pytask
    from loky import cpu_count, get_reusable_executor

    paths.require_checkout(folders[0])
    check_limits()
    if jobs is not None:
        checks.whole("jobs", jobs, least=1)
    workers = jobs or cpu_count()
    if dask_address is None and workers > 1:
        check_several()
    client = dask_client(dask_address) if dask_address is not None else None
    if client:
        workers = sum(client.nthreads().values())
    if not os.access(paths.ROOT, os.W_OK):
        raise StudyError(f"nothing can be built: the folder {paths.ROOT} is read-only")
    _prepare(client)
    finished = False
    try:
        with _alone():
            paths.remove_abandoned()
            session = pytask.build(
                paths=folders,
                config=paths.ROOT / "pyproject.toml",
                expression=expression,
                force=force,
                show_traceback=False,
                show_capture="no",
                parallel_backend="custom" if client or workers > 1 else "none",
                n_workers=workers,
            )
        finished = session.scheduler is None or not session.scheduler.is_active()
    finally:
        if client:
            client.close()
        if not finished:  # a worker left alone would keep the interpreter from ending
            get_reusable_executor(reuse=False, kill_workers=True).shutdown()
    if not finished:
        raise KeyboardInterrupt  # pytask-parallel swallows it and leaves its tasks undone
    return _outcome(session, folders)


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


def _prepare(client):
    """Set up pytask and pytask-parallel, of which no option does it."""
    import pytask
    from _pytask import build as pytask_build
    from _pytask.pluginmanager import get_plugin_manager
    from loky import get_reusable_executor
    from pytask_parallel import ParallelBackend, execute, registry

    class Interruption:
        """No summary, "Succeeded", of a session that was interrupted."""

        @staticmethod
        @pytask.hookimpl(tryfirst=True)
        def pytask_execute_log_end(session):
            if session.scheduler is not None and session.scheduler.is_active():
                raise pytask.ExecutionError

    def plugins():
        manager = get_plugin_manager()
        manager.register(Interruption)
        return manager

    def executor(n_workers):
        if client:
            return client.get_executor()
        # Loky ends idle workers after 10 s by default. A build waited for ever when all of them
        # had ended with a task left: so they stay.
        warnings.filterwarnings("ignore", "A worker was restarted", module="loky")  # it had grown
        first = {"initializer": begin, "initargs": (os.getpid(),)}
        return get_reusable_executor(n_workers, timeout=None, **first)

    registry.register_parallel_backend(ParallelBackend.CUSTOM, executor)
    pytask_build.get_plugin_manager = plugins  # only pytask's command line takes a plugin
    # It looks for finished tasks ever less often, down to once a second, while a core waits.
    execute._Sleeper = partial(execute._Sleeper, timings=[0.02])
    for name in [name for name in sys.modules if re.search(r"(^|\.)task_\w+$", name)]:
        del sys.modules[name]  # pytask finds the tasks of a module as it is imported, and only then


def _outcome(session, folders):
    """What a session did, by the tasks' names."""
    from pytask import TaskOutcome

    made, failures = [], []
    for report in session.execution_reports:
        name = re.split(r"\[|::task_", report.task.name)[-1].rstrip("]")
        if report.outcome == TaskOutcome.SUCCESS:
            made.append(name)
        elif report.outcome == TaskOutcome.FAIL:
            error = report.exc_info[1]
            failures.append(str(error) if isinstance(error, StudyError) else f"{name}: {error}")
    if session.exit_code != 0 and not failures:
        failures.append("the tasks could not be collected, as said above")
    elif not session.tasks:
        raise StudyError(
            f"no task was found in {', '.join(map(str, folders))}: pytask skips every folder "
            "named build or dist, so rename the project's folder"
        )
    return Built(made, failures)
