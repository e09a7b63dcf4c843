"""The whole pipeline in a temporary copy of the project, run as a user runs it."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time

import pytest

from study import notebooks, paths

TWO = ("02-coefficient-over-socket-radius", "03-force-against-depth")
MADE = ("fig07.png", "fig07.csv", "fig09.png", "fig09.csv", "table1.csv", "fig10.png", "fig10.csv")


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    root = tmp_path_factory.mktemp("copy") / "project"
    ignored = shutil.ignore_patterns(".*", "build", "__pycache__", "pytask.lock", "tests")
    shutil.copytree(paths.ROOT, root, ignore=ignored)
    for path in (root / "figures").iterdir():
        path.unlink()
    return root


def environment(root):
    return os.environ | {"PYTHONPATH": str(root)}


def study(root, *words):
    command = [sys.executable, "-m", "study.cli", *words]
    return subprocess.run(
        command, cwd=root.parent, env=environment(root), capture_output=True, text=True
    )


def edit(root, name, old, new):
    path = root / "notebooks" / f"{name}.ipynb"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def ran(done):
    return sorted(set(re.findall(r"build/notebooks/(\S+)\.ipynb", done.stdout)))


def test_pipeline_from_nothing_to_fresh_and_stale(project):
    listed = study(project, "list")
    assert listed.returncode == 0, listed.stderr
    results = [name for notebook in notebooks.CATALOGUE for name in notebook.results]
    assert listed.stdout.count("stale") == len(results)

    done = study(project, "run", "fig09", "fig10")
    assert done.returncode == 0, done.stdout + done.stderr
    assert ran(done) == list(TWO)
    for name in MADE:  # the same bytes as the ones kept in the project
        made, kept = project / "figures" / name, paths.FIGURES / name
        assert made.read_bytes() == kept.read_bytes(), name
        assert f"figures/{name}" in done.stdout or name.endswith(".csv")

    again = study(project, "run", "fig09", "fig10")
    assert again.returncode == 0
    assert "Nothing was stale" in again.stdout

    edit(project, TWO[0], "(a) coefficient", "(a) the coefficient")
    edited = study(project, "run", "fig09", "fig10")
    assert edited.returncode == 0
    assert ran(edited) == [TWO[0]]
    listed = study(project, "list")
    assert listed.stdout.count("fresh") == 5  # fig07, fig09, fig10, table1, trend

    one = study(project, "run", "fig10", "-p", "r2_star=100")
    assert one.returncode == 0, one.stderr
    assert (project / "figures/fig10.csv").read_bytes() != (
        paths.FIGURES / "fig10.csv"
    ).read_bytes()
    back = study(project, "run", "fig10")
    assert ran(back) == [TWO[1]]
    assert (project / "figures/fig10.csv").read_bytes() == (
        paths.FIGURES / "fig10.csv"
    ).read_bytes()


def test_a_failing_cell_stops_its_figure_alone(project):
    edit(project, TWO[0], "(a) the coefficient", "(a) coefficient")
    edit(project, TWO[1], "behind = ", 'behind = 1 / 0\\n",\n    "behind = ')
    done = study(project, "run", "fig09", "fig10", "--force")
    assert done.returncode == 1
    assert ran(done) == [TWO[0]]
    failures = [line for line in done.stderr.splitlines() if line.startswith("failed:")]
    assert len(failures) == 1
    assert re.search(rf"failed: {TWO[1]}, cell In\[\d+\]: ZeroDivisionError", failures[0])
    assert "Traceback" not in done.stdout + done.stderr
    edit(project, TWO[1], 'behind = 1 / 0\\n",\n    "behind = ', "behind = ")


def test_a_damaged_dataset_stops_the_run_with_a_remedy(project):
    curves = project / "data/force_curves.csv"
    whole = curves.read_bytes()
    curves.write_bytes(whole[:-100])
    done = study(project, "run", "fig09")
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "data/force_curves.csv is damaged" in done.stderr
    assert "study data build" in done.stderr
    curves.write_bytes(whole)


def heed_interrupts():
    """Undo what a shell does to a background job, whose children ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def noted_down(root):
    """Whether pytask has noted a finished set-up, in its lock file or the journal beside it."""
    return any("task_curves[" in path.read_text() for path in root.glob("pytask.lock*"))


LESS = """
DESIGN = tuple(
    s
    for s in DESIGN
    if s.group == "ratio"
    or (s.group == "paper" and "finite" not in s.kinematics)
    or (s.group == "fit" and s.poisson == 0.3)
)
"""
"""A part of the dataset's design, for the whole takes minutes."""


@pytest.fixture
def less_data(project):
    """The project with less data to build; put right again afterwards."""
    module = project / "study/design.py"
    module.write_text(module.read_text() + LESS)
    module = project / "study/mechanism/links.py"
    module.write_text(module.read_text().replace("COUNT = 160", "COUNT = 3"))
    yield project
    changed = "design.py", "mechanism/links.py", "contact/coefficients.json"
    for name in (f"study/{name}" for name in changed):
        shutil.copy(paths.ROOT / name, project / name)
    shutil.copytree(paths.DATA, project / "data", dirs_exist_ok=True)


def test_an_interrupted_build_of_the_data_resumes_to_the_same_bytes(less_data):
    project = less_data
    (project / "data/force_curves.csv").unlink()
    command = [sys.executable, "-m", "study.cli", "data", "build"]
    process = subprocess.Popen(
        command,
        cwd=project,
        env=environment(project),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heed_interrupts,
    )
    deadline = time.monotonic() + 60
    while not noted_down(project):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.1)
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert err.splitlines()[-1] == "study: interrupted; what was finished is kept"
    assert not (project / "data/force_curves.csv").exists()

    resumed = study(project, "data", "build")
    assert resumed.returncode == 0, resumed.stderr
    assert "Skipped because unchanged" in resumed.stdout
    built = (project / "data/force_curves.csv").read_text().splitlines()
    kept = set((paths.DATA / "force_curves.csv").read_text().splitlines())
    assert len(built) > 2000
    assert set(built) <= kept
    assert study(project, "data", "show").returncode == 0


def test_mechanism_notebooks_run_with_other_parameters(project):
    done = study(project, "run", "fig16", "fig17", "-p", "duration=0.02", "-p", "outputs=200")
    assert done.returncode == 0, done.stdout + done.stderr
    assert ran(done) == ["07-crank-slider-and-its-parameters", "08-motion-of-the-slider"]
    for name in ("table3.csv", "table4.csv", "scene.csv", "fig16.csv", "fig16.png"):
        made, kept = project / "figures" / name, paths.FIGURES / name
        assert made.read_bytes() == kept.read_bytes(), name
    lines = (project / "figures/fig17.csv").read_text().splitlines()
    assert len(lines) == 202
    assert lines[-1].startswith("20,")


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def test_the_same_tasks_run_on_a_dask_cluster(project, tmp_path):
    pytest.importorskip("distributed")
    address = f"tcp://127.0.0.1:{free_port()}"
    dask = [sys.executable, "-m", "dask"]
    local = ["--host", "127.0.0.1", "--no-dashboard"]
    commands = [
        [*dask, "scheduler", "--port", address.split(":")[-1], *local],
        *(
            [*dask, "worker", address, "--nthreads", "1", "--name", name, *local]
            for name in ("one", "two")
        ),
    ]
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
        done = study(project, "run", "fig09", "fig10", "--force", "--dask", address)
        assert done.returncode == 0, done.stdout + done.stderr
        assert ran(done) == list(TWO)
        for name in MADE:
            made, kept = project / "figures" / name, paths.FIGURES / name
            assert made.read_bytes() == kept.read_bytes(), name
    finally:
        for process in reversed(started):
            process.terminate()
        for process in started:
            process.wait(timeout=30)


def wait_for_workers(address, count):
    from distributed import Client

    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        try:
            with Client(address, timeout=2) as client:
                client.wait_for_workers(count, timeout=30)
                return
        except OSError:
            time.sleep(0.2)
    raise TimeoutError(f"no {count} workers at {address}")


def test_executed_notebook_is_readable(project):
    executed = json.loads((project / f"build/notebooks/{TWO[0]}.ipynb").read_text())
    kinds = [
        output["output_type"] for cell in executed["cells"] for output in cell.get("outputs", [])
    ]
    assert kinds
    assert "error" not in kinds


def test_a_missing_number_stops_the_paper(project):
    shutil.copytree(paths.FIGURES, project / "figures", dirs_exist_ok=True)
    done = study(project, "paper")
    assert done.returncode == 0, done.stderr
    pdf = project / "build/paper.pdf"
    whole = pdf.read_bytes()
    table = project / "figures/table2.csv"
    lines = table.read_text().splitlines(keepends=True)
    table.write_text("".join(line for line in lines if not line.startswith("hertz,RMSE")))
    done = study(project, "paper")
    assert done.returncode == 1
    assert re.fullmatch(r"study: paper/.*figures/table2.csv has no row with .*\n", done.stderr)
    assert pdf.read_bytes() == whole
    table.write_text("".join(lines))
