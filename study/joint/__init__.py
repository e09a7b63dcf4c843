"""A joint of two elastic bodies, and its exact force-depth curve.

A body enters by its `compliance`, for unit radius and unit Young's modulus. A curve for another
R2*, modulus or depth therefore takes milliseconds. A ball or a socket that is symmetric about
the equator is solved exactly, order by order in Legendre polynomials (`series`). Other supports
take quadratic finite elements (`fem`).

Pressure is piecewise linear in the polar angle. Pressure and gap are complementary in the weak
sense, so that the contact matrix is symmetric and positive definite. `contact_kinematics` says
which points face each other, and `complementarity` which of them touch. The contact's edge lies
between two nodes; the force therefore converges with order 2 by either solver.

`supports` reads how ball and socket are held. `curve` solves given depths or a whole curve, whose
contacts are nested in each other (`nested_contact`), in some 30 ms; `large_displacement` goes
beyond linear bodies. `tilted` presses the ball off the axis: its pressure is a Fourier series in
the azimuth, each of whose modes is a problem in the meridian (`fourier`). `directional_law` is the
table of depth and tilt that follows. `stress` finds the stresses inside the bodies, and first
yield. `applicability` says which limits a contact exceeds, and `law_parameters` fits a law to a
joint. `dimensional` is a joint in SI units.
"""

from study.contact import Material, material
from study.joint.contact_kinematics import UnresolvedError
from study.joint.curve import ForceCurve, Solver, force_curve, whole_curve
from study.joint.definition import Joint, Layer, RatioJoint, paper_joint
from study.joint.dimensional import DimensionalJoint, DimensionalSolution, Liner
from study.joint.directional_law import DirectionalLaw, directional_law
from study.joint.stress import FirstYield, LargestStress, first_yield
from study.joint.supports import Kinematics, Rim
from study.joint.tilted import TiltedContact, tilted_contact, under_force
