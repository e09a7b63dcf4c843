"""A copy of the project with three small notebooks of two cells, which run in seconds."""

import nbformat
from nbformat import v4

from helpers.copied import copy_project

CURVE, LAW, TOTAL = NAMES = ("01-curve", "02-law", "03-total")
CATALOGUE = """
[01-curve.curve]
shows = "force over depth"
tells = "The force grows faster than the depth."
[01-curve.numbers]
shows = "what is drawn"
[02-law.law]
shows = "Hertz's law at three depths"
[03-total]
reads = ["numbers"]
[03-total.total]
shows = "the sum of the numbers"
"""
SAVE = 'figures.save(figure, "curve", table)'
LABEL = 'axes.set_ylabel("force")'
CELLS = {
    CURVE: (
        "scale = 1.0  # factor to the force [0.5 to 200]",
        "import pandas as pd\n"
        "from study.pages import figures\n"
        'table = pd.DataFrame({"case": ["a", "b"], "force": [1.0 * scale, 5.0 * scale]})\n'
        "figure, axes = figures.new(width=2, height=2)\n"
        f"axes.plot(table.force)\n{LABEL}\n{SAVE}\n"
        'figures.save_table(table, "numbers")',
    ),
    LAW: (
        "r2_star = 200.0  # socket radius R2* [20 to 10000]",
        "from study import paths\n"
        "from study.contact import hertz\n"
        'rows = [f"{hertz(depth, r2_star):.9g}" for depth in (0.1, 0.2, 0.5)]\n'
        '(paths.results() / "law.csv").write_text("\\n".join(["force", *rows, ""]))',
    ),
    TOTAL: (
        "digits = 6  # of the total [1 to 9]",
        "import csv\n"
        "from study import paths\n"
        'rows = csv.DictReader((paths.FIGURES / "numbers.csv").open())\n'
        'total = sum(float(row["force"]) for row in rows)\n'
        '(paths.results() / "total.csv").write_text(f"total\\n{total:.{digits}g}\\n")',
    ),
}


def stub_project(root):
    """Copy the project to a folder, with the three notebooks and no results instead of its own."""
    copy_project(root)
    for path in (*(root / "figures").iterdir(), *(root / "notebooks").glob("*.ipynb")):
        path.unlink()
    (root / "notebooks/catalogue.toml").write_text(CATALOGUE)
    claims = root / "data/published/claims.csv"  # the results that they name are not made here
    claims.write_text(claims.read_text().splitlines(keepends=True)[0])
    for name, (settings, code) in CELLS.items():
        cells = [v4.new_code_cell(settings, metadata={"tags": ["parameters"]}, id="settings")]
        cells.append(v4.new_code_cell(code, id="code"))
        metadata = {"kernelspec": {"name": "python3", "language": "python", "display_name": "P"}}
        notebook = v4.new_notebook(cells=cells, metadata=metadata)
        nbformat.write(notebook, root / f"notebooks/{name}.ipynb")
    return root


def edit(root, name, old, new):
    """Change the code of a notebook."""
    path = root / f"notebooks/{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    assert old in notebook.cells[1].source
    notebook.cells[1].source = notebook.cells[1].source.replace(old, new, 1)
    nbformat.write(notebook, path)
