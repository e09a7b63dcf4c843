"""Notebooks run as a user runs them: outdated or not, failing, with other parameters, interrupted.

The notebooks are small ones in a copy of the project; `test_end_to_end` runs real ones.
"""

import csv
import re
import signal
import subprocess
import sys
import time

import nbformat
import pytest
from helpers.copied import environment, study
from helpers.stubs import CURVE, LABEL, LAW, NAMES, SAVE, TOTAL, edit, stub_project

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def finished_project(tmp_path_factory):
    """A project in which every notebook was run."""
    root = stub_project(tmp_path_factory.mktemp("copy") / "project")
    assert outdated(root) == set(NAMES)
    done = study(root, "run")
    assert done.returncode == 0, done.stdout + done.stderr
    assert ran(done) == list(NAMES)
    for name in ("curve.png", "numbers.csv", "law.csv", "total.csv"):
        assert f"figures/{name}" in done.stdout
        assert (root / "figures" / name).is_file()
    assert (root / "figures/total.csv").read_text() == "total\n6\n"
    return root


@pytest.fixture
def project(finished_project):
    """The same; what a test changes is undone after it."""
    files = [path for path in finished_project.rglob("*") if path.is_file()]
    before = {path: path.read_bytes() for path in files if "compiled" not in path.parts}
    yield finished_project
    for path in finished_project.rglob("*"):
        if path.is_file() and "compiled" not in path.parts and path not in before:
            path.unlink()
    for path, content in before.items():
        if not path.is_file() or path.read_bytes() != content:
            path.write_bytes(content)


def outdated(root):
    listed = study(root, "list", "--outdated")
    assert (listed.returncode, listed.stderr) == (0, "")
    return {row["notebook"] for row in csv.DictReader(listed.stdout.splitlines())}


def ran(done):
    return sorted(set(re.findall(r"build/notebooks/(\S+)\.ipynb", done.stdout)))


def test_a_second_run_has_nothing_to_do(project):
    assert outdated(project) == set()
    again = study(project, "run")
    assert (again.returncode, again.stderr) == (0, "")
    assert again.stdout.startswith("Nothing was outdated")
    assert again.stdout.splitlines()[-1] == "4 results: 4 identical, 0 agree, 0 differ"


@pytest.mark.parametrize(
    ("name", "reached"),
    [
        ("study/contact/laws.py", {LAW}),
        ("study/measure/stability.py", set()),
        ("figures/curve.png", {CURVE, TOTAL}),  # which reads what the first one makes
        ("build/notebooks/03-total.ipynb", {TOTAL}),
        ("notebooks/task_notebooks.py", set(NAMES)),
    ],
)
def test_a_change_makes_outdated_only_what_reaches_it(project, name, reached):
    path = project / name
    path.write_bytes(path.read_bytes() + (b"CHANGED = True\n" if path.suffix == ".py" else b"\n"))
    assert outdated(project) == reached


def test_a_run_makes_what_is_outdated_and_nothing_else(project):
    (project / "figures/numbers.csv").unlink()
    edit(project, LAW, "0.5)", "0.6)")
    assert outdated(project) == set(NAMES)
    done = study(project, "run", "--jobs", "1")
    assert ran(done) == [CURVE, LAW]  # the numbers are as they were: their total need not be made
    assert re.findall(r"^(\d) of \d  (\S+) \(\d+\.\d s\)", done.stdout, re.M) == [
        ("1", CURVE),
        ("2", LAW),
    ]
    assert re.search(r"^2 tasks run in \d+ s, 1 already up to date\.$", done.stdout, re.M)
    assert re.match(r"differs  figures/law.csv, row \d, column force: kept .* now ", done.stderr)
    assert outdated(project) == set()


def test_results_that_differ_are_named_until_they_are_made_again(project):
    first = {path.name: path.read_bytes() for path in (project / "figures").iterdir()}
    edit(project, CURVE, LABEL, 'axes.set_ylabel("Force")')
    edit(project, CURVE, "5.0 *", "6.0 *")
    edit(project, CURVE, SAVE, SAVE.replace("table", "table.assign(force=[1.0, 5.0])"))
    edited = study(project, "run")
    assert ran(edited) == [CURVE, TOTAL]
    assert edited.returncode == 1
    differing = sorted(edited.stderr.splitlines())
    assert re.fullmatch(r"differs  figures/curve.png, \d+ pixels differ", differing[0])
    assert differing[1:] == [
        "differs  figures/numbers.csv, row 3, column force: kept 5, now 6 (1 in all)",
        "differs  figures/total.csv, row 2, column total: kept 6, now 7 (1 in all)",
    ]
    assert edited.stdout.splitlines()[-1] == "4 results: 1 identical, 0 agree, 3 differ"
    assert (project / "figures/curve.png").read_bytes() != first["curve.png"]
    assert (project / "figures/curve.csv").read_bytes() == first["curve.csv"]
    again = study(project, "run")
    assert (again.returncode, again.stderr) == (1, edited.stderr)
    accepted = study(project, "run", "--force")
    assert (accepted.returncode, accepted.stderr) == (0, "")
    assert accepted.stdout.endswith("4 results: 4 identical, 0 agree, 0 differ\n")


def test_other_parameters_have_a_folder_of_their_own(project):
    kept = {path: path.read_bytes() for path in (project / "figures").iterdir()}
    executed = project / f"build/notebooks/{CURVE}.ipynb"
    kept[executed] = executed.read_bytes()
    words = ("run", "curve", "law", "total", "-p", "scale=100", "-p", "digits=3")
    done = study(project, *words)
    assert (done.returncode, done.stderr) == (0, "")
    assert re.search(r"^made  build/with/scale=100/curve.png +force over depth$", done.stdout, re.M)
    assert f"\n      build/with/scale=100/{CURVE}.ipynb\n" in done.stdout
    assert done.stdout.splitlines()[-1] == "1 results: 1 identical, 0 agree, 0 differ"  # the law
    made = project / "build/with/scale=100"
    assert (made / "numbers.csv").read_text().splitlines()[1:] == ["a,100", "b,500"]
    assert (project / "build/with/digits=3/total.csv").read_text() == "total\n6\n"
    assert all(path.read_bytes() == content for path, content in kept.items())
    assert outdated(project) == set()
    (made / "curve.png").unlink()
    again = study(project, "run", "curve", "-p", "scale=100.0")
    assert "made  build/with/scale=100/curve.png" in again.stdout
    assert ran(again) == []


def test_a_failing_cell_stops_its_results_alone(project):
    edit(project, CURVE, LABEL, "1 / 0")
    edit(project, LAW, "0.5)", "0.6)")
    done = study(project, "run")
    assert done.returncode == 1
    assert ran(done) == [LAW]
    failures = [line for line in done.stderr.splitlines() if line.startswith("failed:")]
    assert len(failures) == 1
    assert re.search(rf"^\d of \d  {CURVE} failed \(", done.stdout, re.M)
    assert "1 failed, 1 not run because a needed task failed" in done.stdout
    assert re.search(rf"failed: {CURVE}, cell In\[\d+\]: ZeroDivisionError", failures[0])
    assert "Traceback" not in done.stdout + done.stderr
    executed = nbformat.read(project / f"build/notebooks/{CURVE}.ipynb", as_version=4)
    kinds = [output.output_type for cell in executed.cells for output in cell.get("outputs", ())]
    assert "error" in kinds  # the copy shows where


def test_each_wrong_notebook_is_named_with_what_is_wrong(project):
    saved = 'figures.save_table(table, "numbers")'
    edit(project, CURVE, saved, f"{saved}\naxes.plot([0, 1])")
    edit(project, LAW, '"law.csv"', '"lw.csv"')
    done = study(project, "run", "curve", "law")
    assert done.returncode == 1
    assert re.search(rf"failed: {CURVE}, cell In\[\d+\] shows '\[<matplotlib", done.stderr)
    assert f"failed: {LAW} did not save law.csv\n" in done.stderr
    edit(project, LAW, "(paths", 'open(paths.results() / "law.csv", "w").close(); (paths')
    done = study(project, "run", "law")
    assert f"failed: {LAW} saved lw.csv, which" in done.stderr
    assert not (project / "figures/lw.csv").exists()


def test_a_damaged_dataset_stops_the_run_with_a_remedy(project):
    curves = project / "data/force_curves.csv"
    curves.write_bytes(curves.read_bytes()[:-100])
    done = study(project, "run", "--force")
    assert done.returncode == 1
    (failure,) = (line for line in done.stderr.splitlines() if line.startswith("failed:"))
    assert "data/force_curves.csv is damaged" in failure
    assert "study data build" in failure


def test_what_stops_a_run_before_it_begins_is_one_line(project):
    fcntl = pytest.importorskip("fcntl")
    with (project / "build/running").open("a") as running:
        fcntl.flock(running, fcntl.LOCK_EX)
        done = study(project, "run", "law")
    assert (done.returncode, done.stdout) == (1, "")
    assert re.fullmatch(f"study: another build is running in {project}; .*\n", done.stderr)

    (project / "notebooks/catalogue.toml").write_text("[[[")
    done = study(project, "list")
    assert (done.returncode, done.stdout) == (1, "")
    assert re.fullmatch(r"study: notebooks/catalogue\.toml: .*\n", done.stderr)


def test_an_interrupted_run_keeps_what_was_finished(project):
    begun, release = project / "begun", project / "release"
    wait = f"open('{begun}', 'w'); import os, time\nwhile not os.path.exists('{release}'):\n"
    edit(project, CURVE, LABEL, f"{wait}    time.sleep(0.1)")
    edit(project, LAW, "0.5)", "0.6)")
    compared = project / f"build/compared/{LAW}.json"
    before = compared.read_text()
    command = [sys.executable, "-m", "study.cli", "run", "curve", "law", "--jobs", "2"]
    process = subprocess.Popen(
        command,
        cwd=project,
        env=environment(project),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    try:
        while not (begun.exists() and compared.read_text() != before):
            assert process.poll() is None
            time.sleep(0.1)
        time.sleep(1.5)  # until the runner has noted it
        process.send_signal(signal.SIGINT)
        release.touch()  # a notebook that has begun is not broken off
        _, err = process.communicate()
    finally:
        process.kill()
    assert process.returncode == 130
    assert err.splitlines()[-1] == "study: interrupted; what was finished is kept"
    assert outdated(project) == {CURVE, TOTAL}
