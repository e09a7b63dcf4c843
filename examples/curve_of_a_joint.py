"""Force, stiffness and pressure of your own joint over the penetration depth."""

from study.joint import Joint

joint = Joint(
    socket_radius=12.5e-3,  # m
    clearance=40e-6,
    wall=6e-3,
    ball="bearing steel",
    socket="bronze",
)
curve = joint.curve()

print("depth um   force N   stiffness N/um   pressure MPa")
for k in range(4, len(curve.depth), 10):
    depth, stiffness = 1e6 * curve.depth[k], 1e-6 * curve.stiffness[k]
    pressure = 1e-6 * curve.peak_pressure[k]
    print(f"{depth:8.3f} {curve.force[k]:9.0f} {stiffness:16.0f} {pressure:14.1f}")
