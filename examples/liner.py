"""How much a PTFE liner in a steel socket reduces the stiffness of a joint."""

from dataclasses import replace

from study.joint import Joint

FORCE = 100.0  # N

bare = Joint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="steel")  # m
lined = replace(bare, liner=("0.5e-3,PTFE",))
stiffness = {}
for name, joint in (("bare", bare), ("lined", lined)):
    found = joint.solve(force=FORCE)
    stiffness[name] = found.stiffness[0]
    print(
        f"{name}: {1e-6 * stiffness[name]:.1f} N/um at {1e6 * found.depth[0]:.3f} um, {FORCE:g} N"
    )
print(f"the lined joint has {stiffness['lined'] / stiffness['bare']:.3f} of the stiffness")
