"""Wrong joints, loads and questions: one clear error that names the value, before any work."""

import re
from dataclasses import replace

import numpy as np
import pytest

from study.joint import Joint, Layer, Material, first_yield, stress
from study.joint.complementarity import ComplementarityError

CUT = Joint.from_ratios(200, ball_support="core:0.2", opening=70)
SOLVED = Joint.from_ratios(200, kinematics="small").solve(depth_star=[0.05, 0.5])
HOUSED = Layer(1.125, Material(5e8, 0.46)), Layer(1.5, Material())
HARD = Material(2e11, 0.3, 1e9)
RING = {"ball_support": "bore:0.5,45", "opening": "55:125"}
BORED = Joint.from_ratios(100, ball_support="bore:0.5,40")


def sized(**changes):
    return Joint(**{"socket_radius": 0.01, "clearance": 1e-4, "wall": 3e-3} | changes)


def ratios(*values, **changes):
    return Joint.from_ratios(*values, **changes)


def stiffened(joint):
    return joint.law("stiffened_hertz")


def pressed(joint, depth, tilt, resolution=32):
    return joint.solve(depth_star=depth, tilt=tilt, resolution=resolution)


def under(force, tilt, joint=CUT):
    return joint.solve(force=force * joint.force_unit, tilt=tilt, resolution=32)


WRONG = [
    # Joint
    (lambda: sized(clearance=-1e-6), "clearance must be > 0 m, got -1e-06 m; without"),
    (lambda: sized(clearance=1e-13), "clearance must be >= 1e-11 m, got 1e-13 m"),
    (lambda: sized(wall=1e-7), "wall must be >= 1e-06 and"),
    (lambda: sized(clearance=0.0011), "clearance must be <= 0.001 m, a tenth of the radius of"),
    (lambda: sized(liner=("PTFE",)), "liner must be a thickness and a material"),
    (lambda: sized(liner=("3e-3,PTFE",)), "wall must be > 0.003 m, the thickness of its liners"),
    (lambda: sized(socket="210,0.3"), "socket"),
    (lambda: sized(kinematics="finite"), "kinematics must be one of small, linear"),
    (lambda: sized(opening=120, ball_support="clamped"), "opening with ball_support clamped"),
    (lambda: sized(socket_support="sector:0,95"), "last angle of socket_support must be <= 90"),
    (lambda: sized(opening="55:125"), "ball_support must hold a whole ball if the socket is a"),
    (lambda: sized(opening=70, rim="mirror"), "must be one of free, got 'mirror'"),
    # from_ratios
    (lambda: ratios(9.99), "r2_star must be >= 10, got 9.99; such a loose ball"),
    (lambda: ratios(2e9), "r2_star must be >= 10 and <= 1e+09, got 2e+09"),
    (lambda: ratios(80, modulus_ratio=0.0), "modulus_ratio must be >= 1e-09"),
    (lambda: ratios(80, poisson=0.5), "poisson must be > -1 and < 0.5, got 0.5"),
    (lambda: ratios(80, 1.4, layers=HOUSED), "socket_ratio does not apply"),
    (lambda: ratios(80, modulus_ratio=2, layers=HOUSED), "modulus_ratio does not apply"),
    (lambda: ratios(80, layers=HOUSED[::-1]), "divided by its inner radius must be >= 1.0001"),
    (lambda: ratios(**RING | {"ball_support": "bore:0.8,45"}), "radius of the bore must be <="),
    (lambda: ratios(**RING | {"ball_support": "pin:6e-3,9e-3"}), "pin requires a joint with"),
    (lambda: ratios(**RING, socket_support="sector:40,90"), "first angle of socket_support"),
    # solve
    (lambda: sized().solve(), "exactly one of depth, force and depth_star must be given, got"),
    (lambda: sized().solve(depth=1e-6, force=1.0), "must be given, got depth and force"),
    (lambda: sized().solve(force=[1.0, -3.0]), "force must be > 0 N, got -3 N"),
    (lambda: sized().solve(force=[]), "force must be one number or a list, got shape (0,)"),
    (lambda: sized().solve(depth=np.nan), "depth must be finite and > 0 m, got nan m"),
    (lambda: sized().solve(depth_star=-0.1), "depth_star must be > 0, got -0.1"),
    (lambda: sized(rim="free").solve(force=9, solver="series"), "solver must be quadratic or lin"),
    (lambda: sized().solve(force=9, solver="fem"), "solver must be one of series, quadratic"),
    (lambda: sized().solve(force=9, resolution=48), "resolution must be a multiple of 32, got 48"),
    (lambda: ratios(200).solve(depth_star=0.1, resolution=16), "resolution must be >= 32"),
    (lambda: sized().solve(depth=1e-15), "elements to resolve the contact"),
    (lambda: ratios(200).solve(depth_star=20, resolution=32), "depth_star must be < 18.97"),
    (lambda: ratios(200).solve(depth_star=9, resolution=32), "rim of the socket"),
    (lambda: ratios(**RING).solve(depth_star=0.5, tilt=0), "inside the opening of 55:125 deg"),
    # curve
    (lambda: ratios(200).curve(20), "depth_star must be < 18.97"),
    (lambda: sized(opening=40).curve(0.9), "rim of the socket (at a half-angle of 40 deg)"),
    (lambda: ratios(200).curve(1e-4), "deepest must be large enough for a contact of >= 16"),
    (lambda: ratios(200).curve(resolution=100), "resolution must be a multiple of 32, got 100"),
    (lambda: ratios(200).curve(0.5, tilt=20), "ball_support under a tilted load must be"),
    # off the axis
    (lambda: under(1e6, 10), "force must be one that the contact transmits inside"),
    (lambda: under(50, 69.5), "N at a tilt of 69.5 deg"),
    (lambda: under(50, 70), "tilt of a force must be inside the socket's opening of 70 deg"),
    (lambda: under(50, 20, ratios(**RING)), "inside the socket's opening of 55:125 deg"),
    (lambda: pressed(BORED, 0.5, 65), "keep the contact on the surface of the ball, which ends at"),
    (lambda: pressed(CUT, 0.5, [1, 2]), "tilt must be one number or as many as there are dep"),
    (lambda: pressed(CUT, 0.1, 120), "tilt must leave a contact inside the opening of 70 deg"),
    (lambda: pressed(CUT, 0.1, 171), "tilt must be >= 0 and <= 170 deg, got 171 deg"),
    (lambda: pressed(CUT, 0.0, 10), "depth_star must be > 0, got 0"),
    (lambda: pressed(CUT, 1e-3, 10), "depth_star must be so large that the elements resolve"),
    (lambda: pressed(CUT, 0.5, 10, 40), "resolution must be a multiple of 16, got 40"),
    (lambda: pressed(CUT, 0.5, 10, 128), "resolution must be >= 32 and <= 96, got 128"),
    (lambda: CUT.solve(force=9, tilt=10, solver="linear"), "solver does not apply to a load off"),
    # laws and stresses
    (lambda: stiffened(ratios(layers=HOUSED)), "is not valid for a socket with layers"),
    (lambda: stiffened(CUT), "stiffened_hertz is not valid for ball_support core:0.2"),
    (lambda: stiffened(sized(ball_support="clamped", opening=70)), "for an opening of 70 deg"),
    (lambda: stiffened(sized(socket_support="rim")), "is not valid for socket_support rim"),
    (lambda: stress.stresses(SOLVED, "rod", 1, 0), "body must be one of ball, socket, got 'rod'"),
    (lambda: stress.stresses(SOLVED, "socket", 0.9, 0), "radius must be > 0 and >= 1 and <= 1.298"),
    (lambda: stress.stresses(SOLVED, "ball", 0.9, 2), "angle must be >= 0 and <= 1.57"),
    (lambda: stress.stresses(replace(SOLVED, solver="linear"), "ball", 1, 0), "solver must be"),
    (lambda: first_yield(ratios(200)), "joint must have a yield_stress"),
    (lambda: first_yield(sized(ball_support="core:0.2", ball=HARD)), "got core:0.2 and outside"),
]


@pytest.mark.parametrize(("call", "message"), WRONG)
def test_wrong_input_is_one_clear_error(call, message):
    with pytest.raises(ValueError, match=re.escape(message)) as error:
        call()
    assert not isinstance(error.value, ComplementarityError)
