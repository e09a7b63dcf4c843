"""A spherical clearance joint in space, as a connector of Exudyn (``pip install exudyn``).

`ClearanceJoint` is any law of this study as Exudyn's user function, with Eqs. 30-33 of the paper in
three dimensions. Two examples are in the checkout: ``tests/other_programs/pendulum.py`` hangs a
body on it, ``tests/other_programs/multibody.py`` puts it into the paper's crank-slider.

Another program takes the force P(d) from `study export`. Let e point from the socket's centre to
the ball's, with n = e/abs(e). The depth is d = abs(e) - dR and its rate d' = n . e'. The normal
force on the ball is -N n with N = P(d) (1 + D d'/d0'), where d0' is the rate at the start of this
contact. The sliding velocity v is that of the ball's surface at R1 n. Friction on the ball is
T = -mu c(abs(v)) N v/abs(v), with the moment R1 n x T. Its spin s about n has the moment
-mu c(r abs(s)) N r n s/abs(s), with a friction radius r (`study.joint.Solution`). Each is as if it
were alone: a ball that slides and spins at once has less of both.
"""

from collections import namedtuple
from functools import partial
from math import inf, isnan, nan, pi, sqrt
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study import checks
from study.compiled import compiled
from study.contact import DimensionalLaw
from study.contact.damping import Damping, damping_factor, delivered_restitution
from study.contact.forces import joint_forces, stored_energy
from study.contact.friction import friction_factor, friction_regime
from study.contact.laws import LIMIT_MARGIN
from study.joint import Joint

JOINTS = "clearance joints"  # key of an Exudyn system's variables: joints and their connectors
Vector = NDArray[np.float64]
NO_VECTOR = (0.0, 0.0, 0.0)
ONLY = 0  # place of the one law


class JointRow(NamedTuple):
    """A row of a joint's history: s, m, N, m/s, and energies in J."""

    time: float
    depth: float
    normal_force: float
    approach_speed: float
    elastic: float
    lost_damping: float
    lost_friction: float


BallForces = namedtuple(
    "BallForces", "force torque normal lost_damping lost_friction depth approach"
)
"""Forces on a ball in space, powers that are lost, and the state of its joint."""


@compiled
def ball_forces(
    laws, radii, pulls, r1, deepest, step, damping, mu, v0, v1, approach, x, y, z, vx, vy, vz, *spin
):
    """`BallForces` on a ball with eccentricity (x, y, z).

    Friction radii are given at every ``step`` of the depth's root. Arguments after (x, y, z) are
    velocity and angular velocity. An array with the law is faster passed than the law.
    """
    law = laws[ONLY]
    reach = sqrt(x * x + y * y + z * z)
    depth = reach - law.clearance
    if not 0 < depth <= deepest:
        return BallForces(NO_VECTOR, NO_VECTOR, 0.0, 0.0, 0.0, depth, approach)
    (nx, ny, nz), (wx, wy, wz) = (x / reach, y / reach, z / reach), spin
    rate, turning = vx * nx + vy * ny + vz * nz, wx * nx + wy * ny + wz * nz
    if isnan(approach):
        approach = rate if rate > 0 else inf
    sx = vx - rate * nx + r1 * (wy * nz - wz * ny)
    sy = vy - rate * ny + r1 * (wz * nx - wx * nz)
    sz = vz - rate * nz + r1 * (wx * ny - wy * nx)
    speed = sqrt(sx * sx + sy * sy + sz * sz)
    state = depth, rate, speed, friction_regime(speed, v0, v1), approach
    forces = joint_forces(law, *state, damping, mu, v0, v1)
    elastic, drag = forces.elastic, forces.tangential
    normal = forces.normal if pulls else max(forces.normal, 0.0)
    share = drag / speed if speed > 0 else 0.0
    tx, ty, tz = share * sx, share * sy, share * sz

    knot = sqrt(depth) / step
    k = min(int(knot), len(radii) - 2)
    radius = radii[k] + (knot - k) * (radii[k + 1] - radii[k])
    slip = radius * turning
    factor, _ = friction_factor(slip, friction_regime(slip, v0, v1), v0, v1)
    moment = -mu * max(normal, 0.0) * radius * factor
    force = tx - normal * nx, ty - normal * ny, tz - normal * nz
    torque = (
        r1 * (ny * tz - nz * ty) + moment * nx,
        r1 * (nz * tx - nx * tz) + moment * ny,
        r1 * (nx * ty - ny * tx) + moment * nz,
    )
    lost = (normal - elastic) * rate, -drag * speed - moment * turning
    return BallForces(force, torque, normal, *lost, depth, approach)


def _friction_radii(law, joint):
    """Friction radii in spin, in m, at equal steps of the root of the depth; the step; how deep.

    They are those of the joint's solved pressure, and without a joint those of Hertz's.
    """
    if joint is None:
        hertz = 3 * pi / 16 * sqrt(law.ball_radius * law.socket_radius / law.clearance)
        return np.array([0, hertz]), 1.0, law.deepest  # it is linear in the root
    curve = joint.curve()
    roots = np.append(0, np.sqrt(curve.depth))
    table = np.linspace(0, roots[-1], len(roots))
    radii = np.interp(table, roots, np.append(0, curve.friction_radius["spin"]))
    return radii, table[1], min(law.deepest, float(curve.depth[-1]))


class ClearanceJoint:
    """A ball in a socket with clearance: the forces on them, and the energy lost.

    The connector acts at both centres. For a socket that turns, its friction leaves out terms of
    the order of clearance over radius; the normal force is exact. A contact without approach at its
    first evaluation is not damped. A value out of range is a ``ValueError``.

    Parameters
    ----------
    law
        A law of a joint in SI units, or a joint, for a table of its force-depth curve. With
        friction, a law of a `study.joint.Joint` reaches no deeper than that table: the
        joint's solved pressure gives the friction radius. For other laws it is that of Hertz's
        pressure.
    restitution, damping, friction, slow_speed, full_speed
        As of `study.mechanism.Scene`, with speeds in m/s (Eqs. 31-33).
    tension
        Whether the force may pull, as Eq. 31 does where the ball leaves fast, or is 0 there.

    Attributes
    ----------
    delivered_restitution
        Restitution of a free impact with this damping.
    rows
        A `JointRow` for the start and every step so far.
    """

    def __init__(
        self,
        law: DimensionalLaw | Joint,
        *,
        restitution: float = 1.0,
        damping: Damping = "exact",
        friction: float = 0.0,
        slow_speed: float = 1e-4,
        full_speed: float = 0.01,
        tension: bool = False,
    ) -> None:
        factor = damping_factor(damping, restitution)
        mu = checks.number("friction", friction, least=0, scalar=True)
        full = checks.number("full speed", full_speed, "m/s", above=0, scalar=True)
        slow = checks.number("slow speed", slow_speed, "m/s", least=0, below=full, scalar=True)
        pulls = bool(checks.flag("tension", tension))
        if isinstance(law, Joint):
            law = law.law()
        self.law = checks.instance("law", law, DimensionalLaw)
        self.delivered_restitution = delivered_restitution(factor)
        radii, step, self.deepest = _friction_radii(law, law.joint if mu > 0 else None)
        self._packed = law.packed()
        numbers = law.ball_radius, self.deepest * (1 + LIMIT_MARGIN), step, factor, mu, slow, full
        self._on_ball = partial(ball_forces, np.array([self._packed]), radii, pulls, *numbers)
        self._begin()

    def _begin(self) -> None:
        """Forget the history."""
        # approach speed, from a contact's first evaluation: inf without approach, NaN in flight
        self.approach = nan
        self.rows: list[JointRow] = []
        self._powers = 0.0, 0.0  # lost to damping and friction at the last row

    def forces(self, eccentricity: Vector, velocity: Vector, spin: Vector) -> tuple[Any, ...]:
        """Force and torque on the ball in N and N m, normal force, powers lost to each in W.

        ``velocity`` is the rate of the eccentricity, ``spin`` the ball's angular velocity; SI
        units, shape (3,). A depth outside the law's range raises `study.checks.StudyError`.
        """
        found = self._found(eccentricity.tolist(), velocity.tolist(), spin.tolist())
        lost = found.lost_damping, found.lost_friction
        return np.array(found.force), np.array(found.torque), found.normal, *lost

    def _found(self, eccentricity, velocity, spin):
        """What `ball_forces` returns at three vectors, which are lists."""
        found = self._on_ball(self.approach, *eccentricity, *velocity, *spin)
        depth, self.approach = found.depth, found.approach
        if not depth <= self.deepest * (1 + LIMIT_MARGIN):
            wanted = f"penetration depth of law {self.law.name} must stay <= {self.deepest:g} m"
            raise checks.StudyError(f"{wanted}, got {depth:g} m")
        return found

    def _resisted(self, system, time, number, eccentricity, _, velocity, spin, *unused):
        """Exudyn's user function: what the connector resists."""
        found = self._found(eccentricity, velocity, spin)
        return [-x for x in found.force + found.torque]

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

        def after_a_step(system, time):
            for joint, number in system.variables[JOINTS]:
                joint._note(time, *(system.GetObjectOutput(number, k) for k in kinds))
            return True

        joints = system.variables.setdefault(JOINTS, [])
        if any(joint is self for joint, _ in joints):
            raise ValueError("joint must be connected only once in one system, got it twice")
        connector = item.ObjectConnectorRigidBodySpringDamper(
            markerNumbers=[socket, ball], springForceTorqueUserFunction=self._resisted
        )
        joints.append((self, system.AddObject(connector)))
        self._begin()
        system.SetPostStepUserFunction(after_a_step)

    def _note(self, time, *vectors):
        """Add a row for the state at the end of a step, or at the start."""
        found = self._found(*map(list, vectors))
        depth, powers = found.depth, (found.lost_damping, found.lost_friction)
        if depth <= 0:
            self.approach = nan
        lost = np.zeros(2)
        if self.rows:  # by the trapezoidal rule
            last = self.rows[-1]
            lost = (last.lost_damping, last.lost_friction) + (time - last.time) * (
                np.add(powers, self._powers) / 2
            )
        approach = nan if self.approach == inf else self.approach
        energy = stored_energy(self._packed, depth)
        self.rows.append(JointRow(time, depth, found.normal, approach, energy, *lost))
        self._powers = powers

    def history(self) -> pd.DataFrame:
        """The joint at the start and after every step, with the fields of `JointRow`, SI units.

        The depth is negative in flight. The approach speed is that of the contact that goes on, NaN
        in flight and where it began without one. What is lost counts from t = 0.
        """
        return pd.DataFrame(self.rows, columns=JointRow._fields)


def solve(system: Any, settings: Any, **options: Any) -> None:
    """Step an assembled Exudyn system; an error of a joint is raised itself, not Exudyn's own."""
    try:
        system.SolveDynamic(settings, **options)
    except Exception as error:
        if isinstance(error.__cause__, checks.StudyError):
            raise error.__cause__ from None
        raise
