"""Flexible links: error against time of particles, of finite elements, and of Exudyn's ANCF cables.

With an ideal joint the slider's position over 0.1 s is judged. Its acceleration would not do: the
sudden moment makes undamped links ring, and no mesh keeps the phase over so many periods. With
clearance the first impact's time and largest force are judged; later impacts are chaotic. The
reference is particles of a fine mesh. Cables have no shear: theirs has a shear stiffness a
thousand times as large.
"""

from collections.abc import Callable, Iterator
from functools import cache, partial
from importlib.util import find_spec
from itertools import product
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from other_programs import cables

from study.mechanism import Scene, paper_scene, simulate
from study.mechanism.compare import normalised_rms
from study.mechanism.frame import Frame

Joint = Literal["ideal joint", "first impact"]
Elements = tuple[int, int]
METHODS = ("particles", "beams", "ANCF cables")
DURATIONS = {"ideal joint": 0.1, "first impact": 2e-3}  # s
OUTPUTS = 100  # of the ideal joint
FINEST = {"ideal joint": (8, 16), "first impact": (32, 64)}
MESHES = {"ideal joint": (1, 2, 4), "first impact": (2, 4, 8, 16)}
"""Elements of the crank; the coupler has twice as many. Particles need two: one has too much
inertia."""
STEPS = {
    "ideal joint": (1e-3, 2e-4, 5e-5, 1e-5),
    "first impact": (1e-5, 4e-6, 1e-6, 2.5e-7),
}
"""Steps of the implicit methods, in s."""
LONGEST_OF_CABLES = 2e-4  # s; with longer steps Newton's method fails on some meshes
SHARES = (0.95, 0.5)  # of the explicit step's limit


class Run(NamedTuple):
    """One method with one mesh and step: ``call`` returns what ``error`` judges.

    The error has one number, the NRMS of the slider's position, or two, relative ones: of the first
    impact's time and of its largest force.
    """

    joint: Joint
    method: str
    elements: Elements
    step: float
    call: Callable[[], NDArray[np.float64]]
    error: Callable[[NDArray[np.float64]], NDArray[np.float64]]

    @property
    def setting(self) -> str:
        """Joint, mesh and step, in words."""
        n, m = self.elements
        return f"{self.joint}, {n} and {m} elements, step {self.step:.3g} s"


def shear_stiff(scene: Scene) -> Scene:
    """Scene with the same joint and links whose shear stiffness is a thousand times as large."""
    ball, socket = scene.materials
    poisson = (1 + scene.poisson) / 1000 - 1
    return scene.replace(poisson=poisson, ball=ball, socket=socket)


def judged(
    model: Literal["particles", "beams"],
    joint: Joint,
    elements: Elements,
    step: float,
    scene: Scene | None = None,
) -> NDArray[np.float64]:
    """Slider's positions in m, or the first impact's time in s and largest force in N."""
    scene = paper_scene() if scene is None else scene
    options: dict[str, Any] = {"law": "hertz", "model": model, "elements": elements, "step": step}
    if joint == "ideal joint":
        options |= {"joint": "ideal", "duration": DURATIONS[joint], "outputs": OUTPUTS}
        return simulate(scene, **options).slider_position[1:]
    first = simulate(scene, duration=DURATIONS[joint], outputs=2, **options).impacts.iloc[0]
    return first[["time", "peak_force"]].to_numpy(dtype=float)


def longest_step(joint: Joint, elements: Elements, scene: Scene | None = None) -> float:
    """Limit of stability of the particles' step out of contact, in s."""
    scene = paper_scene() if scene is None else scene
    ideal = joint == "ideal joint"
    end_mass = scene.slider_mass if ideal else 0.0
    return 2 / Frame(scene, elements).highest_frequency(end_mass, held=ideal)


@cache
def truth(joint: Joint, shear: bool = True) -> NDArray[np.float64]:
    """Limit of `judged`: particles of a fine mesh, with or without shear."""
    scene = paper_scene() if shear else shear_stiff(paper_scene())
    step = SHARES[1] * longest_step(joint, FINEST[joint], scene)
    return judged("particles", joint, FINEST[joint], step, scene)


def error(joint: Joint, shear: bool, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """NRMS of the slider's position over its change since the start; or two relative errors."""
    exact, scene = truth(joint, shear), paper_scene()
    if joint == "first impact":
        return np.abs(values / exact - 1)
    start = scene.crank_length + scene.coupler_length
    return np.array([normalised_rms(np.append(start, exact), np.append(start, values))])


def runs() -> Iterator[Run]:
    """Every method, mesh and step of the chart; cables where Exudyn is installed."""
    exudyn = find_spec("exudyn") is not None
    methods = [method for method in METHODS if exudyn or method != "ANCF cables"]
    for joint, method in product(DURATIONS, methods):
        for n in MESHES[joint]:
            elements, steps = (n, 2 * n), STEPS[joint]
            if method == "particles":
                limit = longest_step(joint, elements)
                steps = tuple(share * limit for share in SHARES if n > 1)
            elif method == "ANCF cables":
                steps = tuple(step for step in steps if step <= LONGEST_OF_CABLES)
            for step in steps:
                run = call(joint, method, elements, step)
                judge = partial(error, joint, method != "ANCF cables")
                yield Run(joint, method, elements, step, run, judge)


def call(
    joint: Joint, method: str, elements: Elements, step: float
) -> Callable[[], NDArray[np.float64]]:
    """A function without arguments that steps one of `METHODS`; cables are assembled here."""
    if method != "ANCF cables":
        return partial(judged, method, joint, elements, step)
    if joint == "ideal joint":
        return cables.ideal_joint(paper_scene(), elements, DURATIONS[joint], OUTPUTS, step)
    return cables.first_impact(paper_scene(), elements, DURATIONS[joint], step)
