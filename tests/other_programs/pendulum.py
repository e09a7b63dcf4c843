"""A pendulum in space on a spherical clearance joint, in Exudyn: an example to start from."""

import numpy as np
import pandas as pd

from other_programs.multibody import integration
from study.mechanism.spatial import ClearanceJoint, solve

GRAVITY = 9.81


def pendulum(
    joint: ClearanceJoint,
    *,
    length: float = 0.2,
    mass: float = 0.3,
    tilt: float = 1.0,
    precession: float = 3.0,
    duration: float = 0.02,
    step: float = 2e-6,
) -> pd.DataFrame:
    """Motion, step by step, of a rod in space that hangs by the ball at its end in a fixed socket.

    It starts with the ball in the middle of its socket, tilted from the vertical by ``tilt`` (rad),
    turning about the vertical axis z by ``precession`` (rad/s). Exudyn steps it by the classical
    Runge-Kutta method. Beside the joint's `history` the table has x, y, z of the rod's centre in m;
    kinetic energy and potential (J); spin_z, the angular momentum about the vertical axis in
    kg m^2/s. Raises `study.checks.StudyError` if the depth leaves the law's range.
    """
    settings = integration(duration, step, step)
    import exudyn as exu
    from exudyn import itemInterface as item  # noqa: N813
    from exudyn.utilities import RigidBodyInertia, RotationMatrixY, SensorBody

    system = exu.SystemContainer().AddSystem()
    inertia = mass * length**2 / 12 * np.diag([1.0, 1.0, 0.01])
    turned, top = np.array(RotationMatrixY(tilt)), [0, 0, length / 2]
    centre, spin = turned @ [0, 0, -length / 2], np.array([0, 0, precession])
    body = system.CreateRigidBody(
        inertia=RigidBodyInertia(mass=mass, inertiaTensor=inertia, com=[0, 0, 0]),
        nodeType=exu.NodeType.RotationRotationVector,
        referencePosition=centre,
        referenceRotationMatrix=turned,
        initialVelocity=np.cross(spin, centre),
        initialAngularVelocity=spin,
        gravity=[0, 0, -GRAVITY],
    )
    ground = system.AddObject(item.ObjectGround())
    socket, ball = (
        system.AddMarker(item.MarkerBodyRigid(bodyNumber=number, localPosition=place))
        for number, place in ((ground, [0, 0, 0]), (body, top))
    )
    joint.connect(system, socket, ball)
    kinds = ("Position", "Velocity", "AngularVelocity", "AngularVelocityLocal", "RotationMatrix")
    sensors = [
        system.AddSensor(
            SensorBody(
                bodyNumber=body,
                outputVariableType=getattr(exu.OutputVariableType, kind),
                storeInternal=True,
            )
        )
        for kind in kinds
    ]
    system.Assemble()
    solve(system, settings, solverType=exu.DynamicSolverType.RK44)
    table = joint.history()
    stored = [np.array(system.GetSensorStoredData(sensor))[:, 1:] for sensor in sensors]
    place, velocity, _, local, rotation = stored
    orbital = np.cross(place, mass * velocity)
    about_centre = np.einsum("nij,jk,nk->ni", rotation.reshape(-1, 3, 3), inertia, local)
    kinetic = (mass * (velocity**2).sum(axis=1) + local**2 @ np.diag(inertia)) / 2
    table[["x", "y", "z"]] = place
    table["kinetic"], table["potential"] = kinetic, mass * GRAVITY * place[:, 2]
    table["spin_z"] = (orbital + about_centre)[:, 2]
    return table
