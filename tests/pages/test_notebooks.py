"""The notebooks as files, their catalogue, and what their results depend on."""

import ast
import re
import subprocess
import sys
from collections import Counter

import nbformat
import pytest

from study import paths
from study.pages import build, catalogue

every_notebook = pytest.mark.parametrize("notebook", catalogue.CATALOGUE, ids=lambda n: n.name)


def code_cells(notebook):
    cells = nbformat.read(notebook.path, as_version=4).cells
    return [cell for cell in cells if cell.cell_type == "code"]


def test_catalogue_and_folder_agree():
    assert sorted(paths.NOTEBOOKS.glob("*.ipynb")) == [n.path for n in catalogue.CATALOGUE]
    results = [name for n in catalogue.CATALOGUE for name in n.results]
    assert len(results) == len(set(results))
    assert all({*n.reads} <= {*results} - {*n.results} for n in catalogue.CATALOGUE)


def test_every_figure_tells_one_sentence_without_numbers():
    for notebook in catalogue.CATALOGUE:
        for result in notebook.results.values():
            assert (paths.FIGURES / f"{result.name}.png").is_file() == bool(result.tells)
        for sentence in (result.tells for result in notebook.results.values() if result.tells):
            assert re.fullmatch(r"[A-Z][^.]{30,250}\.", sentence)
            assert not re.search(r"\d", re.sub(r"(Table|Fig\.) \d+", "", sentence))


def test_notebooks_are_stripped():
    files = [str(notebook.path) for notebook in catalogue.CATALOGUE]
    command = [sys.executable, "-m", "nbstripout", "--verify", *files]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@every_notebook
def test_cells_load_call_and_show(notebook):
    cells = code_cells(notebook)
    assert sum("parameters" in cell.metadata.get("tags", []) for cell in cells) == 1
    assert all(meaning for _, meaning in build.parameters(notebook).values())
    for cell in cells:
        assert cell.source.count("\n") < 15
        assert max(map(len, cell.source.splitlines())) <= 120
        assert not re.search(r"""["'](\.{1,2}/|/\w|data/|figures/)""", cell.source)


def assigned(statement):
    """Names that a statement assigns in its cell, but for the variables of loops."""
    if isinstance(statement, ast.FunctionDef):
        return {statement.name}
    names = {
        node.id
        for node in ast.walk(statement)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    loops = [n for n in ast.walk(statement) if isinstance(n, ast.For | ast.comprehension)]
    of_loops = [node for loop in loops for node in ast.walk(loop.target)]
    return names - {node.id for node in of_loops if isinstance(node, ast.Name)} - {"_"}


@every_notebook
def test_no_name_is_assigned_in_two_cells(notebook):
    """Else a new cell may change what a later one computes."""
    cells = [
        {name for statement in ast.parse(cell.source).body for name in assigned(statement)}
        for cell in code_cells(notebook)
    ]
    count = Counter(name for names in cells for name in names)
    assert not {name for name, times in count.items() if times > 1}


@every_notebook
def test_last_cell_names_the_results_and_the_rendered_page(notebook):
    first, *_, last = nbformat.read(notebook.path, as_version=4).cells
    assert re.match(r"# [^<]*\n", first.source)  # every page of the report shows it
    assert f"](../figures/README.md#{notebook.name})" in last.source
    assert f"](../build/report/notebooks/{notebook.name}.html)" in last.source
    assert "remove-cell" in last.metadata.tags  # the page itself does not show it


def test_results_and_notebooks_select_notebooks():
    selected = catalogue.select(["table2", "fig11", "02-coefficient-over-socket-radius"])
    assert [n.name[:2] for n in selected] == ["02", "04"]
    assert catalogue.select([]) == list(catalogue.CATALOGUE)


def test_parameters_are_literals_or_words():
    (notebook,) = catalogue.select(["fig10"])
    found = build.given(notebook, ["r2_star=100", "kinematics=small", "shallow=[0.01]"])
    assert found == {"r2_star": 100, "kinematics": "small", "shallow": [0.01]}


def test_a_file_is_in_the_folder_of_the_command(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (notebook,) = catalogue.select(["benchmark"])
    assert build.given(notebook, ["mine=my.csv"]) == {"mine": str(tmp_path / "my.csv")}


def test_no_result_depends_on_what_the_workflow_leaves_out():
    """Else a change of these files would leave outdated results."""
    surface = re.search(r"^SURFACE = (\(.+\))$", (paths.ROOT / "Snakefile").read_text(), re.M)
    left_out = ast.literal_eval(surface[1])
    names = {f"study.{name.removesuffix('.py').strip('/').replace('/', '.')}" for name in left_out}
    files = {path.relative_to(paths.STUDY).as_posix() for path in paths.STUDY.rglob("*.py")}
    library = [name[:-3].replace("/", ".") for name in files if not name.startswith(left_out)]
    imports = "\n".join(f"import study.{name}" for name in sorted(library))
    code = f"{imports}\nimport sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not names & set(done.stdout.split())
    for cell in (cell for notebook in catalogue.CATALOGUE for cell in code_cells(notebook)):
        assert not [name for name in names if f"from {name}" in cell.source]
        assert not re.search(r"from study import .*\b(cli|cases|export)\b", cell.source)
