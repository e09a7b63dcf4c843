"""A joint as an element that a program for multibody dynamics has, instead of a function.

Exudyn's hollow sphere and Adams' IMPACT take the two numbers of the law ``power``. MuJoCo's spatial
tendon takes a cubic, which is fitted here to the solved joint in the maximum norm.
"""

import numpy as np
from scipy.optimize import linprog

from study.contact.power_fit import DEPTHS
from study.export.formulas import filled

MILLI = 1e-3


def exudyn(law, **texts):
    """Contact of a ball in a hollow sphere, with k and n."""
    sized, (coefficient, exponent) = law.sized, _power(law)
    texts |= {"socket_radius": f"{sized.socket_radius!r}", "coefficient": f"{coefficient:.9g}"}
    texts |= {"ball_radius": f"{sized.socket_radius - sized.clearance!r}"}
    return filled("sphere.exudyn", "# ", law.in_words(), exponent=f"{exponent:.9g}", **texts)


def adams(law, **texts):
    """The line of IMPACT, in N and mm."""
    coefficient, exponent = _power(law)
    texts |= {"clearance_mm": f"{law.sized.clearance / MILLI:.9g}", "exponent": f"{exponent:.9g}"}
    texts["coefficient_mm"] = f"{coefficient * MILLI**exponent:.9g}"
    return filled("impact.adams", "! ", law.in_words(), **texts)


def mujoco(law, **texts):
    """A spatial tendon with a cubic stiffness."""
    clearance, modulus = law.sized.clearance, float(law.joint.composite_modulus)
    depth = np.geomspace(law.least, law.deepest, DEPTHS)
    cubic, error = _cubic(depth, law.exact(depth))
    turns = np.roots([3 * cubic[2], 2 * cubic[1], cubic[0]])  # where its stiffness vanishes
    turn = turns[np.isreal(turns) & (turns.real > 0)].real.min(initial=np.inf)
    units = modulus * clearance ** np.array([1.0, 0.0, -1.0])
    numbers = {name: f"{x:.9g}" for name, x in zip("abc", cubic * units, strict=True)}
    beyond = "It increases with depth at every depth."
    if turn < np.inf:
        beyond = f"It must stay below {clearance * turn:.3g} m: deeper, it falls."
    texts |= {"clearance": f"{clearance!r}", "beyond": beyond} | numbers
    return filled("tendon.mujoco", "", law.in_words(error), **texts)


ELEMENTS = {"exudyn": exudyn, "adams": adams, "mujoco": mujoco}


def _power(law):
    """K in N/m^n, and n."""
    (exponent,) = law.constants
    clearance, modulus = law.sized.clearance, law.joint.composite_modulus
    return float(modulus * clearance ** (2 - exponent) * law.scale), float(exponent)


def _cubic(depth, force):
    """Coefficients of d, d^2, d^3 with the least maximum of the relative error, and that error."""
    columns = depth[:, None] ** [1, 2, 3] / force[:, None]
    ones = np.ones((len(depth), 1))
    upper, lower = np.hstack([columns, -ones]), np.hstack([-columns, -ones])
    limits = np.append(ones, -ones)
    signs = [(0, None), (0, None), (None, None), (0, None)]  # no pull where contact begins
    found = linprog([0, 0, 0, 1], np.vstack([upper, lower]), limits, bounds=signs)
    return found.x[:3], float(found.x[3])
