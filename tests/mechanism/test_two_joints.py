"""Two clearance joints, a crank of constant speed, and starts that are not at rest."""

import re

import numpy as np
import pytest
from helpers.laws import packed
from helpers.with_hertz import simulate
from scipy.integrate import solve_ivp

from study.mechanism import compare, paper_scene, two_joints
from study.mechanism.joints import ContactState

PAPER = paper_scene()
BOTH = PAPER.replace(crank_clearance=8e-5)
STARTS = {
    "moment": {},
    "speed": {"crank_speed": 60.0, "gravity": 9.81},
    "start": {"initial_crank_angle": 2.0, "initial_crank_speed": -30.0, "gravity": 9.81},
}


def laws(scene, law="hertz"):
    gaps, radius = (scene.clearance, scene.crank_clearance), scene.socket_radius
    return tuple(packed(law, radius - gap, radius, scene.composite_modulus) for gap in gaps)


@pytest.mark.parametrize("start", STARTS)
def test_jacobian_is_the_derivative(start):
    scene = BOTH.replace(**STARTS[start])
    p, packed = scene.constants(), laws(scene)
    states = [  # (theta, slider's joint, crank's joint) and rates, flight or contact
        ((0.7, 1.3e-5, -2e-5, 8e-7, 0.4, 11.0, 0.03, -0.05, 0.02, 700.0), (False, True)),
        ((0.7, 8e-7, 2.1, -3e-5, 2e-5, 11.0, 0.02, 900.0, 0.03, 0.01), (True, False)),
        ((4.0, 8e-7, -0.4, 9e-7, 1.9, -30.0, -0.02, -900.0, 0.01, 300.0), (True, True)),
    ]
    for values, contacts in states:
        y = np.array([*values, 0, 0, 0, 0, 0])
        contacts = tuple(ContactState(closed, int(closed), 0.06) for closed in contacts)
        k = np.zeros((5, 10))
        motion, parts = two_joints.motion(y, contacts, p, packed)
        two_joints.derive(y, contacts, p, motion, parts, k)
        for j in range(10):
            h, ends = 1e-6 * max(abs(y[j]), 1e-5), []
            for sign in (1, -1):
                moved = y.copy()
                moved[j] += sign * h
                ends.append(two_joints.motion(moved, contacts, p, packed)[0].accelerations)
            by_difference, mine = np.subtract(*ends) / (2 * h), k[:, j]
            size = np.abs(k).max(axis=1) * 1e-7 + np.abs(motion.accelerations) * 1e-8 / h
            assert (np.abs(mine - by_difference) <= size + 1e-4 * np.abs(mine)).all()


class Bodies:
    """Crank, coupler and slider as free bodies (theta, x, y, phi, s): x, y the coupler's centre."""

    def __init__(self, scene):
        self.scene, self.scales = scene, [law.scale for law in laws(scene)]
        self.gaps = scene.clearance, scene.crank_clearance
        self.approach = [0.0, 0.0]

    def joints(self, y):
        """Eccentricity, its rate, turning of ball and of socket, of slider's and crank's joint."""
        s, (theta, x, h, phi, slider), (omega, vx, vy, psi, speed) = self.scene, y[:5], y[5:]
        crank = s.crank_length * np.array([np.cos(theta), np.sin(theta)])
        half = s.coupler_length / 2 * np.array([np.cos(phi), np.sin(phi)])
        across = np.array([[0, -1], [1, 0]])
        centre, rate = np.array([x, h]), np.array([vx, vy])
        end, start = rate + psi * across @ half, rate - psi * across @ half
        return (
            (centre + half - [slider, 0], end - [speed, 0], psi, 0.0),
            (crank - centre + half, omega * across @ crank - start, omega, psi),
        )

    def slopes(self, _, y):
        s, forces, moments = self.scene, [], []
        for j, (e, w, ball, socket) in enumerate(self.joints(y)):
            reach, radius = np.hypot(*e), s.socket_radius - self.gaps[j]
            n = e / max(reach, 1e-300)
            depth, force, turning = reach - self.gaps[j], np.zeros(2), (0.0, 0.0)
            if self.approach[j] and depth > 0:
                elastic = self.scales[j] * (depth / self.gaps[j]) ** 1.5
                normal = elastic * (1 + s.damping_factor * (w @ n) / self.approach[j])
                side = np.array([-n[1], n[0]])
                sliding = w @ side + radius * ball - (reach + radius) * socket
                share = (abs(sliding) - s.slow_speed) / (s.full_speed - s.slow_speed)
                friction = -s.friction * normal * np.clip(share, 0, 1) * np.sign(sliding)
                force = -normal * n + friction * side  # on the ball
                turning = radius * friction, -(reach + radius) * friction
            forces.append(force)
            moments.append(turning)
        return np.concatenate([y[5:], self.accelerate(y, forces, moments)])

    def accelerate(self, y, forces, moments):
        s, (theta, phi), (i1, i2) = self.scene, y[[0, 3]], self.scene.inertias
        (slider, crank), half = forces, s.coupler_length / 2
        about = i1 + s.crank_mass * s.crank_length**2 / 4
        moment = s.driving_moment + moments[1][0]
        moment -= s.crank_mass * s.gravity * s.crank_length / 2 * np.cos(theta)
        moment += s.crank_length * (np.cos(theta) * crank[1] - np.sin(theta) * crank[0])
        alpha = 0.0 if s.crank_speed is not None else moment / about
        both = slider + crank
        turn = half * (np.cos(phi) * both[1] - np.sin(phi) * both[0])
        turn += moments[0][0] + moments[1][1]
        ax, ay = (slider - crank) / s.coupler_mass - [0, s.gravity]
        return [alpha, ax, ay, turn / i2, -slider[0] / s.slider_mass]

    def start(self):
        s, theta, omega = self.scene, self.scene.initial_crank_angle, self.scene.starting_speed
        l1, l2 = s.crank_length, s.coupler_length
        phi = -np.arcsin(l1 / l2 * np.sin(theta))
        psi = -l1 * np.cos(theta) * omega / (l2 * np.cos(phi))
        x, h = l1 * np.cos(theta) + l2 / 2 * np.cos(phi), l1 / 2 * np.sin(theta)
        vx, vy = -l1 * np.sin(theta) * omega - l2 / 2 * np.sin(phi) * psi, l1 / 2 * np.cos(theta)
        slider, speed = x + l2 / 2 * np.cos(phi), vx - l2 / 2 * np.sin(phi) * psi
        return np.array([theta, x, h, phi, slider, omega, vx, vy * omega, psi, speed])

    def meetings(self, count, until):
        """(Time, joint) at which surfaces meet or part, the first ``count``."""

        def gap(j):
            def depth(_, y):
                return np.hypot(*self.joints(y)[j][0]) - self.gaps[j]

            depth.terminal, depth.direction = True, -1 if self.approach[j] else 1
            return depth

        y, t, found = self.start(), 0.0, []
        while len(found) < count:
            longest = 2e-6 if any(self.approach) else 2e-4
            options = {"rtol": 1e-11, "atol": 1e-15, "max_step": longest}
            events = [gap(0), gap(1)]
            part = solve_ivp(self.slopes, (t, until), y, "DOP853", events=events, **options)
            j = 0 if len(part.t_events[0]) else 1
            t, y = part.t_events[j][0], part.y_events[j][0]
            found.append((t, j))
            e, w, _, _ = self.joints(y)[j]
            self.approach[j] = 0.0 if self.approach[j] else w @ e / np.hypot(*e)
            y, t = y + self.slopes(t, y) * 1e-12, t + 1e-12  # off the event
        return found


@pytest.mark.parametrize("start", STARTS)
def test_two_joints_agree_with_another_integrator(start):
    """Absolute coordinates of free bodies, SciPy's integrator, sections between located events."""
    scene = BOTH.replace(**STARTS[start])
    found = Bodies(scene).meetings(6, 0.01)
    impacts = simulate(scene, duration=found[-1][0] + 1e-6, outputs=20, tolerance=1e-10).impacts
    mine = [(row.time, row.joint) for row in impacts.itertuples()]
    mine += [(row.time + row.duration, row.joint) for row in impacts.dropna().itertuples()]
    mine = sorted(mine)[:6]
    assert [time for time, _ in mine] == pytest.approx([time for time, _ in found], rel=1e-7)
    assert [joint for _, joint in mine] == [("slider", "crank")[j] for _, j in found]


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("law", ["hertz", "hyperbolic_winkler"])
def test_energy_balance_closes_with_two_joints(start, law):
    response = simulate(BOTH.replace(**STARTS[start]), law=law, duration=0.05, outputs=300)
    assert response.energy_error < 1e-8
    assert set(response.impacts.joint) == {"slider", "crank"}
    lost = response.lost_damping[-1] + response.lost_friction[-1]
    assert response.impacts.lost.sum() == pytest.approx(lost, rel=1e-9)
    peaks = response.motion[response.motion.event == "crank peak"]
    crank = response.impacts[response.impacts.joint == "crank"]
    assert peaks.crank_joint_normal_force.to_numpy() == pytest.approx(crank.peak_force, rel=1e-12)


@pytest.mark.parametrize(
    "scene", [BOTH, BOTH.replace(crank_speed=60.0), PAPER.replace(crank_speed=60.0)]
)
def test_accuracy_follows_the_tolerance(scene):
    reference = simulate(scene, duration=0.02, outputs=300, tolerance=1e-11)
    errors = [
        compare.motion_nrms(
            reference,
            simulate(scene, duration=0.02, outputs=300, tolerance=tolerance),
            "slider_position",
        )
        for tolerance in (1e-5, 1e-7, 1e-9)
    ]
    assert errors[0] < 1e-3
    assert errors[1] < 1e-5
    assert errors[2] < 1e-7


@pytest.mark.parametrize("start", STARTS)
def test_tiny_clearances_of_stiff_bodies_are_ideal_joints(start):
    scene = PAPER.replace(**STARTS[start], youngs_modulus=1e13)
    ideal, away = simulate(scene, joint="ideal", duration=0.01, outputs=50), []
    for gap in (2e-5, 2e-6):
        two = simulate(scene.replace(clearance=gap, crank_clearance=gap), duration=0.01, outputs=50)
        away.append(np.abs(two.slider_position - ideal.slider_position).max())
    assert away[0] < 4 * 2e-5
    assert away[1] < 0.35 * away[0]


@pytest.mark.parametrize("joint", ["ideal", "clearance"])
def test_force_in_the_ideal_joint_of_the_crank_turns_it(joint):
    scene = PAPER.replace(gravity=9.81, initial_crank_angle=0.3, initial_crank_speed=20.0)
    r = simulate(scene, joint=joint, duration=0.02, outputs=100)
    inertia = scene.inertias[0] + scene.crank_mass * scene.crank_length**2 / 4
    st, ct = np.sin(r.crank_angle), np.cos(r.crank_angle)
    turn = ct * r.crank_joint_force_y - st * r.crank_joint_force_x
    moment = scene.driving_moment - scene.crank_length * (turn + scene.crank_mass * 9.81 / 2 * ct)
    assert inertia * r.crank_acceleration == pytest.approx(moment, rel=1e-9, abs=1e-9)
    size = np.hypot(r.crank_joint_force_x, r.crank_joint_force_y)
    assert r.crank_joint_normal_force == pytest.approx(size, rel=1e-12)


def test_constant_speed_is_the_crank_slider_of_the_textbook():
    speed, angle = 50.0, 0.4
    scene = PAPER.replace(crank_speed=speed, initial_crank_angle=angle, gravity=9.81)
    r = simulate(scene, joint="ideal", duration=0.1, outputs=4000)
    theta, l1, l2 = angle + speed * r.time, scene.crank_length, scene.coupler_length
    root = np.sqrt(l2**2 - (l1 * np.sin(theta)) ** 2)
    position = l1 * np.cos(theta) + root
    velocity = -l1 * speed * np.sin(theta) * (1 + l1 * np.cos(theta) / root)
    assert r.crank_angle == pytest.approx(theta, rel=1e-14)
    assert r.slider_position == pytest.approx(position, rel=1e-13)
    assert r.slider_velocity == pytest.approx(velocity, rel=1e-12, abs=1e-12)
    assert r.energy_error < 1e-12
    fall = 9.81 * (0.3 / 2 + 0.21) * l1 * np.sin(theta) + 9.81 * 0.21 / 2 * l2 * np.sin(
        r.coupler_angle
    )
    power = np.gradient(r.kinetic + fall, r.time)[1:-1]
    assert (r.driving_moment * speed)[1:-1] == pytest.approx(power, abs=1e-3 * power.max())


def test_clearance_at_constant_speed_needs_the_same_moment_in_the_mean():
    scene = PAPER.replace(crank_speed=50.0, clearance=5e-6)
    ideal, rigid_links = (
        simulate(scene, joint=joint, duration=0.1, outputs=2000) for joint in ("ideal", "clearance")
    )
    assert (rigid_links.crank_speed == 50.0).all()
    assert rigid_links.energy_error < 1e-8
    kept = rigid_links.work[-1] - rigid_links.lost_damping[-1] - rigid_links.lost_friction[-1]
    assert kept == pytest.approx(ideal.work[-1], abs=0.01 * np.ptp(ideal.work))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"crank_speed": 5.0, "driving_moment": 1.0}, "driving_moment does not apply to a cra"),
        ({"crank_speed": 5.0, "initial_crank_speed": 1.0}, "initial_crank_speed does not apply"),
        ({"crank_clearance": 1e-5, "coupler_inertia": 0.0}, "coupler_inertia must be > 0 kg m^2"),
    ],
)
def test_bad_scene_is_one_clear_error(changes, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        PAPER.replace(**changes)


@pytest.mark.parametrize(
    "options", [{"model": "particles"}, {"model": "beams"}, {"joint": "ideal"}]
)
def test_a_model_without_a_second_joint_says_so(options):
    message = "crank_clearance, .* requires model rigid"
    with pytest.raises(ValueError, match=message):
        simulate(BOTH, duration=1e-3, **options)
