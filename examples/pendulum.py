"""A rod that drops into its socket with clearance, in Exudyn (pip install exudyn).

`ClearanceJoint` is a law of this study as Exudyn's user function, with Eqs. 30-33 of Yao et al. in
three dimensions. Let e point from the socket's centre to the ball's, with n = e/abs(e). The depth
is d = abs(e) - dR and its rate d' = n . e'. The normal force on the ball is -N n with
N = P(d) (1 + D d'/v0), where v0 is the rate at the start of this contact. The sliding velocity v
is that of the ball's surface at R1 n. Friction on the ball is T = -mu c(abs(v)) N v/abs(v), with
the moment R1 n x T.
"""

from math import inf, isnan, nan

import numpy as np

from study.contact import DimensionalLaw
from study.contact.forces import damping_factor, friction_factor, friction_regime
from study.joint import Joint

SPEEDS = 1e-4, 0.01  # m/s: no friction below the first, full friction above the second


class ClearanceJoint:
    """A ball in a socket with clearance, as a connector of Exudyn.

    ``rows`` has time in s, depth in m (negative in flight) and normal force in N after each step.
    """

    def __init__(
        self,
        law: DimensionalLaw,
        restitution: float = 1.0,
        friction: float = 0.0,
        damping: str = "exact",
    ) -> None:
        self.law, self.friction = law, friction
        self.factor = damping_factor(damping, restitution)
        self.approach = nan  # in flight
        self.rows: list[tuple[float, float, float]] = []

    def forces(self, eccentricity, velocity, spin):
        """Force and torque on the ball in N and N m, depth in m and normal force in N.

        ``velocity`` is the rate of the eccentricity, ``spin`` the angular velocity of the ball.
        """
        e, speed, turn = map(np.asarray, (eccentricity, velocity, spin))
        reach = float(np.linalg.norm(e))
        depth = reach - self.law.clearance
        if depth <= 0:
            self.approach = nan
            return np.zeros(3), np.zeros(3), depth, 0.0
        n = e / reach
        rate = float(speed @ n)
        if isnan(self.approach):
            self.approach = rate if rate > 0 else inf
        normal = self.law.force(depth) * (1 + self.factor * rate / self.approach)
        sliding = speed - rate * n + self.law.ball_radius * np.cross(turn, n)
        size = float(np.linalg.norm(sliding))
        fraction, _ = friction_factor(size, friction_regime(size, *SPEEDS), *SPEEDS)
        tangential = -self.friction * max(normal, 0.0) * fraction * sliding / (size or 1.0)
        torque = self.law.ball_radius * np.cross(n, tangential)
        return tangential - normal * n, torque, depth, normal

    def connect(self, system, socket, ball):
        """Put the joint between two markers of a system, at the centres of socket and ball."""
        import exudyn as exu
        from exudyn.itemInterface import ObjectConnectorRigidBodySpringDamper as Connector

        def resisted(system, time, number, place, _, velocity, spin, *unused):
            force, torque, *_ = self.forces(place, velocity, spin)
            return [*-force, *-torque]

        pair = [socket, ball]
        number = system.AddObject(
            Connector(markerNumbers=pair, springForceTorqueUserFunction=resisted)
        )
        kind = exu.OutputVariableType
        kinds = kind.DisplacementLocal, kind.VelocityLocal, kind.AngularVelocityLocal

        def after_a_step(system, time):
            *_, depth, normal = self.forces(*(system.GetObjectOutput(number, k) for k in kinds))
            self.rows.append((time, depth, normal))
            return True

        system.SetPostStepUserFunction(after_a_step)


def main() -> None:
    """Let a rod of 0.2 m fall by the clearance."""
    import exudyn as exu
    from exudyn.itemInterface import MarkerBodyRigid
    from exudyn.utilities import RigidBodyInertia

    length, mass, weight = 0.2, 0.3, 0.3 * 9.81  # m, kg, N
    sizes = Joint(socket_radius=10e-3, clearance=50e-6, wall=5e-3)  # m
    joint = ClearanceJoint(sizes.law(), restitution=0.8, friction=0.1)
    system = exu.SystemContainer().AddSystem()
    inertia = RigidBodyInertia(mass, mass * length**2 / 12 * np.diag([1, 1, 0.01]))
    hung = {"referencePosition": [0, 0, -length / 2], "gravity": [0, 0, -weight / mass]}
    turns = exu.NodeType.RotationRotationVector  # for explicit steps
    rod = system.CreateRigidBody(inertia=inertia, nodeType=turns, **hung)
    socket = system.AddMarker(MarkerBodyRigid(bodyNumber=system.CreateGround()))
    ball = system.AddMarker(MarkerBodyRigid(bodyNumber=rod, localPosition=[0, 0, length / 2]))
    joint.connect(system, socket, ball)
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.endTime, settings.timeIntegration.numberOfSteps = 0.02, 10_000  # s
    settings.solution.file.write = False
    system.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    force = max(normal for *_, normal in joint.rows)
    print(f"largest force: {force:.2f} N, {force / weight:.1f} weights")


if __name__ == "__main__":
    main()
