"""Cases of a parameter study: the columns of their table, and the results of each case.

A case is a mapping of columns to texts, as in a CSV file. The columns are options of `study joint`
or `study simulate`. Further columns of the user are copied to the table. Semicolons separate the
values of an option that may be repeated.

A new column of results needs its unit and meaning in ``columns.toml``, and its value in the
function that solves the cases of its form.
"""

import csv
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from difflib import SequenceMatcher
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from study import checks
from study.checks import StudyError
from study.contact import SOCKET_RATIO, tabulated
from study.contact.power_fit import DEPTHS, USUAL_RANGE, PowerFit, fit_power
from study.joint import (
    DimensionalJoint,
    RatioJoint,
    applicability,
    force_curve,
    tilted_contact,
    whole_curve,
)
from study.joint.dimensional import usual_depth
from study.joint.tilted import LARGEST_TILT
from study.mechanism import Scene
from study.mechanism.compare import second_run
from study.mechanism.simulate import BEAM_STEP, ELEMENTS, LAW, TOLERANCE, ready, simulate
from study.mechanism.validity import exceeded_limits
from study.parameters import Parameter, described

Kind = Literal["joints", "scenes"]
Case = dict[str, str]
Rows = list[list[str]]
NAME, ERROR = "case", "error"
"""First column of every table (name or number of the case) and last one (reason of a failure)."""
COLUMNS: dict[str, dict[str, tuple[str, str]]] = {
    form: {name: (unit, meaning) for name, (unit, meaning) in columns.items()}
    for form, columns in tomllib.loads(
        Path(__file__).with_name("columns.toml").read_text(encoding="utf-8")
    ).items()
}
"""Results of a case, by the form of the cases: column -> unit and meaning."""
COLUMNS["scenes run twice"] = COLUMNS["scenes"] | COLUMNS["scenes run twice"]
FITTED = np.geomspace(*USUAL_RANGE, 8)
"""Depths in clearances at which k and n are fitted if each depth takes a tenth of a second, that is
off the axis and with large displacements. A case off the axis without given depths is
solved at these depths.

With 40 depths the error of the fit to a ring at 90 deg is 3.373 % instead of 3.366 %."""
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


def _joint(values):
    asked = {name: values.pop(name) for name in ("depth_star",) if name in values}
    given, tilt = _tilted(RatioJoint, values)
    joint = given.joint()

    def solved():
        if tilt is not None:
            solve = partial(tilted_contact, joint, tilt=tilt)
            contact, power = _off_axis(solve, "depth_star", asked, FITTED)
            return _results(contact, applicability.of_contact(contact), power)
        if asked:
            curve, slope, table = force_curve(joint, **asked), "", None
        else:
            curve = whole_curve(joint, usual_depth(joint))
            table = tabulated(curve)
            slope = table(curve.depth_star, joint.r2_star, derivative=True)
        power = _fitted(lambda: _power_star(joint, table))
        found = _results(curve, applicability.of_curve(curve), power)
        return found | {"stiffness_star": slope}

    used = {"socket_ratio": joint.socket_ratio, "modulus_ratio": joint.modulus_ratio}
    used |= {"socket_poisson": joint.socket.poisson, "rim": joint.rim, "tilt": tilt}
    return _bodies(joint), solved, vars(given) | used


def _tilted(kind, values):
    """Joint of a class, and the tilt of its load or None; with a tilt the rim is free."""
    tilt = values.pop("tilt", None)
    joint = kind(**({} if tilt is None else {"rim": "free"}) | values)
    return joint, joint.default_tilt if tilt is None else tilt


def _off_axis(solve, depth, asked, places):
    """A contact at what is asked for, or at some depths, and k and n over these depths.

    ``solve`` takes the depths by the name ``depth``, or what is asked for.
    """
    contact = solve(**(asked or {depth: places}))
    along = (lambda: solve(**{depth: places})) if asked else (lambda: contact)

    def power():
        found = vars(along())
        return fit_power(found[depth], found[depth.replace("depth", "force")])

    return contact, _fitted(power)


def _power_star(joint, table):
    """Power law along the axis, by the table of the whole curve if it is known."""
    if table is None and joint.has_large_displacements:
        return fit_power(FITTED, force_curve(joint, FITTED).force_star)
    places = np.geomspace(*USUAL_RANGE, DEPTHS)
    return fit_power(places, (table or tabulated(whole_curve(joint, USUAL_RANGE[1])))(places))


def _fitted(fit: Callable[[], PowerFit]) -> PowerFit | None:
    """A fit, or None if the joint cannot be solved over the whole range of the fit."""
    try:
        return fit()
    except (ValueError, StudyError):
        return None


def _results(solution, limits, power):
    """Results of a joint by column, with its limits in short and its power law."""
    of_power = power._asdict() if power else dict.fromkeys(PowerFit._fields, "")
    along_axis = {"transverse": 0.0, "transverse_star": 0.0, "displacement_tilt": 0.0}
    found = along_axis | {"peak_error": "", "yield_factor": ""} | vars(solution)
    if "tilt" in found:
        half_angle = solution.contact_half_angle_deg
        found |= {"displacement_tilt": solution.tilt, "contact_half_angle_deg": half_angle}
    found |= {f"power_{name}": value for name, value in of_power.items()}
    return found | {"applicability": [applicability.in_short(each) for each in limits]}


def _bodies(joint):
    """Key of the compliances of a joint's bodies, or of a joint with large displacements itself."""
    bodies = joint.ball_body, joint.socket_body
    return repr(joint if joint.has_large_displacements else bodies)


def _dimensional_joint(values):
    asked = {name: values.pop(name) for name in _ASKED if name in values}
    if len(asked) > 1:
        raise ValueError("depth and force must not both be given; remove one of them")
    joint, tilt = _tilted(DimensionalJoint, values)

    def solved():
        if tilt is None:
            solution = joint.solve(**asked) if asked else joint.curve()
            power = _fitted(joint.power_law)
        else:
            solve, places = partial(joint.solve, tilt=tilt), joint.clearance * FITTED
            solution, power = _off_axis(solve, "depth", asked, places)
        factors = [factor for factor in solution.yield_factor.values() if factor is not None]
        nearest = np.min(factors, axis=0) if factors else ""
        found = _results(solution, solution.limits, power)
        return found | {"yield_factor": nearest}

    used = vars(joint) | {name: getattr(DimensionalJoint, name) for name in ("ball", "socket")}
    return _bodies(joint.joint), solved, used | {"tilt": tilt}


def _scene(values, twice=False):
    of_scene = {name: values.pop(name) for name in described(Scene) if name in values}
    key = repr((of_scene, values)) if values.get("model", "rigid") != "rigid" else ""
    scene = Scene(**of_scene)
    run, again = ready(scene, **values), partial(simulate, scene, **values) if twice else None
    return key, partial(_simulate, scene, run, again), _used_by_scene(scene, **values)


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
    impacts = response.impact_rows
    angle, crank, coupler = response.crank_angle, scene.crank_length, scene.coupler_length
    ideal = crank * np.cos(angle) + np.sqrt(coupler**2 - (crank * np.sin(angle)) ** 2)
    deviation = np.abs(response.slider_position - ideal)
    try:
        agreement = None if again is None else second_run(response, again)
    except StudyError as error:
        raise StudyError(f"the run at a second tolerance failed: {error}") from None
    return {
        "impacts": len(response.impact_rows),
        "largest_depth": impacts["peak_depth"].max(initial=0.0),
        "largest_force": impacts["peak_force"].max(initial=0.0),
        "energy_lost": response.lost_damping[-1] + response.lost_friction[-1],
        "delivered_restitution": response.delivered_restitution,
        "last_separation": response.last_separation,
        "mean_slider_deviation": deviation.mean(),
        "largest_slider_deviation": deviation.max(),
        "energy_error": response.energy_error,
        "applicability": applicability.in_short(exceeded_limits(scene, response)),
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
_DEPTHS = {"depth_star": Parameter("Penetration depths d/dR", limits={"least": 0}, several=";")}
_ASKED = {
    "depth": Parameter("Penetration depths", "m", {"above": 0}, several=";"),
    "force": Parameter("Contact forces", "N", {"above": 0}, several=";"),
}
_OF_SCENES = {
    **described(Scene),
    **{n: about for n, about in described(simulate).items() if n not in ("scene", "progress")},
    **{name: described(DimensionalJoint)[name] for name in ("wall", "liner")},
    "socket_ratio": described(RatioJoint)["socket_ratio"],
}
FORMS = {
    "joints": Form(described(RatioJoint) | _TILT | _DEPTHS, ("r2_star",), _joint),
    "joints with dimensions": Form(
        described(DimensionalJoint) | _TILT | _ASKED,
        ("socket_radius", "clearance", "wall"),
        _dimensional_joint,
    ),
    "scenes": Form(_OF_SCENES, (), _scene),
    "scenes run twice": Form(_OF_SCENES, (), partial(_scene, twice=True)),
}
"""By a name of `COLUMNS`."""
