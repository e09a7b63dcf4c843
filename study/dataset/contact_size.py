"""The table of half-angle and peak pressure that the report's page of a joint reads.

Like the table of `study.dataset.stiffening_fit`, it has Chebyshev coefficients of joints that are
solved at Chebyshev's places.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study.contact.stiffening import PLACES
from study.dataset.stiffening_fit import DEEPEST, RESOLUTION, at_places, logarithms, table
from study.joint import Joint, whole_curve

COUNTS = {"share": 6, "poisson": 5, "socket_poisson": 4, "socket_ratio": 8, "r2_star": 3}
"""Places of the coordinates of a joint."""
QUANTITIES = ("half_angle", "peak_pressure")
SMALLEST = 5e-4  # coefficient of the table


def parts(socket_poisson: float) -> NDArray[np.float64]:
    """Logarithms at the depths of the table, for the joints with one socket's Poisson's ratio.

    They are of half-angle and of peak pressure over Hertz's sqrt(ds R2/R1) and 2/pi of it. The last
    two axes are quantity and depth, those before them as of `stiffening_fit.logarithms`.
    """
    return logarithms(socket_poisson, COUNTS, _of_joint)


def _of_joint(joint: Joint) -> list[NDArray[np.float64]]:
    curve = whole_curve(joint, DEEPEST, RESOLUTION)
    of_hertz = np.sqrt(curve.depth_star / joint.ball_radius)
    found = np.radians(curve.contact_half_angle_deg), np.pi / 2 * curve.peak_pressure_star
    return [at_places(curve.depth_star, values / of_hertz) for values in found]


def size_table(solved: Sequence[NDArray[np.float64]]) -> pd.DataFrame:
    """Coefficients of both quantities, from `parts` of every Poisson's ratio of the socket."""
    by_quantity = np.reshape(solved, (-1, len(QUANTITIES), len(PLACES))).swapaxes(0, 1)
    tables = {
        name: table(part, (), SMALLEST, COUNTS)
        for name, part in zip(QUANTITIES, by_quantity, strict=True)
    }
    return pd.concat(tables, names=["quantity"]).reset_index("quantity")
