"""Walls between the rooms: who may import whom, and what an import loads."""

import re
import subprocess
import sys

import pytest

from study import paths

HEAVY = {"numba", "pandas", "skfem", "matplotlib"}


def lint():
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command as f; f()"]
    return subprocess.run([*command, "--no-cache"], cwd=paths.ROOT, capture_output=True, text=True)


def test_every_room_keeps_its_walls():
    done = lint()
    assert done.returncode == 0, done.stdout
    assert re.search(r"Contracts: \d+ kept, 0 broken", done.stdout)


def loaded(code):
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.mark.parametrize(
    ("code", "heavy"),
    [
        ("import study.contact", HEAVY),
        ("from study.mechanism import Scene, simulate", {"skfem", "matplotlib", "study.dataset"}),
        ("from study.joint import Joint, Material, force_curve", HEAVY),
    ],
)
def test_an_import_loads_what_it_needs(code, heavy):
    assert not heavy & set(loaded(f"{code}; import sys; print(*sys.modules)"))


@pytest.mark.parametrize("room", ["contact", "joint", "mechanism"])
def test_the_library_names_no_file_of_the_data(room):
    for source in (paths.ROOT / "study" / room).glob("*.py"):
        text = source.read_text()
        assert not re.search(r"[\"'/]data\b", text), source
