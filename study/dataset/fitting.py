"""Coefficients of laws from force-depth curves, by least squares.

The paper's two steps: one coefficient f1 per case, then a surrogate of f1 over R2*. The
surrogate is a straight line, because P* -> R2* F(ds) as R2* grows, with an intercept for the
next order in 1/R2*; its coefficients are ours, the paper's are lost. Liu's coefficient follows
from a published number. Those of `stiffened_hertz` make its largest relative error as small as
can be.
"""

import json
import re
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares, linprog

from study import checks
from study.contact import LAWS, LawName, hertz, shapes
from study.contact.laws import AREA_COEFFICIENTS, stiffening_scale, stiffening_terms
from study.contact.printed import contact_edge, lost_depth
from study.dataset.design import PAPER_KINEMATICS, R2_STAR
from study.joint import Joint, Material, whole_curve
from study.joint.growth import depths_and_forces

FITTED_LAWS: dict[str, tuple[LawName, dict]] = {
    name: ("hyperbolic_winkler", {"area": area}) for area, name in AREA_COEFFICIENTS.items()
} | {"winkler": ("winkler", {})}
"""Name of the coefficients -> law and its options."""
SLACK = 1.05  # of the largest error, for fewer coefficients
REACH, POLE = 0.6, 1.8  # constants of stiffened_hertz, chosen for the smallest error
DIGITS = 7  # of a coefficient, and decimals of those of stiffened_hertz: 1e-6 of the force
LARGEST_DEPTH = 0.5  # of the fit, in dR, as in the paper
SAMPLE = np.linspace(0, LARGEST_DEPTH, 21)
"""Depths of the paper's measures of agreement, identified from Table 2 (notebook 13)."""
LARGEST_R2_STAR = 300  # of the surrogate's fit, as in the paper


def coefficient(law: str, depth_star: ArrayLike, force_star: ArrayLike) -> float:
    """Coefficient f1 that minimises the sum of (P* - f1 f2(ds))^2 over one case's curve.

    Parameters
    ----------
    law
        A key of `FITTED_LAWS`.
    depth_star, force_star
        Shape (n,); at least one depth > 0.
    """
    depth, force = checks.same_length(depth_star=depth_star, force_star=force_star)
    f2 = shape(law, depth)
    if not f2.any():
        raise ValueError(f"depth_star must hold a depth > 0 to fit to, got {checks.shown(depth)}")
    return float(f2 @ force / (f2 @ f2))


def shape(law: str, depth_star: ArrayLike) -> NDArray[np.float64]:
    """Function f2 of a law: its force with the coefficient 1."""
    name, options = FITTED_LAWS[checks.choice("law", law, FITTED_LAWS)]
    return LAWS[name](depth_star, 2.0, coefficient=1.0, **options)


def sampled(curve: pd.DataFrame) -> NDArray[np.float64]:
    """Forces of one case of the dataset at the depths of `SAMPLE`: 0 at no depth, shape (21,)."""
    checks.frame("curve", curve, ("depth_star", "force_star"))
    inside = curve[curve.depth_star <= LARGEST_DEPTH]
    if len(inside) != len(SAMPLE) - 1 or not np.allclose(inside.depth_star, SAMPLE[1:]):
        raise ValueError(f"curve must have the depths {SAMPLE[1]:g} to {SAMPLE[-1]:g} of SAMPLE")
    return np.append(0, inside.force_star)


def coefficients_by_case(law: str, curves: pd.DataFrame) -> pd.DataFrame:
    """Coefficient ``f1`` of every case of one set-up, by ``r2_star``, to a depth of 0.5.

    Parameters
    ----------
    law
        A key of `FITTED_LAWS`.
    curves
        Rows of `study.dataset.load`.
    """
    checks.frame("curves", curves, ("r2_star", "depth_star", "force_star"))
    inside = checks.frame("curves", curves[curves.depth_star <= LARGEST_DEPTH], ())
    rows = [
        (r2_star, coefficient(law, case.depth_star, case.force_star))
        for r2_star, case in inside.groupby("r2_star")
    ]
    return pd.DataFrame(rows, columns=["r2_star", "f1"])


def surrogate(r2_star: ArrayLike, f1: ArrayLike) -> dict[str, float]:
    """``slope`` and ``intercept`` of the line f1 = slope R2* + intercept, by least squares."""
    x, y = checks.same_length(2, r2_star=r2_star, f1=f1)
    if not np.ptp(x) > 1e-9 * np.abs(x).max():
        raise ValueError(f"r2_star must vary for a line, got only {x[0]:g}")
    slope, intercept = np.polyfit(x, y, 1)
    return {"slope": _rounded(slope), "intercept": _rounded(intercept)}


def _rounded(value):
    return float(f"{value:.{DIGITS}g}")


def liu_coefficient(force_star: ArrayLike, published_r_squared: float, unit: ArrayLike) -> float:
    """Coefficient of Liu's law, P* = c R2* (...), that gives it the R2 of the paper's Table 2.

    That R2 depends on the mean difference of law and finite elements only
    (`study.claims.statistics.r_squared_as_published`), and Liu's law is the smaller of the two.

    Parameters
    ----------
    force_star
        Forces at `SAMPLE`, for the R2* of Table 2.
    published_r_squared
        With its sign, negative.
    unit
        The law's force over c R2* at the same depths but 0, shape (20,).
    """
    (force,) = checks.same_length(2, force_star=force_star)
    checks.number("published_r_squared", published_r_squared, most=1, scalar=True)
    (shape,) = checks.same_length(unit=unit)
    if shape.sum() == 0:
        raise ValueError("unit must not be 0 throughout, got only 0")
    missing = np.sqrt((1 - published_r_squared) * np.sum((force - force.mean()) ** 2))
    return float((force.sum() - missing) / (R2_STAR * shape.sum()))


def fit_all(curves: pd.DataFrame, published: pd.DataFrame) -> dict[str, dict]:
    """All of `study.contact.laws.fitted_coefficients`, from the dataset.

    ``published`` is ``data/published/tables.csv``, for Liu's law.
    """
    paper = curves[(curves.group == "paper") & (curves.kinematics == PAPER_KINEMATICS)]
    stated = published.set_index(["where", "row", "quantity"]).value
    fits = fit_laws(paper, -stated["Table 2", "liu", "R2"])  # printed without its sign
    stiffening = fit_stiffening(curves[curves.group == "fit"])
    return fits | {"stiffened_hertz": stiffening, "printed_hertz": fit_printed()}


def fit_laws(curves: pd.DataFrame, liu_r_squared: float) -> dict[str, dict[str, float]]:
    """``slope`` and ``intercept`` by law of the paper that has them, over its 20 <= R2* <= 300.

    The curves are those of one set-up; ``liu_r_squared`` is Liu's published R2 with its sign.
    """
    checks.frame("curves", curves, ("r2_star", "depth_star", "force_star"))
    fits = {}
    for law in FITTED_LAWS:
        cases = coefficients_by_case(law, curves[curves.r2_star <= LARGEST_R2_STAR])
        fits[law] = surrogate(cases.r2_star, cases.f1)
    force, (unit, _) = sampled(curves[curves.r2_star == R2_STAR]), shapes.liu(SAMPLE[1:], ())
    slope = liu_coefficient(force, liu_r_squared, unit)
    return fits | {"liu": {"slope": _rounded(slope), "intercept": 0.0}}


def fit_stiffening(curves: pd.DataFrame) -> dict[str, object]:
    """Coefficients of `study.contact.stiffened_hertz`, by linear programming.

    The coefficients enter S linearly. The largest relative error over all curves is within
    `SLACK` of the smallest one; the sum of the scaled coefficients' sizes is then the smallest,
    which leaves most of them at zero.

    The curves are the dataset's group ``fit``, in several kinematics.

    Returns
    -------
    dict
        Constants ``reach`` and ``pole``; lists of shape (5, 9): ``limit``, and ``first_order`` by
        kinematics.
    """
    keys = ["kinematics", "r2_star", "socket_ratio", "poisson_ball"]
    checks.frame("curves", curves, (*keys, "depth_star", "force_star"))
    kinds = list(dict.fromkeys(curves.kinematics))
    rows, right = [], []
    for (kind, r2_star, ratio, poisson), case in curves.groupby(keys, sort=False):
        ds = case.depth_star.to_numpy()
        stiffening = case.force_star.to_numpy() / hertz(ds, r2_star)
        u = np.sqrt(ds) / (np.sqrt(ds) + stiffening_scale(ratio, REACH))
        powers = np.column_stack([u, u**2, ds, ds**2, ds**3])
        terms = (powers[:, :, None] * stiffening_terms(ratio, poisson, POLE)).reshape(len(ds), -1)
        blocks = [terms, *(terms / r2_star * (kind == other) for other in kinds)]
        rows.append(np.hstack(blocks) / stiffening[:, None])
        right.append(1 - 1 / stiffening)
    found = _sparse_minimax(np.vstack(rows), np.concatenate(right))
    matrices = np.round(found.reshape(1 + len(kinds), 5, 9), DIGITS - 1) + 0.0  # no -0
    limit, *first_order = matrices.tolist()
    first_order = dict(zip(kinds, first_order, strict=True))
    return {"reach": REACH, "pole": POLE, "limit": limit, "first_order": first_order}


def _sparse_minimax(matrix, right):
    """A sparse x whose largest |matrix x - right| is `SLACK` times the smallest possible."""
    scale = np.abs(matrix).max(axis=0)
    rows, unknowns = np.vstack([matrix / scale, -matrix / scale]), len(scale)
    sides = np.concatenate([right, -right])
    with_bound = np.hstack([rows, -np.ones((len(rows), 1))])
    free = [(None, None)] * unknowns
    best = _solve(np.append(np.zeros(unknowns), 1.0), with_bound, sides, [*free, (0, None)])
    halves = np.hstack([rows, -rows])  # positive and negative parts of x: their sum is the least
    limits = sides + SLACK * best[-1]
    parts = _solve(np.ones(2 * unknowns), halves, limits, [(0, None)] * (2 * unknowns))
    return (parts[:unknowns] - parts[unknowns:]) / scale


def _solve(cost, matrix, limits, bounds):
    found = linprog(cost, A_ub=matrix, b_ub=limits, bounds=bounds, method="highs-ds")
    if not found.success:
        raise checks.StudyError(f"coefficients were not found: {found.message}")
    return found.x


def format_coefficients(fits: dict[str, dict]) -> str:
    """JSON text of all fitted coefficients, a matrix row per line."""
    text = json.dumps(fits, indent=2)
    inner = re.compile(r"\[([^\[\]]*)\]")
    return inner.sub(lambda row: f"[{' '.join(row[1].split())}]", text) + "\n"


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
FAR = 1e9  # R2* at which terms in 1/R2* are nothing


def fit_printed() -> dict[str, list[float]]:
    """Numbers of `study.contact.printed`, so that the force's largest relative error is least.

    The joints are solved in the limit of large R2*. Those of the peak pressure, ``p``, are by
    least squares. Takes some 20 s.
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
    """A ball without a share, or a socket, need not vary."""
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
        unit = (mean / 2 / curve.peak_pressure)[:, None]
        rows.append(unit * np.column_stack([lost, share * depth]))
        right.append(1 - 3 * unit[:, 0])
    return _printed(np.linalg.lstsq(np.vstack(rows), np.concatenate(right))[0])


def _named(unknowns):
    ends = np.cumsum([len(values) for values in PRINTED_START.values()])[:-1]
    return dict(zip(PRINTED_START, np.split(np.asarray(unknowns), ends), strict=True))


def _printed(values):
    return [float(f"{value:.{PRINTED_DIGITS}g}") for value in values]


def _minimax(error, start):
    """Unknowns whose largest error is least: a linear programme a step, in a growing range."""
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
