"""Links of particles, integrated explicitly: the finite particle method, as Yao et al. use it.

Each particle has a mass and, per link, a rotary inertia. Plane frame elements between them give
internal forces, found after the element's rigid motion is taken off (vector form intrinsic finite
element; Ting, Shih & Wang, J. Mech. 20 (2004), 113-122). Time is stepped by explicit central
differences (Eq. 29).

The joint's damping and friction take the centred velocity, and the step's forces are solved for.
``lagged`` takes the velocity half a step ago instead. Its step is also limited by the damping
D P/v0, which grows without bound in a sustained contact that began slowly. ``unguarded`` is
``lagged`` without checks of the limits of stability.
"""

from collections import namedtuple
from collections.abc import Iterator
from functools import partial
from math import ceil, hypot, inf, pi, sqrt
from typing import Literal

import numpy as np

from study import checks
from study.compiled import compiled
from study.contact.forces import elastic_force, friction_factor, friction_regime, joint_forces
from study.mechanism import loads, stepping
from study.mechanism.angles import angle_of, direction, norm
from study.mechanism.frame import Array, Elements, Frame, straight_links
from study.mechanism.scene import Scene
from study.mechanism.stepping import JointOutput

Method = Literal["centred", "lagged", "unguarded"]
OWN = "gap", "gap_rate", "slider", "slider_speed", "damping_power", "friction_power"
"""Numbers of the state besides those of all models: the depth at the last step and its mean rate;
position of the slider, and its speed half a step before; rates of the energies lost."""
LANES = 8  # numbers in a processor's widest vector: loops over multiples are compiled to vectors
Chain = namedtuple("Chain", "elements bodies pin last frequency ideal lagged guarded")
"""What does not change: elements and particles as in `Frame`, a row for each quantity; numbers of
the pin and of the last particle; how damping is stepped. The masses in ``bodies``, along x and y,
have the slider of an ideal joint."""
FIXED = 0  # number of the particle, and of its rotation, at the crank's fixed end
AXIS_X, AXIS_Y = range(2)  # columns of places and rates
# Rows of the motion: places and turns at the current time, and their rates half a step before
X, Y, TURN, U, V, SPIN = range(6)
LENGTH0, AXIAL, NEAR, FAR = range(4)  # rows of the elements
MASS_X, MASS_Y, ROTARY, WEIGHT = range(4)  # rows of the bodies
# Rows that a step computes: directions, strains and forces of the elements, the forces one place
# late; forces and moments on the particles, and their rates at the middle of the step
COSINE, SINE, ANGLE, LENGTH, GROWTH, BENT1, BENT2, MOMENT1, MOMENT2, PULL, PUSH = range(11)
FORCE_X, FORCE_Y, MOMENT, MIDDLE_U, MIDDLE_V, MIDDLE_SPIN = range(11, 17)


def stable_step(scene: Scene, elements: Elements) -> float:
    """Stability limit in s of the explicit time step, for a clearance joint without contact."""
    return 2 / Frame(scene, elements).highest_frequency(0.0, held=False)


@compiled
def _internal_forces(motion, elements, bodies, workspace, pin, last, drive):
    """Fill in strains and forces of the elements, and forces and moments on the particles."""
    m, w, size = motion, workspace, elements.shape[1]
    for e in range(size):
        w[COSINE, e], w[SINE, e] = m[X, e + 1] - m[X, e], m[Y, e + 1] - m[Y, e]
    for e in range(size):
        dx, dy, length0 = w[COSINE, e], w[SINE, e], elements[LENGTH0, e]
        length = norm(dx, dy)
        # (l^2 - l0^2) / (l + l0): no cancellation
        w[GROWTH, e] = ((dx - length0) * (dx + length0) + dy * dy) / (length + length0)
        w[LENGTH, e], w[COSINE, e], w[SINE, e] = length, dx / length, dy / length
    for e in range(size):  # the element's rotation; what is left of the particles' bends it
        w[ANGLE, e] = angle_of(w[SINE, e], w[COSINE, e])
    for e in range(last):
        j = e + (e >= pin)
        w[BENT1, e], w[BENT2, e] = m[TURN, j] - w[ANGLE, e], m[TURN, j + 1] - w[ANGLE, e]
    for e in range(size):
        whole = 2 * pi * np.floor((w[BENT1, e] + w[BENT2, e]) / (4 * pi) + 0.5)
        bent1, bent2 = w[BENT1, e] - whole, w[BENT2, e] - whole
        near, far = elements[NEAR, e], elements[FAR, e]
        w[MOMENT1, e], w[MOMENT2, e] = near * bent1 + far * bent2, far * bent1 + near * bent2
        w[BENT1, e], w[BENT2, e] = bent1, bent2
    for e in range(size):
        tension, shear = elements[AXIAL, e] * w[GROWTH, e], w[MOMENT1, e] + w[MOMENT2, e]
        shear /= w[LENGTH, e]
        w[PULL, e + 1] = tension * w[COSINE, e] + shear * w[SINE, e]
        w[PUSH, e + 1] = tension * w[SINE, e] - shear * w[COSINE, e]
    for i in range(bodies.shape[1]):
        w[FORCE_X, i] = 0.0 - w[PULL, i] + w[PULL, i + 1]
        w[FORCE_Y, i] = bodies[WEIGHT, i] - w[PUSH, i] + w[PUSH, i + 1]
    w[FORCE_X, FIXED] = w[FORCE_Y, FIXED] = 0.0  # held
    w[MOMENT, FIXED], w[MOMENT, pin + 1] = drive - w[MOMENT1, FIXED], -w[MOMENT1, pin]
    for e in range(1, pin):
        w[MOMENT, e] = -w[MOMENT2, e - 1] - w[MOMENT1, e]
    for e in range(pin + 1, last):
        w[MOMENT, e + 1] = -w[MOMENT2, e - 1] - w[MOMENT1, e]
    w[MOMENT, pin], w[MOMENT, last + 1] = -w[MOMENT2, pin - 1], -w[MOMENT2, last - 1]


@compiled
def _accelerate(motion, bodies, workspace, h):
    """Step the rates and fill in those at the middle of the step; say if all are finite."""
    wild = 0
    for k in range(3):
        for i in range(bodies.shape[1]):
            change = h * workspace[FORCE_X + k, i] / bodies[k, i]
            middle = motion[U + k, i] + 0.5 * change
            workspace[MIDDLE_U + k, i] = middle
            motion[U + k, i] += change
            wild += not abs(middle) < 1e150
    return wild == 0


@compiled
def _resist(speed, grip, v0, v1):
    """Friction factor at the centred speed v = speed - grip factor(v), and that speed."""
    regime = friction_regime(speed, v0, v1)
    if regime == 0 or grip == 0:
        factor, _ = friction_factor(speed, regime, v0, v1)
        return factor, speed
    size, sign = abs(speed), 1.0 if speed > 0 else -1.0
    slowed = size - grip
    if slowed < v1:
        slowed = (size + grip * v0 / (v1 - v0)) / (1 + grip / (v1 - v0))
    regime = 2 if slowed >= v1 else 1
    factor, _ = friction_factor(slowed, regime, v0, v1)
    return sign * factor, sign * slowed


@compiled
def _meet(gap, rate, rate_before, h):
    """Share of a step at which a gap <= 0 closes, and the approach speed, > 0.

    They are those of a parabola through the last three gaps: ``rate`` is the mean rate of the step,
    which ends above 0, and ``rate_before`` that of the step before.
    """
    growth = (rate - rate_before) / h
    start = rate - 0.5 * h * growth
    approach = sqrt(max(start * start - 2 * growth * gap, 0.0))
    if approach == 0:
        return 1.0, rate
    if start >= 0:
        return -2 * gap / ((start + approach) * h), approach
    return (approach - start) / (growth * h), approach


@compiled
def _follow_gap(state, impacts, depth, h):
    """Begin or end an impact where the depth changes its sign; return the event, -1 for none."""
    rate, event = (depth - state.gap) / h, -1
    if depth <= 0 and state.contact:
        stepping.end_impact(impacts, state, -rate)
        event = stepping.END
    elif depth > 0 and not state.contact:
        part, approach = _meet(state.gap, rate, state.gap_rate, h)
        stepping.begin_impact(impacts, state, state.time - (1 - part) * h, approach)
        event = stepping.START
    state.gap, state.gap_rate = depth, rate
    return event


@compiled
def _joint(ex, ey, depth, load, slider_mass, state, motion, chain, workspace, p, law, h):
    """Forces of the joint as a `JointOutput`, and the limit of the step.

    The depth is > 0; ``workspace`` has the other forces and moments, and ``load`` the slider.
    """
    last = chain.last
    spin, moment = motion[SPIN, last + 1], workspace[MOMENT, last + 1]
    mass, rotary = chain.bodies[MASS_X, last], chain.bodies[ROTARY, last + 1]
    r = norm(ex, ey)
    nx, ny = ex / r, ey / r
    wx, wy = motion[U, last] - state.slider_speed, motion[V, last]
    rate, sliding = wx * nx + wy * ny, wy * nx - wx * ny + p.r1 * spin
    elastic, stiffness = elastic_force(law, depth)
    loss = elastic * p.damping / state.approach
    inverse_mass = 1 / mass + nx * nx / slider_mass
    stiff = chain.frequency**2 + stiffness * inverse_mass
    if chain.lagged:  # (h w)^2 + 2 h c/m < 4
        limit = (sqrt((loss * inverse_mass) ** 2 + 4 * stiff) - loss * inverse_mass) / stiff
        regime = friction_regime(sliding, p.v0, p.v1)
        speeds = rate, sliding, regime, state.approach
        forces = joint_forces(law, depth, *speeds, p.damping, p.friction, p.v0, p.v1)
        normal, tangential = forces.normal, forces.tangential
    else:  # with the forces of this step, which depend on the velocity
        limit = 2 / sqrt(stiff)
        # accelerations of the ball against the slider without the joint's forces
        fnx = workspace[FORCE_X, last] / mass - load.value / slider_mass
        fny = workspace[FORCE_Y, last] / mass
        rate += 0.5 * h * (fnx * nx + fny * ny)
        sliding += 0.5 * h * (fny * nx - fnx * ny + p.r1 * moment / rotary)
        free_rate, free_sliding, both = rate, sliding, 0.5 * h * nx * ny / slider_mass
        side = 1 / mass + ny * ny / slider_mass + p.r1**2 / rotary
        normal = tangential = 0.0
        for _ in range(4):  # normal and tangential force act on each other weakly
            pushed = free_rate - both * tangential
            normal = (elastic + loss * pushed) / (1 + 0.5 * h * loss * inverse_mass)
            rate = pushed - 0.5 * h * inverse_mass * normal
            grip = 0.5 * h * side * p.friction * max(normal, 0.0)
            factor, sliding = _resist(free_sliding + both * normal, grip, p.v0, p.v1)
            tangential = -p.friction * max(normal, 0.0) * factor
    fx, fy = normal * nx + tangential * ny, normal * ny - tangential * nx
    workspace[FORCE_X, last] -= fx
    workspace[FORCE_Y, last] -= fy
    workspace[MOMENT, last + 1] += p.r1 * tangential
    state.damping_power, state.friction_power = (normal - elastic) * rate, -tangential * sliding
    return JointOutput(ex, ey, depth, normal, tangential, fx, fy), limit


@compiled
def _write_output(row, state, motion, speed, pull, chain, workspace, joint, p, h):
    """Fill a row of output, after the step's rates and before its places."""
    m, w, pin, last = motion, workspace, chain.pin, chain.last
    turning = workspace[MOMENT, FIXED] / chain.bodies[ROTARY, FIXED]
    kinetic = stored = 0.0  # of the links, at the middle of the step; and of their strains
    for i in range(1, last + 1):
        for k in range(2):
            kinetic += 0.5 * chain.bodies[k, i] * w[MIDDLE_U + k, i] ** 2
    for j in range(last + 2):
        kinetic += 0.5 * chain.bodies[ROTARY, j] * w[MIDDLE_SPIN, j] ** 2
    for e in range(last):
        stretching = chain.elements[AXIAL, e] * w[GROWTH, e] * w[GROWTH, e]
        bending1, bending2 = w[MOMENT1, e] * w[BENT1, e], w[MOMENT2, e] * w[BENT2, e]
        stored += 0.5 * (stretching + bending1 + bending2)
    if not chain.ideal:
        kinetic += 0.5 * p.m3 * speed * speed
    crank_speed = m[SPIN, FIXED] - 0.5 * h * turning
    work = state.work - loads.on_crank(p, m[TURN, FIXED], crank_speed).energy
    work -= loads.on_slider(p, state.slider, speed).energy
    for i in range(1, last + 1):
        work -= p.gravity * chain.bodies[MASS_X, i] * m[Y, i]
    change = 0.5 * h * workspace[MOMENT, last + 1] / chain.bodies[ROTARY, last + 1]
    row.crank_angle, row.crank_speed = m[TURN, FIXED], crank_speed
    row.crank_acceleration, row.driving_moment = turning, p.moment + state.holding
    row.slider_position, row.slider_velocity, row.slider_acceleration = state.slider, speed, pull
    row.coupler_angle = direction(m[Y, last] - m[Y, pin], m[X, last] - m[X, pin])
    row.coupler_speed = m[SPIN, last + 1] - change
    row.work, row.kinetic, row.elastic = work, kinetic, stored
    row.lost_damping, row.lost_friction = state.lost_damping, state.lost_friction
    stepping.write_joint(row, joint)


@compiled
def advance(state, motion, chain, workspace, p, law, h, strides, rows, impacts, events):
    """Fill ``rows``, ``strides`` steps apart; return the number of rows filled and the ending."""
    (elements, bodies, pin, last, _, ideal, _, _), done, m = chain, 0, motion
    while done < len(rows) and state.steps < state.until:
        if state.impacts == len(impacts):
            return done, stepping.FULL
        state.time = state.steps * h
        # A load at the velocity now, v = u + h/2 a with u half a step before, is linearised: with
        # its value F at u, m a = R + F + F' h/2 a has the solution a = (R + F) / (m - h/2 F').
        on_crank = loads.on_crank(p, m[TURN, FIXED], m[SPIN, FIXED])
        on_slider = loads.on_slider(p, state.slider, state.slider_speed)
        slider_mass = p.m3 - 0.5 * h * on_slider.by_rate
        _internal_forces(m, elements, bodies, workspace, pin, last, on_crank.value)
        if p.steady:  # the crank's fixed end keeps its rate
            state.holding, workspace[MOMENT, FIXED] = -workspace[MOMENT, FIXED], 0.0
        else:
            workspace[MOMENT, FIXED] /= 1 - 0.5 * h * on_crank.by_rate / bodies[ROTARY, FIXED]
        event, largest = -1, False
        if ideal:
            mass = bodies[MASS_X, last]
            heavier = 1 - 0.5 * h * on_slider.by_rate / mass
            workspace[FORCE_X, last] = (workspace[FORCE_X, last] + on_slider.value) / heavier
            fx = slider_mass / mass * workspace[FORCE_X, last] - on_slider.value
            fy = workspace[FORCE_Y, last]
            joint = JointOutput(0.0, 0.0, 0.0, norm(fx, fy), 0.0, fx, fy)
            workspace[FORCE_Y, last] = 0.0
        else:
            ex, ey = m[X, last] - state.slider, m[Y, last]
            depth = norm(ex, ey) - law.clearance
            if not depth <= p.clearance:
                state.limit = p.clearance
                return done, stepping.TOO_DEEP
            joint = JointOutput(ex, ey, depth, 0.0, 0.0, 0.0, 0.0)
            event = _follow_gap(state, impacts, depth, h)
            damped, rubbed = state.damping_power, state.friction_power
            state.damping_power = state.friction_power = 0.0
            if depth > 0:
                joint, limit = _joint(
                    ex, ey, depth, on_slider, slider_mass, state, m, chain, workspace, p, law, h
                )
                if chain.guarded and not h <= limit:  # nor if the limit is no number
                    state.limit = limit
                    return done, stepping.FAILED
            state.lost_damping += 0.5 * h * (damped + state.damping_power)
            state.lost_friction += 0.5 * h * (rubbed + state.friction_power)
            if depth > 0:
                largest = stepping.follow_impact(impacts, state, joint.normal, depth)
        pull = (joint.force_x + on_slider.value) / slider_mass  # the slider's acceleration
        finite = _accelerate(m, bodies, workspace, h)
        state.slider_speed = m[U, last] if ideal else state.slider_speed + h * pull
        speed = state.slider_speed - 0.5 * h * pull
        power = state.holding * m[SPIN, FIXED] + loads.on_slider(p, state.slider, speed).power
        power += loads.on_crank(p, m[TURN, FIXED], workspace[MIDDLE_SPIN, FIXED]).power
        stepping.add_work(state, power, h if state.steps > 0 else 0.0)
        if not (finite and abs(speed) < inf):
            state.limit = 2 / chain.frequency
            return done, stepping.FAILED
        for which in (event, stepping.PEAK if largest else -1):
            if which >= 0:
                row = stepping.event_row(events, state, which)
                _write_output(row, state, m, speed, pull, chain, workspace, joint, p, h)
        if state.steps % strides == 0:
            _write_output(rows[done], state, m, speed, pull, chain, workspace, joint, p, h)
            done += 1
        for k in range(3):
            for i in range(bodies.shape[1]):
                m[X + k, i] += h * m[U + k, i]
        state.slider = m[X, last] if ideal else state.slider + h * state.slider_speed
        state.steps += 1
    return done, stepping.FINE


def blocks(
    scene: Scene,
    law: np.record,
    times: Array,
    ideal: bool,
    step: float | None,
    elements: Elements,
    method: Method,
) -> Iterator[stepping.Block]:
    """Blocks of output rows at equally spaced ``times`` of the scene with links of particles.

    The law is packed; ``ideal`` fixes the ball to the slider. Equal steps of at most ``step`` s
    divide the time between outputs; above the stability limit they are a ``ValueError``, unless
    ``unguarded``. The default is half the limit; in a clearance joint, at a depth of one clearance.
    """
    frame, p = Frame(scene, elements), scene.constants()
    frequency = frame.highest_frequency(scene.slider_mass if ideal else 0.0, ideal)
    start = straight_links(scene, elements, ideal)
    on_crank = loads.on_crank(p, scene.initial_crank_angle, scene.starting_speed)
    on_slider = loads.on_slider(p, *start[-1])
    by_springs = max(-on_crank.by_place, 0.0) / frame.rotaries[FIXED]
    by_springs += max(-on_slider.by_place, 0.0) / scene.slider_mass
    frequency = hypot(frequency, sqrt(by_springs))  # not below that of frame and springs together
    limit = 2 / frequency
    if step is None:
        inverse_mass = 1 / frame.masses[-1] + 1 / scene.slider_mass
        _, stiffness = elastic_force(law, scene.clearance)
        step = 1 / (frequency if ideal else sqrt(frequency**2 + stiffness * inverse_mass))
    checks.number("stability limit", min(limit, 2 * step), "s", least=1e-10 * times[-1])
    strides, h = stepping.divide(times, step)
    if h > limit and method != "unguarded":
        raise ValueError(f"step must be <= {limit:.4g} s, the stability limit, got {step:.4g} s")
    masses, weights = frame.masses.copy(), -scene.gravity * frame.masses
    masses[-1] += scene.slider_mass if ideal else 0.0
    bodies = _filled([masses, masses, frame.rotaries, weights], (1.0, 1.0, 1.0, 0.0))
    rows = [frame.elements[name] for name in ("length", "axial", "near", "far")]
    padded = _filled(rows, (1.0, 0.0, 0.0, 0.0))
    lagged, guarded, last = method != "centred", method != "unguarded", len(frame.elements)
    chain = Chain(padded, bodies, frame.pin, last, frequency, ideal, lagged, guarded)
    state = stepping.new_state(*OWN)
    motion, state.slider, state.slider_speed = _start(
        scene, frame, start, ideal, h, on_crank, on_slider
    )
    workspace, state.step = np.zeros((MIDDLE_SPIN + 1, motion.shape[1])), h
    state.gap = norm(motion[X, last] - state.slider, motion[Y, last]) - scene.clearance
    loop = partial(advance, state, motion, chain, workspace, p, law, h, strides)
    failure = "the step must stay <= {:.4g} s, the stability limit"
    return stepping.advance_in_blocks(loop, times, state, failure)


def _filled(rows, values, more=0):
    """Rows of numbers, padded with their values to whole vectors and ``more`` numbers."""
    size = LANES * ceil(max(map(len, rows)) / LANES) + more
    pairs = zip(rows, values, strict=True)
    return np.array([np.pad(row, (0, size - len(row)), constant_values=v) for row, v in pairs])


def _start(scene, frame, start, ideal, h, on_crank, on_slider):
    """Motion, and the slider's position and speed, at t = 0; rates are those half a step before.

    The joints are at rest, and the links straight: only gravity and the loads accelerate them. They
    are unstrained too, so that a link that turns stretches, and oscillates axially at first.
    """
    places, rates, turns, spins, slide = start
    if scene.crank_speed is None:
        spins[FIXED] -= h / 2 * on_crank.value / frame.rotaries[FIXED]
    slide[1] -= h / 2 * on_slider.value / (scene.slider_mass + (frame.masses[-1] if ideal else 0.0))
    rates[1:, AXIS_Y] += h / 2 * scene.gravity
    rates[-1, AXIS_Y] = 0.0 if ideal else h / 2 * scene.gravity  # the ball is at rest in its socket
    if ideal:
        rates[-1, AXIS_X] = slide[1]
    motion = _filled([*places.T, turns, *rates.T, spins], [0.0] * 6, LANES)
    last = len(places)
    motion[X, last:] = 1 + np.arange(motion.shape[1] - last)  # no two at one place
    return motion, *slide
