"""The notebooks as files, their catalogue, and the checks made before one runs."""

import ast
import re
import subprocess
import sys
from collections import Counter

import nbformat
import pytest

from study import paths
from study.pages import catalogue, execute

every_notebook = pytest.mark.parametrize("notebook", catalogue.CATALOGUE, ids=lambda n: n.name)


def code_cells(notebook):
    cells = nbformat.read(notebook.path, as_version=4).cells
    return [cell for cell in cells if cell.cell_type == "code"]


def test_catalogue_and_folder_agree():
    assert sorted(paths.NOTEBOOKS.glob("*.ipynb")) == [n.path for n in catalogue.CATALOGUE]
    results = [name for n in catalogue.CATALOGUE for name in n.results]
    assert len(results) == len(set(results))


def test_every_figure_tells_one_sentence_without_numbers():
    for notebook in catalogue.CATALOGUE:
        for result in notebook.results.values():
            assert (paths.FIGURES / f"{result.name}.png").is_file() == result.is_figure
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
def test_first_cell_asks_and_names_the_rendered_page(notebook):
    first = nbformat.read(notebook.path, as_version=4).cells[0]
    assert re.match(r"# [^<]*\n", first.source)  # every page of the report shows it
    page = f"`build/report/notebooks/{notebook.name}.html`"
    assert f"\nRendered with its results: {page}." in first.source


@every_notebook
def test_parameters_are_documented_literals(notebook):
    assert execute.parameters(notebook)
    (cell,) = [c for c in code_cells(notebook) if "parameters" in c.metadata.get("tags", [])]
    assert all("#" in line for line in cell.source.splitlines())
    for key, (value, allowed, _) in execute.parameters(notebook).items():
        numbers = isinstance(value, (list, tuple)) or not isinstance(value, bool)
        assert bool(allowed) == numbers or key == "parts"
        execute.check_range(key, value, allowed)


def test_results_and_notebooks_select_notebooks():
    selected = catalogue.select(["table2", "fig11", "02-coefficient-over-socket-radius"])
    assert [n.name[:2] for n in selected] == ["02", "04"]
    assert catalogue.select([]) == list(catalogue.CATALOGUE)
    with pytest.raises(ValueError, match="got 'fig1': did you mean fig01?"):
        catalogue.select(["fig1"])


def test_settings_reach_the_notebooks_that_have_them():
    chosen = execute.check_parameters(
        catalogue.select(["fig09", "fig10", "fig13"]),
        ["kinematics=small", "r2_star=100", "levels=[-5,5]", "largest_depth=0.5"],
    )
    assert chosen == {
        "02-coefficient-over-socket-radius": {"kinematics": "small"},
        "03-force-against-depth": {"kinematics": "small", "r2_star": 100.0, "largest_depth": 0.5},
        "05-range-of-the-hyperbolic-winkler-law": {
            "kinematics": "small",
            "r2_star": 100.0,
            "levels": [-5.0, 5.0],
        },
    }
    with pytest.raises(ValueError, match="^03-.* has none of the given parameters; leave it out"):
        execute.check_parameters(catalogue.select(["fig10", "fig13"]), ["levels=[-5,5]"])
    assert isinstance(chosen["03-force-against-depth"]["r2_star"], float)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        (
            "r2star=100",
            "-p must be KEY=VALUE with KEY one of kinematics, largest_depth, r2_star, shallow, got",
        ),
        ("r2_star=many", "parameter r2_star must be of type float, got 'many'"),
        ("r2_star", "-p must be KEY=VALUE, got 'r2_star'"),
        ("r2_star=5", "parameter r2_star must be one of 20, 40, 60, 80, 100, 120, 140, 16"),
        ("kinematics=finite", "parameter kinematics must be one of linear, small, got 'finite'"),
        ("r2_star=" + "-" * 100_000, "parameter r2_star must be of type float, got '------"),
    ],
)
def test_wrong_settings_stop_before_anything_runs(setting, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        execute.check_parameters(catalogue.select(["fig10"]), [setting])


def test_a_notebook_comes_after_those_it_reads_from():
    made = {name for nb in catalogue.CATALOGUE for name in nb.results}
    assert all(set(nb.reads) <= made - set(nb.results) for nb in catalogue.CATALOGUE)
