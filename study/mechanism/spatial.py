"""A spherical clearance joint in space, as a connector of Exudyn (``pip install exudyn``).

`ClearanceJoint` is any law of this study as Exudyn's user function, with Eqs. 30-33 of the paper in
three dimensions. Two examples are in the checkout: ``tests/other_programs/pendulum.py`` hangs a
body on it, ``tests/other_programs/multibody.py`` puts it into the paper's crank-slider.

Another program takes the force P(d) from `study export`. Let e point from the socket's centre to
the ball's, with n = e/abs(e). The depth is d = abs(e) - dR and its rate d' = n . e'. The normal
force on the ball is -N n with N = P(d) (1 + D d'/d0'), where d0' is the rate at the start of this
contact. The sliding velocity v is that of the ball's surface at R1 n, spin included. Friction on
the ball is T = -mu c(abs(v)) N v/abs(v), with the moment R1 n x T.
"""

from math import inf, isnan, nan
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study import checks
from study.contact.damping import Damping, damping_factor
from study.contact.forces import joint_forces, stored_energy
from study.contact.friction import friction_branch
from study.contact.joint_law import JointLaw, pack
from study.contact.laws import LIMIT_MARGIN, AnyLaw

JOINTS = "clearance joints"  # key of an Exudyn system's variables: joints and their connectors
COLUMNS = ["time", "depth", "normal_force", "approach_speed"]
COLUMNS += ["elastic", "lost_damping", "lost_friction"]
"""Of a joint's history: s, m, N, m/s, and energies in J."""
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
        checked = JointLaw(
            law,
            ball_radius=ball_radius,
            socket_radius=socket_radius,
            composite_modulus=composite_modulus,
            **options,
        )
        self.name, self.deepest = checked.name, checked.deepest
        self.law = pack(law, ball_radius, socket_radius, composite_modulus, **options)
        self.ball_radius, self.clearance = ball_radius, self.law.clearance
        self.damping_factor = damping_factor(damping, restitution)
        self.friction = checks.number("friction", friction, least=0, scalar=True)
        full = checks.number("full speed", full_speed, "m/s", above=0, scalar=True)
        slow = checks.number("slow speed", slow_speed, "m/s", least=0, below=full, scalar=True)
        self.speeds = slow, full
        self._begin()

    def _begin(self) -> None:
        """Forget the history."""
        # approach speed, from a contact's first evaluation: inf without approach, NaN in flight
        self.approach = nan
        self.rows: list[tuple[float, ...]] = []
        self._powers = 0.0, 0.0  # lost to damping and friction at the last row

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
        rate = float(velocity @ outwards)
        if isnan(self.approach):
            self.approach = rate if rate > 0 else inf
        arm = self.ball_radius * outwards
        sliding = velocity - rate * outwards + np.cross(spin, arm)
        speed = np.sqrt(sliding @ sliding)
        state = depth, rate, speed, friction_branch(speed, *self.speeds), self.approach
        numbers = self.damping_factor, self.friction, *self.speeds
        normal, _, _, elastic, _, tangential, _, _ = joint_forces(self.law, *state, *numbers)
        drag = tangential / speed * sliding if speed > 0 else np.zeros(3)
        powers = (normal - elastic) * rate, -drag @ sliding
        return drag - normal * outwards, np.cross(arm, drag), normal, *powers

    def connect(self, system: Any, socket: int, ball: int) -> None:
        """Put the joint between two markers of an Exudyn system, at the centres of both.

        Its history begins anew. All joints of a system share its one user function after a step.
        They are in ``system.variables``, which ``system.Reset()`` keeps: take a new system instead.
        Raises ``ValueError`` if the joint is in this system already.
        """
        import exudyn as exu
        from exudyn import itemInterface as item  # noqa: N813

        kind = exu.OutputVariableType
        kinds = kind.DisplacementLocal, kind.VelocityLocal, kind.AngularVelocityLocal

        def force(system, time, number, place, _, velocity, spin, *unused):
            force, torque, *_ = self.forces(*map(np.array, (place, velocity, spin)))
            return [*-force, *-torque]  # Exudyn counts what the connector resists

        def after_a_step(system, time):
            for joint, number in system.variables[JOINTS]:
                joint._note(time, *(np.array(system.GetObjectOutput(number, k)) for k in kinds))
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
            self.approach = nan
        _, _, normal, *powers = self.forces(place, velocity, spin)
        lost = np.zeros(2)
        if self.rows:  # by the trapezoidal rule
            lost = self.rows[-1][-2:] + (time - self.rows[-1][0]) * np.add(powers, self._powers) / 2
        approach = nan if self.approach == inf else self.approach
        self.rows.append((time, depth, normal, approach, stored_energy(self.law, depth), *lost))
        self._powers = powers

    def history(self) -> pd.DataFrame:
        """The joint at the start and after every step, SI units.

        Columns `COLUMNS`. The depth is negative in flight. The approach speed is that of the
        contact that goes on, NaN in flight and where it began without one. What is lost counts
        from t = 0.
        """
        return pd.DataFrame(self.rows, columns=COLUMNS)


def solve(system: Any, settings: Any, **options: Any) -> None:
    """Step an assembled Exudyn system, and pass on the `study.checks.StudyError` of a joint.

    Exudyn raises an error of its own from it, with all calls in the message.
    """
    try:
        system.SolveDynamic(settings, **options)
    except Exception as error:
        if isinstance(error.__cause__, checks.StudyError):
            raise error.__cause__ from None
        raise
