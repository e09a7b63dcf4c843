"""Links of beams, integrated implicitly: geometrically exact beam elements.

Elements are Reissner's plane beam with two nodes and one integration point. Places and rotations
are interpolated linearly in the fixed frame, so that the consistent mass is constant and rigid
motion is free of strain. The shear compliance includes the residual bending flexibility (MacNeal
1978), with which the nodal stiffness of a straight element is exact.

With the unknowns q of all nodes and of the slider, the weak form is, for all dq that leave the held
unknowns as they are::

    dq . (M q'' + f(q, q')) = 0
    dq . f = sum over elements of L (n d(stretch) + v d(slide) + m d(bend))  -  work of the weights
             + N d(depth) - T d(slip)  -  loads on crank and slider

where N and T are the normal and tangential force of the joint. Time is stepped by the
generalised-alpha method (Chung & Hulbert 1993), with Newton's method on a banded matrix.
"""

from collections import namedtuple
from collections.abc import Iterator
from functools import partial
from math import inf

import numpy as np

from study.compiled import compiled
from study.contact.forces import friction_regime, joint_forces
from study.mechanism import loads, stepping
from study.mechanism.angles import direction, norm, sine_cosine
from study.mechanism.frame import Array, Elements, straight_links
from study.mechanism.scene import LINKS, Scene
from study.mechanism.stepping import JointOutput

SPECTRAL_RADIUS = 0.8  # share that a step leaves of motions of infinite frequency
ALPHA_M = (2 * SPECTRAL_RADIUS - 1) / (SPECTRAL_RADIUS + 1)
ALPHA_F = SPECTRAL_RADIUS / (SPECTRAL_RADIUS + 1)
NEWTON_TOLERANCE = 1e-9  # change at which Newton's method stops, relative to the clearance
BAND = 6  # unknowns of neighbouring nodes are at most this far apart
NO_TANGENT = (0.0, 0.0)
ANY = np.int64(3)  # friction regime: that of the sliding speed; from NumPy, as in `events`
PLACES, RATES, ACCELERATIONS, BEFORE = range(4)
"""Rows of a motion: places and rotations, their rates, the method's accelerations, and those one
step before."""
STRETCH, SLIDE, BEND = range(3)  # strains of an element
X1, Y1, TURN1, X2, Y2, TURN2 = range(6)  # unknowns of an element
CRANK = 2  # number of the rotation at the crank's fixed end
SECTION = np.dtype(
    [(name, float) for name in ("length", "axial", "shear", "bending", "mass", "rotary")]
)
"""An element: its length, stiffnesses, and mass and rotary inertia per length."""
Ball = namedtuple("Ball", "x y turn slider")
"""Numbers of the unknowns of the ball, and of the slider's position."""
Mesh = namedtuple("Mesh", "sections unknowns ball pin held mass weight initial rates ideal")
"""Elements of both links, with their unknowns numbered along the chain.

``sections`` has a `SECTION` for each element, ``unknowns`` the numbers of (x, y, rotation) at both
of its ends; ``pin`` is the number of the pin's x, and ``held`` those of unknowns whose rate is
given. Column `BAND` of ``mass`` is its diagonal. ``initial`` and ``rates`` are those at t = 0."""
BeamJoint = namedtuple("BeamJoint", "output rate sliding elastic")
"""Joint between beams: its `JointOutput`, the rate of its depth, its sliding speed, and the elastic
part of its normal force."""
NO_JOINT = BeamJoint(JointOutput(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0, 0.0, 0.0)


def assemble(scene: Scene, elements: Elements, ideal: bool) -> Mesh:
    """Mesh with numbers of elements of crank and coupler; an ideal joint fixes ball to slider."""
    places, rates, turns, spins, slide = straight_links(scene, elements, ideal)
    (pin, _), nodes = elements, np.arange(len(places))
    x = 3 * nodes + (nodes > pin)  # x, y and rotation of each node, and a second one of the pin
    rotations = np.insert(x + 2, pin + 1, x[pin] + 3)
    near = x[:-1], x[:-1] + 1, np.delete(rotations, [pin, -1])
    far = x[1:], x[1:] + 1, np.delete(rotations, [0, pin + 1])
    ball = Ball(*(int(x[-1]) + i for i in (0, 1, 2, 0 if ideal else 3)))
    initial, speeds = np.zeros(max(ball) + 1), np.zeros(max(ball) + 1)
    for values, of_nodes, angles in ((initial, places, turns), (speeds, rates, spins)):
        values[x], values[x + 1], values[rotations] = *of_nodes.T, angles
    initial[ball.slider], speeds[ball.slider] = slide
    held = [0, 1, ball.y] if ideal else [0, 1]
    initial[held] = speeds[held] = 0.0
    if scene.crank_speed is not None:
        held.append(CRANK)
    rows = []
    for body, n in zip(LINKS, elements, strict=True):
        link = scene.link(body)
        length = link.length / n
        shear = 1 / (1 / link.shear + length**2 / (12 * link.bending))
        masses = link.mass_per_length, link.rotary_per_length
        rows += [(length, link.axial, shear, link.bending, *masses)] * n
    sections, unknowns = np.array(rows, SECTION).view(np.recarray), np.column_stack([*near, *far])
    mass, weight = _mass_and_weight(sections, unknowns, len(initial), scene.gravity)
    mass[ball.slider, BAND] += scene.slider_mass
    numbers = unknowns, ball, int(x[pin]), np.array(held)
    return Mesh(sections, *numbers, mass, weight, initial, speeds, ideal)


def _mass_and_weight(sections, unknowns, size, gravity):
    """Consistent mass of the elements, a band, and their weights as loads on the nodes.

    dq . M q'' is the integral of mass (x'' dx + y'' dy) + rotary turn'' d(turn) along the elements.
    The product of two linear functions gives L/3 for one node, and L/6 for two.
    """
    mass, load = np.zeros((size, 2 * BAND + 1)), np.zeros(size)
    for section, at in zip(sections, unknowns, strict=True):
        length = section["length"]
        for i in range(6):
            density = section["rotary" if i % 3 == 2 else "mass"]
            for j in range(i % 3, 6, 3):
                share = (2 if i == j else 1) * density * length / 6
                mass[at[i], BAND + at[j] - at[i]] += share
        load[at[[Y1, Y2]]] -= gravity * length * section["mass"] / 2
    return mass, load


@compiled
def _internal(q, sections, unknowns, force, matrix, factor):
    """Add the forces, and ``factor`` times their tangent to ``matrix``; return the energy.

    With ' the derivative along the element, and the rotation in its middle, the strains are
    stretch = c x' + s y' - 1, slide = c y' - s x' and bend = turn'. Row by row, ``b`` has their
    derivatives by the unknowns of the element, which have the forces L (n b + v b + m b). The
    tangent is L (axial b b + shear b b + bending b b), and L n and L v times the second derivatives
    of stretch and slide.
    """
    energy, b, d = 0.0, np.zeros((3, 6)), np.zeros(6)
    for e in range(len(sections)):
        section, at = sections[e], unknowns[e]
        length, axial = section.length, section.axial
        shear, bending = section.shear, section.bending
        for i in range(6):
            d[i] = q[at[i]]
        dx, dy = (d[X2] - d[X1]) / length, (d[Y2] - d[Y1]) / length
        turn = 0.5 * (d[TURN1] + d[TURN2])
        s, c = sine_cosine(turn)
        along, across = c * dx + s * dy, c * dy - s * dx
        stretch, slide, bend = along - 1, across, (d[TURN2] - d[TURN1]) / length
        n, v, m = axial * stretch, shear * slide, bending * bend
        energy += 0.5 * length * (n * stretch + v * slide + m * bend)
        b[STRETCH] = -c / length, -s / length, 0.5 * across, c / length, s / length, 0.5 * across
        b[SLIDE] = s / length, -c / length, -0.5 * along, -s / length, c / length, -0.5 * along
        b[BEND] = 0.0, 0.0, -1 / length, 0.0, 0.0, 1 / length
        for i in range(6):
            force[at[i]] += length * (n * b[STRETCH, i] + v * b[SLIDE, i] + m * b[BEND, i])
            if factor == 0:
                continue
            for j in range(6):
                value = axial * b[STRETCH, i] * b[STRETCH, j] + shear * b[SLIDE, i] * b[SLIDE, j]
                value += bending * b[BEND, i] * b[BEND, j]
                # second derivatives of the strains: places with rotations, and rotations
                if i % 3 == 2 and j % 3 == 2:
                    value -= 0.25 * (n * along + v * across)
                elif i % 3 == 2:
                    value += 0.5 * (n * b[SLIDE, j] - v * b[STRETCH, j])
                elif j % 3 == 2:
                    value += 0.5 * (n * b[SLIDE, i] - v * b[STRETCH, i])
                matrix[at[i], BAND + at[j] - at[i]] += factor * length * value
    return energy


@compiled
def _add_joint(q, v, ball, touching, approach, regime, p, law, force, matrix, tangent):
    """Add the forces of the joint, and their tangent, as in `_forces`; return the `BeamJoint`.

    A motion dq of (ball's x, y and rotation, slider) changes the depth by along . dq, and the
    surfaces slip by slip . dq. The forces are N along - T slip. When the normal turns by the angle
    turned . dq, along becomes along + across, and slip becomes slip - along, both times the angle.
    """
    ex, ey = q[ball.x] - q[ball.slider], q[ball.y]
    wx, wy, r = v[ball.x] - v[ball.slider], v[ball.y], norm(ex, ey)
    depth = r - law.clearance
    nx, ny = (ex / r, ey / r) if r > 0 else (1.0, 0.0)
    tx, ty = -ny, nx
    rate, sideways = wx * nx + wy * ny, wx * tx + wy * ty
    sliding = sideways + p.r1 * v[ball.turn]
    if not touching or depth <= 0:
        return BeamJoint(JointOutput(ex, ey, depth, 0.0, 0.0, 0.0, 0.0), rate, sliding, 0.0)
    if regime == ANY:
        regime = friction_regime(sliding, p.v0, p.v1)
    speeds = rate, sliding, regime, approach
    forces = joint_forces(law, depth, *speeds, p.damping, p.friction, p.v0, p.v1)
    normal, tangential = forces.normal, forces.tangential
    at = ball.x, ball.y, ball.turn, ball.slider
    along, across, slip = (nx, ny, 0.0, -nx), (tx, ty, 0.0, -tx), (tx, ty, p.r1, -tx)
    by_q, by_v = tangent
    for i in range(4):
        force[at[i]] += normal * along[i] - tangential * slip[i]
    for j in range(4 if by_q != 0 else 0):
        turned = by_q * across[j] / r
        drate = by_v * along[j] + sideways * turned
        dsliding = by_v * slip[j] - rate * turned
        dnormal = forces.normal_by_depth * by_q * along[j] + forces.normal_by_rate * drate
        dtangential = (
            forces.tangential_by_normal * dnormal + forces.tangential_by_sliding * dsliding
        )
        for i in range(4):
            change = dnormal * along[i] - dtangential * slip[i]
            change += (normal * across[i] + tangential * along[i]) * turned
            matrix[at[i], BAND + at[j] - at[i]] += change
    fx, fy = normal * nx - tangential * tx, normal * ny - tangential * ty
    output = JointOutput(ex, ey, depth, normal, tangential, fx, fy)
    return BeamJoint(output, rate, sliding, forces.elastic)


@compiled
def _hold(unknowns, matrix, right):
    """Make a banded system leave some unknowns at 0."""
    for i in unknowns:
        right[i], matrix[i], matrix[i, BAND] = 0.0, 0.0, 1.0


@compiled
def _solve(matrix, right):
    """Solve a banded system in place by elimination along the chain, without pivoting."""
    size = len(right)
    for i in range(size):
        pivot = matrix[i, BAND]
        for k in range(1, min(BAND, size - 1 - i) + 1):
            ratio = matrix[i + k, BAND - k] / pivot
            if ratio != 0:
                for j in range(1, min(BAND, size - 1 - i) + 1):
                    matrix[i + k, BAND - k + j] -= ratio * matrix[i, BAND + j]
                right[i + k] -= ratio * right[i]
    for i in range(size - 1, -1, -1):
        for j in range(1, min(BAND, size - 1 - i) + 1):
            right[i] -= matrix[i, BAND + j] * right[i + j]
        right[i] /= matrix[i, BAND]


@compiled
def _forces(q, v, mesh, state, regime, p, law, force, matrix, tangent):
    """Fill ``force`` with f(q, v) of M a + f = 0; return strain energy and `BeamJoint`.

    The derivatives by places and rates, times the two factors ``tangent``, are added to ``matrix``.
    A load F on an unknown contributes -F.
    """
    ball, (by_q, by_v) = mesh.ball, tangent
    for i in range(len(force)):
        force[i] = -mesh.weight[i]
    on_crank = loads.on_crank(p, q[CRANK], v[CRANK])
    on_slider = loads.on_slider(p, q[ball.slider], v[ball.slider])
    for i, load in ((CRANK, on_crank), (ball.slider, on_slider)):
        force[i] -= load.value
        matrix[i, BAND] -= by_q * load.by_place + by_v * load.by_rate
    energy = _internal(q, mesh.sections, mesh.unknowns, force, matrix, by_q)
    if mesh.ideal:
        return energy, NO_JOINT
    touching, approach = state.contact, state.approach
    joint = _add_joint(q, v, ball, touching, approach, regime, p, law, force, matrix, tangent)
    return energy, joint


@compiled
def _meet(gap0, rate0, gap1, rate1, h):
    """Instant in a step at which a cubic gap function vanishes, and its rate there."""
    low, high = 0.0, 1.0
    for _ in range(60):
        s = 0.5 * (low + high)
        gap = (1 + 2 * s) * (1 - s) ** 2 * gap0 + s * (1 - s) ** 2 * h * rate0
        gap += s * s * (3 - 2 * s) * gap1 + s * s * (s - 1) * h * rate1
        if gap < 0:
            low = s
        else:
            high = s
    slope = 6 * s * (1 - s) * (gap1 - gap0) / h
    slope += (1 - s) * (1 - 3 * s) * rate0 + s * (3 * s - 2) * rate1
    return s * h, slope if slope > 0 else (gap1 - gap0) / h


@compiled
def _newton(motion, new, mesh, state, sliding, p, law, h, tolerance, old, work):
    """Fill ``new`` with places, rates and accelerations after a step; False for no balance.

    ``old`` are the forces before. An iteration takes one friction regime, and the next one that
    regime or a neighbour: free to jump, it would alternate between the law's ends.
    """
    (force, right, matrix), size, ball = work, motion.shape[1], mesh.ball
    q, v, a = motion[PLACES], motion[RATES], motion[ACCELERATIONS]
    q1, v1, a1 = new[PLACES], new[RATES], new[ACCELERATIONS]
    gamma = 0.5 - ALPHA_M + ALPHA_F
    beta = 0.25 * (1 - ALPHA_M + ALPHA_F) ** 2
    by_a = (1 - ALPHA_M) / (beta * h * h)
    by_q, by_v = 1 - ALPHA_F, (1 - ALPHA_F) * gamma / (beta * h)
    for i in range(size):
        a1[i] = a[i]
        v1[i] = v[i] + h * a[i]
        q1[i] = q[i] + h * v[i] + 0.5 * h * h * a[i]
    regime = 0 if mesh.ideal else friction_regime(sliding, p.v0, p.v1)
    for _ in range(60):
        for i in range(size):
            for j in range(2 * BAND + 1):
                matrix[i, j] = by_a * mesh.mass[i, j]
        _forces(q1, v1, mesh, state, regime, p, law, force, matrix, (by_q, by_v))
        for i in range(size):
            right[i] = -(1 - ALPHA_F) * force[i] - ALPHA_F * old[i]
            for j in range(max(0, i - BAND), min(size, i + BAND + 1)):
                share = (1 - ALPHA_M) * a1[j] + ALPHA_M * a[j]
                right[i] -= mesh.mass[i, BAND + j - i] * share
        _hold(mesh.held, matrix, right)
        _solve(matrix, right)
        change = total = 0.0
        for i in range(size):
            change, total = max(change, abs(right[i])), total + abs(right[i])
            q1[i] += right[i]
            v1[i] += gamma / (beta * h) * right[i]
            a1[i] += right[i] / (beta * h * h)
        if not total < inf:  # the maximum leaves out what is not a number
            return False
        away = 0
        if state.contact:
            ex, ey = q1[ball.x] - q1[ball.slider], q1[ball.y]
            across = (v1[ball.y] * ex - (v1[ball.x] - v1[ball.slider]) * ey) / norm(ex, ey)
            away = friction_regime(across + p.r1 * v1[ball.turn], p.v0, p.v1) - regime
        if change <= tolerance and abs(away) <= 1:
            return True
        regime += min(max(away, -1), 1)
    return False


@compiled
def advance(state, motion, mesh, p, law, h, strides, rows, impacts, events):
    """Fill ``rows``, ``strides`` steps apart; return the number of rows filled and the ending."""
    size, done = motion.shape[1], 0
    new, old, force, right = np.zeros((3, size)), np.zeros(size), np.zeros(size), np.zeros(size)
    matrix = np.zeros((size, 2 * BAND + 1))
    work = force, right, matrix
    strain, joint = _forces(
        motion[PLACES], motion[RATES], mesh, state, ANY, p, law, old, matrix, NO_TANGENT
    )
    if state.steps == 0:
        _add_work(state, old, motion, mesh, p, 0.0)
    far = abs(mesh.initial[mesh.ball.slider])  # of the start: a loop may begin at any step
    tolerance = NEWTON_TOLERANCE * law.clearance + 1e-13 * far
    while True:
        if state.impacts == len(impacts):
            return done, stepping.FULL
        t = state.time = state.steps * h
        if state.steps % strides == 0:
            _write_output(rows[done], state, motion, old, mesh, joint.output, strain, p)
            done += 1
        begun = largest = ended = False
        while True:  # twice if the surfaces meet in this step
            sliding = joint.sliding
            if not _newton(motion, new, mesh, state, sliding, p, law, h, tolerance, old, work):
                return done, stepping.FAILED
            strain, new_joint = _forces(
                new[PLACES], new[RATES], mesh, state, ANY, p, law, force, matrix, NO_TANGENT
            )
            depth = new_joint.output.depth
            if mesh.ideal or state.contact or depth <= 0:
                break
            after, approach = _meet(joint.output.depth, joint.rate, depth, new_joint.rate, h)
            stepping.begin_impact(impacts, state, t + after, approach)
            begun = True
        state.steps += 1
        state.time = state.steps * h
        if state.contact:
            if not depth <= p.clearance:
                state.limit = p.clearance
                return done, stepping.TOO_DEEP
            for at in (joint, new_joint):
                lost = (at.output.normal - at.elastic) * at.rate
                state.lost_damping += 0.5 * h * lost
                state.lost_friction -= 0.5 * h * at.output.tangential * at.sliding
            force_now = new_joint.output.normal
            largest = stepping.follow_impact(impacts, state, force_now, depth)
            ended = depth <= 0
            if ended:
                stepping.end_impact(impacts, state, -new_joint.rate)
        for i in range(size):  # an assignment of arrays takes seconds to compile
            motion[BEFORE, i], old[i] = motion[ACCELERATIONS, i], force[i]
            for row in (PLACES, RATES, ACCELERATIONS):
                motion[row, i] = new[row, i]
        joint = new_joint
        _add_work(state, old, motion, mesh, p, h)
        for event, happened in enumerate((begun, largest, ended)):
            if happened:
                row = stepping.event_row(events, state, event)
                _write_output(row, state, motion, old, mesh, joint.output, strain, p)
        if done == len(rows) or state.steps >= state.until:
            return done, stepping.FINE


@compiled
def _true_acceleration(motion, i):
    """Acceleration now: the method's belong to a time (alpha_f - alpha_m) h before."""
    late = (1 - SPECTRAL_RADIUS) / (SPECTRAL_RADIUS + 1)
    now = motion[ACCELERATIONS, i]
    return now + late * (now - motion[BEFORE, i])


@compiled
def _reaction(i, force, motion, mass):
    """Force or moment that holds an unknown, against inertia and other forces."""
    total = force[i]
    for j in range(max(0, i - BAND), min(len(force), i + BAND + 1)):
        total += mass[i, BAND + j - i] * _true_acceleration(motion, j)
    return total


@compiled
def _add_work(state, force, motion, mesh, p, h):
    """Add the work of the loads in a step, which ends with ``motion`` and ``force``."""
    q, v = motion[PLACES], motion[RATES]
    if p.steady:
        state.holding = _reaction(CRANK, force, motion, mesh.mass)
    slider = mesh.ball.slider
    power = state.holding * v[CRANK] + loads.on_crank(p, q[CRANK], v[CRANK]).power
    stepping.add_work(state, power + loads.on_slider(p, q[slider], v[slider]).power, h)


@compiled
def _write_output(row, state, motion, force, mesh, joint, strain, p):
    """Fill a row of output from motion and joint at the state's time."""
    q, v, ball, pin = motion[PLACES], motion[RATES], mesh.ball, mesh.pin
    on_slider = loads.on_slider(p, q[ball.slider], v[ball.slider])
    work = state.work - loads.on_crank(p, q[CRANK], v[CRANK]).energy - on_slider.energy
    size, kinetic = len(q), 0.0
    for i in range(size):
        work += mesh.weight[i] * q[i]
        for j in range(max(0, i - BAND), min(size, i + BAND + 1)):
            kinetic += 0.5 * v[i] * mesh.mass[i, BAND + j - i] * v[j]
    if mesh.ideal:
        fx = p.m3 * _true_acceleration(motion, ball.x) - on_slider.value
        fy = -_reaction(ball.y, force, motion, mesh.mass)
        joint = JointOutput(0.0, 0.0, 0.0, norm(fx, fy), 0.0, fx, fy)
    row.crank_angle, row.crank_speed = q[CRANK], v[CRANK]
    row.crank_acceleration = _true_acceleration(motion, CRANK)
    row.driving_moment = p.moment + state.holding
    row.slider_position, row.slider_velocity = q[ball.slider], v[ball.slider]
    row.slider_acceleration = (joint.force_x + on_slider.value) / p.m3
    row.coupler_angle = direction(q[ball.y] - q[pin + 1], q[ball.x] - q[pin])
    row.coupler_speed = v[ball.turn]
    row.work, row.kinetic, row.elastic = work, kinetic, strain
    row.lost_damping, row.lost_friction = state.lost_damping, state.lost_friction
    stepping.write_joint(row, joint)


def _start(mesh, p):
    """Places, rates and accelerations at t = 0, in the rows of ``advance``'s ``motion``.

    Rotations without inertia follow the load at once, unless held.
    """
    sections, unknowns, held = mesh.sections, mesh.unknowns, mesh.held
    mass, load, slider = mesh.mass, mesh.weight.copy(), mesh.ball.slider
    motion = np.array([mesh.initial, mesh.rates, 0 * load, 0 * load])
    load[CRANK] += loads.on_crank(p, mesh.initial[CRANK], mesh.rates[CRANK]).value
    load[slider] += loads.on_slider(p, mesh.initial[slider], mesh.rates[slider]).value
    force, stiffness = -load, np.zeros_like(mass)
    _internal(motion[PLACES], sections, unknowns, force, stiffness, 1.0)
    light = mass[:, BAND] == 0
    if light.any():
        motion[PLACES] -= _solution(stiffness, force, [*held, *np.flatnonzero(~light)])
        force = -load
        _internal(motion[PLACES], sections, unknowns, force, stiffness, 0.0)
    motion[[ACCELERATIONS, BEFORE]] = _solution(mass, -force, [*held, *np.flatnonzero(light)])
    return motion


def _solution(matrix, right, held):
    """Solution of a banded system, 0 for the unknowns ``held``."""
    matrix, right = matrix.copy(), right.copy()
    _hold(np.array(held), matrix, right)
    _solve(matrix, right)
    return right


def blocks(
    scene: Scene, law: np.record, times: Array, ideal: bool, step: float, elements: Elements
) -> Iterator[stepping.Block]:
    """Blocks of output rows of the scene with links of beam elements, as for particles."""
    mesh, p, state = assemble(scene, elements, ideal), scene.constants(), stepping.new_state()
    strides, h = stepping.divide(times, step)
    motion, state.step = _start(mesh, p), h
    loop = partial(advance, state, motion, mesh, p, law, h, strides)
    return stepping.advance_in_blocks(
        loop, times, state, "Newton's method found no balance, for which a shorter step may help"
    )
