"""Compile the stepping loops once, in set-up: ``python -m study.mechanism.warm``.

Each kind is compiled by a process of its own, as many at once as there are cores. What two of them
need is compiled by both: to wait for each other would take longer.
"""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter

from study.mechanism.scene import Scene
from study.mechanism.simulate import Model, simulate

KINDS: dict[str, tuple[Scene, Model]] = {
    "rigid links with two clearance joints": (Scene(crank_clearance=1e-4), "rigid"),
    "rigid links": (Scene(), "rigid"),
    "links of finite elements": (Scene(), "beams"),
    "links of particles": (Scene(), "particles"),
}
"""Those that take longest come first: the processes then end at about the same time."""


def compile_kind(name: str) -> None:
    """Simulate a moment of a kind, which compiles its loops or loads them from the cache."""
    scene, model = KINDS[name]
    simulate(scene, model=model, duration=1e-5, outputs=1)


def _compile_apart(name):
    """Compile a kind in a process of its own; return the time that it takes, in s."""
    start = perf_counter()
    subprocess.run([sys.executable, "-m", __spec__.name, name], check=True)
    return perf_counter() - start


def main() -> None:
    """Compile every kind, and say how long each took."""
    print(f"Compiling {len(KINDS)} kinds of links, once ...", flush=True)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, seconds in zip(KINDS, pool.map(_compile_apart, KINDS), strict=True):
            print(f"Compiled {name}: {seconds:.1f} s", flush=True)


if __name__ == "__main__":
    if sys.argv[1:]:
        compile_kind(sys.argv[1])
    else:
        main()
