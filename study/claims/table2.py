"""What Table 2 of the paper says about its own computation, without and with elastic solutions.

For each law Table 2 prints a coefficient of determination kappa and the RMSE. With the elastic
forces y at n depths, and the errors e = c f - y of a law, they are read as

    1 - kappa = g (sum e)^2/S,    n RMSE^2 = sum e^2,    S = sum (y - mean y)^2.

The amplitude c is 1 in Hertz's and Steuermann's laws, and that of least squares in the Winkler and
the hyperbolic Winkler law. A `Reading` has what the paper does not state. `printed` to
`amplitudes` use the printed numbers alone. `scan` to `ranked` compare them with elastic solutions,
by sums of their forces (`SUMS`). ``published`` is `study.dataset.published_table_2`.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

from study import contact
from study.contact.laws import AREA_COEFFICIENTS, Area
from study.dataset import cached, fitting
from study.dataset.fitting import LARGEST_DEPTH, R2_STAR
from study.joint import Solver, reference_joint

ROWS = ("hertz", "steuermann", "winkler", "hyperbolic_winkler")
"""Rows of Table 2 with known formulas; Liu's is reconstructed from its own row."""
NUMBERS = [f"{number} {law}" for law in ROWS for number in ("1 - kappa_as_printed", "RMSE")]
"""The eight numbers that are compared."""
HALF_DIGIT = 5e-5  # half of the last digit that Table 2 prints
SAMPLINGS = {f"{n}, from 0": np.linspace(0, LARGEST_DEPTH, n) for n in (19, 20, 21, 22, 39)} | {
    f"{n}, without 0": np.linspace(0, LARGEST_DEPTH, n + 1)[1:] for n in (19, 20, 21)
}
FACTORS = {"1": 1.0, "19/18": 19 / 18}  # g; 19/18 if adjusted coefficients were printed as plain
SUMS = ("force", "force^2", *ROWS[:3], *AREA_COEFFICIENTS.values())
"""Sums over a list of depths: of y, of y^2, and of y f for each law."""
RATIOS = tuple(np.round(1 + np.geomspace(0.05, 2.0, 13), 4).tolist())
FREE_SCALE = (0.5, 2.0)  # range of a common factor of all elastic forces
_DEPTHS = np.linspace(0.1, LARGEST_DEPTH**0.5, 32) ** 2
Numbers = NDArray[np.float64]


class Reading(NamedTuple):
    """List of depths (a key of `SAMPLINGS`), area element of the hyperbolic law, and g."""

    sampling: str = "21, from 0"
    area: Area = "flat"
    factor: float = 1.0


USUAL = Reading()


def law_forces(sample: Numbers, force: Numbers, area: Area = "flat") -> dict[str, Numbers]:
    """Forces of the five laws of Table 2, the Winkler ones fitted to forces at the same depths."""
    laws = {law: contact.LAWS[law]()(sample, R2_STAR) for law in contact.PAPER_LAWS}
    for row, name in ("winkler", "winkler"), ("hyperbolic_winkler", AREA_COEFFICIENTS[area]):
        laws[row] = fitting.coefficient(name, sample, force) * fitting.shape(name, sample)
    return laws


@lru_cache
def laws_at(sampling: str, area: Area = "flat") -> Numbers:
    """Forces f of `ROWS`, with the amplitude 1, at one of `SAMPLINGS`; shape (4, n)."""
    depths = SAMPLINGS[sampling]
    known = [law(depths, R2_STAR) for law in (contact.Hertz(), contact.Steuermann())]
    fitted = [fitting.shape(law, depths) for law in ("winkler", AREA_COEFFICIENTS[area])]
    return np.array(known + fitted)


def printed(published: pd.DataFrame) -> Numbers:
    """1 - kappa and RMSE of `ROWS`, shape (2, 4, 257): as printed, and 256 corners of rounding."""
    rows = published.loc[list(ROWS)]
    stated = np.array([1 - rows.kappa_as_printed, rows.RMSE])[..., None]
    corners = np.array([[0.0] * 8, *product((-HALF_DIGIT, HALF_DIGIT), repeat=8)]).T
    return stated + corners.reshape(2, 4, -1)


def totals(table: Numbers, reading: Reading = USUAL) -> tuple[Numbers, Numbers]:
    """Sum of the elastic forces y, and S, from kappa of Hertz's and Steuermann's laws.

    Their errors have the same sign on average, so that with r^2 the ratio of their 1 - kappa

        sum f_Hertz - sum y = r (sum f_Steuermann - sum y).
    """
    hertz, steuermann = laws_at(reading.sampling)[:2].sum(axis=1)
    r = np.sqrt(table[0, 0] / table[0, 1])
    total = (hertz - r * steuermann) / (1 - r)
    return total, reading.factor * (total - hertz) ** 2 / table[0, 0]


def amplitudes(table: Numbers, reading: Reading = USUAL) -> tuple[Numbers, Numbers]:
    """Amplitudes of the two fitted laws from kappa, and from the RMSE; each of shape (2, 257).

    With sum y^2 = S + (sum y)^2/n, and the sign for which the two amplitudes are nearer,

        c sum f = sum y +- sqrt((1 - kappa) S/g),    c^2 sum f^2 = sum y^2 - n RMSE^2.
    """
    laws, (total, about_mean) = laws_at(*reading[:2])[2:], totals(table, reading)
    missing, rmse = table[:, 2:]
    squares = about_mean + total**2 / laws.shape[1] - laws.shape[1] * rmse**2
    by_rmse = np.sqrt(squares / (laws**2).sum(axis=1)[:, None])
    error = np.sqrt(missing * about_mean / reading.factor)
    low, high = (total + np.array([-error, error])) / laws.sum(axis=1)[:, None]
    return np.where(abs(low - by_rmse) < abs(high - by_rmse), low, high), by_rmse


def sums(sampling: str, force: Numbers) -> dict[str, float]:
    """`SUMS` of the forces at one of `SAMPLINGS`."""
    laws = [*laws_at(sampling), laws_at(sampling, "sphere")[3]]
    return dict(zip(SUMS, [force.sum(), force @ force, *(f @ force for f in laws)], strict=True))


def scaled(sums: Mapping[str, Any], factor: Any) -> dict[str, Any]:
    """`SUMS` of all forces times a factor."""
    return {name: sums[name] * factor ** (2 if name == "force^2" else 1) for name in SUMS}


def scan(
    ratios: Sequence[float] = RATIOS,
    solver: Solver | None = None,
    resolution: int | None = None,
    **joint: Any,
) -> pd.DataFrame:
    """`SUMS` by socket ratio and sampling, of `study.joint.reference_joint` with changes."""
    rows = []
    for ratio in ratios:
        set_up = reference_joint(R2_STAR, socket_ratio=ratio, **joint)
        curve = contact.Table.of_curve(cached.curve(set_up, _DEPTHS, resolution, solver))
        for name, sample in SAMPLINGS.items():
            rows.append({"ratio": ratio, "sampling": name} | sums(name, curve(sample)))
    return pd.DataFrame(rows)


def deviations(published: Any, sums: Mapping[str, Any], reading: Reading = USUAL) -> dict[str, Any]:
    """Deviations ln(computed/published) of `NUMBERS`, from `SUMS` that are numbers or arrays.

    The amplitudes c of the fitted laws are those of least squares, and

        sum e^2 = sum y^2 - 2 c sum y f + c^2 sum f^2.
    """
    found, kappa, rmse = {}, published["kappa_as_printed"], published["RMSE"]
    products = [sums[name] for name in (*ROWS[:3], AREA_COEFFICIENTS[reading.area])]
    for law, f, of_law in zip(ROWS, laws_at(*reading[:2]), products, strict=True):
        about_mean = sums["force^2"] - sums["force"] ** 2 / len(f)
        c = 1.0 if law in ROWS[:2] else of_law / (f @ f)
        missing = reading.factor * (sums["force"] - c * f.sum()) ** 2 / about_mean
        squares = sums["force^2"] - 2 * c * of_law + c**2 * (f @ f)
        found[f"1 - kappa_as_printed {law}"] = np.log(missing / (1 - kappa[law]))
        found[f"RMSE {law}"] = np.log(np.sqrt(squares / len(f)) / rmse[law])
    return found


def misfit(deviations: Mapping[str, Any]) -> Any:
    """RMS of the deviations of `NUMBERS`, each a number or an array."""
    return np.sqrt(sum(deviations[number] ** 2 for number in NUMBERS) / len(NUMBERS))


def between(scanned: pd.DataFrame) -> Callable[[Any], dict[str, Any]]:
    """`SUMS` as a function of ln(ratio), between the ratios of a `scan` of one sampling."""
    curve = CubicSpline(np.log(scanned.ratio), np.log(scanned[list(SUMS)]))
    return lambda x: dict(zip(SUMS, np.moveaxis(np.exp(curve(x)), -1, 0), strict=True))


def profile(
    published: pd.DataFrame, scanned: pd.DataFrame, reading: Reading = USUAL, count: int = 4001
) -> pd.DataFrame:
    """Deviations and ``misfit`` at ratios in equal steps of ln(ratio); see `between`."""
    x = np.linspace(np.log(scanned.ratio.iloc[0]), np.log(scanned.ratio.iloc[-1]), count)
    off = deviations(published, between(scanned)(x), reading)
    return pd.DataFrame({"ratio": np.exp(x)} | off | {"misfit": misfit(off)})


def freed(published: Any, scanned: pd.DataFrame, reading: Reading) -> dict[str, float]:
    """``ratio`` and ``scale``, a factor of all forces, of minimum ``misfit``; see `between`."""
    sums_at = between(scanned)
    low, high = np.array([np.log(scanned.ratio.iloc[[0, -1]]), np.log(FREE_SCALE)]).T

    def off(x):  # ln(ratio) and ln(scale)
        return deviations(published, scaled(sums_at(x[0]), np.exp(x[1])), reading)

    grid = np.array(np.meshgrid(*np.linspace(low, high, 66)[1:-1].T)).reshape(2, -1)
    start, limits = grid[:, misfit(off(grid)).argmin()], {"bounds": (low, high), "ftol": 1e-12}
    x = least_squares(lambda x: list(off(x).values()), start, xtol=1e-12, gtol=1e-12, **limits).x
    return {"ratio": np.exp(x[0]), "scale": np.exp(x[1]), "misfit": misfit(off(x))}


def ranked(published: pd.DataFrame, scans: pd.DataFrame, scale_free: bool = False) -> pd.DataFrame:
    """``ratio`` and ``misfit`` of every candidate, best first; and the scale if it is free.

    ``scans`` are from `scan`, with any further columns that name the set-up.
    """
    names = [column for column in scans.columns if column not in ("ratio", *SUMS)]
    rows, table = [], published.to_dict()
    for key, scanned in scans.groupby(names, sort=False):
        set_up = dict(zip(names, key, strict=True))
        for area, factor in product(AREA_COEFFICIENTS, FACTORS):
            reading = Reading(set_up["sampling"], area, FACTORS[factor])
            if scale_free:
                best = freed(table, scanned, reading)
            else:
                over = profile(published, scanned, reading)
                best = over.loc[over.misfit.idxmin(), ["ratio", "misfit"]].to_dict()
            rows.append(set_up | {"area": area, "factor": factor} | best)
    return pd.DataFrame(rows).sort_values("misfit", kind="stable", ignore_index=True)
