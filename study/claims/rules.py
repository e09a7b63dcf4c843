"""The rules by which the paper's statements are judged: a number per reading, from results.

A rule reads results from ``figures/`` and gives one number, or one per reading: a model,
material, duration or socket radius that the paper's text allows. Its arguments are the words in
the claim's column ``of``.
"""

import re
from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd

from study import checks, contact, dataset, paths
from study.claims import statistics
from study.dataset.design import case_name

RULES: dict[str, Callable[[str], dict[str, float]]] = {}
"""Name of a rule -> function(of) -> {reading: number}."""

PAPER = "the paper's joint"
LAWS = contact.PAPER_LAWS
PROPOSED = "hyperbolic_winkler"
EARLY = 10.0  # ms: the first impacts
DURATIONS = (50, 100, 200)  # ms: the paper states none
FIT = 0.5  # largest depth of the fits
FIRST = 0.025  # least depth of the dataset
MODELS = {"rigid": "rigid links", "particles": "particles", "beams": "finite elements"}
MATERIALS = {
    "poisson": ("Poisson's ratio", 0.3, 0.2, 0.4),
    "modulus_ratio": ("moduli", 1.0, 1 / 3, 3),
}
"""Name, usual value, and the range of metals; the ratio is the socket's modulus over the ball's."""
RATIOS = "ratios 1.1 to 3"

PER_MODEL = {name: (model,) for model, name in MODELS.items()}
PER_DURATION = {f"{name}, {end} ms": (m, end) for end in DURATIONS for m, name in MODELS.items()}
"""Readings: name -> arguments of a rule's function after the words of ``of``."""

LAW = f"({'|'.join(LAWS)})"
SOME_LAWS = f"{LAW}( {LAW})*"
NUMBER = r"\d+\.?\d*"
RANGE = f"{NUMBER} {NUMBER}"
KINEMATICS = "(small|linear|finite)"


class ClaimError(checks.StudyError):
    """A claim cannot be judged; the message names it and what is missing."""


def define(name: str, number: Callable[..., Any], of: str = "", readings: dict | None = None):
    """Add a rule: its name, function of the words of ``of``, their pattern, and its readings.

    Without ``readings`` the function returns one number, or a dictionary of readings.
    """
    RULES[name] = partial(_apply, name, number, of, readings)
    return number


def rule(of="", readings=None):
    """Make a function a rule under its own name."""
    return lambda function: define(function.__name__, function, of, readings)


def _apply(name, number, pattern, readings, of):
    if not isinstance(of, str) or not re.fullmatch(pattern, of):
        wanted = f"of must be {pattern or 'empty'!r} for rule {name}"
        raise ClaimError(f"{wanted}, got {checks.shown(of)}")
    words = [float(word) if re.fullmatch(NUMBER, word) else word for word in of.split()]
    if readings:
        return {name: float(number(*words, *reading)) for name, reading in readings.items()}
    found = number(*words)
    return found if isinstance(found, dict) else {PAPER: found}


@cache
def result(name: str) -> pd.DataFrame:
    """One result's numbers, from ``figures/``; ``ClaimError`` if they are missing."""
    path = paths.FIGURES / f"{name}.csv"
    if not path.is_file():
        raise ClaimError(f"figures/{name}.csv is missing; make it with: study run {name}")
    return pd.read_csv(path)


def _table_2(column):
    return result("table2").pivot(index="law", columns="quantity", values=column)


def _trend(prefix="", least=FIRST):
    """Forces (or slopes, exponents) of the elastic solution and of the laws over depth."""
    table = result("trend").set_index("depth_star")
    table = table[[f"{prefix}{name}" for name in ("exact", *LAWS)]]
    return table.rename(columns=lambda name: name.removeprefix(prefix))[table.index >= least]


def _errors(least=FIRST):
    """Relative errors of the paper's laws, in percent."""
    table = _trend(least=least)
    return 100 * (table[list(LAWS)].div(table.exact, axis=0) - 1)


def _inside(table, low=0.0, high=FIT):
    return table[(table.index > low) & (table.index <= high + 1e-9)]


def _at(table, depth):
    return table.iloc[np.abs(table.index - depth).argmin()]


def _radii(kinematics="linear"):
    return result("fig14").query("kinematics == @kinematics").set_index("r2_star")


def _rise(numbers):
    """The last number over the first."""
    return numbers.iloc[-1] / numbers.iloc[0]


# ---- Tables 1 and 2 ----

# A number of Table 1; the absolute value of one of Table 2, by the paper's definitions
define(
    "table_1",
    lambda quantity: {"this study": result("table1").set_index("quantity").ours[quantity]},
    "determination|determination_adjusted|RMSE|RE_min_percent|RE_max_percent",
)
define(
    "table_2",
    lambda law, name: abs(_table_2("ours")[name][law]),
    f"{LAW} (determination|determination_adjusted|RMSE)",
)
# Absolute coefficient of determination of some laws by its definition
define(
    "correct_determination",
    lambda *laws: dict(_table_2("correct").determination.abs()[[*laws]].rename(str.capitalize)),
    SOME_LAWS,
)
# Number of the five laws with the rank by RMSE that they have in Table 2
define("order", lambda: (_table_2("ours").RMSE.rank() == _table_2("published").RMSE.rank()).sum())
# RMSE of the fitted Winkler law over that of the proposed one
define("improvement", lambda: _table_2("ours").RMSE["winkler"] / _table_2("ours").RMSE[PROPOSED])


# ---- force against depth ----


@rule(SOME_LAWS)
def crossing(*laws):
    """Depth beyond which the proposed law is closer than some others."""
    error = _inside(_errors().abs())
    depth = error.index.to_numpy()
    leads = {law.capitalize(): error[law] - error[PROPOSED] for law in laws}
    return {law: statistics.last_crossing(depth, lead) for law, lead in leads.items()}


@rule(f"{RANGE}( {LAW})+")
def growth(first, second, *laws):
    """Least absolute relative error at the second depth over that at the first, of some laws."""
    error = _errors(0.005)[list(laws)].abs()
    return (_at(error, second) / _at(error, first)).min()


@rule(LAW)
def scaled_fit(rival):
    """RMSE of the proposed law over that of another, each times the factor that fits it best."""
    table, left = _inside(_trend()), {}
    for law in (PROPOSED, rival):
        factor = (table[law] @ table.exact) / (table[law] @ table[law])
        left[law] = statistics.rmse(table.exact, factor * table[law])
    return left[PROPOSED] / left[rival]


# Depth beyond which the proposed law is closer than all of some others
define("last_crossing", lambda *laws: max(crossing(*laws).values()), SOME_LAWS)


@rule(f"(force|slope|exponent) {RANGE} {LAW}( {LAW})+")
def closest(quantity, low, high, law, *others):
    """Share of depths (from, to) at which a law is closer than all others, in percent."""
    values = _inside(_trend("" if quantity == "force" else f"{quantity}_"), low, high)
    error = values.sub(values.exact, axis=0).abs()
    return 100 * error[list(others)].gt(error[law], axis=0).all(axis=1).mean()


@rule()
def best_exponent():
    """Share of depths up to 0.5 at which the proposed law's exponent is the closest, percent."""
    sets = {"of five": {PROPOSED}, "without Liu's law": {PROPOSED, "liu"}}
    rivals = {name: [law for law in LAWS if law not in left] for name, left in sets.items()}
    return {name: closest("exponent", 0, FIT, PROPOSED, *laws) for name, laws in rivals.items()}


@rule(readings={"depth 0.1": (0.1,), "depth 0.5": (0.5,)})
def half_angle(depth):
    """Contact half-angle of Eq. 21 over that of the elastic solution."""
    table = result("fig06").query("panel == 'b'").pivot(index="x", columns="part", values="y")
    return _at(table[PROPOSED] / table.exact, depth)


@rule()
def arc():
    """Growth of the contact half-angle with depth at 0.5 over that at 0.1."""
    angle = result("trend").set_index("depth_star").contact_half_angle_deg
    rate = pd.Series(np.gradient(angle, angle.index), angle.index)
    return _at(rate, 0.5) / _at(rate, 0.1)


@rule(RANGE)
def overall_error(low, high):
    """Relative RMSE of the proposed law between two depths, in percent."""
    table = _inside(_trend(), low, high)
    return 100 * statistics.relative_rmse(table.exact, table[PROPOSED])


@rule()
def start():
    """Number of Hertz's and Steuermann's laws that are closer as contact begins."""
    error = _errors(0.005).iloc[0].abs()
    return (error[["hertz", "steuermann"]] < error[PROPOSED]).sum()


# ---- socket radius, other parameters, scale ----

# Least adjusted R2 (the paper's definition) of the proposed law over a range of R2*
define(
    "least_determination",
    lambda low, high: _radii().loc[low:high].determination_adjusted.min(),
    RANGE,
)
# 1 - R2 (the paper's definition) at the largest R2* over that at the least, by kinematics
define(
    "unexplained",
    lambda *kinds: {kind: _rise(1 - _radii(kind).determination) for kind in kinds},
    f"{KINEMATICS}( {KINEMATICS})*",
)
# Relative RMSE in percent: at the largest R2*, there over that at the smallest, at any
define("relative_rmse", lambda: _radii().relative_RMSE_percent.iloc[-1])
define("rise", lambda: _rise(_radii().relative_RMSE_percent))
define("worst_relative_rmse", lambda: _radii().relative_RMSE_percent.max())
# ... and the largest relative error from a depth of 0.1 on
define(
    "worst_errors",
    lambda: {
        "relative RMSE": _radii().relative_RMSE_percent.max(),
        "largest relative error": result("fig15")["from_0.1_percent"].max(),
    },
)
# Largest |relative error| up to a depth of 0.5, the largest over the least of any R2*
define(
    "spread_over_radius", lambda: np.divide(*result("fig15").whole_range_percent.agg([max, min]))
)
# Time of solving the elastic contact at every call over that of Hertz's law
define("solving_each_call", lambda: result("speed_laws").set_index("method").relative["solver"])


@rule()
def thickness():
    """Fall of the force (R2* = 200, depth 0.5) from socket ratio 1.1 to 3, in percent."""
    table = result("assumptions").set_index("case").force_at_largest_depth
    return {RATIOS: 100 * (1 - table[case_name("ratio-3")] / table[case_name("ratio-1.1")])}


@rule("|".join(MATERIALS))
def material(of):
    """Largest change of the force at depth 0.5 with a property at the same E*, in percent."""
    table = result("reach_material").query("panel == @of and law == @PROPOSED")
    error = _at(table.pivot(index="depth_star", columns="parameter", values="value"), 0.5)
    error.index = error.index.astype(float)
    force = 1 / (1 + error / 100)  # over that of the law, which depends on neither
    name, usual, low, high = MATERIALS[of]
    change = (100 * (force / force[usual] - 1).abs()).loc[low - 1e-3 : high]
    least, most = change.index.min(), change.index.max()
    return {f"{name} {least:.2g} to {most:.2g} against {usual:g}": change.max()}


@rule(NUMBER)
def error_over_ratio(depth):
    """Largest absolute relative error of the proposed law at a depth, socket ratios 1.1 to 3."""
    table = result("reach_socket").query("law == @PROPOSED and 1.0999 < socket_ratio < 3.0001")
    return {RATIOS: table.relative_error_percent[np.isclose(table.depth_star, depth)].abs().max()}


@rule()
def scale():
    """Change of P/(E* dR^2) between clearances of 10 µm, 0.1 mm and 1 mm, in percent."""
    depths, modulus, forces = result("fig10").depth_star.to_numpy(), 1e11, []
    for clearance in (1e-5, 1e-4, 1e-3):
        radii = 199 * clearance, 200 * clearance
        force = contact.contact_force(PROPOSED, depths * clearance, *radii, modulus)
        forces.append(force / (modulus * clearance**2))
    return {"laws in SI units": 100 * np.ptp(forces, axis=0).max() / np.max(forces)}


# Largest error of three-node triangles on coarse and fine meshes, in percent
define(
    "triangles",
    lambda *mesh: (
        100 * result("speed_solvers").set_index(["method", "setting"]).largest_error[mesh]
    ),
    readings={
        f"{name}, {size} elements": (method, f"resolution {size}")
        for method, name in (("CAX3", "CalculiX CAX3"), ("three-node triangles", "this study"))
        for size in (32, 160)
    },
)


# ---- crank-slider ----


def _motions(figure, one, other, end=None):
    """One quantity of two joints or models over the time in ms."""
    motion = result(figure).set_index("time_ms").loc[:end]
    return motion[one], motion[other]


def _joints(figure, model, end=None):
    return _motions(figure, f"clearance_{model}", f"ideal_{model}", end)


def _deviation(one, other):
    """RMS difference over RMS of the other one's change, in percent."""
    return 100 * np.sqrt(((one - other) ** 2).mean() / ((other - other.iloc[0]) ** 2).mean())


def _largest_impact(model, end):
    """Largest force of a model's impacts that begin in a time in ms."""
    return result("impacts").query("model == @model and 1e3 * time <= @end").peak_force.max()


# RMS difference of particles and finite elements in one quantity, in percent
define(
    "methods_agree",
    lambda figure, joint, end: _deviation(
        *_motions(figure, f"{joint}_particles", f"{joint}_beams", end)
    ),
    "fig1[789]",
    {f"{joint}, {end} ms": (joint, end) for end in DURATIONS for joint in ("ideal", "clearance")},
)
# RMS difference of clearance and ideal joint over that of the ideal motion, in percent
define("deviation", lambda *run: _deviation(*_joints(*run)), "fig1[789]", PER_MODEL)


@rule(readings=PER_DURATION)
def ahead(model, end):
    """Share of the time for which the slider is ahead of the ideal one, in percent."""
    (place, ideal), (_, speed) = (_joints(figure, model, end) for figure in ("fig17", "fig18"))
    return 100 * ((place - ideal) * speed > 0).mean()


@rule(readings=PER_MODEL)
def larger_acceleration(model):
    """Largest absolute acceleration with clearance over that without, in the first 10 ms."""
    return np.divide(*(values.abs().max() for values in _joints("fig19", model, EARLY)))


@rule(readings=PER_DURATION)
def larger_force(model, end):
    """Largest force with clearance over that of the ideal joint."""
    force, ideal = _joints("fig20", model, end)
    return max(force.max(), _largest_impact(model, end)) / ideal.max()


@rule(readings=PER_MODEL)
def impact_force(model):
    """Largest force of the impacts over that of the ideal joint in the same first 10 ms."""
    return _largest_impact(model, EARLY) / _joints("fig20", model, EARLY)[1].max()


@rule(readings=PER_DURATION)
def last_separation(model, end):
    """Last separation as share of the simulated time, in percent."""
    impacts = result("impacts").query("model == @model")
    return 100 * (1e3 * (impacts.time + impacts.duration).max()) / end


@rule(readings=PER_DURATION)
def oscillation(model, end):
    """Share of windows of 1 ms in which the force swings twice as far as in an ideal joint."""
    windows = (force.groupby(force.index // 1) for force in _joints("fig20", model))
    swing, ideal = ((window.max() - window.min()).loc[: end - 1] for window in windows)
    return 100 * (swing > 2 * ideal).mean()


def _path(model, end=None):
    """Direction of the ball's centre in degrees, its y in clearances, and where it touches."""
    clearance = 1e6 * dataset.published()["Table 3", "joint", "clearance_m"]
    x, y = (
        c.to_numpy() / clearance for c in _motions("fig21", f"x_um_{model}", f"y_um_{model}", end)
    )
    return np.degrees(np.arctan2(y, x)), y, np.hypot(x, y) >= 1


@rule(readings=PER_MODEL)
def downwards(model):
    """How far below the socket's centre the ball first touches, in percent of the clearance."""
    _, y, touches = _path(model)
    return -100 * y[touches][0]


# Share of the time in contact, in percent
define("in_contact", lambda *run: 100 * _path(*run)[2].mean(), readings=PER_DURATION)


@rule(readings=PER_DURATION)
def circumference(model, end):
    """Arc along the socket that the contact covers, in degrees."""
    angle, _, touches = _path(model, end)
    return np.unique(angle[touches] // 1).size


@rule(readings=PER_DURATION)
def preferred(model, end):
    """Share of the time in contact in the most visited quarter of directions, in percent."""
    angle, _, touches = _path(model, end)
    count = np.histogram(angle[touches] % 360, np.arange(0, 361, 5))[0]
    quarters = np.convolve(np.append(count, count[:17]), np.ones(18), "valid")
    return 100 * quarters.max() / count.sum()


@rule()
def depth_in_mechanism():
    """Largest depth in the crank-slider, in clearances, by socket radius and duration."""
    rows = result("durations")[["socket_radius_mm", "duration_ms", "largest_depth"]]
    return {
        f"socket radius {radius:g} mm, {duration / 1000:g} s": depth
        for radius, duration, depth in rows.itertuples(index=False)
    }


@rule()
def law_in_mechanism():
    """Absolute relative error of the proposed law at the largest depths of the crank-slider, %."""
    error = _errors(0.005)[PROPOSED].abs()
    return {
        name: np.interp(depth, error.index, error) for name, depth in depth_in_mechanism().items()
    }


@rule()
def restitution():
    """Restitution delivered by Lankarani and Nikravesh's damping."""
    first = result("impacts").query("model == 'rigid'").delivered_restitution.iloc[0]
    limits = result("stability_limits").set_index("what").observed
    return {"free impact": float(limits["restitution, lankarani-nikravesh"]), "first impact": first}


@rule()
def explicit_cost():
    """Time of particles over that of the fastest implicit method, at equal errors of an impact."""
    table = result("flexible_times").query("joint == 'first impact'")
    return {f"within {100 * row.error:g} %": row.ratio for row in table.itertuples()}
