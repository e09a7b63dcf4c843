"""Cases of a parameter study: the columns of their table, and the results of each case.

A case is a mapping of columns to texts, as in a CSV file. The columns of joints are the parameters
of `study.joint.options`, of scenes the fields of `study.mechanism.Scene` and the arguments of
`study.mechanism.simulate`. Further columns of the user are copied to the table. The results are the
quantities of a `study.joint.Solution` or a `study.mechanism.Response`, and a few more.
"""

import re
import warnings
from collections.abc import Iterable, Mapping
from difflib import SequenceMatcher
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

from study import checks, parameters
from study.checks import StudyError
from study.contact.power_fit import PowerFit
from study.joint import limits
from study.joint.options import DIMENSIONS, PARAMETERS, RATIOS, joint_of, merged
from study.joint.solution import quantities
from study.joint.tilted import LARGEST_TILT
from study.mechanism import Response, Scene
from study.mechanism.compare import second_run
from study.mechanism.law_in_scene import of_name
from study.mechanism.response import exceeded_limits
from study.mechanism.simulate import simulate
from study.parameters import Parameter, Quantity, described
from study.tables import read_table

Kind = Literal["joints", "scenes"]
Case = dict[str, str]
NAME, ERROR = "case", "error"
"""First column of every table (name or number of the case) and last one (reason of a failure)."""
LOADS = {
    "depth_star": Parameter("Penetration depths d/dR", limits={"above": 0}, several=";"),
    "depth": Parameter("Penetration depths", "m", {"above": 0}, several=";"),
    "force": Parameter("Contact forces", "N", {"above": 0}, several=";"),
}
SOCKET = ("wall", "socket_ratio", "liner")
"""Parameters of the socket in a scene."""
INPUTS: dict[str, dict[str, Parameter]] = {
    "joints": {
        **PARAMETERS,
        **LOADS,
        "tilt": Parameter(
            "Angle off the axis of the displacement, or of the force if forces are given",
            "deg",
            {"least": 0, "most": LARGEST_TILT},
        ),
    },
    "scenes": {
        **described(Scene),
        **{n: of for n, of in described(simulate).items() if n not in ("scene", "progress")},
        **{name: PARAMETERS[name] for name in SOCKET},
    },
}
"""Parameters of a case by column."""
_RENAMED = {"tilt": "displacement_tilt"}
"""Quantities of a solution whose column has another name, as theirs is that of a parameter."""
_APPLICABILITY = {
    "applicability": Quantity(
        "Model limits that are exceeded (study joint and study simulate explain them)"
    )
}


def _of_joints(dimensions):
    """Results of a joint: quantities of its solution, and its power law."""
    found = {_RENAMED.get(name, name): of for name, of in quantities(dimensions).items()}
    law = "force = k depth^n" if dimensions else "force_star = k depth_star^n"
    if dimensions:
        found["yield_factor"] = Quantity(
            "Yield stress divided by the maximum von Mises stress, of the body closest to yield"
        )
    return {
        **found,
        "power_coefficient": Quantity(
            f"k of the power law {law}, fitted from 0.05 to 0.5 clearances",
            "N/m^n" if dimensions else "",
        ),
        "power_exponent": Quantity(
            "n of this power law; empty if the joint cannot be solved over this range"
        ),
        "power_error": Quantity("Maximum relative error of this power law over this range"),
        **_APPLICABILITY,
        "warnings": Quantity("Values that were probably meant in another unit"),
    }


_OF_SCENES = {
    **parameters.quantities(Response),
    "delivered_restitution": Quantity(
        "Coefficient of restitution of a free impact with the damping of the scene"
    ),
    "mean_slider_deviation": Quantity(
        "Mean distance of the slider from its position with ideal joints at the same crank angle",
        "m",
    ),
    "largest_slider_deviation": Quantity("Maximum of this distance at the output times", "m"),
    **_APPLICABILITY,
    "agrees_until": Quantity(
        "With --twice: time until which a run at a second tolerance agrees, for rigid links", "s"
    ),
}
COLUMNS: dict[str, dict[str, Quantity]] = {
    "joints": _of_joints(False),
    "joints with dimensions": _of_joints(True),
    "scenes": _OF_SCENES,
}
"""Results of a case by column, for each form of the cases."""


def inputs(form: str) -> dict[str, Parameter]:
    """Parameters of the cases of a form by column."""
    if form == "scenes":
        return INPUTS["scenes"]
    other, own = (RATIOS, {"depth_star"}) if form != "joints" else (DIMENSIONS, {"depth", "force"})
    return {name: of for name, of in INPUTS["joints"].items() if name not in {*other, *own}}


def load(cases: Path | Iterable[Mapping[str, Any]]) -> list[Case]:
    """Cases from a CSV file, or from mappings, as texts; empty texts are left out.

    A column of the file may have a unit, such as ``wall [mm]``. Raises ``ValueError`` if there is
    no case, or if the file cannot be read.
    """
    if isinstance(cases, Path):
        known = INPUTS["joints"] | INPUTS["scenes"]
        pairs = [name for name, of in known.items() if of.several == ","]
        table = read_table(cases, "cases", pairs)
        rows = [dict(zip(table.names, row, strict=True)) for row in table.rows]
    else:
        rows = [_as_texts(case) for case in cases]
    if not rows:
        raise ValueError("cases must have at least one row, got none")
    return [dict(_with_unit(*cell) for cell in row.items() if cell[1]) for row in rows]


def _as_texts(case):
    if not isinstance(case, Mapping):
        shown = checks.shown(case)
        raise ValueError(f"each of cases must be a mapping of columns to values, got {shown}")
    return {str(name): _text(value) for name, value in case.items()}


def _text(value):
    """Text of a cell from a Python value; a list has several values, a tuple is one value."""
    if isinstance(value, list | tuple | np.ndarray):
        return ("," if isinstance(value, tuple) else ";").join(map(_text, value))
    return "" if value is None else str(value)


_HEAD = re.compile(r"(?P<name>\w+)\s*[(\[](?P<unit>.+)[)\]]")


def _with_unit(name, text):
    """Column without the unit of its head, which is added to each number of the cell."""
    found = _HEAD.fullmatch(name)
    for every in INPUTS.values() if found else ():
        about = every.get(found["name"])
        if about and about.unit and checks.exponent_of(found["unit"], about.unit) is not None:
            texts = (f"{one}{found['unit']}" for one in text.split(";"))
            return found["name"], ";".join(texts)
    return name, text


def form_of(kind: Kind, cases: list[Case], joint: Mapping[str, Any]) -> str:
    """Form of the cases, a key of `COLUMNS`.

    Raises ``ValueError`` for a column that is probably a misspelt parameter, that belongs to
    another form, or that has the name of a result; and for names that are given twice.
    """
    columns = list(dict.fromkeys(name for case in cases for name in case))
    form: str = kind
    if kind == "joints" and not {*RATIOS} & {*columns, *joint}:
        form = "joints with dimensions"
    if joint and kind == "scenes":
        raise ValueError("joint applies to joints only, got scenes; remove it")
    for column in columns:
        if column not in (NAME, *inputs(form)):
            check_own(form, column)
    rows: dict[str, int] = {}
    for row, case in enumerate(cases, 1):
        name = case.get(NAME, str(row))
        if (first := rows.setdefault(name, row)) != row:
            raise ValueError(
                f"row {row}: {NAME} must have a different name in each row, got {name!r} also in "
                f"row {first}"
            )
    return form


_LONG = 6  # letters of a name in which two may be wrong


def check_own(form: str, column: str) -> None:
    """Raise ``ValueError`` for a column of the user that is probably meant as another one."""
    if column in (*COLUMNS[form], ERROR):
        raise ValueError(
            f"column {column} must have another name, because the table of results has one of this "
            "name"
        )
    for other in COLUMNS:
        if column in inputs(other):
            raise ValueError(
                f"column {column} must be removed or have another name, because it is a parameter "
                f"of {other} and not of {form}"
            )
    plain = re.sub(r"[\s_]*[(\[].*[)\]]$|[\s_](mm?|um|k?n|[km]?pa|gpa|deg)$", "", column.lower())
    for known in (NAME, *inputs(form)):
        blocks = SequenceMatcher(None, plain, known).get_matching_blocks()
        wrong = max(len(plain), len(known)) - sum(block.size for block in blocks)
        if wrong <= (1 if len(known) < _LONG else 2):
            raise ValueError(
                f"column {column} is not a parameter: did you mean {known}? A unit is written "
                f"behind the name in brackets, as in wall [mm], or behind each number. A column "
                "that is only to be copied must have a name that differs more from theirs"
            )


def values_of(form: str, case: Case, joint: Mapping[str, Any]) -> dict[str, Any]:
    """Values of a case by column, as numbers and objects, over those of a saved joint."""
    known = inputs(form)
    given = {name: known[name].read(name, text) for name, text in case.items() if name in known}
    values = {name: known[name].taken(name, value) for name, value in given.items()}
    return merged(joint, values) if form.startswith("joints") else values


def bodies_of(form: str, values: dict[str, Any]) -> str:
    """What a case shares with others that are best solved after it: its elastic bodies.

    Raises ``ValueError`` for values that do not suit each other.
    """
    if form == "scenes":
        _scene_of(values)
        return ""
    joint, *_ = _joint_of(values)
    return repr((joint.ball_body, joint.socket_body))


def solve(form: str, values: dict[str, Any], twice: bool = False) -> list[list[str]]:
    """Rows of results of a case: cells with 9 significant digits, and the reason of a failure."""
    columns = COLUMNS[form]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", checks.UnitWarning)  # the table has the sentences
            results = _simulated(values, twice) if form == "scenes" else _solved(values)
        cells = [_cells(name, results[name]) for name in columns]
    except Exception as error:  # written to the table, and counted: the other cases go on
        known = isinstance(error, ValueError | StudyError)
        reason = str(error) if known else f"{type(error).__name__}: {error}"
        return [failed(form, reason)]
    count = max(map(len, cells))
    full = [column * count if len(column) == 1 else column for column in cells]
    return [[*row, ""] for row in zip(*full, strict=True)]


def failed(form: str, reason: str) -> list[str]:
    """Row of a case without results."""
    return [""] * len(COLUMNS[form]) + [" ".join(reason.split())]


def _cells(name, values):
    if values is None:
        return [""]
    if isinstance(values, str | list):
        return np.atleast_1d(values).tolist()
    return [f"{value:.9g}" for value in np.atleast_1d(checks.number(name, values))]


def _joint_of(values):
    """Joint of a case, its depths or forces, and its tilt."""
    loads = {name: of for name, of in values.items() if name in LOADS}
    if len(loads) > 1:
        raise ValueError(f"{' and '.join(loads)} must not both be given; remove one of them")
    others = {name: of for name, of in values.items() if name not in (*LOADS, "tilt")}
    joint = joint_of(others, off_axis="tilt" in values)
    return joint, loads, values.get("tilt", joint.default_tilt)


def _solved(values):
    joint, loads, tilt = _joint_of(values)
    solve = joint.solve if loads else joint.curve
    solution = solve(**loads, tilt=tilt, stresses=joint.has_dimensions)
    factors = [factor for factor in solution.yield_factor.values() if factor is not None]
    try:
        fit = joint.power_law if joint.has_dimensions else joint.power_fit
        power = fit(tilt=solution.direction_deg)._asdict()
    except (ValueError, StudyError):  # it cannot be solved over the range of the fit
        power = dict.fromkeys(PowerFit._fields)
    return {
        **{
            _RENAMED.get(name, name): getattr(solution, name)
            for name in quantities(joint.has_dimensions)
        },
        "yield_factor": np.min(factors, axis=0) if factors else None,
        **{f"power_{name}": value for name, value in power.items()},
        "applicability": [limits.in_short(each) for each in solution.limits],
        "warnings": " ".join(joint.warnings),
    }


def _scene_of(values):
    """Scene of a case, and the arguments of its simulation."""
    own = {*described(Scene), *SOCKET}
    scene = Scene(**{name: values[name] for name in described(Scene) if name in values})
    socket = {name: values[name] for name in SOCKET if name in values}
    law = of_name(scene, values.get("law"), **socket)
    return scene, {name: of for name, of in values.items() if name not in own} | {"law": law}


def _simulated(values, twice):
    scene, options = _scene_of(values)
    response = simulate(scene, **options)
    if not response.complete:
        raise KeyboardInterrupt
    angle, crank, coupler = response.crank_angle, scene.crank_length, scene.coupler_length
    ideal = crank * np.cos(angle) + np.sqrt(coupler**2 - (crank * np.sin(angle)) ** 2)
    deviation = np.abs(response.slider_position - ideal)
    try:
        agreement = twice and second_run(response, partial(simulate, scene, **options))
    except StudyError as error:
        raise StudyError(f"the run at a second tolerance failed: {error}") from None
    return {
        **{name: getattr(response, name) for name in parameters.quantities(Response)},
        "delivered_restitution": response.delivered_restitution,
        "mean_slider_deviation": deviation.mean(),
        "largest_slider_deviation": deviation.max(),
        "applicability": limits.in_short(exceeded_limits(scene, response)),
        "agrees_until": agreement.until if agreement else None,
    }


def random_cases(count: int, ranges: Mapping[str, str], seed: int = 0) -> list[Case]:
    """Random cases of a parameter study.

    Parameters
    ----------
    count
        Number of cases, >= 1. A larger number begins with the same cases.
    ranges
        Range of each column: ``low:high`` draws uniformly, ``low:high:log`` uniformly in the
        logarithm, and ``a,b,c`` one of the listed values. Numbers are drawn with 6 digits.
    seed
        Seed of the random numbers; the same seed gives the same cases.

    Examples
    --------
    >>> random_cases(2, {"r2_star": "20:300:log", "rim": "mirror,free"})
    [{'r2_star': '112.242', 'rim': 'mirror'}, {'r2_star': '22.347', 'rim': 'mirror'}]
    """
    count = checks.whole("number of random cases", count, least=1)
    seed = checks.whole("seed", seed, least=0)
    if not isinstance(ranges, Mapping) or not ranges:
        wanted = "ranges of the random cases must be a mapping of columns to ranges as texts"
        raise ValueError(f"{wanted}, got {checks.shown(ranges)}")
    columns = {name: _range(name, text) for name, text in ranges.items()}
    share = np.random.default_rng(seed).random
    return [{name: at(share()) for name, at in columns.items()} for _ in range(count)]


def _range(name, text):
    """Function of a number from 0 to 1 that gives a text within a range."""
    ends = checks.instance(f"range of {name}", text, str).split(":")
    if len(ends) == 1:
        values = [value.strip() for value in text.split(",")]
        return lambda x: values[int(x * len(values))]
    if len(ends) > 3 or ends[2:] not in ([], ["log"]):
        wanted = f"range of {name} must be low:high, low:high:log, or values separated by commas"
        raise ValueError(f"{wanted}, got {text!r}")
    known = {**INPUTS["scenes"], **INPUTS["joints"]}
    unit = known[name].unit if name in known else ""
    low, high = (checks.read(f"range of {name}", end, unit=unit) for end in ends[:2])
    checks.number(f"low end of the range of {name}", low, above=0 if ends[2:] else None)
    checks.number(f"high end of the range of {name}", high, above=low)
    if ends[2:]:
        return lambda x: f"{low * (high / low) ** x:.6g}"
    return lambda x: f"{low + (high - low) * x:.6g}"
