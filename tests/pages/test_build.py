"""A build of the data that is killed and interrupted, in a temporary copy of the project."""

import os
import re
import signal
import socket
import subprocess
import sys
import time

import pandas as pd
import psutil
import pytest
from helpers.copied import change, copy_project, describe, environment, study

from study import paths

pytestmark = pytest.mark.slow


def heed_interrupts():
    """Undo what a shell does to a background job, whose children ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


LESS = """
DESIGN = (
    SetUp("paper", "paper", PAPER_SUPPORTS, r2_stars=(20, 200, 300)),
    *(s for s in DESIGN if s.group == "validation" and s.name < "validation-060"),
)
"""
"""A part of the dataset's design, for the whole takes minutes."""
SMALLER = {
    "dataset/design": [("12 if by_series", "4 if by_series")],
    "dataset/stiffening_fit": [
        (
            '_ORDER = ("',
            'for c in (LIMITS, CHANGES):\n    c |= dict.fromkeys(list(c)[:4], 2)\n_ORDER = ("',
        )
    ],
    "choose/random_scenes": [("COUNT = 160", "COUNT = 3")],
    "claims/set_ups": [("MECHANISMS = 64", "MECHANISMS = 2"), ("(0.05, 1.0)", "(0.05, 0.06)")],
}


@pytest.fixture
def less_data(tmp_path):
    """A copy of the project with less data to build, all of them up to date."""
    project = copy_project(tmp_path / "project")
    for name, changes in SMALLER.items():
        change(project, f"study/{name}.py", *changes)
    with (project / "study/dataset/design.py").open("a") as module:
        module.write(LESS)
    describe(project)
    return project


def start_build(project):
    """Start a build of the data, and return once two batches are noted down as finished."""
    command = [sys.executable, "-m", "study.cli", "data", "build"]
    process = subprocess.Popen(
        command,
        cwd=project,
        env=environment(project),
        stdout=(project.parent / "out").open("w"),
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heed_interrupts,
    )
    before = finished(project)
    while finished(project) < before + 2:
        assert process.poll() is None
        time.sleep(0.1)
    return process


def finished(root):
    """How many batches of cases pytask has noted in its lock file or the journal beside it."""
    return len(set(re.findall(r"task_curves\[.*?\]", "".join(p.read_text() for p in notes(root)))))


def notes(root):
    return root.glob("pytask.lock*")


def leftovers(root):
    return [path for path in root.rglob(".part-*") if path.exists()]


def test_a_killed_and_an_interrupted_build_of_the_data_resume(less_data):
    project = less_data
    (project / "data/force_curves.csv").unlink()
    killed = start_build(project)
    workers = psutil.Process(killed.pid).children(recursive=True)
    assert workers
    killed.kill()
    killed.communicate()
    psutil.wait_procs(workers)  # they end with it
    for path in (project / "build/curves").glob("*.csv"):  # whole, or not there
        assert path.read_text().endswith("\n")
    (project / f"data/.part-{socket.gethostname()}-{killed.pid}-x").mkdir()
    done = finished(project)

    process = start_build(project)
    assert finished(project) >= done + 2
    assert leftovers(project / "data") == []
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 130
    assert err.splitlines()[-1] == "study: interrupted; what was finished is kept"
    assert not (project / "data/force_curves.csv").exists()

    others = [project / name for name in OTHERS]
    before = [path.read_bytes() for path in others]
    resumed = study(project, "data", "build")
    assert resumed.returncode == 0, resumed.stderr
    skipped = re.search(r"(\d+) already up to date", resumed.stdout)
    assert int(skipped[1]) > done  # what the killed one had finished, and more
    assert leftovers(project) == []
    assert not (project / "build/stiffening").exists()  # up to date: it was not solved
    assert [path.read_bytes() for path in others] == before
    keys = ["case", "depth_star"]
    built = pd.read_csv(project / "data/force_curves.csv").set_index(keys)
    kept = pd.read_csv(paths.DATA / "force_curves.csv").set_index(keys)
    assert len(built) > 400
    numbers = ["force_star", "peak_pressure_star"]
    pd.testing.assert_frame_equal(built[numbers], kept.loc[built.index, numbers], rtol=1e-7)
    assert study(project, "data", "show").returncode == 0

    description = project / "data/datapackage.json"
    stated, stamp = description.read_bytes(), description.stat().st_mtime_ns
    again = study(project, "data", "build")
    assert (again.returncode, again.stderr) == (0, "")
    assert again.stdout.startswith("The dataset is up to date")
    assert again.stdout.count("\n") == 1
    assert (description.read_bytes(), description.stat().st_mtime_ns) == (stated, stamp)

    whole = study(project, "data", "build", "--from-nothing")
    assert whole.returncode == 0, whole.stderr
    assert len(list((project / "build/stiffening").iterdir())) == 2 + 2
    assert (
        len(pd.read_csv(project / "data/links.csv"))
        < 100
        < len(pd.read_csv(paths.DATA / "links.csv"))
    )
    assert study(project, "data", "build").stdout == again.stdout


OTHERS = ("data/links.csv", "study/contact/stiffening.csv")
"""What is not made from the curves; set_ups.csv is, by way of the coefficients."""
