"""The joint in CalculiX: axisymmetric triangles, contact by penalty between surfaces.

Bodies and meshes are those of `study.elastic.fem`; search, integration and solution of the
contact are CalculiX's. Lengths are in socket radii R2 and stresses in E*; r is its x, z its y.
"""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from study import checks
from study.elastic import fem

PENALTY = 100.0
CONTACTS = ("SURFACE TO SURFACE", "NODE TO SURFACE")
TIMEOUT = 600.0  # s
_SECTORS = 180  # an axisymmetric element stands for a sector of 2 degrees
_TOTAL = re.compile(r"total force .* for set DRIVEN and time\s+\S+\s+(\S+)\s+(\S+)\s+(\S+)")
_FREE = {"r": "1", "z": "2"}


def version():
    """Version of the CalculiX that is installed, as ``2.20``; None if there is none."""
    if shutil.which("ccx") is None:
        return None
    said = subprocess.run(["ccx", "-v"], capture_output=True, text=True, timeout=60, check=False)
    found = re.search(r"Version\s+(\S+)", said.stdout)
    return found.group(1) if found else None


def force_curve(
    joint, depth_star, resolution=64, nodes=6, penalty=PENALTY, contact=CONTACTS[0], raw=None
):
    depths = np.atleast_1d(checks.number("depth_star", depth_star, least=0))
    ordered, places = np.unique(depths, return_inverse=True)
    deck = deck_of(joint, ordered[ordered > 0], resolution, nodes, penalty, contact, **(raw or {}))
    forces = np.zeros(ordered.shape)
    forces[ordered > 0] = _SECTORS * joint.r2_star**2 * _run(deck, np.count_nonzero(ordered))
    return forces[places]


def deck_of(
    joint, depths, resolution, nodes, penalty, contact, controls="", initial=1.0, adjust=""
):
    r1, clearance = joint.ball_radius, 1 / joint.r2_star
    ball = fem.ball_mesh(resolution, nodes)
    socket = fem.socket_mesh(joint.socket_ratio, resolution, nodes)
    first, second = joint.modulus_shares
    n, e = ball.doflocs.shape[1], ball.t.shape[1]
    kind = f"CAX{nodes}"
    lines = ["*NODE"]
    lines += _body("BALL", ball, r1, clearance, 0, 0, kind)[0]
    lines = []
    parts_b = _body("BALL", ball, r1, clearance, 0, 0, kind)
    parts_s = _body("SOCKET", socket, 1.0, 0.0, n, e, kind)
    lines += parts_b[0] + parts_s[0]
    sets = parts_b[1]
    for name, share, poisson in (
        ("BALL", first, joint.ball.poisson),
        ("SOCKET", second, joint.socket.poisson),
    ):
        lines += [
            f"*MATERIAL, NAME={name}",
            "*ELASTIC",
            f"{1 / share:.14g}, {poisson:.14g}",
            f"*SOLID SECTION, ELSET={name}, MATERIAL={name}",
        ]
    h = np.pi / 2 / resolution
    lines += [
        "*SURFACE INTERACTION, NAME=CONTACT",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{penalty * resolution:.14g}",
        f"*CONTACT PAIR, INTERACTION=CONTACT, TYPE={contact}{adjust}",
        "BALLSURFACE, SOCKETSURFACE",
    ]
    lines += ["*BOUNDARY", "BALLAXIS, 1, 1", "SOCKETAXIS, 1, 1", "SOCKETOUTSIDE, 1, 2"]
    if joint.rim == "mirror":
        lines += ["SOCKETEQUATOR, 2, 2"]
    if joint.ball_drive == "clamped":
        lines += ["BALLEQUATOR, 1, 1"]
    nl = ", NLGEOM" if joint.kinematics == "finite" else ""
    for d in depths:
        lines += [
            f"*STEP, INC=1000{nl}",
            *([controls] if controls else []),
            "*STATIC",
            f"{initial}, 1.0",
            "*BOUNDARY",
            f"BALLEQUATOR, 2, 2, {d * clearance:.14g}",
            "*NODE PRINT, NSET=BALLEQUATOR, TOTALS=ONLY, FREQUENCY=1000",
            "RF",
            "*END STEP",
        ]
    return "\n".join(lines) + "\n"


def _body(name, mesh, radius, shift, n, e, kind):
    p = radius * mesh.doflocs
    p[1] += shift
    t = mesh.dofs.element_dofs if kind == "CAX6" else mesh.t
    t = t.copy()
    t2f = mesh.t2f.copy()
    x, y = mesh.p[:, mesh.t]
    neg = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]) < 0
    t[:, neg] = t[:, neg][[0, 2, 1] + ([5, 4, 3] if kind == "CAX6" else [])]
    t2f[:, neg] = t2f[:, neg][[2, 1, 0]]
    lines = [f"*NODE, NSET={name}"]
    lines += [f"{i}, {a:.14g}, {b:.14g}, 0" for i, (a, b) in enumerate(p.T, n + 1)]
    lines += [f"*ELEMENT, TYPE={kind}, ELSET={name}"]
    lines += [", ".join(map(str, [i, *el])) for i, el in enumerate((t.T + n + 1).tolist(), e + 1)]
    for b, facets in mesh.boundaries.items():
        if b == "surface":
            side, el = np.nonzero(np.isin(t2f, facets))
            lines += [f"*SURFACE, NAME={name}SURFACE"]
            lines += [f"{j + e + 1}, S{s + 1}" for s, j in zip(side, el)]
        else:
            ids = np.unique(mesh.facets[:, facets])
            if kind == "CAX6":
                ids = np.union1d(ids, mesh.dofs.facet_dofs[0, facets])
            lines += [f"*NSET, NSET={name}{b.upper()}"] + [f"{i + n + 1}," for i in ids]
    return lines, None


def _run(deck, count):
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "joint.inp").write_text(deck)
        out = subprocess.run(
            ["ccx", "joint"],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
            env=os.environ | {"OMP_NUM_THREADS": "1"},
        )
        global LAST
        LAST = out.stdout
        dat = Path(folder, "joint.dat").read_text()
        global STA
        STA = Path(folder, "joint.sta").read_text()
        global DAT
        DAT = dat
    vals = re.findall(
        r"total force .* set BALLEQUATOR and time\s+(\S+)\s+(\S+)\s+(\S+)\s+(\S+)", dat
    )
    if len(vals) != count:
        print(out.returncode, out.stdout[-1500:], dat)
    return np.array([float(v[2]) for v in vals])
