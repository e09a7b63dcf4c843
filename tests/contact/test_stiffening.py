"""The table behind stiffened_hertz, against joints that had no part in it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study import contact, dataset
from study.contact import stiffening
from study.dataset import stiffening_fit as made
from study.joint import Joint, reference_joint

OPTIONS = {
    "socket_ratio": st.floats(1.1, 1e3),
    "modulus_ratio": st.floats(1e-4, 1e4),
    "poisson": st.floats(0.2, 0.46),
    "socket_poisson": st.floats(0.2, 0.46),
    "ball_support": st.sampled_from(["guided", "clamped"]),
    "rim": st.sampled_from(["mirror", "free"]),
}
joints = st.fixed_dictionaries(OPTIONS)


def force(depth, joint, derivative=False):
    return contact.StiffenedHertz.of(joint)(depth, derivative=derivative)


def error(joint):
    """Largest relative error, from the shallowest depth that is solved to one clearance."""
    curve = joint.curve()
    inside = curve.depth_star <= 1
    return np.abs(force(curve.depth_star[inside], joint) / curve.force_star[inside] - 1).max()


def test_error_on_joints_that_had_no_part_in_it():
    rows = dataset.load(group="validation")
    keys = ["r2_star", "socket_ratio", "modulus_ratio", "poisson_ball", "poisson_socket"]
    errors, as_reference = [], []
    for (r2_star, ratio, modulus, *nu, drive, rim), case in rows.groupby(
        [*keys, "ball_support", "rim"]
    ):
        of = dict(zip(OPTIONS, (ratio, modulus, *nu, drive, rim), strict=True))
        found = force(case.depth_star, Joint.from_ratios(r2_star, **of))
        errors.append(np.abs(found / case.force_star - 1).max())
        if (drive, rim) == ("clamped", "free"):
            as_reference.append(errors[-1])
    assert len(errors) >= 340
    assert len(as_reference) >= 40
    assert max(as_reference) < 0.0025
    assert max(errors) < 0.005
    assert np.median(errors) < 0.001
    assert max(error(reference_joint(r2_star)) for r2_star in (20, 200)) < 0.003


@pytest.mark.parametrize("ratio", [1.1, 3.0, 1e6])
@pytest.mark.parametrize("modulus", [1e-9, 0.03, 1e9])  # of a rigid ball to a rigid socket
@pytest.mark.parametrize("r2_star", [20, 1e9])
def test_error_at_the_ends_of_the_range(ratio, modulus, r2_star):
    for nu in ((0.2, 0.46), (0.46, 0.2)):
        of = dict(zip(OPTIONS, (ratio, modulus, *nu), strict=False))
        assert error(Joint.from_ratios(r2_star, **of)) < 0.006  # the worst corner: 0.0057


@given(joints, st.floats(20, 1e6))
def test_force_grows_and_starts_as_that_of_hertz(options, r2_star):
    ds = np.concatenate([np.geomspace(1e-14, 1e-3, 50), np.linspace(1e-3, 1, 400)[1:]])
    joint = Joint.from_ratios(r2_star, **options)
    found = force(ds, joint)
    assert (np.diff(found) > 0).all()
    assert (force(ds, joint, derivative=True) > 0).all()
    assert found[0] == pytest.approx(contact.Hertz()(ds[0], r2_star), rel=1e-5)


@given(joints, st.floats(20, 1e6))
@settings(max_examples=40)
def test_force_is_continuous_in_every_parameter(options, r2_star):
    ds = np.array([0.01, 0.3, 1.0])
    here = force(ds, Joint.from_ratios(r2_star, **options))
    for name in ("socket_ratio", "modulus_ratio", "poisson", "socket_poisson"):
        value = options[name]
        beside = options | {name: value * (1 + 1e-7) if value < 0.4 or value > 1 else value - 1e-8}
        assert force(ds, Joint.from_ratios(r2_star, **beside)) == pytest.approx(here, rel=1e-5)
    other = Joint.from_ratios(r2_star * (1 + 1e-7), **options)
    assert force(ds, other) == pytest.approx(here, rel=1e-5)


@given(st.floats(0.2, 0.46), st.floats(0.2, 0.46), st.floats(1.1, 10))
def test_rigid_bodies_leave_no_trace_of_their_material(nu, other, ratio):
    def law(**options):
        return force(np.array([0.01, 0.3, 1.0]), Joint.from_ratios(200, **options))

    ball = {"modulus_ratio": 1e-9, "socket_poisson": nu, "socket_ratio": ratio}
    assert law(poisson=other, **ball) == pytest.approx(law(poisson=0.3, **ball), rel=0.01)
    socket = {"modulus_ratio": 1e9, "poisson": nu}
    of_other = law(socket_poisson=other, socket_ratio=ratio, **socket)
    assert of_other == pytest.approx(law(socket_poisson=0.3, **socket), rel=0.01)


def test_a_part_of_the_table_made_anew_is_the_kept_one():
    one = dict.fromkeys(stiffening.DEGREES, 1)
    found = made.logarithms(0.2, one)[0, 0, 0, 0]  # a rigid ball, the thinnest socket
    for clamped, free in np.ndindex(2, 2):
        bodies = 2e-9, 0.2, 0.2, 1.1
        kept = stiffening.powers(made.LARGEST, bodies, bool(clamped), bool(free))
        powers = stiffening.PLACES[:, None] ** np.arange(9, 0, -1)
        assert found[clamped, free] == pytest.approx(np.log1p(powers @ kept), abs=1e-3)


@pytest.mark.parametrize("text", [None, "a,b\nx,y\n"])
def test_a_damaged_table_is_named(monkeypatch, tmp_path, text):
    monkeypatch.setattr(stiffening, "TABLE", tmp_path / "stiffening.csv")
    monkeypatch.setattr(stiffening, "table", stiffening.table.__wrapped__)
    stiffening._in_r2_star.cache_clear()
    if text is not None:
        stiffening.TABLE.write_text(text)
    with pytest.raises(Exception, match=r"stiffening.csv is missing or damaged"):
        force(0.1, Joint.from_ratios(200))
