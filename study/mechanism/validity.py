"""Model limits of its contact law that a simulation exceeds, as sentences."""

from study import checks
from study.contact import SOCKET_RATIO
from study.joint import Joint, first_yield, limits
from study.mechanism.response import Response
from study.mechanism.scene import Scene


def exceeded_limits(
    scene: Scene, response: Response, socket_ratio: float = SOCKET_RATIO
) -> limits.Limits:
    """Model limits that the deepest contact exceeds: a key for each, and a sentence.

    Yield is checked if a material has a yield stress, for half a ball on a guided plate and a
    socket with the given ratio of its radii that is held at its whole outside.
    """
    deepest = response.impact_rows["peak_depth"].max(initial=0.0)
    if deepest == 0:
        return {}
    depth_star, (ball, socket) = deepest / scene.clearance, scene.materials
    law = response.law.law if response.law else None
    found: limits.Limits = {}
    if law and law.fitted_to and depth_star > law.fitted_to:
        found["law"] = (
            f"The penetration depth of {depth_star:.2g} clearances is greater than "
            f"{law.fitted_to:g}, the maximum to which the law {law.name} was fitted."
        )
    moduli = {"ball": ball.youngs_modulus, "socket": socket.youngs_modulus}
    found |= limits.modulus_limit(moduli)
    try:
        r2_star = scene.socket_radius / scene.clearance
        joint = Joint.from_ratios(r2_star, socket_ratio, ball=ball, socket=socket)
        found |= limits.limits(joint, depth_star, 0.0, depth=deepest)
        yields = ball.yield_stress or socket.yield_stress
        first = first_yield(joint, min(depth_star, 1.0)) if yields else None
    except checks.RangeError as error:
        found["joint"] = (
            f"The law was not compared with an elastic solution of this joint: {error}."
        )
        return found
    if first is not None:
        found["yield"] = (
            f"The {first.body} yields at depths above {first.depth_star:.2g} clearances, and "
            f"{depth_star:.2g} are reached. The law is elastic and therefore too stiff there."
        )
    return found
