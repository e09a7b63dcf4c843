"""A spherical clearance joint in Exudyn, for mechanisms in space: an example to start from.

`ClearanceJoint` is any law of this study as Exudyn's user function, with Eqs. 30-33 of the paper in
three dimensions. `pendulum` hangs a body on it, `crank_slider` is the mechanism of
`study.mechanism` in Exudyn.

Another program takes the force P(d) from `study export`. Let e point from the socket's centre to
the ball's, with n = e/abs(e). The depth is d = abs(e) - dR and its rate d' = n . e'. The normal
force on the ball is -N n with N = P(d) (1 + D d'/d0'), where d0' is the rate at the start of this
contact. The sliding velocity v is that of the ball's surface at R1 n, spin included. Friction on
the ball is T = -mu c(abs(v)) N v/abs(v), with the moment R1 n x T.
"""

from math import inf, nan, pi
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study import checks
from study.contact.damping import Damping, damping_factor
from study.contact.forces import elastic_force, pack, stored_energy
from study.contact.friction import friction_branch, friction_factor
from study.contact.joint_law import JointLaw
from study.contact.laws import LIMIT_MARGIN, AnyLaw, find
from study.measure.peers import multibody
from study.mechanism import Scene, scene_law

GRAVITY = 9.81
JOINTS = "clearance joints"  # key of an Exudyn system's variables: joints and their connectors
Vector = NDArray[np.float64]


class ClearanceJoint:
    """A ball in a socket with clearance: the forces on them, and the energy lost.

    The connector acts at both centres. For a socket that turns, its friction leaves out terms of
    the order of clearance over radius; the normal force is exact. A contact without approach at its
    first evaluation is not damped.

    Parameters
    ----------
    ball_radius, socket_radius
        In m.
    composite_modulus
        E*, in Pa.
    law
        As of `study.contact.JointLaw`; ``options`` are the law's.
    restitution, damping
        Damping of Eq. 31, and its rule, as of `study.mechanism.Scene`.
    friction, slow_speed, full_speed
        Friction of Eqs. 32 and 33, its tolerance speeds in m/s.

    Attributes
    ----------
    rows
        A tuple for the start and every step so far, columns as of `history`.

    Raises
    ------
    ValueError
        For a value out of range.
    """

    def __init__(
        self,
        ball_radius: float,
        socket_radius: float,
        composite_modulus: float,
        law: AnyLaw = "hertz",
        *,
        restitution: float = 1.0,
        damping: Damping = "lankarani-nikravesh",
        friction: float = 0.0,
        slow_speed: float = 1e-4,
        full_speed: float = 0.01,
        **options: Any,
    ) -> None:
        radii = {"ball_radius": ball_radius, "socket_radius": socket_radius}
        known = JointLaw(law, **radii, composite_modulus=composite_modulus, **options)
        self.name, self.deepest = known.name, known.deepest
        self.law = pack(law, *radii.values(), composite_modulus, **options)
        self.ball_radius, self.clearance = ball_radius, self.law.clearance
        self.damping_factor = damping_factor(damping, restitution)
        self.friction = checks.number("friction", friction, least=0, scalar=True)
        full = checks.number("full speed", full_speed, "m/s", above=0, scalar=True)
        slow = checks.number("slow speed", slow_speed, "m/s", least=0, below=full, scalar=True)
        self.speeds = slow, full
        self._begin()

    def _begin(self):
        """Forget the history."""
        self.approach: float | None = None  # of the contact that goes on, at its first evaluation
        self.rows: list[tuple[float, ...]] = []
        self._losing = 0.0, 0.0, 0.0  # time of the last row, powers lost to damping and friction

    def forces(self, place: Vector, velocity: Vector, spin: Vector) -> tuple[Any, ...]:
        """Force and torque on the ball in N and N m, normal force, powers lost to each in W.

        ``place`` and ``velocity`` are those of the ball's centre from the socket's, ``spin`` its
        angular velocity; SI units. Raises `study.checks.StudyError` for a depth outside
        the law's range.
        """
        distance = np.sqrt(place @ place)
        depth = distance - self.clearance
        if depth <= 0:
            return np.zeros(3), np.zeros(3), 0.0, 0.0, 0.0
        if not depth <= self.deepest * (1 + LIMIT_MARGIN):
            wanted = f"depth of {self.name} must stay <= {self.deepest:g} m"
            raise checks.StudyError(f"{wanted}, got {depth:g} m")
        outwards = place / distance
        rate = velocity @ outwards
        if self.approach is None:
            self.approach = rate if rate > 0 else inf
        elastic = elastic_force(self.law, depth)[0]
        normal = elastic * (1 + self.damping_factor * rate / self.approach)  # Eq. 31
        arm = self.ball_radius * outwards
        sliding = velocity - rate * outwards + np.cross(spin, arm)
        speed = np.sqrt(sliding @ sliding)
        tangential = np.zeros(3)
        if speed > 0 and normal > 0:  # Eqs. 32 and 33, against the direction of sliding
            share = friction_factor(speed, friction_branch(speed, *self.speeds), *self.speeds)[0]
            tangential = -self.friction * normal * share / speed * sliding
        powers = (normal - elastic) * rate, -tangential @ sliding
        return tangential - normal * outwards, np.cross(arm, tangential), normal, *powers

    def connect(self, system: Any, socket: int, ball: int) -> None:
        """Put the joint between two markers of an Exudyn system, at the centres of both.

        Its history begins anew. All joints of a system share its one user function after a step.
        They are in ``system.variables``, which ``system.Reset()`` keeps: take a new system instead.
        Raises ``ValueError`` if the joint is in this system already.
        """
        import exudyn as exu
        from exudyn import itemInterface as item  # noqa: N813

        kind = exu.OutputVariableType
        seen = kind.DisplacementLocal, kind.VelocityLocal, kind.AngularVelocityLocal

        def force(system, time, number, place, _, velocity, spin, *unused):
            force, torque, *_ = self.forces(*map(np.array, (place, velocity, spin)))
            return [*-force, *-torque]  # Exudyn counts what the connector resists

        def after_a_step(system, time):
            for joint, number in system.variables[JOINTS]:
                joint._note(time, *(np.array(system.GetObjectOutput(number, one)) for one in seen))
            return True

        joints = system.variables.setdefault(JOINTS, [])
        if any(joint is self for joint, _ in joints):
            raise ValueError("joint must be connected once, got it twice in one system")
        connector = item.ObjectConnectorRigidBodySpringDamper(
            markerNumbers=[socket, ball], springForceTorqueUserFunction=force
        )
        joints.append((self, system.AddObject(connector)))
        self._begin()
        system.SetPostStepUserFunction(after_a_step)

    def _note(self, time, place, velocity, spin):
        """Add a row for the state at the end of a step, or at the start."""
        depth = np.sqrt(place @ place) - self.clearance
        if depth <= 0:
            self.approach = None
        _, _, normal, *powers = self.forces(place, velocity, spin)
        before, *powers_before = self._losing
        lost = self.rows[-1][-2:] if self.rows else (0.0, 0.0)
        pairs = zip(lost, powers, powers_before, strict=True)
        lost = tuple(e + (time - before) * (p + q) / 2 for e, p, q in pairs)
        stored = stored_energy(self.law, depth)
        approach = nan if self.approach in (None, inf) else self.approach
        self.rows.append((time, depth, normal, approach, stored, *lost))
        self._losing = time, *powers

    def history(self) -> pd.DataFrame:
        """The joint at the start and after every step, SI units.

        Columns time, depth (negative in flight), normal_force, approach_speed (of the contact that
        goes on; NaN in flight, and where it began without one), elastic, lost_damping and
        lost_friction (J, since t = 0).
        """
        names = ("time", "depth", "normal_force", "approach_speed")
        energies = ("elastic", "lost_damping", "lost_friction")
        return pd.DataFrame(self.rows, columns=[*names, *energies])


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
    Runge-Kutta method.

    Returns
    -------
    pandas.DataFrame
        The joint's `history`, and: x, y, z of the rod's centre in m; kinetic energy and potential
        (J); spin_z, the angular momentum about the vertical axis in kg m^2/s.

    Raises
    ------
    ValueError
        For a value out of range.
    study.checks.StudyError
        If the depth leaves the law's range.
    """
    checks.instance("joint", joint, ClearanceJoint)
    checks.number("length", length, "m", above=0, scalar=True)
    checks.number("mass", mass, "kg", above=0, scalar=True)
    checks.number("tilt", tilt, "rad", least=-2 * pi, most=2 * pi, scalar=True)
    checks.number("precession", precession, "rad/s", least=-1e6, most=1e6, scalar=True)
    settings = multibody.integration(duration, step, step)
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
    multibody.solve(system, settings, solverType=exu.DynamicSolverType.RK44)
    table = joint.history()
    stored = [np.array(system.GetSensorStoredData(one))[:, 1:] for one in sensors]
    place, velocity, _, local, rotation = stored
    of_centre = np.cross(place, mass * velocity)
    own = np.einsum("nij,jk,nk->ni", rotation.reshape(-1, 3, 3), inertia, local)
    kinetic = (mass * (velocity**2).sum(axis=1) + local**2 @ np.diag(inertia)) / 2
    table[["x", "y", "z"]] = place
    table["kinetic"], table["potential"] = kinetic, mass * GRAVITY * place[:, 2]
    table["spin_z"] = (of_centre + own)[:, 2]
    return table


def crank_slider(
    scene: Scene, law: AnyLaw = "hertz", *, duration: float, step: float = 1e-6, **options: Any
) -> pd.DataFrame:
    """The crank-slider of rigid links in Exudyn, by its generalised alpha method.

    Beside the joint's `history` a column ``slider_position``, in m, as of
    `study.mechanism.simulate`. The materials of ``stiffened_hertz`` are the scene's; its
    ``socket_ratio`` must be given. Duration and step in s. Raises `study.checks.StudyError` if the
    depth leaves the law's range.
    """
    settings = multibody.integration(duration, step, step)
    s, (system, at, slider) = scene, multibody.links(scene)
    law = find(law)
    options = scene_law.options(scene, law, options)
    joint = ClearanceJoint(
        s.ball_radius,
        s.socket_radius,
        s.composite_modulus,
        law,
        restitution=s.restitution,
        damping=s.damping,
        friction=s.friction,
        slow_speed=s.slow_speed,
        full_speed=s.full_speed,
        **options,
    )
    joint.connect(system, at("slider", 0), at("coupler", s.coupler_length / 2))
    stored = multibody.sensor(system, slider, "Position")
    system.Assemble()
    multibody.solve(system, settings)
    table = joint.history()
    table["slider_position"] = system.GetSensorStoredData(stored)[:, 1]
    return table
