"""A contact law in a scene: with the scene's dimensions and materials."""

from __future__ import annotations

from math import isclose
from typing import Any

from study import checks
from study.contact import LAWS, SOCKET_RATIO, DimensionalLaw
from study.contact.laws import LIMIT_MARGIN, find
from study.joint import Joint
from study.mechanism.scene import Scene

SAME = 1e-6  # relative difference of the sizes and materials of a law and of a scene
LAW = "stiffened_hertz"  # default of a simulation


def clearance_joint(
    scene: Scene,
    *,
    wall: float | None = None,
    socket_ratio: float | None = None,
    liner: tuple = (),
) -> Joint:
    """The clearance joint of a scene, with a socket that is held at its whole outside.

    The wall of the socket in m, or the ratio of its radii, and its liners are no parameters of a
    scene. By default they are those of the reference joint: a ratio of 1.298, and no liner.
    """
    if wall is not None and socket_ratio is not None:
        raise ValueError("wall and socket_ratio must not both be given; remove one of them")
    if wall is None:
        ratio = SOCKET_RATIO if socket_ratio is None else socket_ratio
        wall = (checks.number("socket_ratio", ratio, scalar=True) - 1) * scene.socket_radius
    return Joint(scene.socket_radius, scene.clearance, wall, *scene.materials, liner)


def of_name(scene: Scene, law: str | None = None, **socket: Any) -> Any:
    """Law of a scene by its name, for a socket as of `clearance_joint`.

    The default is `LAW`, or the table of the elastic solution if the wall or liners are given.
    """
    socket = {name: value for name, value in socket.items() if value not in (None, ())}
    if not socket:
        return law or LAW
    law = law or (LAW if socket.keys() == {"socket_ratio"} else "tabulated")
    if not LAWS[checks.choice("law", law, LAWS)].needs_joint:
        raise ValueError(f"{next(iter(socket))} does not apply to the law {law}; remove it")
    return clearance_joint(scene, **socket).law(law)


def in_scene(scene: Scene, law: Any) -> DimensionalLaw:
    """A law of `simulate` in the scene's joint; one of another joint is a ``ValueError``."""
    if isinstance(law, Joint):
        law = law.law()
    if isinstance(law, str) and LAWS[checks.choice("law", law, LAWS)].needs_joint:
        law = clearance_joint(scene).law(law)
    if not isinstance(law, DimensionalLaw):
        law = find(law)
        if law.joint is not None:
            ball, socket = scene.materials
            ratio = socket.youngs_modulus / ball.youngs_modulus
            _check_same("modulus_ratio", law.joint.modulus_ratio, ratio)
            _check_same("poisson", law.joint.ball.poisson, ball.poisson)
            _check_same("socket_poisson", law.joint.innermost.poisson, socket.poisson)
        sizes = {name: getattr(scene, name) for name in ("ball_radius", "socket_radius")}
        law = DimensionalLaw(law, **sizes, composite_modulus=scene.composite_modulus)
    _check_same("socket radius in m", law.socket_radius, scene.socket_radius)
    _check_same("clearance in m", law.clearance, scene.clearance)
    # a liner has a modulus of its own, and a scene without materials takes those of the law
    bodies = () if law.joint is None else (law.joint.ball, law.joint.socket)
    if scene.materials not in (Scene().materials, bodies):
        _check_same("composite modulus E* in Pa", law.composite_modulus, scene.composite_modulus)
    if law.deepest < law.clearance * (1 - LIMIT_MARGIN):
        deep = f"but the law {law.name} is valid up to {law.deepest:.4g} m"
        raise checks.RangeError(f"law must be valid up to a depth of one clearance, {deep}")
    return law


def _check_same(name, value, expected):
    """Raise `RangeError` if a size or a material of a law is not that of the mechanism."""
    if not isclose(value, expected, rel_tol=SAME):
        raise checks.RangeError(
            f"{name} of the law must be {expected:.9g}, that of the mechanism, got {value:.9g}; "
            "change the mechanism, or use another law"
        )
