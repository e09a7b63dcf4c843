"""``make setup``: the locked packages by uv or pip, by programs that only note their calls."""

import os
import re
import shutil
import subprocess
import sys

import pytest

from study import paths
from study.compiled import CACHE
from study.mechanism import simulate, warm

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


@pytest.mark.parametrize(
    ("status", "installed"),
    [
        (0, [f"{UV} {what}" for what in STEPS]),
        (1, [f"{program} {what}" for what in STEPS for program in (UV, PIP)]),
    ],
    ids=["uv", "pip"],
)
def test_the_lock_is_installed_by_uv_or_else_by_pip(tmp_path, status, installed):
    for name in ("Makefile", "requirements.lock", "pyproject.toml"):
        shutil.copy(paths.ROOT / name, tmp_path)
    for name, does in (("python", MADE), ("uv", f"exit {status}\n")):
        (tmp_path / name).write_text(NOTED + does)
        (tmp_path / name).chmod(0o755)
    path = os.pathsep.join([str(tmp_path), os.environ["PATH"]])
    command = ["make", "setup", f"PYTHON={tmp_path / 'python'}"]
    done = subprocess.run(
        command, cwd=tmp_path, env=os.environ | {"PATH": path}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    called = (tmp_path / "called").read_text().splitlines()
    assert [line for line in called if " install " in line] == installed
    assert called.count("python -m study.mechanism.warm") == 1
    first = (tmp_path / ".venv/first.lock").read_text()
    assert {line.split("==")[0] for line in first.splitlines() if line[0] != " "} == BEFORE_WARM
    assert first.count("--hash=sha256:") > len(BEFORE_WARM)
    assert (tmp_path / ".venv/.ready").is_file()


def test_a_copy_is_set_up_anew_and_so_is_what_moved(tmp_path):
    first, copy, moved = (tmp_path / name for name in ("first", "a copy, é", "moved"))
    first.mkdir()
    for name in ("Makefile", "requirements.lock", "pyproject.toml"):
        shutil.copy(paths.ROOT / name, first)
    python = tmp_path / "python"
    python.write_text(NOTED + MADE)
    python.chmod(0o755)

    def set_up(folder):
        """Whether ``make setup`` made an environment."""
        command = ["make", "setup", f"PYTHON={python}"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        called = folder / "called"
        made = called.is_file() and "-m venv" in called.read_text()
        called.unlink(missing_ok=True)
        return made

    assert [set_up(first), set_up(first)] == [True, False]
    shutil.copytree(first, copy, copy_function=shutil.copy2)
    assert [set_up(copy), set_up(copy), set_up(first)] == [True, False, False]
    first.rename(moved)
    assert [set_up(moved), set_up(moved)] == [True, False]


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
    wanted = f"study: {copy} is a copy whose environment is still that of {paths.ROOT}; set it up"
    assert done.stderr == f"{wanted} with: make setup\n"


def test_a_missing_lock_is_named_with_its_remedy(tmp_path):
    for name in ("Makefile", "pyproject.toml"):
        shutil.copy(paths.ROOT / name, tmp_path)
    done = subprocess.run(["make", "test"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode != 0
    remedy = "Missing: requirements.lock. Restore it with: git checkout -- requirements.lock\n"
    assert done.stderr.startswith(remedy)


def test_a_loop_that_does_not_compile_fails_the_set_up(tmp_path):
    for name in ("Makefile", "requirements.lock", "pyproject.toml"):
        shutil.copy(paths.ROOT / name, tmp_path)
    fails = 'case "$*" in *warm*) exit 3;; esac\n'
    (tmp_path / "python").write_text(NOTED + MADE + fails)
    (tmp_path / "python").chmod(0o755)
    command = ["make", "setup", f"PYTHON={tmp_path / 'python'}"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode != 0
    assert not (tmp_path / ".venv/.ready").exists()


def test_simulations_of_every_kind_need_no_more_than_set_up_compiles(capsys):
    warm.main()
    first, last = capsys.readouterr().out.splitlines()
    assert all(name in first for name in warm.KINDS)
    assert re.fullmatch(r"Compiled in \d+\.\d s", last)
    compiled = set(CACHE.rglob("*.nbc"))
    for scene, model in warm.KINDS.values():
        simulate(scene, model=model, law="stiffened_hertz", duration=2e-3, outputs=10)
    assert set(CACHE.rglob("*.nbc")) == compiled
