"""Set-ups at random, numbers of the statements on Figs. 17 to 21, and which of them hold."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from study import dataset
from study.claims import search, set_ups, verdicts
from study.claims.motion_quantities import motion_quantities
from study.mechanism import Scene, paper_scene, simulate

CLAIMS = search.statements()
RUNS = dataset.set_ups()
COMMON = {"duration": 0.04, "outputs": 800}
IDEAL = simulate(paper_scene(), joint="ideal", **COMMON)


def shifted(response, places, column):
    """A response that is earlier by a number of outputs, in one column."""
    rows = response.rows.copy()
    rows[column][:-places] = rows[column][places:]
    return replace(response, rows=rows)


def test_set_ups_are_the_same_for_a_seed_and_within_their_ranges():
    drawn = list(set_ups.draw(3, count=8))
    assert drawn == list(set_ups.draw(3, count=8)) != list(set_ups.draw(4, count=8))
    for one in drawn:
        for joint in [joint for some in one.joints.values() for joint in some]:
            values = one.mechanism | joint
            for name, (low, high) in set_ups.RANGES.items():
                assert values[name] is None or low <= values[name] <= high
            if values["as_stated"]:
                assert (values["friction"], values["restitution"]) == (0.05, 0.5)
                assert values["initial_crank_angle"] in (0.0, np.pi)
    assert {one.mechanism["as_stated"] for one in drawn} == {True, False}


def test_a_scene_keeps_what_the_paper_states():
    for one in set_ups.draw(count=4):
        for model in set_ups.MODELS:
            scene = set_ups.scene(one.mechanism, one.joints["rigid"][1], model)
            for name in ("crank_length", "coupler_mass", "slider_mass", "clearance", "poisson"):
                assert getattr(scene, name) == getattr(Scene, name)
            assert abs(scene.driving_moment) == Scene.driving_moment
            assert model == "rigid" or scene.crank_clearance is None


def test_every_statement_on_the_figures_has_a_number_and_a_bound():
    kept = verdicts.load().set_index("claim")
    assert set(CLAIMS.relation) <= {"<", ">"}
    assert {"slightly_ahead", "persistent_impacts", "downwards"} <= set(CLAIMS.claim)
    assert (kept.expected[CLAIMS.claim].to_numpy() == CLAIMS.expected).all()
    flexible = CLAIMS[CLAIMS.claim.str.startswith("methods_agree")]
    meant = {name for row in CLAIMS.row for name in meant_by(row)}
    assert meant - set(flexible.row) <= set(motion_quantities(IDEAL, IDEAL))
    assert meant <= set(RUNS)


def test_an_ideal_joint_beside_itself_is_neither_ahead_nor_different():
    numbers = motion_quantities(IDEAL, IDEAL)
    assert numbers["time for which the slider is ahead"] == 0
    assert numbers["acceleration, difference of clearance and ideal joint"] == 0
    assert numbers["largest early acceleration over that of the ideal joint"] == 1
    assert numbers["force over that of the ideal joint"] == 1
    assert numbers["time in which the force swings"] == 0
    assert np.isnan(numbers["first touch below the centre"])


@pytest.mark.parametrize(
    ("column", "name"),
    [("slider_position", "slider is"), ("slider_velocity", "slider's velocity is")],
)
def test_an_earlier_motion_is_ahead_and_a_later_one_is_not(column, name):
    earlier = shifted(IDEAL, 3, column)
    key = f"time for which the {name} ahead"
    assert motion_quantities(earlier, IDEAL, 0.03)[key] > 95
    assert motion_quantities(IDEAL, earlier, 0.03)[key] < 5


def test_numbers_of_the_papers_scene_up_to_a_time():
    response = simulate(paper_scene(), **COMMON)
    whole, part = motion_quantities(response, IDEAL), motion_quantities(response, IDEAL, 0.02)
    assert whole["last separation"] == pytest.approx(100 * response.last_separation / 0.04)
    assert part["last separation"] == pytest.approx(2 * whole["last separation"])
    touches = response.depth > 0
    assert whole["time in contact"] == pytest.approx(100 * touches.mean())
    angle = np.degrees(np.arctan2(response.eccentricity_y, response.eccentricity_x))[touches]
    assert whole["arc that the contact covers"] == np.unique(np.floor(angle % 360)).size
    assert whole["first touch below the centre"] == pytest.approx(100, abs=0.01)


def meant_by(row):
    """Names of the measures that may be meant by the number of a claim."""
    return search.MEASURES.get(row, (row,))


def test_a_number_holds_on_the_right_side_of_the_mildest_of_its_bounds():
    inside, outside = {}, {}
    for claim in CLAIMS.itertuples():
        sign, mildest = (1, min) if claim.relation == ">" else (-1, max)
        bound = mildest(expected for expected, _ in claim.bounds)
        inside |= dict.fromkeys(meant_by(claim.row), bound * (1 + 0.001 * sign))
        outside |= dict.fromkeys(meant_by(claim.row), bound * (1 - 0.001 * sign))
    inside, outside = pd.DataFrame([inside]), pd.DataFrame([outside])
    assert search.held(inside).all(axis=None)
    assert not search.held(outside).any(axis=None)
    nothing = search.held(inside * np.nan)
    assert nothing.isna().sum(axis=1)[0] == 3  # the agreement of two methods is not measured
    assert not nothing.any(axis=None)
    inside["last separation"] = 0.0  # one of two measures is enough
    assert search.held(inside).all(axis=None)


def test_pairs_that_never_hold_together():
    holds = pd.DataFrame({"a": [1, 1, 0], "b": [0, 1, 0], "c": [0, 0, 1], "d": [0, 0, 0]})
    assert search.never_together(holds.astype(bool)) == [("a", "c"), ("b", "c")]


def test_kept_runs_are_those_of_the_set_ups():
    drawn = [*set_ups.draw(), *set_ups.FOUND]
    assert set(RUNS.set_up) == {one.number for one in drawn}
    sizes = {kind: size * set_ups.MECHANISMS for kind, size in set_ups.JOINTS.items()}
    count = RUNS.groupby("kind").size()
    for kind, size in (sizes | {"found": len(set_ups.FOUND)}).items():
        assert count[kind] == size * len(set_ups.OF_KIND[kind])
    assert (RUNS[RUNS.model == "rigid"].fed_in_percent.dropna().abs() < 1e-3).all()


def test_what_the_directed_search_found_holds_again():
    """With rigid links and few impacts, whose motion is the same at another tolerance."""
    one = set_ups.FOUND[0]
    rigid = one._replace(joints={"rigid": one.joints["found"]})
    found = set_ups.run([rigid])
    kept = RUNS[(RUNS.set_up == one.number) & (RUNS.model == "rigid")]
    for row in CLAIMS.row[~CLAIMS.claim.str.startswith("methods_agree")]:
        for name in meant_by(row):
            assert found[name].iloc[0] == pytest.approx(kept[name].iloc[0], rel=1e-3)
    holds = search.held(found.reindex(columns=[*RUNS]))
    assert holds.sum(axis=1)[0] == holds.notna().sum(axis=1)[0] == 10
