"""Every statement has a rule and its evidence, and verdicts follow from numbers alone."""

import re

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import dataset, paths
from study.claims import rules, verdicts
from study.pages.catalogue import CATALOGUE, check_claims
from study.pages.report import claims as report_claims

ROWS = verdicts.load()
JUDGED = verdicts.judge()
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
    assert set(JUDGED.verdict) == set(verdicts.VERDICTS)
    assert set(JUDGED.kind) == set(verdicts.KINDS) == {"stated", *report_claims.GROUPS}


def test_claims_are_grouped_by_kind_and_verdict():
    groups = list(zip(JUDGED.kind, JUDGED.verdict, strict=True))
    order = [(kind, verdict) for kind in verdicts.KINDS for verdict in verdicts.VERDICTS]
    assert groups == sorted(groups, key=order.index)


def test_what_cannot_speak_for_or_against_the_paper_stands_apart():
    kind = ROWS.set_index("claim").kind
    assert (
        kind[["same_scale", "solving_is_slow", "table1_determination", "closest_at_start"]]
        == "can hardly fail"
    ).all()
    implied = ["two_parameters", "any_geometry", "moduli_by_modulus", "poisson_by_modulus"]
    implied += ["restitution", "determination_falls_by_conformity"]
    assert set(kind[kind == "implied only"].index) == set(implied)
    table_2 = ROWS[ROWS.rule == "table_2"]
    assert len(table_2) == 15
    assert (table_2.kind == "used to identify").all()


def test_durations_are_the_same_where_they_are_compared():
    found = JUDGED.set_index("claim").found
    readings = [
        re.findall(r"(\w+, \d+ ms):", found[n]) for n in ("larger_force", "persistent_impacts")
    ]
    assert set(readings[0]) == set(readings[1])


def test_every_number_of_tables_1_and_2_is_a_claim():
    stated = pd.read_csv(paths.DATA / "published/tables.csv")
    stated = stated[stated["where"].isin(["Table 1", "Table 2"])]
    keys = {"/".join(row) for row in stated[["where", "row", "quantity"]].itertuples(index=False)}
    kept = pd.read_csv(paths.DATA / "published/claims.csv", keep_default_na=False)
    assert keys <= set(kept[kept.relation.isin(["=", "?"])].expected)


@pytest.mark.parametrize("row", list(ROWS.itertuples()), ids=lambda row: row.claim)
def test_claim_is_whole_and_its_evidence_is_there(row):
    for column in ("part", "where", "statement", "measure"):
        assert getattr(row, column).strip()
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
        ([101.1], "=", 100, "contradicted"),
        ([100, 111], "=", 100, "cannot be decided"),
        ([105, 111], "=", 100, "contradicted"),
        ([100], "?", 100, "cannot be decided"),
        ([-100], "=", -100, "reproduced"),
        ([50], "<", 100, "reproduced"),
        ([101], "<", 100, "reproduced"),
        ([150], "<", 100, "contradicted"),
        ([150], ">", 100, "reproduced"),
        ([50, 150], ">", 100, "cannot be decided"),
        ([95, 98], ">", 100, "contradicted"),
    ],
)
def test_verdict_by_hand(values, relation, expected, found):
    assert verdicts.verdict(values, relation, expected, 1) == found


@given(
    st.lists(NUMBER, min_size=1, max_size=4),
    st.sampled_from(verdicts.RELATIONS),
    NUMBER.filter(lambda x: abs(x) > 1e-3),
    st.floats(0, 10),
)
def test_wider_tolerance_never_makes_a_single_reading_worse(values, relation, expected, tolerance):
    narrow = verdicts.verdict(values[:1], relation, expected, tolerance)
    wide = verdicts.verdict(values[:1], relation, expected, 2 * tolerance)
    assert verdicts.VERDICTS.index(wide) >= verdicts.VERDICTS.index(narrow)
    forth, back = (verdicts.verdict(v, relation, expected, 1) for v in (values, values[::-1]))
    assert forth == back


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
        return verdicts.judge

    yield change
    rules.result.cache_clear()


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("rule", "magic", "claim table1_determination has no rule: 'magic'"),
        ("relation", "~", "relation of table1_determination must be one of =, <, >, ?, got '~'"),
        ("kind", "sure", "kind of table1_determination must be one of stated, implied only, used"),
        ("expected", "Table 1/f1/R3", "claim table1_determination expects Table 1/f1/R3, which"),
        ("expected", "many", "expected of table1_determination must be a number"),
        ("expected", "0", "expected of table1_determination must not be 0"),
        (
            "tolerance",
            "wide",
            "tolerance of table1_determination must be a number >= 0, in percent",
        ),
        ("tolerance", "-1", "tolerance of table1_determination must be a number >= 0, in percent"),
        ("claim", "table1_rmse", "claim table1_rmse occurs twice"),
        (
            "of",
            "R3",
            "claim table1_determination: of must be 'determination|determination_adjusted|RMSE",
        ),
    ],
)
def test_a_wrong_claim_is_one_clear_error(changed, column, value, message):
    with pytest.raises(verdicts.ClaimError, match=re.escape(message)):
        changed(column, value)()


def test_names_that_no_notebook_makes_stop_a_run_at_once(changed):
    changed("evidence", "explianed")
    with pytest.raises(
        verdicts.ClaimError, match="claim table1_determination: no notebook makes 'explianed'"
    ):
        check_claims()


def test_missing_evidence_is_one_clear_error(changed):
    with pytest.raises(
        verdicts.ClaimError, match=r"figures/table1.csv is missing; .*study run tab"
    ):
        changed(without="table1")()
