"""A joint that is pressed off its axis, in CalculiX: bricks in space, contact by penalty.

Half of a whole ball on a rigid core or at a rigid neck, and half of its socket, are meshed beside
the plane of symmetry y = 0. Bricks have 20 nodes, all of them on spheres. Shells of bricks are thin
at the contact, and at the core: thick ones there make the force 4 % too large. So do wide bricks at
the edge of a neck. Displacements are small ones. Lengths are in socket radii R2 and stresses in E*.
"""

import re
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from other_programs import calculix
from study import checks
from study.joint import Joint
from study.joint.compliance import graded
from study.joint.supports import Core, Neck, WholeOutside

_TOTAL = re.compile(r"for set BALLHELD and time\s+\S+\s+(\S+)\s+\S+\s+(\S+)")
_ROUND = 0.5  # how far the square in the middle of a cap is bent to a disc
_RINGS = 0.6  # around it, over the elements of half its side
_DEPTH_SCALE = 0.15  # elements grow from this depth below the surface on
_NONE = 1e-12  # R2
_FACE = [0, 1, 2, 3, 8, 9, 10, 11]  # nodes of a brick on its first face
_EDGE = 0.05  # rad: elements grow from this distance from the edge of a neck on
_HOLE = 0.05  # radius of the hole in the middle of a ball at a neck, over that of the ball
_FAR, _GROWTH = np.radians(150), 0.3  # where the ball's second cap begins; growth towards it


def force(joint: Joint, depth_star: float, tilt: float, **mesh: float) -> NDArray[np.float64]:
    """Force along the displacement and across it, over E* dR^2; arguments as for `deck`."""
    (found,) = calculix.run(deck(joint, depth_star, tilt, **mesh), 1, _TOTAL)
    x, z = np.sin(np.radians(tilt)), np.cos(np.radians(tilt))
    return 2 * joint.r2_star**2 * np.array([[x, z], [z, -x]]) @ found  # two halves


def deck(joint, depth_star, tilt, resolution=3, shells=2, shift=0.3, penalty=3000.0):
    """CalculiX's input for one depth; the ball starts where it first touches.

    The joint has a core or a neck of 30 deg, ``linear`` kinematics, an opening below 90 deg, and a
    socket of one material. A ball at a neck has a small hole in its middle, free of traction. The
    ``resolution``, at least 3, is bricks along half the side of the square in the middle of the
    cup; ``shells`` are those of the socket, and half the ball's. By a ``shift`` of up to 0.4 bricks
    are smaller by (1 - shift)/(1 + shift) at the rim where phi = 0, and larger opposite.
    ``penalty`` is pressure per overclosure, in E*/R2.
    """
    support = joint.ball_support
    if support != Neck(180 - np.degrees(_FAR)):
        checks.instance("ball_support", support, Core)
    core = support.radius if isinstance(support, Core) else _HOLE
    checks.choice("kinematics", joint.kinematics, ("linear",))
    checks.instance("socket_support", joint.socket_support, WholeOutside)
    if joint.opening.is_ring:
        raise ValueError(f"opening must be that of a cup, got {joint.opening}")
    opening = np.radians(checks.number("opening", joint.opening.last, "deg", below=90))
    centre = np.array([np.sin(np.radians(tilt)), 0, np.cos(np.radians(tilt))]) / joint.r2_star
    half = (1 - core) / 2
    outer, inner = graded(half, _DEPTH_SCALE, shells), graded(half, core, shells)
    radii = joint.radius_ratio * np.append(1 - outer, core + inner[-2::-1])
    is_neck = isinstance(support, Neck)
    points, quads, near = _half_sphere(resolution, opening, shift, is_neck)
    in_ball = partial(_on_sphere, centre=centre)
    neck = len(quads) - near if is_neck else None
    ball, after = body("BALL", points, quads[:, ::-1], near, radii, in_ball, (1, 1), neck)
    points, quads = _cap(resolution, opening, shift, round(_RINGS * resolution))
    radii = 1 + graded(joint.socket_ratio - 1, _DEPTH_SCALE, shells)
    lines = [
        *ball,
        *body("SOCKET", points, quads, len(quads), radii, _on_sphere, after)[0],
        *solution(joint, depth_star * centre, penalty, ["BALLPLANE, 2, 2", "SOCKETPLANE, 2, 2"]),
    ]
    return "\n".join(lines) + "\n"


def solution(joint, displacement, penalty, planes):
    """Materials, contact, supports and the step that moves the ball, as lines of a deck."""
    of_ball, of_socket = joint.modulus_shares
    return [
        *calculix.material("BALL", 1 / of_ball, joint.ball.poisson),
        *calculix.material("SOCKET", 1 / of_socket, joint.socket.poisson),
        *calculix.pair(penalty, "surface"),
        *("*BOUNDARY", *planes, "SOCKETHELD, 1, 3"),
        *("*STEP, INC=1000", "*STATIC", "1., 1.", "*BOUNDARY"),
        *(f"BALLHELD, {k}, {k}, {part:.12g}" for k, part in enumerate(displacement, 1)),
        *("*NODE PRINT, NSET=BALLHELD, TOTALS=ONLY, FREQUENCY=1000", "RF", "*END STEP"),
    ]


def _cap(n, angle, shift, rings):
    """Half a cap about the pole: unit vectors, and quadrilaterals of them.

    A square of 2n by n, bent halfway to a disc, and rings of 4n around it. The points end with
    those of the rim, from phi = 0 to pi.
    """
    i, j = (x.ravel() for x in np.meshgrid(np.arange(-n, n + 1), np.arange(n + 1)))
    eighths = np.where(np.abs(i) < j, 2 - i / np.maximum(j, 1), j / np.where(i, i, 1) + 4 * (i < 0))
    disc = np.maximum(np.abs(i), j) * np.exp(0.25j * np.pi * eighths)
    square = ((1 - _ROUND) * (i + 1j * j) + _ROUND * disc) / (n + rings)
    number = np.arange(square.size).reshape(n + 1, 2 * n + 1)
    edge = np.concatenate([number[:n, -1], number[n, :0:-1], number[n::-1, 0]])
    share = np.arange(1, rings + 1)[:, None] / rings
    around = (1 - share) * square[edge] + share * np.exp(1j * np.linspace(0, np.pi, 4 * n + 1))
    quads = [patch(number), patch(np.vstack([edge, _numbers(square.size, around)]).T)]
    flat = np.append(square, around)
    flat = (flat + shift) / (1 + shift * flat)  # conformal: bricks stay about square
    return _vectors(angle * np.abs(flat), np.angle(flat)), np.vstack(quads)


def _half_sphere(n, angle, shift, neck=False):
    """`_cap`, rings and an opposite cap; and how many quadrilaterals are in the first two.

    Rings are narrow at the first cap, or with a ``neck`` at the second, where it is held.
    """
    points, quads = _cap(n, angle, shift, round(_RINGS * n))
    opposite, turned = _cap(n, np.pi - _FAR, shift, n // 2)
    rim = np.arange(len(points))[-4 * n - 1 :]
    phi = np.arctan2(points[rim, 1], points[rim, 0])
    length, size = _FAR - angle, angle / n
    count = int(np.ceil(np.log1p(_GROWTH * length / size) / np.log1p(_GROWTH)))
    theta = angle + graded(length, size / _GROWTH, count)[1:-1]
    if neck:
        theta = _FAR - graded(length, _EDGE, 3 * n)[-2:0:-1]
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    between, start = _numbers(len(points), theta), len(points) + theta.size
    last = start + len(opposite) + np.arange(-4 * n - 1, 0)
    band = patch(np.vstack([rim, between, last]).T)
    every = np.vstack([points, _vectors(theta.ravel(), phi.ravel()), opposite * [1, 1, -1]])
    return every, np.vstack([quads, band, turned[:, ::-1] + start]), len(quads) + len(band)


def _vectors(theta, phi):
    x, y, z = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)
    return np.column_stack([x, np.where(np.abs(y) < 1e-12, 0, y), z])


def _numbers(start, array):
    return start + np.arange(array.size).reshape(array.shape)


def patch(number):
    """Quadrilaterals of a structured patch of points."""
    corners = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    return np.column_stack([corner.ravel() for corner in corners])


def _on_sphere(points, radius, centre=0.0):
    """Positions on a sphere, of vectors of any length."""
    return centre + radius * points / np.linalg.norm(points, axis=1)[:, None]


def body(name, points, quads, near, shells, place, first, neck=None):
    """Nodes, bricks and sets of a body, numbered from ``first`` (node, brick) on; and the next.

    Positions are ``place(points, shell)``; half-way between two points or shells are the middles
    of edges. The body's surface is the first ``near`` quadrilaterals of the first shell. A brick's
    nodes are those of its first face, of its second one, the middles of both faces' edges, and
    those between the faces. Held is the last shell, or the last ``neck`` quadrilaterals of the
    first.
    """
    sides = np.sort(np.stack([quads, np.roll(quads, -1, axis=1)], axis=2), axis=2)
    edges, side = np.unique(sides.reshape(-1, 2), axis=0, return_inverse=True)
    side = side.reshape(-1, 4) + len(points)
    every = np.vstack([points, points[edges].mean(axis=1)])
    places = [[place(every, a), place(points, (a + b) / 2)] for a, b in pairwise(shells)]
    next_shell = len(every) + len(points)
    places = np.vstack([*(np.vstack(both) for both in places), place(every, shells[-1])])
    brick = np.hstack([quads, quads + next_shell, side, side + next_shell, quads + len(every)])
    bricks = np.vstack([brick + k * next_shell for k in range(len(shells) - 1)]) + first[0]
    numbers = np.arange(len(places)) + first[0]
    lines = [f"*NODE, NSET={name}"]
    lines += [
        f"{k}, {x:.14g}, {y:.14g}, {z:.14g}" for k, (x, y, z) in zip(numbers, places, strict=True)
    ]
    lines += [f"*ELEMENT, TYPE=C3D20, ELSET={name}"]
    for k, nodes in enumerate(bricks.tolist(), first[1]):
        lines += [", ".join(map(str, [k, *nodes[:10]])) + ",", ", ".join(map(str, nodes[10:]))]
    lines += [f"*SURFACE, NAME={name}SURFACE", *(f"{first[1] + k}, S1" for k in range(near))]
    _, across, along = np.abs(places.T) < _NONE
    held = numbers[-len(every) :] if neck is None else np.unique(brick[-neck:, _FACE]) + first[0]
    sets = {"HELD": held, "PLANE": numbers[across], "EQUATOR": numbers[along]}
    for what, nodes in sets.items():
        lines += [f"*NSET, NSET={name}{what}", *(f"{k}," for k in nodes)] if len(nodes) else []
    return lines, (first[0] + len(places), first[1] + len(bricks))
