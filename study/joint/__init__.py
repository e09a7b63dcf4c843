"""A joint of two elastic bodies, and its force-depth curve by the elastic solution.

`Joint` describes the joint, and `Solution` holds what is solved. A body is described by its
`compliance`, for unit radius and unit Young's modulus. A curve for another R2*, modulus or depth
therefore takes milliseconds. For a ball or a socket that is symmetric about the equator the
compliance is a `series` of Legendre polynomials, each of which is solved exactly. Other supports
need finite elements: Fourier `modes` of bodies of revolution on a mesh of the `meridian`.

Pressure is piecewise linear in the polar angle. Pressure and gap are complementary in the weak
sense, so that the contact matrix is symmetric and positive definite. `kinematics` pairs the points
of the surfaces, and `complementarity` determines which of them touch. The edge of the contact lies
between two nodes; the force therefore converges with order 2 by either solver. `axial` presses the
ball along the axis, where contacts are `nested` in each other, and `tilted` in other directions.

`bearings` has the dimensions of catalogues, `supports` the supports of ball and socket, `stress`
the stresses inside the bodies, `yielding` first yield, and `limits` the model limits that a contact
exceeds.
"""

from study.contact import Material, material
from study.joint.axial import Solver
from study.joint.description import Layer, Liner
from study.joint.joint import Joint, reference_joint
from study.joint.kinematics import UnresolvedError
from study.joint.solution import LargestStress, Solution
from study.joint.supports import Kinematics, Rim
from study.joint.yielding import FirstYield, first_yield
