"""Results beside the kept ones: what is identical, agrees or differs, and what is written."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from study import paths
from study.dataset.tolerance import table_differs
from study.pages import baseline, figures
from study.pages.catalogue import Notebook, Result


@pytest.fixture
def folders(tmp_path, monkeypatch):
    """Empty folders that the module takes for the project's."""
    monkeypatch.setattr(paths, "FIGURES", tmp_path / "figures")
    monkeypatch.setattr(paths, "BUILD", tmp_path / "build")
    monkeypatch.setenv(paths.RESULTS_VARIABLE, str(tmp_path / "work"))
    return tmp_path


FIGURE = Result("fig", "00-mine", shows="a figure", tells="It grows.")
NOTEBOOK = Notebook("00-mine", {"fig": FIGURE})


def make(folders, scale=1.0, label="force"):
    """Make a figure, as a notebook does, and compare it with the kept one."""
    table = pd.DataFrame({"case": ["a", "b", "c"], "x": [0.1, 0.2, 0.3], "force": [1.0, 5.0, 25.0]})
    table["force"] *= scale
    figure, axes = figures.new(width=2, height=2)
    axes.plot(table.x, table.force)
    axes.set_ylabel(label)
    figures.save(figure, "fig", table)
    baseline.take_over(folders / "work", NOTEBOOK)
    (comparison,) = baseline.compare([NOTEBOOK])
    return comparison


def kept_bytes(folders):
    return [(folders / "figures" / file).read_bytes() for file in FIGURE.files]


def test_a_result_that_is_new_or_agrees_leaves_the_kept_files(folders):
    assert make(folders).state == "identical"  # there was none: what was made is kept
    first = kept_bytes(folders)
    assert make(folders).state == "identical"
    assert make(folders, 1 + 5e-7).state == "agrees"
    assert kept_bytes(folders) == first


def test_numbers_that_differ_are_written_and_named(folders):
    make(folders)
    first = kept_bytes(folders)
    found = make(folders, 1.004)
    assert found.state == "differs"
    assert found.where == "figures/fig.csv, row 4, column force: kept 25, now 25.1 (3 in all)"
    assert kept_bytes(folders) != first
    assert make(folders, 1.004).state == "identical"  # with those that it has replaced


def test_a_label_that_differs_is_written_and_seen_beside_numbers_that_agree(folders):
    make(folders)
    first = kept_bytes(folders)
    found = make(folders, label="Force")
    assert found.state == "differs"
    assert "figures/fig.png" in found.where
    assert kept_bytes(folders)[0] == first[0]
    assert kept_bytes(folders)[1] != first[1]
    assert make(folders, 1 + 5e-7).state == "differs"


@pytest.mark.parametrize(("name", "left"), [("fig.csv", 0), ("fig.png", 0), ("fig.png", 60)])
def test_a_kept_file_that_is_damaged_is_named_and_made_again(folders, name, left):
    make(folders)
    path = folders / "figures" / name
    whole = path.read_bytes()
    path.write_bytes(whole[:left])
    assert make(folders) == ("differs", f"figures/{name}, the kept file was damaged")
    assert path.read_bytes() == whole


def table(folders, name, **columns):
    path = folders / f"{name}.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    pd.DataFrame(columns).to_csv(path, index=False)
    return path


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ({"a": [1.0]}, {"b": [1.0]}, "columns: kept a; now b"),
        ({"a": [1.0]}, {"a": [1.0, 2.0]}, "rows: kept 1, now 2"),
        ({"a": ["x", "y"]}, {"a": ["x", "z"]}, "row 3, column a: kept y, now z (1 in all)"),
        ({"a": [7]}, {"a": [8]}, "row 2, column a: kept 7, now 8 (1 in all)"),
        ({"a": [1.0]}, {"a": [1.0000005]}, None),
        ({"a": [1e-14]}, {"a": [3e-13]}, None),  # differences of numbers of size 1
    ],
)
def test_tables_are_compared_number_by_number(tmp_path, old, new, text):
    found = table_differs(table(tmp_path, "t", **old), table(tmp_path / "new", "t", **new))
    assert found == text


def test_chaotic_results_and_few_digits_have_their_own_tolerance(tmp_path):
    column = {"value": [2.0, 1e-4]}
    other = {"value": [2.001, 1.01e-4]}
    for name, text in (("convergence", None), ("fig10", "row 3")):
        old, new = table(tmp_path, name, **column), table(tmp_path / "new", name, **other)
        found = table_differs(old, new)
        assert found is None if text is None else found.startswith(text)
    name, column = "stability_steps", {"y": ["1.23", "4.56e-07"]}
    for value, same in (("1.24", True), ("1.26", False)):
        old = table(tmp_path, name, **column)
        new = table(tmp_path / "new", name, y=[value, "4.57e-07"])
        assert (table_differs(old, new) is None) == same


@given(st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=8), st.floats(-9e-7, 9e-7))
def test_any_change_within_the_tolerance_agrees_and_twice_it_does_not(tmp_path_factory, x, change):
    folder = tmp_path_factory.mktemp("tables")
    x = np.round(x, 3)
    old = table(folder, "t", a=x)
    assert table_differs(old, table(folder / "near", "t", a=x * (1 + change))) is None
    beyond = table_differs(old, table(folder / "far", "t", a=x * (1 + 2.1e-6)))
    assert (beyond is None) == (not x.any())
