"""Exudyn, a program for multibody dynamics, on the rigid links with their clearance joint.

The joint is Exudyn's own contact of two spheres, or that of ``examples/pendulum.py`` for any law.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.mechanism import Scene
from study.mechanism.law_in_scene import in_scene


def check(scene: Scene) -> None:
    """Raise ``ValueError`` for a scene with features or a start that no system here has."""
    names = "gravity", "initial_eccentricity", "initial_crank_angle", "initial_crank_speed"
    for name in (*names, "crank_speed"):
        if getattr(scene, name) != getattr(Scene, name):
            raise ValueError(f"{name} does not apply to this model; remove it")


def slide(system: Any, node: int) -> None:
    """Keep the slider's node on the slide, unturned."""
    from exudyn import itemInterface as item  # noqa: N813

    fixed = system.AddNode(item.NodePointGround())
    fixed = system.AddMarker(item.MarkerNodeCoordinate(nodeNumber=fixed, coordinate=0))
    for coordinate in (1, 2):
        own = item.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate)
        pair = [fixed, system.AddMarker(own)]
        system.AddObject(item.ObjectConnectorCoordinate(markerNumbers=pair))


def contact(system: Any, scene: Scene, ball: int, socket: int) -> int:
    """Exudyn's own contact of a sphere in a sphere between two markers, with Hertz's law.

    Its restitution is set so that its damping is that of Lankarani and Nikravesh.
    """
    from exudyn import itemInterface as item  # noqa: N813

    s, law = scene, in_scene(scene, "hertz").packed()
    start = [s.clearance, 0, 0, 0]  # the gap must start positive, or the first impact is missed
    data = item.NodeGenericData(initialCoordinates=start, numberOfDataCoordinates=4)
    return system.AddObject(
        item.ObjectContactSphereSphere(
            markerNumbers=[ball, socket],
            nodeNumber=system.AddNode(data),
            spheresRadii=[s.ball_radius, s.socket_radius],
            isHollowSphere1=True,
            contactStiffness=law.scale / s.clearance**1.5,
            contactStiffnessExponent=1.5,
            impactModel=1,
            restitutionCoefficient=1 - (1 - s.restitution**2) / 2,
            contactDamping=0.0,
            dynamicFriction=s.friction,
            frictionProportionalZone=s.full_speed,
        )
    )


def links(scene: Scene) -> tuple[Any, Callable[[str, float], int], int]:
    """Exudyn's system of crank, coupler and slider with its drive, all but the clearance joint.

    Returns the system, a function that makes a marker on a body ("ground", "crank", "coupler" or
    "slider") at a place in m along it from its centre, and the slider's node. A scene must start
    at rest, with concentric ball and links on +x, and have only what this system has; else it is
    a ``ValueError``.
    """
    import exudyn as exu
    from exudyn import itemInterface as item  # noqa: N813

    check(scene)
    s, system = scene, exu.SystemContainer().AddSystem()
    ground = system.AddObject(item.ObjectGround())
    bodies = {}
    for name, mass, inertia, x in (
        ("crank", s.crank_mass, s.inertias[0], s.crank_length / 2),
        ("coupler", s.coupler_mass, s.inertias[1], s.crank_length + s.coupler_length / 2),
        ("slider", s.slider_mass, 1e-4, s.crank_length + s.coupler_length),
    ):
        node = system.AddNode(item.NodeRigidBody2D(referenceCoordinates=[x, 0, 0]))
        body = item.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=node)
        bodies[name] = node, system.AddObject(body)

    def at(body, x):
        number = ground if body == "ground" else bodies[body][1]
        return system.AddMarker(item.MarkerBodyRigid(bodyNumber=number, localPosition=[x, 0, 0]))

    half = s.crank_length / 2, s.coupler_length / 2
    for pair in (("ground", 0, "crank", -half[0]), ("crank", half[0], "coupler", -half[1])):
        markers = [at(*pair[:2]), at(*pair[2:])]
        system.AddObject(item.ObjectJointRevolute2D(markerNumbers=markers))
    slide(system, bodies["slider"][0])
    torque = [0, 0, s.driving_moment]
    system.AddLoad(item.LoadTorqueVector(markerNumber=at("crank", 0), loadVector=torque))
    return system, at, bodies["slider"][0]


def sensor(system: Any, node: int, quantity: str) -> int:
    """Sensor that stores a quantity of a node, such as "Acceleration"."""
    import exudyn as exu
    from exudyn.utilities import SensorNode

    kind = getattr(exu.OutputVariableType, quantity)
    return system.AddSensor(
        SensorNode(nodeNumber=node, outputVariableType=kind, storeInternal=True)
    )


def integration(duration: float, step: float, period: float) -> Any:
    """Exudyn's settings for steps of about a length, with output every ``period``, all in s."""
    import exudyn as exu

    checks.number("step", step, "s", above=0, most=duration, scalar=True)
    settings = exu.SimulationSettings()
    time = settings.timeIntegration
    time.numberOfSteps, time.endTime = round(duration / step), duration
    time.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = period
    time.generalizedAlpha.spectralRadius = 0.9
    time.newton.useModifiedNewton = True
    time.discontinuous.useRecommendedStepSize = False
    return settings


def slider_acceleration(
    scene: Scene, duration: float, outputs: int, step: float
) -> NDArray[np.float64]:
    """Slider's acceleration at equally spaced times, in m/s^2, with Exudyn's own `contact`."""
    system, at, slider = links(scene)
    contact(system, scene, at("coupler", scene.coupler_length / 2), at("slider", 0))
    stored = sensor(system, slider, "Acceleration")
    system.Assemble()
    system.SolveDynamic(integration(duration, step, duration / outputs))
    return system.GetSensorStoredData(stored)[1:, 1]


def crank_slider(
    scene: Scene, joint: Any, *, duration: float, step: float = 1e-6
) -> NDArray[np.float64]:
    """Slider's position, in m, after each step; fills the joint of ``examples/pendulum.py``."""
    settings = integration(duration, step, step)
    system, at, slider = links(scene)
    joint.connect(system, at("slider", 0), at("coupler", scene.coupler_length / 2))
    stored = sensor(system, slider, "Position")
    system.Assemble()
    system.SolveDynamic(settings)
    return system.GetSensorStoredData(stored)[:, 1]


def largest_forces(scene: Scene, duration: float, step: float, after: float) -> NDArray[np.float64]:
    """Maximum normal force in N after a time, and that of the first contact, at ends of steps."""
    import exudyn as exu
    from exudyn.utilities import SensorObject

    system, at, _ = links(scene)
    joint = contact(system, scene, at("coupler", scene.coupler_length / 2), at("slider", 0))
    force = SensorObject(
        objectNumber=joint, outputVariableType=exu.OutputVariableType.Force, storeInternal=True
    )
    stored = system.AddSensor(force)
    system.Assemble()
    system.SolveDynamic(integration(duration, step, step))
    times, *along = system.GetSensorStoredData(stored).T
    normal = np.linalg.norm(along, axis=0) / np.hypot(1, scene.friction)
    first = np.flatnonzero(normal)[0]
    end = first + np.flatnonzero(normal[first:] == 0)[0]
    return np.array([normal[times > after].max(), normal[first:end].max()])
