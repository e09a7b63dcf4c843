"""Files for other programs: hooks, workflow, containers, conda and the citation."""

import json
import re
import shlex

import pytest
import yaml

from study import paths

ROOT = paths.ROOT


def text(name):
    return (ROOT / name).read_text(encoding="utf-8")


def test_hooks_are_those_of_the_locked_versions():
    locked = dict(re.findall(r"^([\w-]+)==(\S+)", text("requirements.lock"), re.MULTILINE))
    hooks = {
        hook["id"]: repository["rev"].removeprefix("v")
        for repository in yaml.safe_load(text(".pre-commit-config.yaml"))["repos"]
        for hook in repository["hooks"]
    }
    ruff = locked["ruff"]
    assert hooks == {"ruff-check": ruff, "ruff-format": ruff, "nbstripout": locked["nbstripout"]}


def test_the_workflow_runs_what_a_clean_checkout_must_pass():
    (job,) = yaml.safe_load(text(".github/workflows/check.yml"))["jobs"].values()
    assert job["strategy"]["matrix"] == {
        "system": ["ubuntu-latest", "macos-latest"],
        "python": ["3.11", "3.12", "3.13"],
    }
    (run,) = (step for step in job["steps"] if "run" in step)
    assert (run["run"], run["env"]) == (".ci/run", {"PYTHON": "python"})
    assert (ROOT / run["run"]).stat().st_mode & 0o111
    assert re.search(r"^PYTHON \?=", text("Makefile"), re.MULTILINE)  # a variable of this name
    assert "secrets" not in text(".github/workflows/check.yml")


def test_the_container_takes_files_that_are_there_and_calls_targets_of_make():
    targets = re.findall(r"^(\w+):", text("Makefile"), re.MULTILINE)
    steps = [line.split(maxsplit=1) for line in text("Dockerfile").splitlines()]
    called = []
    for step, words in steps:
        if step == "COPY":
            *sources, _ = words.split()
            assert all((ROOT / source).exists() for source in sources)
        elif step in ("RUN", "CMD"):
            commands = [json.loads(words)] if step == "CMD" else map(shlex.split, words.split("&&"))
            called += [command[1] for command in commands if command[0] == "make"]
    assert called == ["setup", "reproduce"]
    assert set(called) <= set(targets)
    wanted = re.search(r'requires-python = ">=3\.(\d+)"', text("pyproject.toml"))
    assert int(re.match(r"FROM python:3\.(\d+)-slim\n", text("Dockerfile"))[1]) >= int(wanted[1])


def test_the_container_takes_nothing_that_git_ignores():
    ignored = {line.removeprefix("**/").rstrip("/*") for line in text(".dockerignore").splitlines()}
    assert ignored - {".git"} == {line.rstrip("/*") for line in text(".gitignore").splitlines()}


def test_the_development_container_is_the_same_one():
    folder = ROOT / ".devcontainer"
    container = json.loads(text(".devcontainer/devcontainer.json"))
    assert (folder / container["build"]["dockerfile"]).resolve() == ROOT / "Dockerfile"
    assert (folder / container["build"]["context"]).resolve() == ROOT
    assert container["postCreateCommand"] == "make setup"


def test_conda_installs_the_project_with_the_python_that_it_needs():
    *packages, pip = yaml.safe_load(text("environment.yml"))["dependencies"]
    assert packages == ["python>=3.11", "make", "pip"]
    assert 'requires-python = ">=3.11"' in text("pyproject.toml")
    _, project = pip["pip"][0].split()
    extras = re.findall(r"\w+", project)
    assert all(re.search(rf"^{extra} = \[", text("pyproject.toml"), re.M) for extra in extras)


NAMES = [".pre-commit-config.yaml", ".github/workflows/check.yml", "Dockerfile", "environment.yml"]


@pytest.mark.parametrize("name", [*NAMES, ".devcontainer/devcontainer.json", ".zenodo.json"])
def test_no_package_index_is_named(name):
    assert not re.search(r"index-url|pypi|simple/", text(name))
