"""The rules by which the paper's statements are judged: a number per reading, from results.

A rule reads results from ``figures/`` and gives one number per reading, where a reading is a
set-up, formula, model or duration that what is given in the paper allows. ``of`` is the text in
the claim's column of that name, where a rule serves several claims.
"""

from functools import cache

import numpy as np
import pandas as pd

from study import checks, contact, dataset, paths, statistics

RULES = {}
"""Name of a rule -> function(of) -> {reading: number}."""

OWN, SERIES = "clamped 1.3, flat area", "plane 1.19, sphere"  # set-ups, by their names elsewhere
LAWS = contact.PAPER_LAWS
PROPOSED = "hyperbolic_winkler"
EARLY = 10.0  # ms: the first impacts
DURATIONS = (50, 100, 200)  # ms: the paper does not say how long it simulates
FIT = 0.5  # largest depth of the fits
MODELS = ("rigid", "particles", "beams")


class ClaimError(checks.StudyError):
    """A claim cannot be judged; the message names it and what is missing."""


def rule(function):
    """Make a function a rule under its own name."""
    RULES[function.__name__] = function
    return function


@cache
def result(name):
    """One result's numbers, from ``figures/``; ``ClaimError`` if they are missing."""
    path = paths.FIGURES / f"{name}.csv"
    if not path.is_file():
        raise ClaimError(f"figures/{name}.csv is missing; make it with: study run {name}")
    return pd.read_csv(path)


def _curves(least=0.025):
    """Exact forces and those of the laws over depth, from a least depth on, in both set-ups."""
    for reading, table in result("own_curves").groupby("set_up"):
        yield (
            reading,
            table[table.depth_star >= least].set_index("depth_star").drop(columns="set_up"),
        )


def _errors(table):
    """Relative errors of the paper's laws, in percent."""
    return 100 * (table[list(LAWS)].div(table.exact, axis=0) - 1)


def _inside(table, low=0.0, high=FIT):
    return table[(table.index > low) & (table.index <= high + 1e-9)]


def _motion(figure):
    """Times in ms as index, one quantity of every joint and model as columns."""
    return result(figure).set_index("time_ms")


def _per_model(compute):
    return {model: float(compute(model)) for model in MODELS}


# ---- Tables 1 and 2 ----


@rule
def table_1(of):
    """A number of Table 1: quantity."""
    table = result("table1").set_index("quantity")
    found = {SERIES: table.ours[of]}
    explained = result("explained").set_index(["row", "quantity"])
    if ("f1", of) in explained.index:
        found = {OWN: explained.loc[("f1", of), OWN]} | found
    return found


@rule
def rmse(of):
    """RMSE of a law in the set-up that explains Table 2; of Liu's in both readings."""
    explained = result("explained").set_index(["row", "quantity"])[OWN]
    readings = {"liu": ("liu", "liu_half_angle")}.get(of, (of,))
    return {name: explained[name, "RMSE"] for name in readings}


@rule
def r_squared(of):
    """|R2| of a law (law, R2 or R2_adj) at 20 depths of the whole range, and of Fig. 10(d)."""
    law, quantity = of.split()
    windows = result("windows").set_index(["set_up", "low", "high"])[law]
    found = {"0 to 0.5": windows[OWN, 0.0, 0.5], "0.35 to 0.5": windows[OWN, 0.35, 0.5]}
    if quantity == "R2_adj":
        found = {key: 1 - (1 - value) * 19 / 18 for key, value in found.items()}
    return {key: abs(value) for key, value in found.items()}


@rule
def one_sample(of):
    """By how much RMSE / sqrt(1 - R2), a standard deviation, differs in the published rows."""
    table = result("table2").pivot(index="law", columns="quantity", values="published")
    signed = table.R2.where(table.R2 < 1, -table.R2)
    deviation = table.RMSE / np.sqrt(1 - signed)
    return {"published": 100 * (deviation.max() / deviation.min() - 1)}


@rule
def order(of):
    """How many of the five laws have the rank by RMSE that they have in Table 2."""
    published = result("table2").query("quantity == 'RMSE'").set_index("law").published
    explained = result("explained").query("quantity == 'RMSE'").set_index("row")
    ranks = published.rank()
    return {
        name: (explained.loc[list(LAWS), name].rank() == ranks[list(LAWS)]).sum()
        for name in (OWN, SERIES)
    }


# ---- force against depth ----


@rule
def start(of):
    """How many of Hertz and Steuermann are closer than the proposed law as contact begins."""
    found = {}
    for reading, table in _curves(0.005):
        error = _errors(table).iloc[0].abs()
        found[reading] = (error[["hertz", "steuermann"]] < error[PROPOSED]).sum()
    return found


@rule
def crossing(of):
    """Depth beyond which the proposed law is closer than Hertz's and Steuermann's."""
    explained = result("explained").query("quantity == 'crossing'").set_index("row")
    return {name: explained[name].max() for name in (OWN, SERIES)}


@rule
def crossing_of_liu(of):
    """Depth beyond which the proposed law is closer than Liu's, in both of its readings."""
    table = _inside(dict(_curves())[OWN])
    error = table.sub(table.exact, axis=0).abs()
    readings = {"spherical": "liu", "half-angle": "liu_half_angle"}
    return {
        name: statistics.last_crossing(table.index.to_numpy(), error[law] - error[PROPOSED])
        for name, law in readings.items()
    }


@rule
def closest(of):
    """Share of depths (from, to) at which the proposed law is closer than others, in percent."""
    low, high, *others = of.split()
    found = {}
    for reading, table in _curves():
        error = _inside(_errors(table).abs(), float(low), float(high))
        found[reading] = 100 * error[others].gt(error[PROPOSED], axis=0).all(axis=1).mean()
    return found


@rule
def growth(of):
    """Least |relative error| at the second depth over that at the first, of some laws."""
    first, second, *laws = of.split()
    found = {}
    for reading, table in _curves():
        error = _errors(table)[laws].abs()
        found[reading] = (_at(error, float(second)) / _at(error, float(first))).min()
    return found


def _at(table, depth):
    return table.iloc[np.abs(table.index - depth).argmin()]


@rule
def scaled_fit(of):
    """RMSE of the proposed law over that of another, each times the factor that fits it best."""
    found = {}
    for reading, table in _curves():
        table = _inside(table)
        scaled = {
            law: table[law] * (table[law] @ table.exact) / (table[law] @ table[law])
            for law in (PROPOSED, of)
        }
        left = {law: statistics.rmse(table.exact, force) for law, force in scaled.items()}
        found[reading] = left[PROPOSED] / left[of]
    return found


@rule
def exponent(of):
    """Share of depths up to 0.5 at which a law's exponent is closer than others', in percent."""
    law, *others = of.split()
    found = {}
    for reading, table in _curves():
        slopes = _inside(table.filter(like="exponent_").rename(columns=lambda c: c[9:]))
        error = slopes.sub(slopes.exact, axis=0).abs()
        found[reading] = 100 * error[others].gt(error[law], axis=0).all(axis=1).mean()
    return found


@rule
def improvement(of):
    """RMSE of the fitted Winkler law over that of the proposed one."""
    explained = result("explained").query("quantity == 'RMSE'").set_index("row")
    return {name: explained[name]["winkler"] / explained[name][PROPOSED] for name in (OWN, SERIES)}


@rule
def largest_error(of):
    """Largest |relative error| of the proposed law between two depths, in percent."""
    low, high = map(float, of.split())
    return {name: _inside(_errors(t)[PROPOSED].abs(), low, high).max() for name, t in _curves()}


@rule
def arc(of):
    """Growth of the contact half-angle with depth at 0.5 over that at 0.1."""
    angle = dict(_curves())[OWN].half_angle_deg
    rate = pd.DataFrame({"rate": np.gradient(angle, angle.index)}, angle.index)
    return {OWN: _at(rate, 0.5).rate / _at(rate, 0.1).rate}


# ---- socket radius, other parameters, scale ----


def _radii():
    yield OWN, result("own_radius")
    for kinematics in ("linear", "finite"):
        yield f"{SERIES}, {kinematics}", result("fig14").query("kinematics == @kinematics")


@rule
def least_r_squared(of):
    """Least adjusted R2 of the proposed law over a range of R2*."""
    low, high = map(float, of.split())
    return {name: t[t.r2_star.between(low, high)].R2_adj.min() for name, t in _radii()}


@rule
def unexplained(of):
    """1 - R2 at the largest R2* over that at the smallest."""
    return {name: (1 - t.R2.iloc[-1]) / (1 - t.R2.iloc[0]) for name, t in _radii()}


@rule
def relative_rmse(of):
    """Relative RMSE at the largest R2*, in percent."""
    return {name: t.relative_RMSE_percent.iloc[-1] for name, t in _radii()}


@rule
def rise(of):
    """Relative RMSE at the largest R2* over that at the smallest."""
    t = dict(_radii())
    return {
        n: r.relative_RMSE_percent.iloc[-1] / r.relative_RMSE_percent.iloc[0] for n, r in t.items()
    }


@rule
def worst_relative_rmse(of):
    """Largest relative RMSE at any R2*, in percent."""
    return {name: t.relative_RMSE_percent.max() for name, t in _radii()}


@rule
def spread_over_radius(of):
    """Largest |relative error| up to a depth of 0.5, the largest over the least of any R2*."""
    tables = {OWN: result("own_radius"), SERIES: result("fig15")}
    return {n: t.whole_range_percent.max() / t.whole_range_percent.min() for n, t in tables.items()}


@rule
def thickness(of):
    """By how much the force (R2* = 200, depth 0.5) falls from socket ratio 1.1 to 3, percent."""
    table = result("assumptions").set_index("case").force_at_largest_depth
    return {
        "ratios 1.1 to 3": 100 * (1 - table["ratio-3-linear-200"] / table["ratio-1.1-linear-200"])
    }


@rule
def material(of):
    """Largest change of the force at depth 0.5 with a property at the same E*, in percent."""
    table = result("reach_material").query("panel == @of and law == 'hertz'")
    error = _at(table.pivot(index="depth_star", columns="parameter", values="value"), 0.5)
    error.index = error.index.astype(float)
    force = 1 / (1 + error / 100)  # over that of Hertz, whose law knows neither
    name, usual = {"poisson": ("Poisson's ratio", 0.3), "modulus_ratio": ("moduli", 1.0)}[of]
    change = 100 * (force / force[usual] - 1).abs().max()
    return {f"{name} {error.index.min():g} to {error.index.max():g} against {usual:g}": change}


@rule
def error_over_ratio(of):
    """Largest |relative error| of the proposed law, depths 0.1 to 0.5, socket ratios 1.1 to 3."""
    table = result("reach_socket").query("law == @PROPOSED and 0.0999 < depth_star < 0.5001")
    table = table[table.socket_ratio.between(1.1, 3)]
    return {"sphere's area": table.relative_error_percent.abs().max()}


@rule
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


@rule
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


@rule
def methods_agree(of):
    """RMS difference of particles and finite elements in one quantity, in percent."""
    table = result("agreement").query("model == 'particles' and against == 'beams'")
    return dict(zip(table.joint, 100 * table[of], strict=True))


@rule
def ahead(of):
    """Share of the simulated time in which the slider is ahead of the ideal one, in percent."""
    place, speed = _motion("fig17"), _motion("fig18")
    return _per_model(
        lambda m: (
            100 * ((place[f"clearance_{m}"] - place[f"ideal_{m}"]) * speed[f"ideal_{m}"] > 0).mean()
        )
    )


@rule
def deviation(of):
    """RMS difference of clearance and ideal joint over that of the ideal motion, in percent."""
    motion = _motion(of)

    def rms(model):
        ideal = motion[f"ideal_{model}"]
        change = ideal - ideal.iloc[0]
        return 100 * np.sqrt(
            ((motion[f"clearance_{model}"] - ideal) ** 2).mean() / (change**2).mean()
        )

    return _per_model(rms)


@rule
def larger_acceleration(of):
    """Largest |acceleration| with clearance over that without, in the first 10 ms."""
    largest = _motion("fig19").loc[:EARLY].abs().max()
    return _per_model(lambda m: largest[f"clearance_{m}"] / largest[f"ideal_{m}"])


@rule
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


@rule
def impact_force(of):
    """Largest force of the impacts over that of the ideal joint in the same first 10 ms."""
    impacts = result("impacts")
    peaks = impacts[1e3 * impacts.time <= EARLY].groupby("model").peak_force.max()
    ideal = _motion("fig20").loc[:EARLY].max()
    return _per_model(lambda m: peaks[m] / ideal[f"ideal_{m}"])


@rule
def last_separation(of):
    """Last separation as share of the simulated time, in percent, for several durations."""
    impacts = result("impacts")
    last = 1e3 * (impacts.time + impacts.duration).groupby(impacts.model).max()
    return {f"{m}, {end} ms": 100 * last[m] / end for end in DURATIONS[1:] for m in MODELS}


def _path(model):
    """Path of the ball's centre in clearances: x, y, and where it is in contact."""
    path = _motion("fig21")[[f"x_um_{model}", f"y_um_{model}"]]
    path = path / (1e6 * _clearance())
    x, y = path.to_numpy().T
    return x, y, np.hypot(x, y) >= 1


def _clearance():
    return dataset.published()["Table 3", "joint", "clearance_m"]


@rule
def downwards(of):
    """How far below the socket's centre the ball first touches, in percent of the clearance."""

    def below(model):
        _, y, touches = _path(model)
        return -100 * y[np.flatnonzero(touches)[0]]

    return _per_model(below)


@rule
def in_contact(of):
    """Share of the simulated time in contact, in percent."""
    return _per_model(lambda m: 100 * _path(m)[2].mean())


@rule
def circumference(of):
    """Arc along the socket that the contact covers, in degrees."""

    def covered(model):
        x, y, touches = _path(model)
        angle = np.degrees(np.arctan2(y, x))[touches]
        return np.unique(angle // 1).size

    return _per_model(covered)


@rule
def preferred(of):
    """Share of the time in contact in the most visited quarter of directions, in percent."""
    found = {}
    for end in DURATIONS[1:]:
        inside = _motion("fig21").index <= end
        for model in MODELS:
            x, y, touches = (values[inside] for values in _path(model))
            angle = np.degrees(np.arctan2(y, x))[touches] % 360
            count = np.histogram(angle, np.arange(0, 361, 5))[0]
            quarters = np.convolve(np.append(count, count[:17]), np.ones(18), "valid")
            found[f"{model}, {end} ms"] = 100 * quarters.max() / count.sum()
    return found


@rule
def depth_in_mechanism(of):
    """Largest depth in the crank-slider, in clearances; for a small socket by its force."""
    found = _per_model(lambda m: np.hypot(*_path(m)[:2]).max() - 1)
    variants = result("variants").set_index(["links", "variant"]).largest_force
    clearance, radius, depths = _clearance(), 2e-3, np.linspace(0, 0.5, 2001)
    stated = dataset.published().xs("Table 4")["material"]
    modulus = stated["youngs_modulus_GPa"] * 1e9, stated["poisson"]
    radii = radius - clearance, radius, contact.composite_modulus(*modulus, *modulus)
    force = contact.contact_force(PROPOSED, depths * clearance, *radii)
    small = variants["rigid links", "socket radius 2 mm"]
    return found | {"rigid, socket radius 2 mm": np.interp(small, force, depths)}


@rule
def law_in_mechanism(of):
    """|Relative error| of the proposed law at the largest depths of the crank-slider, percent."""
    deepest, found = depth_in_mechanism(""), {}
    for radius, depth in (("10 mm", deepest["rigid"]), ("2 mm", max(deepest.values()))):
        for reading, table in _curves(0.005):
            error = _errors(table)[PROPOSED].abs()
            found[f"{reading}, socket radius {radius}"] = np.interp(depth, error.index, error)
    return found


@rule
def restitution(of):
    """Restitution that Lankarani and Nikravesh's damping delivers."""
    first = result("impacts").query("model == 'rigid'").delivered_restitution.iloc[0]
    limits = result("stability_limits").set_index("what").observed
    return {"free impact": float(limits["restitution, lankarani-nikravesh"]), "first impact": first}


@rule
def solving_each_call(of):
    """Time of solving the elastic contact at every call over that of Hertz's law."""
    return {"series": result("speed_laws").set_index("method").relative["solver"]}


@rule
def explicit_steps(of):
    """Time of explicit steps over another method's, both for an error of 1e-4 in 0.3 s."""
    table = result("speed_steppers")
    times = {
        method: np.exp(np.interp(np.log(1e-4), np.log(rows.rms_error), np.log(rows.time)))
        for method, rows in table.sort_values("rms_error").groupby("method")
        if rows.rms_error.min() < 1e-4 < rows.rms_error.max()
    }
    return {
        f"{method} over {other}": times[method] / times[other]
        for other in ("Rodas5P, events", "CVODE")
        for method in ("centred", "velocity Verlet")
    }
