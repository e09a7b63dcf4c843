"""Compile the stepping loops once, in set-up: ``python -m study.mechanism.warm``."""

from time import perf_counter

from study.mechanism.scene import Scene
from study.mechanism.simulate import Model, simulate

KINDS: dict[str, tuple[Scene, Model]] = {
    "rigid links": (Scene(), "rigid"),
    "rigid links with two clearance joints": (Scene(crank_clearance=1e-4), "rigid"),
    "links of particles": (Scene(), "particles"),
    "links of finite elements": (Scene(), "beams"),
}


def main() -> None:
    """Simulate a moment of every kind, and say what is compiled and how long it took."""
    for name, (scene, model) in KINDS.items():
        print(f"Compiling {name}, once ...", end=" ", flush=True)
        start = perf_counter()
        simulate(scene, model=model, duration=1e-5, outputs=1)
        print(f"{perf_counter() - start:.1f} s")


if __name__ == "__main__":
    main()
