"""A Dask cluster that does the work of a build or of a parameter study."""

from typing import Any

from study.checks import StudyError


def client(address: str) -> Any:
    """Client of a Dask scheduler that answers and has workers, or raise `StudyError`."""
    try:
        from distributed import Client
    except ImportError:
        remedy = "install it with: pip install '.[dask]'"
        raise StudyError(f"--dask needs the extra [dask]; {remedy}") from None
    try:
        scheduler_client = Client(address, timeout=5)
    except (OSError, ValueError) as error:
        raise StudyError(f"no Dask scheduler answers at {address} ({error})") from None
    if not scheduler_client.nthreads():
        scheduler_client.close()
        raise StudyError(f"the Dask scheduler at {address} has no workers")
    return scheduler_client
