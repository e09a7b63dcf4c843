"""The page of a joint of one's own: its JavaScript, in a browser or in node, against Python."""

import json
import re
import shutil
import subprocess
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from helpers.programs import CHROMIUM
from scipy.optimize import minimize_scalar

from study.joint import Joint
from study.pages.report import numbers as page_of_joint

STATIC = Path(page_of_joint.__file__).parent / "static"
NODE = shutil.which("node")
RANGE = 0.05, 0.5
RUN = """
const run = ({ joint, depth, force }) => {
  try {
    const law = window.STIFFENED_HERTZ.law(joint), at = depth ?? law.depth(force);
    return { depth: at, force: law.force(at), stiffness: law.stiffness(at), deepest: law.deepest,
      power: law.power(...RANGE), inverse: law.depth(law.force(at)) };
  } catch (error) { return { refused: error.message }; }
};
const told = JSON.stringify(GIVEN.map(run));
"""


@pytest.fixture(scope="module")
def computed(tmp_path_factory):
    """Run the page's script on many joints at once."""

    def computed(given):
        folder = tmp_path_factory.mktemp("joint")
        head = f"window.JOINT_DATA = {json.dumps(page_of_joint.joint_data())};\n"
        law = (STATIC / "joint.js").read_text(encoding="utf-8")
        run = RUN.replace("GIVEN", json.dumps(given)).replace("RANGE", json.dumps(RANGE))
        if CHROMIUM:
            parts = (head, law, f"{run} document.body.textContent = told;")
            page = folder / "page.html"
            scripts = "".join(f"<script>{part}</script>" for part in parts)
            page.write_text(f"<body>{scripts}</body>", encoding="utf-8")
            options = ("--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom")
            command = [CHROMIUM, *options, f"--user-data-dir={folder}/profile", page.as_uri()]
            done = subprocess.run(command, capture_output=True, text=True)
            told = unescape(done.stdout.partition("<body>")[2].partition("</body>")[0])
        elif NODE:
            script = folder / "page.js"
            lines = ["globalThis.window = globalThis;", head, law, run, "console.log(told);"]
            script.write_text("\n".join(lines), encoding="utf-8")
            told = subprocess.run([NODE, script], capture_output=True, text=True).stdout
        else:
            pytest.skip("neither Chromium nor node found")
        return json.loads(told)

    return computed


def random_joint(rng):
    """Dimensions and materials of a joint in the law's range."""
    radius = 10 ** rng.uniform(-3, 0)
    ball, socket = (
        f"{10 ** rng.uniform(8, 12):.6g},{rng.uniform(0.2, 0.46):.4g}" for _ in range(2)
    )
    return {
        "socket_radius": radius,
        "clearance": radius / 10 ** rng.uniform(1.31, 5.0),
        "wall": radius * (0.1 + 10 ** rng.uniform(-3, 1.5)),
        "ball": ball,
        "socket": socket,
        "ball_support": str(rng.choice(["guided", "clamped"])),
        "rim": str(rng.choice(["mirror", "free"])),
    }


@pytest.fixture(scope="module")
def joints():
    """Joints with a depth or a force each, and their laws in Python."""
    rng, given = np.random.default_rng(2024), []
    for k in range(200):
        joint = random_joint(rng)
        law = Joint(**joint).law("stiffened_hertz")
        depth = law.deepest * 10 ** rng.uniform(-4, 0)
        asked = {"depth": depth} if k % 2 else {"force": law.force(depth)}
        given.append(({"joint": joint} | asked, law))
    return given


@pytest.fixture(scope="module")
def found(computed, joints):
    return computed([given for given, _ in joints])


def test_force_depth_and_stiffness_are_pythons(found, joints):
    for of_page, (given, law) in zip(found, joints, strict=True):
        depth = given.get("depth", of_page["depth"])
        assert of_page["depth"] == pytest.approx(given.get("depth") or law.depth(given["force"]))
        if "force" in given:
            assert depth == pytest.approx(law.depth(given["force"]), rel=1e-9)
        assert of_page["force"] == pytest.approx(law.force(depth), rel=1e-9)
        assert of_page["stiffness"] == pytest.approx(law.stiffness(depth), rel=1e-9)
        assert of_page["inverse"] == pytest.approx(depth, rel=1e-9)
        assert of_page["deepest"] == pytest.approx(law.deepest, rel=1e-12)


def test_the_power_law_has_the_least_largest_error(found, joints):
    """As the nearest of all exponents on 60 depths; its error is met at both signs."""
    for of_page, (_, law) in list(zip(found, joints, strict=True))[::8]:
        depth = law.clearance * np.geomspace(*RANGE, 60)
        logarithm, force = np.log(depth), np.log(law.force(depth))
        best = minimize_scalar(
            lambda n, x=logarithm, y=force: np.ptp(n * x - y),
            bounds=(1, 4),
            method="bounded",
            options={"xatol": 1e-9},
        )
        k, n, error = (of_page["power"][name] for name in ("k", "n", "error"))
        off = k * depth**n / law.force(depth) - 1
        assert [off.max(), -off.min()] == pytest.approx([error, error], abs=1e-9)
        assert error == pytest.approx(np.tanh(best.fun / 2), rel=1e-4)
        assert error <= np.tanh(best.fun / 2) * (1 + 1e-9)


USUAL = {"socket_radius": 0.0125, "clearance": 4e-5, "wall": 0.006, "ball": "steel"}
USUAL |= {"socket": "bronze", "ball_support": "guided", "rim": "mirror"}
WRONG = [
    {"socket_radius": 0},
    *({"clearance": value} for value in (-1e-5, 0.0125, 0.002)),
    *({"wall": value} for value in (1e-7, 0.001, 2e4)),
    *({"ball": text} for text in ("steal", "210e9", "210,0.3", "2e11,0.5")),
    *({"socket": text} for text in ("2e11,0.3,0", "1e7,0.1", "2e11,0.48", "2e11,x", "1e22,0.3")),
    {"rim": "held"},
    {"depth": 4.1e-5},
    *({"force": value} for value in (-1.0, 1e9)),
]


def test_what_python_refuses_the_page_refuses_in_the_same_words(computed):
    given = [({"joint": USUAL, "depth": 1e-6} | split(wrong)) for wrong in WRONG]
    for case, of_page in zip(given, computed(given), strict=True):
        with pytest.raises(ValueError, match=" must be ") as refused:
            law = Joint(**case["joint"]).law("stiffened_hertz")
            if "force" in case:
                law.depth(case["force"])
            law.force(case["depth"])
        words = re.split(": did you mean|; without clearance|; use the law", str(refused.value))[0]
        assert of_page["refused"] == words.replace("rim must", "rim of stiffened_hertz must")


def split(wrong):
    """A wrong value of the joint, or a wrong depth or force."""
    if wrong.keys() & {"depth", "force"}:
        return {"depth": None} | wrong
    return {"joint": USUAL | wrong}
