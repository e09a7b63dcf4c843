"""Flexible links: error and computing time of particles, beams, and methods compared with them.

With an ideal joint the position of the slider over 0.1 s is compared. Its acceleration is not
suitable, because the sudden moment excites undamped vibrations of the links, and no mesh reproduces
their phase over so many periods. With clearance the time and the maximum force of the first impact
are compared, because later impacts are chaotic. The reference is the mean of particles and beams on
a mesh that is four times as fine as the finest mesh compared; half of their difference is the
uncertainty of the reference.
"""

from collections.abc import Iterator
from functools import cache, partial
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from study.measure.timing import Call, Run
from study.mechanism import Scene, beams, paper_scene, particles
from study.mechanism.compare import normalised_rms
from study.mechanism.frame import Frame
from study.mechanism.law_in_scene import in_scene

Joint = Literal["ideal joint", "first impact"]
Model = Literal["particles", "beams"]
Elements = tuple[int, int]
MODELS: tuple[Model, Model] = ("particles", "beams")
REFERENCE = "reference"
"""Name of the row whose error is the uncertainty of the reference."""
SCENE = paper_scene()
DURATIONS: dict[Joint, float] = {"ideal joint": 0.1, "first impact": 2e-3}  # s
OUTPUTS = 100  # of the ideal joint
MESHES = {"ideal joint": (1, 2, 4), "first impact": (2, 4, 8, 16)}
"""Numbers of elements of the crank; the coupler has twice as many. Particles need at least two,
because the rotary inertia of a single one is too large."""
STEPS = {"ideal joint": (1e-3, 2e-4, 5e-5, 1e-5), "first impact": (1e-5, 4e-6, 1e-6, 2.5e-7)}
"""Steps of the implicit methods, in s."""
SHARES = (0.95, 0.5)  # fractions of the limit of the explicit step
MOST_CALLS = 101  # of a run: 100 that are timed, and one before
REFINED = 4  # how much finer mesh and implicit step of the reference are than the finest compared


def runs() -> Iterator[Run]:
    """Runs of both models with every mesh and step, and the uncertainty of their reference."""
    for joint, model in product(DURATIONS, MODELS):  # compiles
        simulated(model, joint, (2, 4), 4e-6)
    for joint, model in product(DURATIONS, MODELS):
        for n in MESHES[joint]:
            elements, steps = (n, 2 * n), tuple(STEPS[joint])
            if model == "particles":
                limit = longest_step(joint, elements)
                steps = tuple(share * limit for share in SHARES if n > 1)
            for step in steps:
                call = prepared(model, joint, elements, step)
                yield run(model, joint, elements, step, call)
    for joint in DURATIONS:
        elements, step = finest(joint)
        call = prepared("beams", joint, elements, step)
        yield run(REFERENCE, joint, elements, step, call)


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

    def against_reference(values):
        return error(joint, reference(joint, scene), values)

    return Run(method, setting, call, against_reference, columns)


def simulated(
    model: Model, joint: Joint, elements: Elements, step: float, scene: Scene = SCENE
) -> NDArray[np.float64]:
    """Positions of the slider in m, or time in s and maximum force in N of the first impact."""
    return prepared(model, joint, elements, step, scene, calls=1)()


def prepared(
    model: Model,
    joint: Joint,
    elements: Elements,
    step: float,
    scene: Scene = SCENE,
    calls: int = MOST_CALLS,
) -> Call:
    """A function that returns the result of `simulated`, and can be called several times.

    Masses and stiffnesses are assembled here, so that only the time integration is timed: in a
    short run they would take most of the time.
    """
    law, ideal = in_scene(scene, "hertz").packed(), joint == "ideal joint"
    times = np.linspace(0, DURATIONS[joint], (OUTPUTS if ideal else 2) + 1)
    assemble = partial(beams.blocks, scene, law, times, ideal, step, elements)
    if model == "particles":
        assemble = partial(particles.blocks, scene, law, times, ideal, step, elements, "centred")
    ready = [assemble() for _ in range(calls)]

    def integrate():
        for rows, impacts, _ in ready.pop():  # noqa: B007
            pass
        if ideal:
            return rows["slider_position"][1:].copy()
        return np.array([impacts["time"][0], impacts["peak_force"][0]])

    return integrate


def longest_step(joint: Joint, elements: Elements, scene: Scene = SCENE) -> float:
    """Stability limit in s of the step of particles without contact."""
    ideal = joint == "ideal joint"
    end_mass = scene.slider_mass if ideal else 0.0
    return 2 / Frame(scene, elements).highest_frequency(end_mass, held=ideal)


def finest(joint: Joint) -> tuple[Elements, float]:
    """Elements of the reference, and its step in s with beams."""
    n = REFINED * max(MESHES[joint])
    return (n, 2 * n), min(STEPS[joint]) / REFINED


@cache
def reference(joint: Joint, scene: Scene = SCENE) -> NDArray[np.float64]:
    """Reference of `simulated`: the mean of both models on the finest mesh, so that none is exact.

    The error of the beams on this mesh is half of the difference of the two.
    """
    elements, step = finest(joint)
    explicit = SHARES[1] * longest_step(joint, elements, scene)
    of_particles = simulated("particles", joint, elements, explicit, scene)
    return (of_particles + simulated("beams", joint, elements, step, scene)) / 2


def error(
    joint: Joint, exact: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """NRMS error of the slider's position, or the relative errors of the first impact."""
    if joint == "first impact":
        return np.abs(values / exact - 1)
    start = SCENE.crank_length + SCENE.coupler_length
    return np.array([normalised_rms(np.append(start, exact), np.append(start, values))])
