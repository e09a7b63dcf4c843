"""SUNDIALS' CVODE on the rigid links, called from C: equations, derivatives and roots compiled.

``gcc`` builds `cvode.c`, beside this module, with SUNDIALS 6 where both are found (Debian's
libsundials-dev). It is called in this process, and so timed like the study's own stepper.
"""

import ctypes
import hashlib
import re
import shutil
import subprocess
from functools import cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from study import checks, paths
from study.measure import explicit
from study.mechanism import Scene

Coordinates = Literal["Cartesian", "contact"]
SOURCE = Path(__file__).with_suffix(".c")
FLAGS = ("-O3", "-march=native", "-fPIC", "-shared", "-Wl,-z,defs")
LIBRARIES = ("-lsundials_cvode", "-lsundials_nvecserial", "-lm")
SCALES = {  # absolute tolerances of (z, z') over the tolerance, in flight and in contact
    "Cartesian": (1e-2, 5e-6, 5e-6, 1.0, 1e-3, 1e-3, 1e-2, 5e-6, 5e-6, 1.0, 1e-3, 1e-3),
    "contact": (1e-1, 1e-5, 1e-5, 1.0, 1e-3, 1e-2, 1e-2, 1e-7, 1.0, 1.0, 1e-2, 1e3),
}
RELATIVE = 1e-2  # relative tolerance over the tolerance
ORDER, NEWTON = 5, 0.03  # highest order, and coefficient of Newton's convergence
"""With these and `SCALES` CVODE was the quickest at equal error, of the values tried."""


@cache
def version() -> str | None:
    """Version of the SUNDIALS that programs are built with here, or None without it or gcc."""
    if shutil.which("gcc") is None:
        return None
    text = "#include <cvode/cvode.h>\nSUNDIALS_VERSION"
    options = {"input": text, "capture_output": True, "text": True, "check": False}
    said = subprocess.run(["gcc", "-E", "-P", "-"], **options).stdout
    number = re.search(r'"(6\.[\d.]+)"\s*$', said)
    return number and number.group(1)


@cache
def _library():
    """The program, built anew when its source changed."""
    if version() is None:
        raise checks.StudyError("gcc or SUNDIALS 6 (Debian's libsundials-dev) is not installed")
    digest = hashlib.sha256(SOURCE.read_bytes() + str((FLAGS, version())).encode()).hexdigest()
    built = paths.BUILD / "other_programs" / f"cvode-{digest[:16]}.so"
    if not built.exists():
        with paths.whole(built) as temporary:
            order = ["gcc", *FLAGS, "-o", str(temporary), str(SOURCE), *LIBRARIES]
            done = subprocess.run(order, capture_output=True, text=True, check=False)
            if done.returncode:
                raise checks.StudyError(f"gcc failed: {done.stderr.strip()}")
    run = ctypes.CDLL(str(built)).run
    numbers, number, count = np.ctypeslib.ndpointer(float), ctypes.c_double, ctypes.c_int
    run.argtypes = [numbers, number, numbers, count, number, count]
    run.argtypes += [number, numbers, number, count, numbers, ctypes.c_void_p]
    return run


def slider_acceleration(
    scene: Scene,
    law: np.record,
    duration: float,
    outputs: int,
    tolerance: float,
    coordinates: Coordinates = "contact",
) -> tuple[NDArray[np.float64], int]:
    """Slider's acceleration at equally spaced times, in m/s^2, and the number of evaluations.

    The law is a record of Hertz's (`study.contact.DimensionalLaw.packed`). The coordinates are
    those of contact: ``Cartesian`` as in flight, or ``contact`` for depth and direction. Raises
    `study.checks.StudyError` if gcc or SUNDIALS is missing, or CVODE fails.
    """
    found = _run(scene, law, duration, outputs, tolerance, coordinates, None)
    return found[:-1], int(found[-1])


def largest_forces(
    scene: Scene, law: np.record, duration: float, tolerance: float
) -> NDArray[np.float64]:
    """Maximum normal force, and that of the first contact, in N, in contact coordinates."""
    peaks = np.zeros(2)
    _run(scene, law, duration, 1, tolerance, "contact", peaks.ctypes.data)
    return peaks


def _run(scene, law, duration, outputs, tolerance, coordinates, peaks):
    if law.shape_index != 0:
        raise ValueError(f"law must be Hertz's, packed, got shape {law.shape_index}")
    start, scales = explicit.start_of(scene), np.array(SCALES[coordinates])
    how: list[Any] = [duration, outputs, RELATIVE * tolerance, tolerance * scales, NEWTON, ORDER]
    constants, found = np.array(scene.constants()), np.empty(outputs + 1)
    status = _library()(constants, law.scale, start, coordinates == "contact", *how, found, peaks)
    if status < 0:
        raise checks.StudyError(f"CVODE failed with status {status} (cvode.h) at {tolerance:g}")
    return found
