"""What decides a result: the code that it reaches through imports, and the data that this reads."""

import ast
import hashlib
import json
import os
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from study import paths

READS = {
    "contact/laws.py": ("study/contact/coefficients.json",),
    "contact/hertz_correction.py": ("study/contact/hertz_correction.csv",),
    "contact/materials.py": ("study/contact/materials.csv",),
    "dataset/store.py": (
        *("data/force_curves.csv", "data/links.csv", "data/published/tables.csv"),
        *("data/published/joint.csv", "data/published/others.csv", "data/published/speed.csv"),
    ),
    "claims/verdicts.py": ("data/published/claims.csv",),
}
"""Data files of modules of `study`, by the module that reads them."""


def sources(*starts: Path) -> list[Path]:
    """Source files of the study that modules or notebooks reach through imports, and themselves.

    A name that a package takes over from one of its modules leads to that module, not to the
    whole package. Imports inside functions count. `study.paths` is left out: where a file is
    does not decide what is in it.
    """
    found, todo = set(), list(starts)
    while todo:
        path = todo.pop()
        if path not in found:
            found.add(path)
            todo += _imported(path, path.stat().st_mtime_ns)
    return sorted(path for path in found if path.suffix == ".py" and path.name != "paths.py")


def inputs(notebook: Path) -> list[Path]:
    """Files that decide what a notebook makes: itself, the code it reaches, and what this reads."""
    code = sources(notebook) if notebook.is_file() else []
    library = paths.ROOT / "study"
    names = [n for path in code for n in READS.get(path.relative_to(library).as_posix(), ())]
    return [notebook, *code, *(paths.ROOT / name for name in names)]


def digests(files: Iterable[Path]) -> dict[str, str]:
    """First 16 digits of the SHA-256 of each file, by its path in the project."""
    return {name(path): sha256(path.read_bytes())[:16] for path in files}


def name(path: Path) -> str:
    """A file's path in the project, for messages and descriptions."""
    return path.relative_to(paths.ROOT).as_posix()


def sha256(content: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


@lru_cache(maxsize=256)
def _imported(path, _modified):
    """Files of the study that one file imports."""
    names = []
    for node in ast.walk(_parse(path)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    found = [_definition(name) for name in names if name.startswith("study.")]
    return [path for path in found if path.is_file()]


def _parse(path):
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".ipynb":
        cells = [cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
        lines = [line for cell in cells for line in "".join(cell["source"]).splitlines()]
        text = "\n".join(line for line in lines if not line.startswith(("%", "!")))
    return ast.parse(text, str(path))


def _definition(name):
    """File that defines a dotted name of the study: a module, a package or a name in one."""
    path = paths.ROOT.joinpath(*name.split("."))
    package = path.parent / "__init__.py"
    for file in (path.with_suffix(".py"), path / "__init__.py", path.parent.with_suffix(".py")):
        if file.is_file() and file.name in os.listdir(file.parent):  # Joint.py is not joint.py
            return file
    if not package.is_file():
        return package
    for node in _parse(package).body:  # its own name, or one that it passes on
        if isinstance(node, ast.ImportFrom):
            for alias in node.names:
                if path.name == (alias.asname or alias.name):
                    return _definition(f"{node.module}.{alias.name}")
    return package
