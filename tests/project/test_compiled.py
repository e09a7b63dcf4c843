"""The cache of compiled loops: named by the code, read again, and compiled anew if damaged."""

import subprocess
import sys
import time

import psutil
import pytest

from study import compiled, paths

LOOP = """
import sys
from pathlib import Path
from study import paths
paths.CACHE = Path(sys.argv[1])
from study.mechanism import angles
print(angles.norm(3.0, 4.0))
"""


def run(cache):
    """Call a loop in a new process with a cache of its own; its standard error, and the files."""
    done = subprocess.run([sys.executable, "-c", LOOP, cache], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "5.0\n"), done.stderr
    return done.stderr, {path: path.stat().st_mtime_ns for path in cache.rglob("*.nb*")}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("suffix", "damage"), [(".nbi", lambda b: b"junk"), (".nbc", lambda b: b[: len(b) // 2])]
)
def test_a_damaged_cache_is_compiled_again(tmp_path, suffix, damage):
    silent, first = run(tmp_path)
    assert silent == ""
    assert run(tmp_path) == ("", first)  # it was read
    path = next(path for path in first if path.suffix == suffix)
    path.write_bytes(damage(path.read_bytes()))
    said, again = run(tmp_path)
    assert said.count("\n") == 1
    assert said.endswith(f"{path.name} is damaged; the loops are compiled again\n")
    assert again.keys() == first.keys()
    assert again[path] > first[path]
    assert run(tmp_path) == ("", again)


def test_the_folder_is_named_by_the_code_of_laws_and_mechanism(tmp_path, monkeypatch):
    names = set()
    monkeypatch.setattr(paths, "STUDY", tmp_path)
    for package, text in (("contact", "a"), ("contact", "b"), ("mechanism", "c"), ("joint", "d")):
        (tmp_path / package).mkdir(exist_ok=True)
        (tmp_path / package / "laws.py").write_text(text)
        compiled.folder.cache_clear()
        names.add(compiled.folder().name)
    compiled.folder.cache_clear()
    assert len(names) == 3  # a joint is not compiled


@pytest.mark.slow
def test_compiling_leaves_no_process_when_it_is_terminated(tmp_path):
    code = LOOP.replace(
        "from study.mechanism import angles\nprint(angles.norm(3.0, 4.0))",
        ("from study.mechanism.__main__ import main; print('begun', flush=True); main()"),
    )
    process = subprocess.Popen([sys.executable, "-c", code, tmp_path], stdout=subprocess.PIPE)
    process.stdout.readline()
    time.sleep(1)
    children = psutil.Process(process.pid).children(recursive=True)
    process.terminate()
    process.communicate()
    _, alive = psutil.wait_procs(children, timeout=1)
    assert alive == []


@pytest.mark.slow
def test_simulations_need_no_more_than_set_up_compiles():
    from study.mechanism import __main__ as set_up
    from study.mechanism import simulate

    set_up.main()
    files = set(compiled.folder().rglob("*.nbc"))
    for model in set_up.KINDS:
        simulate(law="stiffened_hertz", model=model, duration=2e-3, outputs=10)
    assert set(compiled.folder().rglob("*.nbc")) == files
