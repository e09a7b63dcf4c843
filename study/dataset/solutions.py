"""Elastic solutions that notebooks show and that take longer than a second.

``data/solutions/cases.csv`` is the list of these solutions (their design): a row for each case,
with its kind, the joint and the other arguments. Each kind has a file of results in the same
folder, and each row of it names its case. The functions of this module return the stored results of
a case, or solve it if it is not in the list. Both ways give the same numbers, because arguments and
results are rounded to 9 significant digits.

``study data record NOTEBOOK`` renews the rows of a notebook in the design.
"""

import json
import os
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from study import parameters, provenance
from study.contact import Material
from study.dataset import store
from study.joint import DimensionalJoint, Joint, force_curve, tilted_contact, whole_curve
from study.joint.curve import Solver
from study.joint.definition import RatioJoint
from study.joint.stress import StressOverDepth, over_depth
from study.joint.tilted import RESOLUTION

Floats = NDArray[np.float64]
RECORD_VARIABLE = "STUDY_SOLUTIONS_RECORD"  # file to which a running notebook adds what it needs
COLUMNS = ("case", "kind", "notebooks", "joint", "arguments")
"""Columns of the design; ``joint`` and ``arguments`` are JSON."""


class Case(NamedTuple):
    """One solution: a kind of `store.SOLUTIONS`, the joint and the other arguments as JSON."""

    kind: str
    joint: str
    arguments: str

    @property
    def name(self) -> str:
        """Name in the files: ten digits that follow from the case."""
        return provenance.sha256("".join(self).encode())[:10]


class Curve(NamedTuple):
    """Force-depth curve of a joint, as `study.joint.ForceCurve` without the pressures."""

    joint: Joint
    depth_star: Floats
    force_star: Floats
    contact_half_angle_deg: Floats
    peak_pressure_star: Floats
    error_estimate: Floats


class Loaded(NamedTuple):
    """Results of `study.joint.DimensionalJoint.solve` under one force.

    Numbers in SI units: ``depth``, ``peak_pressure`` and its relative error (NaN along the axis),
    the signed polar angles in deg at which the contact begins and ends, the ``body`` that is
    closest to yield with its ``yield_factor``, and the pressures at ``angle_deg``.
    """

    depth: float
    peak_pressure: float
    peak_error: float
    first_edge_deg: float
    last_edge_deg: float
    body: str
    yield_factor: float
    angle_deg: Floats
    pressure: Floats


def curve(
    joint: Joint,
    depth_star: ArrayLike | None = None,
    resolution: int | None = None,
    solver: Solver | None = None,
) -> Curve:
    """`study.joint.force_curve` at some depths, or `study.joint.whole_curve` without them."""
    depths = None if depth_star is None else np.atleast_1d(depth_star).tolist()
    given = {"depth_star": depths, "resolution": resolution, "solver": solver}
    rows = _rows("axial", joint, given)
    return Curve(joint, *(rows[name].to_numpy() for name in Curve._fields[1:]))


def stress_over_depth(joint: Joint, deepest: float = 1.0) -> dict[str, StressOverDepth]:
    """Maximum von Mises stress in each body over the depth: `study.joint.stress.over_depth`."""
    rows, names = _rows("stress", joint, {"deepest": deepest}), StressOverDepth._fields
    return {
        body: StressOverDepth(*(of[name].to_numpy() for name in names))
        for body, of in rows.groupby("body", sort=False)
    }


def tilted(
    joint: Joint, depth_star: ArrayLike, tilt: ArrayLike, resolution: int = RESOLUTION
) -> pd.DataFrame:
    """Depth, tilt, force along the displacement and its error, of `study.joint.tilted_contact`."""
    depths, tilts = np.broadcast_arrays(*np.atleast_1d(depth_star, tilt))
    given = {"depth_star": depths.tolist(), "tilt": tilts.tolist(), "resolution": resolution}
    return _rows("tilted", joint, given).reset_index(drop=True)


def under_load(joint: DimensionalJoint, force: float, tilt: float | None = None) -> Loaded:
    """`study.joint.DimensionalJoint.solve` for a force in N, at a tilt in deg."""
    rows = _rows("loaded", joint, {"force": force, "tilt": tilt})
    scalars = rows.iloc[0][list(Loaded._fields[:-2])].to_dict()
    return Loaded(**scalars, angle_deg=rows.angle_deg.to_numpy(), pressure=rows.pressure.to_numpy())


def design() -> pd.DataFrame:
    """The design: a table of all stored cases, with the columns `COLUMNS`."""
    return store.read(store.CASES)


def cases() -> dict[Case, set[str]]:
    """Cases of the design, each with the names of the notebooks that show it."""
    frame = design()
    names = frame.notebooks.str.split().map(set)
    return dict(zip(map(Case._make, frame[[*Case._fields]].to_numpy()), names, strict=True))


def batches() -> dict[str, dict[str, list[Case]]]:
    """Cases of each kind by the notebooks that show them, as their joints have bodies in common."""
    by_kind: dict[str, dict[str, list[Case]]] = {kind: {} for kind in store.SOLUTIONS}
    for case, notebooks in cases().items():
        by_kind[case.kind].setdefault("-".join(sorted(notebooks)), []).append(case)
    return by_kind


def record(notebook: str, needed: Iterable[Case]) -> None:
    """Replace the rows that the design has for a notebook by the cases that it needs."""
    by_case = {case: names - {notebook} for case, names in cases().items()}
    for case in needed:
        by_case.setdefault(case, set()).add(notebook)
    rows = [
        (case.name, case.kind, " ".join(sorted(names)), case.joint, case.arguments)
        for case, names in by_case.items()
        if names
    ]
    order = pd.DataFrame(rows, columns=COLUMNS).sort_values(["kind", "notebooks"], kind="stable")
    store.keep(order, store.CASES)


def case_of(kind: str, joint: Joint | DimensionalJoint, arguments: dict[str, Any]) -> Case:
    """Case of a joint and the other arguments of its kind."""
    return Case(kind, json.dumps(_written(joint)), json.dumps(_rounded(arguments)))


def read_joint(case: Case) -> Joint | DimensionalJoint:
    """Joint of a case."""
    given = json.loads(case.joint)
    return DimensionalJoint(**given) if case.kind == "loaded" else RatioJoint(**given).joint()


def solve(case: Case) -> pd.DataFrame:
    """Results of a case, rounded to 9 significant digits, with the columns of its kind's file."""
    arguments = json.loads(case.arguments)
    frame = pd.DataFrame(_SOLVE[case.kind](read_joint(case), **arguments))
    numbers = frame.select_dtypes("float").columns
    frame[numbers] = frame[numbers].map(_rounded)
    frame.insert(0, "case", case.name)
    return frame


def _axial(joint, depth_star, **options):
    if depth_star is None:
        solved = whole_curve(joint, resolution=options["resolution"])
    else:
        solved = force_curve(joint, depth_star, **options)
    return {name: getattr(solved, name) for name in Curve._fields[1:]}


def _stresses(joint, deepest):
    parts = [
        pd.DataFrame({"body": body} | table._asdict())
        for body, table in over_depth(joint, deepest).items()
    ]
    return pd.concat(parts, ignore_index=True)


def _tilted(joint, depth_star, tilt, resolution):
    solved = tilted_contact(joint, depth_star, tilt, resolution)
    names = ("depth_star", "tilt", "force_star", "error_estimate")
    return {name: getattr(solved, name) for name in names}


def _loaded(joint, force, tilt):
    solved = joint.solve(force=force, tilt=tilt)
    factors = {body: of[0] for body, of in solved.yield_factor.items() if of is not None}
    body = min(factors, key=factors.__getitem__)
    if tilt is None:
        last = solved.contact_half_angle_deg[0]
        error, first = np.nan, -last
    else:
        error, (first, last) = solved.peak_error[0], solved.contact_edges_deg[:, 0]
    numbers = (solved.depth[0], solved.peak_pressure[0], error, first, last, body, factors[body])
    near = solved.pressure[0] > 0
    arrays = solved.angle_deg[near], solved.pressure[0, near]
    return dict(zip(Loaded._fields, (*numbers, *arrays), strict=True))


_SOLVE: dict[str, Callable[..., Any]] = {
    "axial": _axial,
    "stress": _stresses,
    "tilted": _tilted,
    "loaded": _loaded,
}


def _rows(kind, joint, arguments):
    """Results of a case, stored or solved now."""
    case = case_of(kind, joint, arguments)
    if record := os.environ.get(RECORD_VARIABLE):
        with Path(record).open("a", encoding="utf-8") as file:
            file.write(json.dumps(case) + "\n")
    kept = _kept(kind)
    return kept[case.name] if case.name in kept else solve(case)


@cache
def _kept(kind):
    """Kept results of one kind, by the names of their cases."""
    frame = store.read(store.SOLUTIONS[kind])
    return {name: rows.reset_index(drop=True) for name, rows in frame.groupby("case", sort=False)}


def _written(joint):
    """Arguments of the joint that are not the default, as texts and numbers of 9 digits."""
    record = RatioJoint.of(joint) if isinstance(joint, Joint) else joint
    given, default = {}, parameters.defaults(type(record))
    for name, about in parameters.described(type(record)).items():
        value = getattr(record, name)
        if value is None or value == default.get(name, ...):
            continue
        if isinstance(value, Material):  # by numbers: the table of materials may change
            numbers = value.youngs_modulus, value.poisson, value.yield_stress
            given[name] = ",".join(f"{number:.9g}" for number in numbers if number is not None)
        else:
            given[name] = _rounded(value) if isinstance(value, float) else about.written(value)
    return given


def _rounded(value: Any) -> Any:
    """A number, or those in lists and dictionaries, with 9 significant digits."""
    if isinstance(value, dict):
        return {name: _rounded(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_rounded(one) for one in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value
