"""Cases of a parameter study: the columns of their table, and the results of each case.

A case is a mapping of columns to texts, as in a CSV file. The columns are options of `study joint`
or `study simulate`. Further columns of the user are copied to the table. Semicolons separate the
values of an option that may be repeated.

The results are quantities of a `study.joint.Solution` or a `study.mechanism.Response`, and a few
more of `COLUMNS`.
"""

import csv
import re
from collections.abc import Callable, Iterable, Mapping
from difflib import SequenceMatcher
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from study import checks, parameters
from study.checks import StudyError
from study.contact import SOCKET_RATIO
from study.contact.power_fit import PowerFit
from study.joint import Joint, limits
from study.joint.joint import SUPPORTS
from study.joint.solution import quantities
from study.joint.tilted import LARGEST_TILT
from study.mechanism import Response, Scene
from study.mechanism.compare import second_run
from study.mechanism.law_in_scene import LAW, of_name
from study.mechanism.response import exceeded_limits
from study.mechanism.simulate import BEAM_STEP, ELEMENTS, TOLERANCE, ready, simulate
from study.parameters import Parameter, Quantity, described

Kind = Literal["joints", "scenes"]
Case = dict[str, str]
Rows = list[list[str]]
NAME, ERROR = "case", "error"
"""First column of every table (name or number of the case) and last one (reason of a failure)."""
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
    }


_OF_RESPONSE = {
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
}
COLUMNS: dict[str, dict[str, Quantity]] = {
    "joints": _of_joints(False),
    "joints with dimensions": _of_joints(True),
    "scenes": _OF_RESPONSE,
    "scenes run twice": _OF_RESPONSE
    | {
        "agrees_until": Quantity(
            "Time until which a run at a second tolerance agrees; only for rigid links", "s"
        )
    },
}
"""Results of a case by column, for each form of the cases."""
_UNIT = re.compile(r"[\s_]*[(\[].*[)\]]$|[\s_](mm?|um|k?n|[km]?pa|gpa|deg)$")
"""A unit at the end of a column's name, in lower case."""


def load(cases: Path | Iterable[Mapping[str, Any]]) -> list[Case]:
    """Cases from a CSV file, or from mappings, as texts; empty texts are left out.

    Raises ``ValueError`` if there is no case, if a file is not CSV text, or if a row has another
    length.
    """
    rows = _from_csv(cases) if isinstance(cases, Path) else [_as_texts(case) for case in cases]
    if not rows:
        raise ValueError("cases must have at least one row, got none")
    return [{name: text for name, text in row.items() if text} for row in rows]


def _from_csv(path):
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = [[cell.strip() for cell in row] for row in csv.reader(file) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        why = getattr(error, "strerror", None) or "it is not CSV text in UTF-8"
        raise ValueError(f"cases must be a CSV file, got {path}: {why}") from None
    names, *rows = rows or [[]]
    if len(set(names)) < len(names):
        raise ValueError(f"each column must have a different name, got {', '.join(names)}")
    for number, row in enumerate(rows, 1):
        if len(row) != len(names):
            wanted = f"row {number} must have {len(names)} cells, as many as there are column names"
            raise ValueError(f"{wanted}, got {len(row)}")
    return [dict(zip(names, row, strict=True)) for row in rows]


def _as_texts(case):
    if not isinstance(case, Mapping):
        shown = checks.shown(case)
        raise ValueError(f"each of cases must be a mapping of columns to values, got {shown}")
    return {str(name): _text(value) for name, value in case.items()}


def _text(value):
    """Text of a cell from a Python value; a list has several values, a tuple is one value.

    None is an empty cell, for the default. A missing number (NaN) raises an error where it is read:
    it may be the result of a calculation.
    """
    if isinstance(value, list | tuple | np.ndarray):
        return ("," if isinstance(value, tuple) else ";").join(map(_text, value))
    return "" if value is None else str(value)


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
    low, high = (checks.read(f"range of {name}", end) for end in ends[:2])
    checks.number(f"low end of the range of {name}", low, above=0 if ends[2:] else None)
    checks.number(f"high end of the range of {name}", high, above=low)
    if ends[2:]:
        return lambda x: f"{low * (high / low) ** x:.6g}"
    return lambda x: f"{low + (high - low) * x:.6g}"


def prepared(
    kind: Kind, cases: list[Case], twice: bool = False
) -> tuple[str, list[str], list[Case]]:
    """Form of the cases (a key of `COLUMNS`), key of each case (`Form`), and its complete cells.

    The complete cells include the default values that are used. Mechanisms may be simulated
    ``twice``. A case with invalid values is not completed; `solve` returns the reason. Raises
    ``ValueError`` if no case is valid (the message names row and column), or for an invalid column.
    """
    checks.choice("kind", kind, get_args(Kind))
    columns = list(dict.fromkeys(name for case in cases for name in case))
    form: str = kind
    if kind == "joints" and "r2_star" not in columns:
        form = "joints with dimensions"
    if checks.flag("twice", twice):
        if kind != "scenes":
            raise ValueError(f"twice applies to scenes only, got {kind}; remove it")
        form = "scenes run twice"
    for column in own_columns(form, columns):
        _check_own(form, column)
    reasons: list[str] = []
    keys: list[str] = []
    complete: list[Case] = []
    rows: dict[str, int] = {}
    for row, case in enumerate(cases, 1):
        name = case.get(NAME, str(row))
        if name in rows:
            other = f"got {name!r} also in row {rows[name]}"
            raise ValueError(f"row {row}: {NAME} must have a different name in each row, {other}")
        if name.startswith(checks.FORMULA) and not _is_number(name):
            wanted = f"{NAME} must not begin like the formula of a spreadsheet"
            raise ValueError(f"row {row}: {wanted}, got {name!r}")
        rows[name] = row
        try:
            key, _, values = _prepare(form, case)
        except ValueError as error:
            reasons.append(f"row {row}: {error}")
            key, values = "", {}
        keys.append(key)
        used = {name: values[name] for name in columns if values.get(name) is not None}
        written = {name: FORMS[form].columns[name].written(value) for name, value in used.items()}
        cells = written | case
        complete.append({name: cells[name] for name in columns if name in cells})
    if len(reasons) == len(cases):
        raise ValueError(reasons[0])
    return form, keys, complete


def own_columns(form: str, columns: Iterable[str]) -> list[str]:
    """Columns that are not parameters of the cases; they are copied to the table."""
    return [name for name in columns if name not in (NAME, *FORMS[form].columns)]


def _check_own(form, column):
    """Raise ``ValueError`` for a column with the name of a result or similar to a parameter."""
    if column in (*COLUMNS[form], ERROR):
        raise ValueError(
            f"column {column} must have another name, because the table of results has one of this "
            "name"
        )
    for other, of in FORMS.items():
        if column in of.columns:
            wanted = f"column {column} must be removed or have another name"
            raise ValueError(f"{wanted}, because it is a parameter of {other} and not of {form}")
    name = _UNIT.sub("", column.lower())
    for known in (NAME, *FORMS[form].columns):
        if _letters_between(name, known) <= (1 if len(known) < _LONG else 2):
            raise ValueError(
                f"column {column} is not a parameter: did you mean {known}? Parameters have names "
                "without units and values in SI units. A column that is only to be copied must "
                "have a name that differs more from theirs"
            )


_LONG = 6  # letters of a name in which two may be wrong


def _letters_between(name, other):
    same = SequenceMatcher(None, name, other).get_matching_blocks()
    return max(len(name), len(other)) - sum(block.size for block in same)


def _is_number(text):
    try:
        checks.read("", text)
    except ValueError:
        return False
    return True


def solve(form: str, cases: list[Case]) -> list[Rows]:
    """Rows of results of each case: cells with 9 significant digits.

    A case that fails has one row with the reason.
    """
    return [_rows(form, case) for case in cases]


def _rows(form, case):
    columns = COLUMNS[form]
    try:
        results = _prepare(form, case)[1]()
        cells = [_cells(name, results[name]) for name in columns]
    except Exception as error:  # written to the table, and counted: the other cases go on
        known = isinstance(error, ValueError | StudyError)
        reason = str(error) if known else f"{type(error).__name__}: {error}"
        return [[""] * len(columns) + [" ".join(reason.split())]]
    count = max(map(len, cells))
    full = [column * count if len(column) == 1 else column for column in cells]
    return [[*row, ""] for row in zip(*full, strict=True)]


def _cells(name, values):
    if isinstance(values, str | list):
        return np.atleast_1d(values).tolist()
    return [f"{value:.9g}" for value in np.atleast_1d(checks.number(name, values))]


def _prepare(form, case):
    """Key of a case, the function that solves it, and the values that it uses (`Form`)."""
    columns, needed, prepare = FORMS[form]
    for name in needed:
        if name not in case:
            instead = ""
            if form == "joints with dimensions":
                instead = ", or r2_star for a joint without dimensions"
            raise ValueError(f"{name} must be given{instead}")
    about = {name: columns[name] for name in case if name in columns}
    return prepare({name: of.taken(name, of.read(name, case[name])) for name, of in about.items()})


def _joint(values, dimensions):
    """A joint with dimensions, or by its ratios; its results are those of a `Solution`."""
    asked = {name: values.pop(name) for name in ("depth", "force", "depth_star") if name in values}
    if len(asked) > 1:
        raise ValueError("depth and force must not both be given; remove one of them")
    tilt = values.pop("tilt", None)
    given = values if tilt is None else {"rim": "free"} | values
    if "layer" in given:
        given["layers"] = given.pop("layer")
    joint = Joint(**given) if dimensions else Joint.from_ratios(**given)
    tilt = joint.default_tilt if tilt is None else tilt

    def solved():
        if asked:
            solution = joint.solve(**asked, tilt=tilt, stresses=dimensions)
        else:
            solution = joint.curve(tilt=tilt, stresses=dimensions)
        names = quantities(dimensions)
        arrays = {name: getattr(solution, name) for name in names}
        found = {_RENAMED.get(n, n): "" if of is None else of for n, of in arrays.items()}
        factors = [factor for factor in solution.yield_factor.values() if factor is not None]
        found["yield_factor"] = np.min(factors, axis=0) if factors else ""
        found["applicability"] = [limits.in_short(each) for each in solution.limits]
        return found | _power(joint, solution.direction_deg)

    used = vars(joint) | {name: getattr(joint, name) for name in ("r2_star", "socket_ratio")}
    used |= {"modulus_ratio": joint.modulus_ratio, "poisson": joint.ball.poisson}
    used |= {
        "socket_poisson": joint.innermost.poisson,
        "layer": joint.layers if joint.liner else (),
        "tilt": tilt,
    }
    return repr((joint.ball_body, joint.socket_body)), solved, used


def _power(joint, tilt):
    """Power law of a joint by column; empty if it cannot be solved over the range of the fit."""
    try:
        fit = (joint.power_law if joint.has_dimensions else joint.power_fit)(tilt=tilt)
    except (ValueError, StudyError):
        return {f"power_{name}": "" for name in PowerFit._fields}
    values = fit._asdict()
    return {f"power_{name}": value for name, value in values.items()}


def _scene(values, twice=False):
    of_scene = {name: values.pop(name) for name in described(Scene) if name in values}
    key = repr((of_scene, values)) if values.get("model", "rigid") != "rigid" else ""
    scene = Scene(**of_scene)
    socket = {
        name: values.pop(name) for name in ("wall", "socket_ratio", "liner") if name in values
    }
    complete = _used_by_scene(scene, **values, **socket)
    values["law"] = of_name(scene, values.get("law"), **socket)
    run, again = ready(scene, **values), partial(simulate, scene, **values) if twice else None
    return key, partial(_simulate, scene, run, again), complete


def _used_by_scene(scene, model="rigid", joint="clearance", law=LAW, **given):
    """Values that a simulation uses where none are given, None for what it does not have."""
    usual = {name: p.default for name, p in signature(simulate).parameters.items()}
    usual |= {"model": model, "joint": joint, "law": law}
    if model == "rigid":
        usual["tolerance"] = TOLERANCE if joint == "clearance" else None
    else:
        usual["elements"] = ELEMENTS
        usual |= {"method": "centred"} if model == "particles" else {"step": BEAM_STEP}
    thick = law in (LAW, "tabulated") and "wall" not in given
    usual["socket_ratio"] = SOCKET_RATIO if thick else None
    inertias = dict(zip(("crank_inertia", "coupler_inertia"), scene.inertias, strict=True))
    return usual | vars(scene) | inertias


def _simulate(scene, run, again):
    response = run()
    if not response.complete:
        raise KeyboardInterrupt
    angle, crank, coupler = response.crank_angle, scene.crank_length, scene.coupler_length
    ideal = crank * np.cos(angle) + np.sqrt(coupler**2 - (crank * np.sin(angle)) ** 2)
    deviation = np.abs(response.slider_position - ideal)
    try:
        agreement = None if again is None else second_run(response, again)
    except StudyError as error:
        raise StudyError(f"the run at a second tolerance failed: {error}") from None
    return {
        **{name: getattr(response, name) for name in parameters.quantities(Response)},
        "delivered_restitution": response.delivered_restitution,
        "mean_slider_deviation": deviation.mean(),
        "largest_slider_deviation": deviation.max(),
        "applicability": limits.in_short(exceeded_limits(scene, response)),
        "agrees_until": "" if agreement is None else agreement.until,
    }


class Form(NamedTuple):
    """How cases of one form are read and solved.

    ``prepare`` takes the values of the columns. It gives a key, a function that solves the case,
    and all values that this uses, by column. The results have the names of `COLUMNS`, and more.
    Cases with the same key share elastic bodies, or are quick: one process solves several of them,
    and keeps them together.
    """

    columns: Mapping[str, Parameter]
    needed: tuple[str, ...]
    prepare: Callable[[dict[str, Any]], tuple[str, Callable[[], Mapping], Mapping[str, Any]]]


_TILT = {
    "tilt": Parameter(
        "Angle off the axis of the displacement, or of the force if forces are given",
        "deg",
        {"least": 0, "most": LARGEST_TILT},
    )
}
_ASKED = {
    "depth_star": Parameter("Penetration depths d/dR", limits={"above": 0}, several=";"),
    "depth": Parameter("Penetration depths", "m", {"above": 0}, several=";"),
    "force": Parameter("Contact forces", "N", {"above": 0}, several=";"),
}
_RATIOS = described(Joint.from_ratios)
_RATIOS = {"layer" if name == "layers" else name: about for name, about in _RATIOS.items()}
_RATIOS |= {name: described(Joint)[name] for name in SUPPORTS}
_OF_SCENES = {
    **described(Scene),
    **{n: about for n, about in described(simulate).items() if n not in ("scene", "progress")},
    **{name: described(Joint)[name] for name in ("wall", "liner")},
    "socket_ratio": _RATIOS["socket_ratio"],
}
FORMS = {
    "joints": Form(
        _RATIOS | _TILT | {"depth_star": _ASKED["depth_star"]},
        ("r2_star",),
        partial(_joint, dimensions=False),
    ),
    "joints with dimensions": Form(
        described(Joint) | _TILT | {name: _ASKED[name] for name in ("depth", "force")},
        ("socket_radius", "clearance", "wall"),
        partial(_joint, dimensions=True),
    ),
    "scenes": Form(_OF_SCENES, (), _scene),
    "scenes run twice": Form(_OF_SCENES, (), partial(_scene, twice=True)),
}
"""By a name of `COLUMNS`."""
