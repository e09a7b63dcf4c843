"""Exudyn's ANCF cables as flexible links: thin beams with absolute positions and slopes of nodes.

They bend and stretch by any amount, without shear and without rotary inertia of their sections:
the limit of `study.mechanism`'s flexible links for a very large shear stiffness. Exudyn's
generalised alpha method steps them.
"""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from other_programs import multibody
from study.mechanism import Scene

TOLERANCE = 1e-6
"""Of Newton's method. With Exudyn's default, 1e-8, rounding in stiff links makes steps fail."""


def links(scene: Scene, elements: tuple[int, int], ideal: bool) -> tuple[Any, int, int]:
    """Exudyn's system of a scene (`multibody.links`), the slider's node, and the contact's number.

    With an ``ideal`` joint there is no contact, and its number is -1.
    """
    import exudyn as exu
    from exudyn import itemInterface as item  # noqa: N813

    multibody.check(scene)
    s, system = scene, exu.SystemContainer().AddSystem()
    ground, x, ends = system.AddObject(item.ObjectGround()), 0.0, []
    for body, n in (("crank", elements[0]), ("coupler", elements[1])):
        link = s.link(body)
        size = link.length / n
        coordinates = [[x + size * e, 0, 1, 0] for e in range(n + 1)]
        nodes = [
            system.AddNode(item.NodePoint2DSlope1(referenceCoordinates=c)) for c in coordinates
        ]
        cables = [
            system.AddObject(
                item.ObjectANCFCable2D(
                    length=size,
                    massPerLength=link.mass_per_length,
                    bendingStiffness=link.bending,
                    axialStiffness=link.axial,
                    nodeNumbers=list(pair),
                )
            )
            for pair in pairwise(nodes)
        ]
        first = system.AddMarker(item.MarkerBodyRigid(bodyNumber=cables[0]))
        last = item.MarkerBodyRigid(bodyNumber=cables[-1], localPosition=[size, 0, 0])
        ends.append((first, system.AddMarker(last)))
        x += link.length
    slider = system.AddNode(item.NodeRigidBody2D(referenceCoordinates=[x, 0, 0]))
    body = item.ObjectRigidBody2D(mass=s.slider_mass, inertia=1e-4, nodeNumber=slider)
    at_slider = system.AddMarker(item.MarkerBodyRigid(bodyNumber=system.AddObject(body)))
    multibody.slide(system, slider)
    at_ground = system.AddMarker(item.MarkerBodyRigid(bodyNumber=ground))
    (axis, near), (far, ball) = ends
    joints, contact = [(at_ground, axis), (near, far)], -1
    if ideal:
        joints.append((ball, at_slider))
    else:
        contact = multibody.contact(system, s, ball, at_slider)
    for pair in joints:
        system.AddObject(item.ObjectJointRevolute2D(markerNumbers=list(pair)))
    system.AddLoad(item.LoadTorqueVector(markerNumber=axis, loadVector=[0, 0, s.driving_moment]))
    return system, slider, contact


def _settings(duration, step, period):
    settings = multibody.integration(duration, step, period)
    newton = settings.timeIntegration.newton
    newton.relativeTolerance = newton.absoluteTolerance = TOLERANCE
    return settings


def ideal_joint(
    scene: Scene, elements: tuple[int, int], duration: float, outputs: int, step: float
) -> Callable[[], NDArray[np.float64]]:
    """Assembled: a function that steps to the slider's positions at equally spaced times, in m."""
    system, slider, _ = links(scene, elements, ideal=True)
    stored = multibody.sensor(system, slider, "Position")
    system.Assemble()
    settings = _settings(duration, step, duration / outputs)

    def run():
        system.SolveDynamic(settings)
        return system.GetSensorStoredData(stored)[-outputs:, 1]

    return run


def first_impact(
    scene: Scene, elements: tuple[int, int], duration: float, step: float
) -> Callable[[], NDArray[np.float64]]:
    """Assembled: a function that steps to the first impact's start, in s, and peak force, in N."""
    import exudyn as exu
    from exudyn.utilities import SensorObject

    system, _, contact = links(scene, elements, ideal=False)
    kinds = exu.OutputVariableType.Displacement, exu.OutputVariableType.Force
    sensors = [
        system.AddSensor(
            SensorObject(objectNumber=contact, outputVariableType=kind, storeInternal=True)
        )
        for kind in kinds
    ]
    system.Assemble()
    settings, steps = _settings(duration, step, step), round(duration / step)

    def run():
        system.SolveDynamic(settings)
        tables = (system.GetSensorStoredData(sensor)[-steps:] for sensor in sensors)
        (t, *place), (_, *force) = (table.T for table in tables)
        distance = np.linalg.norm(place, axis=0)
        depth = distance - scene.clearance
        begin = np.argmax(depth > 0)
        end = begin + np.argmax(np.append(depth[begin:], -1.0) <= 0)
        part = depth[begin] / (depth[begin] - depth[begin - 1])
        normal = np.abs(np.sum(np.multiply(force, place), axis=0)) / np.maximum(distance, 1e-300)
        return np.array([t[begin] - part * (t[begin] - t[begin - 1]), normal[begin:end].max()])

    return run
