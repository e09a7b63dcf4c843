"""Contact off the axis: isotropy, the axis itself, energy, smoothness, errors, and CalculiX."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from study.joint import Joint, Material, UnresolvedError
from study.joint.tilted import axes_of, direction

CORE = "core:0.2"
WIDE = Joint.from_ratios(200, ball_support=CORE)
CUT = Joint.from_ratios(200, ball_support=CORE, opening=70)
"""Pressed towards 60 deg, its contact is cut by the rim."""
CALCULIX = {
    (4, 2): (97.302, -13.357),
    (4, 3): (97.011, -13.323),
    (4, 4): (96.945, -13.317),
    (5, 3): (97.031, -13.452),
    (6, 3): (96.984, -13.490),
}
"""Forces of CUT along and across at a depth of 0.5 and a tilt of 60 deg, by resolution and shells.

By CalculiX 2.20 and `other_programs.calculix_tilted` with a penalty of 3000; twice that raises the
force by 0.034 %. The error of the finest, which takes 7 min, is about 0.1 %. Left out is (5, 4),
which ends 1.7 % lower although CalculiX reports convergence: see `calculix.deck`.
"""

ROD_END = {"ball_support": "bore:0.5,45", "opening": "55:125"}
WIDE_ROD_END = {"ball_support": "bore:0.4,35", "opening": "45:135"}
THIN = {"socket_ratio": 1.2, "socket": Material(70e9, 0.35)}
CALCULIX_ROD_END = {
    (4, 2): (281.515, 1.4623),
    (6, 3): (281.324, 1.4617),
    (8, 3): (281.180, 1.4611),
    (10, 4): (281.129, 1.4625),
}
"""Force and pressure in the middle of a ROD_END: R2* = 200, a depth of 0.5, a tilt of 90 deg.

By CalculiX 2.20 and `other_programs.calculix_ring`, by resolution and shells, with a penalty of
3000. Twice that raises the force of (6, 3) by 0.04 %, and of other rod ends by up to 0.11 %: the
error of the finest force is about 0.1 %.
"""
BEARINGS = (
    ({"bearing": "GE 8 E"}, 4.9e-6, 6504.6, 324.6e6),
    ({"bearing": "GE 8 E"}, 12.3e-6, 25962, 803.0e6),
    ({"bearing": "GE 20 E"}, 7.95e-6, 34789, 282.4e6),
    ({"bearing": "GE 20 E"}, 20.7e-6, 138971, 741.5e6),
    ({"bearing": "GE 40 E", "ball_diameter": "52.4mm", "play": "60um"}, 10.1e-6, 115549, 250.7e6),
    ({"bearing": "GE 40 E", "ball_diameter": "52.4mm", "play": "60um"}, 27.5e-6, 460595, 689.5e6),
)
"""Joints of steel on steel, depths in m, forces in N, and pressures at the middle in Pa.

The specific loads are about 100 and 400 MPa. By CalculiX 2.20 and `other_programs.calculix_ring` at
(6, 3), extrapolated from penalties of 3000 and 6000 to a contact without compliance, which changes
a force by 0.14 to 0.22 %. In the last five, a mesh of (8, 3) changes a force by at most 0.07 % and
a pressure by at most 0.04 %, while the pressure at the rim grows by 2.7 to 4.6 %.
"""
SUPPORTS = (
    {"ball_support": "core:0.3", "opening": 70},
    {"ball_support": "neck:30", "opening": 100},
    ROD_END,
)


def pressed(joint, depth, tilt, resolution=32):
    return joint.solve(depth_star=depth, tilt=tilt, resolution=resolution)


def in_space(found):
    """Forces (x, z) of contacts, shape (k, 2)."""
    parts = zip(found.tilt, found.force_star, found.transverse_star, strict=True)
    return np.array([axes_of(tilt).T @ both for tilt, *both in parts])


@pytest.mark.slow
@pytest.mark.parametrize("kinematics", ["small", "linear"])
def test_a_ball_in_a_wide_socket_is_the_same_in_every_direction(kinematics):
    joint = Joint.from_ratios(200, ball_support=CORE, kinematics=kinematics)
    axial, found = joint.solve(depth_star=0.5), joint.solve(depth_star=[0.5, 0.5], tilt=[0, 30])
    assert (found.solver, axial.solver) == ("modes", "quadratic")
    assert not found.reaches_rim.any()
    # both are 0.1 % off: their error estimates are 0.75 and 0.36 %
    assert found.force_star == pytest.approx(axial.force_star[0], rel=1.5e-3)
    assert found.force_star[1] == pytest.approx(found.force_star[0], rel=2e-4)
    limits = axial.force_star[0] * np.array([1e-12, 1e-4])
    assert (np.abs(found.transverse_star) < limits).all()
    middle = (found.contact_from_deg + found.contact_to_deg) / 2
    assert middle == pytest.approx([0, 30], abs=0.2)
    # 2 % low, as elements count as a whole; and angles are those of the socket, not of the ball
    assert found.contact_area_star[1] == pytest.approx(axial.contact_area_star[0], rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("tilt", [0, 30])
def test_peak_pressure_is_that_of_the_axisymmetric_contact(tilt):
    axial, found = (WIDE.solve(depth_star=[0.1, 0.5], tilt=t) for t in (None, tilt))
    # 0.4 to 0.9 %; in the plane of symmetry, half of a node's function is on the other side
    assert found.peak_pressure_star == pytest.approx(axial.peak_pressure_star, rel=0.015)
    assert found.peak_angle_deg == pytest.approx([tilt, tilt], abs=1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("supports", "resolution"),
    [
        ({"ball_support": "neck:30"}, 32),
        ({"opening": 70}, 48),
        ({"socket_support": "rim"}, 48),
        ({"socket_support": "sector:0,40"}, 48),
    ],
)
def test_along_the_axis_force_is_that_of_the_axisymmetric_contact(supports, resolution):
    joint = Joint.from_ratios(200, **{"ball_support": CORE} | supports)
    axial, found = joint.solve(depth_star=0.5), pressed(joint, 0.5, 0, resolution)
    off = abs(found.force_star / axial.force_star - 1)
    # the mesh on the sphere is the coarser one by far: 0.1 % at resolution 48
    assert off < found.error_estimate + axial.error_estimate
    assert off < 3e-3
    assert abs(found.transverse_star) < 1e-12 * found.force_star


@pytest.mark.slow
def test_error_estimate_covers_the_error_where_the_rim_cuts_the_contact():
    where = [0.1, 0.3, 0.5, 0.5], [60, 75, 60, 75]
    coarse, fine = (pressed(CUT, *where, n) for n in (32, 48))
    assert coarse.reaches_rim.all()
    error = np.hypot(*(in_space(coarse) - in_space(fine)).T) / np.hypot(*in_space(fine).T)
    # the estimate is of order 1, and both forces are extrapolated
    assert (error < coarse.error_estimate).all()
    assert (fine.error_estimate < coarse.error_estimate).all()
    assert coarse.error_estimate.max() < 0.09


@cache
def derivative(kinematics, tilt, step=0.03):
    """Derivatives of the force along and across by a displacement along (first column) and across.

    And the contact itself. The contact's edge passes nodes as it moves: a smaller step scatters.
    """
    joint = Joint.from_ratios(200, ball_support=CORE, opening=70, kinematics=kinematics)
    axes = axes_of(tilt)
    x, z = (1.5 * axes[0] + np.concatenate([step * axes, -step * axes])).T
    moved = pressed(joint, np.hypot(x, z) - 1, np.degrees(np.arctan2(x, z)))
    forces = in_space(moved) @ axes.T
    return ((forces[:2] - forces[2:]) / (2 * step)).T, pressed(joint, 0.5, tilt)


@pytest.mark.parametrize("kinematics", ["small", "linear"])
@pytest.mark.parametrize("tilt", [20, 60])  # the rim cuts the second
def test_stiffness_is_the_derivative_of_the_force(kinematics, tilt):
    by_steps, found = derivative(kinematics, tilt)
    assert found.reaches_rim == (tilt == 60)
    assert found.stiffness_star == pytest.approx(by_steps[0, 0], rel=6e-3)
    assert found.transverse_stiffness_star == pytest.approx(by_steps[1, 1], rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kinematics", "tilt", "most"),
    # the force of small kinematics takes the socket's normals, and the gap the ball's: 1/R2*
    [("linear", 20, 1e-3), ("linear", 60, 1e-3), ("small", 20, 1e-3), ("small", 60, 1 / 200)],
)
def test_forces_have_an_energy(kinematics, tilt, most):
    by_steps, _ = derivative(kinematics, tilt)
    norm = np.linalg.norm(by_steps)
    assert abs(by_steps[0, 1] - by_steps[1, 0]) < most * norm
    assert (abs(by_steps[0, 1]) > 0.1 * norm) == (tilt == 60)  # the rim couples them


@pytest.mark.slow
def test_force_is_that_of_calculix_where_the_rim_cuts_the_contact():
    found, finest = CUT.solve(depth_star=0.5, tilt=60), np.array(CALCULIX[6, 3])
    force = np.append(found.force_star, found.transverse_star)
    assert force == pytest.approx(finest, abs=3e-3 * finest[0])  # 0.17 % along and 0.03 % across
    off = [np.hypot(*(force - CALCULIX[mesh])) for mesh in ((4, 2), (5, 3), (6, 3))]
    assert off == sorted(off, reverse=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("joint", "depth", "force", "pressure", "reaches_rim"),
    [
        ((200, ROD_END), 0.5, *CALCULIX_ROD_END[10, 4], True),
        ((200, ROD_END), 0.1, 17.804, 0.3368, False),  # (10, 3), penalty 6000
        ((200, ROD_END | THIN), 0.5, 409.497, 2.1967, True),  # (10, 4), penalty 6000
        ((200, WIDE_ROD_END), 0.15, 32.570, 0.4386, False),  # (8, 3), penalty 3000
        ((2000, ROD_END), 0.5, 2812.99, 1.4577, True),  # (6, 3), penalty 3000
    ],
)
def test_force_and_pressure_of_a_rod_end_are_those_of_calculix(
    joint, depth, force, pressure, reaches_rim
):
    r2_star, how = joint
    found = Joint.from_ratios(r2_star, **how).solve(depth_star=depth)  # a ring's tilt is 90 deg
    assert found.reaches_rim == reaches_rim
    assert found.force_star == pytest.approx(force, rel=3e-3)  # 0.03 to 0.215 %
    assert found.peak_pressure_star == pytest.approx(pressure, rel=0.01)  # at most 0.69 %
    assert abs(found.transverse_star) < 1e-9 * force


@pytest.mark.slow
@pytest.mark.parametrize(("sizes", "depth", "force", "pressure"), BEARINGS)
def test_force_and_pressure_of_a_bearing_are_those_of_calculix(sizes, depth, force, pressure):
    found = Joint.of(**sizes, socket="bearing steel").solve(depth=depth)
    assert found.reaches_rim  # the maximum inside the contact is at its middle
    assert found.force == pytest.approx(force, rel=1.5e-3)  # 0.03 to 0.11 %
    assert found.peak_pressure == pytest.approx(pressure, rel=3e-3)  # 0.01 to 0.21 %


@pytest.mark.slow
def test_at_a_rim_the_pressure_grows_with_the_resolution_and_at_the_middle_it_does_not():
    joint = Joint.of(bearing="GE 20 E", socket="bearing steel")
    coarse, fine = (joint.solve(depth=20.7e-6, resolution=n) for n in (32, 64))
    assert fine.peak_pressure == pytest.approx(coarse.peak_pressure, rel=3e-3)  # 0.17 %
    assert fine.pressure.max() > 1.08 * coarse.pressure.max()  # 12 %: a sharp edge


@pytest.mark.slow
def test_a_ball_that_moves_far_still_faces_the_whole_rim():
    joint = Joint.from_ratios(10, ball_support=CORE)  # moved by 0.19 R2, or 11 deg
    found, axial = pressed(joint, [0.9, 0.9], [0, 40]), joint.solve(depth_star=0.9)
    # linear kinematics leave out terms of order 1/R2*^2, not the same ones off the axis
    assert found.force_star == pytest.approx(axial.force_star[0], rel=1e-2)
    assert found.force_star[1] == pytest.approx(found.force_star[0], rel=3e-3)


@pytest.mark.slow
def test_a_force_is_borne_by_the_displacement_that_is_found():
    force, tilt = np.array([30.0, 100.0, 60.0]), np.array([0.0, 20.0, 60.0])
    found = CUT.solve(force=force * CUT.force_unit, tilt=tilt, resolution=32)
    wanted = force[:, None] * [direction(t) for t in tilt]
    assert in_space(found) == pytest.approx(wanted, abs=1e-5 * force.max())
    again = pressed(CUT, found.depth_star, found.tilt)
    assert in_space(again) == pytest.approx(wanted, abs=1e-5 * force.max())
    # the rim yields more than the pole, and there the displacement goes ahead of the force
    assert found.tilt[0] == pytest.approx(0, abs=1e-9)
    assert found.tilt[2] > 70


def test_a_symmetric_ring_answers_symmetric_tilts_alike():
    joint = Joint.from_ratios(200, **ROD_END)
    under = joint.solve(force=200 * joint.force_unit, resolution=32)
    assert (under.tilt[0], under.transverse_star[0]) == (90, 0)  # zero by symmetry is zero
    found = pressed(joint, [0.5] * 3, [75, 90, 105])
    assert found.force_star[0] == pytest.approx(found.force_star[2], rel=1e-9)
    across = found.transverse_star / found.force_star[1]
    assert across[:2] == pytest.approx([-across[2], 0], abs=1e-9)
    assert found.reaches_rim.all()


@pytest.mark.slow
def test_away_from_its_rims_a_ring_is_the_cup_around_the_same_ball():
    cup, ring = (
        pressed(Joint.from_ratios(200, ball_support=CORE, opening=opening), 0.1, 90)
        for opening in (140, "40:140")
    )
    assert ring.force_star == pytest.approx(cup.force_star, rel=5e-3)


@pytest.mark.slow
def test_stresses_and_friction_off_the_axis_are_those_along_it():
    # a ball on a large core in a wide socket: nearly the same in every direction
    joint = Joint.from_ratios(200, ball_support="core:0.5")
    axial, found = (
        joint.solve(depth_star=[0.1, 0.5], tilt=tilt, stresses=True) for tilt in (None, 20)
    )
    assert found.friction_radius_star == pytest.approx(axial.friction_radius_star, rel=5e-3)
    for body, largest in found.stress.items():
        assert largest.von_mises == pytest.approx(axial.stress[body].von_mises, rel=0.03)
        assert np.degrees(largest.angle) == pytest.approx([20, 20], abs=3)
        assert (largest.error < 0.03).all()


def bends(values):
    """Second differences of the logarithm of a force, which a jump would make large."""
    return np.abs(np.diff(np.log(values), 2))


@pytest.mark.slow
@settings(max_examples=4)
@given(
    supports=st.sampled_from(SUPPORTS),
    r2_star=st.floats(20, 3000),
    depth=st.floats(0.15, 0.9),
    tilt=st.floats(55, 88),
    resolution=st.sampled_from([32, 48]),
)
def test_the_force_is_smooth_in_tilt_and_depth(supports, r2_star, depth, tilt, resolution):
    """In steps of 0.5 deg and of 1 %; a force that a rim cuts bends by at most half a percent."""
    tilts = tilt + np.array([-0.5, 0, 0.5, 0, 0])
    depths = depth * np.array([1, 1, 1, 1 / 1.01, 1.01])
    try:
        found = pressed(Joint.from_ratios(r2_star, **supports), depths, tilts, resolution)
    except UnresolvedError:
        return
    force = found.force_star
    assert bends(force[:3]).max() < 5e-3
    assert bends(force[[3, 1, 4]]).max() < 5e-3
    assert force[3] < force[1] < force[4]


@pytest.mark.slow
def test_a_small_core_is_resolved():
    """With elements that grow all the way to the core, the force was 2 % off at resolution 32."""
    joint = Joint.from_ratios(200, ball_support="core:0.12", opening=80)
    coarse, fine = (pressed(joint, 0.5, 10, n).force_star for n in (32, 48))
    assert coarse == pytest.approx(fine, rel=1e-3)


def random_contacts(seed, count):
    """Joints of all supports, and the depth and tilt of a contact of each."""
    draw = np.random.default_rng(seed)
    for number in range(count):
        last = draw.uniform(50, 120)
        supports = (
            {"ball_support": f"core:{draw.uniform(0.1, 0.6):.2f}", "opening": last},
            {"ball_support": f"neck:{draw.uniform(10, 40):.0f}", "opening": last},
            {"ball_support": "bore:0.3,45", "opening": f"{90 - last / 3}:{90 + last / 3}"},
        )[number % 3]
        joint = Joint.from_ratios(
            np.exp(draw.uniform(np.log(20), np.log(3000))),
            draw.choice([1.1, 1.298, 2.0]),
            socket=Material(206e9 * 10 ** draw.uniform(-1, 1)),
            kinematics=draw.choice(["small", "linear"]),
            **supports,
        )
        tilt = draw.uniform(joint.opening.first, joint.opening.last)
        yield joint, np.exp(draw.uniform(np.log(0.05), 0)), tilt


@pytest.mark.slow
def test_stated_errors_cover_the_difference_to_twice_the_resolution():
    """For force and peak pressure; 300 such contacts give the frequency that is published."""
    for joint, depth, tilt in random_contacts(5, 4):
        try:
            coarse, fine = (pressed(joint, depth, tilt, n) for n in (32, 64))
        except UnresolvedError:
            continue
        forces = [np.array([c.force_star[0], c.transverse_star[0]]) for c in (coarse, fine)]
        off = np.hypot(*(forces[0] - forces[1])) / np.hypot(*forces[1])
        assert off <= coarse.error_estimate[0]
        off = abs(coarse.peak_pressure_star / fine.peak_pressure_star - 1)
        assert off <= coarse.peak_error


COUNT = 10  # 60 for the numbers of REPRODUCING


@pytest.mark.slow
def test_errors_cover_the_difference_from_twice_the_resolution_in_nine_of_ten_contacts():
    rng, covered = np.random.default_rng(11), []
    while len(covered) < COUNT:
        r2_star, modulus_ratio = 10 ** rng.uniform(1.7, 3.3), 10 ** rng.uniform(-2.5, 1)
        poissons, ratio = rng.uniform(0.2, 0.46, 2), 10 ** rng.uniform(0.05, 0.4)
        if rng.random() < 0.5:
            half, tilt = rng.uniform(18, 40), 90
            opening = f"{90 - half:.6f}:{90 + half:.6f}"
            core, *bore = rng.uniform(0.2, 0.7), rng.uniform(0.3, 0.6), rng.uniform(40, 48)
            support = [f"core:{core:.3f}", f"bore:{bore[0]:.3f},{bore[1]:.1f}"][rng.integers(2)]
        else:
            opening = round(rng.uniform(70, 120), 1)
            core, neck = rng.uniform(0.2, 0.7), rng.uniform(15, 40)
            support = [f"core:{core:.3f}", f"neck:{neck:.1f}"][rng.integers(2)]
            tilt = rng.uniform(10, opening - 5)
        try:
            joint = Joint.from_ratios(
                *(r2_star, ratio),
                modulus_ratio=modulus_ratio,
                poisson=poissons[0],
                socket_poisson=poissons[1],
                ball_support=support,
                opening=opening,
            )
            depth = rng.uniform(0.08, 0.9)
            coarse, fine = (
                joint.solve(depth_star=depth, tilt=tilt, resolution=n) for n in (32, 64)
            )
        except ValueError:  # the contact would leave the ball, or the bore its face
            continue
        forces = [np.array([of.force_star[0], of.transverse_star[0]]) for of in (coarse, fine)]
        off = np.hypot(*(forces[0] - forces[1])) / np.hypot(*forces[1])
        off_peak = abs(coarse.peak_pressure_star / fine.peak_pressure_star - 1)[0]
        covered.append([off <= coarse.error_estimate[0], off_peak <= coarse.peak_error[0]])
    assert (np.mean(covered, axis=0) >= 0.9).all()
