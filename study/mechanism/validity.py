"""Which limits of its contact law a simulation exceeds, in words."""

from study import checks
from study.contact import LAWS, SOCKET_RATIO
from study.joint import Joint, applicability, first_yield
from study.mechanism.response import Response
from study.mechanism.scene import Scene


def exceeded_limits(
    scene: Scene, response: Response, socket_ratio: float = SOCKET_RATIO
) -> applicability.Limits:
    """Limits that the deepest contact exceeds: a key for each, and a sentence.

    Yield is looked for where a material has a yield stress, in a half ball that slides at its
    equator and a socket of the ratio given, held all over its outside.
    """
    deepest = response.impact_rows["peak_depth"].max(initial=0.0)
    if deepest == 0:
        return {}
    depth_star, (ball, socket) = deepest / scene.clearance, scene.materials
    name, *_ = response.law.split(":")
    law = LAWS.get(name)
    found: applicability.Limits = {}
    if law and law.fitted_to and depth_star > law.fitted_to:
        found["law"] = (
            f"The depth of {depth_star:.2g} clearances is beyond {law.fitted_to:g}, to which the "
            f"law {law.name} was fitted."
        )
    moduli = {"ball": ball.youngs_modulus, "socket": socket.youngs_modulus}
    found |= applicability.modulus_limit(moduli)
    try:
        joint = Joint(scene.socket_radius / scene.clearance, socket_ratio, ball, socket)
        found |= applicability.limits(joint, depth_star, 0.0, depth=deepest)
        yields = ball.yield_stress or socket.yield_stress
        first = first_yield(joint, min(depth_star, 1.0)) if yields else None
    except checks.RangeError as error:
        found["joint"] = f"The elastic solution is not for this joint, and not compared: {error}."
        return found
    if first is not None:
        found["yield"] = (
            f"The {first.body} yields from {first.depth_star:.2g} clearances on, of "
            f"{depth_star:.2g} that are reached. The law is elastic, and too stiff from there."
        )
    return found
