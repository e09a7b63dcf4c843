"""Every statement has its number in a result, and verdicts follow from numbers alone."""

import re

import pandas as pd
import pytest

from study import checks, dataset, paths
from study.claims import verdicts
from study.dataset import store
from study.pages.catalogue import CATALOGUE

ROWS = verdicts.load()
JUDGED = verdicts.judge()
FILE = pd.read_csv(paths.DATA / "published/claims.csv", keep_default_na=False, dtype=str)
RESULTS = {name for notebook in CATALOGUE for name in notebook.results}


def test_kept_claims_are_the_computed_ones():
    kept = pd.read_csv(paths.FIGURES / "claims.csv", keep_default_na=False)
    assert list(kept) == list(JUDGED)
    for column in ("claim", "verdict", "found"):
        assert kept[column].tolist() == JUDGED[column].tolist()


def test_every_bound_of_ours_is_tried_at_half_and_twice():
    """Of a number, of its excess over 1 or an even share of 25 %, or of the odds of a share."""
    for row in ROWS.itertuples():
        (low, high) = min(row.bounds), max(row.bounds)
        if len(row.bounds) > 1:
            (least, most) = (low[0], high[0]) if low[0] != high[0] else (low[1], high[1])
            shifted = [(least - even, most - even) for even in (0, 1, 25)]
            shifted.append((least * (100 - most), most * (100 - least)))
            assert any(4 * a == pytest.approx(b, rel=0.01) for a, b in shifted), row.claim


def test_every_number_of_tables_1_and_2_is_a_claim():
    stated = pd.read_csv(paths.DATA / "published/tables.csv")
    stated = stated[stated["where"].isin(["Table 1", "Table 2"])]
    keys = {"/".join(row) for row in stated[["where", "row", "quantity"]].itertuples(index=False)}
    assert keys <= set(FILE[FILE.relation == "="].expected)


def test_every_claim_is_whole_and_has_its_number():
    assert not ROWS.claim.duplicated().any()
    assert set(JUDGED.verdict) == set(verdicts.VERDICTS)
    assert set(JUDGED.kind) == set(verdicts.KINDS)
    for row in ROWS.itertuples():
        for column in ("part", "where", "statement", "measure", "assumes"):
            assert getattr(row, column).strip()
        assert {row.figure, row.evidence} <= RESULTS
        assert row.relation in verdicts.RELATIONS
        assert all(expected != 0 and tolerance >= 0 for expected, tolerance in row.bounds)
        assert verdicts.readings(row.evidence, row.row, row.column)


def test_every_number_for_statements_judges_one():
    """No notebook computes a number that nothing needs; one of a name has one value a reading."""
    for name in RESULTS:
        if name.startswith("numbers_"):
            table = pd.read_csv(paths.read_result(f"{name}.csv"))
            assert list(table) == ["quantity", "reading", "value", "unit"]
            assert set(table.quantity) == set(ROWS[ROWS.evidence == name].row)
            assert not table.duplicated(["quantity", "reading"]).any()
            assert table.groupby("quantity").unit.nunique().eq(1).all()


def test_the_notebook_depends_on_all_evidence():
    (notebook,) = [n for n in CATALOGUE if "claims" in n.results]
    assert sorted(notebook.reads) == sorted(set(ROWS.evidence))


@pytest.mark.parametrize(
    ("values", "relation", "bounds", "found"),
    [
        ([101, 99], "=", [(100, 1)], "reproduced"),
        ([101.1], "=", [(100, 1)], "contradicted"),
        ([105, 111], "=", [(100, 1)], "contradicted"),
        ([95, 111], "=", [(100, 1)], "undecided"),
        ([-100], "=", [(-100, 1)], "reproduced"),
        ([100], ">=", [(100, 0)], "reproduced"),
        ([100], ">", [(100, 0)], "contradicted"),
        ([100], "<=", [(100, 0)], "reproduced"),
        ([100], "<", [(100, 0)], "contradicted"),
        ([150], ">", [(100, 1)], "reproduced"),
        ([50, 150], ">", [(100, 1)], "undecided"),
        # a bound of ours must not decide
        ([7], "<", [(5, 0), (20, 0)], "undecided"),
        ([4], "<", [(5, 0), (20, 0)], "reproduced"),
        ([21], "<", [(5, 0), (20, 0)], "contradicted"),
        ([1.1], "=", [(1, 5), (1, 20)], "undecided"),
    ],
)
def test_verdict_by_hand(values, relation, bounds, found):
    assert verdicts.verdict(values, relation, bounds) == found
    if len(values) == 1:
        decides = ["the tolerance, which this study chose"] if found == "undecided" else []
        assert verdicts.depends_on(["a"], verdicts.holds(values, relation, bounds)) == decides


@pytest.mark.parametrize(
    ("values", "bounds", "found"),
    [
        ([7, 8], [(5, 0), (20, 0)], "a tolerance is missing"),
        ([3, 30], [(5, 0), (20, 0)], "data are missing"),
        ([3, 7], [(5, 0), (20, 0)], "data are missing"),  # a tolerance matters too
    ],
)
def test_the_reason_of_an_undecided_statement(values, bounds, found):
    held = verdicts.holds(values, "<=", bounds)
    assert verdicts.reason(held, "data") == found
    by_wording = found.replace("data are missing", "wording allows several readings")
    assert verdicts.reason(held, "wording") == by_wording


def test_numbers_on_both_sides_of_a_stated_one_are_no_question_of_tolerance():
    assert verdicts.reason(verdicts.holds([95, 111], "=", [(100, 1)]), "data") == "data are missing"


def test_only_undecided_statements_have_a_reason_and_readings_are_explained():
    has_reason = JUDGED.undecided_because.isin(verdicts.REASONS)
    assert has_reason.equals(JUDGED.verdict == "undecided")
    assert set(JUDGED.undecided_because) == {"", *verdicts.REASONS}
    for row in ROWS.itertuples():
        several = len(verdicts.readings(row.evidence, row.row, row.column)) > 1
        assert several == (row.readings in verdicts.MISSING), row.claim


def test_the_scale_of_the_relative_rmse_is_that_of_the_paper():
    for row in ROWS[
        ROWS.measure.str.match(r".*[Rr]elative RMSE") & (ROWS.readings != "")
    ].itertuples():
        assert row.expected == "6.8", row.claim
    verdict = JUDGED.set_index("claim").verdict
    assert verdict[["depth_to_one", "small_error"]].tolist() == ["contradicted", "undecided"]


def test_no_words_contradict_a_relation():
    words = {
        ">=": r"at least|must be",
        "<=": "at most",
        "<": "less than",
        "=": "must|both|all five",
    }
    words[">"] = "more than|greater than|must exceed"
    for row in ROWS.itertuples():
        assert re.search(words[row.relation], row.measure), (row.claim, row.relation)


def test_what_a_verdict_hangs_on_is_the_part_that_changes_it():
    names = ["rigid, 50 ms", "rigid, 200 ms", "beams, 50 ms", "beams, 200 ms"]
    held = verdicts.holds([3, 1, 3, 1], ">", [(2, 0)])
    assert verdicts.depends_on(names, held) == ["50 ms or 200 ms"]
    held = verdicts.holds([3, 3, 3, 1], ">", [(2, 0)])
    assert verdicts.depends_on(names, held) == ["rigid or beams", "50 ms or 200 ms"]
    assert verdicts.depends_on(names, verdicts.holds([3, 3, 3, 3], ">", [(2, 0)])) == []


def test_a_verdict_says_what_it_hangs_on():
    undecided = JUDGED[JUDGED.verdict == "undecided"].set_index("claim").depends_on
    assert undecided["larger_force"] == "50 ms or 200 ms or 100 ms"
    assert undecided["projection_is_essential"] == "the tolerance, which this study chose"
    decided = JUDGED[JUDGED.verdict != "undecided"].set_index("claim").depends_on
    assert decided.equals(ROWS.set_index("claim").assumes[decided.index].rename("depends_on"))
    assert not set(undecided) & set(ROWS.assumes)


@pytest.fixture
def change(monkeypatch, tmp_path):
    """Change a claim in a copy of the file, from now on; the copy has no hash."""
    monkeypatch.setattr(verdicts, "CLAIMS", tmp_path / "claims.csv")
    monkeypatch.setattr(store, "verify", lambda some: None)

    def write(claim, column, value):
        rows = FILE.copy()
        rows.loc[rows.claim == claim, column] = value
        rows.to_csv(verdicts.CLAIMS, index=False)

    return write


@pytest.mark.parametrize(
    ("claim", "column", "value", "verdict"),
    [
        ("shape_beats_hertz", "expected", "2", "reproduced"),
        ("half_angle", "tolerance", "30", "reproduced"),
        ("half_angle", "tolerance", "5 to 40", "undecided"),
        ("order", "row", "hertz RMSE", "contradicted"),
    ],
)
def test_a_changed_claim_changes_its_verdict(change, claim, column, value, verdict):
    assert JUDGED.set_index("claim").verdict[claim] != verdict
    change(claim, column, value)
    assert verdicts.judge().set_index("claim").verdict[claim] == verdict


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("expected", "many", "claims.csv is missing or damaged (could not convert string to float"),
        ("expected", "Table 2/hertz/nothing", "claims.csv is missing or damaged (('Table 2', 'he"),
        ("evidence", "nothing", "figures/nothing.csv must have finite numbers in the column value"),
        ("column", "reading", "make it with: study run numbers_00"),
    ],
)
def test_a_wrong_claim_is_one_clear_error(change, column, value, message):
    change("half_angle", column, value)
    with pytest.raises(checks.StudyError, match=re.escape(message)) as error:
        verdicts.judge()
    assert "\n" not in str(error.value)


def test_a_damaged_file_of_claims_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr(verdicts, "CLAIMS", tmp_path / "claims.csv")
    with pytest.raises(dataset.DatasetError, match=r"claims\.csv is missing, or not the file"):
        verdicts.load()
