"""Depth under one force of 100 joints with random clearances within a tolerance.

The first argument is the file for the plot.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from study.joint import Joint

FORCE, COUNT = 3000.0, 100  # N
clearances = np.random.default_rng(1).uniform(30e-6, 50e-6, COUNT)  # m
sizes = {"socket_radius": 12.5e-3, "wall": 6e-3, "socket": "bronze"}  # m
joints = [Joint(clearance=clearance, **sizes) for clearance in clearances]
depths = [1e6 * float(joint.law("stiffened_hertz").depth(FORCE)) for joint in joints]

folder = Path(tempfile.gettempdir())
file = Path(sys.argv[1]) if len(sys.argv) > 1 else folder / "tolerance_of_the_clearance.png"
figure = Figure(layout="constrained")
axes = figure.subplots()
axes.plot(1e6 * clearances, depths, ".")
axes.set(xlabel="clearance (um)", ylabel=f"depth under {FORCE:g} N (um)")
figure.savefig(file)
print(f"depth under {FORCE:g} N: {min(depths):.3f} to {max(depths):.3f} um")
print(f"standard deviation: {np.std(depths):.3f} um; plot: {file}")
