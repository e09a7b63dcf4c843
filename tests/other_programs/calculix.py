"""The joint in CalculiX: axisymmetric triangles, frictionless contact by penalty.

Bodies and meshes are those of `study.joint.meridian`; the search, integration and solution of the
contact are CalculiX's, on moved surfaces. Lengths are in socket radii R2 and stresses in E*;
the deck's x is r and its y is z.
"""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from study import checks
from study.joint import meridian, modes

CONTACTS = {"surface": "SURFACE TO SURFACE", "node": "NODE TO SURFACE"}
PENALTY = 5000.0
TIMEOUT = 1800.0  # s
_SECTORS = 180  # an axisymmetric element stands for a sector of 2 degrees
_TOTAL = re.compile(r"total force \(fx,fy,fz\) for set BALLEQUATOR and time\s+\S+\s+\S+\s+(\S+)")


def version() -> str | None:
    """Version of the installed CalculiX, such as ``2.20``, or None if there is none."""
    program = shutil.which("ccx")
    if program is None:
        return None
    said = subprocess.run([program, "-v"], capture_output=True, text=True, timeout=60, check=False)
    number = re.search(r"Version\s+(\S+)", said.stdout)
    return number and number.group(1)


def force_curve(joint, depth_star, *mesh, **how):
    """Dimensionless force P/(E* dR^2) at given depths >= 0, in any order: one step for each.

    Arguments are those of `deck`. Raises `study.checks.StudyError` if CalculiX is missing, fails
    or takes too long.
    """
    depths = np.atleast_1d(depth_star)
    ordered, places = np.unique(depths, return_inverse=True)
    touching = ordered > 0
    text = deck(joint, ordered[touching], *mesh, **how)
    force = np.zeros(ordered.shape)
    if touching.any():
        force[touching] = _SECTORS * joint.r2_star**2 * run(text, np.count_nonzero(touching))
    return force[places]


def deck(
    joint, depth_star, resolution=64, nodes=6, penalty=PENALTY, contact="surface", large=False
):
    """CalculiX's input for increasing depths > 0 over dR.

    The joint has ``linear`` kinematics, a hemispherical socket that is held at its whole outside or
    at the face of its rim, and the ball support ``guided`` or ``clamped``. The ``resolution`` is
    the number of elements along the surface, a multiple of 16; they have 6 ``nodes`` (CAX6) or 3
    (CAX3). The ``penalty`` is pressure per overclosure, in E*/R2: at R2* = 200 with CAX6 it costs
    0.2 % of the force at 1000 and 0.03 % at 6000; from about 15,000 on some depths end 0.2 to 2.8 %
    too low although CalculiX reports convergence. The ``contact`` is from ``surface`` to surface,
    or from ``node`` to surface, which takes a sixth of the time and scatters by up to 0.8 %.
    Displacements are ``large`` ones (NLGEOM), or small ones with contact on moved surfaces.
    """
    checks.choice("kinematics", joint.kinematics, ("linear",))
    checks.choice("ball_support", str(joint.ball_support), ("guided", "clamped"))
    checks.choice("socket_support", str(joint.socket_support), ("outside", "rim"))
    bodies = joint.ball_body, joint.socket_body
    ball, socket = (modes.meshed(body, resolution, nodes).mesh for body in bodies)
    ratios, poissons, moduli = joint.socket_body.layers
    radius, clearance = joint.radius_ratio, 1 / joint.r2_star
    lines = [
        *_body("BALL", ball, radius * ball.doflocs + [[0], [clearance]], (1, 1)),
        *_body("SOCKET", socket, socket.doflocs, (1 + ball.doflocs.shape[1], 1 + ball.nelements)),
    ]
    of_ball, of_socket = joint.modulus_shares
    lines += material("BALL", 1 / of_ball, joint.ball.poisson)
    layer = meridian.layer_of(socket, ratios)
    for k, (poisson, modulus) in enumerate(zip(poissons, moduli, strict=True)):
        lines += [f"*ELSET, ELSET=LAYER{k}"]
        lines += [f"{i}," for i in np.flatnonzero(layer == k) + 1 + ball.nelements]
        lines += material(f"LAYER{k}", modulus / of_socket, poisson)
    lines += [
        *pair(penalty, contact),
        *("*BOUNDARY", "BALLAXIS, 1, 1", "SOCKETAXIS, 1, 1"),
        f"SOCKET{str(joint.socket_support).upper()}, 1, 2",
        *(["SOCKETRIM, 2, 2"] if joint.rim == "mirror" else []),
        *(["BALLEQUATOR, 1, 1"] if str(joint.ball_support) == "clamped" else []),
    ]
    for depth in depth_star:
        lines += [
            "*STEP, INC=1000" + (", NLGEOM" if large else ""),
            *("*STATIC", "1., 1."),
            *("*BOUNDARY", f"BALLEQUATOR, 2, 2, {depth * clearance:.12g}"),
            *("*NODE PRINT, NSET=BALLEQUATOR, TOTALS=ONLY, FREQUENCY=1000", "RF"),
            "*END STEP",
        ]
    return "\n".join(lines) + "\n"


def pair(penalty, contact):
    """Contact of ball and socket."""
    return [
        "*SURFACE INTERACTION, NAME=CONTACT",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{penalty:.12g}",
        f"*CONTACT PAIR, INTERACTION=CONTACT, TYPE={CONTACTS[contact]}",
        "BALLSURFACE, SOCKETSURFACE",
    ]


def material(name, modulus, poisson):
    """A material and the set of elements that have it."""
    return [
        *(f"*MATERIAL, NAME={name}", "*ELASTIC", f"{modulus:.12g}, {poisson:.12g}"),
        f"*SOLID SECTION, ELSET={name}, MATERIAL={name}",
    ]


def _body(name, mesh, places, first):
    """Nodes, elements, boundaries of one body, numbered from ``first`` (node, element) on.

    An element's nodes run counterclockwise, corners before midsides: 1, 2, 3, 12, 23, 31.
    """
    x, z = mesh.p[:, mesh.t]
    clockwise = (x[1] - x[0]) * (z[2] - z[0]) < (x[2] - x[0]) * (z[1] - z[0])
    elements = mesh.dofs.element_dofs.copy()
    turned = [0, 2, 1, 5, 4, 3][: len(elements)]
    elements[:, clockwise] = elements[:, clockwise][turned]
    sides = np.where(clockwise, mesh.t2f[::-1], mesh.t2f)
    lines = [f"*NODE, NSET={name}"]
    lines += [f"{i}, {x:.14g}, {z:.14g}" for i, (x, z) in enumerate(places.T, first[0])]
    lines += [f"*ELEMENT, TYPE=CAX{len(elements)}, ELSET={name}"]
    numbers = (elements.T + first[0]).tolist()
    lines += [", ".join(map(str, [i, *nodes])) for i, nodes in enumerate(numbers, first[1])]
    for boundary, facets in mesh.boundaries.items():
        side, element = np.nonzero(np.isin(sides, facets))
        if boundary == "surface":
            lines += [f"*SURFACE, NAME={name}SURFACE"]
            lines += [f"{i}, S{k}" for i, k in zip(element + first[1], side + 1, strict=True)]
        else:
            ends = [side, (side + 1) % 3, side + 3][: len(elements) // 3 + 1]
            lines += [f"*NSET, NSET={name}{boundary.upper()}"]
            lines += [f"{i}," for i in np.unique(elements[ends, element]) + first[0]]
    return lines


def run(text: str, count: int, total: re.Pattern[str] = _TOTAL) -> NDArray[np.float64]:
    """Reactions at the driven nodes, one row per step: by default the axial ones.

    ``total`` is searched in the printed results (``.dat``), after which come those of the mesh
    (``.frd``).
    """
    program = shutil.which("ccx")
    if program is None:
        raise checks.StudyError("ccx (Debian's calculix-ccx) is not installed")
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "joint.inp").write_text(text)
        try:
            options = {"capture_output": True, "text": True, "timeout": TIMEOUT, "check": False}
            one_thread = os.environ | {"OMP_NUM_THREADS": "1"}
            done = subprocess.run([program, "joint"], cwd=folder, env=one_thread, **options)
        except subprocess.TimeoutExpired as error:
            raise checks.StudyError(f"ccx took more than {TIMEOUT:g} s") from error
        results = [Path(folder, f"joint.{ending}") for ending in ("dat", "frd")]
        said = "".join(result.read_text() for result in results if result.exists())
    forces = total.findall(said)
    lines = [line.strip() for line in done.stdout.splitlines() if line.strip(" _\n")]
    wrong = [" ".join(lines[i : i + 2]) for i, line in enumerate(lines) if "*ERROR" in line]
    if done.returncode or wrong or len(forces) != count:
        reason = (wrong[:1] or lines[-1:] or ["no output"])[0]
        raise checks.StudyError(f"ccx failed with {len(forces)} of {count} depths solved: {reason}")
    return np.array(forces, dtype=float)
