"""Compile the time integration loops, which set-up does once: ``python -m study.mechanism``."""

from time import perf_counter
from typing import get_args

from study.mechanism import Scene, simulate
from study.mechanism.simulate import Model

KINDS = get_args(Model)
"""Models, each with loops of its own."""


def main() -> None:
    """Simulate a short time with each kind, which compiles what is not compiled yet."""
    for number, model in enumerate(KINDS, 1):
        start = perf_counter()
        simulate(Scene(), law="hertz", model=model, duration=1e-5, outputs=1)
        if model == "rigid":
            simulate(Scene(), model=model, joint="ideal", duration=1e-5, outputs=1)
        what = f"links of model {model} ({number} of {len(KINDS)}, {perf_counter() - start:.0f} s)"
        print(f"  compiled {what}", flush=True)


if __name__ == "__main__":
    main()
