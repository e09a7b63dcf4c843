"""What Table 2 says without an elastic solution: on a made table, and on the paper's."""

import numpy as np
import pandas as pd
import pytest

from study import dataset, paths
from study.claims import statistics as stats
from study.claims import table_alone
from study.dataset import fitting

DISC, SPHERE = "hyperbolic_winkler", "hyperbolic_winkler_sphere"


def made(depths, force, digits, measure="kappa_as_printed"):
    """Table 2 of some forces, with a number of digits, as `table_alone.printed` wants it."""
    hertz, steuermann = table_alone.known_forces(depths)
    laws = {"hertz": hertz, "steuermann": steuermann}
    for law in ("winkler", DISC):
        laws[law] = fitting.coefficient(law, depths, force) * fitting.shape(law, depths)
    rows = {law: stats.goodness_of_fit(force, values) for law, values in laws.items()}
    table = pd.DataFrame(rows).T.round(digits)
    return table.assign(kappa_as_printed=table[measure])


@pytest.fixture
def depths():
    return np.linspace(0, 0.5, 16)


@pytest.fixture
def force(depths):
    return 700 * depths**1.62 * (1 + 0.1 * depths)


def test_sums_and_coefficients_of_a_made_table_are_found(depths, force):
    table = table_alone.printed(made(depths, force, 12))
    total, about_mean = table_alone.totals(table, depths)
    assert total[0] == pytest.approx(force.sum())
    assert about_mean[0] == pytest.approx(np.sum((force - force.mean()) ** 2))
    for law in ("winkler", DISC):
        best = fitting.coefficient(law, depths, force)
        for found in table_alone.coefficients(table, law, depths):
            assert found[0] == pytest.approx(best)
        assert table_alone.disagreement(table, law, depths)[0] == pytest.approx(0, abs=1e-6)
    for law, least in ((SPHERE, 0.05), ("winkler", 20)):
        off = table_alone.disagreement(table, law, depths, opposite=law == "winkler")
        assert abs(off[0]) > least
    found, rest = table_alone.forces(table, DISC, depths)
    assert found[:, 0] == pytest.approx(force, abs=0.3)
    assert rest[0] == pytest.approx(np.sum((found[:, 0] - force) ** 2), rel=1e-3)


def test_a_wrong_sample_or_factor_shows(depths, force):
    table = table_alone.printed(made(depths, force, 4))
    right = table_alone.interval(table_alone.disagreement(table, "winkler", depths))
    assert right["low"] < 0 < right["high"]
    for wrong, factor in ((np.linspace(0, 0.5, 15), 1), (depths[1:], 1), (depths, 19 / 18)):
        off = table_alone.interval(table_alone.disagreement(table, "winkler", wrong, factor))
        assert min(abs(off["low"]), abs(off["high"])) > 20 * (right["high"] - right["low"])


def test_by_the_usual_definition_one_number_is_the_same_for_all_laws(depths, force):
    table = table_alone.printed(made(depths, force, 12, "determination"))
    share = [missing[0] / rmse[0] ** 2 for missing, rmse in table.values()]
    assert share == pytest.approx([len(depths) / np.sum((force - force.mean()) ** 2)] * 4)


def test_corners_enclose_whatever_rounds_to_the_printed_table():
    published = dataset.published_table_2()
    rng = np.random.default_rng(3)
    usual = table_alone.printed(published)
    quantities = (
        lambda table: table_alone.totals(table, fitting.SAMPLE)[0],
        lambda table: table_alone.totals(table, fitting.SAMPLE)[1],
        lambda table: table_alone.disagreement(table, DISC, fitting.SAMPLE),
        lambda table: table_alone.forces(table, DISC, fitting.SAMPLE)[1],
    )
    bounds = [table_alone.interval(quantity(usual)) for quantity in quantities]
    for _ in range(200):
        moved = published.copy()
        moved[["kappa_as_printed", "RMSE"]] += rng.uniform(-5e-5, 5e-5, (len(moved), 2))
        inside = table_alone.printed(moved)
        for quantity, bound in zip(quantities, bounds, strict=True):
            assert bound["low"] <= quantity(inside)[0] <= bound["high"]


def test_the_papers_table_alone():
    found = pd.read_csv(paths.FIGURES / "table_alone.csv").set_index(["quantity", "reading"])
    share = found.loc["(1 - kappa_as_printed)/RMSE^2"]
    assert share.low["hertz"] > 1.05 * share.high["steuermann"]
    assert share.low["hyperbolic_winkler"] > 1.03 * share.high["winkler"]
    total = found.loc["sum of P*"]
    assert total.value.tolist() == pytest.approx([1646.77, 1646.36], abs=0.01)
    assert total.high["Table 2"] - total.low["Table 2"] < 0.09
    apart = found.loc["difference between the two amplitudes of a law (percent)"]
    assert apart.low[["winkler", "disc"]].min() > -0.015
    assert apart.high["sphere"] < -0.4
    left = found.loc["squared norm of the remaining component"]
    assert left.low["disc"] < 0 < left.high["disc"] < 15
    assert left.high["sphere"] < -300
    assert found.loc["maximum difference from the forces of the reference joint"].high["disc"] < 0.7


def test_of_the_samples_two_survive():
    table = pd.read_csv(paths.FIGURES / "table_alone_samples.csv")
    table = table[table.law != "sphere"]
    good = table[table.disagreement_percent.abs() < 0.05]
    assert set(good.sampling + " " + good.adjustment_factor) == {"21, from 0 1", "20, from 0 19/18"}
    assert len(good) == 4
    rest = table.drop(good.index)
    assert (rest.disagreement_percent.abs() - rest.uncertainty_percent).min() > 0.5


def test_all_eight_numbers_leave_one_list_of_depths_and_one_area():
    found = pd.read_csv(paths.FIGURES / "table_alone.csv").set_index(["quantity", "reading"])
    needed = found.value["needed error of a printed number (half units of its last digit)"]
    assert needed["21 depths, disc"] < 1
    assert needed.drop("21 depths, disc").min() > 50


@pytest.mark.parametrize("off", [0.9998, 1.0002])
def test_a_table_of_known_forces_needs_no_other_digits(off):
    force = 200 * (fitting.SAMPLE / 0.5) ** 1.65
    table = table_alone.printed(made(fitting.SAMPLE, force, 12))
    assert table_alone.needed_rounding(table, DISC, fitting.SAMPLE) < 1e-3
    missing, rmse = table["steuermann"]
    table["steuermann"] = missing, off * rmse
    assert table_alone.needed_rounding(table, DISC, fitting.SAMPLE) > 2  # not rounding
