"""Constants k and n of the force k d^n of a joint, and the contact of Adams that uses them."""

from study.export import export
from study.joint import Joint

CLEARANCE, MINIMUM = 40e-6, 2e-6  # m

joint = Joint(12.5e-3, CLEARANCE, wall=6e-3, ball="bearing steel", socket="bronze")

for maximum in (4e-6, 20e-6, 40e-6):  # m
    power = joint.power_law((MINIMUM, maximum))
    print(
        f"{1e6 * MINIMUM:g} to {1e6 * maximum:g} um: k = {power.coefficient_mm:.7g} N/mm^n, "
        f"n = {power.exponent:.7g}, within {100 * power.error:.1f} % of the force"
    )

print(export("power", "adams", joint))
