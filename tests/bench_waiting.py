"""How long one waits for a command: run with ``make bench``. Nothing fails for being slow.

Processor time is that of a command and of all processes that it waits for; what it prints goes
nowhere.
"""

import os
import re
import resource
import shlex
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import NamedTuple

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


WAITS = (
    Wait("make reproduce, nothing outdated", f"{NO_SET_UP} reproduce", 2.5),
    Wait("study list", f"{BIN}/study list", 1.0),
    Wait("study joint", f"{BIN}/" + re.search(r"^study joint .*$", README, re.M)[0], 1.0),
    Wait("study simulate", f"{BIN}/study simulate", 1.0),
)


def run(command):
    """Status and processor time in s of one command."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    done = subprocess.run(shlex.split(command), cwd=paths.ROOT, check=False, **quiet)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.returncode, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def test_commands_with_nothing_to_make(capsys):
    rows = []
    for wait in WAITS:
        run(wait.run)  # makes what is outdated, and fills the caches
        statuses, times = zip(*(run(wait.run) for _ in range(TIMES)), strict=True)
        rows.append((wait, times, max(statuses, key=abs)))
    with capsys.disabled():
        print(f"\n{machine()}; load {os.getloadavg()[0]:.1f} of {os.cpu_count()}")
        print(f"{'processor time in s':30}{'median':>8}{'least':>8}{'most':>8}{'goal':>8}")
        for wait, times, status in rows:
            numbers = f"{median(times):8.2f}{min(times):8.2f}{max(times):8.2f}{wait.goal:8.1f}"
            print(f"{wait.name:30}{numbers}{f'  ended with status {status}' if status else ''}")
    assert not any(status for _, _, status in rows)
