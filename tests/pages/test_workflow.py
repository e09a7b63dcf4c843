"""The workflow as a user meets it: outdated, failing, interrupted, killed, damaged, on a cluster.

The notebooks are small ones in a copy of the project, whose path has a space, an accent and quotes.
"""

import json
import os
import signal
import subprocess
import sys
import time

import psutil
import pytest
from helpers.project import CURVE, LAW, NAMES, TOTAL, edit, environment, stub_project, study

pytestmark = pytest.mark.slow

RESULTS = ["curve.csv", "curve.png", "law.csv", "numbers.csv", "total.csv"]
SLOW = "import time, pathlib; pathlib.Path(BEGUN).touch(); time.sleep(60)\n"


@pytest.fixture(scope="module")
def finished_project(tmp_path_factory):
    """A project in which every notebook was run, and every result accepted."""
    root = stub_project(tmp_path_factory.mktemp("a 'copy', \"é\"") / "project")
    done = study(root, "run")
    assert done.returncode == 1
    assert done.stderr.count("it was not accepted before; accept it with: study accept ") == 4
    assert ran(done) == list(NAMES)
    assert sorted(path.name for path in (root / "build/results").iterdir()) == RESULTS
    assert list((root / "figures").iterdir()) == []
    assert study(root, "accept", *NAMES).stdout.count("accepted  figures/") == len(RESULTS)
    assert (root / "figures/total.csv").read_text() == "total\n6\n"
    return root


@pytest.fixture
def project(finished_project):
    """The same; what a test changes is undone after it."""
    folders = [finished_project / name for name in ("notebooks", "figures", "data", "study")]
    files = [p for folder in folders for p in folder.rglob("*") if p.suffix not in (".pyc", "")]
    before = {path: path.read_bytes() for path in files}
    yield finished_project
    for path, content in before.items():
        if not path.is_file() or path.read_bytes() != content:
            path.write_bytes(content)


def ran(done):
    return sorted(name for name in NAMES if f"{name}  (" in done.stdout)


def status(root, *words):
    """Exit status and last line of a run."""
    done = study(root, *words)
    return done.returncode, (done.stderr or done.stdout).splitlines()[-1]


ALL_IDENTICAL = (0, "4 results: 4 identical, 0 agree, 0 differ")


def test_what_has_changed_is_run_with_its_readers_and_nothing_else(project):
    for path in (project / "notebooks/02-law.ipynb", project / "study/contact/laws.py"):
        path.touch()
    again = study(project, "run")
    assert "Nothing to be done" in again.stdout  # a new time is no change
    assert again.stdout.splitlines()[-1] == ALL_IDENTICAL[1]
    edit(project, CURVE, "5.0", "5.001")
    done = study(project, "run")
    assert ran(done) == [CURVE, TOTAL]
    assert done.returncode == 1
    assert "numbers.csv, row 3, column force: accepted 5, now 5.001 (1 in all)" in done.stderr
    assert "study accept numbers" in done.stderr
    assert done.stdout.splitlines()[-1] == "4 results: 1 identical, 0 agree, 3 differ"
    with (project / "study/contact/laws.py").open("a") as module:
        module.write("CHANGED = True\n")
    assert ran(study(project, "run")) == list(NAMES)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("depths =", "1 / 0; depths =", "cell In[2]: ZeroDivisionError: division by zero"),
        ('"law")', '"law"); figures.save_table(pd.DataFrame(), "x")', "saved x.csv, which noteb"),
    ],
)
def test_a_notebook_that_fails_is_named_and_the_others_go_on(project, old, new, message):
    edit(project, LAW, old, new)
    done = study(project, "run", "--force")
    assert (done.returncode, ran(done)) == (1, [CURVE, TOTAL])
    *_, reason, last = done.stderr.splitlines()
    assert reason.startswith("failed: 02-law")
    assert message in reason
    assert last == "study: 1 of the jobs failed: 02-law"


def start(root, begun):
    """Start a run of a notebook that waits, and return when it has begun."""
    edit(root, CURVE, "import pandas", f"{SLOW.replace('BEGUN', repr(str(begun)))}import pandas")
    process = subprocess.Popen(
        [sys.executable, "-m", "study.cli", "run"],
        cwd=root,
        env=environment(root),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    while not begun.exists():
        assert process.poll() is None
        time.sleep(0.1)
    return process


def test_a_run_that_is_killed_leaves_nothing_that_has_to_be_removed(project, tmp_path):
    process = start(project, tmp_path / "begun")
    busy = status(project, "run", "law")
    assert busy == (1, f"study: another run is working in {project}; wait until it has ended")
    children = psutil.Process(process.pid).children(recursive=True)
    assert len(children) >= 2  # job and kernel
    process.kill()
    process.communicate()
    psutil.wait_procs(children)  # they end with it
    edit(project, CURVE, "time.sleep(60)", "pass")
    done = study(project, "run")
    assert (done.returncode, done.stderr) == (0, "")
    assert CURVE in ran(done)
    assert done.stdout.splitlines()[-1] == ALL_IDENTICAL[1]
    assert list(project.rglob(".part-*")) == []


def test_an_interrupted_run_ends_at_once_and_keeps_what_is_finished(project, tmp_path):
    process = start(project, tmp_path / "begun")
    children = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate()
    assert (process.returncode, err.splitlines()[-1]) == (
        130,
        "study: interrupted; what was finished is kept",
    )
    assert "Traceback" not in err
    psutil.wait_procs(children)
    assert list(project.rglob(".part-*")) == []
    assert not (project / "build/notebooks/01-curve.ipynb").exists()


def test_a_file_that_is_edited_during_its_run_is_run_again(project, tmp_path):
    path = project / "notebooks/02-law.ipynb"
    late = f"import os; os.utime({str(path)!r})\nimport pandas"
    edit(project, LAW, "import pandas", late)
    done = study(project, "run", "law")
    assert done.returncode == 1
    assert "failed: 02-law: notebooks/02-law.ipynb was edited while it ran; run it" in done.stderr
    edit(project, LAW, late, "import pandas")
    assert status(project, "run", "law") == (0, "1 results: 1 identical, 0 agree, 0 differ")


def test_damaged_results_are_named_with_the_remedy(project):
    assert study(project, "run").returncode == 0
    table, picture = project / "build/results/curve.csv", project / "figures/curve.png"
    table.write_text("junk")
    picture.write_bytes(picture.read_bytes()[:60])
    code, line = status(project, "run", "curve")
    assert code == 1
    assert "make it again with: study run curve --force" in line
    done = study(project, "run", "curve", "--force")
    assert done.returncode == 0
    assert "drawn differently: build/results/curve.png (its table is identical)" in done.stdout
    assert study(project, "accept", "curve").stdout == "accepted  figures/curve.png\n"


def test_damaged_data_stop_a_run_with_one_line(project):
    path = project / "data/datapackage.json"
    path.write_text(path.read_text().replace("title", "tytle", 1))
    done = study(project, "run")
    assert (done.returncode, ran(done)) == (1, [])
    first, *_, last = done.stderr.splitlines()
    assert last == "study: 1 of the jobs failed: check"
    assert "git checkout -- data/datapackage.json" in first


def test_other_parameters_have_their_own_folder(project):
    before = {path: path.read_bytes() for path in (project / "figures").iterdir()}
    done = study(project, "run", "curve", "-p", "scale=2")
    assert (done.returncode, done.stderr) == (0, "")
    folder = project / "build/with/scale=2"
    assert (folder / "numbers.csv").read_text() == "case,force\na,2\nb,10\n"
    assert (folder / "01-curve.ipynb").is_file()
    for words, message in (
        (["curve", "-p", "scale=1000"], "parameter scale must be >= 0.5 and <= 200, got 1000"),
        (["curve", "-p", "skale=1"], "-p must be KEY=VALUE with KEY one of scale, got 'skale'"),
        (["-p", "scale=2"], "-p must be given with a NAME"),
        (["curve", "-p", "scale=2", "--force"], "--force cannot be used together with -p"),
    ):
        code, line = status(project, "run", *words)
        assert code == 2
        assert message in line
    assert {path: path.read_bytes() for path in (project / "figures").iterdir()} == before


def test_a_notebook_outside_the_workflow_writes_to_a_folder_for_experiments(project, tmp_path):
    before = {path: path.read_bytes() for path in (project / "figures").iterdir()}
    code = "import papermill, sys; papermill.execute_notebook(*sys.argv[1:], {'scale': 3})"
    output = tmp_path / "out.ipynb"
    subprocess.run(
        [sys.executable, "-c", code, "01-curve.ipynb", output],
        cwd=project / "notebooks",
        env=environment(project),
        check=True,
        capture_output=True,
    )
    said = "This is no run of the workflow: results are written to build/scratch/01."
    assert json.dumps(json.loads(output.read_text())).count(said) == 1
    scratch = project / "build/scratch/01"
    assert (scratch / "numbers.csv").read_text() == "case,force\na,3\nb,15\n"
    assert {path: path.read_bytes() for path in (project / "figures").iterdir()} == before


def test_jobs_can_be_submitted_by_a_command(tmp_path):
    root = stub_project(tmp_path / "project")
    submit = tmp_path / "submit"
    submit.write_text(f'#!/bin/sh\necho "$1" >> {tmp_path}/submitted\nsh "$1" >/dev/null 2>&1 &\n')
    submit.chmod(0o755)
    cluster = ["--executor", "cluster-generic", "--cluster-generic-submit-cmd", str(submit)]
    poll = ["--jobs", "2", "--seconds-between-status-checks", "1"]
    done = study(root, "run", "curve", "law", "--", *cluster, *poll)
    assert "3 results: 0 identical, 0 agree, 3 differ" in done.stdout, done.stderr
    assert len((tmp_path / "submitted").read_text().splitlines()) == 3  # with the check of the data


def test_a_new_case_is_solved_and_no_other(tmp_path):
    root = stub_project(tmp_path / "project")
    path, ratios = root / "study/dataset/design.py", "(0.0, 0.1, 0.2, 0.25, "
    path.write_text(path.read_text().replace(ratios, "(0.0, 0.1, 0.2, 0.22, 0.25, "))
    code, line = status(root, "data", "check")
    assert code == 1
    assert "missing: poisson-0.22-linear-200; build them with: study data build" in line
    before = (root / "data/force_curves.csv").read_text().splitlines()
    assert status(root, "data", "build") == (0, "Changed: data/force_curves.csv.")
    after = (root / "data/force_curves.csv").read_text().splitlines()
    assert len(after) == len(before) + 40
    assert [line for line in after if line not in before] == [
        line for line in after if ",poisson-0.22-" in line
    ]
    assert status(root, "data", "build") == (0, "No file of the dataset has changed.")
