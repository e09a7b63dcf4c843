"""A copy of the project with three small notebooks, and ``study`` run in it as a user does."""

import os
import shutil
import subprocess
import sys

import nbformat
from nbformat import v4
from numba.core.caching import UserProvidedCacheLocator

from study import compiled, paths

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
CELLS = {
    CURVE: (
        "scale = 1.0  # factor to the force [0.5 to 200]",
        "import pandas as pd\n"
        "from study.pages import figures\n"
        'table = pd.DataFrame({"case": ["a", "b"], "force": [1.0 * scale, 5.0 * scale]})\n'
        "figure, axes = figures.new(width=2, height=2)\n"
        'axes.plot(table.force)\naxes.set_ylabel("force")\n'
        'figures.save(figure, "curve", table)\n'
        'figures.save_table(table, "numbers")',
    ),
    LAW: (
        "r2_star = 200.0  # socket radius R2* [20 to 10000]",
        "import pandas as pd\n"
        "from study.contact import Hertz\n"
        "from study.pages import figures\n"
        "depths = [0.1, 0.2, 0.5]\n"
        'figures.save_table(pd.DataFrame({"force": Hertz()(depths, r2_star)}), "law")',
    ),
    TOTAL: (
        "factor = 1.0  # to the total [1 to 9]",
        "import pandas as pd\n"
        "from study import paths\n"
        "from study.pages import figures\n"
        'total = factor * pd.read_csv(paths.read_result("numbers.csv")).force.sum()\n'
        'figures.save_table(pd.DataFrame({"total": [total]}), "total")',
    ),
}


def copy_project(root):
    """Copy what a run needs: no environment, no builds; but what is compiled."""
    ignored = shutil.ignore_patterns(".*", "build", "__pycache__", "tests")
    shutil.copytree(paths.ROOT, root, ignore=ignored)
    share_compiled(root, root / "build/compiled")
    return root


def share_compiled(root, cache):
    """Copy what is compiled to the cache of a package in another folder."""
    kept = cache / compiled.folder().name
    for name in ("contact", "mechanism", "measure"):  # numba names folders by those of the sources
        old, new = (
            UserProvidedCacheLocator.get_suitable_cache_subpath(folder / "study" / name / "x.py")
            for folder in (paths.ROOT, root)
        )
        if (compiled.folder() / old).is_dir():
            shutil.copytree(compiled.folder() / old, kept / new)


def stub_project(root):
    """Copy the project, with the three notebooks and no results instead of its own."""
    copy_project(root)
    for path in (*(root / "figures").iterdir(), *(root / "notebooks").glob("*.ipynb")):
        path.unlink()
    (root / "notebooks/catalogue.toml").write_text(CATALOGUE)
    claims = root / "data/published/claims.csv"  # the results that they name are not made here
    claims.write_text(claims.read_text().splitlines(keepends=True)[0])
    assert study(root, "data", "accept", str(claims)).returncode == 0
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


def environment(root, **more):
    return os.environ | {"PYTHONPATH": str(root), "PYTHONDONTWRITEBYTECODE": ""} | more


def study(root, *words, **more):
    """Run the command line of a copy, with more variables in its environment."""
    command = [sys.executable, "-m", "study.cli", *words]
    return subprocess.run(
        command, cwd=root, env=environment(root, **more), capture_output=True, text=True
    )
