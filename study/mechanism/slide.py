"""Force of the slide on the slider, in one place for all models of the links.

The slide of the paper is smooth and exerts no force along its direction. A spring, a dashpot or a
load between slider and ground is written here, with its parameters in `study.mechanism.scene`:
rigid links, particles, beams and the ideal joint take force, derivatives, energy and loss from
here.
"""

from collections import namedtuple

from numba.extending import register_jitable

Slide = namedtuple("Slide", "force by_position by_speed energy loss")
"""Force along the slide in N, its derivatives by position and speed of the slider, elastic energy
in J, and lost power in W."""


@register_jitable
def slide(p, position, speed):
    """`Slide` at a position in m and a speed in m/s of the slider."""
    return Slide(0.0, 0.0, 0.0, 0.0, 0.0)
