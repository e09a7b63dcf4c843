"""Elastic solutions that notebooks show: read if they are stored, else solved.

``data/solutions/cases.json`` has the `Request` of each stored solution, and each kind has a file of
results in the same folder. Stored and solved results are the same numbers, because arguments and
results have 9 significant digits. `store_requests` writes the list, and ``study data build`` solves
what is new.
"""

import hashlib
import json
from collections.abc import Iterable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from study import paths
from study.dataset import store
from study.joint import Joint, LargestStress, Solution, Solver
from study.joint.tilted import RESOLUTION
from study.joint.yielding import StressOverDepth, over_depth

Floats = NDArray[np.float64]
_AXIAL = ("depth_star", "force_star", "contact_half_angle_deg", "peak_pressure_star")
COLUMNS: dict[str, tuple[str, ...]] = {
    "axial": (*_AXIAL, "error_estimate"),
    "tilted": ("depth_star", "tilt", "force_star", "error_estimate"),
    "loaded": (*_AXIAL, "peak_error", "contact_from_deg", "contact_to_deg", "error_estimate"),
}
"""Arrays of a `study.joint.Solution` that are stored, by the kind of solution."""


class Request(NamedTuple):
    """One solution: a kind of `store.SOLUTIONS`, and the arguments of the joint and of its kind."""

    kind: str
    joint: dict[str, Any]
    arguments: dict[str, Any]

    @property
    def name(self) -> str:
        """Name in the files: ten digits that follow from the request."""
        text = self.kind + json.dumps(self.joint) + json.dumps(self.arguments)
        return hashlib.sha256(text.encode()).hexdigest()[:10]


def curve(
    joint: Joint,
    depth_star: ArrayLike | None = None,
    resolution: int | None = None,
    solver: Solver | None = None,
) -> Solution:
    """Solution along the axis at some depths, or the `study.joint.Joint.curve` without them."""
    depths = None if depth_star is None else np.atleast_1d(depth_star).tolist()
    given = {"depth_star": depths, "resolution": resolution, "solver": solver}
    return _solution("axial", joint, _rows("axial", joint, given))


def stress_over_depth(joint: Joint, deepest: float = 1.0) -> dict[str, StressOverDepth]:
    """Maximum von Mises stress in each body over the depth: `study.joint.yielding.over_depth`."""
    rows, names = _rows("stress", joint, {"deepest": deepest}), StressOverDepth._fields
    return {
        body: StressOverDepth(*(of[name].to_numpy() for name in names))
        for body, of in rows.groupby("body", sort=False)
    }


def tilted(
    joint: Joint, depth_star: ArrayLike, tilt: ArrayLike, resolution: int = RESOLUTION
) -> Solution:
    """Force along the displacement at some depths and tilts."""
    depths, tilts = np.broadcast_arrays(*np.atleast_1d(depth_star, tilt))
    given = {"depth_star": depths.tolist(), "tilt": tilts.tolist(), "resolution": resolution}
    return _solution("tilted", joint, _rows("tilted", joint, given))


def under_load(joint: Joint, force: float, tilt: float | None = None) -> Solution:
    """Solution under a force in N, with the pressure and the stress of the body nearest to yield.

    A tilt is that of the force, in deg.
    """
    rows = _rows("loaded", joint, {"force": force, "tilt": tilt})
    first = rows.iloc[[0]]
    stress, place = first.von_mises.to_numpy(), (str(first.place.iloc[0]),)
    unknown = np.full(1, np.nan)
    largest = LargestStress(stress, stress / first.peak_pressure_star, unknown, unknown, place)
    return _solution(
        "loaded",
        joint,
        first,
        angle_deg=rows.angle_deg.to_numpy(),
        pressure_star=rows.pressure_star.to_numpy()[None],
        stress={first.body.iloc[0]: largest},
    )


def _solution(kind, joint, rows, **more):
    stored = {name: rows[name].to_numpy() for name in COLUMNS[kind]}
    return Solution(joint=joint, solver="stored", **stored, **more)


def request_of(kind: str, joint: Joint, arguments: dict[str, Any]) -> Request:
    """Request for a joint with the other arguments of the kind."""
    renamed = {"layers": "layer"}  # in the file
    written = {renamed.get(name, name): value for name, value in joint.arguments().items()}
    return Request(kind, written, _rounded(arguments))


def joint_of(request: Request) -> Joint:
    """Joint of a request."""
    if "socket_radius" in request.joint:
        return Joint(**request.joint)
    given = dict(request.joint)
    if "layer" in given:
        given["layers"] = given.pop("layer")
    return Joint.from_ratios(**given)


def solve(request: Request) -> pd.DataFrame:
    """Results of a request with 9 significant digits, and with the columns of its kind's file."""
    joint, given = joint_of(request), dict(request.arguments)
    if request.kind == "stress":
        tables = over_depth(joint, **given)
        frame = pd.concat(
            pd.DataFrame({"body": body} | of._asdict()) for body, of in tables.items()
        )
    else:
        if request.kind == "axial" and given["depth_star"] is None:
            solved = joint.curve(1.0, resolution=given["resolution"])
        else:
            solved = joint.solve(**given, stresses=request.kind == "loaded")
        arrays = {name: getattr(solved, name) for name in COLUMNS[request.kind]}
        frame = pd.DataFrame({k: np.nan if of is None else of for k, of in arrays.items()})
    if request.kind == "loaded":
        factors = {body: of[0] for body, of in solved.yield_factor.items() if of is not None}
        body = min(factors, key=factors.__getitem__)
        near, largest = solved.pressure_star[0] > 0, solved.stress[body]
        frame = frame.assign(body=body, von_mises=largest.von_mises, place=largest.place)
        pressures = {"angle_deg": solved.angle_deg, "pressure_star": solved.pressure_star[0]}
        of_angles = pd.DataFrame({name: of[near] for name, of in pressures.items()})
        frame = frame.merge(of_angles, how="cross")
    numbers = frame.select_dtypes("float").columns
    frame[numbers] = frame[numbers].map(_rounded)
    frame.insert(0, "case", request.name)
    return frame.reset_index(drop=True)


def requests() -> list[Request]:
    """Requests whose solutions are stored."""
    store.verify([store.CASES])
    listed = json.loads(store.CASES.read_text(encoding="utf-8"))
    return [Request(**request) for request in listed.values()]


def store_requests(every: Iterable[Request]) -> None:
    """Write the list of requests, a line for each, and its hash."""
    lines = [f'"{request.name}": {json.dumps(request._asdict())}' for request in every]
    with paths.whole(store.CASES) as temporary:
        temporary.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    store.write_hashes([store.CASES])


def _rows(kind, joint, arguments):
    """Results of a request, stored or solved now."""
    request = request_of(kind, joint, arguments)
    if request.name in (stored := _stored(kind)):
        return stored[request.name]
    return solve(request)


@cache
def _stored(kind):
    """Stored results of one kind, by the names of their requests."""
    frame = store.read(store.SOLUTIONS[kind])
    return {name: rows.reset_index(drop=True) for name, rows in frame.groupby("case", sort=False)}


def _rounded(value: Any) -> Any:
    """A number, or those in lists and dictionaries, with 9 significant digits."""
    if isinstance(value, dict):
        return {name: _rounded(one) for name, one in value.items()}
    if isinstance(value, list):
        return [_rounded(one) for one in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value
