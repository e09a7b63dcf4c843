"""Compile the time integration loops when the project is set up: ``python -m study.measure.warm``.

Each kind is compiled in a separate process, all at the same time. Functions that two kinds need are
compiled by both, because it would take longer to wait for each other.
"""

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from time import perf_counter

from study.measure import explicit
from study.mechanism.scene import Scene
from study.mechanism.simulate import simulate


def _explicit_steps(law, duration, outputs):
    packed = explicit.packed(Scene(), law)
    explicit.integrate(Scene(), packed, duration, outputs, 1e-6, "RK4")


KINDS: dict[str, Callable[..., object]] = {
    "rigid links": partial(simulate, Scene(), model="rigid"),
    "rigid links with two clearance joints": partial(
        simulate, Scene(crank_clearance=1e-4), model="rigid"
    ),
    "links of particles": partial(simulate, Scene(), model="particles"),
    "links of beams": partial(simulate, Scene(), model="beams"),
    "rigid links by explicit steps": _explicit_steps,
}
"""Kind of loops -> a simulation that needs them, as a function of law, duration and outputs."""


def _compile(kind):
    KINDS[kind](law="hertz", duration=1e-5, outputs=1)


def main() -> None:
    """Simulate a short time with each kind, each in a separate process."""
    start = perf_counter()
    print(f"Compiling {', '.join(KINDS)}, once ...", flush=True)
    with ProcessPoolExecutor(len(KINDS), get_context("spawn")) as pool:
        list(pool.map(_compile, KINDS))
    print(f"Compiled in {perf_counter() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main()
