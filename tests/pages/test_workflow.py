"""The workflow as a user meets it: outdated, failing, interrupted, killed, damaged, on a cluster.

The notebooks are small ones in a copy of the project, whose path has a space, an accent and quotes.
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from urllib.parse import unquote

import psutil
import pytest
from helpers.project import CURVE, LAW, NAMES, TOTAL, edit, environment, stub_project, study

from study import paths

pytestmark = pytest.mark.slow

RESULTS = ["README.md", "curve.csv", "curve.png", "law.csv", "numbers.csv", "total.csv"]
SLOW = "import time, pathlib; pathlib.Path(BEGUN).touch(); time.sleep(60)\n"
LAWS = "study/contact/laws.py"
LINK = re.compile(r'(?:href|src)="([^"#]+)(?:#[^"]*)?"')


@pytest.fixture(scope="module")
def finished_project(tmp_path_factory):
    """A project in which everything was made, and every result accepted."""
    root = stub_project(tmp_path_factory.mktemp("a 'copy', \"é\"") / "project")
    done = study(root, "run")
    assert done.returncode == 1
    assert done.stderr.count(".csv, which was not accepted before; accept it with: study run ") == 4
    assert "differs: figures/README.md; the texts of the catalogue have changed" in done.stderr
    assert done.stdout.splitlines()[-1] == "5 results: 0 identical, 0 agree, 5 differ"
    assert ran(done) == sorted(["article", "report", *NAMES])
    assert sorted(path.name for path in (root / "build/results").iterdir()) == RESULTS
    assert list((root / "figures").iterdir()) == []
    done = study(root, "run", *NAMES, "--accept")
    assert (done.returncode, done.stdout.count("accepted: figures/")) == (0, len(RESULTS) - 1)
    assert "\n## 02-law\n" in (root / "figures/README.md").read_text()
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
    """Jobs that a run has done."""
    return sorted(re.findall(r"^(\S+)  \(.+ s\)$", done.stdout, re.MULTILINE))


def last(done):
    """Exit status and last line of a run."""
    return done.returncode, (done.stderr or done.stdout).splitlines()[-1]


def append(path, text="\nCHANGED = True\n"):
    path.write_text(path.read_text() + text)


def test_the_pages_of_the_report_have_their_links_and_no_path_of_this_machine(project):
    report = project / "build/report"
    pages = {page.relative_to(report).as_posix(): page for page in report.rglob("*.html")}
    assert {
        "index.html",
        "figures/README.html",
        "README.html",
        "data/README.html",
        "search.html",
    } <= {
        *pages,
        *(f"notebooks/{name}.html" for name in NAMES),
    }
    assert {"api/study.contact.html", "api/study.joint.html"} <= pages.keys()
    assert not [name for name in pages if re.match(r"api/study\.(cli|pages)", name)]
    for name, page in pages.items():
        text = page.read_text()
        assert str(project) not in text, name
        for link in {*LINK.findall(text)}:
            if not re.match(r"https?:|mailto:|data:", link):
                assert (page.parent / unquote(link).partition("?")[0]).exists(), (name, link)
    gallery = pages["figures/README.html"].read_text()
    for shown in ("force over depth", "The force grows faster", "force = 5 at case = b"):
        assert shown in gallery
    assert "notebooks/02-law.html" in pages["README.html"].read_text()
    assert "_images/curve.png" in gallery
    assert 'id="study.contact.laws.Hertz"' in pages["api/study.contact.html"].read_text()


def test_damaged_files_are_made_again_and_never_accepted(project):
    build = project / "build"
    good = (build / "results/curve.png").read_bytes()
    (build / "results/curve.png").write_bytes(b"")
    (build / "results/law.csv").write_text("force\n")
    (build / "paper.pdf").unlink()
    (build / "supplement.pdf").write_bytes(b"")
    (build / "report/index.html").write_bytes(b"")
    os.utime(build / "results/total.csv", (2e9, 2e9))
    (build / "results/.part-0").mkdir()  # which a killed job leaves
    done = study(project, "run", "curve", "law", "--accept")
    assert (ran(done), "accepted" in done.stdout) == ([CURVE, LAW], False)
    assert (build / "results/curve.png").read_bytes() == good
    done = study(project, "run")
    assert ran(done) == sorted([TOTAL, "article", "report"])
    assert last(done) == (0, "5 results: 5 identical, 0 agree, 0 differ")
    assert (build / "paper.pdf").read_bytes().startswith(b"%PDF")
    assert (build / "supplement.pdf").read_bytes().startswith(b"%PDF")
    assert "</html>" in (build / "report/index.html").read_text()


def test_a_new_time_or_a_change_of_the_surface_is_no_change(project):
    os.utime(project / LAWS, (2e9, 2e9))  # in the future
    (project / "notebooks/02-law.ipynb").touch()
    for name in ("cli/run.py", "export/__init__.py", "cases/run.py", "pages/build.py"):
        append(project / "study" / name)
    append(project / "study/pages/report/conf.py")
    done = study(project, "run", *NAMES)
    assert "Nothing to be done" in done.stdout
    assert last(done) == (0, "4 results: 4 identical, 0 agree, 0 differ")


def test_what_has_changed_is_run_with_its_readers_and_nothing_else(project):
    edit(project, CURVE, "5.0", "5.001")
    done = study(project, "run", *NAMES)
    assert ran(done) == [CURVE, TOTAL]
    assert done.returncode == 1
    assert (
        "differs: build/results/numbers.csv, row 3, column force: accepted 5, now 5.001 (1 in all);"
        " accept it with: study run numbers --accept"
    ) in done.stderr
    assert done.stdout.splitlines()[-1] == "4 results: 1 identical, 0 agree, 3 differ"
    edit(project, CURVE, "5.001", "5.0")
    os.utime(project / LAWS, (2e9, 2e9))
    assert ran(study(project, "run", *NAMES)) == [CURVE, TOTAL]
    laws = (project / LAWS).read_text()
    append(project / LAWS)
    assert LAW in study(project, "run", "law", "--", "--dry-run").stdout
    (project / LAWS).write_text(laws)
    assert "Nothing to be done" in study(project, "run", "law").stdout  # edited, and edited back
    append(project / LAWS)
    shutil.rmtree(project / ".snakemake")
    assert ran(study(project, "run", "law")) == [LAW]
    assert ran(study(project, "run", *NAMES)) == [CURVE, TOTAL]


def test_a_new_result_of_a_notebook_is_made_beside_its_old_ones(project):
    catalogue = project / "notebooks/catalogue.toml"
    text = catalogue.read_text()
    catalogue.write_text(text.replace("[21-", '[02-law.more]\nshows = "more"\n[21-', 1))
    edit(project, LAW, '"law")', '"law"); figures.save_table(pd.DataFrame({"x": [1]}), "more")')
    assert ran(study(project, "run", "law", "more")) == [LAW]
    assert (project / "build/results/more.csv").is_file()
    catalogue.write_text(text)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("depths =", "1 / 0; depths =", "02-law, cell In[2]: ZeroDivisionError: division by zero;"),
        ('"law")', '"x")', "02-law must save what notebooks/catalogue.toml names: see law.csv, x"),
    ],
)
def test_a_notebook_that_fails_is_named_and_the_others_go_on(project, old, new, message):
    edit(project, LAW, old, new)
    append(project / LAWS, f"# {message}")
    done = study(project, "run", *NAMES)
    assert (done.returncode, ran(done)) == (1, [CURVE, TOTAL])
    reason, end = done.stderr.splitlines()
    assert reason.startswith(f"failed: {message}")
    assert end == "Error: some files were not made, for the reasons above or in .snakemake/log"


def start(root, begun):
    """Start a run of a notebook that waits, and return when it has begun."""
    edit(root, CURVE, "import pandas", f"{SLOW.replace('BEGUN', repr(str(begun)))}import pandas")
    process = subprocess.Popen(
        [sys.executable, "-m", "study.cli", "run", *NAMES],
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
    busy = last(study(project, "run", "law"))
    assert busy == (1, "Error: another run is working in this folder; wait until it has ended")
    children = psutil.Process(process.pid).children(recursive=True)
    assert len(children) >= 2  # job and kernel
    process.kill()
    process.communicate()
    psutil.wait_procs(children)  # they end with it
    edit(project, CURVE, "time.sleep(60)", "pass")
    done = study(project, "run", *NAMES)
    assert (done.returncode, done.stderr) == (0, "")
    assert CURVE in ran(done)
    assert list(project.rglob(".part-*")) == []


def test_an_interrupted_run_ends_at_once_and_keeps_what_is_finished(project, tmp_path):
    process = start(project, tmp_path / "begun")
    children = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate()
    assert process.returncode == 1
    assert "Traceback" not in err
    psutil.wait_procs(children)
    assert list(project.rglob(".part-*")) == []
    assert not (project / "build/notebooks/01-curve.ipynb").exists()


def test_a_picture_that_is_drawn_differently_is_named(project):
    picture = project / "figures/curve.png"
    picture.write_bytes(picture.read_bytes()[:60])
    done = study(project, "run", "curve")
    assert done.returncode == 0
    assert "drawn differently: build/results/curve.png (its table is identical)" in done.stdout
    done = study(project, "run", "curve", "--accept")
    assert done.stdout.count("accepted: ") == 1
    edit(project, LAW, "depths =", "1 / 0; depths =")
    edit(project, CURVE, "5.0", "7.0")
    before = (project / "figures/curve.csv").read_bytes()
    assert study(project, "run", "curve", "law", "--accept").returncode == 1
    assert (project / "figures/curve.csv").read_bytes() == before


def test_changed_data_are_a_change_for_every_notebook(project):
    path, sums = project / "data/datapackage.json", project / "data/SHA256SUMS"
    before, hashes = paths.sha256(path), sums.read_text()
    path.write_text(path.read_text().replace("Computing time", "The computing time", 1))
    assert paths.sha256(path) != before
    sums.write_text(hashes.replace(before, paths.sha256(path)))
    done = study(project, "run", *NAMES)
    sums.write_text(hashes)
    assert ran(done) == sorted(NAMES)


def test_damaged_data_stop_a_run_with_one_line(project):
    path = project / "data/datapackage.json"
    path.write_text(path.read_text().replace("title", "tytle", 1))
    for words in ((), ("-p", "r2_star=100")):
        done = study(project, "run", "law", *words)
        assert (done.returncode, ran(done)) == (1, [])
        assert "git checkout -- data/datapackage.json" in done.stderr.splitlines()[0]


def test_other_parameters_have_their_own_folder(project):
    before = {path: path.read_bytes() for path in (project / "figures").iterdir()}
    done = study(project, "run", "curve", "-p", "scale=2")
    assert (done.returncode, done.stderr) == (0, "")
    folder = project / "build/with/scale=2"
    assert (folder / "numbers.csv").read_text() == "case,force\na,2\nb,10\n"
    assert (folder / "01-curve.ipynb").is_file()
    for words, message in (
        (["curve", "-p", "skale=1"], "parameter of 01-curve must be one of scale, got 'skale'"),
        (["curve", "-p", "scale"], "-p must be KEY=VALUE, got 'scale'"),
        (["-p", "scale=2"], "-p and --accept must be given with a NAME"),
        (["curve", "-p", "scale=2", "--accept"], "-p cannot be used together with --accept"),
        (["curve", "-p", "scale=2", "--", "-n"], "-p cannot be used together with --accept or"),
    ):
        code, line = last(study(project, "run", *words))
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
    said = "This is no run of the workflow: results are written to build/scratch."
    assert json.dumps(json.loads(output.read_text())).count(said) == 1
    assert (project / "build/scratch/numbers.csv").read_text() == "case,force\na,3\nb,15\n"
    assert {path: path.read_bytes() for path in (project / "figures").iterdir()} == before


def test_jobs_can_be_submitted_by_a_command(tmp_path):
    root = stub_project(tmp_path / "project")
    submit = tmp_path / "submit"
    submit.write_text(f'#!/bin/sh\necho "$1" >> {tmp_path}/submitted\nsh "$1" >/dev/null 2>&1 &\n')
    submit.chmod(0o755)
    cluster = ["--executor", "cluster-generic", "--cluster-generic-submit-cmd", str(submit)]
    poll = ["--jobs", "2", "--seconds-between-status-checks", "1"]
    done = study(root, "run", "curve", "law", "--", *cluster, *poll)
    assert "2 results: 0 identical, 0 agree, 2 differ" in done.stdout, done.stderr
    assert len((tmp_path / "submitted").read_text().splitlines()) == 2


def test_a_new_case_is_solved_and_no_other(tmp_path):
    root = stub_project(tmp_path / "project")
    path, ratios = root / "study/dataset/design.py", "(0.0, 0.1, 0.2, 0.25, "
    path.write_text(path.read_text().replace(ratios, "(0.0, 0.1, 0.2, 0.22, 0.25, "))
    code, line = last(study(root, "data", "check"))
    assert code == 1
    assert "missing: poisson-0.22-linear-200; build them with: study data build" in line
    before = (root / "data/force_curves.csv").read_text().splitlines()
    assert last(study(root, "data", "build")) == (0, "Changed: data/force_curves.csv")
    after = (root / "data/force_curves.csv").read_text().splitlines()
    assert len(after) == len(before) + 40
    assert [line for line in after if line not in before] == [
        line for line in after if ",poisson-0.22-" in line
    ]
    assert last(study(root, "data", "build")) == (0, "No file has changed.")
