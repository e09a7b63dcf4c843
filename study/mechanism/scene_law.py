"""A contact law in a scene: with the scene's materials, and described in words.

The socket's thickness and supports are not in the scene: they are options of a law.
"""

from inspect import signature
from math import isclose
from typing import Any

import numpy as np

from study import checks
from study.contact import SOCKET_RATIO, JointLaw, Material
from study.contact.laws import Law, find
from study.mechanism.scene import Scene

SAME = 1e-6  # relative difference of the sizes and materials of a law and of a scene
FITTED = ("liu", "winkler", "hyperbolic_winkler", "power")
"""Laws of the paper whose coefficients were fitted in a joint of `PAPER_MATERIALS`."""
PAPER_MATERIALS = {"modulus_ratio": 1.0, "poisson": 0.3, "socket_poisson": 0.3}


def materials(ball: Material, socket: Material) -> dict[str, float]:
    """Materials as options of a law: modulus ratio, Poisson's ratios of ball and socket."""
    values = socket.youngs_modulus / ball.youngs_modulus, ball.poisson, socket.poisson
    return dict(zip(PAPER_MATERIALS, values, strict=True))


def in_scene(scene: Scene, law: Any, given: dict[str, Any]) -> tuple[Law, dict, float, str]:
    """A law of `simulate` without dimensions, all its options, its E* in Pa, and all in words.

    A law of another joint, or of other materials, than the scene's is a ``ValueError``.
    """
    if not isinstance(law, str) or law == "tabulated":
        law, given = _with_dimensions(scene, law, given)
    if not isinstance(law, JointLaw):
        law, modulus = find(law), scene.composite_modulus
        return law, options(scene, law, given), modulus, in_words(scene, law, given)
    radius, clearance, modulus = law.clearance * law.r2_star, law.clearance, law.composite_modulus
    sizes = scene.socket_radius, scene.clearance, scene.crank_clearance or scene.clearance
    if not np.allclose(sizes, (radius, clearance, clearance), SAME, 0):
        wanted = f"give Scene(socket_radius={radius:.9g}, clearance={clearance:.9g})"
        raise checks.RangeError(f"law must be of all clearance joints, the crank's too: {wanted}")
    law, given = law.dimensionless, law.options | given
    words = in_words(scene, law, given)
    if not isclose(modulus, scene.composite_modulus, rel_tol=SAME):
        bodies = [] if law.joint is None else [*law.joint.materials.values()]
        if scene.materials not in (Scene().materials, (*bodies[:1], *bodies[-1:])):
            wanted = f"the scene's, {scene.composite_modulus:.9g} Pa, or its materials left out"
            raise checks.RangeError(f"modulus E* of law must be {wanted}, got {modulus:.9g} Pa")
        words += f"; with its own composite modulus, {modulus:.9g} Pa"
    return law, given, modulus, words


def _with_dimensions(scene, law, given):
    """A law and its options; the table of a `DimensionalJoint`, or of the scene's joint."""
    from study.joint import DimensionalJoint  # other laws by name need no solver

    if isinstance(law, str):
        for name in given:
            known = ("wall" if "wall" in given else "socket_ratio"), "liner"
            checks.choice("option of tabulated", name, known)
        ratio = checks.number("socket_ratio", given.get("socket_ratio", SOCKET_RATIO), scalar=True)
        wall = given.get("wall", (ratio - 1) * scene.socket_radius)
        sizes = scene.socket_radius, scene.clearance, wall
        law, given = DimensionalJoint(*sizes, *scene.materials, given.get("liner", ())), {}
    return law.law() if isinstance(law, DimensionalJoint) else law, given


def options(scene: Scene, law: Law, given: dict[str, Any]) -> dict[str, Any]:
    """Options of a law: those given, the scene's materials, and by default the paper's thickness.

    A law, or an option, of other materials than the scene's is a ``ValueError``.
    """
    own = materials(*scene.materials)
    known = own.keys() & signature(law.parts).parameters.keys()
    stated = {name: given[name] for name in known if given.get(name) is not None}
    if law.joint is not None:
        stated = materials(law.joint.ball, law.joint.socket)
    for name, value in stated.items():
        what = f"{name} of law {law.__name__}"
        if not isclose(checks.number(what, value, scalar=True), own[name], rel_tol=SAME):
            raise checks.RangeError(f"{what} must be the scene's, {own[name]:.9g}, got {value:.9g}")
    has_thickness = "socket_ratio" in signature(law.parts).parameters
    usual = {"socket_ratio": SOCKET_RATIO} if has_thickness else {}
    return usual | given | {name: own[name] for name in known}


def in_words(scene: Scene, law: Law, given: dict[str, Any]) -> str:
    """A law with all of its options, those given and others; a remark if it is of another joint."""
    own, joint = materials(*scene.materials), law.joint
    if joint is not None:
        own = materials(joint.ball, joint.socket)
        used = {"r2_star": joint.r2_star, "socket_ratio": joint.socket_ratio}
        used |= joint.configuration | own | {"layers": joint.columns()["layers"] or None}
    else:
        parameters = list(signature(law.parts).parameters.values())[1:]
        used = {p.name: (own | given).get(p.name, p.default) for p in parameters}
    words = []
    for name, value in used.items():
        if value is not None:
            text = f"{value:.9g}" if isinstance(value, float) else str(value)
            own_of_paper = name == "socket_ratio" and joint is None and name not in given
            usual = " (the paper's)" if own_of_paper else ""
            words.append(f"{name} {text}{usual}")
    papers = np.allclose([*own.values()], [*PAPER_MATERIALS.values()], SAME, 0)
    if not papers and law.__name__ in FITTED and given.get("coefficient") is None:
        words.append("its coefficient is that of the paper's joint, which has other materials")
    return f"{law.__name__}: {', '.join(words)}" if words else law.__name__
