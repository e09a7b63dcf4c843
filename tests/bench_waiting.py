"""How long one waits for a command: run with ``make bench``. Nothing fails for being slow.

``make bench LONG=1`` also times what takes minutes: set-up by pip, everything from nothing, the
tests, all in a fresh clone of what is committed. Processor time is that of a command and of all
processes that it waits for; what it prints goes nowhere.
"""

import os
import re
import resource
import shlex
import subprocess
import sys
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import NamedTuple

import pytest

from study import paths
from study.measure.timing import machine

TIMES = 5
BIN = Path(sys.executable).parent  # with the environment that runs the benchmark
NO_SET_UP = f"make --old-file .venv/.ready BIN={BIN}"
README = (paths.ROOT / "README.md").read_text(encoding="utf-8")


class Wait(NamedTuple):
    """A command, how it is run, and the goal in s."""

    name: str
    run: str
    goal: float


SHORT = (  # processor time
    Wait("make reproduce, nothing outdated", f"{NO_SET_UP} reproduce", 2.5),
    Wait("study list", f"{BIN}/study list", 1.0),
    Wait("study joint", f"{BIN}/" + re.search(r"^study joint .*$", README, re.M)[0], 1.0),
    Wait("study simulate", f"{BIN}/study simulate", 1.0),
)
LONG = (  # wall time
    Wait("make setup, by pip", "make setup", 80.0),
    Wait("make reproduce, from nothing", "make reproduce", 90.0),
    Wait("make test", "make test", 240.0),
)


def run(command, folder, **environment):
    """Status, processor time and wall time in s of one command."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    done = subprocess.run(
        shlex.split(command), cwd=folder, env=os.environ | environment, check=False, **quiet
    )
    wall, after = perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return (
        done.returncode,
        after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        wall,
    )


def show(capsys, kind, rows):
    """Print a table of waits with their times; then fail if a command failed."""
    with capsys.disabled():
        print(f"\n{machine()}; load {os.getloadavg()[0]:.1f} of {os.cpu_count()}")
        print(f"{kind + ' in s':30}{'median':>8}{'least':>8}{'most':>8}{'goal':>8}")
        for wait, times, status in rows:
            numbers = f"{median(times):8.2f}{min(times):8.2f}{max(times):8.2f}{wait.goal:8.1f}"
            print(f"{wait.name:30}{numbers}{f'  ended with status {status}' if status else ''}")
    assert not any(status for _, _, status in rows)


def test_commands_with_nothing_to_make(capsys):
    rows = []
    for wait in SHORT:
        run(wait.run, paths.ROOT)  # makes what is outdated, and fills the caches
        statuses, times, _ = zip(*(run(wait.run, paths.ROOT) for _ in range(TIMES)), strict=True)
        rows.append((wait, times, max(statuses, key=abs)))
    show(capsys, "processor time", rows)


@pytest.mark.skipif("LONG" not in os.environ, reason="takes minutes: make bench LONG=1")
def test_everything_in_a_fresh_clone(capsys, tmp_path):
    subprocess.run(["git", "clone", "-q", str(paths.ROOT), "clone"], cwd=tmp_path, check=True)
    no_uv = tmp_path / "bin/uv"  # found first; `make setup` then takes pip
    no_uv.parent.mkdir()
    no_uv.write_text("#!/bin/sh\nexit 1\n")
    no_uv.chmod(0o755)
    environment = {"PATH": f"{no_uv.parent}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": ""}
    rows = []
    for wait in LONG:
        status, _, wall = run(wait.run, tmp_path / "clone", **environment)
        rows.append((wait, [wall], status))
    show(capsys, "wall time", rows)
