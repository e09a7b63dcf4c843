"""The package as a user installs it: a wheel, away from the project's folder."""

import json
import os
import re
import subprocess
import sys
import tomllib
from importlib.metadata import distribution, packages_distributions

import pytest
from helpers.project import share_compiled
from packaging.requirements import Requirement

from study import paths

pytestmark = pytest.mark.slow

LIBRARY = """
import study
from study import contact, export
from study.joint import Joint, Material
from study.mechanism import Scene, simulate

joint = Joint.from_ratios(75, socket=Material(7e10, 0.33))
print(study.__file__)
print(joint.law("stiffened_hertz").law(0.3))
print(joint.solve(depth_star=0.5).force_star)
print(simulate(Scene(restitution=0.9), duration=1e-3, outputs=2).slider_position[-1])
print(len(export.export("tabulated", "csv", joint)))
"""

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
    sys.argv = ["study", *words]
    sys.stdout, sys.stderr = TextIOWrapper(BytesIO()), TextIOWrapper(BytesIO())
    try:
        cli.main()
    except SystemExit as stop:
        sys.stdout.flush(), sys.stderr.flush()
        texts = [stream.buffer.getvalue().decode() for stream in (sys.stdout, sys.stderr)]
        done.append((stop.code, *texts))
print(json.dumps(done), file=shown)
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


def run(installed, *words, given="", **more):
    """Run Python from another folder, with a cache folder of its own."""
    (installed / "empty").mkdir(exist_ok=True)
    variables = {"PYTHONPATH": str(installed / "site"), "XDG_CACHE_HOME": str(installed / "cache")}
    return subprocess.run(
        [sys.executable, *words],
        input=given,
        cwd=installed / "empty",
        env=os.environ | variables | more,
        capture_output=True,
        text=True,
    )


def several(installed, commands, blocked=()):
    done = run(installed, "-c", SEVERAL, given=json.dumps([commands, sorted(blocked)]))
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_laws_joints_simulations_and_exports_work(installed):
    done = run(installed, "-c", LIBRARY)
    assert done.returncode == 0, done.stderr
    where, *numbers = done.stdout.splitlines()
    assert where == str(installed / "site/study/__init__.py")
    assert len(numbers) == 4
    assert not (installed / "site/build").exists()


def not_in_the_base():
    """Names of all installed packages that a base install does not bring."""
    project = tomllib.loads((paths.ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    base, texts = set(), list(project["dependencies"])
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


SIZES = ("--socket-radius", "0.01", "--clearance", "1e-4", "--wall", "3e-3")
BASE = [
    ("law", "hertz", "--r2-star", "200", "--depth-star", "0.3", "--json"),
    ("joint", "--r2-star", "75", "--depth-star", "0.1", "--json"),
    ("joint", "--r2-star", "75", "--depth-star", "0.1", "--ball-support", "clamped", "--json"),
    ("joint", *SIZES, "--socket", "bronze", "--force", "100", "--json"),
    ("simulate", "--duration", "1e-3", "--output", "motion.csv", "--json"),
    ("simulate", "--duration", "1e-3", "--joint", "ideal", "--json"),
    ("choose", "--r2-star", "200", "--depth-star", "0.3", "--tolerance", "0.01", "--json"),
    ("simulate", "--model", "auto", "--tolerance", "0.1", "--json"),
]
TEXTS = [
    ("data", "materials"),
    ("export", "--law", "tabulated", "--format", "csv", "--r2-star", "150"),
    ("simulate", "--duration", "1e-3"),
    ("sweep", "joints", "--random", "2", "--range", "r2_star=50:90", "--output", "joints.csv"),
]


def test_a_base_install_has_what_laws_joints_simulations_exports_and_sweeps_need(installed):
    done = several(installed, [*BASE, *TEXTS], not_in_the_base())
    for command, (status, out, err) in zip([*BASE, *TEXTS], done, strict=True):
        err = re.sub(r"\d+ of \d+ cases, 0 failed\n", "", err)  # progress on a slow machine
        assert (status, err) == (0, ""), command
        assert json.loads(out) if command in BASE else out
        assert json.loads(out)["law"] if SIZES[0] in command else True


STUDY = [("data", "show"), ("measure",), ("paper",)]
PROJECT = [("run", "fig10"), ("list",)]


def test_a_command_of_the_study_says_in_a_base_install_what_to_install(installed):
    done = several(installed, [*STUDY, *PROJECT], not_in_the_base())
    install = r"pip install 'spherical-clearance-joint-study\[study\]'\n"
    for command, (status, out, err) in zip([*STUDY, *PROJECT], done, strict=True):
        needs = rf"study {' '.join(command)} needs the package \w+; .*{install}"
        if command in PROJECT:  # its notebooks are needed first
            needs = ".* requires a checkout of the project, .*\n"
        assert (status, out) == (1, ""), command
        assert re.fullmatch(f"study: {needs}", err), err
