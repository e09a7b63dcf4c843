"""Runs tasks with pytask: what is stale, in parallel, on this machine or on a Dask cluster."""

import os
import signal
import threading
from contextlib import contextmanager, nullcontext

import pytask
from _pytask import build as pytask_build
from loky import cpu_count, get_reusable_executor

from study import paths
from study.checks import StudyError

_RUNNER = "STUDY_RUNNER"  # process number of the runner, for its workers


def leave_interrupts_to_the_runner():
    """Ignore Ctrl-C in a worker process: the runner stops it, and says so once."""
    in_main_thread = threading.current_thread() is threading.main_thread()
    if in_main_thread and os.environ.get(_RUNNER) == str(os.getppid()):
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def build(folders, expression="", *, jobs=None, force=False, dask_address=None, dry=False):
    """Run the stale tasks of some folders.

    Parameters
    ----------
    folders : list of pathlib.Path
        Where the ``task_*.py`` files are.
    expression : str
        Which tasks, as for ``pytask -k``, with those that they need; all by default.
    jobs : int, optional
        Processes, by default one per core.
    force : bool
        Run fresh ones too.
    dask_address : str, optional
        Address of a Dask scheduler whose workers run the tasks instead.
    dry : bool
        Run nothing and print nothing, only find what is stale.

    Returns
    -------
    pytask.Session

    Raises
    ------
    study.checks.StudyError
        If the project's folder is read-only, or the Dask scheduler does not answer or has no
        workers.
    KeyboardInterrupt
        If interrupted; finished tasks stay finished, and the next call resumes.
    """
    paths.require_checkout(folders[0])
    options = {"n_workers": jobs or cpu_count()}
    options["parallel_backend"] = "loky" if options["n_workers"] > 1 else "none"
    client = None
    os.environ[_RUNNER] = str(os.getpid())
    if dask_address is not None:
        client = _dask_client(dask_address)
        options = {"parallel_backend": "dask", "n_workers": sum(client.nthreads().values())}
    if not dry:
        if not os.access(paths.ROOT, os.W_OK):
            raise StudyError(f"nothing can be built: the folder {paths.ROOT} is read-only")
        paths.sweep()
    pytask.console.quiet = dry
    finished = False
    try:
        with _no_cache_of_hashes() if dry else nullcontext():
            session = pytask.build(
                paths=folders,
                config=paths.ROOT / "pyproject.toml",
                expression=expression,
                force=force,
                dry_run=dry,
                show_traceback=False,
                capture="fd" if not dry else "no",
                show_capture="no",
                **options,
            )
        finished = session.scheduler is None or not session.scheduler.is_active()
    finally:
        pytask.console.quiet = False
        if client:
            client.close()
        if not finished:  # a worker left alone would keep the interpreter from ending
            get_reusable_executor(reuse=False, kill_workers=True).shutdown()
    if not finished:
        raise KeyboardInterrupt  # pytask-parallel swallows it and leaves its tasks undone
    return session


@contextmanager
def _no_cache_of_hashes():
    """Keep pytask from writing its cache of file hashes, which fails in a read-only folder."""
    kept = pytask_build.pytask_unconfigure
    pytask_build.pytask_unconfigure = None
    try:
        yield
    finally:
        pytask_build.pytask_unconfigure = kept


def _dask_client(address):
    try:
        from distributed import Client
    except ImportError:
        raise StudyError(
            "--dask needs the extra [dask]; install it with: pip install '.[dask]'"
        ) from None
    try:
        client = Client(address, timeout=5)
    except (OSError, ValueError) as error:
        raise StudyError(f"no Dask scheduler answers at {address} ({error})") from None
    if not client.nthreads():
        client.close()
        raise StudyError(f"the Dask scheduler at {address} has no workers")
    return client
