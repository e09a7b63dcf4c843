"""Who does the work of a build or of a parameter study: processes here, or a Dask cluster."""

import multiprocessing
import os
import signal
import threading
import time
from typing import Any

from study.checks import StudyError

BUILD, SOLVER = 2_800_000, 1_300_000
"""Memory in KiB that any notebook needs, and the solution of any joint."""
_FILES = 128  # that a notebook opens


def check_limits(memory: int = BUILD) -> None:
    """Refuse limits of this process under which a notebook or solver dies, or waits for ever.

    It waits where OpenBLAS (until 0.3.30) gets no memory: it asks for it again and again.
    """
    if os.name != "posix":
        return
    import resource

    limits = [("-v", "too little memory", "RLIMIT_AS", 1024, memory)]
    if memory == BUILD:
        limits.append(("-n", "too few open files", "RLIMIT_NOFILE", 1, _FILES))
    what = "build" if memory == BUILD else "solution"
    for flag, short, name, unit, least in limits:
        allowed, _ = resource.getrlimit(getattr(resource, name))
        if allowed != resource.RLIM_INFINITY and allowed < least * unit:
            limit = f"ulimit {flag} is {allowed // unit}, and must be at least {least}"
            raise StudyError(f"{short} for a {what}: {limit}")


def check_several() -> None:
    """Refuse several processes where they cannot share semaphores, as without ``/dev/shm``."""
    try:
        multiprocessing.Semaphore()
    except OSError as error:
        why = f"share semaphores in /dev/shm ({error.strerror})"
        raise StudyError(f"several processes cannot {why}: take --jobs 1") from None


def begin(runner: int) -> None:
    """Prepare a worker: it ignores Ctrl-C, as its runner stops it, and ends soon after its runner.

    The runner, a process number, may be killed without ending its workers.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch():
        while os.getppid() == runner:
            time.sleep(1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def dask_client(address: str) -> Any:
    """Client of a Dask scheduler that answers and has workers, or raise `StudyError`."""
    try:
        from distributed import Client
    except ImportError:
        remedy = "install it with: pip install '.[dask]'"
        raise StudyError(f"--dask needs the extra [dask]; {remedy}") from None
    try:
        client = Client(address, timeout=5)
    except (OSError, ValueError) as error:
        raise StudyError(f"no Dask scheduler answers at {address} ({error})") from None
    if not client.nthreads():
        client.close()
        raise StudyError(f"the Dask scheduler at {address} has no workers")
    return client
