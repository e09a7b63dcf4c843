"""Flexible links: error and computing time of particles, beams, and methods compared with them.

With an ideal joint the position of the slider over 0.1 s is compared. Its acceleration is not
suitable, because the sudden moment excites undamped vibrations of the links, and no mesh reproduces
their phase over so many periods. With clearance the time and the maximum force of the first impact
are compared, because later impacts are chaotic. The reference is computed with particles on a fine
mesh.
"""

from collections.abc import Iterator
from functools import cache, partial
from itertools import product
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from study.measure.timing import Call, Run
from study.mechanism import Scene, paper_scene, simulate
from study.mechanism.compare import normalised_rms
from study.mechanism.frame import Frame

Joint = Literal["ideal joint", "first impact"]
Model = Literal["particles", "beams"]
Elements = tuple[int, int]
MODELS: tuple[Model, Model] = ("particles", "beams")
SCENE = paper_scene()
DURATIONS: dict[Joint, float] = {"ideal joint": 0.1, "first impact": 2e-3}  # s
OUTPUTS = 100  # of the ideal joint
FINEST = {"ideal joint": (8, 16), "first impact": (32, 64)}
MESHES = {"ideal joint": (1, 2, 4), "first impact": (2, 4, 8, 16)}
"""Numbers of elements of the crank; the coupler has twice as many. Particles need at least two,
because the rotary inertia of a single one is too large."""
STEPS = {"ideal joint": (1e-3, 2e-4, 5e-5, 1e-5), "first impact": (1e-5, 4e-6, 1e-6, 2.5e-7)}
"""Steps of the implicit methods, in s."""
SHARES = (0.95, 0.5)  # fractions of the limit of the explicit step


def runs() -> Iterator[Run]:
    """Runs of both models with every mesh and step."""
    for joint in DURATIONS:  # compiles
        reference(joint)
        simulated("beams", joint, (2, 4), 4e-6)
    for joint, model in product(DURATIONS, MODELS):
        for n in MESHES[joint]:
            elements, steps = (n, 2 * n), tuple(STEPS[joint])
            if model == "particles":
                limit = longest_step(joint, elements)
                steps = tuple(share * limit for share in SHARES if n > 1)
            for step in steps:
                call = partial(simulated, model, joint, elements, step)
                yield run(model, joint, elements, step, call)


def run(
    method: str,
    joint: Joint,
    elements: Elements,
    step: float,
    call: Call,
    scene: Scene = SCENE,
    **columns: str,
) -> Run:
    """A row of the chart; ``call`` returns a result like `simulated`, compared with `reference`."""
    setting = f"{joint}, {elements[0]} and {elements[1]} elements, step {step:.3g} s"
    return Run(method, setting, call, partial(error, joint, scene), columns)


def simulated(
    model: Model, joint: Joint, elements: Elements, step: float, scene: Scene = SCENE
) -> NDArray[np.float64]:
    """Positions of the slider in m, or time in s and maximum force in N of the first impact."""
    options: dict[str, Any] = {"law": "hertz", "model": model, "elements": elements, "step": step}
    if joint == "ideal joint":
        options |= {"joint": "ideal", "duration": DURATIONS[joint], "outputs": OUTPUTS}
        return simulate(scene, **options).slider_position[1:]
    first = simulate(scene, duration=DURATIONS[joint], outputs=2, **options).impacts.iloc[0]
    return first[["time", "peak_force"]].to_numpy(dtype=float)


def longest_step(joint: Joint, elements: Elements, scene: Scene = SCENE) -> float:
    """Stability limit in s of the step of particles without contact."""
    ideal = joint == "ideal joint"
    end_mass = scene.slider_mass if ideal else 0.0
    return 2 / Frame(scene, elements).highest_frequency(end_mass, held=ideal)


@cache
def reference(joint: Joint, scene: Scene = SCENE) -> NDArray[np.float64]:
    """Reference of `simulated`: particles on a fine mesh."""
    step = SHARES[1] * longest_step(joint, FINEST[joint], scene)
    return simulated("particles", joint, FINEST[joint], step, scene)


def error(joint: Joint, scene: Scene, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """NRMS error of the slider's position, or the relative errors of the first impact."""
    exact = reference(joint, scene)
    if joint == "first impact":
        return np.abs(values / exact - 1)
    start = scene.crank_length + scene.coupler_length
    return np.array([normalised_rms(np.append(start, exact), np.append(start, values))])
