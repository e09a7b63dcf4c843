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


def check_limits(memory: int = BUILD) -> None:
    """Refuse a limit of memory under which a notebook dies, or a solver waits for ever.

    It waits where OpenBLAS (until 0.3.30) gets no memory: it asks for it again and again.
    """
    if os.name != "posix":
        return
    import resource

    allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
    if allowed != resource.RLIM_INFINITY and allowed < memory * 1024:
        what = "build" if memory == BUILD else "solution"
        limit = f"ulimit -v must be >= {memory} KiB, got {allowed // 1024} KiB"
        raise StudyError(f"there is not enough memory for a {what}: {limit}")


def begin(runner: int) -> None:
    """Prepare a worker: it ignores Ctrl-C, as its runner stops it, and ends soon after its runner.

    The runner, a process number, may be killed without ending its workers.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    multiprocessing.set_start_method(None, force=True)  # kernels that it starts do not know loky's

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
        raise StudyError(f"--dask requires the package distributed; {remedy}") from None
    try:
        client = Client(address, timeout=5)
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
