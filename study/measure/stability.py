"""Where explicit steps and impacts fail, predicted and observed.

Most limits have a prediction, in closed form or from the linearised equations, and an observed
value, found by running the method on both sides of it.
"""

from math import inf, sqrt

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from study import checks
from study.contact.forces import elastic_force, pack
from study.contact.laws import find
from study.measure import explicit
from study.measure.limits import bisect
from study.mechanism import (
    MechanismError,
    Scene,
    events,
    particles,
    rigid,
    scene_law,
    simulate,
    stepping,
)
from study.mechanism.frame import Frame
from study.mechanism.response import ALL_COLUMNS

Numbers = NDArray[np.float64]


def packed(scene: Scene, law: str) -> np.record:
    """A law in a scene's joint, for the compiled functions."""
    checks.instance("scene", scene, Scene).has_none_of("crank_clearance")
    options = scene_law.options(scene, find(law), {})
    radii = scene.ball_radius, scene.socket_radius
    return pack(law, *radii, scene.composite_modulus, **options)


def _checked(state):
    state = np.asarray(checks.number("state", state))
    if state.shape != (6,) or not state[1:3].any():
        raise ValueError(f"state must be 6 numbers, of a contact, got {checks.shown(state)}")
    return state


def _contact(scene, law, state):
    """Depth, force, stiffness and 1/mass of the mechanism along normal and tangent of a contact.

    A unit force along the tangent of the ball's surface accelerates the sliding by 1/mass: through
    crank and coupler, a double pendulum, and through the slider (this study, closed form).
    """
    numbers, p, state = packed(scene, law), scene.constants(), _checked(state)
    distance = np.hypot(state[1], state[2])
    nx, ny = state[1:3] / distance
    depth = distance - numbers.clearance
    along = rigid.inverse_effective_mass(state[0], state[2], nx, ny, 0.0, p)
    across = rigid.inverse_effective_mass(state[0], state[2], -ny, nx, p.r1, p)
    return depth, *elastic_force(numbers, depth), along, across


def lasting_contact(scene: Scene, law: str, duration: float) -> Numbers:
    """State of rigid links at the end of a simulation that ends in contact.

    Returns
    -------
    ndarray, shape (6,)
        (theta, e_x, e_y) and their rates, in rad, m and s.
    """
    packed(scene, law)  # checks both
    last = simulate(scene, law=law, duration=duration, outputs=2, tolerance=1e-10).motion.iloc[-1]
    crank, coupler = last.crank_angle, last.coupler_angle
    turns = scene.crank_length * last.crank_speed, scene.coupler_length * last.coupler_speed
    ex = -turns[0] * np.sin(crank) - turns[1] * np.sin(coupler) - last.slider_velocity
    ey = turns[0] * np.cos(crank) + turns[1] * np.cos(coupler)
    return np.array([crank, last.eccentricity_x, last.eccentricity_y, last.crank_speed, ex, ey])


def oscillator(scene: Scene, law: str, state: ArrayLike) -> dict[str, float]:
    """The contact as an oscillator along its normal: m x'' = -P' x - (D P/v0) x'.

    Returns
    -------
    dict
        ``depth`` in m, ``force`` P in N, ``mass`` m of the mechanism along the normal in kg,
        ``frequency`` w = sqrt(P'/m) in rad/s.
    """
    depth, force, stiffness, along, _ = _contact(scene, law, state)
    mass = 1 / along
    return {"depth": depth, "force": force, "mass": mass, "frequency": sqrt(stiffness / mass)}


def _amplification(scheme, w, g):
    """Matrix (2, 2) that a step h of a scheme applies to (x, h x') of h^2 x'' = -w^2 x - g h x'."""
    place, speed = identity = np.eye(2)  # of (x, h x'), each row over both
    pull = np.array([-w * w, -g])
    if scheme in ("symplectic Euler", "lagged"):
        speed = speed + pull
        return np.array([place + speed, speed])
    if scheme == "centred":
        speed = ((1 - g / 2) * speed - w * w * place) / (1 + g / 2)
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
    """Longest stable step of a scheme for x'' = -w^2 x - rate x', in s: spectral radius 1.

    Parameters
    ----------
    frequency, rate
        In rad/s and 1/s.
    """
    checks.choice("scheme", scheme, explicit.SCHEMES)
    checks.number("frequency", frequency, "rad/s", above=0, scalar=True)
    checks.number("rate", rate, "1/s", least=0, scalar=True)

    def unstable(h):
        matrix = _amplification(scheme, h * frequency, h * rate)
        return np.abs(np.linalg.eigvals(matrix)).max() > 1 + 1e-8  # rounding is not instability

    return bisect(unstable, 1e-3 / (frequency + rate), 4 / frequency)


def friction_rate(scene: Scene, law: str, state: ArrayLike) -> float:
    """Rate mu P / ((v1 - v0) m) at which friction slows sliding between v0 and v1, in 1/s.

    m is the mass that a force along the tangent of the ball's surface moves.
    """
    _, force, _, _, across = _contact(scene, law, state)
    return scene.friction * force * across / (scene.full_speed - scene.slow_speed)


def observed_step(
    scene: Scene,
    law: str,
    state: ArrayLike,
    scheme: str,
    approach: float = inf,
    steps: int = 40,
) -> float:
    """Smallest step at which two runs that start side by side diverge, in s.

    Parameters
    ----------
    scheme
        One of `study.measure.explicit.SCHEMES`.
    approach
        Approach speed of the contact, in m/s; inf: not damped.
    steps
        Of each run. Runs diverge if the first difference of their accelerations grows tenfold.
    """
    checks.choice("scheme", scheme, explicit.SCHEMES)
    steps, state = checks.whole("steps", steps, least=2), _checked(state)
    numbers, contact = packed(scene, law), oscillator(scene, law, state)
    rate = scene.damping_factor * contact["force"] / contact["mass"] / approach
    rates = contact["frequency"] + rate
    nx, ny = state[1:3] / np.hypot(state[1], state[2])
    change, slip = contact["depth"] * np.array([nx, ny]), np.array([-ny, nx]) * scene.full_speed
    slip *= scene.friction > 0
    beside = state + 1e-6 * np.array([0, *change, 0, *rates * change + slip])

    def diverge(h):
        options = (steps * h, steps, h * (1 + 1e-9), scheme)  # one step an output, despite rounding
        try:
            runs = [
                explicit.integrate(scene, numbers, *options, start, approach, guarded=False)[0]
                for start in (state, beside)
            ]
        except MechanismError:
            return True
        apart = np.abs(runs[1] - runs[0])
        return not apart.max() < 10 * apart[:2].max()

    if scene.friction > 0:
        rates += friction_rate(scene, law, state)
    return bisect(diverge, 0.1 / rates, 4 / contact["frequency"], 30)


def frame_limits(scene: Scene, elements: tuple[int, int]) -> dict[tuple[str, str], float]:
    """Limits 2/frequency of the explicit step for long chains of particles, in closed form.

    Neighbours that move oppositely along the link have the frequency (2/l) sqrt(EA/m'). The rotary
    inertia is m' l^3/12. Particles that all turn alike, against shear s = 12 EI/(k GA l^2), have
    (12/l^2) sqrt(EI/(m' (1 + s))); neighbours that turn oppositely, in bending, sqrt(48 EI/m')/l^2.
    Limits by link and ``axial``, ``shear`` or ``bending``, in s.
    """
    checks.instance("scene", scene, Scene)
    limits, elements = {}, particles.numbers_of_elements(elements)
    for body, number in zip(("crank", "coupler"), elements, strict=True):
        link = scene.link(body)
        length = link.length / number
        shear = 12 * link.bending / (link.shear * length**2)
        turning = length**2 * sqrt(link.mass_per_length / link.bending)
        limits[body, "axial"] = length * sqrt(link.mass_per_length / link.axial)
        limits[body, "shear"] = turning * sqrt(1 + shear) / 6
        limits[body, "bending"] = turning / sqrt(12)
    return limits


def observed_frame_step(scene: Scene, elements: tuple[int, int], steps: int = 600) -> float:
    """Smallest step at which particles with an ideal joint do not keep their energy, in s."""
    checks.instance("scene", scene, Scene)
    elements, steps = particles.numbers_of_elements(elements), checks.whole("steps", steps, least=2)
    options = {"model": "particles", "joint": "ideal", "method": "unguarded", "outputs": 2}

    def fails(h):
        try:
            run = {"step": h * (1 + 1e-9), "duration": steps * h, "elements": elements}
            return simulate(scene, **options, **run).energy_error > 0.01
        except MechanismError:
            return True

    limit = 2 / Frame(scene, elements).highest_frequency(scene.slider_mass, True)
    return bisect(fails, limit / 2, 2 * limit, 14)


def rigid_steps(
    scene: Scene, law: str, duration: float, tolerance: float = 1e-8
) -> tuple[int, float]:
    """Number of steps that rigid links try in a duration (s), and the loss to friction (J)."""
    checks.number("duration", duration, "s", above=0, scalar=True)
    checks.number("tolerance", tolerance, least=1e-12, most=1e-2, scalar=True)
    numbers = packed(scene, law)
    state, advance = events.stepper(scene, (numbers,), duration, tolerance)
    rows = np.zeros((2, len(ALL_COLUMNS)))
    rows[1, 0] = duration
    advance(rows, *stepping.new_impacts(1000, len(ALL_COLUMNS)))
    return int(state[stepping.STEPS]), rows[1, list(ALL_COLUMNS).index("lost_friction")]


def free_impact(
    factor: float, pull: float = 0.0, depth: float = 0.0, speed: float = 1.0, power: float = 1.5
) -> tuple[float, float]:
    """Contact of a mass, x'' = -x^p (1 + D x') - pull, until the surfaces part.

    Parameters
    ----------
    factor
        Damping factor D over the approach speed.
    pull
        Constant force that drives the surfaces apart.
    depth, speed
        At the start: an impact, or the release of a loaded contact.
    power
        Exponent p.

    Returns
    -------
    separation : float
        Speed at the end.
    tension : float
        Largest tensile force of the contact over the largest compressive one.
    """
    for name, value in (("factor", factor), ("pull", pull), ("depth", depth)):
        checks.number(name, value, least=0, scalar=True)
    limits = {"least": 0} if depth > 0 else {"above": 0}
    checks.number("speed", speed, **limits, scalar=True)
    checks.number("power", power, least=1, most=10, scalar=True)

    def motion(t, y):
        return y[1], -(max(y[0], 0.0) ** power) * (1 + factor * y[1]) - pull

    def parting(t, y):
        return y[0]

    parting.terminal, parting.direction = True, -1
    options = {"method": "LSODA", "rtol": 1e-9, "atol": 1e-12, "max_step": 0.02}
    places, speeds = solve_ivp(motion, (0, 1e3), (depth, speed), events=parting, **options).y
    force = np.maximum(places, 0.0) ** power * (1 + factor * speeds)
    return -speeds[-1], max(-force.min(), 0.0) / force.max()


def event_differences(
    scene: Scene, law: str, change: float, duration: float, share: float = 0.05
) -> pd.DataFrame:
    """Time differences of the same impacts in two runs whose balls start ``change`` (m) apart.

    Returns
    -------
    DataFrame
        Columns ``impact`` from 1, ``time`` and ``difference`` in s; up to the impact where the
        difference reaches a ``share`` of the time between impacts.
    """
    packed(scene, law)  # checks both
    checks.number("share", share, above=0, scalar=True)
    times = []
    for x in (0.0, change):
        moved = scene.replace(initial_eccentricity=(x, 0.0))
        run = simulate(moved, law=law, duration=duration, outputs=2, tolerance=1e-12)
        times.append(run.impacts.time.to_numpy())
    both = min(map(len, times))
    first, second = (t[:both] for t in times)
    difference = np.abs(second - first)
    saturated = difference > share * np.diff(first, prepend=0.0)
    end = np.argmax(saturated) if saturated.any() else both
    table = {"impact": 1 + np.arange(end), "time": first[:end], "difference": difference[:end]}
    return pd.DataFrame(table)
