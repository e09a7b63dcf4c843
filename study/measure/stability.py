"""Limits of methods, above all of explicit steps, predicted and observed.

Most limits have a prediction, in closed form or from the linearised equations, and an observed
value, found by bisection between a value that works and one that fails.
"""

from collections.abc import Callable, Iterable
from math import inf, sqrt

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from study.checks import StudyError
from study.contact.forces import elastic_force
from study.measure import explicit
from study.measure.explicit import EX, EY, THETA, packed
from study.mechanism import MechanismError, Scene, rigid, simulate

Numbers = NDArray[np.float64]


def sustained_contact(scene: Scene, law: str, duration: float) -> Numbers:
    """State of rigid links at the end of a simulation that ends in contact, as of `start_of`."""
    last = simulate(scene, law=law, duration=duration, outputs=2, tolerance=1e-10).motion.iloc[-1]
    crank, coupler = last.crank_angle, last.coupler_angle
    turns = scene.crank_length * last.crank_speed, scene.coupler_length * last.coupler_speed
    ex = -turns[0] * np.sin(crank) - turns[1] * np.sin(coupler) - last.slider_velocity
    ey = turns[0] * np.cos(crank) + turns[1] * np.cos(coupler)
    return np.array([crank, last.eccentricity_x, last.eccentricity_y, last.crank_speed, ex, ey])


def oscillator(scene: Scene, law: str, state: ArrayLike) -> dict[str, float]:
    """The contact as an oscillator along its normal: m x'' = -P' x - (D P/v0) x'.

    A unit force along the tangent of the ball's surface accelerates the sliding by 1/mass: through
    crank and coupler, a double pendulum, and through the slider (this study, closed form).

    The numbers are ``depth`` in m, ``force`` P in N, ``mass`` m of the mechanism along the normal
    in kg, ``frequency`` w = sqrt(P'/m) in rad/s, and ``friction_rate`` mu P / ((v1 - v0) m) in 1/s,
    at which friction slows sliding between v0 and v1, with the mass along the tangent.
    """
    numbers, p = packed(scene, law), scene.constants()
    state = np.asarray(state)
    theta, ex, ey = state[THETA], state[EX], state[EY]
    distance = np.hypot(ex, ey)
    nx, ny = ex / distance, ey / distance
    depth = distance - numbers.clearance
    force, stiffness = elastic_force(numbers, depth)
    mass = 1 / rigid.inverse_effective_mass(theta, ey, nx, ny, 0.0, p)
    slip = rigid.inverse_effective_mass(theta, ey, -ny, nx, p.r1, p)
    grip = scene.friction * force * slip / (scene.full_speed - scene.slow_speed)
    values = depth, force, mass, sqrt(stiffness / mass), grip
    return dict(zip(("depth", "force", "mass", "frequency", "friction_rate"), values, strict=True))


def _amplification(scheme, w, g):
    """Matrix (2, 2) that a step h of a scheme applies to (x, h x') of h^2 x'' = -w^2 x - g h x'."""
    place, speed = identity = np.eye(2)  # of (x, h x'), each row over both
    pull = np.array([-w * w, -g])
    if scheme == "symplectic Euler":
        speed = speed + pull
        return np.array([place + speed, speed])
    if scheme == "velocity Verlet":
        moved = place + speed + pull / 2
        return np.array([moved, speed + (pull - w * w * moved - g * (speed + pull)) / 2])
    system = np.array([speed, pull])
    power = identity + system / 4  # exp(system) to the fourth order
    for order in (3, 2, 1):
        power = identity + system @ power / order
    return power


def step_limit(scheme: str, frequency: float, rate: float = 0.0) -> float:
    """Longest stable step in s of a scheme for x'' = -w^2 x - rate x': spectral radius 1.

    The frequency w is in rad/s, the rate in 1/s.
    """

    def unstable(h):
        matrix = _amplification(scheme, h * frequency, h * rate)
        return np.abs(np.linalg.eigvals(matrix)).max() > 1 + 1e-8  # rounding is not instability

    return bisect(unstable, 1e-3 / (frequency + rate), 4 / frequency)


def observed_step(
    scene: Scene, law: str, state: ArrayLike, scheme: str, approach: float = inf
) -> float:
    """Smallest step in s at which two runs of 40 steps from neighbouring states diverge.

    Runs diverge if the first difference of their accelerations grows tenfold. ``approach`` is the
    approach speed of the contact in m/s; inf means without damping.
    """
    numbers, contact, state = packed(scene, law), oscillator(scene, law, state), np.asarray(state)
    rate = scene.damping_factor * contact["force"] / contact["mass"] / approach
    rates = contact["frequency"] + rate
    nx, ny = np.array([state[EX], state[EY]]) / np.hypot(state[EX], state[EY])
    change, slip = contact["depth"] * np.array([nx, ny]), np.array([-ny, nx]) * scene.full_speed
    slip *= scene.friction > 0
    beside = state + 1e-6 * np.array([0, *change, 0, *rates * change + slip])

    def diverge(h):
        options = (40 * h, 40, h * (1 + 1e-9), scheme)  # one step an output, despite rounding
        try:
            runs = [
                explicit.integrate(scene, numbers, *options, start, approach, guarded=False)
                for start in (state, beside)
            ]
        except MechanismError:
            return True
        first, second = (rows["slider_acceleration"] for rows in runs)
        apart = np.abs(second - first)
        return not apart.max() < 10 * apart[:2].max()

    longest = 4 / contact["frequency"]
    return bisect(diverge, 0.1 / (rates + contact["friction_rate"]), longest, 20)


def table(rows: Iterable[tuple]) -> pd.DataFrame:
    """Table of limits: what fails, condition, predicted and observed limit, unit, reported by."""
    columns = ["what", "condition", "predicted", "observed", "unit", "reported_by"]
    limits, numbers = pd.DataFrame(rows, columns=columns), ["predicted", "observed"]
    limits[numbers] = limits[numbers].map(lambda x: x if isinstance(x, str) else f"{x:.3g}")
    return limits


def bisect(fails: Callable[[float], bool], low: float, high: float, times: int = 40) -> float:
    """Smallest value that fails, from ``low`` to ``high``, both > 0, to 4 digits."""
    ends = low, high
    for _ in range(times):
        middle = sqrt(low * high)
        low, high = (low, middle) if fails(middle) else (middle, high)
    if low in ends or high in ends:
        raise StudyError("no limit was found between {:g} and {:g}".format(*ends))
    return float(f"{high:.4g}")
