"""A joint as k and n of a force k d^n, and as the contact of Adams that takes them."""

from study.export import export
from study.joint import Joint

CLEARANCE, LEAST = 40e-6, 2e-6  # m

joint = Joint(12.5e-3, CLEARANCE, wall=6e-3, ball="bearing steel", socket="bronze")

for largest in (4e-6, 20e-6, 40e-6):  # m
    power = joint.power_law((LEAST, largest))
    print(
        f"{1e6 * LEAST:g} to {1e6 * largest:g} um: k = {power.coefficient_mm:.4g} N/mm^n, "
        f"n = {power.exponent:.4f}, within {100 * power.error:.1f} % of the force"
    )

print(export("power", "adams", joint))
