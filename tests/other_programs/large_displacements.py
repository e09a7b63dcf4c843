"""Forces of CalculiX with small and with large displacements, for one published file.

``PYTHONPATH=tests python -m other_programs.large_displacements`` writes
``data/published/large_displacements.csv`` and its hash. It takes about half an hour.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from other_programs import calculix
from study import paths
from study.dataset import store
from study.joint import Joint, reference_joint

FILE = paths.DATA / "published/large_displacements.csv"
DEPTHS = np.array([0.05, 0.1, 0.2, 0.3, 0.4, 0.5])
RESOLUTION = 64
PENALTY = 3000.0  # E*/R2; with 6000 more forces are too small, one of them by 29 %
REMOVED = [
    *(("guided", 20, 0.2), ("guided", 60, 0.05), ("liner", 20, 0.1), ("liner", 20, 0.4)),
    *(("reference", 60, 0.05), ("reference", 200, 0.1), ("soft", 20, 0.1), ("soft", 200, 0.05)),
]
"""Joint, R2* and depth at which the ratio of both forces jumps, because CalculiX ends with a wrong
contact area."""


def joints() -> Iterator[tuple[str, Joint]]:
    """Name and joint of each pair of curves, in the order of the file."""
    for r2_star in (20, 60, 200):
        yield "guided", Joint.from_ratios(r2_star, 1.25)
    held = {"ball_support": "clamped", "rim": "free"}
    for r2_star in (20, 60, 200):
        yield "liner", Joint.from_ratios(r2_star, 1.5, modulus_ratio=0.01, poisson=0.4, **held)
    for r2_star in (10, 20, 60, 200, 600, 2000):
        yield "reference", reference_joint(r2_star)
    for r2_star in (20, 60, 200):
        yield "soft", reference_joint(r2_star, modulus_ratio=0.5)


def curves(name: str, joint: Joint) -> pd.DataFrame:
    """Rows of the file for one joint, at each depth; both bodies have the same Poisson's ratio."""
    small, large = (
        calculix.force_curve(joint, DEPTHS, RESOLUTION, penalty=PENALTY, large=large)
        for large in (False, True)
    )
    columns = {
        "joint": name,
        "r2_star": round(joint.r2_star, 9),
        "socket_ratio": joint.socket_ratio,
        "poisson": joint.materials["ball"].poisson,
        "modulus_ratio": joint.modulus_ratio,
        "ball_support": str(joint.ball_support),
        "rim": str(joint.rim),
        "depth_star": DEPTHS,
        "force_small": small,
        "force_large": large,
    }
    return pd.DataFrame(columns)


def main() -> None:
    """Solve all joints, and write the file and its hash."""
    frame = pd.concat([curves(name, joint) for name, joint in joints()])
    places = zip(frame.joint, frame.r2_star, frame.depth_star, strict=True)
    frame = frame[[place not in REMOVED for place in places]]
    with paths.whole(FILE) as temporary:
        frame.to_csv(temporary, index=False, float_format="%.6g", lineterminator="\n")
    store.write_hashes([FILE])


if __name__ == "__main__":
    main()
