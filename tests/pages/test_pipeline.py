"""Notebooks run as a user runs them: stale or fresh, failing, with other parameters, interrupted.

The notebooks are small ones in a copy of the project; `test_end_to_end` runs real ones.
"""

import csv
import json
import re
import shlex
import signal
import subprocess
import sys
import time

import nbformat
import pytest
from helpers.copied import environment, study
from helpers.stubs import CURVE, LABEL, LAW, NAMES, SAVE, TOTAL, edit, stub_project

LIST = ["-m", "study.cli", "list"]


@pytest.fixture(scope="module")
def fresh_project(tmp_path_factory):
    """A project in which every notebook was run."""
    root = stub_project(tmp_path_factory.mktemp("copy") / "project")
    assert states(root) == dict.fromkeys(NAMES, "stale")
    done = study(root, "run")
    assert done.returncode == 0, done.stdout + done.stderr
    assert ran(done) == list(NAMES)
    for name in ("curve.png", "numbers.csv", "law.csv", "total.csv"):
        assert f"figures/{name}" in done.stdout
        assert (root / "figures" / name).is_file()
    assert (root / "figures/total.csv").read_text() == "total\n6\n"
    assert states(root) == dict.fromkeys(NAMES, "fresh")
    return root


@pytest.fixture
def project(fresh_project):
    """The same; what a test changes is undone after it."""
    files = [path for path in fresh_project.rglob("*") if path.is_file()]
    before = {path: path.read_bytes() for path in files if "compiled" not in path.parts}
    yield fresh_project
    for path in fresh_project.rglob("*"):
        if path.is_file() and "compiled" not in path.parts and path not in before:
            path.unlink()
    for path, content in before.items():
        if not path.is_file() or path.read_bytes() != content:
            path.write_bytes(content)


def states(root, *names):
    listed = csv.DictReader(study(root, "list", *names).stdout.splitlines())
    return {row["notebook"]: row["state"] for row in listed}


def ran(done):
    return sorted(set(re.findall(r"build/notebooks/(\S+)\.ipynb", done.stdout)))


def stale(root):
    return {name for name, state in states(root).items() if state == "stale"}


def test_what_is_fresh_is_found_without_a_runner(project):
    again = study(project, "run")
    assert (again.returncode, again.stderr) == (0, "")
    assert "Nothing was stale" in again.stdout
    assert again.stdout.splitlines()[-1] == "4 results: 4 identical, 0 agree, 0 differ"
    heavy = {"pytask", "sqlalchemy", "pandas", "matplotlib", "scipy", "papermill", "numba"}
    for words in (["list"], ["run"]):
        code = (
            "import sys\nfrom study.cli import main\n"
            f"sys.argv = ['study', *{words}]\n"
            "try:\n    main()\nexcept SystemExit:\n    print(*sys.modules, file=sys.stderr)\n"
        )
        command = [sys.executable, "-c", code]
        options = {"env": environment(project), "capture_output": True, "text": True}
        done = subprocess.run(command, cwd=project, **options)
        loaded = set(done.stderr.split())
        assert "study.pages.freshness" in loaded
        assert not heavy & loaded


def change(path):
    path.write_text(path.read_text() + "CHANGED = True\n")


def test_a_changed_module_makes_stale_only_what_reaches_it(project):
    for module, reached in (
        ("contact/laws", {LAW}),
        ("pages/figures", {CURVE, TOTAL}),  # which reads what the first one makes
        ("measure/stability", set()),
    ):
        path = project / f"study/{module}.py"
        text = path.read_text()
        change(path)
        assert stale(project) == reached, module
        path.write_text(text)
    assert stale(project) == set()


def test_a_changed_product_table_read_or_task_makes_stale(project):
    for name, reached in (
        ("figures/law.csv", {LAW}),
        ("figures/curve.png", {CURVE, TOTAL}),
        ("build/notebooks/03-total.ipynb", {TOTAL}),
        ("notebooks/02-law.ipynb", {LAW}),
        ("notebooks/task_notebooks.py", set(NAMES)),
    ):
        path = project / name
        content = path.read_bytes()
        path.write_bytes(content + b"\n")
        assert stale(project) == reached, name
        path.unlink()
        if name != "notebooks/02-law.ipynb":  # without its notebook nothing can be said
            assert stale(project) >= reached - {TOTAL}, name
        path.write_bytes(content)
    text = (project / "notebooks/catalogue.toml").read_text()
    more = text.replace("[03-total]", '[02-law.laws]\nshows = "a picture"\n[03-total]')
    (project / "notebooks/catalogue.toml").write_text(more)
    assert stale(project) == {LAW}


def test_pytask_and_the_list_agree_on_what_is_stale(project):
    """What `list` calls stale is what a run runs, and nothing else."""
    change(project / "study/contact/damping.py")
    expected = stale(project)
    edit(project, LAW, "0.5)", "0.6)")
    expected |= {LAW}
    assert stale(project) == expected
    done = study(project, "run")
    assert set(ran(done)) <= expected  # one that reads what did not change need not run
    assert LAW in ran(done)
    assert stale(project) == set()
    edit(project, TOTAL, "import csv", "import (csv")
    assert stale(project) == {TOTAL}
    done = study(project, "run", "total")
    assert re.search(rf"failed: {TOTAL}, cell In.*SyntaxError", done.stderr)


def test_the_journal_of_a_killed_run_counts(project):
    lock = project / "pytask.lock"
    entries = lock.read_text().split("[[task]]")
    (law,) = [entry for entry in entries if f'[{LAW}]"\nstate' in entry]
    lock.write_text("[[task]]".join(entry for entry in entries if entry != law))
    assert stale(project) == {LAW}
    values = dict(re.findall(r'^(id|state) = "(.+)"', law, re.M))
    sections = law.split("[task.")
    for section in sections[1:]:
        values[section.partition("]")[0]] = dict(re.findall(r'^"?(.+?)"? = "(.+)"', section, re.M))
    journal = project / "pytask.lock.journal"
    journal.write_text(json.dumps(values | {"lock-version": "1"}) + "\n")
    assert stale(project) == set()
    journal.write_text("{broken")
    assert stale(project) == set(NAMES)


def test_results_that_differ_are_named_until_they_are_accepted(project):
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
    again = study(project, "verify")
    assert (again.returncode, again.stderr) == (1, edited.stderr)
    assert again.stdout == edited.stdout.splitlines()[-1] + "\n"
    accepted = study(project, "verify", "--keep")
    assert (accepted.returncode, accepted.stderr) == (0, "")
    assert accepted.stdout == "4 results: 4 identical, 0 agree, 0 differ\n"
    assert stale(project) == set()


def test_a_file_changed_by_hand_is_made_again(project):
    table = project / "figures/law.csv"
    content = table.read_bytes()
    table.write_text(table.read_text().replace(".", "0."))
    done = study(project, "run", "law")
    assert ran(done) == [LAW]
    assert done.returncode == 1
    assert re.match(r"differs  figures/law.csv, row \d, column force: kept .* now ", done.stderr)
    assert table.read_bytes() == content


def test_other_parameters_have_a_folder_of_their_own(project):
    kept = {path: path.read_bytes() for path in (project / "figures").iterdir()}
    executed = project / f"build/notebooks/{CURVE}.ipynb"
    kept[executed] = executed.read_bytes()
    words = ("run", "curve", "law", "-p", "scale=100")
    done = study(project, *words)
    assert (done.returncode, done.stderr) == (0, "")
    assert re.search(r"^made  build/with/scale=100/curve.png +force over depth$", done.stdout, re.M)
    assert f"\n      build/with/scale=100/{CURVE}.ipynb\n" in done.stdout
    assert done.stdout.splitlines()[-1] == "1 results: 1 identical, 0 agree, 0 differ"  # the law
    made = project / "build/with/scale=100"
    assert (made / "numbers.csv").read_text().splitlines()[1:] == ["a,100", "b,500"]
    assert all(path.read_bytes() == content for path, content in kept.items())
    assert states(project) == dict.fromkeys(NAMES, "fresh")
    again = study(project, *words)
    assert "in build/with/scale=100/ and figures/ is up to date" in again.stdout
    (made / "curve.png").unlink()
    assert ran(study(project, "run", "curve", "-p", "scale=100.0")) == []
    assert (made / "curve.png").is_file()
    assert "Nothing was stale" in study(project, "run").stdout


def test_what_reads_results_reads_those_with_the_papers_parameters(project):
    (project / "figures/numbers.csv").unlink()
    done = study(project, "run", "curve", "total", "-p", "scale=2", "-p", "digits=3")
    assert (done.returncode, done.stderr) == (0, "")
    assert ran(done) == [CURVE]  # as it was, for the total of its numbers
    with_settings = project / "build/with"
    assert (with_settings / "digits=3/total.csv").read_text() == "total\n6\n"
    assert (with_settings / "scale=2/numbers.csv").read_text().endswith("b,10\n")
    assert states(project) == dict.fromkeys(NAMES, "fresh")


def test_a_failing_cell_stops_its_results_alone(project):
    edit(project, CURVE, LABEL, "1 / 0")
    done = study(project, "run", "curve", "law", "--force")
    assert done.returncode == 1
    assert ran(done) == [LAW]
    failures = [line for line in done.stderr.splitlines() if line.startswith("failed:")]
    assert len(failures) == 1
    assert re.search(rf"failed: {CURVE}, cell In\[\d+\]: ZeroDivisionError", failures[0])
    assert "Traceback" not in done.stdout + done.stderr
    executed = nbformat.read(project / f"build/notebooks/{CURVE}.ipynb", as_version=4)
    kinds = [output.output_type for cell in executed.cells for output in cell.get("outputs", ())]
    assert "error" in kinds  # the copy shows where


def test_a_cell_that_shows_what_a_plot_returns_fails(project):
    saved = 'figures.save_table(table, "numbers")'
    edit(project, CURVE, saved, f"{saved}\naxes.plot([0, 1])")
    done = study(project, "run", "curve", "--force")
    assert done.returncode == 1
    assert re.search(rf"failed: {CURVE}, cell In\[\d+\] shows '\[<matplotlib", done.stderr)
    assert "end its last line with ;" in done.stderr


def test_too_few_files_are_named_as_the_cause(project):
    """Where the kernel cannot even open what shows the error."""
    few = "import resource\nresource.setrlimit(resource.RLIMIT_NOFILE, (8, 8))\nopen('other')"
    edit(project, CURVE, LABEL, few)
    done = study(project, "run", "curve")
    assert done.returncode == 1
    assert re.search(rf"failed: {CURVE}, cell In\[2\]: OSError: .*Too many open files", done.stderr)


@pytest.mark.parametrize(
    ("limit", "told"),
    [
        ("-v 1200000", "too little memory for a build: ulimit -v is 1200000, "),
        ("-n 64", "too few open files for a build: ulimit -n is 64, "),
    ],
)
def test_limits_that_are_too_low_are_named_before_a_notebook_runs(project, limit, told):
    """Else a kernel dies without a message, or OpenBLAS asks for memory for ever."""
    python = shlex.quote(sys.executable)
    command = f"ulimit {limit} && exec {python} -m study.cli run law --force"
    options = {"env": environment(project), "capture_output": True, "text": True, "timeout": 120}
    done = subprocess.run(["sh", "-c", command], cwd=project, **options)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.count("\n") == 1
    assert done.stderr.startswith(f"study: {told}")


def test_a_catalogue_that_is_no_toml_is_named(project):
    (project / "notebooks/catalogue.toml").write_text("[[[")
    done = study(project, "list")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("study: notebooks/catalogue.toml: ")
    assert done.stderr.count("\n") == 1


def test_a_build_beside_another_is_refused(project):
    fcntl = pytest.importorskip("fcntl")
    with (project / "build/running").open("a") as running:
        fcntl.flock(running, fcntl.LOCK_EX)
        done = study(project, "run", "law", "--force")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"study: another build is running in {project}: wait until it ends\n"
    assert study(project, "run", "law", "--force").returncode == 0


def test_a_notebook_that_saves_something_else_fails(project):
    edit(project, LAW, '"law.csv"', '"lw.csv"')
    done = study(project, "run", "law")
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == f"failed: {LAW} did not save law.csv"
    assert LAW in stale(project)
    edit(project, LAW, "(paths", 'open(paths.results() / "law.csv", "w").close(); (paths')
    done = study(project, "run", "law")
    assert done.returncode == 1
    assert f"failed: {LAW} saved lw.csv, which the catalogue does not name" in done.stderr
    assert not (project / "figures/lw.csv").exists()


def test_a_damaged_dataset_stops_the_run_with_a_remedy(project):
    curves = project / "data/force_curves.csv"
    curves.write_bytes(curves.read_bytes()[:-100])
    done = study(project, "run", "law", "--force")
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "data/force_curves.csv is damaged" in done.stderr
    assert "study data build" in done.stderr


def test_an_interrupted_run_keeps_what_was_finished(project):
    begun, release = project / "begun", project / "release"
    wait = f"open('{begun}', 'w'); import os, time\nwhile not os.path.exists('{release}'):\n"
    edit(project, CURVE, LABEL, f"{wait}    time.sleep(0.1)")
    edit(project, LAW, "0.5)", "0.6)")
    journal, finished = project / "pytask.lock.journal", f'task_notebook[{LAW}]","state"'
    command = [sys.executable, "-m", "study.cli", "run", "curve", "law"]
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
        while not (begun.exists() and journal.exists() and finished in journal.read_text()):
            assert process.poll() is None
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        release.touch()  # a notebook that has begun is not broken off
        _, err = process.communicate()
    finally:
        process.kill()
    assert process.returncode == 130
    assert err.splitlines()[-1] == "study: interrupted; what was finished is kept"
    assert stale(project) == {CURVE, TOTAL}
