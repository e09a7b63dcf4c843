"""Real figures in a temporary copy of the project, and small notebooks on a Dask cluster."""

import json
import re
import socket
import subprocess
import sys
import time

import pytest
from helpers.copied import copy_project, environment, study
from helpers.stubs import NAMES, stub_project

from study import paths
from study.dataset.tolerance import table_differs

pytestmark = pytest.mark.slow


def test_figures_are_made_from_nothing(tmp_path):
    """One as kept, beside another of a shorter simulation; each in its own process."""
    project = copy_project(tmp_path / "project")
    for path in (project / "figures").iterdir():
        path.unlink()
    done = study(project, "run", "fig10", "fig17", "-p", "duration=0.02", "-p", "outputs=200")
    assert done.returncode == 0, done.stdout + done.stderr
    made = re.findall(r"build/\S+\.ipynb", done.stdout)
    shorter = project / "build/with/duration=0.02,outputs=200"
    assert [(project / name).parent.name for name in made] == ["notebooks", shorter.name]
    for name in ("fig10", "trend"):
        assert (project / f"figures/{name}.png").is_file()
        assert table_differs(paths.FIGURES / f"{name}.csv", project / f"figures/{name}.csv") is None
    assert not (project / "figures/fig17.csv").exists()
    lines = (shorter / "fig17.csv").read_text().splitlines()
    assert len(lines) == 202
    assert lines[-1].startswith("20,")
    executed = json.loads((project / made[1]).read_text())
    kinds = [
        output["output_type"] for cell in executed["cells"] for output in cell.get("outputs", [])
    ]
    assert kinds
    assert "error" not in kinds


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def test_the_same_tasks_run_on_a_dask_cluster(tmp_path):
    """Two tasks at once in one worker, and one beside them in another."""
    pytest.importorskip("distributed")
    project = stub_project(tmp_path / "project")
    address = f"tcp://127.0.0.1:{free_port()}"
    dask = [sys.executable, "-m", "dask"]
    local = ["--host", "127.0.0.1", "--no-dashboard"]
    commands = [[*dask, "scheduler", "--port", address.split(":")[-1], *local]]
    for threads in (2, 1):
        of_worker = ["--nthreads", str(threads), "--name", str(threads), *local]
        commands.append([*dask, "worker", address, *of_worker])
    started = []
    try:
        for command in commands:
            log = open(tmp_path / f"{len(started)}.log", "w")  # noqa: SIM115
            started.append(
                subprocess.Popen(
                    command, cwd=tmp_path, env=environment(project), stdout=log, stderr=log
                )
            )
        wait_for_workers(address, 2)
        done = study(project, "run", "--dask", address)
        assert done.returncode == 0, done.stdout + done.stderr
        made = set(re.findall(r"build/notebooks/(\S+)\.ipynb", done.stdout))
        assert made == set(NAMES)
        assert (project / "figures/total.csv").read_text() == "total\n6\n"
        again = study(project, "run")
        assert "Nothing was outdated" in again.stdout
    finally:
        for process in reversed(started):
            process.terminate()
        for process in started:
            process.wait()


def wait_for_workers(address, count):
    from distributed import Client

    while True:
        try:
            with Client(address) as client:
                client.wait_for_workers(count)
                return
        except OSError:  # the scheduler does not listen yet
            time.sleep(0.2)
