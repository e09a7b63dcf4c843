"""Kept solutions: the same as solved anew, found by their joint, and solved if not kept."""

import json

import numpy as np
import pandas as pd
import pytest

from study.contact import Material
from study.dataset import DatasetError, production, solutions, store
from study.joint import DimensionalJoint, Joint, Layer, force_curve, paper_joint, stress


def test_a_random_part_of_every_file_is_solved_again():
    production.check_solutions(0.005)


def test_a_changed_number_is_found(monkeypatch):
    every = {path: store.read(path) for path in [store.CASES, *store.SOLUTIONS.values()]}
    every[store.SOLUTIONS["stress"]].loc[:, "von_mises"] *= 1 + 1e-5
    monkeypatch.setattr(store, "read", every.__getitem__)
    with pytest.raises(DatasetError, match=r"stresses.csv: case \w+ solved again differs"):
        production.check_solutions(0.001)


@pytest.fixture
def nothing_is_solved(monkeypatch):
    def solve(case):
        raise AssertionError(f"{case} is not kept")

    monkeypatch.setattr(solutions, "solve", solve)


def test_a_kept_curve_is_found_by_its_joint(nothing_is_solved):
    curves = (of for of in solutions.cases() if of.kind == "axial")
    case = next(of for of in curves if json.loads(of.arguments)["depth_star"])
    joint = solutions.read_joint(case)
    kept = solutions.curve(joint, **json.loads(case.arguments))
    assert kept.joint == joint
    np.testing.assert_allclose(kept.depth_star, json.loads(case.arguments)["depth_star"])
    assert (np.diff(kept.force_star[np.argsort(kept.depth_star)]) > 0).all()


def test_what_is_not_kept_is_solved():
    joint = Joint(77.7, 1.5)
    solved, direct = solutions.curve(joint, [0.2, 0.1]), force_curve(joint, [0.2, 0.1])
    for name in solutions.Curve._fields[1:]:
        np.testing.assert_allclose(getattr(solved, name), getattr(direct, name), rtol=1e-8)


def test_stresses_are_those_of_the_library():
    joint = Joint(123.4, 1.4, Material(2e11, 0.3, 1e9), Material(2e11, 0.3, 5e8))
    kept = solutions.stress_over_depth(joint)
    first = stress.first_crossing(joint, kept, 1.0)
    assert first.body == stress.first_yield(joint).body
    assert first.depth_star == pytest.approx(stress.first_yield(joint).depth_star, rel=1e-6)


@pytest.mark.parametrize(
    "joint",
    [
        Joint(30),
        paper_joint(200.0, ball_support="core:0.3", opening=70),
        Joint(
            50,
            ball=Material(1e11, 0.2),
            layers=(Layer(1.2, Material(3e9, 0.4)), Layer(2.0, Material())),
        ),
        Joint(50, opening="55:125", ball_support="bore:0.5,45"),
        Joint(80, ball_support="neck:30", socket_support="sector:60,90", kinematics="small"),
    ],
    ids=["default", "core", "layers", "ring", "neck"],
)
def test_a_joint_is_read_as_it_was_written(joint):
    case = solutions.case_of("axial", joint, {"depth_star": [0.1]})
    again = solutions.read_joint(case)
    assert solutions.case_of("axial", again, {"depth_star": [0.1]}) == case
    assert again.columns() == joint.columns()
    assert again.configuration == joint.configuration


def test_a_joint_with_dimensions_is_read_as_it_was_written():
    joint = DimensionalJoint(
        10e-3, 50e-6, 4e-3, ball="steel", liner="2e-3,POM", ball_support="pin:2e-3,9e-3"
    )
    case = solutions.case_of("loaded", joint, {})
    again = solutions.read_joint(case)
    assert solutions.case_of("loaded", again, {}) == case
    assert again.joint.layers == joint.joint.layers
    assert again.ball_support.radius == pytest.approx(joint.ball_support.radius, rel=1e-8)


def test_recording_renews_the_rows_of_one_notebook(tmp_path, monkeypatch):
    monkeypatch.setattr(store, "CASES", tmp_path / "cases.csv")
    monkeypatch.setattr(store, "read", pd.read_csv)
    pd.DataFrame(columns=solutions.COLUMNS).to_csv(store.CASES)
    monkeypatch.setattr(store, "keep", lambda frame, path, **_: frame.to_csv(path, index=False))
    one, two = (solutions.case_of("axial", Joint(r), {"depth_star": None}) for r in (50, 60))
    solutions.record("first", [one, two])
    solutions.record("second", [two])
    solutions.record("first", [one])
    assert solutions.design().set_index("case").notebooks.to_dict() == {
        one.name: "first",
        two.name: "second",
    }
