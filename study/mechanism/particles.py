"""The finite particle method, the paper's own: flexible links as particles that follow Newton.

Each particle has a mass and, per link, a rotary inertia; plane frame elements between them
give internal forces, found after the element's rigid motion is taken off (vector form
intrinsic finite element; Ting, Shih & Wang, J. Mech. 20 (2004), 113-122). Time is stepped by
explicit central differences (Eq. 29). In the damping and friction of the joint the velocity is
the centred one, which the forces of the step are solved for, or the one half a step ago
(``lagged``); ``unguarded`` is the latter without the checks of the limits of stability.
"""

from collections import namedtuple
from collections.abc import Iterator
from functools import partial
from math import inf, pi, sqrt
from typing import Literal

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from study import checks
from study.compiled import compiled
from study.contact.forces import elastic_force, joint_forces
from study.contact.friction import friction_branch, friction_factor
from study.mechanism import stepping
from study.mechanism.angles import angle_of, direction, norm, sine_cosine
from study.mechanism.scene import Link, Scene

Method = Literal["centred", "lagged", "unguarded"]
GAP, GAP_RATE, DRIVE_WORK, DRIVE_POWER = range(4)  # places in the state, before all models' own


System = namedtuple("System", "elements masses rotaries pin frequency ideal lagged guarded")
"""What does not change: elements and particles as in `Frame`, and how damping is stepped."""
Motion = namedtuple("Motion", "places rates turns spins slide")
"""Places (x, y) and turns at the current time, their rates half a step before it; ``slide`` is
(x, x') of the slider."""


def lump(link: Link, elements: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Particles of one link: masses in kg, rotary inertias of the half elements at each in kg m^2.

    With two or more elements a little of each end's mass goes to its neighbour, so that mass,
    centre and moment of inertia of the link are exact: stiff links then move as the rigid ones
    at any number of elements. A single element has its mass at its ends, and too much inertia.
    """
    length = link.length / elements
    halves = np.full(elements + 1, 2.0)
    halves[[0, -1]] = 1.0
    masses = halves / 2
    if elements > 1:
        shift = elements / (8 * (elements - 1))
        masses[[0, -1]] -= shift
        masses[1] += shift
        masses[-2] += shift
    rotary = link.mass_per_length * length**3 / 24 + link.rotary_per_length * length / 2
    return link.mass_per_length * length * masses, rotary * halves


class Frame:
    """Particles and elements of both links, laid out on +x.

    Particle 0 is the crank's fixed end, ``pin`` the one that both links share, the last one
    the ball. Rotations are counted per link, so that the pin has two. A row of ``elements`` has
    length (m), axial stiffness (N/m), and the bending stiffnesses that tie the moment at an end
    to the rotations of the near and the far end (N m).
    """

    def __init__(self, scene: Scene, elements: tuple[int, int]) -> None:
        links, rows = (scene.link("crank"), scene.link("coupler")), []
        for link, n in zip(links, elements, strict=True):
            length = link.length / n
            shear = 12 * link.bending / (link.shear * length**2)
            bending = link.bending / (length * (1 + shear))
            row = length, link.axial / length, (4 + shear) * bending, (2 - shear) * bending
            rows += [row] * n
        self.elements = np.array(rows)
        (m1, j1), (m2, j2) = (lump(link, n) for link, n in zip(links, elements, strict=True))
        self.pin = elements[0]
        self.masses = np.concatenate([m1[:-1], [m1[-1] + m2[0]], m2[1:]])
        self.rotaries = np.concatenate([j1, j2])

    def highest_frequency(self, end_mass: float, held: bool) -> float:
        """Highest natural frequency of the straight frame, in rad/s.

        ``end_mass``, in kg, is added to the last particle along the slide, where it is ``held``.
        """
        turns, size = 2 * len(self.masses), 3 * len(self.masses) + 1
        stiffness, mass = np.zeros((size, size)), np.zeros(size)
        for e, (length, axial, near, far) in enumerate(self.elements):
            along, turn = [2 * e, 2 * e + 2], turns + e + (e >= self.pin)
            bent = [2 * e + 1, 2 * e + 3, turn, turn + 1]
            strain = np.array([[1 / length, -1 / length, 1, 0], [1 / length, -1 / length, 0, 1]])
            stiffness[np.ix_(along, along)] += axial * np.array([[1, -1], [-1, 1]])
            stiffness[np.ix_(bent, bent)] += strain.T @ [[near, far], [far, near]] @ strain
        mass[:turns] = np.repeat(self.masses, 2)
        mass[turns:] = self.rotaries
        mass[turns - 2] += end_mass
        free = np.delete(np.arange(size), [0, 1, turns - 1] if held else [0, 1])
        root = np.sqrt(mass[free])
        scaled = stiffness[np.ix_(free, free)] / np.outer(root, root)
        return sqrt(scipy.linalg.eigvalsh(scaled)[-1])


def numbers_of_elements(pair: tuple[int, int]) -> tuple[int, int]:
    """Return the numbers of elements of crank and coupler, or raise ``ValueError``."""
    if not isinstance(pair, (tuple, list)) or len(pair) != 2:
        shown = checks.shown(pair)
        raise ValueError(f"elements must be two numbers, of crank and coupler, got {shown}")
    crank, coupler = (checks.whole("elements", n, least=1, most=500) for n in pair)
    return crank, coupler


def stable_step(scene: Scene, elements: tuple[int, int]) -> float:
    """Limit of stability of the explicit step with a clearance joint out of contact, in s."""
    checks.instance("scene", scene, Scene)
    elements = numbers_of_elements(elements)
    return 2 / Frame(scene, elements).highest_frequency(0.0, held=False)


def usual_step(scene: Scene, law: np.record, elements: tuple[int, int]) -> float:
    """Half the limit of stability with a clearance joint at a depth of one clearance, in s."""
    frame = Frame(scene, elements)
    ease = 1 / frame.masses[-1] + 1 / scene.slider_mass
    stiffest = elastic_force(law, scene.clearance)[1] * ease
    return 1 / sqrt(frame.highest_frequency(0.0, held=False) ** 2 + stiffest)


@compiled
def _internal_forces(places, turns, elements, pin, forces, moments):
    """Subtract the elements' forces on particles and return the strain energy."""
    energy = 0.0
    for e in range(len(elements)):
        length0, axial, near, far = elements[e]
        dx, dy = places[e + 1, 0] - places[e, 0], places[e + 1, 1] - places[e, 1]
        length = norm(dx, dy)
        c, s = dx / length, dy / length
        rigid = angle_of(s, c)  # the element's rotation; what is left of the particles' bends it
        j = e + (1 if e >= pin else 0)
        bent1, bent2 = turns[j] - rigid, turns[j + 1] - rigid
        whole = 2 * pi * round((bent1 + bent2) / (4 * pi))
        bent1 -= whole
        bent2 -= whole
        # (l^2 - l0^2) / (l + l0): no cancellation
        stretch = ((dx - length0) * (dx + length0) + dy * dy) / (length + length0)
        tension = axial * stretch
        moment1, moment2 = near * bent1 + far * bent2, far * bent1 + near * bent2
        shear = (moment1 + moment2) / length
        fx, fy = tension * c + shear * s, tension * s - shear * c
        forces[e, 0] += fx
        forces[e, 1] += fy
        forces[e + 1, 0] -= fx
        forces[e + 1, 1] -= fy
        moments[j] -= moment1
        moments[j + 1] -= moment2
        energy += 0.5 * (tension * stretch + moment1 * bent1 + moment2 * bent2)
    return energy


@compiled
def _resist(speed, grip, v0, v1):
    """Friction factor at the centred speed v = speed - grip factor(v), and that speed."""
    branch = friction_branch(speed, v0, v1)
    if branch == 0 or grip == 0:
        return friction_factor(speed, branch, v0, v1)[0], speed
    size, sign = abs(speed), 1.0 if speed > 0 else -1.0
    slowed = size - grip
    if slowed < v1:
        slowed = (size + grip * v0 / (v1 - v0)) / (1 + grip / (v1 - v0))
    branch = 2 if slowed >= v1 else 1
    return sign * friction_factor(slowed, branch, v0, v1)[0], sign * slowed


@compiled
def _meet(gap, rate, rate_before, h):
    """When in a step, as part of it, a gap <= 0 closes, and the approach speed, > 0.

    ``rate`` is the mean one of the step, which ends above 0, ``rate_before`` that of the step
    before: a parabola through the last three gaps.
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
    """Begin or end an impact where the depth has changed its sign; which of them, -1 for none."""
    rate, event = (depth - state[GAP]) / h, -1
    if depth <= 0 and state[stepping.CONTACT] > 0:
        stepping.end_impact(impacts, state, -rate)
        event = stepping.END
    elif depth > 0 and state[stepping.CONTACT] == 0:
        part, approach = _meet(state[GAP], rate, state[GAP_RATE], h)
        stepping.begin_impact(impacts, state, state[stepping.TIME] - (1 - part) * h, approach)
        event = stepping.START
    state[GAP], state[GAP_RATE] = depth, rate
    return event


@compiled
def _joint(place, state, motion, system, acting, p, law, h):
    """Normal and tangential force of the step, powers lost to each, and the limit of the step.

    ``place`` is the ball's eccentricity and depth, > 0, ``acting`` the other forces and moments.
    """
    (ex, ey, depth), (forces, moments) = place, acting
    last, spin = len(system.masses) - 1, motion.spins[-1]
    mass, rotary = system.masses[last], system.rotaries[-1]
    r = norm(ex, ey)
    nx, ny = ex / r, ey / r
    wx, wy = motion.rates[last, 0] - motion.slide[1], motion.rates[last, 1]
    rate, sliding = wx * nx + wy * ny, wy * nx - wx * ny + p.r1 * spin
    elastic, stiffness = elastic_force(law, depth)
    loss = elastic * p.damping / state[stepping.APPROACH]
    ease = 1 / mass + nx * nx / p.m3
    stiff = system.frequency**2 + stiffness * ease
    if system.lagged:  # (h w)^2 + 2 h c/m < 4
        limit = (sqrt((loss * ease) ** 2 + 4 * stiff) - loss * ease) / stiff
        branch = friction_branch(sliding, p.v0, p.v1)
        given = rate, sliding, branch, state[stepping.APPROACH], p.damping, p.friction, p.v0, p.v1
        found = joint_forces(law, depth, *given)
        normal, tangential = found[0], found[5]
    else:  # with the forces of this step, which depend on it
        limit = 2 / sqrt(stiff)
        fnx, fny = forces[last, 0] / mass, forces[last, 1] / mass
        rate += 0.5 * h * (fnx * nx + fny * ny)
        sliding += 0.5 * h * (fny * nx - fnx * ny + p.r1 * moments[-1] / rotary)
        free_rate, free_sliding, both = rate, sliding, 0.5 * h * nx * ny / p.m3
        side = 1 / mass + ny * ny / p.m3 + p.r1**2 / rotary
        normal = tangential = 0.0
        for _ in range(4):  # normal and tangential force act on each other weakly
            pushed = free_rate - both * tangential
            normal = (elastic + loss * pushed) / (1 + 0.5 * h * loss * ease)
            rate = pushed - 0.5 * h * ease * normal
            grip = 0.5 * h * side * p.friction * max(normal, 0.0)
            factor, sliding = _resist(free_sliding + both * normal, grip, p.v0, p.v1)
            tangential = -p.friction * max(normal, 0.0) * factor
    fx, fy = normal * nx + tangential * ny, normal * ny - tangential * nx
    forces[last, 0] -= fx
    forces[last, 1] -= fy
    moments[-1] += p.r1 * tangential
    state[stepping.LOST_DAMPING] += h * (normal - elastic) * rate
    state[stepping.LOST_FRICTION] -= h * tangential * sliding
    return (normal, tangential, fx, fy), limit


@compiled
def _accelerate(motion, system, acting, end_mass, steady, h):
    """Step the rates and return the kinetic energy at the middle of the step.

    At constant crank speed, ``steady``, the crank's fixed end turns as it did.
    """
    masses, rotaries, (forces, moments) = system.masses, system.rotaries, acting
    last, kinetic = len(masses) - 1, 0.0
    for i in range(1, last + 1):
        mass = end_mass if i == last else masses[i]
        for n in range(1 if system.ideal and i == last else 2):
            change = h * forces[i, n] / mass
            kinetic += 0.5 * mass * (motion.rates[i, n] + 0.5 * change) ** 2
            motion.rates[i, n] += change
    for j in range(len(rotaries)):
        change = 0.0 if steady and j == 0 else h * moments[j] / rotaries[j]
        kinetic += 0.5 * rotaries[j] * (motion.spins[j] + 0.5 * change) ** 2
        motion.spins[j] += change
    return kinetic


@compiled
def _drive(state, power, h):
    """Add the work of a drive since the step before, by the powers at both."""
    if state[stepping.STEPS] > 0:
        state[DRIVE_WORK] += 0.5 * h * (state[DRIVE_POWER] + power)
    state[DRIVE_POWER] = power


@compiled
def _record(row, state, motion, system, acting, joint, p, h, strain, kinetic):
    """Fill a row of output, after the step's rates and before its places."""
    places, _, turns, spins, _ = motion
    (_, moments), (place, forces, slider), pin = acting, joint, system.pin
    last, turning, drive = len(places) - 1, moments[0] / system.rotaries[0], p.moment
    if p.steady:
        turning, drive = 0.0, -moments[0]
    work = state[DRIVE_WORK] + p.moment * turns[0]
    for i in range(1, last + 1):
        work -= p.gravity * system.masses[i] * places[i, 1]
    crank = turns[0], spins[0] - 0.5 * h * turning, turning, drive
    along, across = places[last, 0] - places[pin, 0], places[last, 1] - places[pin, 1]
    coupler = direction(across, along), spins[-1] - 0.5 * h * moments[-1] / system.rotaries[-1]
    lost = state[stepping.LOST_DAMPING], state[stepping.LOST_FRICTION]
    energies = work, kinetic, strain, *lost
    stepping.record(row, crank, slider, coupler, place, forces, energies)


@compiled
def advance(state, motion, system, p, law, h, strides, rows, impacts, events):
    """Fill ``rows``, ``strides`` steps apart; return the number of rows filled and the ending."""
    places, rates, turns, spins, slide = motion
    masses, ideal = system.masses, system.ideal
    last, done = len(masses) - 1, 0
    acting = forces, moments = np.zeros_like(places), np.zeros_like(turns)
    end_mass = masses[last] + (p.m3 if ideal else 0.0)
    while done < len(rows):
        if int(state[stepping.IMPACTS]) == len(impacts):
            return done, stepping.FULL
        state[stepping.TIME] = state[stepping.STEPS] * h
        forces[:, 0] = 0.0
        forces[:, 1] = -p.gravity * masses
        moments[:] = 0.0
        moments[0] = p.moment
        strain = _internal_forces(places, turns, system.elements, system.pin, forces, moments)
        if p.steady:
            _drive(state, -moments[0] * spins[0], h)
        place, found, event, largest = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), -1, False
        if ideal:
            fx, fy = p.m3 / end_mass * forces[last, 0], forces[last, 1]
            found = norm(fx, fy), 0.0, fx, fy
        else:
            ex, ey = places[last, 0] - slide[0], places[last, 1]
            place = ex, ey, norm(ex, ey) - law.clearance
            if not place[2] <= p.clearance:
                state[stepping.LIMIT] = p.clearance
                return done, stepping.TOO_DEEP
            event = _follow_gap(state, impacts, place[2], h)
            if place[2] > 0:
                found, limit = _joint(place, state, motion, system, acting, p, law, h)
                if h > limit and system.guarded:
                    state[stepping.LIMIT] = limit
                    return done, stepping.FAILED
                largest = stepping.follow_impact(impacts, state, found[0], place[2])
        pull = found[2] / p.m3  # the slider's acceleration
        kinetic = _accelerate(motion, system, acting, end_mass, p.steady > 0, h)
        slide[1] = rates[last, 0] if ideal else slide[1] + h * pull
        speed = slide[1] - 0.5 * h * pull
        if not ideal:
            kinetic += 0.5 * p.m3 * speed * speed
        if not kinetic < inf:
            state[stepping.LIMIT] = 2 / system.frequency
            return done, stepping.FAILED
        joint = place, found, (slide[0], speed, pull)
        if event >= 0:
            row = stepping.event_row(events, state, event)
            _record(row, state, motion, system, acting, joint, p, h, strain, kinetic)
        if largest:
            row = stepping.event_row(events, state, stepping.PEAK)
            _record(row, state, motion, system, acting, joint, p, h, strain, kinetic)
        if int(state[stepping.STEPS]) % strides == 0:
            _record(rows[done], state, motion, system, acting, joint, p, h, strain, kinetic)
            done += 1
        places += h * rates
        turns += h * spins
        slide[0] = places[last, 0] if ideal else slide[0] + h * slide[1]
        state[stepping.STEPS] += 1
    return done, stepping.FINE


def blocks(
    scene: Scene,
    law: np.record,
    times: NDArray[np.float64],
    ideal: bool,
    step: float | None,
    elements: tuple[int, int],
    method: Method,
) -> Iterator[stepping.Block]:
    """Blocks of output rows at equally spaced ``times`` of the scene with links of particles.

    The law is packed, and ``ideal`` tells whether the ball is fixed to the slider. Equal steps of
    at most ``step`` seconds divide the outputs' distance; `usual_step` is the default. Raises
    ``ValueError`` for one above the limit of stability, unless ``unguarded``.
    """
    frame = Frame(scene, elements)
    frequency = frame.highest_frequency(scene.slider_mass if ideal else 0.0, ideal)
    limit = 2 / frequency
    checks.number("limit of stability", limit, "s", least=1e-10 * times[-1])
    if step is None:
        step = 1 / frequency if ideal else usual_step(scene, law, elements)
    strides, h = stepping.divide(times, step)
    if h > limit and method != "unguarded":
        raise ValueError(f"step must be <= {limit:.4g} s, the limit of stability, got {step:.4g} s")
    how = {"lagged": method != "centred", "guarded": method != "unguarded"}
    system = System(**vars(frame), frequency=frequency, ideal=ideal, **how)
    motion, state, p = _start(scene, frame, ideal, h), np.zeros(stepping.STATE), scene.constants()
    state[stepping.STEP] = h
    ball, slide = motion.places[-1], motion.slide
    state[GAP] = norm(ball[0] - slide[0], ball[1]) - scene.clearance
    loop = partial(advance, state, motion, system, p, law, h, strides)
    failure = "the step must stay <= {:.4g} s, the limit of stability"
    return stepping.advance_in_blocks(loop, times, state, failure)


def _start(scene, frame, ideal, h):
    """Motion at t = 0, the joints at rest: rates of half a step earlier by the accelerations then.

    The links are straight, so that only gravity and the drive's moment accelerate them. They are
    unstrained too: a link that turns then stretches, and rings axially at first.
    """
    particles, (e_x, e_y) = len(frame.masses), (0.0, 0.0) if ideal else scene.initial_eccentricity
    (theta, phi), (omega, psi) = scene.configuration(e_y)
    places, rates = np.zeros((particles, 2)), np.zeros((particles, 2))
    of_crank = np.arange(particles - 1) < frame.pin
    angles, speeds = np.where(of_crank, theta, phi), np.where(of_crank, omega, psi)
    chords = frame.elements[:, :1] * np.array([sine_cosine(a)[::-1] for a in angles])
    places[1:] = np.cumsum(chords, axis=0)
    rates[1:] = np.cumsum(speeds[:, None] * chords[:, ::-1] * (-1, 1), axis=0)
    of_crank = np.arange(particles + 1) <= frame.pin
    turns, spins = np.where(of_crank, theta, phi), np.where(of_crank, omega, psi)
    slide = np.array([places[-1, 0] - e_x, rates[-1, 0]])
    if scene.crank_speed is None:
        spins[0] -= h / 2 * scene.driving_moment / frame.rotaries[0]
    rates[1:, 1] += h / 2 * scene.gravity
    rates[-1, 1] = 0.0 if ideal else h / 2 * scene.gravity  # the ball is at rest in its socket
    return Motion(places, rates, turns, spins, slide)
