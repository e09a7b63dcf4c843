"""Inference from Table 2: what made a table is found, without and with elastic solutions."""

import numpy as np
import pandas as pd
import pytest

from study import contact, dataset, paths
from study.claims import statistics as stats
from study.claims import table2
from study.claims.table2 import Reading
from study.dataset import fitting

RATIOS = (1.15, 1.2, 1.25, 1.3, 1.36, 1.45)
FREE = {"ball_support": "guided", "rim": "mirror"}  # solved by the series, in milliseconds
NAMES = ["sampling", "area", "factor", "kinematics"]


def goodness(depths, force, area="flat"):
    """Measures of the five laws for some forces, as in Table 2."""
    laws = table2.law_forces(depths, force, area)
    return pd.DataFrame(
        {law: stats.goodness_of_fit(force, of_law) for law, of_law in laws.items()}
    ).T


def made_up(sampling):
    depths = table2.SAMPLINGS[sampling]
    return depths, 700 * depths**1.62 * (1 + 0.1 * depths)


def elastic(sampling, scale=1.0, **changes):
    """Elastic forces of a reference joint with changes, times a factor."""
    joint = table2.reference_joint(socket_ratio=changes.pop("ratio"), **(FREE | changes))
    return scale * contact.Table.of_curve(joint.curve(0.5))(table2.SAMPLINGS[sampling])


def test_sums_and_amplitudes_of_a_made_table_are_found():
    depths, force = made_up("22, from 0")
    table, reading = table2.printed(goodness(depths, force)), Reading("22, from 0")
    total, about_mean = table2.totals(table, reading)
    assert total[0] == pytest.approx(force.sum())
    assert about_mean[0] == pytest.approx(np.sum((force - force.mean()) ** 2))
    best = [fitting.coefficient(law, depths, force) for law in table2.ROWS[2:]]
    for found in table2.amplitudes(table, reading):
        assert found[:, 0] == pytest.approx(best)
    by_kappa, by_rmse = table2.amplitudes(table, reading._replace(area="sphere"))
    assert abs(by_kappa[1, 0] / by_rmse[1, 0] - 1) > 5e-4


@pytest.mark.parametrize(
    "wrong",
    [Reading("21, from 0"), Reading("20, without 0"), Reading("22, from 0", "flat", 19 / 18)],
)
def test_a_wrong_list_of_depths_or_factor_shows(wrong):
    table = table2.printed(goodness(*made_up("22, from 0")).round(4))

    def apart(reading):
        by_kappa, by_rmse = table2.amplitudes(table, reading)
        return 100 * (by_kappa / by_rmse - 1)[0]

    right, off = apart(Reading("22, from 0")), apart(wrong)
    assert right.min() < 0 < right.max()
    assert abs(off).min() > 20 * np.ptp(right)


def test_by_the_usual_definition_one_number_is_the_same_for_all_laws():
    depths, force = made_up("22, from 0")
    measures = goodness(depths, force)
    missing, rmse = table2.printed(measures.assign(kappa_as_printed=measures.determination))[..., 0]
    quotient = len(depths) / np.sum((force - force.mean()) ** 2)
    assert missing / rmse**2 == pytest.approx([quotient] * 4)


def test_corners_enclose_whatever_rounds_to_the_printed_table():
    published, rng = dataset.published_table_2(), np.random.default_rng(3)

    def quantities(table):
        return np.array([*table2.totals(table), *table2.amplitudes(table)[0]])

    corners = quantities(table2.printed(published))
    for _ in range(200):
        moved = published.copy()
        moved[["kappa_as_printed", "RMSE"]] += rng.uniform(-5e-5, 5e-5, (len(moved), 2))
        inside = quantities(table2.printed(moved))[:, 0]
        assert (corners.min(axis=1) <= inside).all()
        assert (inside <= corners.max(axis=1)).all()


def test_the_papers_table_alone():
    found = pd.read_csv(paths.FIGURES / "table_alone.csv").set_index(["quantity", "reading"])
    quotient = found.loc["(1 - kappa_as_printed)/RMSE^2"]
    assert quotient.low["hertz"] > 1.05 * quotient.high["steuermann"]
    assert quotient.low["hyperbolic_winkler"] > 1.03 * quotient.high["winkler"]
    total = found.loc["sum of P*"]
    assert total.value.tolist() == pytest.approx([1646.77, 1646.36], abs=0.01)
    assert total.high["Table 2"] - total.low["Table 2"] < 0.09
    apart = found.loc["difference between the two amplitudes of a law (percent)"]
    assert apart.high["sphere"] < -0.4 < -0.015 < apart.low[["winkler", "disc"]].min()
    needed = found.value["needed error of a printed number (half units of its last digit)"]
    assert needed["21 depths, disc"] < 1
    assert needed.drop("21 depths, disc").min() > 50


@pytest.fixture(scope="module")
def scans():
    """Scans of two set-ups, of which the first made the table in the tests below."""
    kinds = ("linear", "small")
    return pd.concat(table2.scan(RATIOS, kinematics=k, **FREE).assign(kinematics=k) for k in kinds)


def test_the_set_up_that_made_a_table_is_found(scans):
    sampling = "20, without 0"
    table = goodness(table2.SAMPLINGS[sampling], elastic(sampling, ratio=1.27))
    best = table2.ranked(table, scans)
    assert best.loc[0, NAMES].tolist() == [sampling, "flat", "1", "linear"]
    assert best.ratio[0] == pytest.approx(1.27, abs=1e-3)
    assert best.misfit[0] < 1e-3
    assert (np.diff(best.misfit) >= 0).all()


def test_a_common_factor_is_found_and_without_it_the_ratio_is_wrong(scans):
    sampling = "20, without 0"
    scans = scans[(scans.sampling == sampling) & (scans.kinematics == "linear")]
    table = goodness(table2.SAMPLINGS[sampling], elastic(sampling, 0.96, ratio=1.3))
    free = table2.ranked(table, scans, scale_free=True).iloc[0]
    assert (free.ratio, free.scale) == pytest.approx((1.3, 0.96), abs=2e-3)
    assert free.misfit < 2e-4
    fixed = table2.ranked(table, scans).iloc[0]
    assert fixed.misfit > 5 * free.misfit
    assert abs(fixed.ratio - 1.3) > 0.02


@pytest.mark.parametrize("area", ["flat", "sphere"])
def test_deviations_from_sums_are_those_of_the_measures(area):
    published, reading = dataset.published_table_2(), Reading("19, from 0", area, 19 / 18)
    depths, force = table2.SAMPLINGS["19, from 0"], elastic("19, from 0", ratio=1.4)
    sums = table2.scaled(table2.sums("19, from 0", force), 1.05)
    found = table2.deviations(published, sums, reading)
    for law, of_law in table2.law_forces(depths, 1.05 * force, area).items():
        if law in table2.ROWS:
            stated = published.loc[law]
            measured = stats.goodness_of_fit(1.05 * force, of_law)
            missing = 19 / 18 * (1 - measured["kappa_as_printed"]) / (1 - stated.kappa_as_printed)
            assert found[f"1 - kappa_as_printed {law}"] == pytest.approx(np.log(missing))
            assert found[f"RMSE {law}"] == pytest.approx(np.log(measured["RMSE"] / stated.RMSE))


def test_profile_passes_through_the_scan(scans):
    table, reading = dataset.published_table_2(), Reading("19, from 0", factor=19 / 18)
    one = scans[(scans.sampling == "19, from 0") & (scans.kinematics == "linear")]
    fine = table2.profile(table, one, reading, 2001)
    off = table2.deviations(table, one, reading)
    for number in table2.NUMBERS:
        found = np.interp(one.ratio, fine.ratio, fine[number])
        assert found == pytest.approx(off[number], abs=1e-4)


def test_the_reference_joint_explains_table_2_and_its_rivals_do_not():
    published = dataset.published_table_2()
    force = fitting.sampled(dataset.paper_curves(r2_star=200))
    found = table2.deviations(published, table2.sums("21, from 0", force))
    assert max(map(abs, found.values())) < 0.0072
    assert 0.002 < table2.misfit(found) < 0.0031
    scans = {"clamped": table2.scan(RATIOS, resolution=64), "guided": table2.scan(RATIOS, **FREE)}
    scans = pd.concat([rows.assign(ball_support=support) for support, rows in scans.items()])
    table = table2.ranked(published, scans[scans.sampling == "21, from 0"])
    table = table[table.factor == "1"].set_index(["ball_support", "area"])
    assert table.ratio["clamped", "flat"] == pytest.approx(1.298, abs=0.002)
    rivals = [("guided", "sphere"), ("clamped", "sphere"), ("guided", "flat"), ("clamped", "flat")]
    assert 100 * table.misfit[rivals].to_numpy() == pytest.approx([7.8, 10.6, 12.6, 0.3], abs=0.2)
