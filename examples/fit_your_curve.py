"""Which law follows a curve of force over depth, and which clearance its joint has.

The curve stands in `fit_your_curve.csv`. It was not measured but made: a joint with a clearance of
44 um, 40 N of noise, and a depth that reads 1.5 um at first touch. The drawing says 40 um.
"""

from pathlib import Path

import numpy as np

from study.choose import fit_curve
from study.joint import DimensionalJoint

table = np.loadtxt(Path(__file__).with_suffix(".csv"), delimiter=",", skiprows=1)
depth, force = 1e-6 * table[:, 0], table[:, 1]  # m, N
drawn = DimensionalJoint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="bronze")  # m

fit = fit_curve(depth, force, drawn, fit=("clearance", "offset"))
for law in fit.laws:
    print(f"{law.law}: RMSE {law.rmse:.0f} N, R2 {law.determination:.5f}")

solved = next(law for law in fit.laws if law.law == "tabulated")
for name, value in solved.parameters.items():
    print(f"{name}: {1e6 * value:.2f} um, standard error {1e6 * solved.standard_errors[name]:.2f}")
