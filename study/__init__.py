"""Contact force laws for spherical clearance joints.

The compliance of elastic bodies and the gap between them give a force-depth curve (`study.joint`).
Such curves form the dataset (`study.dataset`), to which the coefficients of the laws are fitted
(`study.dataset.fitting`, `study.contact`). The laws drive a mechanism (`study.mechanism`), and the
notebooks present the results.

Examples
--------
A joint with dimensions in SI units, and a bearing from a catalogue:

>>> import numpy as np
>>> from study import Joint, Material
>>> bronze = Joint(socket_radius=12.5e-3, clearance=40e-6, wall=6e-3, socket="bronze")
>>> print(f"{bronze.solve(force=3000).depth[0]:.4g} m")
4.232e-06 m
>>> Joint.of(bearing="GE 20 E", play="50um").solve(force=35e3).specific_load.round(-5)
array([1.006e+08])

A joint made from ratios, with normalised depths d/dR and forces P/(E* dR^2), and its laws:

>>> from study.choose import compare_laws
>>> solution = Joint.from_ratios(75, socket=Material(7e10, 0.33)).solve(depth_star=[0.1, 0.5])
>>> print(solution.force_star.round(2), solution.contact_half_angle_deg.round(1))
[ 6.59 95.69] [21.  44.9]
>>> laws = compare_laws(Joint.from_ratios(75, socket_ratio=1.4), deepest=0.5)
>>> print(laws[laws.error_bound <= 0.02].law.iloc[0])  # the cheapest one
stiffened_hertz

The crank-slider with a law by name, a joint with dimensions, or values of a function as its law:

>>> from study.contact import Table
>>> from study.mechanism import Scene, simulate
>>> len(simulate(Scene(restitution=0.9), law="hyperbolic_winkler", duration=0.02).impacts)
12
>>> depth = np.linspace(0.01, 1, 100) ** 2
>>> mine = Table.of_values(depth, 300 * depth**1.5, r2_star=200)
>>> response = simulate(law=mine, duration=0.002)
>>> response = simulate(Scene(socket_radius=12.5e-3, clearance=40e-6), law=bronze, duration=0.002)
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from study.joint import Joint, Material

__all__ = ["Joint", "Material"]


def __getattr__(name: str) -> Any:  # late: commands that need no joint start without it
    """`Joint` or `Material` of `study.joint`."""
    if name not in __all__:
        raise AttributeError(f"module 'study' has no attribute {name!r}")
    from study import joint

    return getattr(joint, name)
