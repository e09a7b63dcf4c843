"""The kernel in which a notebook runs as a task: this interpreter, without the user's settings."""

import os
import sys
from pathlib import Path

from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpec

from study import paths

COMMAND = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]


def manager(folder: Path, results: Path) -> type[AsyncKernelManager]:
    """Class of a kernel that lives in ``folder`` and writes figures and tables to ``results``."""
    environment = os.environ | {
        paths.RESULTS_VARIABLE: str(results),
        "PYTHONPATH": os.pathsep.join([str(paths.ROOT), os.environ.get("PYTHONPATH", "")]),
        "PYTHONUTF8": "1",
        # kernels run side by side: their own threads would wait for each other
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        # settings in the user's home folder must not change a result
        "IPYTHONDIR": str(folder / "ipython"),
    }
    places = {"connection_file": str(folder / "kernel.json")}
    if os.name == "posix":  # not ports, which kernels started at the same time may share
        places |= {"transport": "ipc", "ip": str(folder / "socket")}

    class Kernel(AsyncKernelManager):
        kernel_spec = KernelSpec(argv=COMMAND, language="python")

        def __init__(self, **options):
            super().__init__(**(options | places))

        async def start_kernel(self, **options):
            await super().start_kernel(cwd=str(folder), env=environment, **options)

    return Kernel
