"""Maximum contact force from states of the rigid links at times of a contact."""

from math import sqrt

import numpy as np

from study.compiled import compiled
from study.contact.forces import elastic_force
from study.measure import explicit
from study.measure.explicit import EX, EX_RATE, EY, EY_RATE
from study.mechanism.angles import norm


@compiled
def gap_and_rate(y, clearance):
    """Overlap of the surfaces, negative without one, and its rate."""
    r = norm(y[EX], y[EY])
    return r - clearance, (y[EX] * y[EX_RATE] + y[EY] * y[EY_RATE]) / r


@compiled
def _force(y, approach, p, law, work, out):
    """Normal force and its rate in a contact."""
    explicit.acceleration(y, True, approach, p, law, work, out)
    (depth, rate), r = gap_and_rate(y, law.clearance), norm(y[EX], y[EY])
    if depth <= 0:
        return 0.0, 0.0
    across = (y[EX] * y[EY_RATE] - y[EY] * y[EX_RATE]) / r
    growth = (y[EX] * out[EX] + y[EY] * out[EY]) / r + across * across / r
    (elastic, stiffness), loss = elastic_force(law, depth), p.damping / approach
    damped = 1 + loss * rate
    return elastic * damped, stiffness * rate * damped + elastic * loss * growth


@compiled
def largest(times, states, approach, p, law):
    """Largest maximum in N, inside the interval, of cubics through the forces and their rates.

    It is 0 if no force has a maximum.
    """
    work, out, found = np.zeros(6), np.zeros(3), 0.0
    force, growth = _force(states[0], approach, p, law, work, out)
    for i in range(1, len(times)):
        last, rising = force, growth
        force, growth = _force(states[i], approach, p, law, work, out)
        if rising > 0 and growth <= 0:
            h = times[i] - times[i - 1]
            mean = (force - last) / h
            c, d = 3 * mean - 2 * rising - growth, rising + growth - 2 * mean
            x = rising / (sqrt(c * c - 3 * d * rising) - c)  # rising + 2 c x + 3 d x^2 = 0
            found = max(found, last + h * x * (rising + x * (c + x * d)))
    return found
