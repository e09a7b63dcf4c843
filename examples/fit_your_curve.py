"""Find the law that fits a force-depth curve best, and the clearance of its joint.

The curve in `fit_your_curve.csv` was computed for a joint with a clearance of 44 um, with noise of
40 N and a depth sensor that reads 1.5 um at first touch. The clearance on the drawing is 40 um.
"""

from pathlib import Path

import numpy as np

from study.choose import fit_curve
from study.joint import Joint

table = np.loadtxt(Path(__file__).with_suffix(".csv"), delimiter=",", skiprows=1)
depth, force = 1e-6 * table[:, 0], table[:, 1]  # m, N
drawn = Joint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="bronze")  # m

laws = fit_curve(depth, force, drawn, fit=["clearance", "offset"])
for law in laws.dropna(subset="rmse").itertuples():
    print(f"{law.law}: RMSE {law.rmse:.0f} N, R2 {law.determination:.5f}")

solved = laws[laws.law == "tabulated"].iloc[0]
for name in ("clearance", "offset"):
    error = solved[f"{name}_error"]
    print(f"{name}: {1e6 * solved[name]:.2f} um, standard error {1e6 * error:.2f} um")
