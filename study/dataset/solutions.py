"""Elastic solutions that notebooks show: read if they are stored, else solved.

``data/solutions/cases.json`` names the joint and the other arguments of each stored solution, and
each kind has a file of results in the same folder. Stored and solved results are the same numbers,
because arguments and results are rounded to 9 significant digits. A solution that takes a notebook
longer than `LONG` is noted in ``build/asked``; ``study data build`` stores it.
"""

import hashlib
import json
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from time import process_time
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from study import parameters, paths
from study.contact import Material
from study.dataset import store
from study.joint import DimensionalJoint, Joint, force_curve, tilted_contact, whole_curve
from study.joint.curve import Solver
from study.joint.definition import RatioJoint
from study.joint.stress import StressOverDepth, over_depth
from study.joint.tilted import RESOLUTION

Floats = NDArray[np.float64]
LONG = 1.0  # s of processor time
ASKED = paths.BUILD / "asked"


class Case(NamedTuple):
    """One solution: a kind of `store.SOLUTIONS`, and the arguments of the joint and of its kind."""

    kind: str
    joint: dict[str, Any]
    arguments: dict[str, Any]

    @property
    def name(self) -> str:
        """Name in the files: ten digits that follow from the case."""
        text = self.kind + json.dumps(self.joint) + json.dumps(self.arguments)
        return hashlib.sha256(text.encode()).hexdigest()[:10]


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


def case_of(kind: str, joint: Joint | DimensionalJoint, arguments: dict[str, Any]) -> Case:
    """Case of a joint and the other arguments of its kind."""
    return Case(kind, _written(joint), _rounded(arguments))


def joint_of(case: Case) -> Joint | DimensionalJoint:
    """Joint of a case."""
    given = case.joint
    return DimensionalJoint(**given) if case.kind == "loaded" else RatioJoint(**given).joint()


def solve(case: Case) -> pd.DataFrame:
    """Results of a case, rounded to 9 significant digits, with the columns of its kind's file."""
    frame = pd.DataFrame(_SOLVE[case.kind](joint_of(case), **case.arguments))
    numbers = frame.select_dtypes("float").columns
    frame[numbers] = frame[numbers].map(_rounded)
    frame.insert(0, "case", case.name)
    return frame


def cases() -> list[Case]:
    """Cases of the stored solutions."""
    store.verify([store.CASES])
    return [Case(**case) for case in json.loads(store.CASES.read_text(encoding="utf-8")).values()]


def store_cases(every: Iterable[Case]) -> None:
    """Write the list of cases, a line for each, and its hash."""
    lines = [f'"{case.name}": {json.dumps(case._asdict())}' for case in every]
    with paths.whole(store.CASES) as temporary:
        temporary.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    store.write_hashes([store.CASES])


def adopt_asked() -> int:
    """Add the cases that notebooks asked for to the list; return how many are new."""
    known, notes = {case.name: case for case in cases()}, sorted(ASKED.glob("*.json"))
    new = {}
    for path in notes:
        with suppress(ValueError, TypeError):  # a damaged note is made again by its notebook
            case = Case(**json.loads(path.read_text(encoding="utf-8")))
            if case.name not in known:
                new[case.name] = case
    if new:
        store_cases([*known.values(), *new.values()])
    for path in notes:
        path.unlink()
    return len(new)


def _rows(kind, joint, arguments):
    """Results of a case, stored or solved now."""
    case = case_of(kind, joint, arguments)
    if case.name in (stored := _stored(kind)):
        return stored[case.name]
    start = process_time()
    rows = solve(case)
    if process_time() - start > LONG and paths.READ_VARIABLE in os.environ:  # in the workflow
        with suppress(OSError), paths.whole(ASKED / f"{case.name}.json") as temporary:
            temporary.write_text(json.dumps(case._asdict()))
    return rows


@cache
def _stored(kind):
    """Stored results of one kind, by the names of their cases."""
    frame = store.read(store.SOLUTIONS[kind])
    return {name: rows.reset_index(drop=True) for name, rows in frame.groupby("case", sort=False)}


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
