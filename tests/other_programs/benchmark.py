"""The values of the benchmark by two sources, and entries with their times.

``PYTHONPATH=tests python -m other_programs.benchmark values CASE ...`` computes the rows of some
cases in ``data/benchmark.csv`` again, by default of all, and ``... entries CASE ...`` those in
``data/benchmark_entries.csv``. They need CalculiX, gcc with SUNDIALS 6, and Exudyn; all values
take about half an hour. For times on one core, set ``OMP_NUM_THREADS=1``.
"""

import datetime
import json
import os
import re
import sys
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from other_programs import absolute, calculix, calculix_ring, calculix_tilted, cvode, multibody
from study import dataset, paths
from study.contact import Hertz
from study.dataset import benchmark, store
from study.joint import Joint
from study.measure import explicit
from study.mechanism import Scene, simulate

QUANTITIES = {
    "hemisphere": ("force at 5 um", "force at 25 um", "force at 50 um"),
    "reference": ("force at 5 um", "force at 25 um", "force at 50 um"),
    "thin_socket": ("force at 5 um", "force at 25 um"),
    "lined_socket": ("force at 15 um", "force at 50 um"),
    "nearly_incompressible": ("force at 5 um", "force at 25 um"),
    "rim_held": ("force at 5 um", "force at 25 um"),
    "close_fit": ("force at 0.5 um", "force at 5 um"),
    "hip_off_axis": ("force at 40 um",),
    "ball_stud_off_axis": ("force at 20 um", "transverse force at 20 um"),
    "rod_end": ("force at 25 um", "pressure at 25 um"),
    "ideal_slider": (
        "crank angle at 0.1 s",
        "slider position at 0.1 s",
        "slider velocity at 0.1 s",
        "slider acceleration at 0.1 s",
    ),
    "first_impacts": (
        "time of impact 1",
        "approach speed of impact 1",
        "peak force of impact 1",
        "peak force of impact 3",
        "slider position at 0.02 s",
        "slider acceleration at 0.02 s",
    ),
    "constant_speed": (
        "time of impact 1",
        "approach speed of impact 1",
        "peak force of impact 1",
        "peak force of impact 3",
        "slider velocity at 0.01 s",
    ),
}
ON_AXIS = [*QUANTITIES][:7]
UNITS = {"force": "N", "pressure": "Pa", "time": "s", "angle": "rad", "position": "m"}
UNITS |= {"speed": "m/s", "velocity": "m/s", "acceleration": "m/s^2"}
DIGITS = {"joint": 6, "mechanism": 9}
FINEST = {"series": 1280, "quadratic": 320, "modes": 96}
PENALTY, STIFFER = 3000.0, 10_000.0
"""Of CalculiX's contact. The second one shows what the first costs, on the coarse mesh."""
ROUNDING = {"joint": 1e-5, "mechanism": 1e-8}
"""Minimum uncertainty: of the values as they are written."""


class Source(NamedTuple):
    """Values of a case by a program, their relative errors, and how the program was called."""

    name: str
    found: Any
    errors: Any = 0.0


def cases() -> pd.DataFrame:
    """Kind, description and arguments of each case, by its name."""
    return store.read(paths.DATA / "benchmark_cases.csv").set_index("case")


def arguments(case: str) -> dict[str, Any]:
    """Arguments of a joint or a scene, as `cases` has them."""
    return json.loads(cases().arguments[case])


def joint_of(case: str, other: bool = False) -> tuple[Joint, float | None]:
    """Joint of a case, and the tilt of its load; an ``other`` one has bodies that are not kept."""
    given = arguments(case)
    if other:
        given |= {"ball": "2e11,0.31", "wall": 1.01 * given["wall"], "socket": "1e11,0.32"}
    tilt = given.pop("tilt", None)
    return Joint(**given), tilt


def depths(case: str) -> np.ndarray:
    """Different depths of a joint's quantities, in m."""
    found = [quantity.split()[-2] for quantity in QUANTITIES[case]]
    return 1e-6 * np.unique(np.array(found, dtype=float))


def by_study(case: str, finest: bool = False, other: bool = False) -> Source:
    """Values of this study, at its default settings or the finest ones (`joint_of`)."""
    if cases().kind[case] == "mechanism":
        return _motion_by_study(case, 1e-12 if finest else None)
    joint, tilt = joint_of(case, other)
    how: dict[str, Any] = {"depth": depths(case), "tilt": tilt}
    found = usual = joint.solve(**how)
    if finest:
        found = joint.solve(**how, resolution=FINEST[found.solver])
    values, errors = found.force, found.error_estimate
    if case == "rod_end":
        pressure, coarse = (
            of.pressure[0, np.abs(of.angle_deg - tilt).argmin()] for of in (found, usual)
        )
        values = np.append(values, pressure)
        errors = np.append(errors, abs(coarse / pressure - 1))
    elif len(QUANTITIES[case]) > len(values):
        values = np.append(values, found.transverse)
        errors = errors * np.hypot(*values) / np.abs(values)
    name = {"series": "Legendre series", "quadratic": "axisymmetric finite elements"}
    name["modes"] = "finite elements of Fourier modes"
    return Source(f"this study, {name[found.solver]}", values, errors)


def _motion_by_study(case, tolerance):
    scene, ideal = scene_of(case)
    times, names = _times(case)
    kind: dict[str, Any] = {"joint": "ideal"} if ideal else {"tolerance": tolerance}
    last = max(times)
    found = simulate(scene, law="hertz", duration=last, outputs=1, **kind)
    rows = {last: {name: getattr(found, name.replace(" ", "_"))[-1] for name in names}}
    impacts = [] if ideal else found.impacts.to_dict("records")
    return Source("this study, rigid links", _picked(case, rows, impacts))


def scene_of(case: str) -> tuple[Scene, bool]:
    """Parameters of a mechanism, and whether its joint is ideal."""
    given = arguments(case)
    ideal = given.pop("joint", "clearance") == "ideal"
    return Scene(**given), ideal


MOTION = "crank angle", "crank speed", "slider position", "slider velocity", "slider acceleration"


def _times(case):
    """Times of a mechanism's quantities in s, and the names of those of motion."""
    at = [quantity.split(" at ") for quantity in QUANTITIES[case] if " at " in quantity]
    return sorted({float(when.split()[0]) for _, when in at}), [name for name, _ in at]


def _picked(case, rows, impacts):
    """Values of the quantities from rows of motion by time, and impacts."""
    values = []
    for quantity in QUANTITIES[case]:
        name, at, when = quantity.partition(" at ")
        if at:
            values.append(rows[float(when.split()[0])][name])
        else:
            name, number = quantity.split(" of impact ")
            values.append(impacts[int(number) - 1][name.replace(" ", "_")])
    return np.array(values, dtype=float)


def by_absolute_coordinates(case: str, tolerance: float = absolute.TOLERANCE) -> Source:
    """Values of `absolute`."""
    scene, ideal = scene_of(case)
    times, _ = _times(case)
    found, impacts = absolute.motion(scene, times, ideal, tolerance)
    rows = {t: dict(zip(MOTION, row, strict=True)) for t, row in zip(times, found, strict=True)}
    name = f"absolute coordinates with multipliers, SciPy's DOP853, tolerance {tolerance:.0e}"
    return Source(name, _picked(case, rows, impacts))


def by_calculix(case: str, mesh: int = 1, penalty: float = PENALTY) -> Source:
    """Values of CalculiX on its fine mesh, number 1, or its coarse one, number 0."""
    joint, tilt = joint_of(case)
    star = depths(case) / joint.clearance
    unit = joint.force_unit
    name = f"CalculiX {calculix.version()}"
    if tilt is None:
        resolution = (32, 64)[mesh]
        forces = calculix.force_curve(joint, star, resolution, penalty=penalty)
        return Source(f"{name}, axisymmetric CAX6, {resolution} along the surface", unit * forces)
    if case == "rod_end":
        resolution, shells = ((4, 2), (6, 3))[mesh]
        force, pressure, _ = calculix_ring.pressed(
            joint, star[0], resolution=resolution, shells=shells, penalty=penalty
        )
        values = np.array([unit * force, joint.pressure_unit * pressure])
    else:
        resolution, shells = ((3, 2), (4, 3))[mesh]
        values = unit * calculix_tilted.force(
            joint, star[0], tilt, resolution=resolution, shells=shells, penalty=penalty
        )
        values = values[: len(QUANTITIES[case])]
    return Source(f"{name}, bricks C3D20, mesh {resolution}, {shells}", values)


def by_published_series(case: str) -> Source:
    """Values of a Legendre series that is independent of this study (``published/joint.csv``)."""
    joint, _ = joint_of(case)
    stored = dataset.reference_forces()
    stored = stored[stored.source.str.startswith("Legendre")].set_index("depth_star")
    rows = stored.loc[np.round(depths(case) / joint.clearance, 9)]
    return Source(rows.source.iloc[0], joint.force_unit * rows.force_star, rows.trust.to_numpy())


def second(case: str) -> Source:
    """Values of the second source, with errors from two meshes or tolerances.

    The compliance of CalculiX's contact is extrapolated to zero for loads along the axis. A force
    that falls with it belongs to a wrong contact area (`calculix.deck`): then the force is not
    extrapolated, and the fall is counted as an error.
    """
    if case == "hemisphere":
        return by_published_series(case)
    if cases().kind[case] == "mechanism":
        coarse, fine = (by_absolute_coordinates(case, tolerance) for tolerance in (1e-10, 1e-12))
    else:
        coarse, fine = by_calculix(case, 0), by_calculix(case, 1)
    errors = np.abs(coarse.found / fine.found - 1)
    if case in ON_AXIS:
        stiffer = by_calculix(case, 0, STIFFER)
        change = (stiffer.found - coarse.found) / (1 - PENALTY / STIFFER)
        errors = np.maximum(errors, -change / fine.found)
        fine = fine._replace(found=fine.found + np.maximum(change, 0))
    return fine._replace(errors=errors)


def rows_of(case: str) -> pd.DataFrame:
    """Rows of ``data/benchmark.csv`` of a case."""
    kind = cases().kind[case]
    first, other = by_study(case, finest=True), second(case)
    if kind == "mechanism":
        coarse = _motion_by_study(case, 1e-10)
        first = first._replace(errors=np.abs(coarse.found / first.found - 1))
    columns = {
        "case": case,
        "quantity": QUANTITIES[case],
        "unit": [UNITS[re.split(" at | of ", of)[0].split()[-1]] for of in QUANTITIES[case]],
    }
    for number, source in enumerate((first, other), start=1):
        columns |= {
            f"source_{number}": source.name,
            f"value_{number}": _rounded(source.found, DIGITS[kind]),
            f"error_{number}": _rounded(np.maximum(source.errors, ROUNDING[kind]), 2),
        }
    frame = pd.DataFrame(columns)
    value = (frame.value_1 + frame.value_2) / 2
    errors = [np.abs(frame.value_1 - frame.value_2) / value.abs(), frame.error_1, frame.error_2]
    frame.insert(3, "value", _rounded(value, DIGITS[kind] + 1))
    frame.insert(4, "uncertainty", _rounded(np.max(errors, axis=0), 2))
    return frame


def _rounded(values, digits):
    return [float(f"{value:.{digits}g}") for value in np.broadcast_to(values, np.shape(values))]


def by_hertz(case: str) -> Source:
    """Values of Hertz's law."""
    joint, _ = joint_of(case)
    return Source("Hertz's law", joint.law(Hertz()).force(depths(case)))


def by_stiffened_hertz(case: str) -> Source:
    """Values of the stiffened Hertz law."""
    joint, _ = joint_of(case)
    return Source("stiffened Hertz law", joint.law("stiffened_hertz").force(depths(case)))


def _acceleration(case, run):
    """Values of a program that gives the slider's acceleration only."""
    scene, _ = scene_of(case)
    (last,), _ = _times(case)
    values = np.full(len(QUANTITIES[case]), np.nan)
    place = [of.startswith("slider acceleration") for of in QUANTITIES[case]].index(True)
    values[place] = run(scene, last)[-1]
    return values


def by_cvode(case: str, tolerance: float = 1e-8) -> Source:
    """Slider's acceleration by CVODE."""

    def run(scene, last):
        law = explicit.packed(scene, "hertz")
        return cvode.slider_acceleration(scene, law, last, 1, tolerance)[0]

    return Source(
        f"CVODE in C, SUNDIALS {cvode.version()}, tolerance {tolerance:.0e}",
        _acceleration(case, run),
    )


def by_exudyn(case: str, step: float = 4e-6) -> Source:
    """Slider's acceleration by Exudyn, where friction begins at no speed."""
    import exudyn

    def run(scene, last):
        return multibody.slider_acceleration(scene, last, 1, step)

    name = f"Exudyn {exudyn.__version__}, generalised alpha, step {step:g} s"
    return Source(name, _acceleration(case, run))


HELD_OUTSIDE = "hemisphere", "reference", "thin_socket", "close_fit"
ENTRIES: dict[str, tuple[Callable[[str], Source], Any, int]] = {
    "this study": (by_study, [*QUANTITIES], 1),
    "Hertz's law": (by_hertz, ON_AXIS, 10),
    "stiffened Hertz law": (by_stiffened_hertz, HELD_OUTSIDE, 10),
    "CalculiX": (lambda case: by_calculix(case, 0), [*QUANTITIES][1:10], 1),
    "SciPy": (lambda case: by_absolute_coordinates(case, 1e-8), [*QUANTITIES][10:], 1),
    "CVODE": (by_cvode, ["first_impacts"], 10),
    "Exudyn": (by_exudyn, ["first_impacts"], 3),
}
"""Entry -> function, its cases, and how many times it is called for the shortest time."""


def processor_time() -> float:
    """Time in s of this process and those that it has called, whatever else the computer does."""
    called = os.times()
    return time.process_time() + called.children_user + called.children_system


def entry_of(name: str, case: str) -> pd.DataFrame:
    """Rows of ``data/benchmark_entries.csv`` of an entry for a case, with the time in s."""
    (call, _, repeats), times = ENTRIES[name], []
    if name == "this study":  # compile and load; the bodies of the other joint are not used again
        by_study(case, other=True)
    for _ in range(repeats):
        start = processor_time()
        found = call(case)
        times.append(processor_time() - start)
    kind = cases().kind[case]
    columns = {
        "entry": name,
        "case": case,
        "quantity": QUANTITIES[case],
        "value": _rounded(found.found, DIGITS[kind]),
        "time": float(f"{min(times):.3g}"),
        "called": found.name,
        "date": datetime.date.today().isoformat(),
    }
    return pd.DataFrame(columns).dropna(subset="value")


def keep(made: pd.DataFrame, keys: list[str], order: list[Any]) -> pd.DataFrame:
    """Rows just made and the stored others, in an order of the keys."""
    file = benchmark.ENTRIES if "entry" in keys else benchmark.VALUES
    stored = pd.read_csv(file) if file.exists() else made[:0]
    done = set(made[keys].itertuples(index=False, name=None))
    others = [row not in done for row in stored[keys].itertuples(index=False, name=None)]
    rows = pd.concat([made, stored[others]])
    place = [order.index(row) for row in rows[keys].itertuples(index=False, name=None)]
    rows = rows.iloc[np.argsort(place, kind="stable")]
    with paths.whole(file) as temporary:
        rows.to_csv(temporary, index=False, lineterminator="\n")
    store.write_hashes([file])
    return rows


def main(what: str, *names: str) -> None:
    """Compute values or entries of some cases, and write each as soon as it is known."""
    for case in names or QUANTITIES:
        if what == "values":
            made = rows_of(case)
            keep(made, ["case"], [(name,) for name in QUANTITIES])
            print(made.drop(columns=["source_1", "source_2"]).to_string(), flush=True)
            continue
        pairs = [(name, of) for name, (_, cases, _) in ENTRIES.items() for of in cases]
        for name in (name for name, of in pairs if of == case):
            made = entry_of(name, case)
            keep(made, ["entry", "case"], pairs)
            print(made.to_string(), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
