"""The numbers of the printed law (`study.contact.printed`), from joints solved for them.

A linear programme in each step reduces the force's largest relative error to the least.
"""

from itertools import product

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares, linprog

from study import checks
from study.contact.printed import contact_edge, lost_depth
from study.joint import Joint, Material, whole_curve
from study.joint.growth import depths_and_forces
from study.threads import one_thread

PRINTED_JOINTS = (
    (0.0, 0.1, 0.3, 0.6, 0.85, 1.0),  # shares of the ball in the compliance
    (1.25, 1.3, 1.4, 1.6, 2.0, 2.6, 4.0, 1e4),  # socket ratios
    (0.2, 0.3, 0.4),  # Poisson's ratios of the ball
    (0.2, 0.3, 0.38, 0.43, 0.46),  # and of the socket
)
"""Joints that the numbers of `study.contact.printed` are fitted to, every combination."""
PRINTED_DEPTHS = np.append([0.001, 0.003], np.linspace(0.1, 1, 16) ** 2)
PRINTED_START = {
    "b": [0.26, -0.28, 0.68],
    "c": [0.73, 0.1],
    "kn": [0.105, 1.43],
    "h": [0.77, 1.58],
    "w": [0.52, -0.7, 1.2, 1.44, -2.68],
}
"""Names and first guesses of the numbers, in the order of the unknowns."""
PRINTED_DIGITS = 4
FAR = 1e9  # R2* at which terms in 1/R2* vanish


@one_thread
def fit_printed() -> dict[str, list[float]]:
    """Numbers of `study.contact.printed` with the least largest relative error of the force.

    The joints are solved in the limit of large R2*. The numbers ``p`` of the peak pressure are
    fitted by least squares. Takes some 20 s.
    """
    joints = [joint for joint in product(*PRINTED_JOINTS) if _is_first(*joint)]
    radii = np.array([_hertz_radii(*joint) for joint in joints])
    of_bodies = np.array(joints).T[:, :, None]
    slope = np.gradient(np.log(PRINTED_DEPTHS)) / np.gradient(np.log(radii), axis=1)

    def error(unknowns):
        left = 1 - lost_depth(radii, *of_bodies, _named(unknowns))
        return (3 / slope * np.log(np.maximum(radii**2 * left, 1e-6) / PRINTED_DEPTHS)).ravel()

    start = np.concatenate(list(PRINTED_START.values()))
    found = _minimax(error, least_squares(error, start, x_scale=np.abs(start)).x)
    return {name: _printed(values) for name, values in _named(found).items()} | {"p": _fit_peak()}


def _is_first(share, socket_ratio, poisson, socket_poisson):
    """Whether a joint is the first of those that differ in a rigid body only: these are equal."""
    _, ratios, poissons, socket_poissons = PRINTED_JOINTS
    if share == 0:
        return poisson == poissons[0]
    return share < 1 or (socket_ratio, socket_poisson) == (ratios[0], socket_poissons[0])


def _hertz_radii(share, socket_ratio, poisson, socket_poisson):
    """Contact radii over R2 that Hertz gives for a joint's forces at `PRINTED_DEPTHS`."""
    joint = joint_of_share(FAR, share, socket_ratio, poisson, socket_poisson)
    depth, force = depths_and_forces(joint, 1.0, 160)
    left = depth / np.cbrt(0.75 * force / FAR) ** 2
    spline = CubicSpline(np.sqrt(np.append(0, depth)), np.append(1, left))
    return np.sqrt(PRINTED_DEPTHS / spline(np.sqrt(PRINTED_DEPTHS)))


def joint_of_share(
    r2_star: float, share: float, socket_ratio: float, poisson: float, socket_poisson: float
) -> Joint:
    """Joint whose ball has a share in the compliance, from 0 to 1 within 1e-8."""
    share = np.clip(share, 1e-8, 1 - 1e-8)
    ball = Material((1 - poisson**2) / share, poisson)
    socket = Material((1 - socket_poisson**2) / (1 - share), socket_poisson)
    return Joint(r2_star, socket_ratio, ball, socket)


def _fit_peak():
    """Numbers of the peak pressure over the mean, with exact forces."""
    rows, right = [], []
    shares, ratios, _, socket_poissons = PRINTED_JOINTS
    for share, ratio, poisson in product(shares, ratios, socket_poissons[::2]):
        curve = whole_curve(joint_of_share(FAR, share, ratio, 0.3, poisson), 1.0, 160)
        depth, force = curve.depth_star, curve.force_star / FAR
        lost = 1 - depth / np.cbrt(0.75 * force) ** 2
        mean = force / (np.pi * np.sin(contact_edge(depth, lost, share)) ** 2)
        unit = (mean / 2 / curve.peak_pressure_star)[:, None]
        rows.append(unit * np.column_stack([lost, share * depth]))
        right.append(1 - 3 * unit[:, 0])
    return _printed(np.linalg.lstsq(np.vstack(rows), np.concatenate(right))[0])


def _named(unknowns):
    ends = np.cumsum([len(values) for values in PRINTED_START.values()])[:-1]
    return dict(zip(PRINTED_START, np.split(np.asarray(unknowns), ends), strict=True))


def _printed(values):
    return [float(f"{value:.{PRINTED_DIGITS}g}") for value in values]


def _minimax(error, start):
    """Unknowns with the least largest error, by a linear programme per step in a growing range."""
    found, reach = np.asarray(start), 0.1
    for _ in range(12):
        now, each = error(found), np.diag(1e-6 * found)
        columns = np.array([error(found + one) - now for one in each]).T * 1e6 * reach
        largest = np.abs(now).max()
        near = np.abs(now) + np.abs(columns).sum(axis=1) > 0.9 * largest
        rows = np.vstack([columns[near], -columns[near]])
        rows, sides = np.column_stack([rows, -np.ones(len(rows))]), now[near]
        bounds = [(-1, 1)] * len(found) + [(0, None)]
        step = _solve(np.append(0 * found, 1), rows, np.append(-sides, sides), bounds)[:-1]
        trial = found * (1 + reach * step)
        better = np.abs(error(trial)).max() < largest
        found, reach = (trial, 1.5 * reach) if better else (found, 0.3 * reach)
        if reach < 1e-3:
            break
    return found


def _solve(cost, matrix, limits, bounds):
    found = linprog(cost, A_ub=matrix, b_ub=limits, bounds=bounds, method="highs-ds")
    if not found.success:
        raise checks.StudyError(f"coefficients were not found: {found.message}")
    return found.x
