"""The finite particle method, the paper's own: flexible links as particles that follow Newton.

Each particle has a mass and, per link, a rotary inertia; plane frame elements between them
give internal forces, found after the element's rigid motion is taken off (vector form
intrinsic finite element; Ting, Shih & Wang, J. Mech. 20 (2004), 113-122). Time is stepped by
explicit central differences (Eq. 29). In the damping and friction of the joint the velocity is
the centred one, which the forces of the step are solved for, or the one half a step ago
(``lagged``); ``unguarded`` is the latter without the checks of the limits of stability.
"""

from math import inf, pi, sqrt
from typing import Literal

import numpy as np
import scipy.linalg

from study import checks
from study.compiled import compiled
from study.contact.forces import elastic_force, joint_forces, stored_energy
from study.contact.friction import friction_branch, friction_factor
from study.mechanism.angles import angle_of, arcsine, direction, norm, sine_cosine
from study.mechanism.response import (
    CONTACT,
    FAILED,
    FINE,
    FULL,
    IMPACTS,
    TOO_DEEP,
    advance_in_blocks,
    divide,
)
from study.mechanism.scene import Scene

Method = Literal["centred", "lagged", "unguarded"]

# Places in the array of numbers that describes the scene
M3, MOMENT, GRAVITY, R1, DAMPING, FRICTION, V0, V1, FREQUENCY, LAGGED, GUARDED, IDEAL = range(12)
# ... in the state of the stepper
APPROACH, STEPS, GAP, GAP_RATE, LOST_DAMPING, LOST_FRICTION = range(6)


def lump(link, elements):
    """Particles of one link: masses, and rotary inertias of the half elements at each.

    With two or more elements a little of each end's mass goes to its neighbour, so that mass,
    centre and moment of inertia of the link are exact: stiff links then move as the rigid ones
    at any number of elements. A single element has its mass at its ends, and too much inertia.

    Parameters
    ----------
    link : study.mechanism.scene.Link
    elements : int

    Returns
    -------
    masses, rotaries : ndarray, shapes (elements + 1,)
        In kg and kg m^2.
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
    the ball. Rotations are counted per link, so that the pin has two.

    Parameters
    ----------
    scene : study.mechanism.scene.Scene
    elements : tuple of int
        Number of elements of crank and coupler.

    Attributes
    ----------
    elements : ndarray, shape (n, 4)
        Length (m), axial stiffness (N/m), and the bending stiffnesses that tie the moment at an
        end to the rotations of the near and the far end (N m).
    masses, rotaries : ndarray, shapes (n + 1,) and (n + 2,)
    """

    def __init__(self, scene, elements):
        links = scene.link("crank"), scene.link("coupler")
        rows = []
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

    def highest_frequency(self, end_mass, held):
        """Highest natural frequency of the straight frame, in rad/s.

        Parameters
        ----------
        end_mass : float
            Added to the last particle along the slide, in kg.
        held : bool
            Whether the last particle is held on the slide.
        """
        count = len(self.elements)
        turns = 2 * (count + 1)
        size = turns + count + 2
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


def numbers_of_elements(pair):
    """Return the numbers of elements of crank and coupler, or raise ``ValueError``."""
    if not isinstance(pair, (tuple, list)) or len(pair) != 2:
        raise ValueError(
            f"elements must be two numbers, of crank and coupler, got {checks.shown(pair)}"
        )
    return tuple(checks.whole("elements", n, least=1, most=500) for n in pair)


def stable_step(scene, elements):
    """Limit of stability of the explicit step with a clearance joint out of contact, in s."""
    checks.instance("scene", scene, Scene)
    elements = numbers_of_elements(elements)
    return 2 / Frame(scene, elements).highest_frequency(0.0, held=False)


def usual_step(scene, law, elements):
    """Half the limit of stability with a clearance joint at a depth of one clearance, in s.

    Parameters
    ----------
    scene : study.mechanism.scene.Scene
    law : ndarray
        From ``study.contact.forces.pack``.
    elements : tuple of int
        Of crank and coupler.

    Returns
    -------
    float
    """
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
def advance(state, x, v, turns, spins, slide, frame, p, law, h, strides, rows, impacts, deepest):
    """Step to each output, ``strides`` steps apart, and fill ``rows``; all else goes on.

    ``x`` and ``turns`` are at the current time, ``v`` and ``spins`` half a step before it;
    ``slide`` is (x, v) of the slider. Returns the number of rows filled, how it ended, and the
    limit of the step if that was passed.
    """
    elements, masses, rotaries, pin = frame
    last = len(masses) - 1
    forces, moments = np.zeros_like(x), np.zeros_like(turns)
    held = p[IDEAL] > 0
    end_mass = masses[last] + (p[M3] if held else 0.0)
    done = 0
    while done < len(rows):
        if int(state[IMPACTS]) == len(impacts):
            return done, FULL, 0.0
        t = state[STEPS] * h
        forces[:, 0] = 0.0
        forces[:, 1] = -p[GRAVITY] * masses
        moments[:] = 0.0
        moments[0] = p[MOMENT]
        strain = _internal_forces(x, turns, elements, pin, forces, moments)
        normal = tangential = depth = ex = ey = fx = fy = 0.0
        if held:
            fx, fy = p[M3] / end_mass * forces[last, 0], forces[last, 1]
        else:
            ex, ey = x[last, 0] - slide[0], x[last, 1]
            r = norm(ex, ey)
            depth = r - law[1]
            if depth > deepest or not r < inf:
                return done, TOO_DEEP, 0.0
            gap_rate = (depth - state[GAP]) / h
            if depth <= 0:
                if state[CONTACT] > 0:
                    state[CONTACT] = 0.0
                    impact = impacts[int(state[IMPACTS]) - 1]
                    impact[4], impact[5] = t, -gap_rate
            else:
                if state[CONTACT] == 0:
                    count = int(state[IMPACTS])
                    part, approach = _meet(state[GAP], gap_rate, state[GAP_RATE], h)
                    state[CONTACT], state[APPROACH] = 1.0, approach
                    lost = state[LOST_DAMPING] + state[LOST_FRICTION]
                    impacts[count] = t - (1 - part) * h, approach, 0.0, 0.0, t, 0.0, 0.0, lost
                    state[IMPACTS] = count + 1
                nx, ny = ex / r, ey / r
                wx, wy = v[last, 0] - slide[1], v[last, 1]
                rate, sliding = wx * nx + wy * ny, wy * nx - wx * ny + p[R1] * spins[-1]
                elastic, stiffness = elastic_force(law, depth)
                loss = elastic * p[DAMPING] / state[APPROACH]
                ease = 1 / masses[last] + nx * nx / p[M3]
                stiff = p[FREQUENCY] ** 2 + stiffness * ease
                limit = 2 / sqrt(stiff)
                if p[LAGGED] > 0:  # (h w)^2 + 2 h c/m < 4
                    limit = (sqrt((loss * ease) ** 2 + 4 * stiff) - loss * ease) / stiff
                if h > limit and p[GUARDED] > 0:
                    return done, FAILED, limit
                if p[LAGGED] > 0:
                    branch, limits = friction_branch(sliding, p[V0], p[V1]), (p[V0], p[V1])
                    given = (rate, sliding, branch, state[APPROACH], p[DAMPING], p[FRICTION])
                    found = joint_forces(law, depth, *given, *limits)
                    normal, tangential = found[0], found[5]
                else:  # with the forces of this step, which depend on it
                    fnx, fny = forces[last, 0] / masses[last], forces[last, 1] / masses[last]
                    rate += 0.5 * h * (fnx * nx + fny * ny)
                    sliding += 0.5 * h * (fny * nx - fnx * ny + p[R1] * moments[-1] / rotaries[-1])
                    free_rate, free_sliding, both = rate, sliding, 0.5 * h * nx * ny / p[M3]
                    side = 1 / masses[last] + ny * ny / p[M3] + p[R1] ** 2 / rotaries[-1]
                    for _ in range(4):  # normal and tangential force act on each other weakly
                        pushed = free_rate - both * tangential
                        normal = (elastic + loss * pushed) / (1 + 0.5 * h * loss * ease)
                        rate = pushed - 0.5 * h * ease * normal
                        grip = 0.5 * h * side * p[FRICTION] * max(normal, 0.0)
                        factor, sliding = _resist(free_sliding + both * normal, grip, p[V0], p[V1])
                        tangential = -p[FRICTION] * max(normal, 0.0) * factor
                fx, fy = normal * nx + tangential * ny, normal * ny - tangential * nx
                forces[last, 0] -= fx
                forces[last, 1] -= fy
                moments[-1] += p[R1] * tangential
                state[LOST_DAMPING] += h * (normal - elastic) * rate
                state[LOST_FRICTION] -= h * tangential * sliding
                impact = impacts[int(state[IMPACTS]) - 1]
                impact[2], impact[3] = max(impact[2], normal), max(impact[3], depth)
                lost = state[LOST_DAMPING] + state[LOST_FRICTION]
                impact[4], impact[6] = t, lost - impact[7]
            state[GAP], state[GAP_RATE] = depth, gap_rate
        output = int(state[STEPS]) % strides == 0
        kinetic, work = 0.0, p[MOMENT] * turns[0]
        for i in range(1, last + 1):
            mass = end_mass if i == last else masses[i]
            for n in range(1 if held and i == last else 2):
                change = h * forces[i, n] / mass
                kinetic += 0.5 * mass * (v[i, n] + 0.5 * change) ** 2
                v[i, n] += change
            work -= p[GRAVITY] * masses[i] * x[i, 1]
        for j in range(len(turns)):
            change = h * moments[j] / rotaries[j]
            kinetic += 0.5 * rotaries[j] * (spins[j] + 0.5 * change) ** 2
            spins[j] += change
        pull = fx / p[M3]  # the slider's acceleration
        slide[1] = v[last, 0] if held else slide[1] + h * pull
        speed = slide[1] - 0.5 * h * pull
        if not held:
            kinetic += 0.5 * p[M3] * speed * speed
        if not kinetic < inf:
            return done, FAILED, 2 / p[FREQUENCY]
        if output:
            row = rows[done]
            turning = moments[0] / rotaries[0]
            row[0], row[1], row[2] = t, turns[0], slide[0]
            row[3], row[4] = spins[0] - 0.5 * h * turning, speed
            row[5], row[6] = turning, pull
            row[7] = direction(x[last, 1] - x[pin, 1], x[last, 0] - x[pin, 0])
            row[8] = spins[-1] - 0.5 * h * moments[-1] / rotaries[-1]
            row[9], row[10], row[11] = ex, ey, depth
            row[12], row[13] = norm(fx, fy) if held else normal, tangential
            row[14], row[15] = fx, fy
            row[16], row[17] = work, kinetic
            row[18] = strain + stored_energy(law, depth)
            row[19], row[20] = state[LOST_DAMPING], state[LOST_FRICTION]
            done += 1
        x += h * v
        turns += h * spins
        slide[0] = x[last, 0] if held else slide[0] + h * slide[1]
        state[STEPS] += 1
    return done, FINE, 0.0


def blocks(scene, law, times, ideal, step, elements, method):
    """Yield blocks of output rows of the scene with flexible links made of particles.

    Parameters
    ----------
    scene : study.mechanism.scene.Scene
    law : ndarray
        From ``study.contact.forces.pack``.
    times : list of ndarray
        Equally spaced outputs, the first at 0, in blocks.
    ideal : bool
        Whether the ball is fixed to the slider.
    step : float or None
        Largest step, in s, shortened to divide the outputs' distance; None: half the limit of
        stability at the largest depth.
    elements : tuple of int
        Of crank and coupler.
    method : {"centred", "lagged", "unguarded"}
        Velocity in damping and friction.

    Returns
    -------
    iterator
        Of what `advance_in_blocks` yields.

    Raises
    ------
    ValueError
        For a step above the limit of stability, unless ``unguarded``.
    MechanismError
        If the limit is passed on the way, the motion overflows, or the ball goes deeper than one
        clearance.
    """
    frame = Frame(scene, elements)
    frequency = frame.highest_frequency(scene.slider_mass if ideal else 0.0, ideal)
    limit = 2 / frequency
    checks.number("limit of stability", limit, "s", least=1e-10 * times[-1][-1])
    if step is None:
        step = 1 / frequency if ideal else usual_step(scene, law, elements)
    strides, h = divide(times, step)
    if h > limit and method != "unguarded":
        raise ValueError(f"step must be <= {limit:.4g} s, the limit of stability, got {step:.4g} s")
    p = np.array(
        [
            scene.slider_mass,
            scene.driving_moment,
            scene.gravity,
            scene.ball_radius,
            scene.damping_factor,
            scene.friction,
            scene.slow_speed,
            scene.full_speed,
            frequency,
            method != "centred",
            method != "unguarded",
            ideal,
        ]
    )
    particles = len(frame.masses)
    places = np.zeros((particles, 2))
    angle = 0.0 if ideal else arcsine(scene.initial_eccentricity[1] / scene.coupler_length)
    angles = np.where(np.arange(particles - 1) < frame.pin, 0.0, angle)
    chords = frame.elements[:, :1] * np.array([sine_cosine(a)[::-1] for a in angles])
    places[1:] = np.cumsum(chords, axis=0)
    turns = np.where(np.arange(particles + 1) <= frame.pin, 0.0, angle)
    slide = np.array([places[-1, 0] - (0 if ideal else scene.initial_eccentricity[0]), 0.0])
    # at rest at t = 0, half a step earlier by the accelerations of that time
    velocities, spins = np.zeros((particles, 2)), np.zeros(particles + 1)
    spins[0] = -h / 2 * scene.driving_moment / frame.rotaries[0]
    velocities[1 : -1 if ideal else None, 1] = h / 2 * scene.gravity
    state = np.zeros(8)
    state[GAP] = norm(places[-1, 0] - slide[0], places[-1, 1]) - scene.clearance
    arrays = (frame.elements, frame.masses, frame.rotaries, frame.pin)
    moving = (places, velocities, turns, spins, slide)
    return advance_in_blocks(
        lambda _, *block: advance(
            state, *moving, arrays, p, law, h, strides, *block, scene.clearance
        ),
        times,
        state,
        scene,
        lambda: (state[STEPS] * h, h),
        lambda limit: f"the step must stay <= {limit:.4g} s, the limit of stability",
    )
