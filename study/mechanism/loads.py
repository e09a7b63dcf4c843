"""Loads of the mechanism in one form for all models: moments on the crank, forces on the slider.

A `Load` acts along a coordinate: the angle of the crank, or the position of the slider. Models take
its value and derivatives for their steps, and its energy and power for the energy balance: the work
of a load since t = 0 is the integral of its power over time less the change of its energy.

A new load is a function like `drive`, which `on_crank` or `on_slider` calls. It uses operators and
functions of NumPy only, because the ideal mechanism has arrays of places, and returns floats. The
weight is no `Load`: it is an acceleration, -gravity along y, of the masses of each model.
"""

from collections import namedtuple

from numba.extending import register_jitable

PARAMETERS = [  # of `Scene`, that are also in `p`
    "gravity",
    # parameters of further loads
]
Load = namedtuple("Load", "value by_place by_rate energy power")
"""A force in N or a moment in N m, and its derivatives by the place (m or rad) and by its rate.

``energy`` in J is the potential energy of the conservative part, of which the value is the negative
derivative by the place. ``power`` in W is that of the other part, its value times the rate."""
NO_LOAD = Load(0.0, 0.0, 0.0, 0.0, 0.0)


@register_jitable
def drive(p, angle, speed):
    """Constant moment of the drive; 0 for a crank of constant speed."""
    return Load(p.moment, 0.0, 0.0, -p.moment * angle, 0.0)


@register_jitable
def on_crank(p, angle, speed):
    """Moment on the crank about its axis."""
    return _total(
        drive(p, angle, speed),
        # further loads on the crank
    )


@register_jitable
def on_slider(p, position, speed):
    """Force on the slider along x."""
    return _total(
        NO_LOAD,
        # further loads on the slider
    )


@register_jitable
def _total(*loads):
    """Sum of loads on one body."""
    value = by_place = by_rate = energy = power = 0.0
    for load in loads:
        value = value + load.value  # no +=, which would change an array of places
        by_place, by_rate = by_place + load.by_place, by_rate + load.by_rate
        energy, power = energy + load.energy, power + load.power
    return Load(value, by_place, by_rate, energy, power)
