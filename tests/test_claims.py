"""Every statement has a rule and its evidence, and verdicts follow from numbers alone."""

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import claims, dataset, figures, paths, rules
from study.notebooks import CATALOGUE, check_claims

ROWS = claims.load()
JUDGED = claims.judge()
RESULTS = {name for notebook in CATALOGUE for name in notebook.results}
NUMBER = st.floats(-1e6, 1e6)


def test_kept_claims_are_the_computed_ones():
    kept = pd.read_csv(paths.FIGURES / "claims.csv", keep_default_na=False)
    assert kept.claim.tolist() == JUDGED.claim.tolist()
    assert kept.verdict.tolist() == JUDGED.verdict.tolist()
    assert kept.found.tolist() == JUDGED.found.tolist()


def test_there_are_enough_claims_and_each_verdict_occurs():
    assert len(ROWS) >= 20
    assert not ROWS.claim.duplicated().any()
    assert set(JUDGED.verdict) == set(claims.VERDICTS) == set(figures.VERDICT_COLORS)


def test_every_number_of_tables_1_and_2_is_a_claim():
    stated = pd.read_csv(paths.DATA / "published/tables.csv")
    stated = stated[stated["where"].isin(["Table 1", "Table 2"])]
    keys = {"/".join(row) for row in stated[["where", "row", "quantity"]].itertuples(index=False)}
    kept = pd.read_csv(paths.DATA / "published/claims.csv", keep_default_na=False)
    assert keys <= set(kept[kept.relation == "="].expected)


@pytest.mark.parametrize("row", list(ROWS.itertuples()), ids=lambda row: row.claim)
def test_claim_is_whole_and_its_evidence_is_there(row):
    for column in ("part", "where", "statement", "measure"):
        assert getattr(row, column).strip()
    assert 0 <= row.tolerance <= row.partly
    assert row.expected != 0
    assert row.figure in RESULTS
    assert row.evidence.split()
    for name in row.evidence.split():
        assert name in RESULTS
        assert (paths.FIGURES / f"{name}.csv").is_file()


def test_rules_read_what_they_say(monkeypatch):
    read = []
    original = rules.result

    def spy(name):
        read.append(name)
        return original(name)

    monkeypatch.setattr(rules, "result", spy)
    for row in ROWS.itertuples():
        read.clear()
        rules.RULES[row.rule](row.of)
        assert set(read) == set(row.evidence.split()), row.claim


def test_the_notebook_depends_on_all_evidence():
    (notebook,) = [n for n in CATALOGUE if "claims" in n.results]
    assert set(notebook.reads) == set(" ".join(ROWS.evidence).split())


@pytest.mark.parametrize(
    ("values", "relation", "expected", "found"),
    [
        ([100], "=", 100, "reproduced"),
        ([101, 99], "=", 100, "reproduced"),
        ([101.1], "=", 100, "partly"),
        ([111], "=", 100, "not reproduced"),
        ([100, 111], "=", 100, "cannot be decided"),
        ([105, 111], "=", 100, "partly"),
        ([-100], "=", -100, "reproduced"),
        ([50], "<", 100, "reproduced"),
        ([105], "<", 100, "partly"),
        ([150], "<", 100, "not reproduced"),
        ([150], ">", 100, "reproduced"),
        ([50, 150], ">", 100, "cannot be decided"),
        ([95, 150], ">", 100, "partly"),
    ],
)
def test_verdict_by_hand(values, relation, expected, found):
    assert claims.verdict(values, relation, expected, 1, 10) == found


@given(
    st.lists(NUMBER, min_size=1, max_size=4),
    st.sampled_from(claims.RELATIONS),
    NUMBER.filter(lambda x: abs(x) > 1e-3),
    st.floats(0, 10),
)
def test_wider_tolerance_never_makes_a_single_reading_worse(values, relation, expected, tolerance):
    order = ("not reproduced", "partly", "reproduced")
    one = values[:1]
    narrow = claims.verdict(one, relation, expected, tolerance, 2 * tolerance)
    wide = claims.verdict(one, relation, expected, 2 * tolerance, 4 * tolerance)
    assert order.index(wide) >= order.index(narrow)
    assert claims.verdict(values, relation, expected, 1, 5) == claims.verdict(
        values[::-1], relation, expected, 1, 5
    )


@pytest.fixture
def changed(monkeypatch, tmp_path):
    """Judge the claims of a changed file, or without some results."""

    def change(column=None, value=None, without=None):
        (tmp_path / "data/published").mkdir(parents=True)
        rows = pd.read_csv(paths.DATA / "published/claims.csv", keep_default_na=False, dtype=str)
        if column:
            rows.loc[0, column] = value
        rows.to_csv(tmp_path / "data/published/claims.csv", index=False)
        (tmp_path / "figures").mkdir()
        for path in paths.FIGURES.glob("*.csv"):
            if path.stem != without:
                (tmp_path / "figures" / path.name).symlink_to(path)
        stated = dataset.published()
        monkeypatch.setattr(dataset, "published", lambda: stated)
        monkeypatch.setattr(paths, "DATA", tmp_path / "data")
        monkeypatch.setattr(paths, "FIGURES", tmp_path / "figures")
        return claims.judge

    yield change
    rules.result.cache_clear()


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("rule", "magic", "claim table1_r2 has no rule: 'magic'"),
        ("relation", "~", "relation of table1_r2 must be one of =, <, >, got '~'"),
        ("expected", "Table 1/f1/R3", "claim table1_r2 expects Table 1/f1/R3, which"),
        ("expected", "many", "expected of table1_r2 must be a number"),
        ("expected", "0", "expected of table1_r2 must not be 0"),
        ("tolerance", "wide", "claim table1_r2 must have tolerances 0 <= tolerance <= partly"),
        ("tolerance", "1", "claim table1_r2 must have tolerances 0 <= tolerance <= partly"),
        ("claim", "table1_rmse", "claim table1_rmse stands twice"),
        ("of", "R3", "table1_r2: rule table_1 fails for 'R3'"),
    ],
)
def test_a_wrong_claim_is_one_clear_error(changed, column, value, message):
    with pytest.raises(claims.ClaimError, match=message):
        changed(column, value)()


def test_names_that_no_notebook_makes_stop_a_run_at_once(changed):
    changed("evidence", "explianed")
    with pytest.raises(claims.ClaimError, match="claim table1_r2: no notebook makes 'explianed'"):
        check_claims()


def test_missing_evidence_is_one_clear_error(changed):
    with pytest.raises(claims.ClaimError, match=r"figures/table1.csv is missing; .*study run tab"):
        changed(without="table1")()
