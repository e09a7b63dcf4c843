"""What holds ball and socket: how the ball is displaced, where the socket is backed, and its mouth.

Each is a short text or a number, as it is typed. This module reads and checks them, and
`study.joint.fem` meshes what they describe. Angles are polar angles in deg, from the pole that the
ball is pressed into.
"""

from typing import Literal, get_args

import numpy as np

from study import checks

Rim = Literal["mirror", "free"]
"""What holds the socket's edge: a mirror plane, or nothing."""
RIMS: tuple[Rim, ...] = get_args(Rim)
HALF_BALLS = ("plane", "clamped", "point")
"""Drives of half a ball, by its equatorial plane or its centre."""
DRIVES = (*HALF_BALLS, "core:NUMBER", "neck:NUMBER")
"""Every drive, as it is typed."""
BACKINGS = ("whole", "rim")
"""Backings that need no angles: the outside all over, or the face of the rim alone."""
OPENING = 90.0
"""Opening of a hemispherical socket, in deg."""
SUPPORTS = ("ball_drive", "rim", "kinematics", "opening", "backing")
"""Attributes of a joint that say how it is held, and which points of it face each other."""
OPENINGS = (30.0, 170.0)
CORES, NECKS = (0.05, 0.8), (5.0, 90.0)
CLEAR = 5.0  # deg: least angle between neck and mouth
_LEAST_SEAT = 5.0  # deg: a narrower one is smaller than the elements outside


def drive(text: str) -> tuple[str, float]:
    """Kind of a ball's drive, and its number: of ``core:0.2`` the core's radius over R1.

    Of ``neck:30`` the neck's half-angle in deg, from the top; else 0. A text that is neither, or a
    number outside its range, is a ``ValueError``.
    """
    kind, colon, number = text.partition(":") if isinstance(text, str) else ("", "", "")
    if kind in HALF_BALLS and not colon:
        return kind, 0.0
    ranges = {
        "core": ("core of ball_drive", CORES, "R1"),
        "neck": ("neck of ball_drive", NECKS, "deg"),
    }
    if kind not in ranges or not colon:
        wanted = ", ".join(DRIVES)
        raise ValueError(f"ball_drive must be one of {wanted}, got {checks.shown(text)}")
    name, (least, most), unit = ranges[kind]
    return kind, checks.number(name, checks.read(name, number), unit, least=least, most=most)


def reach(opening: float) -> float:
    """Largest polar angle in rad of a contact along the axis: pi/2, or that of the mouth in deg."""
    return min(np.pi / 2, float(np.radians(opening)))


def seat(backing: str, opening: float) -> tuple[float, float] | None:
    """Polar angles, in deg, between which a backing such as ``60,90`` holds the socket's outside.

    None for ``whole`` and ``rim``. A ``ValueError`` for another text, or for angles that are not in
    order or beyond the opening.
    """
    if isinstance(backing, str) and backing in BACKINGS:
        return None
    try:
        low, high = checks.read_several("backing", backing, 2)
    except (ValueError, AttributeError):
        wanted = "whole, rim or two polar angles in deg, such as 60,90"
        raise ValueError(f"backing must be {wanted}, got {checks.shown(backing)}") from None
    checks.number("first angle of backing", low, "deg", least=0, most=opening - _LEAST_SEAT)
    least = low + _LEAST_SEAT
    checks.number("second angle of backing", high, "deg", least=least, most=opening)
    return low, high
