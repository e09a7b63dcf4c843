"""Rigid links with ideal joints, with or without friction in the joint of coupler and slider.

The crank's angle theta is the only degree of freedom: the coupler's angle phi and the slider's
position x follow from l2 sin(phi) = -l1 sin(theta) and x = l1 cos(theta) + l2 cos(phi). With their
derivatives phi1, phi2, x1 and x2 by theta, and the symbols of `study.mechanism.rigid`,

    J theta'' + J' theta'^2 / 2 = M + S x1 - g1 cos(theta) - g2 cos(phi) phi1 + M_f phi1
    J = a11 + a22 phi1^2 + 2 a12 cos(theta - phi) phi1 + m3 x1^2

M_f = R1 T is the moment of friction on the coupler. The joint is the limit of the clearance joint
as the clearance tends to 0: the ball slides in its socket with the speed v = R1 phi', and the
reaction has the normal part N and the tangential part T = -mu c_d(v) N (`study.contact.forces`).
The reaction is a linear function of M_f, so that N^2 + T^2 gives a quadratic equation for M_f.

The motion, the work of the loads and that of friction are integrated by the method of Dormand and
Prince of order 8, with SciPy's coefficients and its estimate of the error, in a compiled loop.
Without friction it is the reference for all that is ideal.
"""

from collections import namedtuple
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from study.compiled import compiled
from study.mechanism import loads
from study.mechanism.response import OUTPUT
from study.mechanism.scene import Scene
from study.mechanism.stepping import Block, MechanismError, new_impacts

BLOCKS = 20  # parts of a simulation, after each of which an interruption is noticed
TOLERANCE = 1e-12  # relative to the angle and speed of the crank
IdealMotion = namedtuple(
    "IdealMotion",
    "st ct sp cp phi1 phi2 x x1 x2 alpha holding fx fy tangential power lost free",
)
"""Sines and cosines of theta and phi; derivatives by theta; theta''; moment that holds a constant
crank speed; force on the slider and friction force; power of the loads and of friction; and a
number that is not positive where friction locks the joint."""


def _motions(p, theta, omega):
    """`IdealMotion` at angles and speeds of the crank."""
    l1, l2, st, ct = p.l1, p.l2, np.sin(theta), np.cos(theta)
    sp = -l1 / l2 * st
    cp = np.sqrt(1 - sp**2)
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    phi1 = -l1 * ct / (l2 * cp)
    phi2 = (l1 * st + l2 * sp * phi1**2) / (l2 * cp)
    x, x1 = l1 * ct + l2 * cp, -l1 * st - l2 * sp * phi1
    x2 = -l1 * ct - l2 * cp * phi1**2 - l2 * sp * phi2
    on_crank, on_slider = loads.on_crank(p, theta, omega), loads.on_slider(p, x, x1 * omega)
    inertia = p.a11 + p.a22 * phi1**2 + 2 * p.a12 * cd * phi1 + p.m3 * x1**2
    half = p.a22 * phi1 * phi2 + p.a12 * (cd * phi2 - sd * (1 - phi1) * phi1) + p.m3 * x1 * x2
    moment = on_crank.value + on_slider.value * x1 - p.g1 * ct - p.g2 * cp * phi1
    moment = moment - half * omega**2

    def reaction(of_friction):
        """theta'', holding moment, and force on the slider, with a moment on the coupler."""
        total = moment + of_friction * phi1
        alpha, holding = (0.0 * theta, -total) if p.steady else (total / inertia, 0.0 * theta)
        beta = phi1 * alpha + phi2 * omega**2
        fx = p.m3 * (x1 * alpha + x2 * omega**2) - on_slider.value
        # fy from the moments on the coupler about its joint with the crank
        turning = p.a22 * beta + p.a12 * (cd * alpha - sd * omega**2) + p.g2 * cp - of_friction
        return alpha, holding, fx, -(turning - l2 * sp * fx) / (l2 * cp)

    # the moment has the magnitude m = c norm(F0 + m F1), c = R1 mu c_d / sqrt(1 + (mu c_d)^2)
    sliding = p.r1 * phi1 * omega
    rough = p.friction * np.minimum(np.maximum((abs(sliding) - p.v0) / (p.v1 - p.v0), 0), 1)
    c, against = p.r1 * rough / np.sqrt(1 + rough**2), -np.sign(sliding)
    (_, _, fx, fy), (_, _, gx, gy) = reaction(0.0 * theta), reaction(against)
    gx, gy = gx - fx, gy - fy
    size, cross, free = fx**2 + fy**2, fx * gx + fy * gy, 1 - c**2 * (gx**2 + gy**2)
    size = c * (c * cross + np.sqrt(np.maximum(c**2 * cross**2 + free * size, 0))) / free
    alpha, holding, fx, fy = reaction(against * size)
    tangential = against * size / p.r1
    power = holding * omega + on_crank.power + on_slider.power
    forces = holding, fx, fy, tangential, power, -tangential * sliding, free
    return IdealMotion(st, ct, sp, cp, phi1, phi2, x, x1, x2, alpha, *forces)


_motion = compiled(_motions)
"""The same at one angle and speed."""


def _fill(rows, p, theta, omega, work, lost):
    """Fill rows of output, which have their times already."""
    at = _motions(p, theta, omega)
    st, ct, sp, cp, alpha, fx, fy = at.st, at.ct, at.sp, at.cp, at.alpha, at.fx, at.fy
    psi, beta = at.phi1 * omega, at.phi1 * alpha + at.phi2 * omega**2
    speed = at.x1 * omega
    on_crank, on_slider = loads.on_crank(p, theta, omega), loads.on_slider(p, at.x, speed)
    kinetic = 0.5 * (p.a11 * omega**2 + p.a22 * psi**2 + p.m3 * speed**2)
    rows["crank_angle"], rows["crank_speed"], rows["crank_acceleration"] = theta, omega, alpha
    rows["slider_position"], rows["slider_velocity"] = at.x, speed
    rows["slider_acceleration"] = at.x1 * alpha + at.x2 * omega**2
    rows["coupler_angle"], rows["coupler_speed"] = np.arctan2(sp, cp), psi
    rows["force_x"], rows["force_y"], rows["tangential_force"] = fx, fy, at.tangential
    rows["normal_force"] = np.sqrt(np.maximum(fx**2 + fy**2 - at.tangential**2, 0))
    rows["kinetic"] = kinetic + p.a12 * (ct * cp + st * sp) * omega * psi
    rows["work"] = work - on_crank.energy - on_slider.energy - p.g1 * st - p.g2 * sp
    rows["lost_friction"] = lost
    rows["driving_moment"] = p.moment + at.holding
    ax = -p.l1 * (st * alpha + ct * omega**2) - 0.5 * p.l2 * (sp * beta + cp * psi**2)
    ay = p.l1 * (ct * alpha - st * omega**2) + 0.5 * p.l2 * (cp * beta - sp * psi**2)
    px, py = p.m2 * ax + fx, p.m2 * (ay + p.gravity) + fy
    rows["crank_joint_normal_force"] = np.hypot(px, py)
    rows["crank_joint_force_x"], rows["crank_joint_force_y"] = px, py


@compiled
def _slope(p, y, slope):
    """Fill in the rates of (theta, theta', work, energy lost); say if friction locks the joint."""
    at = _motion(p, y[0], y[1])
    slope[0], slope[1], slope[2], slope[3] = y[1], at.alpha, at.power, at.lost
    return not at.free > 0


@compiled
def _advance(times, clock, y, p, smallest, tableau, states):
    """Fill the states at times; ``clock`` is the time and step before and after; say if it failed.

    A step is accepted if its error, relative to the state and to the ``smallest`` numbers, is at
    most the tolerance; the next one follows from the error, which is of order 8.
    """
    matrix, weights, third, fifth = tableau
    slopes, stage = np.zeros((len(weights), 4)), y.copy()
    for n in range(len(times)):
        while clock[0] < times[n]:
            h = min(clock[1], times[n] - clock[0])
            for i in range(len(weights)):
                stage[:] = y
                for j in range(i):
                    stage += h * matrix[i, j] * slopes[j]
                if _slope(p, stage, slopes[i]):
                    return True
            stage[:] = y
            error3 = error5 = 0.0
            for k in range(4):
                change = coarse = fine = 0.0
                for i in range(len(weights)):
                    change += h * weights[i] * slopes[i, k]
                    coarse += h * third[i] * slopes[i, k]
                    fine += h * fifth[i] * slopes[i, k]
                stage[k] += change
                scale = TOLERANCE * (smallest[k] + max(abs(y[k]), abs(stage[k])))
                error3 += (coarse / scale) ** 2
                error5 += (fine / scale) ** 2
            error = error5 / np.sqrt(4 * (error5 + 0.01 * error3)) if error5 > 0 else 0.0
            if error <= 1:
                clock[0] = times[n] if h == times[n] - clock[0] else clock[0] + h
                y[:] = stage
            factor = 10.0 if error == 0 else min(10.0, max(0.2, 0.9 * error ** (-1 / 8)))
            # a step that an output has cut short does not shorten the next one
            clock[1] = max(clock[1], h * factor) if error <= 1 else h * factor
            if not clock[1] > 1e-15 * times[-1]:  # NaN too
                return True
        states[n] = y
    return False


def blocks(scene: Scene, times: NDArray[np.float64], friction: bool) -> Iterator[Block]:
    """Blocks of output rows at ``times`` of the scene with an ideal joint; there are no impacts."""
    from scipy.integrate import DOP853  # rigid links with clearance need no SciPy

    p = scene.constants()
    p = p if friction else p._replace(friction=0.0)
    fast = np.sqrt((abs(p.moment) + abs(p.g1) + abs(p.g2)) / p.a11) + 1 / times[-1]  # of the drive
    smallest = np.array([1, fast, p.a11 * fast**2, p.a11 * fast**2])
    # E3 and E5 have a last number for the slope at the end of a step, which is 0
    tableau = DOP853.A, DOP853.B, DOP853.E3[:-1].copy(), DOP853.E5[:-1].copy()
    table, done, states = np.zeros(len(times), OUTPUT), 0, np.zeros((len(times), 4))
    table["time"] = times
    clock = np.array([0.0, min(1e-3 / fast, times[-1])])
    y = np.array([scene.initial_crank_angle, scene.starting_speed, 0.0, 0.0])
    for block in np.array_split(times, min(BLOCKS, (len(times) + 1) // 2)):
        part = slice(done, done + len(block))
        if _advance(block, clock, y, p, smallest, tableau, states[part]):
            what = f"the time integration failed after {clock[0]:.9g} s"
            if p.friction > 0:
                what += (
                    f", because a friction of {p.friction:g} locks a ball of radius {p.r1:g} m, or "
                    "the friction changes too fast with the sliding speed; change one of them, or "
                    "simulate the joint with clearance"
                )
            raise MechanismError(what)
        _fill(table[part], p, *states[part].T)
        done += len(block)
        yield table[:done], *new_impacts(0)
