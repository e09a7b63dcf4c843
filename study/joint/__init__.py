"""A joint of two elastic bodies, and its force-depth curve by the elastic solution.

A body is described by its `compliance`, for unit radius and unit Young's modulus. A curve for
another R2*, modulus or depth therefore takes milliseconds. For a ball or a socket that is symmetric
about the equator the compliance is a series of Legendre polynomials, each of which is solved
exactly (`series`). Other supports need quadratic finite elements (`fem`).

Pressure is piecewise linear in the polar angle. Pressure and gap are complementary in the weak
sense, so that the contact matrix is symmetric and positive definite. `contact_kinematics` pairs the
points of the surfaces, and `complementarity` determines which of them touch. The edge of the
contact lies between two nodes; the force therefore converges with order 2 by either solver.

`supports` has the supports of ball and socket. `curve` solves given depths, or in about 30 ms a
whole curve, whose contacts are nested in each other (`nested_contact`); `large_displacement` is for
large displacements. `tilted` presses the ball off the axis, where the pressure is a Fourier series
in the azimuth, each mode of which is a problem in the meridian (`fourier`). `directional_law` is
the resulting table over depth and tilt. `stress` computes the stresses inside the bodies and first
yield. `applicability` lists the model limits that a contact exceeds, and `law_parameters` fits a
law to a joint. `dimensional` is a joint in SI units.
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
