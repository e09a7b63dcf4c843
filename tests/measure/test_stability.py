"""Where methods fail: predicted and observed limits, and how the software meets each of them."""

import numpy as np
import pandas as pd
import pytest
from helpers.impacts import free_impact
from helpers.with_hertz import simulate

from study import contact, paths
from study.contact.forces import DAMPINGS, damping_factor, delivered_restitution
from study.joint import Joint, Material, reference_joint
from study.measure import explicit, stability
from study.mechanism import MechanismError, paper_scene, particles, rigid, stepping
from study.mechanism.events import stepper
from study.mechanism.frame import Frame
from study.mechanism.response import OUTPUT
from study.mechanism.rigid import ContactState

PAPER = paper_scene()
SLIPPERY = PAPER.replace(friction=0.0)
SETTLED = 0.03  # s


@pytest.fixture(scope="module")
def pressed():
    """Rigid links pressed steadily: their state, and the contact as an oscillator."""
    state = stability.sustained_contact(SLIPPERY, "hertz", SETTLED)
    return state, stability.oscillator(SLIPPERY, "hertz", state)


# Explicit steps


def slopes_at(scene, y, regime, approach):
    """Derivatives of the accelerations of rigid links by their state, in contact."""
    p, slopes, piece = scene.constants(), np.zeros((3, 6)), ContactState(True, regime, approach)
    motion = rigid.motion(y, piece, p, explicit.packed(scene, "hertz"))
    rigid.derive(y, piece, p, motion, slopes)
    return slopes


def test_oscillator_is_the_linearised_equation(pressed):
    state, contact_ = pressed
    y = np.array([state[0], contact_["depth"], np.arctan2(state[2], state[1]), state[3], 0, 0])
    slopes = slopes_at(SLIPPERY, y, 0, 1e-4)
    rate = SLIPPERY.damping_factor * contact_["force"] / (contact_["mass"] * 1e-4)
    assert np.hypot(state[1], state[2]) > SLIPPERY.clearance
    assert slopes[1, 1] == pytest.approx(-(contact_["frequency"] ** 2), rel=1e-4)
    assert slopes[1, 4] == pytest.approx(-rate, rel=1e-4)


@pytest.mark.parametrize(
    ("scheme", "rate", "expected"),
    [
        *((scheme, 0.0, 2.0) for scheme in explicit.SCHEMES[:2]),
        ("RK4", 0.0, 2 * 2**0.5),
        ("symplectic Euler", 3.0, (13**0.5 - 3.0)),  # (h w)^2 + 2 h c/m = 4
        ("symplectic Euler", 1e4, 2e-4),
        ("velocity Verlet", 1e4, 2e-4),
        ("RK4", 1e4, 2.7853e-4),
    ],
)
def test_limits_of_the_linear_oscillator(scheme, rate, expected):
    assert stability.step_limit(scheme, 1.0, rate) == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("scheme", explicit.SCHEMES)
@pytest.mark.parametrize(("law", "moment"), [("hertz", 0.5), ("hyperbolic_winkler", 0.05)])
def test_stiffness_limits_the_step_as_predicted(law, moment, scheme):
    scene = SLIPPERY.replace(driving_moment=moment)
    state = stability.sustained_contact(scene, law, SETTLED * (0.5 / moment) ** 0.5)
    limit = stability.step_limit(scheme, stability.oscillator(scene, law, state)["frequency"])
    seen = stability.observed_step(scene.replace(restitution=1.0), law, state, scheme)
    assert seen == pytest.approx(limit, rel=0.03)


@pytest.mark.parametrize("approach", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("scheme", explicit.SCHEMES)
def test_damping_limits_the_step_as_predicted(pressed, scheme, approach):
    state, contact_ = pressed
    rate = SLIPPERY.damping_factor * contact_["force"] / (contact_["mass"] * approach)
    limit = stability.step_limit(scheme, contact_["frequency"], rate)
    seen = stability.observed_step(SLIPPERY, "hertz", state, scheme, approach)
    assert seen == pytest.approx(limit, rel=0.16)


def test_an_explicit_run_that_leaves_the_clearance_says_so(pressed):
    state, _ = pressed
    numbers = explicit.packed(SLIPPERY, "hertz")
    with pytest.raises(MechanismError, match=r"depth must stay <= one clearance \(5e-05 m\)"):
        explicit.integrate(
            SLIPPERY, numbers, 0.02, 1000, 2e-5, "velocity Verlet", state, 1e-5, guarded=False
        )


@pytest.mark.parametrize("approach", [np.inf, 1e-5])
@pytest.mark.parametrize("scheme", explicit.SCHEMES)
def test_an_explicit_step_beyond_its_limit_is_refused(pressed, scheme, approach):
    state, contact_ = pressed
    numbers = explicit.packed(SLIPPERY, "hertz")
    rate = SLIPPERY.damping_factor * contact_["force"] / (contact_["mass"] * approach)
    limit = stability.step_limit(scheme, contact_["frequency"], rate)

    def run(step):
        outputs = round(20 * limit / step)
        duration = outputs * step
        explicit.integrate(SLIPPERY, numbers, duration, outputs, step, scheme, state, approach)

    run(0.6 * limit)
    with pytest.raises(MechanismError, match="the step must stay <= .* s, the .*stability"):
        run(1.05 * limit)


@pytest.mark.parametrize("band", [1e-3, 1e-4])
def test_friction_that_sticks_limits_the_step_as_predicted(band):
    scene = paper_scene(friction=3.0, slow_speed=0.0, full_speed=band)
    state = stability.sustained_contact(scene, "hertz", 0.8 * SETTLED)
    limit = 2 / stability.oscillator(scene, "hertz", state)["friction_rate"]
    elastic = scene.replace(restitution=1.0)
    seen = stability.observed_step(elastic, "hertz", state, "symplectic Euler")
    assert seen == pytest.approx(limit, rel=0.15)


def test_the_rate_of_friction_is_that_of_the_equations_of_motion():
    scene = paper_scene(friction=3.0, slow_speed=0.0, full_speed=1e-3, restitution=1.0)
    state = stability.sustained_contact(scene, "hertz", 0.8 * SETTLED)
    rate = stability.oscillator(scene, "hertz", state)["friction_rate"]
    angle, ex, ey = state[:3]
    still = np.array([angle, np.hypot(ex, ey) - scene.clearance, np.arctan2(ey, ex), 0, 0, 0])
    slopes = slopes_at(scene, still, 1, np.inf)
    assert rate == pytest.approx(np.abs(np.linalg.eigvals(slopes[:3, 3:])).max(), rel=1e-9)
    moving = np.array([*state[:3], 1.0, *(0.02 * state[1:3] / np.hypot(ex, ey))])
    assert stability.oscillator(scene, "hertz", moving)["friction_rate"] == rate


def test_links_limit_the_step_as_predicted():
    """In the results of notebook 19; y is rounded there."""
    numbers = pd.read_csv(paths.FIGURES / "stability_steps.csv").query("panel == 'b'")
    limits_of = numbers.pivot(index="x", columns="series", values="y")
    assert list(limits_of.index) == [1, 2, 4, 8, 16, 32]
    assert limits_of.observed.to_numpy() == pytest.approx(limits_of.frame.to_numpy(), rel=5e-3)
    assert limits_of.bending[4:].to_numpy() == pytest.approx(
        limits_of.frame[4:].to_numpy(), rel=0.02
    )
    for x in (4, 16):
        frame = 2 / Frame(PAPER, (x, 2 * x)).highest_frequency(PAPER.slider_mass, True)
        assert limits_of.frame[x] == pytest.approx(frame, rel=5e-3)


@pytest.mark.parametrize("joint", ["ideal", "clearance"])
def test_particles_take_no_step_that_is_too_long_and_unguarded_ones_end_in_an_error(joint):
    options = {"model": "particles", "joint": joint, "step": 1e-5, "duration": 0.01}
    with pytest.raises(ValueError, match="step must be <= 1.101e-06 s, the .*stability"):
        simulate(**options)
    with pytest.raises(MechanismError, match=r"must stay <= .* stopped at \S+ s .* 1e-05 s"):
        simulate(method="unguarded", **options)
    options["step"] = 1e-6
    lagged, unguarded = (simulate(method=m, **options) for m in ("lagged", "unguarded"))
    assert lagged.motion.equals(unguarded.motion)


# Damping


@pytest.mark.parametrize("rule", DAMPINGS)
@pytest.mark.parametrize("power", [1.5, 2.0])
@pytest.mark.parametrize("asked", [0.1, 0.5, 0.9])
def test_delivered_restitution_is_that_of_an_integrated_impact(rule, power, asked):
    factor = damping_factor(rule, asked)
    separation, tension = free_impact(factor, power=power)
    assert delivered_restitution(factor) == pytest.approx(separation, abs=1e-7)
    assert tension == 0
    if rule == "exact":
        assert separation == pytest.approx(asked, abs=1e-7)


def test_a_slow_contact_that_is_driven_apart_pulls_and_the_response_tells():
    assert free_impact(0.3, 1.0, depth=1.0, speed=0.0)[1] == 0
    assert free_impact(100, 1.0, depth=1.0, speed=0.0)[1] == pytest.approx(1, abs=0.01)

    def pulls(factor):
        return free_impact(factor, 10.0, 1.0, 0.0)[1] > 1e-9

    onset = stability.bisect(pulls, 0.05, 50, 20)
    assert onset == pytest.approx(1 / np.sqrt(2 * (0.4 + 10)), rel=0.03)  # undamped
    start = (-PAPER.clearance * (1 - 1e-8), 0.0)
    scene = PAPER.replace(initial_eccentricity=start)
    r = simulate(scene, model="beams", duration=0.003, outputs=3000)
    assert r.normal_force.min() < -0.5
    assert (r.tangential_force[r.normal_force < 0] == 0).all()
    assert r.energy_error < 1e-5


# Slow approach


def test_approach_speeds_go_with_the_root_of_the_moment_down_to_nothing():
    for moment in (1.0, 1e-6, 1e-15):
        scene = paper_scene(driving_moment=moment)
        r = simulate(scene, duration=0.02 / moment**0.5, outputs=20)
        assert r.impacts.approach_speed[0] == pytest.approx(0.0809780828 * moment**0.5, rel=1e-7)
        assert (r.impacts.approach_speed > 0).all()
        assert r.energy_error < 1e-9
    assert r.impacts.approach_speed.min() < 1e-14


@pytest.mark.parametrize("model", ["rigid", "particles", "beams"])
def test_a_ball_that_starts_almost_in_touch_rests_there(model):
    reference, speeds = simulate(duration=0.003, outputs=30), []
    for gap in (1e-6, 1e-10, 1e-13):
        scene = PAPER.replace(initial_eccentricity=(-PAPER.clearance * (1 - gap), 0.0))
        r = simulate(scene, model=model, duration=0.003, outputs=30)
        speeds.append(r.impacts.approach_speed[0])
        assert 0 < speeds[-1] < 1e-5
        assert r.impacts.peak_force.max() < 12
        assert r.energy_error < 1e-5
        assert r.slider_position[-1] == pytest.approx(reference.slider_position[-1], abs=1e-4)
    if model == "rigid":  # the speed goes with the gap to three quarters
        assert speeds[0] / speeds[1] == pytest.approx(1e4**0.75, rel=1e-3)


def test_a_gap_lost_in_rounding_is_refused():
    for share in (1 - 1e-16, 1 - 1e-14):
        with pytest.raises(ValueError, match="initial_eccentricity must be < 5e-05 m"):
            PAPER.replace(initial_eccentricity=(-PAPER.clearance * share, 0.0))
    near = PAPER.replace(initial_eccentricity=(-PAPER.clearance * (1 - 1e-13), 0.0))
    assert simulate(near, duration=1e-3).complete


def test_particles_meet_with_an_approach_speed_above_zero():
    generator = np.random.default_rng(1)
    for _ in range(2000):
        gap = -(10.0 ** generator.uniform(-30, -6)) * (generator.random() < 0.9)
        h = 10.0 ** generator.uniform(-9, -5)
        rate = (-gap + 10.0 ** generator.uniform(-30, -6)) / h  # ends in contact
        before = rate * generator.uniform(-3, 3)
        part, approach = particles._meet(gap, rate, before, h)
        assert approach > 0
        assert 0 <= part <= 1 + 1e-9


@pytest.mark.parametrize("scheme", explicit.SCHEMES)
def test_an_explicit_step_that_meets_while_leaving_is_not_damped(scheme):
    """A ball that turns back within the step that touches: no approach speed to divide by."""
    numbers, clearance = explicit.packed(SLIPPERY, "hertz"), SLIPPERY.clearance
    for rate in (0.0, -1e-12, -1e-6):
        start = np.array([0.5, clearance * (1 + 1e-7), 0.0, 0.0, rate, 0.0])
        rows = explicit.integrate(SLIPPERY, numbers, 2e-3, 200, 1e-6, scheme, start)
        pull, depth = rows["slider_acceleration"], rows["depth"]
        assert np.isfinite(pull).all()
        assert depth.max() < 0.01 * clearance
        assert np.abs(pull).max() < 300


# Friction


def test_friction_that_turns_into_a_jump_costs_steps_but_keeps_the_answer():
    steps, lost, rows = [], [], np.zeros(2, OUTPUT)
    rows["time"][1] = 0.1
    for band in (1e-4, 1e-6, 1e-9, 1e-13):
        scene = paper_scene(slow_speed=1e-4, full_speed=1e-4 + band)
        state, advance = stepper(scene, explicit.packed(scene, "hertz"), 0.1, 1e-8)
        advance(rows, *stepping.new_impacts(1000))
        steps.append(state.steps)
        lost.append(rows["lost_friction"][1])
    assert steps[0] < steps[-1] < 3 * steps[0]
    assert lost == pytest.approx([lost[-1]] * 4, rel=1e-4)
    assert lost[1:] == pytest.approx([lost[-1]] * 3, rel=1e-6)


# Chaos


def impact_times(scene, x, duration):
    moved = scene.replace(initial_eccentricity=(x, 0.0))
    return simulate(moved, duration=duration, outputs=2, tolerance=1e-12).impacts.time.to_numpy()


def test_runs_with_loss_can_be_repeated_and_those_without_cannot():
    calm = [impact_times(PAPER, x, 0.05) for x in (0.0, 1e-9)]
    assert calm[0] == pytest.approx(calm[1], abs=1e-7)
    lively = PAPER.replace(restitution=0.99)
    first, near, far = (impact_times(lively, x, 0.06)[:25] for x in (0.0, 1e-11, 1e-9))
    near, far = (np.maximum.accumulate(np.abs(times - first)) for times in (near, far))
    growing = far < 0.05 * np.diff(first, prepend=0.0).min()
    slopes = [
        np.polyfit(np.flatnonzero(growing), np.log(apart[growing]), 1)[0] for apart in (near, far)
    ]
    assert np.exp(slopes) == pytest.approx([1.9, 1.9], abs=0.3)


# Elements


def test_three_node_triangles_lock_and_six_node_ones_do_not():
    for poisson, least, most in ((0.3, 0.002, 0.02), (0.4999, 0.4, 0.7)):
        material = Material(poisson=poisson)
        joint = Joint.from_ratios(200, ball=material, socket=material)
        true = joint.solve(depth_star=0.1).force_star
        linear = joint.solve(depth_star=0.1, resolution=64, solver="linear")
        quadratic = joint.solve(depth_star=0.1, resolution=64, solver="quadratic")
        assert least < linear.force_star / true - 1 < most
        assert quadratic.force_star == pytest.approx(true, rel=0.006)
        assert quadratic.error_estimate > abs(quadratic.force_star / true - 1)
    assert linear.error_estimate > 0.1  # it warns, though of less than it misses


# The laws


def test_laws_that_extrapolate_beyond_one_clearance_are_this_far_off():
    true = reference_joint().solve(depth_star=1.2).force_star[0]
    errors = {name: contact.LAWS[name]()(1.2, 200) / true - 1 for name in contact.PAPER_LAWS}
    assert errors["hyperbolic_winkler"] == pytest.approx(0.17, abs=0.01)
    assert errors["winkler"] == pytest.approx(0.58, abs=0.02)
    assert all(-0.7 < errors[name] < -0.3 for name in ("hertz", "steuermann", "liu"))


@pytest.mark.parametrize(
    ("scheme", "order"), [("symplectic Euler", 1), ("velocity Verlet", 2), ("RK4", 4)]
)
def test_explicit_steps_have_their_order_before_the_first_impact(scheme, order):
    exact = simulate(PAPER, duration=1.6e-3, outputs=4, tolerance=1e-12).depth
    assert (exact < 0).all()  # the slider rests, the ball moves
    how = PAPER, explicit.packed(PAPER, "hertz"), 1.6e-3, 4
    found = [explicit.integrate(*how, step, scheme)["depth"] for step in (4e-4, 2e-4)]
    coarse, fine = (np.abs(values - exact)[1:].max() for values in found)
    assert np.log2(coarse / fine) > order - 0.4
