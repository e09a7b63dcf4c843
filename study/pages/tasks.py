"""Runs tasks with pytask: what is outdated, in parallel, on this machine or on a Dask cluster.

pytask decides what is outdated and records it in ``pytask.lock``; nothing else reads its files. All
adaptations of pytask are in this module, and four of them use parts that it does not document:

- `_is_interrupted` asks the scheduler whether tasks are left, because pytask-parallel does not
  report that a run was interrupted.
- `_watched_by` replaces the function that creates the plugin manager, because ``pytask.build``
  accepts no plugins: an entry point would act on every use of pytask in the environment, and
  ``--hook-module`` is an option of pytask's own command line only.
- `_polled_often` replaces the waiting time of pytask-parallel, which looks for finished tasks ever
  more rarely, at last once in a second: with short tasks, processes were idle for a tenth of a run.
- `_Progress` walks the session's graph of tasks and files to count the tasks that a run may execute
  before the first one begins.
"""

import os
import re
import sys
import time
import warnings
from collections import Counter
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from shutil import get_terminal_size
from typing import NamedTuple

from study import checks, paths
from study.checks import StudyError
from study.workers import begin, check_limits, dask_client

_INTERVAL = 0.05  # s


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
    scheduler. Standard output gets a line for each task that ends, and a summary (`_Progress`).
    Finished tasks stay finished after ``KeyboardInterrupt``; the next call resumes.

    Raises `study.checks.StudyError` if the limit of memory is too low, the folder has no task,
    another build is running, or the Dask scheduler does not answer or has no workers.
    """
    from loky import cpu_count, get_reusable_executor
    from pytask_parallel import ParallelBackend, registry

    paths.require_checkout(folders[0])
    check_limits()
    workers = cpu_count() if jobs is None else checks.whole("jobs", jobs, least=1)
    with alone(), dask_client(dask_address) if dask_address else nullcontext() as client:
        paths.remove_abandoned()
        if client:
            workers = sum(client.nthreads().values())
        executor = client.get_executor if client else partial(_processes, workers)
        registry.register_parallel_backend(ParallelBackend.CUSTOM, lambda n_workers: executor())
        session, progress = None, _Progress(workers)
        try:
            with _watched_by(progress), _polled_often():
                session = _session(
                    folders,
                    expression,
                    force=force,
                    parallel_backend="custom" if client or workers > 1 else "none",
                    n_workers=workers,
                )
        finally:
            progress.end()
            if not client and (session is None or _is_interrupted(session)):
                # a worker left alone would keep the interpreter from ending
                get_reusable_executor(reuse=False, kill_workers=True).shutdown()
    if _is_interrupted(session):
        raise KeyboardInterrupt
    return Built(*_outcome(session))


@contextmanager
def _polled_often():
    """Let pytask-parallel look for finished tasks at equal, short intervals, in this context."""
    from pytask_parallel.execute import _Sleeper

    sleep = _Sleeper.sleep
    _Sleeper.sleep = lambda _: time.sleep(_INTERVAL)
    try:
        yield
    finally:
        _Sleeper.sleep = sleep


def outdated(folders: list[Path], expression: str = "") -> list[str]:
    """Names of the tasks that `build` would run; of those that may stay as they are, too.

    These read what another one makes, which may come out as it was.
    """
    from pytask import TaskOutcome

    paths.require_checkout(folders[0])
    session = _session(folders, expression, dry_run=True)
    would_be = [r for r in session.execution_reports if r.outcome != TaskOutcome.SKIP_UNCHANGED]
    return [_name(report.task) for report in would_be]


def _session(folders, expression, **options):
    """Session of pytask after a run. What pytask prints is shown only if it could not begin."""
    import pytask

    with pytask.console.capture() as printed:
        session = pytask.build(
            paths=folders,
            config=paths.ROOT / "pyproject.toml",
            expression=expression,
            show_traceback=False,
            show_capture="no",
            verbose=0,  # no live table, which would take over standard output
            **options,
        )
    if session.exit_code != 0 and not session.execution_reports:
        print(printed.get().strip(), file=sys.stderr)
        raise StudyError("the tasks could not be collected; the reason is printed above")
    if not session.tasks:
        raise StudyError(
            f"no task was found in {', '.join(map(str, folders))}, because pytask skips every "
            "folder named build or dist; rename the folder of the project"
        )
    return session


@contextmanager
def _watched_by(plugin):
    """Call the methods of a plugin that are named after hooks of pytask, in this context."""
    from _pytask import build as module
    from pytask import hookimpl

    for name in filter(re.compile("pytask_").match, dir(plugin)):
        hookimpl(tryfirst=True)(getattr(type(plugin), name))  # here, as pytask is imported late
    create = module.get_plugin_manager

    def create_with_plugin():
        manager = create()
        manager.register(plugin)
        return manager

    module.get_plugin_manager = create_with_plugin
    try:
        yield
    finally:
        module.get_plugin_manager = create


class _Progress:
    """Plugin of pytask that prints a line for each task that ends, and a summary.

    The number of tasks is that of the outdated ones and of those that read from them. It becomes
    smaller when one of the latter proves to be up to date. On a terminal the last line names the
    tasks that are running.
    """

    def __init__(self, workers):
        self._workers, self._names = workers, {}
        self._begun, self._seconds, self._counts = {}, 0.0, Counter()

    def pytask_execute_log_start(self, session):
        from pytask import has_mark

        selected = {t.signature: t for t in session.tasks if not has_mark(t, "skip")}
        left = [name for name, task in selected.items() if _is_outdated(session, task)]
        while left:
            name = left.pop()
            if name in selected and name not in self._names:
                self._names[name] = _name(selected[name])
                for product in session.dag.successors(name):
                    left += session.dag.successors(product)
        self._total, self._started = len(self._names), time.monotonic()
        if self._total > 1:
            at_once = min(self._workers, self._total)
            self._print(f"Running {self._total} tasks in {_count(at_once, 'process', 'es')}.")

    def pytask_execute_task_log_start(self, task):
        self._begun[task.signature] = time.monotonic()
        if task.signature in self._names:
            self._show_running()

    def pytask_execute_task_log_end(self, report):
        from pytask import TaskOutcome

        name, outcome = report.task.signature, report.outcome
        took = time.monotonic() - self._begun.pop(name)
        self._counts[outcome] += 1
        if outcome in (TaskOutcome.SUCCESS, TaskOutcome.FAIL):
            done = self._counts[TaskOutcome.SUCCESS] + self._counts[TaskOutcome.FAIL]
            failed = " failed" * (outcome == TaskOutcome.FAIL)
            line = f"{done} of {self._total}  {_name(report.task)}{failed} ({took:.1f} s)"
            self._seconds = time.monotonic() - self._started
            if left := self._total - done:
                line += f", about {_duration(self._seconds / done * left)} left"
            self._print(line)
        elif name in self._names:  # it is up to date, or needs one that failed
            self._total -= 1
        if name in self._names:
            self._show_running()

    def end(self):
        """Print the summary, if a task was run."""
        from pytask import TaskOutcome

        counts = self._counts
        self._print()
        if not (ran := counts[TaskOutcome.SUCCESS] + counts[TaskOutcome.FAIL]):
            return
        notes = {
            "failed": counts[TaskOutcome.FAIL],
            "not run because a needed task failed": counts[TaskOutcome.SKIP_PREVIOUS_FAILED],
            "already up to date": counts[TaskOutcome.SKIP_UNCHANGED],
        }
        parts = [f"{_count(ran, 'task')} run in {_duration(self._seconds)}"]
        parts += [f"{number} {text}" for text, number in notes.items() if number]
        self._print(f"{', '.join(parts)}.")

    def _show_running(self):
        running = [self._names[name] for name in self._begun if name in self._names]
        if running and sys.stdout.isatty():
            text = f"running: {', '.join(running)}"[: get_terminal_size().columns - 1]
            print(f"\r{text}\x1b[K", end="", flush=True)

    def _print(self, line=None):
        """Print a line, if any, in the place of the one that names what is running."""
        if sys.stdout.isatty():
            print("\r\x1b[K", end="", flush=True)
        if line is not None:
            print(line, flush=True)


def _is_outdated(session, task):
    """Whether a task would be run now; pytask's own check says so by an exception."""
    from pytask import SkippedUnchanged

    try:
        session.hook.pytask_execute_task_setup(session=session, task=task)
    except SkippedUnchanged:
        return False
    except Exception:  # a file that it needs is missing, which another task may make
        return True
    return True


def _count(number, noun, ending="s"):
    return f"{number} {noun}{ending * (number != 1)}"


def _duration(seconds):
    """Time for a reader: in s below two minutes, else in min."""
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


def _is_interrupted(session):
    """Whether a run ended by Ctrl-C, of which pytask-parallel says nothing: tasks are left then."""
    errors = [report.exc_info[1] for report in session.execution_reports if report.exc_info]
    return session.scheduler.is_active() or any(isinstance(e, KeyboardInterrupt) for e in errors)


@contextmanager
def alone():
    """Refuse to run while another build runs: both would write the same records and results.

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
                    f"another build is running in {paths.ROOT}; wait until it has ended"
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


def _name(task):
    """Identifier of one task among several, or else its function's name without ``task_``."""
    return re.split(r"\[|::task_", task.name)[-1].rstrip("]")


def _outcome(session):
    """Names of the tasks that a session ran, and a message for each cause of a failure."""
    from pytask import TaskOutcome

    made, failures = [], []
    for report in session.execution_reports:
        if report.outcome == TaskOutcome.SUCCESS:
            made.append(_name(report.task))
        elif report.outcome == TaskOutcome.FAIL:
            error = report.exc_info[1]
            is_ours = isinstance(error, StudyError)
            failures.append(str(error) if is_ours else f"{_name(report.task)}: {error}")
    return made, list(dict.fromkeys(failures))
