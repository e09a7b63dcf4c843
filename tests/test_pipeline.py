"""The whole pipeline in a temporary copy of the project, run as a user runs it."""

import csv
import json
import re
import shutil
import socket
import subprocess
import sys
import time

import pytest
from copied import copy_project, environment, study

from study import paths
from study.dataset.tolerance import table_differs
from study.pages import catalogue

TWO = ("02-coefficient-over-socket-radius", "03-force-against-depth")
THREE = ("fig09", "fig10", "fig16")
MADE = ("fig07.png", "fig07.csv", "fig09.png", "fig09.csv", "table1.csv", "fig10.png", "fig10.csv")


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    root = copy_project(tmp_path_factory.mktemp("copy") / "project")
    for path in (root / "figures").iterdir():
        path.unlink()
    return root


def edit(root, name, old, new):
    path = root / "notebooks" / f"{name}.ipynb"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def assert_agrees(root, name):
    """The file made in a copy holds the kept numbers: other bytes only on another processor."""
    made, kept = root / "figures" / name, paths.FIGURES / name
    if made.suffix == ".csv":
        assert table_differs(kept, made) is None, name
    assert made.is_file()
    return made.read_bytes()


def ran(done):
    return sorted(set(re.findall(r"build/notebooks/(\S+)\.ipynb", done.stdout)))


def test_pipeline_from_nothing_to_fresh_and_stale(project):
    listed = study(project, "list")
    assert listed.returncode == 0, listed.stderr
    results = [name for notebook in catalogue.CATALOGUE for name in notebook.results]
    assert listed.stdout.count("stale") == len(results)

    done = study(project, "run", "fig09", "fig10")
    assert done.returncode == 0, done.stdout + done.stderr
    assert ran(done) == list(TWO)
    first = {}
    for name in MADE:
        first[name] = assert_agrees(project, name)
        assert f"figures/{name}" in done.stdout or name.endswith(".csv")

    again = study(project, "run", "fig09", "fig10")
    assert again.returncode == 0
    assert "Nothing was stale" in again.stdout

    edit(project, TWO[0], "(a) coefficient", "(a) the coefficient")
    table = project / "figures/table1.csv"
    row, number = number_in(table)
    table.write_text(table.read_text().replace(number, "0.5"))
    edited = study(project, "run", "fig09", "fig10")
    assert ran(edited) == [TWO[0]]
    assert edited.returncode == 1
    picture, told = sorted(edited.stderr.splitlines())
    assert re.fullmatch(r"differs  figures/fig09.png, \d+ pixels differ", picture)
    assert told == (
        f"differs  figures/table1.csv, row {row}, column ours: kept 0.5, now {number} (1 in all)"
    )
    assert table.read_bytes() == first["table1.csv"]
    assert edited.stdout.splitlines()[-1] == "5 results: 3 identical, 0 agree, 2 differ"
    assert (project / "figures/fig09.png").read_bytes() != first["fig09.png"]
    told = study(project, "verify", "fig09", "fig10")
    assert (told.returncode, told.stderr) == (1, edited.stderr)
    assert told.stdout == edited.stdout.splitlines()[-1] + "\n"
    accepted = study(project, "verify", "--keep")
    assert accepted.returncode == 0
    counts = f"{len(results)} results: 5 identical, 0 agree, 0 differ, {len(results) - 5} not made"
    assert accepted.stdout.startswith(counts)
    listed = study(project, "list")
    assert listed.stdout.count("fresh") == 5  # fig07, fig09, fig10, table1, trend

    one = study(project, "run", "fig10", "-p", "r2_star=100")
    assert one.returncode == 0, one.stderr
    assert one.stdout.splitlines()[-1].endswith("0 differ, 2 other parameters")
    assert (project / "figures/fig10.csv").read_bytes() != first["fig10.csv"]
    listed = study(project, "list", "trend")
    assert listed.stdout.startswith(f"{TWO[1]}: other parameters: r2_star=100.0\n")
    assert study(project, "list", "table1").stdout.startswith(f"{TWO[0]}: fresh\n")
    paper = study(project, "paper")
    assert (paper.returncode, paper.stdout) == (1, "")
    assert "fig10, trend (r2_star=100.0)" in paper.stderr
    assert paper.stderr.endswith(f"restore them with: study run {TWO[1]}\n")
    assert not (project / "build/paper.pdf").exists()
    back = study(project, "run", "fig10")
    assert ran(back) == [TWO[1]]
    assert (project / "figures/fig10.csv").read_bytes() == first["fig10.csv"]
    assert study(project, "list", "trend").stdout.startswith(f"{TWO[1]}: fresh\n")


def number_in(table):
    """Line of a table's RMSE, and its number in the column ours."""
    lines = table.read_text().splitlines()
    (row,) = [n for n, line in enumerate(lines, 1) if line.startswith("RMSE")]
    return row, lines[row - 1].split(",")[lines[0].split(",").index("ours")]


def fresh(project):
    listed = csv.DictReader(study(project, "list").stdout.splitlines())
    return {row["notebook"] for row in listed if row["state"] == "fresh"}


def test_a_changed_module_makes_stale_only_what_reaches_it(project):
    for module, reached in (
        ("dataset/fitting", {TWO[0]}),
        ("pages/figures", set(TWO)),
        ("measure/stability", set()),
    ):
        path = project / f"study/{module}.py"
        text = path.read_text()
        path.write_text(text + "# changed\n")
        assert fresh(project) == set(TWO) - reached
        path.write_text(text)


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
    study(project, "verify", "--keep")


SAVE = r"figures.save(figure, \"fig09\", cases)"
SAVE_AS = r"figures.save(figure, \"fig9\", cases)"


def test_a_notebook_that_saves_something_else_fails(project):
    edit(project, TWO[0], SAVE, "cases.shape")
    done = study(project, "run", "fig09")
    assert done.returncode == 1
    failure = done.stderr.splitlines()[-1]
    assert failure == f"failed: {TWO[0]} did not save fig09.csv, fig09.png"
    assert TWO[0] not in fresh(project)
    edit(project, TWO[0], "cases.shape", f"{SAVE}; {SAVE_AS}")
    done = study(project, "run", "fig09")
    assert done.returncode == 1
    assert "saved fig9.csv, fig9.png, which the catalogue does not name" in done.stderr
    assert not (project / "figures/fig9.csv").exists()
    edit(project, TWO[0], f"{SAVE}; {SAVE_AS}", SAVE)


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


def test_mechanism_notebooks_run_with_other_parameters(project):
    done = study(project, "run", "fig16", "fig17", "-p", "duration=0.02", "-p", "outputs=200")
    assert done.returncode == 0, done.stdout + done.stderr
    assert ran(done) == ["07-crank-slider-and-its-parameters", "08-motion-of-the-slider"]
    for name in ("table3.csv", "table4.csv", "scene.csv", "fig16.csv", "fig16.png"):
        assert_agrees(project, name)
    lines = (project / "figures/fig17.csv").read_text().splitlines()
    assert len(lines) == 202
    assert lines[-1].startswith("20,")


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def test_the_same_tasks_run_on_a_dask_cluster(project, tmp_path):
    """Two tasks at once in one worker, and one beside them in another."""
    pytest.importorskip("distributed")
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
        done = study(project, "run", *THREE, "--force", "--dask", address)
        assert done.returncode == 0, done.stdout + done.stderr
        assert len(ran(done)) == 3
        for name in MADE:
            assert_agrees(project, name)
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
