"""The package as a user installs it: a wheel, away from the project's folder."""

import json
import os
import re
import subprocess
import sys
import tomllib
from importlib.metadata import PathDistribution, distribution, packages_distributions

import pytest
from helpers.project import share_compiled
from packaging.requirements import Requirement

from study import paths

pytestmark = pytest.mark.slow

SEVERAL = """
import json, sys
from io import BytesIO, TextIOWrapper
from study import cli

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in blocked:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

(commands, blocked), done, shown = json.load(sys.stdin), [], sys.stdout
sys.meta_path.insert(0, Blocked())
for words in commands:
    sys.stdout, sys.stderr = TextIOWrapper(BytesIO()), TextIOWrapper(BytesIO())
    try:
        cli.main(words)
    except SystemExit as stop:
        sys.stdout.flush(), sys.stderr.flush()
        texts = [stream.buffer.getvalue().decode() for stream in (sys.stdout, sys.stderr)]
        done.append((stop.code, *texts))
print(json.dumps([cli.__file__, done]), file=shown)
"""
"""Several command lines in one process, as if some packages were not installed."""


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """Folder with the installed wheel and nothing else of the project."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=paths.ROOT, check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    subprocess.run([*pip, "--target", str(folder / "site"), str(wheel)], check=True)
    cache = folder / "cache/spherical-clearance-joint-study/compiled"
    share_compiled(folder / "site", cache)
    return folder


def several(installed, commands, blocked):
    """Run commands from another folder, with a cache folder of their own."""
    (installed / "empty").mkdir(exist_ok=True)
    variables = {"PYTHONPATH": str(installed / "site"), "XDG_CACHE_HOME": str(installed / "cache")}
    done = subprocess.run(
        [sys.executable, "-c", SEVERAL],
        input=json.dumps([commands, sorted(blocked)]),
        cwd=installed / "empty",
        env=os.environ | variables,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    where, results = json.loads(done.stdout)
    assert where == str(installed / "site/study/cli/__init__.py")
    return results


def project():
    return tomllib.loads((paths.ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def not_in_the_base():
    """Names of all installed packages that a base install does not bring."""
    base, texts = set(), list(project()["dependencies"])
    while texts:
        needed = Requirement(texts.pop())
        name = canonical(needed.name)
        if name not in base and (needed.marker is None or needed.marker.evaluate({"extra": ""})):
            base.add(name)
            texts += distribution(name).requires or []
    owners = packages_distributions().items()
    return {package for package, names in owners if not base & set(map(canonical, names))} - {
        "study"
    }


def canonical(name):
    return re.sub("[-_.]+", "-", name).lower()


BRONZE = "--socket-radius 12.5mm --clearance 40um --wall 6mm --socket bronze"
BASE = [
    f"joint {BRONZE} --force 100",
    "joint --r2-star 75 --depth-star 0.1 --ball-support clamped",
    "joint cases.csv --output table.csv",
    "laws --r2-star 200 --depth-star 0.3",
    "export tabulated csv --r2-star 150",
    "simulate --duration 1e-3 --joint ideal",
    "models --duration 5e-3",
    "data materials",
]
NOT_IN_BASE = {
    f"joint {BRONZE} --force 100 --plot x.png": r"this command needs the package matplotlib, .*\n",
    "data show": "this command requires a checkout of the project, .*\n",
    "run fig10": "this command requires a checkout of the project, .*\n",
    "list": "this command requires a checkout of the project, .*\n",
}


def test_a_base_install_has_what_joints_laws_mechanisms_and_exports_need(installed):
    (installed / "empty").mkdir(exist_ok=True)
    (installed / "empty/cases.csv").write_text("r2_star,depth_star\n50,0.1\n60,0.1\n")
    done = several(installed, [words.split() for words in BASE], not_in_the_base())
    for words, (status, out, err) in zip(BASE, done, strict=True):
        assert status == 0, (words, err)
        assert out or (installed / "empty/table.csv").is_file()
    assert not (installed / "site/build").exists()


def test_the_version_is_that_of_the_project(installed):
    version = project()["version"]
    (about,) = installed.glob("site/*.dist-info")
    assert PathDistribution(about).version == version
    ((status, out, _),) = several(installed, [["--version"]], [])
    assert (status, out) == (0, f"study, version {version}\n")


def test_a_command_that_needs_more_than_a_base_install_says_so(installed):
    commands = [words.split() for words in NOT_IN_BASE]
    done = several(installed, commands, not_in_the_base())
    for words, (status, _, err) in zip(NOT_IN_BASE, done, strict=True):
        assert status == 1, words
        assert re.search(NOT_IN_BASE[words], err), err
