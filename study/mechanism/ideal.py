"""Rigid links with ideal joints, the reference for all that is ideal.

The crank's angle theta is the only degree of freedom: the coupler's angle phi and the slider's
position x follow from l2 sin(phi) = -l1 sin(theta) and x = l1 cos(theta) + l2 cos(phi). With their
derivatives phi1, phi2, x1 and x2 by theta, and the symbols of `study.mechanism.rigid`,

    J theta'' + J' theta'^2 / 2 = M + S x1 - g1 cos(theta) - g2 cos(phi) phi1
    J = a11 + a22 phi1^2 + 2 a12 cos(theta - phi) phi1 + m3 x1^2

SciPy's DOP853 integrates it at its smallest tolerance, with the work of the loads.
"""

from collections import namedtuple
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from study.mechanism import loads
from study.mechanism.response import OUTPUT
from study.mechanism.scene import Scene
from study.mechanism.stepping import Block, MechanismError, new_impacts

BLOCKS = 100  # parts of a simulation, after each of which an interruption is noticed
IdealMotion = namedtuple(
    "IdealMotion", "st ct sp cp phi1 phi2 x x1 x2 alpha holding on_crank on_slider power"
)
"""Sines and cosines of theta and phi; derivatives by theta; theta''; moment that holds a constant
crank speed; loads, and their power."""


def _motion(p, theta, omega):
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
    still = 0.0 * theta
    alpha, holding = (still, -moment) if p.steady else (moment / inertia, still)
    power = holding * omega + on_crank.power + on_slider.power
    of_loads = on_crank, on_slider, power
    return IdealMotion(st, ct, sp, cp, phi1, phi2, x, x1, x2, alpha, holding, *of_loads)


def _fill(rows, p, theta, omega, work):
    """Fill rows of output, which have their times already."""
    at = _motion(p, theta, omega)
    st, ct, sp, cp, alpha = at.st, at.ct, at.sp, at.cp, at.alpha
    psi, beta = at.phi1 * omega, at.phi1 * alpha + at.phi2 * omega**2
    sd, cd = st * cp - ct * sp, ct * cp + st * sp
    speed, pull = at.x1 * omega, at.x1 * alpha + at.x2 * omega**2
    # on the slider; on the coupler the opposite, and fy from its moments
    fx = p.m3 * pull - at.on_slider.value
    turning = p.a22 * beta + p.a12 * (cd * alpha - sd * omega**2) + p.g2 * cp
    fy = -(turning - p.l2 * sp * fx) / (p.l2 * cp)
    kinetic = 0.5 * (p.a11 * omega**2 + p.a22 * psi**2 + p.m3 * speed**2)
    rows["crank_angle"], rows["crank_speed"], rows["crank_acceleration"] = theta, omega, alpha
    rows["slider_position"], rows["slider_velocity"] = at.x, speed
    rows["slider_acceleration"] = pull
    rows["coupler_angle"], rows["coupler_speed"] = np.arctan2(sp, cp), psi
    rows["normal_force"], rows["force_x"], rows["force_y"] = np.hypot(fx, fy), fx, fy
    rows["kinetic"] = kinetic + p.a12 * cd * omega * psi
    rows["work"] = work - at.on_crank.energy - at.on_slider.energy - p.g1 * st - p.g2 * sp
    rows["driving_moment"] = p.moment + at.holding
    ax = -p.l1 * (st * alpha + ct * omega**2) - 0.5 * p.l2 * (sp * beta + cp * psi**2)
    ay = p.l1 * (ct * alpha - st * omega**2) + 0.5 * p.l2 * (cp * beta - sp * psi**2)
    px, py = p.m2 * ax + fx, p.m2 * (ay + p.gravity) + fy
    rows["crank_joint_normal_force"] = np.hypot(px, py)
    rows["crank_joint_force_x"], rows["crank_joint_force_y"] = px, py


def blocks(scene: Scene, times: NDArray[np.float64]) -> Iterator[Block]:
    """Blocks of output rows at ``times`` of the scene with an ideal joint; there are no impacts."""
    from scipy.integrate import solve_ivp  # rigid links with clearance need no SciPy

    p = scene.constants()

    def slope(_, y):
        theta, omega, _ = y
        at = _motion(p, theta, omega)
        return omega, at.alpha, at.power

    # of the drive
    fast = np.sqrt((abs(p.moment) + abs(p.g1) + abs(p.g2)) / p.a11) + 1 / times[-1]
    options = {"rtol": 3e-14, "atol": (1e-15, 1e-15 * fast, 1e-15 * p.a11 * fast**2)}
    table, done = np.zeros(len(times), OUTPUT), 0
    table["time"] = times
    start, state = 0.0, (scene.initial_crank_angle, scene.starting_speed, 0.0)
    for block in np.array_split(times, min(BLOCKS, (len(times) + 1) // 2)):
        solution = solve_ivp(slope, (start, block[-1]), state, "DOP853", t_eval=block, **options)
        if not solution.success:
            raise MechanismError(f"the time integration failed after {start:.9g} s")
        start, state = block[-1], solution.y[:, -1]
        _fill(table[done : done + len(block)], p, *solution.y)
        done += len(block)
        yield table[:done], *new_impacts(0)
