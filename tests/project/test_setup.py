"""``make setup`` by programs that only note their calls; a copy of the project is set up anew."""

import os
import shutil
import subprocess

import pytest

from study import paths

FIRST = {"numpy", "scipy", "llvmlite", "numba", "platformdirs", "threadpoolctl"}
NOTED = '#!/bin/sh\necho "$(basename "$0") $*" >> called\n'
MADE = 'case "$*" in *"-m venv"*) mkdir -p .venv/bin; cp "$0" .venv/bin/python;; esac\n'


@pytest.fixture
def folder(tmp_path):
    """Folder with what a set-up reads."""
    (tmp_path / "first").mkdir()
    for name in ("Makefile", "requirements.lock", "pyproject.toml"):
        shutil.copy(paths.ROOT / name, tmp_path / "first")
    return tmp_path / "first"


def set_up(folder, **programs):
    """Run ``make setup`` with Python and others that note their calls; return it and the calls."""
    for name, does in ({"python": MADE, "uv": "exit 1\n"} | programs).items():
        (folder.parent / name).write_text(NOTED + does)
        (folder.parent / name).chmod(0o755)
    path = os.pathsep.join([str(folder.parent), os.environ["PATH"]])
    command = ["make", "setup", f"PYTHON={folder.parent / 'python'}"]
    environment = os.environ | {"PATH": path}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    called = folder / "called"
    calls = called.read_text().splitlines() if called.is_file() else []
    called.unlink(missing_ok=True)
    return done, calls


@pytest.mark.parametrize("uv", ["exit 0\n", "exit 1\n"])
def test_the_lock_is_installed_by_uv_or_else_by_pip(folder, uv):
    done, calls = set_up(folder, uv=uv)
    assert done.returncode == 0, done.stderr
    by = [call.split()[0] for call in calls if " install " in call]
    assert by == (["uv"] * 3 if uv == "exit 0\n" else ["uv", "python"] * 3)
    assert sum("--require-hashes" in call for call in calls) == len(by) * 2 // 3
    assert calls.count("python -m study.mechanism") == 1
    lock = (folder / ".venv/first.lock").read_text()
    assert {line.split("==")[0] for line in lock.splitlines() if line[0] != " "} == FIRST
    steps = [line for line in done.stdout.splitlines() if line[1:5] == " of "]
    assert [step[0] for step in steps] == ["1", "2", "3", "4"]
    assert (folder / ".venv/.ready").is_file()


@pytest.mark.parametrize("fails", ["requirements.lock", "-m study.mechanism"])
def test_a_step_that_fails_fails_the_set_up(folder, fails):
    done, _ = set_up(folder, python=f'{MADE}case "$*" in *"{fails}"*) exit 3;; esac\n')
    assert done.returncode != 0
    assert not (folder / ".venv/.ready").exists()


def test_a_copy_is_set_up_anew(folder, tmp_path):
    copy = tmp_path / "a copy, é"

    def is_made(folder):
        """Whether ``make setup`` made an environment."""
        done, calls = set_up(folder)
        assert done.returncode == 0, done.stderr
        return any("-m venv" in call for call in calls)

    assert [is_made(folder), is_made(folder)] == [True, False]
    shutil.copytree(folder, copy, copy_function=shutil.copy2)
    assert [is_made(copy), is_made(copy), is_made(folder)] == [True, False, False]


def test_a_clone_that_converts_line_ends_has_the_data_as_they_are(tmp_path):
    clone = tmp_path / "clone"
    for words in (
        ["clone", "--quiet", "-c", "core.autocrlf=true", paths.ROOT, clone],
        ["-C", clone, "status", "--porcelain"],
    ):
        done = subprocess.run(["git", *words], capture_output=True, text=True, check=True)
    assert done.stdout == ""
    for path in (*paths.DATA.rglob("*.csv"), paths.STUDY / "contact/stiffening.csv"):
        assert b"\r" not in (clone / path.relative_to(paths.ROOT)).read_bytes(), path
