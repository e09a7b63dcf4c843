"""A rod end: a ball with a bore on a pin, in a ring that is open on both sides.

The load is across the bore, so that the joint is solved at a tilt of 90 deg from its axis.
"""

from study.joint import Joint

rod_end = Joint(
    socket_radius=8.03e-3,  # m; the ball has 16 mm
    clearance=30e-6,  # m, radial
    wall=4e-3,  # m, of the ring
    socket="bronze",
    opening="55:125",  # deg, polar angles of both rims from the axis of the bore
    ball_support="pin:4e-3,12e-3",  # m, radius of the pin and width of the ball
)
solution = rod_end.solve(force=5000)  # N, across the bore by default
power = rod_end.power_law()  # k and n across the bore
print(f"depth {1e6 * solution.depth[0]:.3f} um, peak {1e-6 * solution.peak_pressure[0]:.1f} MPa")
print(f"k = {power.coefficient:.7g} N/m^n, n = {power.exponent:.7g}, within {power.error:.2%}")
