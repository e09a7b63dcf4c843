"""What decides a result: the code that it reaches through imports, and the data that this reads."""

import ast
import hashlib
import json
from functools import lru_cache

from study import paths

READS = {
    "contact/laws.py": ("study/contact/coefficients.json",),
    "dataset/store.py": (
        *("data/force_curves.csv", "data/links.csv", "data/published/tables.csv"),
        *("data/published/joint.csv", "data/published/peers.csv"),
    ),
    "claims/verdicts.py": ("data/published/claims.csv",),
}
"""Data files of modules of `study`, by the module that reads them."""


def sources(*starts):
    """Source files of the study that some files reach through imports, themselves included.

    A name that a package takes over from one of its modules leads to that module, not to the
    whole package. Imports inside functions count. `study.paths` is left out: where a file is
    does not decide what is in it.

    Parameters
    ----------
    *starts : pathlib.Path
        Modules or notebooks.

    Returns
    -------
    list of pathlib.Path
        Python files, sorted.
    """
    found, todo = set(), list(starts)
    while todo:
        path = todo.pop()
        if path not in found:
            found.add(path)
            todo += _imported(path, path.stat().st_mtime_ns)
    return sorted(path for path in found if path.suffix == ".py" and path.name != "paths.py")


def inputs(notebook):
    """Files that decide what a notebook makes: itself, code and data.

    Parameters
    ----------
    notebook : pathlib.Path

    Returns
    -------
    list of pathlib.Path
    """
    code = sources(notebook) if notebook.is_file() else []
    return [notebook, *code, *data(code)]


def data(code):
    """Data files that some modules read."""
    library = paths.ROOT / "study"
    names = [n for path in code for n in READS.get(path.relative_to(library).as_posix(), ())]
    return [paths.ROOT / name for name in names]


def digests(files):
    """First 16 digits of the SHA-256 of each file, by its path in the project.

    Parameters
    ----------
    files : iterable of pathlib.Path

    Returns
    -------
    dict
    """
    return {
        path.relative_to(paths.ROOT).as_posix(): digest(path.read_bytes())[:16] for path in files
    }


def digest(content):
    """SHA-256 of some bytes, in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


@lru_cache(maxsize=256)
def _imported(path, _modified):
    """Files of the study that one file imports."""
    return [
        module
        for node in ast.walk(_parse(path))
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in _names(node)
        for module in _resolve(name)
    ]


def _parse(path):
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".ipynb":
        cells = [cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
        lines = [line for cell in cells for line in "".join(cell["source"]).splitlines()]
        text = "\n".join(line for line in lines if not line.startswith(("%", "!")))
    return ast.parse(text, str(path))


def _names(node):
    """Dotted names that an import statement asks for."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    return [f"{node.module}.{alias.name}" for alias in node.names]


def _resolve(name):
    """Files that define a dotted name of the study; none for names of other packages."""
    parts = name.split(".")
    if parts[0] != "study" or len(parts) == 1:
        return []
    path = paths.ROOT.joinpath(*parts)
    if path.with_suffix(".py").is_file():
        return [path.with_suffix(".py")]
    package = path / "__init__.py"
    if package.is_file():
        return [package]
    above = path.parent
    if above.with_suffix(".py").is_file():  # a name of a module
        return [above.with_suffix(".py")]
    package = above / "__init__.py"  # a name of a package: its own, or one that it passes on
    if not package.is_file():
        return []
    for node in _parse(package).body:
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                if parts[-1] == (alias.asname or alias.name):
                    return _resolve(f"{node.module}.{alias.name}")
    return [package]
