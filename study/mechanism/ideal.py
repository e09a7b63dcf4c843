"""Rigid links with ideal joints, the reference for all that is ideal.

The crank's angle is the only degree of freedom. SciPy's DOP853 integrates it at its smallest
tolerance. At constant crank speed the motion is known, and the drive's work is integrated.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from study.mechanism.response import ALL_COLUMNS
from study.mechanism.scene import Scene
from study.mechanism.stepping import Block, MechanismError, new_impacts

BLOCKS = 100
"""Parts of a simulation, after each of which an interruption is heeded."""


def blocks(scene: Scene, times: NDArray[np.float64]) -> Iterator[Block]:
    """Blocks of output rows at ``times`` of the scene with an ideal joint; there are no impacts."""
    from scipy.integrate import solve_ivp  # rigid links with clearance need no SciPy

    p = scene.constants()
    l1, l2, a11, a22, a12, m3, moment, g1, g2 = p[:9]
    angle, speed = scene.initial_crank_angle, scene.starting_speed

    def kinematics(theta):
        st, ct = np.sin(theta), np.cos(theta)
        sp = -l1 / l2 * st
        cp = np.sqrt(1 - sp**2)
        phi1 = -l1 * ct / (l2 * cp)
        phi2 = (l1 * st + l2 * sp * phi1**2) / (l2 * cp)
        x1 = -l1 * st - l2 * sp * phi1
        x2 = -l1 * ct - l2 * cp * phi1**2 - l2 * sp * phi2
        return st, ct, sp, cp, phi1, phi2, x1, x2

    def drive(theta, omega):
        """Acceleration of the crank, and the moment on it."""
        st, ct, sp, cp, phi1, phi2, x1, x2 = kinematics(theta)
        sd, cd = st * cp - ct * sp, ct * cp + st * sp
        inertia = a11 + a22 * phi1**2 + 2 * a12 * cd * phi1 + m3 * x1**2
        half = a22 * phi1 * phi2 + a12 * (cd * phi2 - sd * (1 - phi1) * phi1) + m3 * x1 * x2
        if p.steady:
            return 0.0 * theta, g1 * ct + g2 * cp * phi1 + half * omega**2
        return (moment - g1 * ct - g2 * cp * phi1 - half * omega**2) / inertia, moment + 0.0 * theta

    def slope(t, y):
        if p.steady:
            return (drive(angle + speed * t, speed)[1] * speed,)
        return y[1], drive(*y)[0]

    def rows(times, theta, omega, done):
        st, ct, sp, cp, phi1, phi2, x1, x2 = kinematics(theta)
        alpha, needed = drive(theta, omega)
        psi, beta = phi1 * omega, phi1 * alpha + phi2 * omega**2
        sd, cd = st * cp - ct * sp, ct * cp + st * sp
        pull = x1 * alpha + x2 * omega**2
        fx = m3 * pull  # on the slider; on the coupler the opposite, and fy from its moments
        fy = -(a22 * beta + a12 * (cd * alpha - sd * omega**2) + g2 * cp - l2 * sp * fx) / (l2 * cp)
        kinetic = 0.5 * (a11 * omega**2 + a22 * psi**2 + m3 * (x1 * omega) ** 2)
        kinetic += a12 * cd * omega * psi
        zero = np.zeros_like(theta)
        columns = (times, theta, l1 * ct + l2 * cp, omega, x1 * omega, alpha, pull)
        columns += (np.arctan2(sp, cp), psi, zero, zero, zero, np.hypot(fx, fy), zero, fx, fy)
        columns += (done - g1 * st - g2 * sp, kinetic, zero, zero, zero, needed)
        ax = -l1 * (st * alpha + ct * omega**2) - 0.5 * l2 * (sp * beta + cp * psi**2)
        ay = l1 * (ct * alpha - st * omega**2) + 0.5 * l2 * (cp * beta - sp * psi**2)
        mass = scene.coupler_mass
        px, py = mass * ax + fx, mass * (ay + scene.gravity) + fy
        columns += (zero, zero, zero, np.hypot(px, py), zero, px, py)
        return np.column_stack(columns)

    fast = np.sqrt((abs(moment) + abs(g1) + abs(g2)) / a11) + 1 / times[-1]  # of the drive
    atol = 1e-15 * a11 * fast**2 if p.steady else (1e-15, 1e-15 * fast)
    table, done = np.zeros((len(times), len(ALL_COLUMNS))), 0
    start, state = 0.0, (0.0,) if p.steady else (angle, speed)
    for block in np.array_split(times, min(BLOCKS, (len(times) + 1) // 2)):
        span = start, block[-1]
        solution = solve_ivp(slope, span, state, "DOP853", t_eval=block, rtol=3e-14, atol=atol)
        if not solution.success:
            raise MechanismError(f"the integrator failed after {start:.9g} s")
        start, state = block[-1], solution.y[:, -1]
        if p.steady:
            motion = angle + speed * block, np.full(len(block), speed), solution.y[0]
        else:
            motion = *solution.y, moment * solution.y[0]
        table[done : done + len(block)] = rows(block, *motion)
        done += len(block)
        yield table[:done], *new_impacts(0, len(ALL_COLUMNS))
