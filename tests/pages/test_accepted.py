"""Results that were made, compared with the accepted ones: identical, agreeing or different."""

from io import StringIO

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import paths
from study.checks import StudyError
from study.dataset.compare import differs
from study.pages import accepted, figures
from study.pages.catalogue import Result

FIGURE = Result("fig", "00-mine", shows="a figure", tells="It grows.")
TABLE = pd.DataFrame({"case": ["a", "b", "c"], "force": [1.0, 5.0, 25.0]})


@pytest.fixture
def make(tmp_path, monkeypatch):
    """Make the figure as a notebook does, and compare it with the accepted one."""
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "FIGURES", tmp_path / "figures")
    monkeypatch.setattr(paths, "RESULTS", tmp_path / "build/results")
    monkeypatch.setenv(paths.WRITE_VARIABLE, str(tmp_path / "build/results"))

    def make(table, label="force"):
        figure, axes = figures.new(width=2, height=2)
        axes.plot(table.force)
        axes.set_ylabel(label)
        figures.save(figure, "fig", table)
        (comparison,) = accepted.compare([FIGURE])
        return comparison

    return make


def test_states_of_a_result_and_what_is_copied(make):
    first = make(TABLE)
    assert (first.state, first.where) == (
        "differs",
        "build/results/fig.csv: it was not accepted before",
    )
    assert accepted.accept([FIGURE]) == ["fig.csv", "fig.png"]
    same = make(TABLE)
    assert (same.state, same.drawn_differently) == ("identical", False)
    drawn = make(TABLE, label="Force")
    assert (drawn.state, drawn.drawn_differently) == ("identical", True)
    assert make(TABLE.assign(force=TABLE.force * (1 + 5e-7))).state == "agrees"
    assert make(TABLE.assign(force=TABLE.force * (1 + 1.5e-6))).state == "differs"
    before = {path: path.read_bytes() for path in paths.FIGURES.iterdir()}
    other = make(TABLE.assign(force=TABLE.force * 1.004))
    assert other.where == (
        "build/results/fig.csv, row 2, column force: accepted 1, now 1.004 (3 in all)"
    )
    assert {path: path.read_bytes() for path in paths.FIGURES.iterdir()} == before
    assert accepted.summary([first, same, drawn, other]) == (
        "4 results: 2 identical, 0 agree, 2 differ"
    )
    assert accepted.accept([FIGURE]) == ["fig.csv", "fig.png"]


def test_what_was_not_made_or_is_damaged_is_named(make):
    with pytest.raises(
        StudyError, match=r"results/fig.csv is missing; make it with: study run fig"
    ):
        accepted.accept([FIGURE])
    make(TABLE)
    accepted.accept([FIGURE])
    (paths.FIGURES / "fig.csv").write_bytes(b"")
    (damaged,) = accepted.compare([FIGURE])
    assert (damaged.state, "figures/fig.csv" in damaged.where) == ("differs", True)


def compared(old, new, name="t"):
    return differs(
        *(StringIO(pd.DataFrame(table).to_csv(index=False)) for table in (old, new)), name
    )


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ({"a": [1.0]}, {"b": [1.0]}, "columns: accepted a; now b"),
        ({"a": [1.0]}, {"a": [1.0, 2.0]}, "rows: accepted 1, now 2"),
        ({"a": ["x", "y"]}, {"a": ["x", "z"]}, "row 3, column a: accepted y, now z (1 in all)"),
        ({"a": [7]}, {"a": [8]}, "row 2, column a: accepted 7, now 8 (1 in all)"),
        ({"a": [1.0]}, {"a": [1.0000005]}, None),
        ({"a": [1e-14]}, {"a": [3e-13]}, None),  # differences of numbers of size 1
        ({"a": [0.0]}, {"a": [1.5e-12]}, "row 2, column a"),
        # rows that have changed places are matched by their words
        ({"a": ["x", "y", "y"], "b": [1, 2, 3]}, {"a": ["y", "x", "y"], "b": [2, 1, 3]}, None),
        (
            {"a": ["x", "y"], "b": [1, 2]},
            {"a": ["y", "x"], "b": [1, 2]},
            "row 2, column b: accepted 1, now 2",
        ),
        ({"a": [1, 2]}, {"a": [2, 1]}, "row 2, column a"),
    ],
)
def test_tables_are_compared_number_by_number(old, new, text):
    found = compared(old, new)
    assert found is None if text is None else found.startswith(text)


def test_chaotic_results_and_few_digits_have_their_own_tolerance():
    old, new = {"value": [2.0, 1e-4]}, {"value": [2.001, 1.01e-4]}
    assert compared(old, new, "convergence") is None
    assert compared(old, new, "fig10").startswith("row 2")
    new = {"value": [2.0031, 1e-4]}
    assert compared(old, new, "convergence").startswith("row 2, column value")
    for value, same in (("1.24", True), ("1.26", False)):
        column = {"y": [value, "4.57e-07"]}
        assert (compared({"y": ["1.23", "4.56e-07"]}, column, "stability_steps") is None) == same


@given(st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=8), st.floats(-9e-7, 9e-7))
def test_any_change_within_the_tolerance_agrees_and_twice_it_does_not(x, change):
    x = np.round(x, 3)
    assert compared({"a": x}, {"a": x * (1 + change)}) is None
    assert (compared({"a": x}, {"a": x * (1 + 2.1e-6)}) is None) == (not x.any())
