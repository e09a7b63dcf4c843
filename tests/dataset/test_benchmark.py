"""The benchmark: its values follow from two sources, this study finds them again, and scores."""

import json
import re

import numpy as np
import pandas as pd
import pytest
from other_programs import benchmark as sources

from study import dataset, paths
from study.dataset import benchmark, store

EXAMPLE = paths.ROOT / "examples/benchmark_entry.csv"
VALUES = store.read(benchmark.VALUES)
ENTRIES = store.read(benchmark.ENTRIES)


def test_ten_joints_and_three_mechanisms_have_all_their_quantities():
    cases = sources.cases()
    assert cases.kind.value_counts().to_dict() == {"joint": 10, "mechanism": 3}
    assert [*cases.index] == [*sources.QUANTITIES]
    found = VALUES.groupby("case", sort=False).quantity.agg(tuple)
    assert found.to_dict() == sources.QUANTITIES


def test_a_value_is_the_mean_of_two_sources_and_its_uncertainty_covers_both():
    mean = (VALUES.value_1 + VALUES.value_2) / 2
    assert VALUES.value.to_numpy() == pytest.approx(mean.to_numpy(), rel=1e-9)
    difference = np.abs(VALUES.value_1 - VALUES.value_2) / mean.abs()
    parts = np.max([difference, VALUES.error_1, VALUES.error_2], axis=0)
    assert VALUES.uncertainty.to_numpy() == pytest.approx(parts, rel=0.05)  # it has two digits
    assert VALUES.source_1.str.startswith("this study").all()
    assert not VALUES.source_2.str.contains("this study").any()
    of_mechanism = VALUES.case.map(sources.cases().kind) == "mechanism"
    assert VALUES.uncertainty[of_mechanism].max() < 1e-5
    assert VALUES.uncertainty[~of_mechanism].max() < 0.03


NUMBER = r"\d+\.?\d*(?:e-?\d+)?"
OF_STUDY = "ball_support", "opening", "tilt"  # described in other words


@pytest.mark.parametrize("case", sources.QUANTITIES)
def test_a_description_has_every_number_of_the_arguments(case):
    stated = {float(n) for n in re.findall(NUMBER, sources.cases().description[case])}
    given = json.loads(sources.cases().arguments[case])
    texts = [str(value) for name, value in given.items() if name not in OF_STUDY]
    assert {float(n) for text in texts for n in re.findall(NUMBER, text)} <= stated


@pytest.mark.parametrize(
    "case",
    [
        *("hemisphere", "thin_socket", "close_fit", "ideal_slider", "first_impacts"),
        *("constant_speed", "reference", "rim_held"),
        pytest.param("hip_off_axis", marks=pytest.mark.slow),
        pytest.param("ball_stud_off_axis", marks=pytest.mark.slow),
        pytest.param("rod_end", marks=pytest.mark.slow),
    ],
)
def test_this_study_finds_its_values_again(case):
    rows = VALUES[VALUES.case == case]
    found = sources.by_study(case, finest=True)
    assert found.found == pytest.approx(rows.value_1.to_numpy(), rel=2e-5)
    assert (np.abs(found.found / rows.value - 1) <= rows.uncertainty).all()


@pytest.mark.parametrize(
    "case",
    ["ideal_slider", "constant_speed", pytest.param("first_impacts", marks=pytest.mark.slow)],
)
def test_equations_in_absolute_coordinates_find_their_values_again(case):
    rows = VALUES[VALUES.case == case]
    found = sources.by_absolute_coordinates(case, 1e-10).found
    assert (np.abs(found / rows.value_2 - 1) <= 2 * rows.uncertainty).all()


def test_values_are_those_of_solutions_from_elsewhere():
    stored = store.read(paths.DATA / "published/mechanism.csv").set_index(["model", "quantity"])
    own = VALUES.set_index(["case", "quantity"]).value
    for model, quantity, case, name in (
        ("ideal", "x_slider(0.1 s)", "ideal_slider", "slider position at 0.1 s"),
        ("ideal", "a_slider(0.1 s)", "ideal_slider", "slider acceleration at 0.1 s"),
        ("clearance", "first impact time", "first_impacts", "time of impact 1"),
        ("clearance", "first impact peak force", "first_impacts", "peak force of impact 1"),
    ):
        row = stored.loc[(model, quantity)]
        assert own[case, name] == pytest.approx(row.value, rel=max(row.trust, 1e-8))


def made_up(factors):
    """Rows whose values are those of a case times factors."""
    rows = VALUES[VALUES.case == "hemisphere"]
    factors = 1 + np.array(factors) * rows.uncertainty
    return rows[["case", "quantity"]].assign(value=rows.value * factors, time=2.0)


def test_scores_are_errors_over_the_uncertainty():
    found = benchmark.scored(made_up([0, 3, -0.5]))
    assert found.over_uncertainty.to_numpy() == pytest.approx([0, 3, 0.5], abs=1e-9)
    assert (found.error / found.uncertainty).to_numpy() == pytest.approx([0, 3, 0.5], abs=1e-9)


def test_entries_score_as_they_should():
    found = benchmark.scored(ENTRIES)
    assert (found.time > 0).all()
    assert (
        len(found[["entry", "case", "time"]].drop_duplicates())
        == found.groupby(["entry", "case"]).ngroups
    )
    of_laws = found[found.entry == "Hertz's law"].error.max()
    assert found[found.entry == "this study"].error.max() < 0.01 < 0.1 < of_laws
    assert {*found[found.entry == "this study"].case} == {*sources.QUANTITIES}


def test_the_example_is_read_and_scored_on_its_cases():
    found = benchmark.scored(benchmark.read_entry(str(EXAMPLE)))
    assert {*found.case} == {"hemisphere", "ideal_slider"}
    assert (found.over_uncertainty > 10).all()  # it is Hertz's law


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda f: f.drop(columns=["time"]), "must have columns .* time; missing: time$"),
        (lambda f: f.assign(case="nope"), "case of row 1 must be one of hemisphere.*, got 'nope'"),
        (
            lambda f: f.assign(quantity="f"),
            "quantity of row 1 must be one of force at 5 um.*got 'f'$",
        ),
        (lambda f: f.assign(value="1,5 N"), "value of row 1 must be a number, got '1,5 N'"),
        (lambda f: f.assign(value="nan"), "value of row 1 must be .*finite"),
        (lambda f: f.assign(time="0"), "time of row 1 must be > 0, got 0"),
        (lambda f: f[:0], "must have a row"),
        (lambda f: pd.concat([f, f]), "each quantity of a case once"),
    ],
)
def test_a_wrong_entry_is_a_sentence(tmp_path, change, message):
    path = tmp_path / "my.csv"
    change(pd.read_csv(EXAMPLE, dtype=str)).to_csv(path, index=False)
    with pytest.raises(ValueError, match=message):
        benchmark.read_entry(str(path))


def test_a_file_that_does_not_exist_or_is_no_table_is_named(tmp_path):
    for text in (None, ""):
        path = tmp_path / "none.csv"
        if text is not None:
            path.write_text(text)
        with pytest.raises(
            ValueError, match=r"mine must be a CSV file that can be read, got .*none"
        ):
            benchmark.read_entry(str(path))


def test_the_series_from_elsewhere_is_in_the_values():
    stored = dataset.reference_forces()
    joint, _ = sources.joint_of("hemisphere")
    rows = VALUES[VALUES.case == "hemisphere"]
    assert (rows.value_2 / joint.force_unit).to_numpy() == pytest.approx(
        stored.force_star[[1, 4, 5]].to_numpy(), rel=1e-5
    )
