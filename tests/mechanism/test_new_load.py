"""The recipe "add a load": a spring and a dashpot on the slider, in a copy, for all models."""

import json
import subprocess
import sys

import pytest
from helpers.project import copy_project, environment

DOCSTRING = """
    slider_stiffness, slider_damping, slider_rest : float, in N/m, N s/m and m
"""
FIELDS = """
    slider_stiffness: float = parameter(0.0, "Stiffness of the slider's spring", "N/m", least=0)
    slider_damping: float = parameter(0.0, "Damping of the slider's dashpot", "N s/m", least=0)
    slider_rest: float = parameter(0.17, "Position of the slider without a spring's force", "m")
"""
NAMES = """
    *("slider_stiffness", "slider_damping", "slider_rest"),
"""
CALL = """
        spring(p, position, speed),
"""
FUNCTION = '''

@register_jitable
def spring(p, position, speed):
    """Force of a spring and a dashpot between the slider and the ground."""
    stretch, k, c = position - p.slider_rest, p.slider_stiffness, p.slider_damping
    energy, power = k * stretch**2 / 2, -c * speed**2
    return Load(-k * stretch - c * speed, -k, -c, energy, power)
'''
RECIPE = [
    ("scene.py", "\n    crank_speed : float", DOCSTRING),
    ("scene.py", "# parameters of further loads", FIELDS),
    ("loads.py", "# parameters of further loads", NAMES),
    ("loads.py", "# further loads on the slider", CALL),
]
"""Files, texts in the lines after which lines are added, and these lines."""
LOAD = "slider_stiffness=2000.0, slider_damping=30.0, slider_rest=0.165"
RUN = f"""
import json
import numpy as np
from study.mechanism import Scene, simulate
scene, results = Scene({LOAD}, initial_eccentricity=(4.5e-5, 0.0)), {{}}
models = {{"rigid": {{}}, "particles": {{"elements": (2, 2)}}}}
models["beams"] = {{"elements": (1, 1), "step": 4e-6}}
for drive in ({{"crank_speed": 30.0}}, {{"initial_crank_angle": 1.0, "driving_moment": 0.2}}):
    for model, options in models.items():
        for joint in ("ideal", "clearance"):
            how = options | {{"model": model, "joint": joint, "law": "hertz", "duration": 1e-3}}
            r = simulate(scene.replace(**drive), outputs=100, **how)
            force = -2000.0 * (r.slider_position - 0.165) - 30.0 * r.slider_velocity
            rest = 0.14 * r.slider_acceleration - r.force_x - force
            power = r.driving_moment * r.crank_speed + force * r.slider_velocity
            results[f"{{model}} {{joint}} {{list(drive)[0]}}"] = {{
                "energy_error": r.energy_error,
                "rest": np.abs(rest).max() / np.abs(force).max(),
                "end": [r.crank_angle[-1], r.slider_position[-1]],
                "work": [r.work[-1], np.trapezoid(power, r.time)],
            }}
print(json.dumps(results))
"""
COMPILED = f"""
import numba
from study.mechanism import Scene, loads
print(numba.njit(loads.on_slider)(Scene({LOAD}).constants(), 0.166, 2.0).value)
"""


def test_a_new_load_is_in_every_model_and_in_the_energy_balance(tmp_path):
    root = copy_project(tmp_path / "project")
    for name, marker, lines in RECIPE:
        path = root / "study/mechanism" / name
        before, after = path.read_text(encoding="utf-8").split(marker)
        end_of_line, after = after.split("\n", 1)
        path.write_text(f"{before}{marker}{end_of_line}{lines}{after}", encoding="utf-8")
    with open(root / "study/mechanism/loads.py", "a", encoding="utf-8") as file:
        file.write(FUNCTION)
    assert sum(lines.count("\n") for *_, lines in RECIPE) + FUNCTION.count("\n") <= 30

    def run(code, **variables):
        command, env = [sys.executable, "-c", code], environment(root, **variables)
        return subprocess.check_output(command, cwd=root, env=env, text=True)

    assert float(run(COMPILED)) == pytest.approx(-2000 * 0.001 - 30 * 2)
    results = json.loads(run(RUN, NUMBA_DISABLE_JIT="1"))  # to compile all models takes a minute
    for name, found in results.items():
        model, joint_and_drive = name.split(maxsplit=1)
        rough = "clearance" in name  # few elements and steps in an impact
        assert found["rest"] < 1e-12
        assert found["energy_error"] < (1e-9 if model == "rigid" else 2e-2 if rough else 1e-4)
        assert found["work"][0] == pytest.approx(found["work"][1], abs=1e-4)  # trapezoidal rule
        reference = results[f"rigid {joint_and_drive}"]["end"]
        assert found["end"] == pytest.approx(reference, abs=1e-4 if rough else 5e-6)
