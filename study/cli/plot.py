"""The figure of study joint --plot: force over depth, and pressure over the polar angle."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from study import paths
from study.pages.figures import STYLE

MICRO, MEGA = 1e-6, 1e6
BEYOND = 1.25  # times the largest depth and half-angle that are shown
SAME_BYTES = {".png": {"Software": None}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


def draw_joint(solution, path):
    """Draw a joint's solved curve, the depths asked for, and the pressure at each, into a file."""
    depths, forces = solution.depth / MICRO, solution.force
    along = np.linspace(0, min(BEYOND * solution.depth.max(), solution.law.deepest), 200)
    widest = min(BEYOND * solution.contact_half_angle_deg.max(), solution.angle_deg[-1])
    with mpl.rc_context(STYLE | {"svg.hashsalt": path.stem}):
        figure = Figure(figsize=(8.4, 3.4))
        left, right = figure.subplots(1, 2)
        left.plot(along / MICRO, solution.law.force(along), color="0.5", label="solved curve")
        for depth, force, pressure in zip(depths, forces, solution.pressure / MEGA, strict=True):
            label = f"{depth:.4g} µm, {float(f'{force:.4g}'):g} N"
            (point,) = left.plot(depth, force, "o", label=label)
            right.plot(solution.angle_deg, pressure, color=point.get_color())
        left.set(xlabel="penetration depth (µm)", ylabel="contact force (N)", xlim=0, ylim=0)
        right.set(xlabel="polar angle (deg)", ylabel="pressure (MPa)", xlim=(0, widest), ylim=0)
        left.legend()
        with paths.whole(path) as temporary:
            figure.savefig(temporary, metadata=SAME_BYTES[path.suffix])
