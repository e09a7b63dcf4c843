"""Kernels that execute notebooks: forked from a process that has imported what notebooks import.

To start an interpreter and to import pandas, matplotlib and the study takes 1.3 s of processor time
for each notebook. Python's fork server does it once for all kernels that one worker starts. Each
kernel is a new interpreter where the system cannot fork (Windows), and in a daemonic process such
as a Dask worker, whose children Python's fork server refuses.
"""

import asyncio
import multiprocessing
import os
import signal
import sys
from pathlib import Path

from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpec
from jupyter_client.provisioning import LocalProvisioner

from study import paths, threads

_LAUNCHER = [sys.executable, "-m", "ipykernel_launcher"]
_FORKS = (
    "forkserver" in multiprocessing.get_all_start_methods()
    and not multiprocessing.current_process().daemon
)
_CONTEXT = multiprocessing.get_context("forkserver" if _FORKS else "spawn")
if _FORKS:
    _CONTEXT.set_forkserver_preload(["study.pages.preload"])


def manager(folder: Path, results: Path) -> type[AsyncKernelManager]:
    """Class of a kernel that lives in ``folder`` and writes figures and tables to ``results``.

    It is of this interpreter, without the user's settings.
    """
    environment = {
        **os.environ,
        **threads.ONE,
        paths.RESULTS_VARIABLE: str(results),
        "PYTHONPATH": os.pathsep.join([str(paths.ROOT), os.environ.get("PYTHONPATH", "")]),
        "PYTHONUTF8": "1",
        # settings in the user's home folder must not change a result
        "IPYTHONDIR": str(folder / "ipython"),
    }
    places = {"connection_file": str(folder / "kernel.json")}
    if os.name == "posix":  # not ports, which kernels started at the same time may share
        places |= {"transport": "ipc", "ip": str(folder / "socket")}

    class Kernel(AsyncKernelManager):
        kernel_spec = KernelSpec(argv=[*_LAUNCHER, "-f", "{connection_file}"], language="python")

        def __init__(self, **options):
            super().__init__(**(options | places))

        async def start_kernel(self, **options):
            if _FORKS:
                self.provisioner = _Forked(parent=self, kernel_spec=self.kernel_spec)
            await super().start_kernel(cwd=str(folder), env=environment, **options)

    return Kernel


class _Forked(LocalProvisioner):
    """Starts a kernel by the fork server in place of a command that runs an interpreter."""

    async def launch_kernel(self, cmd, **kwargs):
        arguments = cmd[len(_LAUNCHER) :], kwargs["cwd"], kwargs["env"]
        self.process = _Process(target=_serve, args=arguments)
        self.process.start()
        self.pid = self.pgid = self.process.pid
        return self.connection_info

    async def send_signal(self, signum):
        if signum != signal.SIGINT:  # sent before each shutdown: an idle kernel complains of it
            await super().send_signal(signum)

    async def wait(self):
        while self.process and self.process.poll() is None:
            await asyncio.sleep(0.01)  # a tenth of jupyter_client's
        return await super().wait()


class _Process(_CONTEXT.Process):
    """A process that is one kernel, with the attributes of `subprocess.Popen`."""

    stdin = stdout = stderr = None

    def poll(self):
        return self.exitcode

    def wait(self):
        self.join()
        return self.exitcode

    def send_signal(self, number):
        os.kill(self.pid, number)


def _serve(arguments, folder, environment):
    """Be a kernel, in a new session, until it is shut down."""
    os.setsid()
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(folder)
    sys.path.insert(0, str(paths.ROOT))
    from ipykernel.kernelapp import IPKernelApp

    parent = f"--IPKernelApp.parent_handle={os.getppid()}"  # the kernel ends with this process
    IPKernelApp.launch_instance(argv=[*arguments, parent])
