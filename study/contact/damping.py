"""Damping of the normal contact force: F_N = P(d) (1 + D d'/v0).

v0 is the approach speed at the start of the impact, kept until the surfaces part. D is the damping
factor; four rules give it from the coefficient of restitution cr. Only ``exact`` delivers it.
"""

from collections.abc import Callable
from functools import lru_cache
from math import inf, log1p
from typing import Literal

from study import checks

Damping = Literal["lankarani-nikravesh", "hunt-crossley", "flores", "exact"]
POWERS = range(2, 60)  # of a series that converges as 0.5^k


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root of a function that is < 0 at ``low`` and > 0 at ``high``, halved to the last digit."""
    while low < (middle := (low + high) / 2) < high:
        if function(middle) < 0:
            low = middle
        else:
            high = middle
    return high


def _surplus(factor: float, restitution: float) -> float:
    """Value of ln((1+D)/(1-cr D)) - D (1 + cr), over D^2 in a series: 0 where D delivers cr."""
    if factor <= 0.5:  # where the logarithms cancel
        return sum(((-1) ** (k + 1) + restitution**k) * factor ** (k - 2) / k for k in POWERS)
    back = restitution * factor
    return log1p(factor) - log1p(-back) - factor - back if back < 1 else inf


@lru_cache(maxsize=1024)
def exact(restitution: float) -> float:
    """Factor D with which a free impact has the restitution cr, whatever the force P(d).

    D (1 + cr) = ln((1+D)/(1-cr D)) follows from dv/dd of the free impact (this study).
    """
    if restitution == 1:
        return 0.0
    return _root(lambda factor: _surplus(factor, restitution), 0.0, 1 / restitution)


DAMPINGS: dict[Damping, Callable[[float], float]] = {
    "lankarani-nikravesh": lambda cr: 3 * (1 - cr**2) / 4,  # Eq. 31: for nearly elastic impacts
    "hunt-crossley": lambda cr: 3 * (1 - cr) / 2,  # exact to first order in 1 - cr (1975)
    "flores": lambda cr: 8 * (1 - cr) / (5 * cr),  # Flores, Machado, Silva & Martins (2011)
    "exact": exact,
}


def damping_factor(damping: Damping, restitution: float) -> float:
    """Damping factor D >= 0 by a rule of `DAMPINGS`, for a restitution from 0 to 1.

    For ``flores`` and ``exact``, whose D grows as 1/cr, the restitution is at least 0.001.
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
    factor = checks.number("factor", factor, least=0, scalar=True)
    return _root(lambda restitution: _surplus(factor, restitution), 0.0, 1.0)
