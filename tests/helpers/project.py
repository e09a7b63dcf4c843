"""A small copy of the project: three notebooks, an article of one line, and ``study`` run in it."""

import os
import re
import shutil
import subprocess
import sys

import nbformat
from nbformat import v4
from numba.core.caching import UserProvidedCacheLocator

from study import compiled, paths

CURVE, LAW, TOTAL = NAMES = ("01-curve", "02-law", "21-statements-of-the-paper")
CATALOGUE = """
[01-curve.curve]
shows = "force over depth"
tells = "The force grows faster than the depth."
expect = "force at case = b"
[01-curve.numbers]
shows = "what is drawn"
[02-law.law]
shows = "Hertz's law at three depths"
[21-statements-of-the-paper]
reads = ["numbers"]
[21-statements-of-the-paper.total]
shows = "the sum of the numbers"
"""
CELLS = {
    CURVE: """scale = 1.0  # factor to the force
import pandas as pd
from study.pages import figures
table = pd.DataFrame({"case": ["a", "b"], "force": [1.0 * scale, 5.0 * scale]})
figure, axes = figures.new(width=2, height=2)
axes.plot(table.force)
figures.save(figure, "curve", table)
figures.save_table(table, "numbers")""",
    LAW: """r2_star = 200.0  # socket radius R2*
import pandas as pd
from study.contact import Hertz
from study.pages import figures
depths = [0.1, 0.2, 0.5]
figures.save_table(pd.DataFrame({"force": Hertz()(depths, r2_star)}), "law")""",
    TOTAL: """factor = 1.0  # to the total
import pandas as pd
from study import paths
from study.pages import figures
total = factor * pd.read_csv(paths.read_result("numbers.csv")).force.sum()
figures.save_table(pd.DataFrame({"total": [total]}), "total")""",
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
    """Copy the project, with three notebooks, short documents and no results instead of its own."""
    copy_project(root)
    documents = [*root.glob("*.md"), *root.rglob("data/README.md"), root / "examples/README.md"]
    for path in (*root.glob("figures/*"), *root.glob("notebooks/*.ipynb"), *documents):
        path.unlink()
    for path in documents:
        path.write_text("# A document\n")
    (root / "README.md").write_text(
        "# The study\n\nSee [the law](notebooks/02-law.ipynb), [the code](study/contact/laws.py), "
        "[all notebooks](notebooks/) and [the data](data/README.md).\n\n![Force](figures/curve.png)"
    )
    index = root / "study/pages/report/index.md"  # without figures of other notebooks
    parts = re.split(r"(?m)^(?=## )", index.read_text(encoding="utf-8"))
    own = re.sub(r"(?m)^- .*notebooks/(?!21-).*\n", "", parts[-1])
    index.write_text(parts[0] + own, encoding="utf-8")
    for name in ("paper", "supplement"):
        (root / f"paper/{name}.typ").write_text(
            '#csv(sys.inputs.results + "/total.csv").at(1).at(0)'
        )
    (root / "notebooks/catalogue.toml").write_text(CATALOGUE)
    for name, source in CELLS.items():
        settings, code = source.split("\n", 1)
        cells = [v4.new_markdown_cell(f"# Notebook {name}", id="title")]
        cells += [v4.new_code_cell(settings, metadata={"tags": ["parameters"]}, id="settings")]
        cells += [v4.new_code_cell(code, id="code")]
        metadata = {"kernelspec": {"name": "python3", "language": "python", "display_name": "P"}}
        notebook = v4.new_notebook(cells=cells, metadata=metadata)
        nbformat.write(notebook, root / f"notebooks/{name}.ipynb")
    return root


def edit(root, name, old, new):
    """Change the code of a notebook."""
    path = root / f"notebooks/{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    assert old in notebook.cells[2].source
    notebook.cells[2].source = notebook.cells[2].source.replace(old, new, 1)
    nbformat.write(notebook, path)


def environment(root, **more):
    return os.environ | {"PYTHONPATH": str(root), "PYTHONDONTWRITEBYTECODE": ""} | more


def study(root, *words, **more):
    """Run the command line of a copy, with more variables in its environment."""
    command = [sys.executable, "-m", "study.cli", *words]
    return subprocess.run(
        command, cwd=root, env=environment(root, **more), capture_output=True, text=True
    )
