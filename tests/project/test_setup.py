"""``make setup``: the locked packages by uv or pip, by programs that only note their calls."""

import os
import re
import shutil
import subprocess
import sys

import pytest

from study import paths
from study.compiled import CACHE
from study.measure import warm

pytestmark = pytest.mark.slow

FIRST = "--no-deps --require-hashes --requirement .venv/first.lock"
LOCKED = "--no-deps --require-hashes --requirement requirements.lock"
ITSELF = "--no-deps --no-index --no-build-isolation --editable ."
UV = "uv pip install --quiet --python .venv/bin/python"
PIP = "python -m pip install --quiet --disable-pip-version-check --no-compile"
STEPS = FIRST, LOCKED, ITSELF
NOTED = '#!/bin/sh\necho "$(basename "$0") $*" >> called\n'
BEFORE_WARM = {"numpy", "scipy", "llvmlite", "numba", "platformdirs", "threadpoolctl"}
MADE = 'case "$*" in *"-m venv"*) mkdir -p .venv/bin; cp "$0" .venv/bin/python;; esac\n'


@pytest.fixture
def first(tmp_path):
    """Folder with what a set-up reads."""
    folder = tmp_path / "first"
    folder.mkdir()
    for name in ("Makefile", "requirements.lock", "pyproject.toml"):
        shutil.copy(paths.ROOT / name, folder)
    return folder


def set_up(folder, **programs):
    """Run ``make setup`` with Python, and others, that note their calls and do what is told."""
    for name, does in ({"python": MADE} | programs).items():
        (folder.parent / name).write_text(NOTED + does)
        (folder.parent / name).chmod(0o755)
    path = os.pathsep.join([str(folder.parent), os.environ["PATH"]])
    command = ["make", "setup", f"PYTHON={folder.parent / 'python'}"]
    environment = os.environ | {"PATH": path}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize(
    ("status", "installed"),
    [
        (0, [f"{UV} {what}" for what in STEPS]),
        (1, [f"{program} {what}" for what in STEPS for program in (UV, PIP)]),
    ],
    ids=["uv", "pip"],
)
def test_the_lock_is_installed_by_uv_or_else_by_pip(first, status, installed):
    done = set_up(first, uv=f"exit {status}\n")
    assert done.returncode == 0, done.stderr
    called = (first / "called").read_text().splitlines()
    assert [line for line in called if " install " in line] == installed
    assert called.count("python -m study.measure.warm") == 1
    lock = (first / ".venv/first.lock").read_text()
    assert {line.split("==")[0] for line in lock.splitlines() if line[0] != " "} == BEFORE_WARM
    assert lock.count("--hash=sha256:") > len(BEFORE_WARM)
    assert (first / ".venv/.ready").is_file()


def test_a_copy_is_set_up_anew_and_so_is_what_moved(first, tmp_path):
    copy, moved = tmp_path / "a copy, é", tmp_path / "moved"

    def is_made(folder):
        """Whether ``make setup`` made an environment."""
        done = set_up(folder, uv="")
        assert done.returncode == 0, done.stderr
        called = folder / "called"
        made = called.is_file() and "-m venv" in called.read_text()
        called.unlink(missing_ok=True)
        return made

    assert [is_made(first), is_made(first)] == [True, False]
    shutil.copytree(first, copy, copy_function=shutil.copy2)
    assert [is_made(copy), is_made(copy), is_made(first)] == [True, False, False]
    first.rename(moved)
    assert [is_made(moved), is_made(moved)] == [True, False]


def test_the_program_of_a_copy_does_not_build_the_original(tmp_path):
    copy = tmp_path / "a copy, é"
    program, module = copy / ".venv/bin/study", copy / "study/paths.py"
    for path in (program, module):
        path.parent.mkdir(parents=True)
    module.touch()
    program.write_text("from study.cli import main\n\nmain()\n")
    command = [sys.executable, program, "list"]
    environment = os.environ | {"PYTHONPATH": str(paths.ROOT), "PYTHONUTF8": "1"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.count("\n") == 1
    assert all(
        text in done.stderr for text in (f"{copy} is a copy", f"{paths.ROOT};", "make setup")
    )


def test_a_missing_lock_is_named_with_its_remedy(first):
    (first / "requirements.lock").unlink()
    done = set_up(first)
    assert done.returncode != 0
    remedy = "Missing: requirements.lock. Restore it with: git checkout -- requirements.lock\n"
    assert done.stderr.startswith(remedy)


def test_a_loop_that_does_not_compile_fails_the_set_up(first):
    done = set_up(first, uv="", python=MADE + 'case "$*" in *warm*) exit 3;; esac\n')
    assert done.returncode != 0
    assert not (first / ".venv/.ready").exists()


def test_simulations_of_every_kind_need_no_more_than_set_up_compiles(capsys):
    warm.main()
    first, last = capsys.readouterr().out.splitlines()
    assert all(name in first for name in warm.KINDS)
    assert re.fullmatch(r"Compiled in \d+\.\d s", last)
    compiled = set(CACHE.rglob("*.nbc"))
    for simulated in warm.KINDS.values():
        simulated(law="stiffened_hertz", duration=2e-3, outputs=10)
    assert set(CACHE.rglob("*.nbc")) == compiled
