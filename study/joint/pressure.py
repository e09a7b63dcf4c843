"""Friction torque under the pressure of a solved contact.

The pressure is that of the frictionless joint, loaded along its axis: friction does not change it.
"""

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.joint.compliance import HatFunctions
from study.joint.curve import ForceCurve


def friction_radii(curve: ForceCurve) -> dict[str, NDArray[np.float64]]:
    """Friction radii, in R2, of a ball in ``spin`` about the load, and in ``tilt`` across it; (k,).

    That is the friction torque over coefficient of friction and force, if the whole contact slides
    (this study). A place of the contact is at n R from the ball's centre and slides along w x n,
    where w is the unit vector of the axis through this centre. The torque along w is mu times the
    integral of p R abs(w x n) dA. R is the radius of the surface on whose areas the force acts: the
    ball's, or for kinematics ``small`` the socket's. Hertz's pressure on a small radius a gives
    3 pi a/16 (``spin``) and R (``tilt``). A depth of 0 is a ``ValueError``.
    """
    from scipy.special import ellipe  # late: for this alone

    joint = curve.joint
    checks.number("depth_star of curve", curve.depth_star, above=0)
    hats = HatFunctions(curve.angles)
    radius = 1.0 if joint.kinematics == "small" else joint.ball_radius
    spin = hats.integrate(np.sin)  # of abs(w x n), or of its mean over the azimuth
    tilt = hats.integrate(lambda angle: 2 / np.pi * ellipe(np.sin(angle) ** 2))
    unit = radius / (curve.pressure @ hats.integrate(np.cos))
    return {"spin": unit * (curve.pressure @ spin), "tilt": unit * (curve.pressure @ tilt)}
