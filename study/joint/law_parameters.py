"""Options of a law for a joint: what `stiffened_hertz` looks up, and what `power` is fitted to."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from study.contact import LAWS, Law, tabulated
from study.contact.power_fit import DEPTHS, USUAL_RANGE, fit_power
from study.joint.curve import whole_curve
from study.joint.definition import Joint


def law_parameters(
    law: Law,
    joint: Joint,
    depth_star: ArrayLike | None = None,
    force_star: ArrayLike | None = None,
) -> dict[str, Any]:
    """Options of a law for a joint; `RangeError` if the law is not for it.

    ``power`` is fitted to exact forces at the given depths, by default those of the solved joint
    from 0.05 to 0.5 clearances.
    """
    if law is LAWS["stiffened_hertz"]:
        return joint.correction_options()
    if law is not LAWS["power"]:
        return {}
    if depth_star is None or force_star is None:
        depth_star = np.geomspace(*USUAL_RANGE, DEPTHS)
        force_star = tabulated(whole_curve(joint, USUAL_RANGE[1]))(depth_star)
    fit = fit_power(depth_star, force_star)
    return {"coefficient": fit.coefficient, "exponent": fit.exponent}
