"""The energy balance as a test of the contact force, and contacts that no integrator may lose."""

import warnings

import numpy as np
import pandas as pd
import pytest
from helpers.with_hertz import simulate

from study import paths
from study.measure import explicit
from study.mechanism import EnergyWarning, paper_scene, stable_step
from study.mechanism.response import CONTACT_ENERGY_LIMIT

PAPER, TWO = paper_scene(), {"model": "particles", "elements": (2, 4)}
AT_REST = {"driving_moment": 0.0, "initial_crank_angle": 0.7}


@pytest.mark.parametrize("joint", ["clearance", "ideal"])
@pytest.mark.parametrize("model", ["rigid", "particles", "beams"])
def test_a_mechanism_at_rest_has_no_energy_error(model, joint):
    scene = PAPER.replace(**AT_REST)
    response = simulate(scene, model=model, joint=joint, law="steuermann", duration=3e-3)
    assert response.energy_error < 1e-6  # rounding, over the floor of the energy that moved
    assert response.contact_energy_error == 0


def test_errors_are_residuals_over_the_energies_that_they_name():
    scene = PAPER.replace(initial_crank_speed=40.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", EnergyWarning)
        r = simulate(scene, method="lagged", step=1e-6, duration=5e-3, outputs=500, **TWO)
    rest = r.work - r.kinetic - r.elastic - r.lost_damping - r.lost_friction
    residual = np.abs(rest - rest[0]).max()
    moved = max(np.ptp(r.work), np.abs(r.kinetic - r.kinetic[0]).max())
    assert r.energy_error == pytest.approx(residual / moved, rel=1e-9)
    # the energy of an impact that stores all of it is the work of the law up to its depth
    depths = [np.linspace(0, deepest, 2001) for deepest in r.impacts.peak_depth]
    stored = sum(np.trapezoid([r.law.force(d) if d else 0 for d in x], x) for x in depths)
    assert r.contact_energy_error == pytest.approx(residual / stored, rel=1e-3)


def test_the_energy_lost_by_particles_follows_the_square_of_the_step():
    limit, errors = stable_step(PAPER, (4, 8)), []
    for share in (0.2, 0.1):
        r = simulate(model="particles", step=share * limit, duration=3e-3, outputs=300)
        errors.append(r.contact_energy_error)
    assert errors[1] < errors[0] / 3


def test_simulate_warns_of_a_wrong_contact_force():
    options = {"method": "unguarded", "step": 3.5e-6, "duration": 0.12, "outputs": 1200}
    with pytest.warns(EnergyWarning, match="the contact force may be wrong by more than 10 %"):
        wrong = simulate(**options, **TWO)
    with warnings.catch_warnings():
        warnings.simplefilter("error", EnergyWarning)
        right = simulate(duration=0.12, **TWO)
    assert wrong.largest_force > 2 * right.largest_force
    assert wrong.slider_position[-1] == pytest.approx(right.slider_position[-1], rel=1e-2)
    assert right.contact_energy_error < CONTACT_ENERGY_LIMIT / 10 < wrong.contact_energy_error


def test_the_threshold_is_that_of_the_calibration_runs():
    runs = pd.read_csv(paths.FIGURES / "energy_test.csv").query("set == 'calibration'")
    right = runs[runs.force_error <= 0.1].contact_energy_error.max()
    assert CONTACT_ENERGY_LIMIT - 0.05 < right <= CONTACT_ENERGY_LIMIT
    assert runs[runs.force_error > 0.1].contact_energy_error.min() > CONTACT_ENERGY_LIMIT


GRAZE = 0.13356  # m, the slider after 0.2 s; without the contacts that begin slowly it is at 0.162


@pytest.mark.parametrize(
    "options",
    [{"tolerance": 1e-2}, {"tolerance": 1e-8}, TWO, {"model": "beams", "elements": (2, 4)}],
)
def test_no_model_loses_a_grazing_contact(options):
    response = simulate(duration=0.2, outputs=200, **options)
    assert response.slider_position[-1] == pytest.approx(GRAZE, abs=1e-5)


@pytest.mark.parametrize("scheme", explicit.SCHEMES)
def test_no_explicit_scheme_loses_a_grazing_contact(scheme):
    rows = explicit.integrate(PAPER, explicit.packed(PAPER, "hertz"), 0.2, 200, 1e-6, scheme)
    assert rows["slider_position"][-1] == pytest.approx(GRAZE, abs=1e-4)


@pytest.mark.parametrize(("scheme", "order"), [("symplectic Euler", 1), ("velocity Verlet", 2)])
def test_the_energy_balance_of_explicit_steps_closes(scheme, order):
    residuals = []
    for step in (1e-6, 5e-7):
        law = explicit.packed(PAPER, "hertz")
        rows = explicit.integrate(PAPER, law, 5e-3, 500, step, scheme)
        lost = rows["lost_damping"] + rows["lost_friction"]
        rest = rows["work"] - rows["kinetic"] - rows["elastic"] - lost
        residuals.append(np.abs(rest - rest[0]).max() / lost[-1])
    assert residuals[1] < 0.03
    assert np.log2(residuals[0] / residuals[1]) > order - 0.5
