"""A spherical plain bearing by its name, and one by the numbers of its catalogue.

The load is across the bore, so that the joint is solved at a tilt of 90 deg from its axis.
"""

from study import Joint

bearing = Joint.of(bearing="GE 20 E", play="50um")  # a measured play replaces that of the table
same = Joint.of(
    bore="20mm",
    outer_diameter="35mm",
    inner_width="16mm",
    outer_width="12mm",
    ball_diameter="29mm",
    play="50um",
    socket="bearing steel",
)
assert same == bearing
solution = bearing.solve(force=30e3)  # N, across the bore by default
power = bearing.power_law(bearing.depths_around(solution.depth))  # k and n around this load
print(f"depth {1e6 * solution.depth[0]:.3f} um, peak {1e-6 * solution.peak_pressure[0]:.1f} MPa")
print(f"specific load {1e-6 * solution.specific_load[0]:.1f} MPa")
print(f"k = {power.coefficient:.7g} N/m^n, n = {power.exponent:.7g}, within {power.error:.2%}")
