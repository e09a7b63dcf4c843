"""Largest forces of the rigid links by other integrators, against those of this study."""

from importlib.util import find_spec

import numpy as np
import pytest
from benchmarks import second
from helpers.with_hertz import simulate
from other_programs import compiled_lsoda, cvode, multibody, odes

from study.measure import explicit
from study.mechanism import paper_scene

SCENE, DURATION = paper_scene(), 0.03  # s: eight impacts, and sustained contact
LAW = explicit.packed(SCENE, "hertz")


@pytest.fixture(scope="module")
def forces():
    impacts = simulate(SCENE, duration=DURATION, outputs=10, tolerance=1e-11).impacts
    assert len(impacts) == 9
    return np.array([impacts.peak_force.max(), impacts.peak_force.iloc[0]])


def test_cvode_finds_them(forces):
    if cvode.version() is None:
        pytest.skip("gcc or SUNDIALS 6 (libsundials-dev) is not installed")
    found = cvode.largest_forces(SCENE, LAW, DURATION, 1e-9)
    assert found == pytest.approx(forces, rel=1e-6)


def test_lsoda_in_compiled_code_finds_them(forces):
    pytest.importorskip("numbalsoda")
    found = compiled_lsoda.largest_forces(SCENE, LAW, DURATION, 1e-9)
    assert found == pytest.approx(forces, rel=1e-5)


def test_scipy_finds_them(forces):
    found = odes.largest_forces("LSODA", SCENE, LAW, DURATION, 1e-7)
    assert found == pytest.approx(forces, rel=1e-5)


def test_exudyn_comes_near_them(forces):
    """Its force is that at the ends of steps; after 12 ms there are no impacts."""
    if find_spec("exudyn") is None:
        pytest.skip("exudyn is not installed")
    own = simulate(SCENE, duration=DURATION, outputs=3000)
    late = own.normal_force[own.time > 0.012].max()
    found = multibody.largest_forces(SCENE, DURATION, 4e-6, 0.012)
    assert found == pytest.approx([late, forces[1]], rel=0.02)


def test_a_run_of_the_chart_has_the_errors_of_both_forces(monkeypatch):
    monkeypatch.setattr(second, "finest", lambda: np.array([200.0, 100.0]))
    forces = np.array([202.0, 95.0])
    run = second.run("any", "coarse", lambda: forces, program="other")
    row = second.row_of(run, np.ones(3), run.call())
    assert (row["chart"], row["program"], row["repeats"]) == ("second", "other", 3)
    assert row["largest_error"] == pytest.approx(0.01)
    assert row["first_impact_error"] == pytest.approx(0.05)
