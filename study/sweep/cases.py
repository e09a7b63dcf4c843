"""Cases of a parameter study: the columns of their table, and the results of each case.

A case is texts by column, as a CSV file holds them. Its columns are the options of `study joint`
and `study simulate`. Semicolons separate the values of an option that may be repeated.

A new column of results needs its unit and meaning in the table of its kind, such as `CURVES`, and
its value in the function that solves this kind.
"""

import csv
import io
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from study import checks
from study.checks import StudyError
from study.contact import tabulated
from study.joint import DimensionalJoint, Joint, force_curve, material, whole_curve
from study.joint.dimensional import usual_depth
from study.joint.parsing import joint as joint_of_texts
from study.joint.parsing import liner
from study.mechanism import Response, Scene
from study.mechanism.response import IMPACT_COLUMNS
from study.mechanism.simulate import ready

Kind = Literal["joints", "scenes"]
Case = dict[str, str]
Told = dict[str, Any]
Rows = list[list[str]]
NAME, ERROR = "case", "error"
"""First column of every table, the case's name or number, and the last, the reason of a failure."""
CURVES = {
    "depth_star": ("1", "Penetration depth d/dR"),
    "force_star": ("1", "Force P/(E* dR^2)"),
    "stiffness_star": ("1", "Slope of force_star over depth_star; of whole curves"),
    "contact_half_angle_deg": ("deg", "Polar angle of the contact's edge"),
    "peak_pressure_star": ("1", "Largest pressure p R2/(E* dR)"),
    "error_estimate": ("1", "Estimated relative error of the force"),
}
SIZED = {
    "depth": ("m", "Penetration depth"),
    "force": ("N", "Contact force"),
    "stiffness": ("N/m", "Slope of the force over the depth"),
    "contact_half_angle_deg": ("deg", "Polar angle of the contact's edge"),
    "peak_pressure": ("Pa", "Largest contact pressure"),
    "error_estimate": ("1", "Estimated relative error of the force"),
    "yield_factor": ("1", "Yield stress over von Mises stress, of the body nearest to yield"),
}
SCENES = {
    "impacts": ("1", "Contacts that begin"),
    "largest_depth": ("m", "Largest penetration depth"),
    "largest_force": ("N", "Largest normal force in a clearance joint"),
    "energy_lost": ("J", "Lost by damping and friction in the joints"),
    "last_separation": ("s", "Time at which the surfaces part for the last time"),
    "mean_slider_deviation": ("m", "From ideal joints at the same crank angle, mean of its size"),
    "largest_slider_deviation": ("m", "The same, its largest size at the times of output"),
    "energy_error": ("1", "Largest error of the energy balance, over the largest energy"),
}
COLUMNS = {"joints": CURVES, "joints with dimensions": SIZED, "scenes": SCENES}
"""Results of a case, by the form of the cases: column -> unit and meaning."""
_LONG = 1.0  # s after which a process returns its results; the other cases are handed out again


class Form(NamedTuple):
    """How cases of one form are read and solved.

    ``read`` has a function for each column, of its name and text, that gives its value. ``solver``
    takes these values. It gives a key, the same for cases that share elastic bodies, and a function
    that solves the case.
    """

    read: Mapping[str, Callable[[str, str], Any]]
    needed: tuple[str, ...]
    solver: Callable[[dict[str, Any]], tuple[str, Callable[[], Told]]]


def load(cases: Path | Iterable[Mapping[str, Any]]) -> list[Case]:
    """Cases from a CSV file, or from mappings, as texts; empty texts are left out.

    Raises
    ------
    ValueError
        If there are none, for a file that is not CSV text, or a row of another length.
    """
    if not isinstance(cases, Path):
        found = [_texts(case) for case in cases]
    else:
        try:
            lines = cases.read_text(encoding="utf-8-sig")
            head, *rows = [row for row in csv.reader(io.StringIO(lines)) if row] or [[]]
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            why = getattr(error, "strerror", None) or "it is not CSV text in UTF-8"
            raise ValueError(f"cases must be a CSV file, got {cases}: {why}") from None
        names = [name.strip() for name in head]
        if len(set(names)) < len(names):
            raise ValueError(f"each column must have a name of its own, got {', '.join(names)}")
        for number, row in enumerate(rows, 1):
            if len(row) != len(names):
                wanted = f"row {number} must have {len(names)} cells, as the head of the file"
                raise ValueError(f"{wanted}, got {len(row)}")
        found = [dict(zip(names, map(str.strip, row), strict=True)) for row in rows]
    if not found:
        raise ValueError("cases must have a row or more, got none")
    return [{name: text for name, text in case.items() if text} for case in found]


def _texts(case):
    if not isinstance(case, Mapping):
        shown = checks.shown(case)
        raise ValueError(f"each of cases must be a mapping of columns to values, got {shown}")
    return {str(name): _text(value) for name, value in case.items()}


def _text(value):
    """Text of a cell from a Python value; a list has several values, a tuple is one value."""
    if isinstance(value, list | tuple | np.ndarray):
        return ("," if isinstance(value, tuple) else ";").join(map(_text, value))
    return "" if value is None or str(value) in ("nan", "<NA>", "NaT") else str(value)


def random_cases(count: int, ranges: Mapping[str, str], seed: int = 0) -> list[Case]:
    """Random cases, the same for the same seed; a larger ``count`` begins with the same ones.

    Parameters
    ----------
    ranges
        Range of each column: ``low:high``, drawn evenly; ``low:high:log``, drawn evenly in the
        logarithm; or values to choose from, ``a,b,c``. Numbers are drawn with 6 digits.
    """
    count = checks.whole("number of random cases", count, least=1)
    seed = checks.whole("seed", seed, least=0)
    if not ranges:
        raise ValueError("ranges of the random cases must be given")
    kinds = {name: _range(name, text) for name, text in ranges.items()}
    draw = np.random.default_rng(seed)
    return [{name: one(draw.random()) for name, one in kinds.items()} for _ in range(count)]


def _range(name, text):
    """Function of a number from 0 to 1 that gives a text within a range."""
    ends = text.split(":")
    if len(ends) == 1:
        values = [value.strip() for value in text.split(",")]
        return lambda x: values[int(x * len(values))]
    if len(ends) > 3 or ends[2:] not in ([], ["log"]):
        wanted = f"range of {name} must be low:high, low:high:log, or values separated by commas"
        raise ValueError(f"{wanted}, got {text!r}")
    low, high = (checks.read(f"range of {name}", end) for end in ends[:2])
    checks.number(f"low end of the range of {name}", low, above=0 if ends[2:] else None)
    checks.number(f"high end of the range of {name}", high, above=low)
    if ends[2:]:
        return lambda x: f"{low * (high / low) ** x:.6g}"
    return lambda x: f"{low + (high - low) * x:.6g}"


def checked(kind: Kind, cases: list[Case]) -> tuple[str, list[str]]:
    """Form of the cases, one of `COLUMNS`, and for each case the key of its elastic bodies.

    Raises
    ------
    ValueError
        For a column, or a value, that is not possible; names row and column.
    """
    checks.choice("kind", kind, ("joints", "scenes"))
    columns = list(dict.fromkeys(name for case in cases for name in case))
    form: str = kind
    if kind == "joints" and "r2_star" not in columns:
        form = "joints with dimensions"
    reads, needed, _ = FORMS[form]
    for column in columns:
        checks.choice("column", column, [NAME, *reads])
    bodies: list[str] = []
    names: dict[str, int] = {}
    for row, case in enumerate(cases, 1):
        try:
            if missing := [column for column in needed if column not in case]:
                other = ", or r2_star" if form == "joints with dimensions" else ""
                raise ValueError(f"{missing[0]} must be given{other}")
            bodies.append(_solver(form, case)[0])
        except ValueError as error:
            raise ValueError(f"row {row}: {error}") from None
        name = case.get(NAME, str(row))
        before = names.setdefault(name, row)
        if before != row:
            twice = f"got {name!r} in row {before} too"
            raise ValueError(f"row {row}: {NAME} must be another name in each row, {twice}")
    return form, bodies


def solve_some(form: str, some: list[Case]) -> list[Rows]:
    """Rows of the first cases of a list, as many as take a second."""
    end, found = time.monotonic() + _LONG, []
    for case in some:
        found.append(rows(form, case))
        if time.monotonic() > end:
            break
    return found


def rows(form: str, case: Case) -> Rows:
    """Cells of a case's rows, with 9 digits; one row with the reason if it fails."""
    columns = COLUMNS[form]
    try:
        told = _solver(form, case)[1]()
        cells = [_cells(name, told[name]) for name in columns]
    except MemoryError:  # not the case's own
        raise
    except Exception as error:  # written to the table, and counted: the other cases go on
        known = isinstance(error, ValueError | StudyError)
        text = str(error) if known else f"{type(error).__name__}: {error}"
        return [[""] * len(columns) + [" ".join(text.split())]]
    count = max(map(len, cells))
    full = [one * count if len(one) == 1 else one for one in cells]
    return [[*row, ""] for row in zip(*full, strict=True)]


def _cells(name, values):
    if isinstance(values, str):
        return [values]
    return [f"{value:.9g}" for value in np.atleast_1d(checks.number(name, values))]


def _solver(form, case):
    reads, _, solver = FORMS[form]
    return solver({name: reads[name](name, text) for name, text in case.items() if name != NAME})


def _word(_, text):
    return text


def _words(_, text):
    return [part.strip() for part in text.split(";")]


def _whole(name, text):
    return checks.read(name, text, int)


def _numbers(name, text):
    return [checks.read(name, part) for part in text.split(";")]


def _pair(name, text):
    return checks.read_several(name, text, kind=int)


def _material(name, text):
    try:
        return material(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _liners(name, text):
    found = tuple(liner(part) for part in _words(name, text))
    return tuple((thickness, _material(name, of)) for thickness, of in found)


def _bodies(joint: Joint) -> str:
    """Key of the compliances of a joint's bodies."""
    supports = joint.ball_drive, joint.rim, joint.kinematics
    return repr((supports, joint.socket_layers, joint.ball.poisson))


def _of_joint(given):
    depths = given.pop("depth_star", None)
    if depths is not None:
        checks.number("depth_star", depths, least=0)
    joint = joint_of_texts(**given)
    return _bodies(joint), partial(_curve, joint, depths)


def _curve(joint: Joint, depths: list[float] | None) -> Told:
    told: Told = {"stiffness_star": ""}
    if depths is None:
        curve = whole_curve(joint, usual_depth(joint))
        law, r2_star = tabulated(curve), joint.r2_star
        told["stiffness_star"] = law(curve.depth_star, r2_star, derivative=True)
    else:
        curve = force_curve(joint, depths)
    return {name: getattr(curve, name) for name in CURVES if name not in told} | told


def _of_sized(given):
    wanted = {name: given.pop(name) for name in ("depth", "force") if name in given}
    for name, values in wanted.items():
        checks.number(name, values, SIZED[name][0], above=0)
    if len(wanted) > 1:
        raise ValueError("either depth or force must be given, not both")
    joint = DimensionalJoint(**given)
    return _bodies(joint.joint), partial(_sized, joint, wanted)


def _sized(joint: DimensionalJoint, wanted: dict[str, list[float]]) -> Told:
    solved = joint.solve(**wanted) if wanted else joint.curve()
    told = {name: getattr(solved, name) for name in SIZED if name != "yield_factor"}
    factors = [factor for factor in solved.yield_factor.values() if factor is not None]
    return told | {"yield_factor": np.min(factors, axis=0) if factors else ""}


def _of_scene(given):
    names = {each.name for each in fields(Scene)}
    texts = {name: text for name, text in given.items() if name in names}
    for name in ("ball", "socket"):
        if name in texts:
            _material(name, texts[name])
    scene = Scene.read(texts)
    options = {name: value for name, value in given.items() if name not in names}
    law = options.get("law", "hertz")
    if "socket_ratio" in options and law != "stiffened_hertz":
        raise ValueError(f"socket_ratio must be left out: law {law} does not depend on it")
    return "", partial(_simulated, scene, ready(scene, **options))


def _simulated(scene: Scene, run: Callable[[], Response]) -> Told:
    response = run()
    if not response.complete:
        raise KeyboardInterrupt
    impacts = dict(zip(IMPACT_COLUMNS, response.impact_rows.T, strict=True))
    deviation = np.abs(response.slider_position - _ideal_position(scene, response))
    return {
        "impacts": len(response.impact_rows),
        "largest_depth": impacts["peak_depth"].max(initial=0.0),
        "largest_force": impacts["peak_force"].max(initial=0.0),
        "energy_lost": response.lost_damping[-1] + response.lost_friction[-1],
        "last_separation": response.last_separation,
        "mean_slider_deviation": deviation.mean(),
        "largest_slider_deviation": deviation.max(),
        "energy_error": response.energy_error,
    }


def _ideal_position(scene: Scene, response: Response) -> np.ndarray:
    """Slider's position with ideal joints at each crank angle of a response, in m."""
    angle, crank, coupler = response.crank_angle, scene.crank_length, scene.coupler_length
    return crank * np.cos(angle) + np.sqrt(coupler**2 - (crank * np.sin(angle)) ** 2)


_OF_BOTH = dict.fromkeys(("ball_drive", "rim", "kinematics"), _word)
_RATIOS = ("r2_star", "socket_ratio", "poisson", "modulus_ratio", "socket_poisson")
_SIZES = ("socket_radius", "clearance", "wall")
_OPTIONS = {
    **dict.fromkeys(("model", "joint", "law", "method"), _word),
    **dict.fromkeys(("duration", "tolerance", "step", "socket_ratio"), checks.read),
    **{"outputs": _whole, "elements": _pair},
}
FORMS = {
    "joints": Form(
        {
            **dict.fromkeys(_RATIOS, checks.read),
            "layer": _words,
            **_OF_BOTH,
            "depth_star": _numbers,
        },
        ("r2_star",),
        _of_joint,
    ),
    "joints with dimensions": Form(
        {
            **dict.fromkeys(_SIZES, checks.read),
            **{"ball": _material, "socket": _material, "liner": _liners},
            **_OF_BOTH,
            **{"depth": _numbers, "force": _numbers},
        },
        _SIZES,
        _of_sized,
    ),
    "scenes": Form(_OPTIONS | {each.name: _word for each in fields(Scene)}, (), _of_scene),
}
"""By a name of `COLUMNS`."""
