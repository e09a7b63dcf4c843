"""What a release needs: its workflow on the host, the image of the container, conda."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
from zipfile import ZipFile

import pytest
import yaml
from packaging.specifiers import SpecifierSet

from study import paths

CHANGES = "# Changelog\n\n## 1.2.0 (2027-01-01)\n\n- New.\n\n## 1.1.0 (2026-12-01)\n\n- Old.\n"
PDFS = ("paper.pdf", "supplement.pdf")


def read(name):
    return yaml.safe_load((paths.ROOT / name).read_text(encoding="utf-8"))


JOBS = read(".github/workflows/checks.yml")["jobs"]
COMPARE, ATTACH = (step["run"] for step in JOBS["release"]["steps"] if "run" in step)


def run(script, folder, tag="v1.2.0", repository="us/joint"):
    """Run a step as the host does, with a program ``gh`` that notes its words."""
    bin_folder = folder.parent / "bin"
    bin_folder.mkdir(exist_ok=True)
    (bin_folder / "gh").write_text('#!/bin/sh\nprintf "%s\\n" "$@" > called\n')
    (bin_folder / "gh").chmod(0o755)
    (bin_folder / "python3").unlink(missing_ok=True)
    (bin_folder / "python3").symlink_to(sys.executable)
    path = os.pathsep.join([str(bin_folder), os.environ["PATH"]])
    variables = {"PATH": path, "GITHUB_REF_NAME": tag, "GITHUB_REPOSITORY": repository}
    return subprocess.run(
        ["bash", "-e", "-c", script],
        cwd=folder,
        env=os.environ | variables,
        capture_output=True,
        text=True,
    )


@pytest.fixture
def folder(tmp_path):
    """A project of version 1.2.0, with the report that another job made."""
    folder = tmp_path / "project"
    (folder / "made").mkdir(parents=True)
    text = (paths.ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for name, value in {"version": "1.2.0", "Repository": "https://github.com/us/joint"}.items():
        text, replaced = re.subn(f'(?m)^{name} = ".+"$', f'{name} = "{value}"', text)
        assert replaced == 1
    (folder / "pyproject.toml").write_text(text, encoding="utf-8")
    (folder / "CHANGELOG.md").write_text(CHANGES)
    for name in ("index.html", *PDFS):
        (folder / "made" / name).write_text(name)
    with tarfile.open(folder / "artifact.tar", "w") as archive:
        archive.add(folder / "made", ".")
    shutil.rmtree(folder / "made")
    return folder


@pytest.mark.parametrize(
    ("tag", "repository", "message"),
    [
        ("v1.2.0", "us/joint", ""),
        ("v1.2.1", "us/joint", "tag v1.2.1, but pyproject.toml has version 1.2.0\n"),
        ("1.2.0", "us/joint", "tag 1.2.0, but pyproject.toml has version 1.2.0\n"),
        ("v1.2.0", "us/j.int", 'must have Repository = "https://github.com/us/j.int"\n'),
        ("v1.2.0", "us/other", 'must have Repository = "https://github.com/us/other"\n'),
    ],
)
def test_a_tag_or_repository_that_is_not_that_of_the_project_stops_a_release(
    folder, tag, repository, message
):
    done = run(COMPARE, folder, tag, repository)
    assert (done.returncode == 0) == (message == "")
    assert done.stderr.endswith(message)
    assert bool(done.stderr) == bool(message)


@pytest.mark.skipif(not shutil.which("sha256sum"), reason="older systems of Apple do not have it")
def test_a_release_has_report_pdfs_hashes_and_changes(folder):
    done = run(ATTACH, folder)
    assert done.returncode == 0, done.stderr
    assert (folder / "notes.md").read_text() == "\n- New.\n\n"
    words = (folder / "called").read_text().splitlines()
    assert words[:4] == ["release", "create", "v1.2.0", "--verify-tag"]
    assert words[-4:] == [*PDFS, "report.zip", "SHA256SUMS"]
    assert words[words.index("--notes-file") + 1] == "notes.md"
    assert sorted(ZipFile(folder / "report.zip").namelist()) == [
        "report/",
        *(f"report/{name}" for name in ("index.html", *PDFS)),
    ]
    lines = (folder / "SHA256SUMS").read_text().splitlines()
    stated = {name: sha for sha, _, name in (line.partition("  ") for line in lines)}
    assert stated == {name: paths.sha256(folder / name) for name in (*PDFS, "report.zip")}


def test_a_release_waits_for_checks_tests_and_rebuild_and_only_it_may_write():
    release = JOBS["release"]
    assert release["needs"] == JOBS["publish"]["needs"] == ["check", "test", "rebuild"]
    assert release["if"] == "startsWith(github.ref, 'refs/tags/v')"
    assert release["permissions"] == {"contents": "write"}
    (checkout,) = (step for step in release["steps"] if "checkout" in step.get("uses", ""))
    assert checkout["with"] == {"persist-credentials": False}
    steps = [step.get("run") or step["uses"] for step in release["steps"]]
    assert steps.index(COMPARE) < steps.index(ATTACH)
    assert read(".github/workflows/checks.yml")["permissions"] == {"contents": "read"}
    allowed = {name: job.get("permissions", {}) for name, job in JOBS.items()}
    assert [name for name, of in allowed.items() if of.get("contents") == "write"] == ["release"]
    uploaded = [step for step in JOBS["rebuild"]["steps"] if "pages" in step.get("uses", "")]
    assert [step["with"]["path"] for step in uploaded] == ["build/report"]


def test_the_container_is_pinned_and_has_a_python_that_is_tested():
    text = (paths.ROOT / "Dockerfile").read_text(encoding="utf-8")
    (python,) = re.findall(r"^FROM python:(3\.\d+)\.\d+-\S+@sha256:[0-9a-f]{64}$", text, re.M)
    assert python in JOBS["test"]["strategy"]["matrix"]["python"]


def test_conda_installs_the_lock():
    """No package but Python has a version here, so that nothing can differ from the lock."""
    *packages, of_pip = read("environment.yml")["dependencies"]
    (python,) = (name.removeprefix("python=") for name in packages if "=" in name)
    assert of_pip == {"pip": ["-r requirements.lock"]}
    assert sorted(name.partition("=")[0] for name in packages) == ["make", "pip", "python"]
    assert python in JOBS["test"]["strategy"]["matrix"]["python"]
    project = tomllib.loads((paths.ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"{python}.0" in SpecifierSet(project["requires-python"])
