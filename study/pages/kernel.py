"""The kernel in which a notebook runs as a task: this interpreter, without the user's settings."""

import os
import sys
from pathlib import Path

from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpec
from traitlets import Dict, Unicode
from traitlets.config import Config

from study import paths

COMMAND = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]


class Kernel(AsyncKernelManager):
    """A kernel in a folder and an environment of its own, which ends with this process."""

    folder = Unicode().tag(config=True)
    environment = Dict().tag(config=True)
    kernel_spec = KernelSpec(argv=COMMAND, language="python")

    async def start_kernel(self, **options):
        """Start it."""
        await super().start_kernel(cwd=self.folder, env=self.environment, **options)


def configuration(folder: Path, results: Path) -> Config:
    """Configure a kernel that lives in ``folder`` and writes figures and tables to ``results``."""
    config = Config()
    config.Kernel.folder = str(folder)
    config.Kernel.connection_file = str(folder / "kernel.json")
    if os.name == "posix":  # not ports, which kernels started at the same time may share
        config.Kernel.transport = "ipc"
        config.Kernel.ip = str(folder / "socket")
    config.Kernel.environment = os.environ | {
        paths.RESULTS_VARIABLE: str(results),
        "PYTHONPATH": os.pathsep.join([str(paths.ROOT), os.environ.get("PYTHONPATH", "")]),
        "PYTHONUTF8": "1",
        # kernels run side by side: their own threads would wait for each other
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        # settings in the user's home folder must not change a result
        "IPYTHONDIR": str(folder / "ipython"),
    }
    return config
