"""Compile the time integration loops, which set-up does once: ``python -m study.mechanism``."""

from time import perf_counter

from study.mechanism import Scene, simulate
from study.mechanism.simulate import Model

KINDS: dict[str, tuple[Scene, Model]] = {
    "rigid links": (Scene(), "rigid"),
    "rigid links with two clearance joints": (Scene(crank_clearance=1e-4), "rigid"),
    "links of particles": (Scene(), "particles"),
    "links of beams": (Scene(), "beams"),
}
"""Kind of loops -> mechanism and model that need them."""


def main() -> None:
    """Simulate a short time with each kind, which compiles what is not compiled yet."""
    for number, (kind, (scene, model)) in enumerate(KINDS.items(), 1):
        start = perf_counter()
        simulate(scene, law="hertz", model=model, duration=1e-5, outputs=1)
        seconds = perf_counter() - start
        print(f"  compiled {kind} ({number} of {len(KINDS)}, {seconds:.0f} s)", flush=True)


if __name__ == "__main__":
    main()
