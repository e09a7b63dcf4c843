"""Damping of the normal contact force: F_N = P(d) (1 + D d'/v0).

v0 is the approach speed at the start of the impact, kept until the surfaces part. D is the damping
factor; four rules give it from the coefficient of restitution cr.
"""

from collections.abc import Callable
from math import expm1, log1p
from typing import Literal

from study import checks

Damping = Literal["lankarani-nikravesh", "hunt-crossley", "flores", "exact"]
_SMALL = 1e-6  # damping factor below which the first order is exact to rounding
POWERS = range(2, 60)  # of a series that converges as 0.5^k


def exact(restitution: float) -> float:
    """Factor D with which a free impact has the restitution cr, whatever the force P(d).

    D (1 + cr) = ln((1+D)/(1-cr D)) follows from dv/dd of the free impact (this study).
    """
    from scipy.optimize import brentq  # its import takes a third of a second

    if restitution == 1:
        return 0.0
    if restitution > 0.8:  # series of the logarithms over D^2: no cancellation as cr -> 1

        def series(factor):
            return sum(((-1) ** (k + 1) + restitution**k) * factor ** (k - 2) / k for k in POWERS)

        return brentq(series, 0.0, 0.5, xtol=1e-15 * (1 - restitution))

    def factor(w):  # w = -ln(1 - cr D) reaches D -> 1/cr without cancellation
        return -expm1(-w) / restitution

    def surplus(w):
        return log1p(factor(w)) + w - (1 + restitution) * factor(w)

    high = (1 + restitution) / restitution
    return factor(brentq(surplus, 1e-3 * restitution, high, xtol=1e-15))


DAMPINGS: dict[Damping, Callable[[float], float]] = {
    "lankarani-nikravesh": lambda cr: 3 * (1 - cr**2) / 4,  # Eq. 31: for nearly elastic impacts
    "hunt-crossley": lambda cr: 3 * (1 - cr) / 2,  # exact to first order in 1 - cr (1975)
    "flores": lambda cr: 8 * (1 - cr) / (5 * cr),  # Flores, Machado, Silva & Martins (2011)
    "exact": exact,
}


def damping_factor(damping: Damping, restitution: float) -> float:
    """Damping factor D >= 0 by a rule of `DAMPINGS`; other rules are a ``ValueError``.

    The restitution is from 0 to 1. It is at least 0.001 for ``flores`` and ``exact``, whose D grows
    as 1/cr.
    """
    checks.choice("damping", damping, DAMPINGS)
    cr = checks.number("restitution", restitution, least=0, most=1, scalar=True)
    if damping in ("flores", "exact"):
        checks.number(f"restitution for damping {damping}", cr, least=1e-3)
    return DAMPINGS[damping](cr)


def delivered_restitution(factor: float) -> float:
    """Restitution cr that a damping factor D gives in a free impact.

    The root of D (1 + cr) = ln((1 + D)/(1 - cr D)) below 1/D, where the force would vanish.
    """
    if checks.number("factor", factor, least=0, scalar=True) < _SMALL:
        return 1.0 - 2 / 3 * factor
    from scipy.optimize import brentq

    def surplus(w):  # cr = (1 - e^-w)/D: no cancellation near 1/D
        return log1p(factor) + w - factor + expm1(-w)

    low = 1e-3 * factor / (1 + factor)
    return -expm1(-brentq(surplus, low, 1 + factor, xtol=1e-15)) / factor
