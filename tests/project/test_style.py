"""The repository as text: the lock, nothing that belongs to one machine only, the map."""

import re
import subprocess
from pathlib import Path

from study import paths


def tracked():
    """Every file that git tracks, whatever its suffix."""
    listed = subprocess.run(
        ["git", "ls-files", "-z"], cwd=paths.ROOT, capture_output=True, text=True
    )
    assert listed.returncode == 0, listed.stderr
    return [paths.ROOT / name for name in listed.stdout.split("\0") if name]


def test_lock_pins_every_package_by_hash_and_names_no_index():
    lock = (paths.ROOT / "requirements.lock").read_text()
    pinned = re.findall(r"^\S+==\S+.*\\$", lock, re.MULTILINE)
    assert len(pinned) > 100
    assert len(pinned) == len(re.findall(r"^\S", lock, re.MULTILINE)) - 2  # two comment lines
    assert "://" not in lock
    assert "index-url" not in lock


def test_no_path_of_a_machine():
    root = str(paths.ROOT)
    for path in filter(Path.is_file, tracked()):
        content = path.read_bytes()
        assert root.encode() not in content, path
        assert not re.search(rb"/(home|Users)/\w+/", content), path


def test_contributing_names_every_package():
    text = (paths.ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    packages = {path.parent.name for path in (paths.ROOT / "study").glob("*/__init__.py")}
    assert not [package for package in packages if f"`{package}`" not in text]


def test_make_help_names_every_target():
    text = (paths.ROOT / "Makefile").read_text(encoding="utf-8")
    (line,) = re.findall(r"^\.PHONY: help (.+)$", text, re.M)
    assert re.findall(r'@echo "make ([\w-]+) ', text) == line.split()
    assert "setup" in line.split()


def test_hooks_and_the_workflow_of_the_host_use_what_is_locked_and_checked_here():
    def text(name):
        return (paths.ROOT / name).read_text(encoding="utf-8")

    locked = dict(re.findall(r"^([\w-]+)==(\S+)", text("requirements.lock"), re.MULTILINE))
    hooks = re.findall(r"rev: v?(\S+)", text(".pre-commit-config.yaml"))
    assert hooks == [locked["ruff"], locked["nbstripout"]]
    jobs = text(".github/workflows/checks.yml") + text(".github/actions/set-up/action.yml")
    called = set(re.findall(r"run: make ([\w-]+)", jobs))
    assert called == {"setup", "check", "test-all", "reproduce"}
    assert {f"make {name}" for name in called - {"setup"}} <= set(text(".ci/run").splitlines())
    assert all(f"\n{name}:" in text("Makefile") for name in called)
