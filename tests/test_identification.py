"""Inference from Table 2: it finds what made a table, and says how sure it is."""

import numpy as np
import pandas as pd
import pytest

from study import contact, dataset, identification
from study import statistics as stats

RATIOS = (1.15, 1.2, 1.25, 1.3, 1.36, 1.45)


@pytest.fixture(scope="module")
def made():
    """RMSE column of a table made with a known set-up, and scans of that and of another."""
    sample = identification.SAMPLINGS["20, without 0"]
    force = identification.forces(sample, socket_ratio=1.27)
    laws = identification.table_2(sample, force, "flat")
    table = pd.Series({law: stats.rmse(force, f) for law, f in laws.items()})
    scans = [
        identification.scan(table, RATIOS, kinematics=kinematics).assign(kinematics=kinematics)
        for kinematics in ("linear", "small")
    ]
    return pd.concat(scans)


def test_the_set_up_that_made_a_table_is_found(made):
    table = identification.likelihood(made, 0.01)
    names = ["sampling", "area", "divisor", "kinematics"]
    best = table[table.evidence > 1 - 1e-9].set_index(names)
    # 21 samples from 0 with the divisor n - 1 are the same: the laws have no error at 0
    assert set(best.index) == {
        ("20, without 0", "flat", "n", "linear"),
        ("21, from 0", "flat", "n - 1", "linear"),
    }
    assert best.best_ratio.to_numpy() == pytest.approx(1.27, abs=1e-3)
    assert best.low.max() < 1.27 < best.high.min()
    assert best.misfit.max() < 1e-3


def test_likelihood_is_sharper_with_a_smaller_error(made):
    wide, narrow = (identification.likelihood(made, sigma) for sigma in (0.03, 0.003))
    assert narrow.iloc[0].high - narrow.iloc[0].low < wide.iloc[0].high - wide.iloc[0].low
    assert (narrow.evidence > 0.1).sum() < (wide.evidence > 0.1).sum()
    assert (np.diff(narrow.evidence) <= 0).all()


def test_profile_passes_through_the_scan(made):
    one = made[(made.kinematics == "linear") & (made.sampling == "19, from 0")]
    one = one[(one.area == "flat") & (one.divisor == "n")]
    fine = identification.profile(one, 2001)
    for law in contact.PAPER_LAWS:
        assert np.interp(one.ratio, fine.ratio, fine[law]) == pytest.approx(one[law], abs=1e-4)


def test_windows_hold_the_whole_range():
    truth = identification.EXPLANATIONS["plane 1.19, sphere"].truth()
    table = identification.windows(truth, "sphere", [0.0, 0.3], [0.2, 0.5])
    assert len(table) == 3  # a window of negative length is left out
    sample = np.linspace(0, 0.5, 20)
    laws = identification.table_2(sample, truth(sample), "sphere")
    whole = table[(table.low == 0) & (table.high == 0.5)].iloc[0]
    for law in contact.PAPER_LAWS:
        assert whole[law] == pytest.approx(stats.r_squared(truth(sample), laws[law]), rel=1e-9)


def test_consequences_are_those_of_table_2():
    explanation = identification.EXPLANATIONS["clamped 1.3, flat area"]
    found = identification.consequences(explanation)
    published = dataset.published("Table 2").xs("RMSE", level="quantity")
    for law in ("hertz", "steuermann", "winkler"):
        assert found[law, "RMSE"] == pytest.approx(published[law], rel=2e-3)
    assert found["hyperbolic_winkler", "RMSE"] == pytest.approx(published["proposed"], rel=2e-3)
    assert found["steuermann", "crossing"] == pytest.approx(0.13, abs=0.005)
    limit = dataset.published("Fig. 14")["proposed", "relative_RMSE_limit_percent"]
    assert 6.5 < found["proposed", "relative_RMSE_limit_percent"] < limit


def test_the_papers_table_is_explained_by_one_set_up():
    published = dataset.published("Table 2").xs("RMSE", level="quantity")
    published = published.rename({"proposed": "hyperbolic_winkler"})
    clamped = {"ball_drive": "clamped", "solver": "quadratic", "resolution": 64}
    found = identification.scan(published, RATIOS, **clamped)
    best = identification.likelihood(found.assign(drive="clamped"), 0.01).iloc[0]
    assert best.area == "flat"
    assert best.best_ratio == pytest.approx(1.3, abs=0.005)
    assert best.misfit < 1e-3
    plane = identification.scan(published, RATIOS).assign(drive="plane")
    assert identification.likelihood(plane, 0.01).misfit.min() > 0.03
