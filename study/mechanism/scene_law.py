"""A contact law in a scene: with the scene's materials, and described in words.

The socket's thickness and supports are not in the scene: they are options of a law.
"""

from inspect import signature
from math import isclose
from typing import Any

from study import checks
from study.contact import SOCKET_RATIO
from study.contact.laws import Law
from study.mechanism.scene import Scene

SAME = 1e-6  # relative difference of the materials of a law and of a scene
FITTED = ("liu", "winkler", "hyperbolic_winkler")
"""Laws of the paper whose coefficients were fitted in a joint of `PAPER_MATERIALS`."""
PAPER_MATERIALS = {"modulus_ratio": 1.0, "poisson": 0.3, "socket_poisson": 0.3}


def materials(scene: Scene) -> dict[str, float]:
    """Materials as options of a law: modulus ratio, Poisson's ratios of ball and socket."""
    ball, socket = scene.materials
    values = socket.youngs_modulus / ball.youngs_modulus, ball.poisson, socket.poisson
    return dict(zip(PAPER_MATERIALS, values, strict=True))


def options(scene: Scene, law: Law, given: dict[str, Any]) -> dict[str, Any]:
    """Options of a law: those given, the scene's materials, and by default the paper's thickness.

    Raises
    ------
    ValueError
        For a law, or an option, of other materials than the scene's.
    """
    own = materials(scene)
    known = own.keys() & signature(law.parts).parameters.keys()
    stated = {name: given[name] for name in known if given.get(name) is not None}
    if law.joint is not None:
        joint = law.joint
        values = joint.modulus_ratio, joint.ball.poisson, joint.socket.poisson
        stated = dict(zip(own, values, strict=True))
    for name, value in stated.items():
        what = f"{name} of law {law.__name__}"
        if not isclose(checks.number(what, value, scalar=True), own[name], rel_tol=SAME):
            raise checks.RangeError(f"{what} must be the scene's, {own[name]:.9g}, got {value:.9g}")
    has_thickness = law.joint is None and "socket_ratio" in signature(law.parts).parameters
    usual = {"socket_ratio": SOCKET_RATIO} if has_thickness else {}
    return usual | given | {name: own[name] for name in known}


def in_words(scene: Scene, law: Law, given: dict[str, Any]) -> str:
    """A law with all of its options, those given and others; a remark if it is of another joint."""
    own, joint = materials(scene), law.joint
    if joint is not None:
        of_joint = ["r2_star", "socket_ratio", "ball_drive", "rim", "kinematics"]
        of_joint += [] if joint.usual_supports else ["opening", "backing"]
        used = {name: getattr(joint, name) for name in of_joint}
        used |= own | {"layers": joint.layers_text or None}
    else:
        parameters = list(signature(law.parts).parameters.values())[1:]
        used = {p.name: (own | given).get(p.name, p.default) for p in parameters}
    words = []
    for name, value in used.items():
        if value is not None:
            text = value if isinstance(value, str) else f"{value:.9g}"
            own_of_paper = name == "socket_ratio" and joint is None and name not in given
            usual = " (the paper's)" if own_of_paper else ""
            words.append(f"{name} {text}{usual}")
    other_materials = any(
        not isclose(own[name], PAPER_MATERIALS[name], rel_tol=SAME) for name in own
    )
    if other_materials and law.__name__ in FITTED and given.get("coefficient") is None:
        words.append("its coefficient is that of the paper's joint, which has other materials")
    return f"{law.__name__}: {', '.join(words)}" if words else law.__name__
