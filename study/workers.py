"""Who does the work of a build or of a parameter study: processes here, or a Dask cluster."""

import os
import signal
import threading
import time
from typing import Any

from study.checks import StudyError


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
