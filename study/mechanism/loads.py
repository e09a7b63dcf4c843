"""Loads on rigid links other than the forces of their joints: the drive's moment and the weights.

All models of rigid links take them from here. Links that an ideal joint pins together are a double
pendulum: then the crank has the coupler's weight at its end, and the coupler's moment is about this
pin. Links between two clearance joints are free bodies, and the coupler's moment is about its
centre.
"""

from collections import namedtuple

from numba.extending import register_jitable

Pose = namedtuple("Pose", "st ct sp cp slider height")
"""Where the links are: sines and cosines of the angles of crank and coupler, position of the
slider, and position of the coupler's end at the crank along y."""
Loads = namedtuple("Loads", "drive crank coupler fall slider")
"""Applied loads, or their derivatives: moment of the drive on the crank, unless its speed is given;
other moments about the crank's axis; moment on the coupler; acceleration of the coupler's centre
along y by its weight; force on the slider along its slide."""


@register_jitable
def applied(p, pose, pinned):
    """Loads on the links in a pose."""
    if pinned:
        return Loads(p.moment, -(p.g1 * pose.ct), -(p.g2 * pose.cp), -p.gravity, 0.0)
    return Loads(p.moment, -(p.own_g1 * pose.ct), 0.0, -p.gravity, 0.0)


@register_jitable
def change(p, pose, dtheta, dphi, dslider, pinned):
    """Derivatives of the loads by something that turns crank and coupler and moves the slider."""
    if pinned:
        return Loads(0.0, p.g1 * pose.st * dtheta, p.g2 * pose.sp * dphi, 0.0, 0.0)
    return Loads(0.0, p.own_g1 * pose.st * dtheta, 0.0, 0.0, 0.0)


@register_jitable
def work(p, pose, driven, pinned):
    """Work of the loads but for a constant; ``driven`` is that of the drive."""
    if pinned:
        return driven - p.g1 * pose.st - p.g2 * pose.sp
    return driven - (p.own_g1 * pose.st + p.m2 * p.gravity * (pose.height + 0.5 * p.l2 * pose.sp))
