"""The recipe "a force on the slider": a spring and a dashpot to ground in a copy of the project.

It changes two files, and all models of the links have it: their energies balance, and they agree.
"""

import json
import subprocess
import sys

import pytest
from helpers.project import copy_project, environment

pytestmark = pytest.mark.slow
RECIPE = {
    "study/mechanism/slide.py": [
        (
            "    return Slide(0.0, 0.0, 0.0, 0.0, 0.0)",
            "    x, k, c = position - p.rest, p.spring, p.dashpot\n"
            "    return Slide(-k * x - c * speed, -k, -c, 0.5 * k * x * x, c * speed * speed)",
        ),
    ],
    "study/mechanism/scene.py": [
        ('friction v0 v1 steady"', 'friction v0 v1 steady spring dashpot rest"'),
        (
            "    gravity: float = parameter(\n",
            '    spring: float = parameter(0.0, "Spring", "N/m", least=0)\n'
            '    dashpot: float = parameter(0.0, "Dashpot", "N s/m", least=0)\n'
            "    gravity: float = parameter(\n",
        ),
        (
            "            steady=float(self.crank_speed is not None),\n",
            "            steady=float(self.crank_speed is not None),\n"
            "            spring=self.spring,\n            dashpot=self.dashpot,\n"
            "            rest=l1 + l2,\n",
        ),
    ],
}
"""File -> texts there, and what is there with the force."""
RUN = """
import json
from study.mechanism import Scene, simulate
scene, found = Scene(spring=2000.0, dashpot=5.0), {}
for model in ("rigid", "particles", "beams"):
    for joint in ("ideal", "clearance"):
        r = simulate(scene, model=model, joint=joint, duration=0.02, outputs=200)
        numbers = r.energy_error, r.slider_position[-1], r.lost_damping[-1], r.elastic[-1]
        found[model + " " + joint] = list(map(float, numbers))
print(json.dumps(found))
"""


def test_a_spring_and_a_dashpot_are_in_all_models(tmp_path):
    root = copy_project(tmp_path / "project")
    for name, changes in RECIPE.items():
        text = (root / name).read_text(encoding="utf-8")
        for old, new in changes:
            assert text.count(old) == 1
            text = text.replace(old, new)
        (root / name).write_text(text, encoding="utf-8")
    command = [sys.executable, "-c", RUN]
    done = subprocess.run(
        command, cwd=root, env=environment(root), check=True, capture_output=True, text=True
    )
    found = json.loads(done.stdout)
    for name, (error, *numbers) in found.items():
        assert error < (1e-11 if "rigid" in name else 1e-5), name
        assert numbers == pytest.approx(found[f"rigid {name.split()[1]}"][1:], rel=1e-3), name
    assert found["rigid ideal"][2] > 1e-4
