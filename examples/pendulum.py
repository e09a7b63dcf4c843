"""A rod that drops into its socket with clearance, in Exudyn (pip install exudyn)."""

import exudyn as exu
import numpy as np
from exudyn.itemInterface import MarkerBodyRigid
from exudyn.utilities import RigidBodyInertia

from study.joint import Joint
from study.mechanism.spatial import ClearanceJoint, solve

LENGTH, MASS, WEIGHT = 0.2, 0.3, 0.3 * 9.81  # m, kg, N

sizes = Joint(socket_radius=10e-3, clearance=50e-6, wall=5e-3)  # m
joint = ClearanceJoint(sizes, restitution=0.8, friction=0.1)
system = exu.SystemContainer().AddSystem()
inertia = RigidBodyInertia(MASS, MASS * LENGTH**2 / 12 * np.diag([1, 1, 0.01]))
hung = {"referencePosition": [0, 0, -LENGTH / 2], "gravity": [0, 0, -WEIGHT / MASS]}
turns = exu.NodeType.RotationRotationVector  # for explicit steps
rod = system.CreateRigidBody(inertia=inertia, nodeType=turns, **hung)
socket = system.AddMarker(MarkerBodyRigid(bodyNumber=system.CreateGround()))
ball = system.AddMarker(MarkerBodyRigid(bodyNumber=rod, localPosition=[0, 0, LENGTH / 2]))
joint.connect(system, socket, ball)
system.Assemble()

settings = exu.SimulationSettings()
settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = 0.02, 10_000  # s
settings.solution.file.write = False
solve(system, settings, solverType=exu.DynamicSolverType.RK44)
force = joint.history().normal_force
print(f"largest force: {force.max():.2f} N, {force.max() / WEIGHT:.1f} weights")
