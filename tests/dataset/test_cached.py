"""Stored solutions: found by their joint, solved if not stored."""

import numpy as np
import pytest

from study.contact import Material
from study.dataset import cached, store
from study.joint import Joint, reference_joint, yielding


def test_a_kept_curve_is_found_by_its_joint(monkeypatch):
    monkeypatch.setattr(cached, "solve", None)
    curves = (of for of in cached.requests() if of.kind == "axial")
    request = next(of for of in curves if of.arguments["depth_star"])
    joint = cached.joint_of(request)
    kept = cached.curve(joint, **request.arguments)
    assert kept.joint == joint
    np.testing.assert_allclose(kept.depth_star, request.arguments["depth_star"])
    assert (np.diff(kept.force_star[np.argsort(kept.depth_star)]) > 0).all()


def test_what_is_not_kept_is_solved():
    joint = Joint.from_ratios(77.7, 1.5)
    solved, direct = cached.curve(joint, [0.2, 0.1]), joint.solve(depth_star=[0.2, 0.1])
    for name in cached.COLUMNS["axial"]:
        np.testing.assert_allclose(getattr(solved, name), getattr(direct, name), rtol=1e-8)


def test_stresses_are_those_of_the_library():
    bodies = {body: Material(yield_stress=of) for body, of in (("ball", 1e9), ("socket", 5e8))}
    joint = Joint.from_ratios(123.4, 1.4, **bodies)
    kept = cached.stress_over_depth(joint)
    first = yielding.first_crossing(joint, kept, 1.0)
    assert first.body == yielding.first_yield(joint).body
    assert first.depth_star == pytest.approx(yielding.first_yield(joint).depth_star, rel=1e-6)


@pytest.mark.parametrize(
    "joint",
    [
        Joint.from_ratios(30),
        reference_joint(200.0, ball_support="core:0.3", opening=70),
        Joint.from_ratios(50, ball=Material(1e11, 0.2), layers="1.2,0.015,0.4;2,1,0.3"),
        Joint.from_ratios(50, opening="55:125", ball_support="bore:0.5,45"),
        reference_joint(80, ball_support="neck:30", socket_support="sector:60,90"),
    ],
    ids=["default", "core", "layers", "ring", "neck"],
)
def test_a_joint_is_read_as_it_was_written(joint):
    request = cached.request_of("axial", joint, {"depth_star": [0.1]})
    again = cached.joint_of(request)
    assert cached.request_of("axial", again, {"depth_star": [0.1]}) == request
    assert again.columns() == joint.columns()
    assert again.supports == joint.supports


def test_a_joint_with_dimensions_is_read_as_it_was_written():
    joint = Joint(10e-3, 50e-6, 4e-3, ball="steel", liner="2e-3,POM", ball_support="pin:2e-3,9e-3")
    request = cached.request_of("loaded", joint, {})
    again = cached.joint_of(request)
    assert cached.request_of("loaded", again, {}) == request
    assert again.layers == joint.layers
    assert again.ball_support.radius == pytest.approx(joint.ball_support.radius, rel=1e-8)


def test_the_list_of_cases_is_written_as_it_was(tmp_path, monkeypatch):
    before, every = store.CASES.read_bytes(), cached.requests()
    monkeypatch.setattr(store, "CASES", tmp_path / "cases.json")
    monkeypatch.setattr(store, "write_hashes", list)
    cached.store_requests(every)
    assert store.CASES.read_bytes() == before
