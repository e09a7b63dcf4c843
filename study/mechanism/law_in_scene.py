"""A contact law in a scene: with the scene's materials, and described in a sentence.

The socket's thickness and supports are not in the scene: they are options of a law.
"""

from math import isclose
from typing import Any

import numpy as np

from study import checks
from study.contact import LAWS, SOCKET_RATIO, DimensionalLaw, Material
from study.contact.laws import Law, find
from study.mechanism.scene import Scene

SAME = 1e-6  # relative difference of the sizes and materials of a law and of a scene
PAPER_MATERIALS = {"modulus_ratio": 1.0, "poisson": 0.3, "socket_poisson": 0.3}
"""Of the joint in which default coefficients of laws were fitted."""
LAW = "stiffened_hertz"
"""Default law of a simulation."""


def materials(ball: Material, socket: Material) -> dict[str, float]:
    """Materials as options of a law: modulus ratio, Poisson's ratios of ball and socket."""
    values = socket.youngs_modulus / ball.youngs_modulus, ball.poisson, socket.poisson
    return dict(zip(PAPER_MATERIALS, values, strict=True))


def in_scene(scene: Scene, law: Any, given: dict[str, Any]) -> tuple[list[DimensionalLaw], str]:
    """A law of `simulate` in each clearance joint of the scene, and a sentence on it.

    A law of another joint, or of other materials, than the scene's is a ``ValueError``.
    """
    gaps = [gap for gap in (scene.clearance, scene.crank_clearance) if gap is not None]
    if not isinstance(law, str) or law == "tabulated":
        law, given = _with_dimensions(scene, law, given)
    if not isinstance(law, DimensionalLaw):
        law = find(law)
        laws = [in_joint(scene, law, gap, given) for gap in gaps]
        return laws, in_words(scene, law, given)
    if given:
        raise checks.RangeError(
            f"{', '.join(given)} does not apply to a law in SI units, which has its options; "
            "remove it"
        )
    sizes = law.socket_radius, *(law.clearance for _ in gaps)
    if not np.allclose([scene.socket_radius, *gaps], sizes, SAME, 0):
        wanted = f"socket_radius={law.socket_radius:.9g}, clearance={law.clearance:.9g}"
        raise checks.RangeError(
            "law must have the socket radius and the clearance of every clearance joint of the "
            f"scene; use Scene({wanted}), or another law"
        )
    modulus, words = law.composite_modulus, in_words(scene, law.law, law.options)
    if not isclose(modulus, scene.composite_modulus, rel_tol=SAME):
        joint = law.law.joint
        bodies = [] if joint is None else [*joint.materials.values()]
        if scene.materials not in (Scene().materials, (*bodies[:1], *bodies[-1:])):
            own = f"{scene.composite_modulus:.9g} Pa, that of the scene's materials"
            raise checks.RangeError(
                f"composite modulus E* of law must be {own}, got {modulus:.9g} Pa; use the same "
                "materials, or do not give the materials of the scene"
            )
        words += f"; with its own composite modulus, {modulus:.9g} Pa"
    _reaching_one_clearance(law)
    return [law] * len(gaps), words


def in_joint(
    scene: Scene, law: Law, clearance: float, given: dict[str, Any] | None = None
) -> DimensionalLaw:
    """A law in a joint of the scene with a clearance in m, its materials and options given."""
    sizes = {"ball_radius": scene.socket_radius - clearance, "socket_radius": scene.socket_radius}
    modulus = scene.composite_modulus
    values = options(scene, law, given or {})
    try:
        found = DimensionalLaw(law, **sizes, composite_modulus=modulus, **values)
    except checks.RangeError as error:
        more = "; use the law tabulated, which is valid for any joint" if law is LAWS[LAW] else ""
        raise checks.RangeError(f"{error}{more}") from None
    return _reaching_one_clearance(found)


def _reaching_one_clearance(law):
    """The law itself, if it does."""
    try:
        law.force(law.clearance)
    except checks.RangeError as error:
        raise checks.RangeError(
            f"law must be valid up to a depth of one clearance, but {error}"
        ) from None
    return law


def _with_dimensions(scene, law, given):
    """A law and its options; the table of a `study.joint.Joint`, or of the scene's joint."""
    from study.joint import Joint  # other laws by name need no solver

    if isinstance(law, str):
        for name in given:
            known = ("wall" if "wall" in given else "socket_ratio"), "liner"
            checks.choice("option of tabulated", name, known)
        ratio = checks.number("socket_ratio", given.get("socket_ratio", SOCKET_RATIO), scalar=True)
        wall = given.get("wall", (ratio - 1) * scene.socket_radius)
        sizes = scene.socket_radius, scene.clearance, wall
        law, given = Joint(*sizes, *scene.materials, given.get("liner", ())), {}
    return law.law() if isinstance(law, Joint) else law, given


def options(scene: Scene, law: Law, given: dict[str, Any]) -> dict[str, Any]:
    """Options of a law: those given, the scene's materials, and by default the paper's thickness.

    A law, or an option, of other materials than the scene's is a ``ValueError``.
    """
    own = materials(*scene.materials)
    known = own.keys() & law.options.keys()
    stated = {name: given[name] for name in known if given.get(name) is not None}
    if law.joint is not None:
        stated = materials(law.joint.ball, law.joint.innermost)
    for name, value in stated.items():
        what = f"{name} of law {law.name}"
        if not isclose(checks.number(what, value, scalar=True), own[name], rel_tol=SAME):
            raise checks.RangeError(
                f"{what} must be {own[name]:.9g}, that of the scene's materials, got {value:.9g}"
            )
    usual = {"socket_ratio": SOCKET_RATIO} if "socket_ratio" in law.options else {}
    return usual | given | {name: own[name] for name in known}


def in_words(scene: Scene, law: Law, given: dict[str, Any]) -> str:
    """A law with all of its options, those given and others; a remark if it is of another joint."""
    own, joint = materials(*scene.materials), law.joint
    if joint is not None:
        own = materials(joint.ball, joint.innermost)
        used = {"r2_star": joint.r2_star, "socket_ratio": joint.socket_ratio}
        used |= joint.supports | own | {"layers": joint.columns()["layers"] or None}
    else:
        used = {name: (own | given).get(name, usual) for name, usual in law.defaults.items()}
    words = []
    for name, value in used.items():
        if value is not None:
            text = f"{value:.9g}" if isinstance(value, float) else str(value)
            own_of_paper = name == "socket_ratio" and joint is None and name not in given
            usual = " (that of the reference joint)" if own_of_paper else ""
            words.append(f"{name} {text}{usual}")
    papers = np.allclose([*own.values()], [*PAPER_MATERIALS.values()], SAME, 0)
    if not papers and law.fitted_to is not None and given.get("coefficient") is None:
        words.append("its coefficient is that of the reference joint, which has other materials")
    return f"{law.name}: {', '.join(words)}" if words else law.name
