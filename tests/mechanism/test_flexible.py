"""Flexible links: particles and finite elements against beam theory, each other and rigid links."""

import numpy as np
import pytest
from helpers.beams import dense
from helpers.laws import packed
from helpers.with_hertz import simulate

from study.mechanism import (
    beams,
    compare,
    frame,
    paper_scene,
    stable_step,
    stepping,
)
from study.mechanism.frame import Frame

PAPER = paper_scene()
FLEXIBLE = ("particles", "beams")
TWO = {"elements": (2, 4)}
every_model = pytest.mark.parametrize("model", FLEXIBLE)


@pytest.mark.parametrize("elements", [2, 3, 8])
def test_particles_have_mass_and_inertia_of_their_link(elements):
    link = PAPER.replace(coupler_inertia=4e-4).link("coupler")
    masses, rotaries = frame.lump(link, elements)
    places = np.linspace(-0.06, 0.06, elements + 1)
    assert masses.sum() == pytest.approx(0.21, rel=1e-13)
    assert masses @ places**2 + rotaries.sum() == pytest.approx(4e-4, rel=1e-12)
    assert masses.min() > 0


def test_a_single_element_has_its_mass_at_its_ends():
    masses, rotaries = frame.lump(PAPER.link("coupler"), 1)
    assert masses.tolist() == pytest.approx([0.105, 0.105])
    assert rotaries.sum() == pytest.approx(0.21 * 0.12**2 / 12)


def straight(elements):
    """System and band of stiffness of the finite elements at rest, with the slider free."""
    system = beams.assemble(PAPER, elements, ideal=False)
    force, band = np.zeros(len(system.initial)), np.zeros((len(system.initial), 2 * beams.BAND + 1))
    beams._internal(system.initial, system.sections, system.unknowns, force, band, 1.0)
    assert np.abs(force).max() < 1e-6
    return system, band


@pytest.mark.parametrize("elements", [1, 4])
def test_finite_elements_bend_as_beam_theory(elements):
    """The coupler as a cantilever: ball free, pin held, a force across its end."""
    system, band = straight((1, elements))
    stiffness, link = dense(band), PAPER.link("coupler")
    first = len(system.initial) - 1 - 3 * elements  # behind the pin's rotation, before the slider
    free = np.arange(first, len(system.initial) - 1)
    load = np.zeros(len(free))
    load[-2] = 1.0
    bent = np.linalg.solve(stiffness[np.ix_(free, free)], load)[-2]
    theory = link.length**3 / (3 * link.bending) + link.length / link.shear
    assert bent == pytest.approx(theory, rel=1e-9)


def test_finite_elements_mass_is_consistent():
    system, _ = straight((2, 4))
    mass = dense(system.mass)
    assert mass == pytest.approx(mass.T)
    moved = np.zeros(len(system.initial))
    moved[[*np.unique(system.unknowns[:, [0, 3]]), system.ball.slider]] = 1.0
    assert moved @ mass @ moved == pytest.approx(0.3 + 0.21 + 0.14, rel=1e-12)


def test_tangent_of_finite_elements_is_the_derivative():
    system = beams.assemble(PAPER, (2, 3), ideal=False)
    generator = np.random.default_rng(1)
    q = system.initial + 0.01 * generator.standard_normal(len(system.initial))
    q[system.unknowns[:, [2, 5]]] += 2.0  # far from straight

    def force(q):
        forces, band = np.zeros(len(q)), np.zeros((len(q), 2 * beams.BAND + 1))
        beams._internal(q, system.sections, system.unknowns, forces, band, 1.0)
        return forces, band

    tangent = dense(force(q)[1])
    for j in range(len(q)):
        step = np.zeros(len(q))
        step[j] = 1e-7
        change = (force(q + step)[0] - force(q - step)[0]) / 2e-7
        assert tangent[:, j] == pytest.approx(change, abs=1e-7 * np.abs(tangent).max())


def test_contact_tangent_of_finite_elements_is_the_derivative():
    s = PAPER
    law = packed("hertz", s.ball_radius, s.socket_radius, s.composite_modulus)
    p, ball = s.constants(), beams.Ball(0, 1, 2, 3)
    q, v = np.array([3e-5, -4.1e-5, 0.3, 0.0]), np.array([0.02, 0.01, 0.5, 0.015])

    def force(q, v, by_v=0.0):
        force, band = np.zeros(4), np.zeros((4, 2 * beams.BAND + 1))
        how = True, 0.05, beams.ANY, p, law
        beams._add_joint(q, v, ball, *how, force, band, (1.0, by_v))
        return force, dense(band)

    assert abs(force(q, v)[0][2]) > 0.01
    stiff, both = force(q, v)[1], force(q, v, 1.0)[1]
    for j in range(4):
        step = np.zeros(4)
        step[j] = 1e-12 if j != 2 else 1e-8
        change = (force(q + step, v)[0] - force(q - step, v)[0]) / (2 * step[j])
        assert stiff[:, j] == pytest.approx(change, rel=1e-3, abs=1e-3 * np.abs(stiff).max())
        step[j] = 1e-8
        change = (force(q, v + step)[0] - force(q, v - step)[0]) / 2e-8
        damp = both - stiff
        assert damp[:, j] == pytest.approx(change, rel=1e-5, abs=1e-6 * np.abs(damp).max())


def test_frequency_of_particles_bounds_the_step():
    links = Frame(PAPER, (2, 4))
    limit = stable_step(PAPER, (2, 4))
    assert limit == 2 / links.highest_frequency(0.0, held=False)
    assert 1e-6 < limit < 1e-5
    below = simulate(model="particles", joint="ideal", step=0.98 * limit, duration=0.02, **TWO)
    assert below.energy_error < 1e-4


def distance(one, other):
    """Largest distance between two sliders, relative to the way of the other."""
    x, way = other.slider_position, np.ptp(other.slider_position)
    return np.abs(one.slider_position - x).max() / way


def order(x, y):
    """Slope of y over x in logarithms."""
    return np.polyfit(np.log(x), np.log(y), 1)[0]


@every_model
def test_stiff_links_move_as_rigid_ones(model):
    options = {"joint": "ideal", "duration": 1e-3, "outputs": 100}
    rigid, apart, factors = simulate(**options), [], [10, 100, 1000]
    step = {"step": 2.5e-7} if model == "beams" else {}
    for factor in factors:
        stiff = PAPER.replace(link_modulus=factor * PAPER.youngs_modulus)
        apart.append(distance(simulate(stiff, model=model, **options, **step, **TWO), rigid))
    assert order(factors, apart) == pytest.approx(-1, abs=0.1)
    assert apart[-1] < 1e-4


def test_flexible_models_come_to_each_other_with_order_2():
    options, numbers, apart = {"joint": "ideal", "duration": 1e-3, "outputs": 100}, [2, 4, 8], []
    for n in numbers:
        common = options | {"elements": (n, 2 * n)}
        beams_ = simulate(model="beams", step=2.5e-7, **common)
        apart.append(distance(simulate(model="particles", **common), beams_))
    assert order(numbers, apart) == pytest.approx(-2, abs=0.25)


@every_model
def test_flexible_links_with_an_ideal_joint(model):
    scene, options = PAPER.replace(gravity=9.81), {"joint": "ideal", "outputs": 20000}
    rigid, r = (simulate(scene, model=m, duration=0.05, **options) for m in ("rigid", model))
    assert r.energy_error < 1e-5
    assert r.impacts.empty
    assert compare.motion_nrms(rigid, r, "slider_position") < 2e-4
    assert compare.motion_nrms(rigid, r, "slider_velocity") < 5e-3
    smooth = np.ones(800) / 800  # 2 ms, over the links' ringing
    for column in ("force_x", "force_y"):
        one, other = (np.convolve(getattr(x, column), smooth, "valid") for x in (r, rigid))
        assert one == pytest.approx(other, abs=0.12 * np.abs(other).max())


@every_model
def test_nearly_rigid_links_impact_as_rigid_ones(model):
    stiff = PAPER.replace(link_modulus=1000 * PAPER.youngs_modulus)
    options = {"duration": 0.002, "outputs": 10}
    reference = simulate(**options).impacts.iloc[0]
    own = {} if model == "particles" else {"step": 1e-7}
    first = simulate(stiff, model=model, **TWO, **own, **options).impacts.iloc[0]
    assert first.time == pytest.approx(reference.time, rel=1e-4)
    assert first.approach_speed == pytest.approx(reference.approach_speed, rel=5e-3)
    for column in ("peak_force", "peak_depth", "separation_speed", "lost"):
        assert first[column] == pytest.approx(reference[column], rel=0.03)


@every_model
def test_shorter_steps_converge_with_order_2(model):
    """Places after one impact, against a much shorter step."""
    options = {"model": model, "duration": 0.002, "outputs": 20, **TWO}
    steps = np.array([8e-7, 4e-7, 2e-7])
    reference = simulate(step=2.5e-8, **options).slider_position[-1]
    errors = [abs(simulate(step=h, **options).slider_position[-1] - reference) for h in steps]
    assert order(steps, errors) > 1.5


@pytest.mark.parametrize("model", ["rigid", "particles", "beams"])
def test_where_a_loop_is_interrupted_changes_no_bit(model, monkeypatch):
    """Compiled loops return after some time, so that Ctrl-C is noticed, and begin anew."""
    options, rows = {} if model == "rigid" else TWO, []
    for patience in (0.0, np.inf):
        monkeypatch.setattr(stepping, "PATIENCE", patience)
        response = simulate(PAPER, model=model, duration=0.02, outputs=200, **options)
        kept = response.rows, response.impact_rows, response.event_rows
        rows.append([part.tobytes() for part in kept])
    assert rows[0] == rows[1]


@every_model
def test_outputs_at_every_step_lose_none_when_the_table_of_impacts_grows(model):
    scene = PAPER.replace(restitution=1.0, friction=0.0)
    options = {"model": model, "duration": 0.1, "step": 2e-6, "outputs": 50_000, **TWO}
    response = simulate(scene, **options)
    assert len(response.impacts) > 64
    assert (np.diff(response.impacts.time) > 0).all()
    assert (np.diff(response.crank_angle[1:]) != 0).all()  # no step is recorded twice
    assert response.energy_error < 1e-4


# driven at constant speed, or started from any angle and speed
STIFF = PAPER.replace(link_modulus=100 * PAPER.youngs_modulus)
STARTS = [
    {"crank_speed": 30.0},
    {"crank_speed": -30.0, "initial_crank_angle": -4.0, "gravity": 9.81},
    {"initial_crank_angle": 1.0, "initial_crank_speed": 25.0, "initial_eccentricity": (1e-5, 2e-5)},
    {"initial_crank_angle": 2.0, "initial_crank_speed": -25.0, "gravity": 9.81},
]
every_start = pytest.mark.parametrize("start", STARTS)


@every_model
@every_start
@pytest.mark.parametrize("joint", ["ideal", "clearance"])
def test_first_row_is_that_of_rigid_links(model, start, joint):
    scene = STIFF.replace(**start)
    rigid, flexible = (
        simulate(scene, model=kind, joint=joint, duration=1e-5, outputs=1).rows[0]
        for kind in ("rigid", model)
    )
    names = ["crank_angle", "slider_position", "crank_speed", "slider_velocity", "coupler_angle"]
    names += ["coupler_speed", "eccentricity_x", "eccentricity_y", "depth", "kinetic"]
    assert [*flexible[names]] == pytest.approx([*rigid[names]], rel=1e-3, abs=1e-8)


@every_model
@every_start
def test_stiff_links_with_an_ideal_joint_move_as_rigid_ones(model, start):
    scene, options = STIFF.replace(**start), {"joint": "ideal", "duration": 0.02, "outputs": 200}
    rigid = simulate(scene, **options)
    flexible = simulate(scene, model=model, elements=(2, 3), **options)
    assert flexible.crank_angle == pytest.approx(rigid.crank_angle, abs=2e-5)
    assert flexible.slider_position == pytest.approx(rigid.slider_position, abs=5e-7)
    assert flexible.energy_error < 1e-6
    if "crank_speed" in start:
        speed, angle = start["crank_speed"], start.get("initial_crank_angle", 0.0)
        # the angle is a sum over tens of thousands of steps
        assert flexible.crank_angle == pytest.approx(angle + speed * flexible.time, rel=1e-10)
        assert (flexible.crank_speed == speed).all()
        assert flexible.work[-1] == pytest.approx(rigid.work[-1], rel=2e-3)


@every_model
@pytest.mark.parametrize("speed", [40.0, -40.0])
def test_moment_that_holds_the_speed_is_that_of_rigid_links_but_for_ringing(model, speed):
    scene = STIFF.replace(crank_speed=speed, initial_crank_angle=1.0, gravity=9.81)
    options = {"joint": "ideal", "duration": 0.02, "outputs": 20000}
    rigid, flexible = (
        np.convolve(simulate(scene, model=kind, **options).driving_moment, np.full(1000, 1e-3))
        for kind in ("rigid", model)
    )  # means over 1 ms, in which stiff links ring some hundred times
    assert flexible[999:-999] == pytest.approx(rigid[999:-999], abs=0.02 * np.abs(rigid).max())


@every_model
@every_start
def test_energy_balance_follows_the_step(model, start):
    scene, errors = PAPER.replace(restitution=0.9, **start), []
    for parts in (1, 4):
        step = 1e-6 if model == "beams" else stable_step(scene, (2, 3)) / 4
        options = {"duration": 5e-3, "outputs": 200, "elements": (2, 3), "step": step / parts}
        errors.append(simulate(scene, model=model, **options).energy_error)
    assert errors[1] < errors[0] / 2
    assert errors[1] < 3e-5


def test_impacts_do_not_depend_on_the_times_of_output():
    """If the step divides the time between them; also where a lagged velocity makes them wrong."""
    options = {"elements": (4, 8), "method": "unguarded", "step": 2e-4 / 202, "duration": 0.02}
    coarse, fine = (simulate(model="particles", outputs=n, **options) for n in (50, 100))
    assert len(coarse.impact_rows) > 10
    for name in ("time", "duration", "peak_force"):
        assert coarse.impact_rows[name] == pytest.approx(
            fine.impact_rows[name], rel=1e-6, nan_ok=True
        )
