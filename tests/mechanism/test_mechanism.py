"""The scene, the ideal mechanism, and rigid links with clearance, against independent numbers."""

from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd
import pytest
from helpers.laws import packed
from helpers.scenes import random_scenes
from helpers.with_hertz import simulate
from scipy.integrate import solve_ivp

from study import dataset, mechanism, paths
from study.contact import LAWS
from study.contact.forces import DAMPINGS
from study.mechanism import MechanismError, Scene, compare, paper_scene, rigid, stepping
from study.mechanism.response import EVENTS
from study.mechanism.rigid import ContactState

PAPER = paper_scene()
HERTZ = packed("hertz", PAPER.ball_radius, PAPER.socket_radius, PAPER.composite_modulus)
LOSSLESS = PAPER.replace(restitution=1.0, friction=0.0)
KNOWN = pd.read_csv(paths.DATA / "published/mechanism.csv").set_index(["model", "quantity"]).value


def test_scene_is_the_papers():
    stated = dataset.published().to_dict()
    s = PAPER
    for (table, row, quantity), value in {
        ("Table 3", "crank", "length_m"): s.crank_length,
        ("Table 3", "crank", "mass_kg"): s.crank_mass,
        ("Table 3", "coupler", "length_m"): s.coupler_length,
        ("Table 3", "coupler", "mass_kg"): s.coupler_mass,
        ("Table 3", "slider", "mass_kg"): s.slider_mass,
        ("Table 3", "joint", "clearance_m"): s.clearance,
        ("Table 4", "material", "youngs_modulus_GPa"): 1e-9 * s.youngs_modulus,
        ("Table 4", "material", "poisson"): s.poisson,
        ("Table 4", "joint", "restitution"): s.restitution,
        ("Table 4", "joint", "friction"): s.friction,
        ("Table 4", "joint", "v0_m_per_s"): s.slow_speed,
        ("Table 4", "joint", "v1_m_per_s"): s.full_speed,
        ("Table 4", "drive", "moment_Nm"): s.driving_moment,
    }.items():
        assert value == pytest.approx(stated.pop((table, row, quantity)), rel=1e-12)
    assert not [key for key in stated if key[0] in ("Table 3", "Table 4")]


@pytest.mark.parametrize("time", [0.02, 0.1])
def test_ideal_mechanism_is_known_to_1e_9(time):
    response = simulate(joint="ideal", duration=0.1, outputs=500)
    last = response.motion.iloc[round(5000 * time)]
    columns = {
        "theta": "crank_angle",
        "x_slider": "slider_position",
        "v_slider": "slider_velocity",
        "a_slider": "slider_acceleration",
    }
    for quantity, column in columns.items():
        known = KNOWN["ideal", f"{quantity}({time:g} s)"]
        assert last[column] == pytest.approx(known, rel=1e-9)
    assert response.energy_error < 1e-11


def test_ideal_joint_force_moves_slider_and_coupler():
    scene = PAPER.replace(gravity=9.81, coupler_inertia=4e-4)
    r = simulate(scene, joint="ideal", duration=0.05, outputs=2000)
    assert r.force_x == pytest.approx(scene.slider_mass * r.slider_acceleration, rel=1e-12)
    # the coupler's centre and its turning, by differences of the simulated motion
    centre = [
        r.slider_position - 0.06 * np.cos(r.coupler_angle),
        -0.06 * np.sin(r.coupler_angle),
    ]
    ax, ay, turning = (
        np.gradient(np.gradient(q, r.time), r.time) for q in (*centre, r.coupler_angle)
    )
    fx, fy = scene.coupler_mass * ax + r.force_x, scene.coupler_mass * (ay + 9.81) + r.force_y
    arm = 0.06 * np.cos(r.coupler_angle), 0.06 * np.sin(r.coupler_angle)
    moment = -arm[0] * fy + arm[1] * fx - (arm[0] * r.force_y - arm[1] * r.force_x)
    inside = slice(20, -20)
    assert moment[inside] == pytest.approx(4e-4 * turning[inside], abs=2e-3)
    assert np.abs(4e-4 * turning[inside]).max() > 0.1


@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.9])
@pytest.mark.parametrize("law", ["stiffened_hertz", "winkler"])
def test_a_scene_delivers_the_restitution_asked_for(restitution, law):
    # a moment that hardly acts in the short time of the impact
    scene = Scene(restitution=restitution, driving_moment=1e-5, friction=0.0)
    response = mechanism.simulate(scene, law=law, duration=0.6, outputs=2)
    first = response.impacts.iloc[0]
    assert first.separation_speed / first.approach_speed == pytest.approx(restitution, abs=1e-3)
    assert response.restitution == response.delivered_restitution == restitution
    paper = mechanism.simulate(paper_scene(restitution=restitution), law=law, duration=1e-3)
    assert paper.restitution == restitution
    given = {0.3: 0.6842, 0.5: 0.7252, 0.9: 0.9132}[restitution]
    assert paper.delivered_restitution == pytest.approx(given, abs=1e-4)


def test_the_papers_scene_differs_in_its_damping_alone():
    changed = {"clearance": 1e-4, "restitution": 0.8}
    assert paper_scene(**changed) == Scene(**changed, damping="lankarani-nikravesh")
    assert paper_scene(damping="flores").damping == "flores"
    assert paper_scene(restitution=0.0).delivered_restitution > 0.6


def test_clearance_with_hertz_is_known():
    response = simulate(law="hertz")
    first = response.impacts.iloc[0]
    assert first.time == pytest.approx(KNOWN["clearance", "first impact time"], rel=1e-8)
    speed = KNOWN["clearance", "first impact approach speed"]
    assert first.approach_speed == pytest.approx(speed, rel=1e-7)
    assert first.peak_force == pytest.approx(
        KNOWN["clearance", "first impact peak force"], rel=1e-5
    )
    assert len(response.impacts) == 9
    x = KNOWN["clearance", "x_slider(0.1 s)"]
    assert response.slider_position[-1] == pytest.approx(x, abs=1e-11)
    assert response.energy_error < 1e-10
    assert response.impacts.separation_speed.isna().tolist() == [False] * 8 + [True]


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-10, 1e-12])
def test_any_tolerance_finds_nine_impacts(tolerance):
    response = simulate(tolerance=tolerance)
    assert len(response.impacts) == len(simulate(tolerance=tolerance, outputs=1).impacts) == 9
    x = KNOWN["clearance", "x_slider(0.1 s)"]
    assert abs(response.slider_position[-1] - x) < 1e-7 * tolerance**0.5 + 2e-12


def test_accuracy_follows_the_tolerance():
    reference = simulate(duration=0.3, outputs=3000, tolerance=1e-11)
    for tolerance, bound in ((1e-5, 2e-5), (1e-7, 3e-7), (1e-9, 3e-9)):
        response = simulate(duration=0.3, outputs=3000, tolerance=tolerance)
        assert compare.motion_nrms(reference, response, "slider_acceleration") < bound


def test_energy_is_kept_without_losses():
    response = simulate(LOSSLESS, duration=0.1)
    assert len(response.impacts) > 64  # the table of impacts grows
    assert (np.diff(response.impacts.time) > 0).all()
    assert response.energy_error < 1e-8
    assert (response.lost_damping == 0).all()
    assert (response.lost_friction == 0).all()


@pytest.mark.parametrize("damping", DAMPINGS)
@pytest.mark.parametrize("law", LAWS)
def test_energy_balance_closes_with_losses(law, damping):
    scene = PAPER.replace(damping=damping, gravity=9.81)
    response = simulate(scene, law=law, duration=0.03, outputs=300)
    assert response.energy_error < 1e-8
    assert response.lost_damping[-1] > 0
    assert (np.diff(response.lost_friction) >= -1e-15).all()


def test_impacts_table_balances_each_impact():
    response = simulate(duration=0.0095, outputs=200)
    ended = response.impacts.dropna()
    assert len(ended) == 6
    lost = response.lost_damping[-1] + response.lost_friction[-1]
    assert response.impacts.lost.sum() == pytest.approx(lost, rel=1e-12)


@pytest.mark.parametrize("model", ["rigid", "particles", "beams"])
def test_motion_has_rows_at_start_peak_and_end_of_each_impact(model):
    response = simulate(model=model, duration=0.006, outputs=20)
    impacts, motion = response.impacts, response.motion
    assert motion.time.is_monotonic_increasing
    assert np.array_equal(
        motion[motion.event == ""].drop(columns="event"), pd.DataFrame(response.rows)
    )
    start, peak, end = (motion[motion.event == kind] for kind in EVENTS)
    step = {"rigid": 1e-12, "particles": 1e-6, "beams": 1e-6}[model]
    ended = impacts.dropna()
    assert start.time.to_numpy() == pytest.approx(impacts.time, abs=step)
    assert end.time.to_numpy() == pytest.approx(ended.time + ended.duration, abs=step)
    assert peak.normal_force.tolist() == impacts.peak_force.tolist()
    assert peak.normal_force.max() > 1.3 * response.normal_force.max()
    inside = (peak.time.to_numpy() > start.time) & (peak.time.to_numpy()[:2] < end.time[:2]).all()
    assert inside.all()
    pull = motion.force_x / PAPER.slider_mass
    assert motion.slider_acceleration.to_numpy() == pytest.approx(pull, rel=1e-9, abs=1e-9)
    rest = motion.work - motion.kinetic - motion.elastic
    rest -= motion.lost_damping + motion.lost_friction
    assert np.ptp(rest) < (1e-9 if model == "rigid" else 1e-2) * motion.kinetic.max()


def test_peaks_between_outputs_are_those_of_a_fine_simulation():
    response = simulate(duration=0.0019, outputs=10)
    coarse = response.motion.query("event == 'peak'").iloc[0]
    fine = simulate(duration=0.0019, outputs=100_000).motion.query("event == ''")
    highest = fine.loc[fine.normal_force.idxmax()]
    assert coarse.time == pytest.approx(highest.time, abs=2e-8)
    assert response.impacts.peak_depth[0] == pytest.approx(fine.depth.max(), rel=1e-5)
    for column in ("slider_acceleration", "normal_force", "depth", "crank_acceleration"):
        at_peak = np.interp(coarse.time, fine.time, fine[column])
        assert coarse[column] == pytest.approx(at_peak, rel=1e-6)


def test_a_contact_is_sustained_if_ten_times_as_long_as_a_free_impact():
    impacts = simulate().impacts
    assert impacts.kind.tolist() == ["impact"] * 8 + ["sustained"]
    begun = impacts.time[8] + 2 * impacts.free_duration[8]  # the same contact, a moment after
    assert simulate(duration=begun).impacts.kind.tolist() == ["impact"] * 9


def test_free_duration_is_that_of_hertz():
    scene = LOSSLESS.replace(driving_moment=1e-3)
    first = simulate(scene, duration=0.1, outputs=10).impacts.iloc[0]
    hertz = 2.943275  # T v / depth, Johnson, Contact Mechanics, Eq. 11.24
    assert first.free_duration == pytest.approx(
        hertz * first.peak_depth / first.approach_speed, rel=1e-3
    )
    assert first.duration == pytest.approx(first.free_duration, rel=1e-2)


@pytest.mark.parametrize("drive", [{}, {"crank_speed": 11.0}])
def test_jacobian_is_the_derivative(drive):
    p = PAPER.replace(gravity=9.81, **drive).constants()
    cases = [
        (
            np.array([0.7, 1.3e-5, -2e-5, 11.0, 0.03, -0.05, 0, 0]),
            ContactState(False, 0, 1.0),
        ),
        (np.array([0.7, 8e-7, 2.1, 11.0, 0.02, 900.0, 0, 0]), ContactState(True, 1, 0.06)),
        (
            np.array([4.0, 8e-7, -0.4, -30.0, -0.02, -900.0, 0, 0]),
            ContactState(True, -2, 0.06),
        ),
    ]
    for y, contact_state in cases:
        k = np.zeros((3, 6))
        motion = rigid.motion(y, contact_state, p, HERTZ)
        rigid.derive(y, contact_state, p, motion, k)
        for j in range(6):
            h = 1e-6 * max(abs(y[j]), 1e-5)
            ends = []
            for sign in (1, -1):
                moved = y.copy()
                moved[j] += sign * h
                ends.append(rigid.motion(moved, contact_state, p, HERTZ).accelerations)
            by_difference = np.subtract(*ends) / (2 * h)
            size = np.abs(k).max(axis=1) * 1e-7 + np.abs(motion.accelerations) * 1e-8 / h
            assert (np.abs(k[:, j] - by_difference) <= size + 1e-4 * np.abs(k[:, j])).all()


@pytest.mark.parametrize(
    "start",
    [
        {},
        {"crank_speed": 40.0, "initial_crank_angle": 0.5},
        {"initial_crank_angle": 2.0, "initial_crank_speed": -30.0},
    ],
)
def test_rigid_links_agree_with_another_integrator(start):
    """Other coordinates (theta, phi, x), SciPy's integrator, sections between located events."""
    s, r1 = PAPER.replace(**start), PAPER.ball_radius
    i1, i2 = s.inertias
    l1, l2, m2 = s.crank_length, s.coupler_length, s.coupler_mass
    a11, a22 = i1 + s.crank_mass * l1**2 / 4 + m2 * l1**2, i2 + m2 * l2**2 / 4

    def gap(y):
        e = l1 * np.cos(y[0]) + l2 * np.cos(y[1]) - y[2], l1 * np.sin(y[0]) + l2 * np.sin(y[1])
        n = np.array(e) / max(np.hypot(*e), 1e-300)
        w = np.array(
            [
                -l1 * np.sin(y[0]) * y[3] - l2 * np.sin(y[1]) * y[4] - y[5],
                l1 * np.cos(y[0]) * y[3] + l2 * np.cos(y[1]) * y[4],
            ]
        )
        return np.hypot(*e) - s.clearance, n, w

    def slopes(_, y, approach):
        depth, n, w = gap(y)
        force, moment = np.zeros(2), 0.0
        if approach and depth > 0:
            elastic = HERTZ[2] * (depth / s.clearance) ** 1.5
            normal = elastic * (1 + s.damping_factor * (w @ n) / approach)
            sliding = w @ (-n[1], n[0]) + r1 * y[4]
            share = np.clip((abs(sliding) - s.slow_speed) / (s.full_speed - s.slow_speed), 0, 1)
            tangential = -s.friction * normal * share * np.sign(sliding)
            force = -normal * n + tangential * np.array([-n[1], n[0]])
            moment = r1 * tangential
        a12, d = m2 * l1 * l2 / 2, y[0] - y[1]
        q1 = s.driving_moment - a12 * np.sin(d) * y[4] ** 2
        q1 += l1 * (np.cos(y[0]) * force[1] - np.sin(y[0]) * force[0])
        q2 = a12 * np.sin(d) * y[3] ** 2 + moment
        q2 += l2 * (np.cos(y[1]) * force[1] - np.sin(y[1]) * force[0])
        mass = [[a11, a12 * np.cos(d)], [a12 * np.cos(d), a22]]
        if s.crank_speed is not None:
            return [*y[3:], 0.0, q2 / a22, -force[0] / s.slider_mass]
        return [*y[3:], *np.linalg.solve(mass, [q1, q2]), -force[0] / s.slider_mass]

    def meet(_, y, approach):
        return gap(y)[0]

    meet.terminal = True
    theta, omega = s.initial_crank_angle, s.starting_speed
    phi = -np.arcsin(l1 / l2 * np.sin(theta))
    psi = -l1 * np.cos(theta) * omega / (l2 * np.cos(phi))
    speed = -l1 * np.sin(theta) * omega - l2 * np.sin(phi) * psi
    x = l1 * np.cos(theta) + l2 * np.cos(phi)
    y, t, approach, times = np.array([theta, phi, x, omega, psi, speed]), 0.0, 0.0, []
    for _ in range(4):  # two impacts: begin, end, begin, end
        meet.direction = -1 if approach else 1
        span = (t, 0.006)
        options = {"rtol": 1e-11, "atol": 1e-16, "max_step": 2e-6 if approach else np.inf}
        part = solve_ivp(slopes, span, y, "DOP853", events=meet, args=(approach,), **options)
        t, y = part.t_events[0][0], part.y_events[0][0]
        times.append(t)
        _, n, w = gap(y)
        approach = 0.0 if approach else w @ n
        y = y + np.array(slopes(t, y, approach)) * 1e-12  # off the event
        t += 1e-12
    mine = simulate(s, duration=0.006).impacts
    ends = np.column_stack([mine.time, mine.time + mine.duration]).ravel()
    assert ends[:4] == pytest.approx(times, rel=1e-8)


def test_a_coupler_that_falls_from_the_horizontal_is_held_by_a_quarter_of_its_weight():
    for joint in ("ideal", "clearance"):
        held = PAPER.replace(crank_speed=0.0, gravity=9.81)  # a crank that stays
        first = simulate(held, joint=joint, duration=1e-5, outputs=1).rows[0]
        weight = (0.5 if joint == "ideal" else 0.25) * 0.21 * 9.81  # the slide holds its end
        assert first["crank_joint_force_y"] == pytest.approx(weight, rel=1e-9)


def test_effective_mass_at_constant_crank_speed_is_that_of_slider_and_coupler():
    p = PAPER.replace(crank_speed=1.0).constants()
    directions = (1.0, 0.0), (0.0, 1.0)  # along the slide, and across it: a rod about its end
    found = [rigid.inverse_effective_mass(0.0, 0.0, *d, 0.0, p) for d in directions]
    assert found == pytest.approx([1 / 0.14, 3 / 0.21], rel=1e-12)


def test_slow_scene_down_to_approach_speeds_of_a_nanometre_per_second():
    scene = PAPER.replace(driving_moment=1e-16)
    response = simulate(scene, duration=1e6, outputs=500)
    assert response.impacts.approach_speed[0] < 1e-9
    assert len(response.impacts) > 3
    assert response.energy_error < 1e-6


def test_results_do_not_depend_on_the_outputs():
    few, many = simulate(duration=0.02, outputs=8), simulate(duration=0.02, outputs=1024)
    assert (few.rows == many.rows[::128]).all()
    pd.testing.assert_frame_equal(few.impacts, many.impacts)


def test_interruption_leaves_what_was_computed():
    told = []

    def stop(time):
        told.append(time)
        if time > 0.02:
            raise KeyboardInterrupt

    response = simulate(duration=0.1, outputs=1000, progress=stop)
    assert not response.complete
    assert response.time[-1] == told[-1]
    whole = simulate(duration=0.1, outputs=1000)
    assert (response.rows == whole.rows[: len(response.rows)]).all()
    assert response.event_rows["time"].max() <= response.time[-1]


def test_normalised_rms_by_hand():
    reference, values = [5.0, 7.0, 9.0, 3.0], [5.0, 8.0, 9.0, 2.0]  # squared: 2, and 4 + 16 + 4
    assert compare.normalised_rms(reference, values) == pytest.approx(np.sqrt(2 / 24))
    assert compare.normalised_rms(reference, reference) == 0
    ideal = simulate(joint="ideal", duration=0.02, outputs=20)
    clearance = simulate(duration=0.02, outputs=20)
    assert compare.motion_nrms(ideal, clearance, "crank_speed") == compare.normalised_rms(
        ideal.crank_speed, clearance.crank_speed
    )


def test_lead_and_last_separation():
    ideal, clearance = simulate(joint="ideal"), simulate()
    lead = compare.phase_lead(clearance, ideal)
    assert lead[0] == 0
    k = 800
    shifted = np.interp(ideal.time[k] + lead[k], ideal.time, ideal.crank_angle)
    assert shifted == pytest.approx(clearance.crank_angle[k], abs=2e-4)
    ends = clearance.impacts.time + clearance.impacts.duration
    assert clearance.last_separation == ends[7]


def test_a_response_tells_how_far_it_can_be_trusted():
    def agreement(*scene, **options):
        run = partial(simulate, *scene, **options)
        return compare.second_run(run(), run)

    assert agreement(PAPER, model="beams", duration=1e-4) is None
    assert agreement(PAPER, joint="ideal", duration=1e-3) is None
    calm = agreement(PAPER, tolerance=1e-8)
    assert (calm.until, calm.lasts, calm.impacts) == (0.1, True, (9, 9))
    assert calm.largest_distance < 1e-8
    assert calm.force_difference < 1e-6
    assert agreement(PAPER, tolerance=1e-12, duration=0.01).lasts  # beside a rougher one
    wild = [agreement(LOSSLESS, tolerance=t) for t in (1e-6, 1e-8, 1e-10)]
    assert not any(found.lasts for found in wild)
    until = [found.until for found in wild]
    assert until == sorted(until)  # errors grow exponentially: each digit buys the same time
    assert 0.02 < until[0] < until[-1] < 0.09
    # chaos, not the steps: a start moved by 1e-10 rad leads away as soon
    moved = LOSSLESS.replace(initial_crank_angle=1e-10)
    runs = [simulate(scene, tolerance=1e-12) for scene in (LOSSLESS, moved)]
    apart = compare.agreement(*runs)
    assert 0.02 < apart.until < 0.09


def test_agreement_finds_where_motions_part():
    first = simulate(PAPER, duration=0.01, outputs=100)
    rows = first.rows.copy()
    rows["eccentricity_y"][60:] += 0.02 * PAPER.clearance
    parted = compare.agreement(first, replace(first, rows=rows))
    assert (parted.until, parted.lasts) == (first.time[59], False)
    assert parted.largest_distance == parted.force_difference == 0
    rows["eccentricity_y"][60:] -= 0.015 * PAPER.clearance
    same = compare.agreement(first, replace(first, rows=rows))
    assert same.lasts
    assert same.largest_distance == pytest.approx(0.005)


@pytest.mark.parametrize(("duration", "difference"), [(0.9e-5, 0.5), (1.1e-5, 0.0)])
def test_agreement_compares_only_impacts_that_have_ended(duration, difference):
    first = simulate(PAPER, duration=0.01, outputs=100)
    rows, impact = first.rows.copy(), first.impact_rows[:1].copy()
    rows["eccentricity_y"][60:] += 0.02 * PAPER.clearance
    impact["time"], impact["duration"] = first.time[59] - 1e-5, duration
    harder = impact.copy()
    harder["peak_force"] *= 2
    runs = replace(first, impact_rows=impact), replace(first, rows=rows, impact_rows=harder)
    assert compare.agreement(*runs).force_difference == pytest.approx(difference)


every_model = pytest.mark.parametrize("model", ["rigid", "particles", "beams"])


@pytest.mark.parametrize(
    ("model", "tolerance", "count"),
    [
        ("rigid", 1e-3, 100),
        ("rigid", 1e-7, 100),
        pytest.param("particles", None, 20, marks=pytest.mark.slow),
        pytest.param("beams", None, 20, marks=pytest.mark.slow),
    ],
)
def test_random_scenes_end_well(model, tolerance, count):
    ended, flexible = 0, model != "rigid"
    options = {"model": model, "tolerance": tolerance, "outputs": 10}
    if flexible:
        options |= {"elements": (2, 4), "duration": 0.02}
    for number, scene in enumerate(random_scenes(count)):
        law = "hertz" if flexible else list(LAWS)[number % len(LAWS)]
        if flexible:  # Newton's method may fail beyond a friction of 0.5
            scene = scene.replace(friction=0.5 * scene.friction)
        try:
            response = simulate(scene, law=law, **options)
        except MechanismError as error:
            assert "depth must stay" in str(error)
            continue
        ended += 1
        assert np.isfinite(response.motion.drop(columns="event").to_numpy()).all()
        assert (response.impacts.approach_speed > 0).all()
        assert (response.impacts.duration > 0).all()
        assert (np.diff(response.impacts.time) > 0).all()
        assert (response.impacts.peak_depth <= scene.clearance).all()
        assert response.energy_error < (1e-2 if flexible else max(1e-9, 100 * tolerance))
    assert ended > 0.75 * count


@every_model
def test_mirrored_drive_gives_the_mirrored_motion(model):
    scene = PAPER.replace(initial_eccentricity=(1e-5, -3e-5))
    other = scene.replace(initial_eccentricity=(1e-5, 3e-5), driving_moment=-0.5)
    options = {"model": model, "duration": 0.005, "outputs": 50}
    up, down = (simulate(of, **options) for of in (scene, other))
    assert down.slider_position == pytest.approx(up.slider_position, abs=1e-9)
    assert down.impacts.time[0] == pytest.approx(up.impacts.time[0], rel=1e-6)
    assert down.crank_angle == pytest.approx(-up.crank_angle, abs=1e-7)


@every_model
def test_an_interruption_is_noticed_between_two_times_of_output(model, monkeypatch):
    told = []

    def stop(time):
        told.append(time)
        if len(told) == 3:
            raise KeyboardInterrupt

    monkeypatch.setattr(stepping, "PATIENCE", 0.0)  # the loops return after each step
    duration = 0.01 if model == "rigid" else 1e-4
    response = simulate(model=model, duration=duration, outputs=1, progress=stop)
    assert (response.complete, told, len(response.rows)) == (False, [0.0] * 3, 1)


@every_model
@pytest.mark.parametrize("joint", ["ideal", "clearance"])
def test_no_drive_no_motion(model, joint):
    scene = PAPER.replace(driving_moment=0.0)
    response = simulate(scene, model=model, joint=joint, duration=0.001, outputs=10)
    assert np.abs(response.crank_angle).max() < 1e-15
    assert response.impacts.empty
    assert response.kinetic.max() < 1e-20  # rounding of the places, for flexible links
    assert (compare.phase_lead(response, response) == 0).all()


@every_model
def test_energy_counts_from_the_start(model):
    scene = PAPER.replace(gravity=9.81, initial_eccentricity=(0.0, -4.9e-5))
    response = simulate(scene, model=model, duration=0.01)
    assert response.work[0] == 0
    assert response.energy_error < (1e-8 if model == "rigid" else 2e-5)
