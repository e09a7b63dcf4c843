"""Compile the stepping loops once, in set-up: ``python -m study.mechanism.warm``.

Each kind is compiled by a process of its own, all at once. What two of them need is compiled by
both: to wait for each other would take longer.
"""

import subprocess
import sys
from time import perf_counter

from study.mechanism.scene import Scene
from study.mechanism.simulate import Model, simulate

KINDS: dict[str, tuple[Scene, Model]] = {
    "rigid links": (Scene(), "rigid"),
    "rigid links with two clearance joints": (Scene(crank_clearance=1e-4), "rigid"),
    "links of particles": (Scene(), "particles"),
    "links of finite elements": (Scene(), "beams"),
}


def main(*names: str) -> None:
    """Simulate a moment of each kind, here if it is named, else each in its own process."""
    for name in names:
        scene, model = KINDS[name]
        simulate(scene, model=model, duration=1e-5, outputs=1)
    if not names:
        start = perf_counter()
        print(f"Compiling {', '.join(KINDS)}, once ...", flush=True)
        command = [sys.executable, "-m", "study.mechanism.warm"]
        processes = [subprocess.Popen([*command, name]) for name in KINDS]
        codes = [process.wait() for process in processes]
        if any(codes):
            sys.exit("The stepping loops were not compiled; the error stands above")
        print(f"Compiled in {perf_counter() - start:.1f} s", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
