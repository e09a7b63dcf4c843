"""Notebooks with other parameters give their results, or say in one sentence what they need."""

import os

import pytest

from study import paths
from study.checks import StudyError
from study.pages import build, catalogue

pytestmark = pytest.mark.slow


@pytest.fixture
def execute(tmp_path, monkeypatch):
    """Execute a notebook, given by its number, with some parameters, from accepted results."""
    # a copy, because the execution changes the environment
    monkeypatch.setattr(os, "environ", os.environ | {paths.READ_VARIABLE: str(paths.FIGURES)})

    def run(number, **given):
        (notebook,) = (n for n in catalogue.CATALOGUE if n.name.startswith(number))
        build.execute(notebook, tmp_path, tmp_path / "executed.ipynb", given)
        return {name for name in notebook.files() if (tmp_path / name).stat().st_size}, notebook

    return run


@pytest.mark.parametrize(
    ("number", "given"),
    [
        ("00", {"depths": [0.5]}),
        ("12", {"resolutions": [32, 64], "ratios": [2], "poissons": [0]}),
        ("21", {"parts": ["Table 2"]}),
        ("30", {"mine": str(paths.ROOT / "examples/benchmark_entry.csv")}),
    ],
)
def test_one_value_of_a_list_gives_results(execute, number, given):
    made, notebook = execute(number, **given)
    assert made == set(notebook.files())


@pytest.mark.parametrize(
    ("number", "given", "message"),
    [
        ("00", {"depths": []}, "ValueError: depths must be a list of one value or more, got []"),
        ("06", {"radii": [20]}, "radii must be a list of 2 values or more, got [20]"),
        ("17", {"resolution": 100}, "ValueError: resolution must be a multiple of 32, got 100"),
        ("21", {"parts": ["nope"]}, "RangeError: parts must be one of force and depth, range of"),
        ("30", {"mine": "none.csv"}, "mine must be a CSV file that can be read, got none.csv"),
        ("31", {"specific_load": -5}, "specific_load must be >= 20 and <= 500 MPa, got -5 MPa"),
        ("31", {"bearing": "GE 21 E"}, "bearing must be GE SIZE E, where SIZE is one of 4, 5"),
    ],
)
def test_a_wrong_parameter_is_one_sentence(execute, number, given, message):
    with pytest.raises(StudyError) as error:
        execute(number, **given)
    assert message in str(error.value)
    assert "\n" not in str(error.value)
