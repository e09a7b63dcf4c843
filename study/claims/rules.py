"""The rules by which the paper's statements are judged: a number per reading, from results.

A rule reads results from ``figures/`` and gives one number per reading, where a reading is a
model, material, duration or socket radius that what is given in the paper allows. ``of`` is the
text in the claim's column of that name, where a rule serves several claims.
"""

import re
from functools import cache, wraps

import numpy as np
import pandas as pd

from study import checks, contact, dataset, paths
from study.claims import statistics

RULES = {}
"""Name of a rule -> function(of) -> {reading: number}."""

PAPER = "the paper's joint"
LAWS = contact.PAPER_LAWS
PROPOSED = "hyperbolic_winkler"
EARLY = 10.0  # ms: the first impacts
DURATIONS = (50, 100, 200)  # ms: the paper does not say how long it simulates
FIT = 0.5  # largest depth of the fits
FIRST = 0.025  # least depth of the dataset
MODELS = ("rigid", "particles", "beams")
POISSON, MODULI = (0.2, 0.4), (1 / 3, 3)
"""Realistic range of Poisson's ratio, and of the socket's modulus over the ball's: metals."""


class ClaimError(checks.StudyError):
    """A claim cannot be judged; the message names it and what is missing."""


LAW = f"({'|'.join(LAWS)})"
NUMBER = r"\d+\.?\d*"


def rule(pattern=""):
    """Make a function a rule under its own name, for an ``of`` of a pattern."""

    def make(function):
        @wraps(function)
        def checked(of):
            if not isinstance(of, str) or not re.fullmatch(pattern, of):
                raise ClaimError(
                    f"of must be {pattern or 'empty'!r} for rule {function.__name__}, "
                    f"got {checks.shown(of)}"
                )
            return function(of)

        RULES[function.__name__] = checked
        return checked

    return make


@cache
def result(name):
    """One result's numbers, from ``figures/``; ``ClaimError`` if they are missing."""
    path = paths.FIGURES / f"{name}.csv"
    if not path.is_file():
        raise ClaimError(f"figures/{name}.csv is missing; make it with: study run {name}")
    return pd.read_csv(path)


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


def _motion(figure):
    """Times in ms as index, one quantity of every joint and model as columns."""
    return result(figure).set_index("time_ms")


def _per_model(compute):
    return {model: float(compute(model)) for model in MODELS}


# ---- Tables 1 and 2 ----


@rule("R2|R2_adj|RMSE|RE_min_percent|RE_max_percent")
def table_1(of):
    """A number of Table 1: quantity."""
    return {"this study": result("table1").set_index("quantity").ours[of]}


def _table_2(column):
    return result("table2").pivot(index="law", columns="quantity", values=column)


@rule(f"{LAW} (R2|R2_adj|RMSE)")
def table_2(of):
    """Absolute value of a number of Table 2: law and quantity, by the paper's definition."""
    law, quantity = of.split()
    return {PAPER: abs(_table_2("ours")[quantity][law])}


@rule(f"{LAW}( {LAW})*")
def correct_r_squared(of):
    """Absolute R2 of some laws by its definition."""
    table = _table_2("correct").R2.abs()
    return {law: table[law] for law in of.split()}


@rule()
def order(of):
    """How many of the five laws have the rank by RMSE that they have in Table 2."""
    ours, published = (_table_2(column).RMSE.rank() for column in ("ours", "published"))
    return {PAPER: (ours == published).sum()}


@rule()
def improvement(of):
    """RMSE of the fitted Winkler law over that of the proposed one."""
    error = _table_2("ours").RMSE
    return {PAPER: error["winkler"] / error[PROPOSED]}


# ---- force against depth ----


@rule()
def start(of):
    """How many of Hertz and Steuermann are closer than the proposed law as contact begins."""
    error = _errors(0.005).iloc[0].abs()
    return {PAPER: (error[["hertz", "steuermann"]] < error[PROPOSED]).sum()}


@rule(f"{LAW}( {LAW})*")
def crossing(of):
    """Depth beyond which the proposed law is closer than some others."""
    error = _inside(_errors().abs())
    depth = error.index.to_numpy()
    return {
        law: statistics.last_crossing(depth, error[law] - error[PROPOSED]) for law in of.split()
    }


@rule(f"{LAW}( {LAW})*")
def last_crossing(of):
    """Depth beyond which the proposed law is closer than all of some others."""
    return {PAPER: max(crossing(of).values())}


@rule(f"{NUMBER} {NUMBER}( {LAW})+")
def closest(of):
    """Share of depths (from, to) at which the proposed law is closer than others, in percent."""
    low, high, *others = of.split()
    error = _inside(_errors().abs(), float(low), float(high))
    return {PAPER: 100 * error[others].gt(error[PROPOSED], axis=0).all(axis=1).mean()}


@rule(f"{NUMBER} {NUMBER}( {LAW})+")
def growth(of):
    """Least |relative error| at the second depth over that at the first, of some laws."""
    first, second, *laws = of.split()
    error = _errors(0.005)[laws].abs()
    return {PAPER: (_at(error, float(second)) / _at(error, float(first))).min()}


@rule(LAW)
def scaled_fit(of):
    """RMSE of the proposed law over that of another, each times the factor that fits it best."""
    table, left = _inside(_trend()), {}
    for law in (PROPOSED, of):
        factor = (table[law] @ table.exact) / (table[law] @ table[law])
        left[law] = statistics.rmse(table.exact, factor * table[law])
    return {PAPER: left[PROPOSED] / left[of]}


@rule(f"(slope|exponent) {LAW}( {LAW})+")
def trend(of):
    """Share of depths up to 0.5 at which a law's slope or exponent is closer than others'."""
    quantity, law, *others = of.split()
    values = _inside(_trend(f"{quantity}_"))
    error = values.sub(values.exact, axis=0).abs()
    return {PAPER: 100 * error[others].gt(error[law], axis=0).all(axis=1).mean()}


@rule()
def best_exponent(of):
    """Share of depths up to 0.5 at which the proposed law's exponent is the closest, percent."""
    rivals = [law for law in LAWS if law != PROPOSED]
    without = [law for law in rivals if law != "liu"]
    return {
        name: trend(" ".join(["exponent", PROPOSED, *laws]))[PAPER]
        for name, laws in (("of five", rivals), ("without Liu's law", without))
    }


@rule(f"{NUMBER} {NUMBER}")
def overall_error(of):
    """Relative RMSE of the proposed law between two depths, in percent."""
    table = _inside(_trend(), *map(float, of.split()))
    return {PAPER: 100 * statistics.relative_rmse(table.exact, table[PROPOSED])}


@rule()
def half_angle(of):
    """Contact half-angle of Eq. 21 over that of the elastic solution, at two depths."""
    table = result("fig06").query("panel == 'b'").pivot(index="x", columns="part", values="y")
    share = table[PROPOSED] / table.exact
    return {f"depth {depth:g}": _at(share, depth) for depth in (0.1, 0.5)}


@rule()
def arc(of):
    """Growth of the contact half-angle with depth at 0.5 over that at 0.1."""
    angle = result("trend").set_index("depth_star").half_angle_deg
    rate = pd.DataFrame({"rate": np.gradient(angle, angle.index)}, angle.index)
    return {PAPER: _at(rate, 0.5).rate / _at(rate, 0.1).rate}


# ---- socket radius, other parameters, scale ----


def _radii(kinematics="linear"):
    return result("fig14").query("kinematics == @kinematics").set_index("r2_star")


@rule(f"{NUMBER} {NUMBER}")
def least_r_squared(of):
    """Least adjusted R2 (the paper's definition) of the proposed law over a range of R2*."""
    low, high = map(float, of.split())
    return {PAPER: _radii().loc[low:high].R2_adj.min()}


@rule("(small|linear|finite)( (small|linear|finite))*")
def unexplained(of):
    """1 - R2 (the paper's definition) at the largest R2* over that at the least, by kinematics."""
    tables = {kinematics: 1 - _radii(kinematics).R2 for kinematics in of.split()}
    return {kinematics: t.iloc[-1] / t.iloc[0] for kinematics, t in tables.items()}


@rule()
def relative_rmse(of):
    """Relative RMSE at the largest R2*, in percent."""
    return {PAPER: _radii().relative_RMSE_percent.iloc[-1]}


@rule()
def rise(of):
    """Relative RMSE at the largest R2* over that at the smallest."""
    error = _radii().relative_RMSE_percent
    return {PAPER: error.iloc[-1] / error.iloc[0]}


@rule()
def worst_errors(of):
    """Largest relative RMSE, and largest relative error from a depth of 0.1 on, in percent."""
    return {
        "relative RMSE": _radii().relative_RMSE_percent.max(),
        "largest relative error": result("fig15")["from_0.1_percent"].max(),
    }


@rule()
def worst_relative_rmse(of):
    """Largest relative RMSE at any R2*, in percent."""
    return {PAPER: _radii().relative_RMSE_percent.max()}


@rule()
def spread_over_radius(of):
    """Largest |relative error| up to a depth of 0.5, the largest over the least of any R2*."""
    error = result("fig15").whole_range_percent
    return {PAPER: error.max() / error.min()}


@rule()
def thickness(of):
    """By how much the force (R2* = 200, depth 0.5) falls from socket ratio 1.1 to 3, percent."""
    table = result("assumptions").set_index("case").force_at_largest_depth
    return {
        "ratios 1.1 to 3": 100 * (1 - table["ratio-3-linear-200"] / table["ratio-1.1-linear-200"])
    }


@rule("poisson|modulus_ratio")
def material(of):
    """Largest change of the force at depth 0.5 with a property at the same E*, in percent."""
    table = result("reach_material").query("panel == @of and law == 'hertz'")
    error = _at(table.pivot(index="depth_star", columns="parameter", values="value"), 0.5)
    error.index = error.index.astype(float)
    force = 1 / (1 + error / 100)  # over that of Hertz, whose law knows neither
    name, usual, (low, high) = {
        "poisson": ("Poisson's ratio", 0.3, POISSON),
        "modulus_ratio": ("moduli", 1.0, MODULI),
    }[of]
    change = (
        100 * (force / force[usual] - 1).abs()[force.index.to_series().between(low - 1e-3, high)]
    )
    least, most = change.index.min(), change.index.max()
    return {f"{name} {least:.2g} to {most:.2g} against {usual:g}": change.max()}


@rule(NUMBER)
def error_over_ratio(of):
    """Largest |relative error| of the proposed law at a depth, socket ratios 1.1 to 3."""
    table = result("reach_socket").query("law == @PROPOSED and 1.0999 < socket_ratio < 3.0001")
    table = table[np.isclose(table.depth_star, float(of))]
    return {"ratios 1.1 to 3": table.relative_error_percent.abs().max()}


@rule()
def scale(of):
    """By how much P/(E* dR^2) changes between clearances of 10 um, 0.1 mm and 1 mm, percent."""
    table = result("fig10")
    modulus, forces = 1e11, []
    for clearance in (1e-5, 1e-4, 1e-3):
        radii = 199 * clearance, 200 * clearance
        depth = table.depth_star.to_numpy() * clearance
        force = contact.contact_force(PROPOSED, depth, *radii, modulus)
        forces.append(force / (modulus * clearance**2))
    return {"laws in SI units": 100 * np.ptp(forces, axis=0).max() / np.max(forces)}


@rule()
def triangles(of):
    """Largest error of three-node triangles on coarse and fine meshes, in percent."""
    table = result("speed_solvers").set_index(["method", "setting"]).largest_error
    names = {"CAX3": "CalculiX CAX3", "three-node triangles": "this study's"}
    return {
        f"{name}, {size} elements": 100 * table[method, f"resolution {size}"]
        for method, name in names.items()
        for size in (32, 160)
    }


# ---- crank-slider ----


def _deviation(motion, one, other):
    """RMS difference of two columns over that of the other one's change, in percent."""
    change = motion[other] - motion[other].iloc[0]
    difference = motion[one] - motion[other]
    return 100 * np.sqrt((difference**2).mean() / (change**2).mean())


@rule("fig1[789]")
def methods_agree(of):
    """RMS difference of particles and finite elements in one quantity, in percent."""
    motion = _motion(of)
    return {
        f"{joint}, {end} ms": _deviation(motion.loc[:end], f"{joint}_particles", f"{joint}_beams")
        for end in DURATIONS
        for joint in ("ideal", "clearance")
    }


@rule()
def ahead(of):
    """Share of the time in which the slider is ahead of the ideal one, in percent, by duration."""
    place, speed = _motion("fig17"), _motion("fig18")

    def share(model, end):
        lead = place[f"clearance_{model}"] - place[f"ideal_{model}"]
        return 100 * (lead * speed[f"ideal_{model}"] > 0).loc[:end].mean()

    return {f"{m}, {end} ms": share(m, end) for end in DURATIONS for m in MODELS}


@rule("fig1[789]")
def deviation(of):
    """RMS difference of clearance and ideal joint over that of the ideal motion, in percent."""
    motion = _motion(of)
    return _per_model(lambda m: _deviation(motion, f"clearance_{m}", f"ideal_{m}"))


@rule()
def larger_acceleration(of):
    """Largest |acceleration| with clearance over that without, in the first 10 ms."""
    largest = _motion("fig19").loc[:EARLY].abs().max()
    return _per_model(lambda m: largest[f"clearance_{m}"] / largest[f"ideal_{m}"])


@rule()
def larger_force(of):
    """Largest force with clearance over that of the ideal joint, for several durations."""
    impacts, found = result("impacts"), {}
    for end in DURATIONS:
        largest = _motion("fig20").loc[:end].max()
        for model in MODELS:
            peaks = impacts[(impacts.model == model) & (1e3 * impacts.time <= end)].peak_force
            force = max(largest[f"clearance_{model}"], peaks.max())
            found[f"{model}, {end} ms"] = force / largest[f"ideal_{model}"]
    return found


@rule()
def impact_force(of):
    """Largest force of the impacts over that of the ideal joint in the same first 10 ms."""
    impacts = result("impacts")
    peaks = impacts[1e3 * impacts.time <= EARLY].groupby("model").peak_force.max()
    ideal = _motion("fig20").loc[:EARLY].max()
    return _per_model(lambda m: peaks[m] / ideal[f"ideal_{m}"])


@rule()
def last_separation(of):
    """Last separation as share of the simulated time, in percent, for several durations."""
    impacts = result("impacts")
    last = 1e3 * (impacts.time + impacts.duration).groupby(impacts.model).max()
    return {f"{m}, {end} ms": 100 * last[m] / end for end in DURATIONS for m in MODELS}


@rule()
def oscillation(of):
    """Share of windows of 1 ms in which the force swings twice as far as in an ideal joint."""
    force, found = _motion("fig20"), {}
    window = (force.index // 1).astype(int)
    swing = force.groupby(window).max() - force.groupby(window).min()
    for end in DURATIONS:
        inside = swing[swing.index < end]
        for model in MODELS:
            more = inside[f"clearance_{model}"] > 2 * inside[f"ideal_{model}"]
            found[f"{model}, {end} ms"] = 100 * more.mean()
    return found


def _path(model):
    """Path of the ball's centre in clearances: x, y, and where it is in contact."""
    path = _motion("fig21")[[f"x_um_{model}", f"y_um_{model}"]]
    path = path / (1e6 * _clearance())
    x, y = path.to_numpy().T
    return x, y, np.hypot(x, y) >= 1


def _clearance():
    return dataset.published()["Table 3", "joint", "clearance_m"]


@rule()
def downwards(of):
    """How far below the socket's centre the ball first touches, in percent of the clearance."""

    def below(model):
        _, y, touches = _path(model)
        return -100 * y[np.flatnonzero(touches)[0]]

    return _per_model(below)


def _by_duration(compute):
    """A number of the joint's path (x, y, where it touches) by model and duration."""
    inside = {end: _motion("fig21").index <= end for end in DURATIONS}
    paths_of = {model: _path(model) for model in MODELS}
    return {
        f"{model}, {end} ms": float(compute(*(values[inside[end]] for values in paths_of[model])))
        for end in DURATIONS
        for model in MODELS
    }


@rule()
def in_contact(of):
    """Share of the time in contact, in percent, by duration."""
    return _by_duration(lambda x, y, touches: 100 * touches.mean())


@rule()
def circumference(of):
    """Arc along the socket that the contact covers, in degrees, by duration."""
    return _by_duration(
        lambda x, y, touches: np.unique(np.degrees(np.arctan2(y, x))[touches] // 1).size
    )


@rule()
def preferred(of):
    """Share of the time in contact in the most visited quarter of directions, in percent."""

    def share(x, y, touches):
        angle = np.degrees(np.arctan2(y, x))[touches] % 360
        count = np.histogram(angle, np.arange(0, 361, 5))[0]
        quarters = np.convolve(np.append(count, count[:17]), np.ones(18), "valid")
        return 100 * quarters.max() / count.sum()

    return _by_duration(share)


def _deepest():
    """Largest depths in the crank-slider by socket radius and duration, in clearances."""
    for row in result("durations").itertuples():
        name = f"socket radius {row.socket_radius_mm:g} mm, {row.duration_ms / 1000:g} s"
        yield name, row.largest_depth


@rule()
def depth_in_mechanism(of):
    """Largest depth in the crank-slider, in clearances, for socket radii and durations."""
    return dict(_deepest())


@rule()
def law_in_mechanism(of):
    """|Relative error| of the proposed law at the largest depths of the crank-slider, percent."""
    error = _errors(0.005)[PROPOSED].abs()
    return {name: np.interp(depth, error.index, error) for name, depth in _deepest()}


@rule()
def restitution(of):
    """Restitution that Lankarani and Nikravesh's damping delivers."""
    first = result("impacts").query("model == 'rigid'").delivered_restitution.iloc[0]
    limits = result("stability_limits").set_index("what").observed
    return {"free impact": float(limits["restitution, lankarani-nikravesh"]), "first impact": first}


@rule()
def solving_each_call(of):
    """Time of solving the elastic contact at every call over that of Hertz's law."""
    return {PAPER: result("speed_laws").set_index("method").relative["solver"]}
