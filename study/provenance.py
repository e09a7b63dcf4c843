"""What decides a result: the code that it reaches through imports, and the data that this reads.

One `digest` of these files says whether a result, a compiled loop or a part of a parameter study
is of this code. Comments and docstrings decide nothing. What a source says is read once, and kept
with the builds until the source changes.
"""

import ast
import hashlib
import io
import json
import os
import tokenize
from collections.abc import Iterable
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from study import paths

_DECIDE_NOTHING = ("paths.py", "provenance.py")  # where a file is, and what is made of it
_GRAPH = paths.CACHE / "imports.json"
_CHANGED: set[str] = set()  # entries of the graph that are not on disk yet
_NO_DATA = ("datapackage.json",)  # describes data, and changes with every build of them
_LAYOUT = {tokenize.NEWLINE, tokenize.NL, tokenize.COMMENT, tokenize.INDENT, tokenize.DEDENT}


class _Source(NamedTuple):
    """What a source file says: the dotted names that it imports, and data files that it names.

    ``code`` is the hash of its code alone. ``passes_on`` has the names that a package takes over
    from its modules.
    """

    sha256: str
    code: str
    imports: list[str]
    passes_on: dict[str, str]
    data: list[str]


def sources(*starts: Path) -> list[Path]:
    """Source files of the study that modules or notebooks reach through imports, and themselves.

    A name that a package takes over from one of its modules leads to that module, not to the
    whole package. Imports inside functions count. `study.paths` is left out: where a file is
    does not decide what is in it.
    """
    reached, left = set(), list(starts)
    while left:
        path = left.pop()
        if path not in reached:
            reached.add(path)
            left += _imported(path, *_stamp(path))
    _keep_graph()
    return sorted(p for p in reached if p.suffix == ".py" and p.name not in _DECIDE_NOTHING)


def inputs(start: Path) -> list[Path]:
    """Files that decide what a notebook or module makes: itself, the code it reaches, their data.

    A module reads the data files that it names: those in its folder, and those in ``data/``.
    """
    code = sources(start) if start.is_file() else []
    named = [(path.parent, text) for path in code for text in _source(path).data]
    places = [folder / text for beside, text in named for folder in (beside, paths.DATA)]
    return list(dict.fromkeys([start, *code, *(place for place in places if place.is_file())]))


def digest(files: Iterable[Path], *more: object, words: bool = False) -> str:
    """One hash of the names and contents of files, and of the ``repr`` of more; 32 digits.

    Comments and docstrings of Python's files count only with ``words``. A file that is missing
    counts as such.
    """
    content = sha256_of if words else _deciding
    contents = [(name(path), content(path)) for path in sorted(set(files))]
    return sha256(repr((contents, more)).encode())[:32]


def digests(files: Iterable[Path]) -> dict[str, str]:
    """First 16 digits of the SHA-256 of what decides in each file, by its path in the project."""
    return {name(path): _deciding(path)[:16] for path in files}


def name(path: Path) -> str:
    """A file's path in the project, for messages and descriptions; its whole path outside it."""
    is_ours = path.is_relative_to(paths.ROOT)
    return path.relative_to(paths.ROOT).as_posix() if is_ours else path.as_posix()


def sha256(content: bytes) -> str:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def _stamp(path):
    stat = path.stat()
    return stat.st_mtime_ns, stat.st_size


def sha256_of(path: Path) -> str:
    """SHA-256 of a file, computed again only after a change; "missing" if there is none."""
    return _content_sha256(path, *_stamp(path)) if path.is_file() else "missing"


def _deciding(path):
    """SHA-256 of what decides in a file: its content, or a module's code."""
    is_code = path.suffix == ".py" and path.is_file()
    return _source(path).code if is_code else sha256_of(path)


@lru_cache(maxsize=1024)
def _content_sha256(path, *_stamp):
    return sha256(path.read_bytes())


@lru_cache(maxsize=1024)
def _imported(path, *_stamp):
    """Files of the study that one file imports."""
    files = [_definition(name) for name in _source(path).imports]
    return [file for file in files if file is not None]


def _definition(dotted):
    """File that defines a dotted name of the study: a module, a package or a name in one."""
    path = paths.ROOT.joinpath(*dotted.split("."))
    package = path.parent / "__init__.py"
    for file in (path.with_suffix(".py"), path / "__init__.py", path.parent.with_suffix(".py")):
        if file.name in _listed(file.parent):  # Joint.py is not joint.py
            return file
    if package.name not in _listed(package.parent):
        return None
    passed_on = _source(package).passes_on.get(path.name)
    return _definition(passed_on) if passed_on else package


@cache
def _listed(folder):
    """Names in a folder, as they are written, on systems that ignore case as well."""
    return frozenset(os.listdir(folder)) if folder.is_dir() else frozenset()


def _source(path):
    """What a source file says, from the graph that is kept, or else parsed."""
    key, sha = name(path), sha256_of(path)
    graph = _graph()
    if key not in graph or graph[key].sha256 != sha:
        graph[key] = _read(path, sha)
        _CHANGED.add(key)
    return graph[key]


@cache
def _graph():
    """The graph of imports: source by its name in the project, from the disk at first."""
    try:
        kept = json.loads(_GRAPH.read_text(encoding="utf-8"))
        return {key: _Source(*source) for key, source in kept.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        return {}  # none is kept yet, or it is damaged


def _keep_graph():
    """Write the graph, if it changed, without the sources that are gone or not of the project."""
    ours = {key for key in _CHANGED if not Path(key).is_absolute()}
    _CHANGED.clear()
    if ours:
        kept = {key: source for key, source in _graph().items() if (paths.ROOT / key).is_file()}
        try:
            with paths.whole(_GRAPH) as temporary:
                temporary.write_text(json.dumps(kept), encoding="utf-8")
        except OSError:
            pass  # the folder is read-only: every process parses again


def _read(path, sha):
    """Parse a module, or the code cells of a notebook."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".ipynb":
        cells = [cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
        lines = [line for cell in cells for line in "".join(cell["source"]).splitlines()]
        text = "\n".join(line for line in lines if not line.startswith(("%", "!")))
    tree = ast.parse(text, str(path))
    nodes = list(ast.walk(tree))
    imports = [a.name for node in nodes if isinstance(node, ast.Import) for a in node.names]
    imports += [dotted for _, dotted in _taken_from(nodes)]
    constants = [node.value for node in nodes if isinstance(node, ast.Constant)]
    data = [v for v in constants if isinstance(v, str) and v.endswith((".csv", ".json"))]
    ours = [dotted for dotted in dict.fromkeys(imports) if dotted.startswith("study.")]
    named = sorted({v for v in data if " " not in v and Path(v).name not in _NO_DATA})
    code = sha256(_code(text).encode()) if path.suffix == ".py" else sha
    passes_on = dict(_taken_from(tree.body)) if path.name == "__init__.py" else {}
    return _Source(sha, code, ours, passes_on, named)


def _taken_from(nodes):
    """Names that statements "from ... import" define, and their dotted names."""
    froms = [node for node in nodes if isinstance(node, ast.ImportFrom)]
    return [(a.asname or a.name, f"{node.module}.{a.name}") for node in froms for a in node.names]


def _code(text):
    """Lines of a source that have code: no comment, and no string that is a statement."""
    lines, with_code, begins = text.split("\n"), set(), True
    for token, after in pairwise(tokenize.generate_tokens(io.StringIO(text).readline)):
        is_document = begins and token.type == tokenize.STRING and after.type == tokenize.NEWLINE
        begins = token.type in _LAYOUT
        row, column = token.start
        if token.type == tokenize.COMMENT:
            lines[row - 1] = lines[row - 1][:column].rstrip()
        elif not (begins or is_document):
            with_code.update(range(row - 1, token.end[0]))
    return "\n".join(lines[row] for row in sorted(with_code))
