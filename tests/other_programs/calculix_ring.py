"""A rod end in CalculiX: a bored ball on a pin, pressed across the axis of a socket that is a ring.

The pin is displaced at a tilt of 90 deg, so that a quarter of the bodies is enough, between the
planes of symmetry y = 0 and z = 0. Both bodies are patches of bricks with 20 nodes over the polar
angle theta, the angle phi around the axis, and the depth. Bricks are small where phi = 0, where the
ball touches, and larger opposite. The rest is as in `calculix_tilted`.
"""

import re

import numpy as np

from other_programs import calculix
from other_programs.calculix_tilted import body, patch, solution
from study import checks
from study.joint import Joint
from study.joint.compliance import graded
from study.joint.supports import Bore, WholeOutside

_STRESS = r"\n -1.{10}(.{12}).{12}(.{12}).{24}(.{12})"  # of a node: xx, zz and zx
_FOUND = re.compile(  # the force, and after it stresses at rim and middle of ball and socket
    r"for set BALLHELD and time\s+\S+\s+(\S+).*-4  STRESS.*?" + 4 * _STRESS, re.DOTALL
)
_PLANES = "BALLPLANE, 2, 2", "SOCKETPLANE, 2, 2", "BALLEQUATOR, 3, 3", "SOCKETEQUATOR, 3, 3"
_DEPTH_SCALE = 0.15  # elements grow from this depth below the surface on
_AROUND_SCALE = 1.5  # and from phi = 0 on over this angle, in rad


def pressed(joint: Joint, depth_star: float, **mesh: float) -> tuple[float, float, float]:
    """Force along the displacement, and the pressures at the middle of the ring and at its rim.

    The force is over E* dR^2, the pressures over E* dR/R2. A pressure is the mean of both bodies'
    radial stresses at their surfaces. It is steadier than the product of penalty and overclosure at
    a node, which scatters by some 2 %. At the rim, a sharp edge, it grows with the resolution.
    Arguments are those of `deck`.
    """
    ((force, *stresses),) = calculix.run(deck(joint, depth_star, **mesh), 1, _FOUND)
    xx, zz, zx = np.reshape(stresses, (2, 2, 3)).mean(axis=0).T
    theta = np.radians([joint.opening.first, 90])
    x, z = np.sin(theta), np.cos(theta)
    rim, middle = -joint.r2_star * (x * x * xx + z * z * zz + 2 * x * z * zx)
    return float(4 * joint.r2_star**2 * force), float(middle), float(rim)  # four quarters


def deck(joint, depth_star, resolution=8, shells=3, penalty=3000.0):
    """CalculiX's input for one depth; the ball starts where it first touches.

    The joint has a bore, ``linear`` kinematics, an opening that is a ring about 90 deg on the
    ball, and a socket of one material that is held all over its outside. The ``resolution`` is the
    number of bricks from the middle of the ring to a rim; ``shells`` are those of the socket, and
    half the ball's. The ``penalty`` is pressure per overclosure, in E*/R2.
    """
    bore = checks.instance("ball_support", joint.ball_support, Bore)
    checks.choice("kinematics", joint.kinematics, ("linear",))
    checks.instance("socket_support", joint.socket_support, WholeOutside)
    if not joint.is_plane_of_symmetry(90) or joint.opening.first < bore.face:
        raise ValueError(f"opening must be a ring about 90 deg on the ball, got {joint.opening}")
    rim, face = np.radians([joint.opening.first, bore.face])
    centre = np.array([1, 0, 0]) / joint.r2_star

    def in_ball(points, share):
        theta, phi = points.T
        radius = bore.radius + share * (np.sin(theta) - bore.radius)
        return centre + joint.radius_ratio * _cylindrical(radius, phi, np.cos(theta))

    def in_socket(points, radius):
        theta, phi = points.T
        return radius * _cylindrical(np.sin(theta), phi, np.cos(theta))

    step = (np.pi / 2 - rim) / resolution
    count = round(_AROUND_SCALE * np.log1p(np.pi / _AROUND_SCALE) / step)
    around, of_socket = graded(np.pi, _AROUND_SCALE, count), _even(rim, np.pi / 2, step)
    of_ball = np.append(_even(face, rim, step)[:-1], of_socket)
    shares = 1 - graded(1, _DEPTH_SCALE / (1 - bore.radius), 2 * shells)
    radii = 1 + graded(joint.socket_ratio - 1, _DEPTH_SCALE, shells)
    points, quads = _ring(of_ball, around)
    ball, after = body("BALL", points, quads[:, ::-1], len(quads), shares, in_ball, (1, 1))
    points, quads = _ring(of_socket, around)
    middle = len(of_ball), after[0] + resolution  # nodes of ball and socket, where phi = 0
    lines = [
        *ball,
        *body("SOCKET", points, quads, len(quads), radii, in_socket, after)[0],
        *("*NSET, NSET=READ", *(f"{k - n}," for k in middle for n in (resolution, 0))),
        *solution(joint, depth_star * centre, penalty, _PLANES)[:-1],
        *("*EL FILE, NSET=READ, FREQUENCY=1000", "S", "*END STEP"),
    ]
    return "\n".join(lines) + "\n"


def _even(first, last, step):
    """Angles in equal steps that are not longer than ``step``."""
    return np.linspace(first, last, int(np.ceil((last - first) / step - 1e-9)) + 1)


def _cylindrical(radius, phi, z):
    return np.column_stack([radius * np.cos(phi), radius * np.sin(phi), z])


def _ring(theta, phi):
    """Points (theta, phi) of a patch, and its quadrilaterals."""
    points = np.stack(np.meshgrid(phi, theta, indexing="ij")[::-1], axis=2)
    return points.reshape(-1, 2), patch(np.arange(points[..., 0].size).reshape(points.shape[:2]))
