"""Compile the stepping loops once, in set-up: ``python -m study.measure.warm``.

Each kind is compiled by a separate process, all at once. What two of them need is compiled by
both: to wait for each other would take longer.
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
"""What uses the loops of a kind -> a simulation by them of some law, duration and outputs."""


def _compile(kind):
    KINDS[kind](law="hertz", duration=1e-5, outputs=1)


def main() -> None:
    """Simulate a moment of each kind, each in its own process."""
    start = perf_counter()
    print(f"Compiling {', '.join(KINDS)}, once ...", flush=True)
    with ProcessPoolExecutor(len(KINDS), get_context("spawn")) as pool:
        list(pool.map(_compile, KINDS))
    print(f"Compiled in {perf_counter() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main()
