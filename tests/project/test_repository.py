"""Files for other programs: hooks, workflow, containers, conda and the citation."""

import json
import re
import shlex

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
    (run,) = (step for step in job["steps"] if "run" in step)
    assert (run["run"], run["env"]) == (".ci/run", {"PYTHON": "python"})
    assert (ROOT / run["run"]).stat().st_mode & 0o111
    assert re.search(r"^PYTHON \?=", text("Makefile"), re.MULTILINE)  # a variable of this name


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


def test_conda_installs_the_project_with_the_python_that_it_needs():
    python, *_, pip = yaml.safe_load(text("environment.yml"))["dependencies"]
    least = python.removeprefix("python")
    assert f'requires-python = "{least}"' in text("pyproject.toml")
    extras = re.findall(r"\w+", pip["pip"][0].split()[1])
    assert all(re.search(rf"^{extra} = \[", text("pyproject.toml"), re.M) for extra in extras)
