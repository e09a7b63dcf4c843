"""Rigid links with ideal joints, the reference for all that is ideal.

The crank's angle is the only degree of freedom. SciPy's DOP853 integrates it at its smallest
tolerance. At constant crank speed the motion is known, and the drive's work is integrated.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from study.mechanism.response import OUTPUT
from study.mechanism.rigid import Pose, loads, work_of_loads
from study.mechanism.scene import Scene
from study.mechanism.stepping import Block, MechanismError, new_impacts

BLOCKS = 100
"""Parts of a simulation, after each of which an interruption is heeded."""


def _kinematics(p, theta):
    """Pose at angles of the crank; first and second derivatives of coupler's angle and slider."""
    l1, l2, st, ct = p.l1, p.l2, np.sin(theta), np.cos(theta)
    sp = -l1 / l2 * st
    cp = np.sqrt(1 - sp**2)
    phi1 = -l1 * ct / (l2 * cp)
    phi2 = (l1 * st + l2 * sp * phi1**2) / (l2 * cp)
    x1 = -l1 * st - l2 * sp * phi1
    x2 = -l1 * ct - l2 * cp * phi1**2 - l2 * sp * phi2
    return Pose(st, ct, sp, cp, l1 * ct + l2 * cp), phi1, phi2, x1, x2


def _drive(p, theta, omega):
    """Acceleration of the crank, and the moment on it."""
    pose, phi1, phi2, x1, x2 = _kinematics(p, theta)
    st, ct, sp, cp = pose.st, pose.ct, pose.sp, pose.cp
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    load = loads(p, pose)
    inertia = p.a11 + p.a22 * phi1**2 + 2 * p.a12 * cd * phi1 + p.m3 * x1**2
    half = p.a22 * phi1 * phi2 + p.a12 * (cd * phi2 - sd * (1 - phi1) * phi1) + p.m3 * x1 * x2
    moment = load.drive + load.crank + load.coupler * phi1 - half * omega**2
    if p.steady:
        return 0.0 * theta, -moment
    return moment / inertia, load.drive + 0.0 * theta


def _fill(rows, p, theta, omega, driven):
    """Fill rows of output, which have their times already; ``driven`` is the drive's work."""
    (pose, phi1, phi2, x1, x2), (alpha, moment) = _kinematics(p, theta), _drive(p, theta, omega)
    st, ct, sp, cp = pose.st, pose.ct, pose.sp, pose.cp
    load = loads(p, pose)
    psi, beta = phi1 * omega, phi1 * alpha + phi2 * omega**2
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    pull = x1 * alpha + x2 * omega**2
    # on the slider; on the coupler the opposite, and fy from its moments
    fx = p.m3 * pull
    turning = p.a22 * beta + p.a12 * (cd * alpha - sd * omega**2) - load.coupler
    fy = -(turning - p.l2 * sp * fx) / (p.l2 * cp)
    kinetic = 0.5 * (p.a11 * omega**2 + p.a22 * psi**2 + p.m3 * (x1 * omega) ** 2)
    rows["crank_angle"], rows["crank_speed"], rows["crank_acceleration"] = theta, omega, alpha
    rows["slider_position"], rows["slider_velocity"] = pose.slider, x1 * omega
    rows["slider_acceleration"] = pull
    rows["coupler_angle"], rows["coupler_speed"] = np.arctan2(sp, cp), psi
    rows["normal_force"], rows["force_x"], rows["force_y"] = np.hypot(fx, fy), fx, fy
    rows["kinetic"] = kinetic + p.a12 * cd * omega * psi
    rows["work"], rows["driving_moment"] = work_of_loads(p, pose, driven), moment
    ax = -p.l1 * (st * alpha + ct * omega**2) - 0.5 * p.l2 * (sp * beta + cp * psi**2)
    ay = p.l1 * (ct * alpha - st * omega**2) + 0.5 * p.l2 * (cp * beta - sp * psi**2)
    px, py = p.m2 * ax + fx, p.m2 * (ay - load.fall) + fy
    rows["crank_joint_normal_force"] = np.hypot(px, py)
    rows["crank_joint_force_x"], rows["crank_joint_force_y"] = px, py


def blocks(scene: Scene, times: NDArray[np.float64]) -> Iterator[Block]:
    """Blocks of output rows at ``times`` of the scene with an ideal joint; there are no impacts."""
    from scipy.integrate import solve_ivp  # rigid links with clearance need no SciPy

    p, angle, speed = scene.constants(), scene.initial_crank_angle, scene.starting_speed

    def slope(t, y):
        if p.steady:
            _, moment = _drive(p, angle + speed * t, speed)
            return (moment * speed,)
        theta, omega = y
        alpha, _ = _drive(p, theta, omega)
        return omega, alpha

    def motion(t, y):
        """Angle and speed of the crank, and the drive's work, at times of a solution."""
        if p.steady:
            return angle + speed * t, np.full(len(t), speed), y[0]
        return y[0], y[1], p.moment * y[0]

    # of the drive
    fast = np.sqrt((abs(p.moment) + abs(p.g1) + abs(p.g2)) / p.a11) + 1 / times[-1]
    atol = 1e-15 * p.a11 * fast**2 if p.steady else (1e-15, 1e-15 * fast)
    table, done = np.zeros(len(times), OUTPUT), 0
    table["time"] = times
    start, state = 0.0, (0.0,) if p.steady else (angle, speed)
    for block in np.array_split(times, min(BLOCKS, (len(times) + 1) // 2)):
        span = start, block[-1]
        options = {"t_eval": block, "rtol": 3e-14, "atol": atol}
        solution = solve_ivp(slope, span, state, "DOP853", **options)
        if not solution.success:
            raise MechanismError(f"the time integration failed after {start:.9g} s")
        start, state = block[-1], solution.y[:, -1]
        _fill(table[done : done + len(block)], p, *motion(block, solution.y))
        done += len(block)
        yield table[:done], *new_impacts(0)
