"""Rigid links: the equations of motion of the crank-slider with its clearance joint.

The crank has the angle theta from +x, and the coupler phi; st, ct, sp, cp are their sines and
cosines. With the eccentricity e = (e_x, e_y), the vector from the centre of the socket to that of
the ball at the coupler's end, and the slider's position x, the chain of the links is::

    l1 ct + l2 cp = x + e_x,    l1 st + l2 sp = e_y,    cp > 0.

There are three degrees of freedom: theta, and two coordinates of the joint. These are e_x and e_y
in flight, and in contact the depth ``|e| - clearance`` and the direction of e. With the depth as a
variable nothing cancels, and the stiff direction is a coordinate, which allows longer steps. A
state is z = (theta, two coordinates), z', and `INTEGRALS` over time.

Crank and coupler are a double pendulum with an ideal joint between them. The clearance joint exerts
a force (f_x, f_y) on the ball and a moment R1 T on the coupler, where T is the tangential force.
With loads M on the crank and S on the slider (`study.mechanism.loads`) and d = theta - phi::

    a11 theta'' + a12 cos(d) phi'' = q1 = M - a12 sin(d) phi'^2 + l1 (ct f_y - st f_x) - g1 ct
    a12 cos(d) theta'' + a22 phi'' = q2 = a12 sin(d) theta'^2 + l2 (cp f_y - sp f_x) + R1 T - g2 cp
    m3 x'' = S - f_x

where a11 = I1 + m1 l1^2/4 + m2 l1^2, a22 = I2 + m2 l2^2/4, a12 = m2 l1 l2/2, and the weights have
the moments g1 = (m1/2 + m2) g l1 and g2 = m2 g l2/2. At constant crank speed theta'' = 0, and the
first equation gives the moment that holds the speed. `study.mechanism.events` steps the equations.
"""

from collections import namedtuple
from functools import partial
from math import sqrt

import numpy as np

from study.compiled import compiled, inlined, inner
from study.contact.forces import (
    NODES,
    WEIGHTS,
    JointForces,
    elastic_force,
    joint_forces,
    stored_energy,
)
from study.mechanism import loads, stepping
from study.mechanism.angles import angle_of, direction, norm, sine_cosine
from study.mechanism.stepping import JointOutput

UNKNOWNS, INTEGRALS = 3, 3
THETA, FIRST, SECOND, OMEGA, FIRST_RATE, SECOND_RATE = range(2 * UNKNOWNS)
"""Places in a state: the crank's angle, the joint's two coordinates, and their rates."""
LOST_DAMPING, LOST_FRICTION, WORK = range(2 * UNKNOWNS, 2 * UNKNOWNS + INTEGRALS)
"""Places of the integrals: energies lost to damping and friction, and the work of loads."""
_UNIT = np.eye(2 * UNKNOWNS)
NO_FORCES = JointForces(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # in flight
_NUMBERS = [("approach", float), ("deep", float), ("regime", np.int64), ("impact", np.int64)]
JOINT = np.dtype([*_NUMBERS, ("closed", bool)], align=True)
"""State of the joint: its `ContactState`, the depth to which the approach speed can lead, and the
number of the impact."""
NOW, BEFORE = range(2)  # places of the joint's records: now, and at the start of the step
ContactState = namedtuple("ContactState", "closed regime approach")
"""Discrete state of the joint: whether it is in contact, its friction regime, and the approach
speed of the contact. While the state stays, the equations of motion are smooth."""
Eccentricity = namedtuple("Eccentricity", "nx ny length rate spin x y x_rate y_rate")
"""Vector e from the centre of the socket to that of the ball, and its rate. (nx, ny) is its
direction, the normal of the surfaces; ``rate`` and ``spin`` are rates of length and direction. The
derivatives of (nx, ny) are (-ny, nx) times that of the direction."""
EccentricityChange = namedtuple(
    "EccentricityChange", "length direction rate spin x y x_rate y_rate"
)
"""Derivatives of parts of an `Eccentricity`; of length and direction in contact only."""
Pose = namedtuple("Pose", "st ct sp cp psi x speed")
"""Sines and cosines of theta and phi, phi', and position and speed of the slider."""
JointMotion = namedtuple("JointMotion", "depth rate sliding normal tangential normal_rate")
"""Depth of the joint, its rate, sliding speed, normal and tangential force, rate of the first."""
Motion = namedtuple(
    "Motion", "accelerations powers joint pose eccentricity ex2 ey2 forces beta slider holding"
)
"""Motion and forces at a state: z''; rates of the integrals; `JointMotion`; `Pose`; `Eccentricity`
and its second derivatives along x and y; `JointForces`; phi''; x''; and the moment that holds a
constant crank speed."""


@inlined
def eccentricity_of(y, closed, clearance):
    """Eccentricity of the joint in a state."""
    a, b, va, vb = y[FIRST], y[SECOND], y[FIRST_RATE], y[SECOND_RATE]
    if closed:  # e = r n with r = clearance + depth, e' = r' n + r spin t, and t = (-ny, nx)
        ny, nx = sine_cosine(b)
        r = clearance + a
        wx, wy = va * nx - r * vb * ny, va * ny + r * vb * nx
        return Eccentricity(nx, ny, r, va, vb, r * nx, r * ny, wx, wy)
    r = sqrt(a * a + b * b)
    nx, ny = (a / r, b / r) if r > 0 else (1.0, 0.0)
    spin = (vb * nx - va * ny) / r if r > 0 else 0.0
    return Eccentricity(nx, ny, r, va * nx + vb * ny, spin, a, b, va, vb)


@inlined
def _eccentricity_change(dy, e, closed):
    """Derivatives of the eccentricity, by those of the state."""
    da, db, dva, dvb = dy[FIRST], dy[SECOND], dy[FIRST_RATE], dy[SECOND_RATE]
    if not closed:
        return EccentricityChange(0.0, 0.0, 0.0, 0.0, da, db, dva, dvb)
    # de = da n + r db t, and with dn = db t, dt = -db n
    # de' = dr' n + (da spin + r dspin) t + r' db t - r spin db n, of which the last two are e'
    # turned by 90 deg
    dx, dy = da * e.nx - e.length * e.ny * db, da * e.ny + e.length * e.nx * db
    dwx = dva * e.nx - (da * e.spin + e.length * dvb) * e.ny - e.y_rate * db
    dwy = dva * e.ny + (da * e.spin + e.length * dvb) * e.nx + e.x_rate * db
    return EccentricityChange(da, db, dva, dvb, dx, dy, dwx, dwy)


@inlined
def _on_ball(e, forces):
    """Force f = -N n + T t on the ball along x and y, where t = (-ny, nx)."""
    normal, tangential = forces.normal, forces.tangential
    return -normal * e.nx - tangential * e.ny, -normal * e.ny + tangential * e.nx


@partial(compiled, forceinline=True)  # to pass its tuples takes longer than to compute them
def motion(y, contact, p, law):
    """`Motion` at y = (z, z', ...), with the joint in a `ContactState`."""
    l1, l2, per_l2, per_m3 = p.l1, p.l2, 1 / p.l2, 1 / p.m3  # first: all else waits for them
    (st, ct), omega, closed = sine_cosine(y[THETA]), y[OMEGA], contact.closed
    e = eccentricity_of(y, closed, law.clearance)

    # the chain of the links, and its rates:
    # sp = (e_y - l1 st)/l2, phi' = (e_y' - l1 ct theta')/(l2 cp), sliding speed r spin + R1 phi'
    sp = (e.y - l1 * st) * per_l2
    cp = sqrt(1 - sp * sp)
    psi = (e.y_rate - l1 * ct * omega) * per_l2 / cp
    x, speed = l1 * ct + l2 * cp - e.x, -l1 * st * omega - l2 * sp * psi - e.x_rate
    sliding = e.length * e.spin + p.r1 * psi

    forces = NO_FORCES
    if closed and y[FIRST] > 0:
        speeds = e.rate, sliding, contact.regime, contact.approach
        forces = joint_forces(law, y[FIRST], *speeds, p.damping, p.friction, p.v0, p.v1)
    fx, fy = _on_ball(e, forces)
    on_crank, on_slider = loads.on_crank(p, y[THETA], omega), loads.on_slider(p, x, speed)

    # the double pendulum, solved for alpha = theta'' and beta = phi''; then the slider
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    cross, coupling = p.a12 * sd, p.a12 * cd
    q1 = on_crank.value - cross * psi * psi + l1 * (ct * fy - st * fx) - p.g1 * ct
    q2 = cross * omega * omega + l2 * (cp * fy - sp * fx) + p.r1 * forces.tangential - p.g2 * cp
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    alpha = (p.a22 * q1 - coupling * q2) * inverse
    beta = (p.a11 * q2 - coupling * q1) * inverse
    holding = 0.0
    if p.steady > 0:
        alpha, beta = 0.0, q2 / p.a22
        holding = coupling * beta - q1
    slider = (on_slider.value - fx) * per_m3

    # the chain of the links, twice differentiated, gives e''
    ex2 = -l1 * (st * alpha + ct * omega * omega) - l2 * (sp * beta + cp * psi * psi) - slider
    ey2 = l1 * (ct * alpha - st * omega * omega) + l2 * (cp * beta - sp * psi * psi)
    # in contact n e'' = r'' - r spin^2 and t e'' = r spin' + 2 r' spin
    growth = e.nx * ex2 + e.ny * ey2 + e.length * e.spin * e.spin
    first, second = ex2, ey2
    if closed:
        first, second = growth, e.nx * ey2 - e.ny * ex2 - 2 * e.rate * e.spin
    accelerations = alpha, first, second * (1 / e.length if closed else 1.0)

    depth = y[FIRST] if closed else e.length - law.clearance
    normal_rate = forces.normal_by_depth * e.rate + forces.normal_by_rate * growth
    joint = JointMotion(depth, e.rate, sliding, forces.normal, forces.tangential, normal_rate)
    lost = (forces.normal - forces.elastic) * e.rate, -forces.tangential * sliding
    powers = *lost, holding * omega + on_crank.power + on_slider.power
    pose = Pose(st, ct, sp, cp, psi, x, speed)
    return Motion(accelerations, powers, joint, pose, e, ex2, ey2, forces, beta, slider, holding)


@compiled
def derive(y, contact, p, at, k):
    """Fill ``k`` with the derivatives of z'' at a state with the `Motion` ``at``.

    There is a column for each number of (z, z'). A name with d is the derivative by this number:
    each equation of `motion` is differentiated, in the same order.
    """
    l1, l2, omega, closed, e = p.l1, p.l2, y[OMEGA], contact.closed, at.eccentricity
    st, ct, sp, cp, psi, x, speed = at.pose
    (alpha, _, turning), beta = at.accelerations, at.beta
    forces, (fx, fy) = at.forces, _on_ball(e, at.forces)
    on_crank, on_slider = loads.on_crank(p, y[THETA], omega), loads.on_slider(p, x, speed)
    cross, coupling = p.a12 * (st * cp - ct * sp), p.a12 * (ct * cp + st * sp)
    inverse = 1 / (p.a11 * p.a22 - coupling * coupling)
    per_reach, per_mass = 1 / (l2 * cp), 1 / p.m3
    lean, per_radius = psi * l2 * sp * per_reach, 1 / e.length if closed else 1.0
    for j in range(2 * UNKNOWNS):
        unit = _UNIT[j]
        dt, do = unit[THETA], unit[OMEGA]
        de = _eccentricity_change(unit, e, closed)
        # chain: l2 cp dphi = de_y - l1 ct dtheta
        # l2 cp dphi' = de_y' + l1 st theta' dtheta - l1 ct dtheta' + l2 sp phi' dphi
        dp = (de.y - l1 * ct * dt) * per_reach
        dpsi = (de.y_rate + l1 * (st * omega * dt - ct * do)) * per_reach + lean * dp
        # joint: df = -dN n + dT t - (N t + T n) d(direction)
        dsliding = de.length * e.spin + e.length * de.spin + p.r1 * dpsi
        dnormal = forces.normal_by_depth * de.length + forces.normal_by_rate * de.rate
        dtangential = forces.tangential_by_normal * dnormal
        dtangential += forces.tangential_by_sliding * dsliding
        dfx = -dnormal * e.nx - dtangential * e.ny - fy * de.direction
        dfy = -dnormal * e.ny + dtangential * e.nx + fx * de.direction
        # double pendulum A (alpha, beta) = q: A (dalpha, dbeta) = dq - dA (alpha, beta)
        dcross, dcoupling = coupling * (dt - dp), -cross * (dt - dp)
        dq1 = (
            -dcross * psi * psi
            - 2 * cross * psi * dpsi
            + l1 * (ct * dfy - st * dfx - (st * fy + ct * fx) * dt)
            + (p.g1 * st * dt + on_crank.by_place * dt + on_crank.by_rate * do)
            - dcoupling * beta
        )
        dq2 = (
            dcross * omega * omega
            + 2 * cross * omega * do
            + l2 * (cp * dfy - sp * dfx - (sp * fy + cp * fx) * dp)
            + p.r1 * dtangential
            + p.g2 * sp * dp
            - dcoupling * alpha
        )
        dalpha = (p.a22 * dq1 - coupling * dq2) * inverse
        dbeta = (p.a11 * dq2 - coupling * dq1) * inverse
        if p.steady > 0:
            dalpha, dbeta = 0.0, dq2 / p.a22
        dpush = -dfx
        if on_slider.by_place != 0 or on_slider.by_rate != 0:
            dx, ds = -l1 * st * dt - l2 * sp * dp - de.x, cp * psi * dp + sp * dpsi
            dspeed = -l1 * (ct * omega * dt + st * do) - l2 * ds - de.x_rate
            dpush += on_slider.by_place * dx + on_slider.by_rate * dspeed
        # e''
        dex2 = (
            -l1 * (st * dalpha + ct * (alpha * dt + 2 * omega * do) - st * omega * omega * dt)
            - l2 * (sp * dbeta + cp * (beta * dp + 2 * psi * dpsi) - sp * psi * psi * dp)
            - dpush * per_mass
        )
        dey2 = l1 * (ct * dalpha - st * (alpha * dt + 2 * omega * do) - ct * omega * omega * dt)
        dey2 += l2 * (cp * dbeta - sp * (beta * dp + 2 * psi * dpsi) - cp * psi * psi * dp)
        first, second = dex2, dey2
        if closed:  # dr'' and r dspin', with dn = t d(direction) and dt = -n d(direction)
            first = (e.nx * at.ey2 - e.ny * at.ex2) * de.direction + e.nx * dex2 + e.ny * dey2
            first += de.length * e.spin * e.spin + 2 * e.length * e.spin * de.spin
            second = e.nx * dey2 - e.ny * dex2 - (e.nx * at.ex2 + e.ny * at.ey2) * de.direction
            second -= 2 * (de.rate * e.spin + e.rate * de.spin) + turning * de.length
        k[THETA, j], k[FIRST, j], k[SECOND, j] = dalpha, first, second * per_radius


@inlined
def contact_state(joint):
    """`ContactState` of the joint's record."""
    return ContactState(joint.closed, joint.regime, joint.approach)


@compiled
def current(work, p, law):
    """Contact state and motion now; ``k`` gets the derivatives of the accelerations."""
    contact = contact_state(work.joints[NOW])
    now = motion(work.y, contact, p, law)
    derive(work.y, contact, p, now, work.k)
    return contact, now


@compiled
def inverse_effective_mass(theta, ey, dx, dy, arm, p):
    """Inverse effective mass of the ball against the socket along (dx, dy), in 1/kg.

    It is the relative acceleration along (dx, dy) by a unit force there, d A^-1 d + dx^2/m3, where
    d is the power of the force by unit rates of theta and phi, and A the mass matrix of the double
    pendulum. ``arm`` is the lever arm of the force about the ball's centre: it turns the coupler.
    """
    st, ct = sine_cosine(theta)
    sp = (ey - p.l1 * st) / p.l2
    cp = sqrt(1 - sp * sp)
    d1, d2 = p.l1 * (ct * dy - st * dx), p.l2 * (cp * dy - sp * dx) + arm
    if p.steady > 0:
        return d2 * d2 / p.a22 + dx * dx / p.m3
    coupling = p.a12 * (ct * cp + st * sp)
    determinant = p.a11 * p.a22 - coupling * coupling
    links = (p.a22 * d1 * d1 - 2 * coupling * d1 * d2 + p.a11 * d2 * d2) / determinant
    return links + dx * dx / p.m3


@inner
def write_output(row, y, at, p):
    """Fill a row of output, which has its time already, at a state with the `Motion` ``at``."""
    e, joint, omega, alpha, beta = at.eccentricity, at.joint, y[OMEGA], at.accelerations[0], at.beta
    st, ct, sp, cp, psi, x, speed = at.pose
    on_crank, on_slider = loads.on_crank(p, y[THETA], omega), loads.on_slider(p, x, speed)
    kinetic = 0.5 * (p.a11 * omega * omega + p.a22 * psi * psi + p.m3 * speed * speed)
    kinetic += p.a12 * (ct * cp + st * sp) * omega * psi
    row.crank_angle, row.crank_speed, row.crank_acceleration = y[THETA], omega, alpha
    row.driving_moment = p.moment + at.holding
    row.slider_position, row.slider_velocity, row.slider_acceleration = x, speed, at.slider
    row.coupler_angle, row.coupler_speed = angle_of(sp, cp), psi
    row.work = y[WORK] - on_crank.energy - on_slider.energy - p.g1 * st - p.g2 * sp
    row.kinetic, row.elastic = kinetic, 0.0  # the elastic energy of the joint is added at the end
    row.lost_damping, row.lost_friction = y[LOST_DAMPING], y[LOST_FRICTION]
    forces, (fx, fy) = (joint.normal, joint.tangential), _on_ball(e, at.forces)
    output = JointOutput(e.x, e.y, joint.depth, *forces, 0.0 - fx, 0.0 - fy)  # without -0.0
    stepping.write_joint(row, output)
    # the coupler's centre is accelerated by its weight and the forces on its two ends
    ax = -p.l1 * (st * alpha + ct * omega * omega) - 0.5 * p.l2 * (sp * beta + cp * psi * psi)
    ay = p.l1 * (ct * alpha - st * omega * omega) + 0.5 * p.l2 * (cp * beta - sp * psi * psi)
    row.crank_joint_force_x = p.m2 * ax - fx
    row.crank_joint_force_y = p.m2 * (ay + p.gravity) - fy
    row.crank_joint_normal_force = norm(row.crank_joint_force_x, row.crank_joint_force_y)


@compiled
def impact_depth(theta, ey, nx, ny, rate, p, law):
    """Depth at which the contact has stored the energy of an approach speed, in m.

    The bodies meet along the normal (nx, ny), where the eccentricity along y is ``ey``.
    """
    energy = rate * rate / (2 * inverse_effective_mass(theta, ey, nx, ny, 0.0, p))
    depth = law.clearance
    for _ in range(200):  # Newton's method on a convex function, from above: it always converges
        force, _ = elastic_force(law, depth)
        change = (stored_energy(law, depth) - energy) / force
        depth -= change
        if abs(change) <= 1e-6 * depth:  # the next change would be of the order of its square
            break
    return depth


@compiled
def add_free_durations(starts, impacts, p, law):
    """Fill in the durations of free elastic impacts with the approach speeds of ``impacts``, in s.

    ``starts`` are their first rows of output. A duration is twice the integral of 1/speed from 0 to
    the largest depth, where the speed vanishes. With depth = deepest (1 - x^2) the integrand is
    smooth, and d(depth) = -2 deepest x dx: hence the factor 4 x of a node x.
    """
    for i in range(len(impacts)):
        impact, row, duration = impacts[i], starts[i], 0.0
        speed = impact.approach_speed
        ny, nx = sine_cosine(direction(row.eccentricity_y, row.eccentricity_x))
        deep = impact_depth(row.crank_angle, law.clearance * ny, nx, ny, speed, p, law)
        energy = stored_energy(law, deep)
        for node, weight in zip(NODES, WEIGHTS):  # noqa: B905 (compiled code has no strict)
            left = 1 - stored_energy(law, deep * (1 - node * node)) / energy
            duration += weight * 4 * node * deep / (speed * sqrt(left))
        impact.free_duration = duration
