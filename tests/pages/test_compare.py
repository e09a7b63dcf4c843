"""Tables that were made, compared with those of the same name, and results with accepted ones."""

from io import StringIO

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import paths
from study.dataset.compare import differs
from study.pages import build
from study.pages.catalogue import Result

FIGURE = Result("fig", "00-mine", shows="a figure", tells="It grows.")
CHANGED = "row 2, column force: accepted 1, now 1.1 (1 in all)"
DAMAGED = "which cannot be compared: it or the accepted table (git restores it) is damaged"


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """Folders of the accepted and of the made results."""
    monkeypatch.setattr(paths, "FIGURES", tmp_path / "figures")
    monkeypatch.setattr(paths, "RESULTS", tmp_path / "results")
    for folder in (paths.FIGURES, paths.RESULTS):
        folder.mkdir()


@pytest.mark.parametrize(
    ("accepted", "made", "expected"),
    [
        ("force\n1\n", "force\n1\n", ("identical", "")),
        ("force\n1\n", "force\n1.0000005\n", ("agree", "")),
        ("force\n1\n", "force\n1.1\n", ("differ", CHANGED)),
        ("", "force\n1\n", ("differ", DAMAGED)),
        (None, "force\n1\n", ("differ", "which was not accepted before")),
    ],
)
def test_made_results_are_identical_agree_or_differ(folders, accepted, made, expected):
    if accepted is not None:
        (paths.FIGURES / "fig.csv").write_text(accepted)
    (paths.RESULTS / "fig.csv").write_text(made)
    assert build.compared(FIGURE) == expected


def compared(old, new, name="t"):
    return differs(
        *(StringIO(pd.DataFrame(table).to_csv(index=False)) for table in (old, new)), name
    )


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ({"a": [1.0]}, {"b": [1.0]}, "columns: added b; removed a"),
        ({"a": [1], "b": [1]}, {"b": [1], "a": [1]}, "columns: in another order"),
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
