"""Compile the stepping loops once, in set-up: ``python -m study.mechanism.warm``.

Each kind is compiled by a process of its own, all at once. What two of them need is compiled by
both: to wait for each other would take longer.
"""

from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from time import perf_counter

from study.mechanism.scene import Scene
from study.mechanism.simulate import Model, simulate

KINDS: dict[str, tuple[Scene, Model]] = {
    "rigid links": (Scene(), "rigid"),
    "rigid links with two clearance joints": (Scene(crank_clearance=1e-4), "rigid"),
    "links of particles": (Scene(), "particles"),
    "links of beams": (Scene(), "beams"),
}


def _compile(kind):
    scene, model = KINDS[kind]
    simulate(scene, model=model, duration=1e-5, outputs=1)


def main() -> None:
    """Simulate a moment of each kind, each in its own process."""
    start = perf_counter()
    print(f"Compiling {', '.join(KINDS)}, once ...", flush=True)
    with ProcessPoolExecutor(len(KINDS), get_context("spawn")) as pool:
        list(pool.map(_compile, KINDS))
    print(f"Compiled in {perf_counter() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main()
