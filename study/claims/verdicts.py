"""Verdicts on the paper's statements, from numbers in the results of this study.

``data/published/claims.csv`` has the statements, in our own words; ``data/datapackage.json``
describes its columns. Each row names the result, the row and the column of the number with which
the statement is compared, the expected number, and its tolerance. Where the paper leaves something
open, there is a number for each reading that can be quoted from its text or that fills in missing
data. Where it states no bound, this study chose one, and half and twice this bound are applied too.
"""

from collections.abc import Sequence
from itertools import combinations, product
from typing import Literal, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study import checks, paths
from study.dataset import store

Verdict = Literal["contradicted", "undecided", "reproduced"]
Relation = Literal["=", "<", "<=", ">", ">="]
VERDICTS, RELATIONS = get_args(Verdict), get_args(Relation)
KINDS = ("stated", "implied only", "used to identify", "trivially satisfied")
"""Only the verdict on a statement of the kind ``stated`` is evidence for or against the paper. The
paper does not say the others explicitly, or they were used to identify the reference joint (or
follow from what was used), or nearly any result would satisfy them."""
MISSING = {"data": "data are missing", "wording": "wording allows several readings"}
"""Why a statement is undecided, by what distinguishes its readings."""
NO_TOLERANCE = "a tolerance is missing"
REASONS = (*MISSING.values(), NO_TOLERANCE)
CLAIMS = paths.DATA / "published/claims.csv"


def load() -> pd.DataFrame:
    """Load the statements, without verdicts: a table of text.

    Its column ``bounds`` has pairs of numbers from ``expected`` and ``tolerance``: one pair, or two
    if this study chose the bound. Raises `study.dataset.DatasetError` if the file is missing or
    damaged, and `study.checks.StudyError` if a bound is no number.
    """
    claims, published = store.read(CLAIMS, keep_default_na=False, dtype=str), store.published()
    bounds = []
    with checks.intact(paths.shown(CLAIMS)):
        for row in claims.itertuples():
            key = tuple(row.expected.split("/"))  # of a number that the paper prints
            numbers = [published[key]] if len(key) == 3 else row.expected.split(" to ")
            pairs = product(numbers, row.tolerance.split(" to "))
            bounds.append([(float(number), float(tolerance)) for number, tolerance in pairs])
    shown = [" to ".join(dict.fromkeys(f"{number:g}" for number, _ in pairs)) for pairs in bounds]
    return claims.assign(expected=shown, bounds=bounds)


def readings(evidence: str, row: str, column: str) -> dict[str, float]:
    """Numbers with which a statement is compared, by reading.

    A reading is, for example, one of the models, materials or durations that the statement allows.
    The numbers are in ``column`` of the result ``evidence`` (`study.paths.read_result`), in those
    rows whose ``quantity`` is ``row``; its column ``reading``, if there is one, names them. Raises
    `study.checks.StudyError` if there are none, or if one is not finite.
    """
    path = paths.read_result(f"{evidence}.csv")
    table = pd.read_csv(path) if path.is_file() else pd.DataFrame({"quantity": []})
    rows = table[table["quantity"] == row]
    numbers = pd.to_numeric(rows.get(column, pd.Series(dtype=float)), errors="coerce")
    if numbers.empty or not np.isfinite(numbers).all():
        raise checks.StudyError(
            f"{paths.shown(path)} must have finite numbers in the column {column} of the quantity "
            f"{row!r}; make it with: study run {evidence}"
        )
    return dict(zip(rows.get("reading", ["this study"] * len(rows)), numbers, strict=True))


def judge() -> pd.DataFrame:
    """Verdict on every statement from the results, ordered by kind and verdict.

    The table is that of `load` without ``row``, ``column``, ``readings`` and ``assumes``, and with
    ``found`` (readings with their numbers, as text), ``lowest``, ``highest``, ``verdict``,
    ``undecided_because`` and ``depends_on``.
    Raises the errors of `load` and `readings`.
    """
    claims, results = load(), []
    for claim in claims.itertuples():
        numbers = readings(claim.evidence, claim.row, claim.column)
        values = list(numbers.values())
        held = holds(values, claim.relation, claim.bounds)
        found = verdict(values, claim.relation, claim.bounds)
        results.append(
            {
                "found": "; ".join(f"{name}: {value:.4g}" for name, value in numbers.items()),
                "lowest": min(values),
                "highest": max(values),
                "verdict": found,
                "undecided_because": reason(held, claim.readings) if found == "undecided" else "",
                "depends_on": "; ".join(depends_on(list(numbers), held)) or claim.assumes,
            }
        )
    judged = claims.drop(columns=["row", "column", "readings", "assumes", "bounds"])
    judged, order = judged.join(pd.DataFrame(results)), (*KINDS, *VERDICTS, "", *REASONS).index
    by = ["kind", "verdict", "undecided_because"]
    return judged.sort_values(by, key=lambda x: x.map(order), ignore_index=True)


def holds(
    values: Sequence[float], relation: Relation, bounds: Sequence[tuple[float, float]]
) -> NDArray[np.bool_]:
    """Whether a statement is satisfied: shape (readings, bounds).

    A number must be equal to the expected one (``=``), less (``<``), at most as large (``<=``),
    more (``>``), or at least as large (``>=``). Each bound is the expected number, not
    0, and the deviation in percent of it that is allowed.
    """
    expected, tolerance = np.asarray(bounds, float).T
    excess = (np.asarray(values)[:, None] - expected) / np.abs(expected) * 100
    excess = {"=": np.abs(excess), "<": excess, ">": -excess}[relation[0]]
    return excess < tolerance if relation in ("<", ">") else excess <= tolerance


def verdict(
    values: Sequence[float], relation: Relation, bounds: Sequence[tuple[float, float]]
) -> Verdict:
    """Verdict on one statement from its numbers, one for each reading; parameters as for `holds`.

    It is ``reproduced`` if the statement is satisfied for every reading and bound, and
    ``contradicted`` if it is satisfied for none. Otherwise it is ``undecided``, because the verdict
    depends on what the paper does not say. It is also undecided if the numbers of the readings are
    on both sides of a number that the paper states.
    """
    held = holds(values, relation, bounds)
    if held.all():
        return "reproduced"
    between = relation == "=" and min(values) < min(bounds)[0] < max(values)
    return "undecided" if held.any() or between else "contradicted"


def reason(held: NDArray[np.bool_], readings: str) -> str:
    """Why a statement is undecided: one of `REASONS`.

    ``held`` is the result of `holds`, and ``readings`` says what distinguishes the readings, as the
    column of the statements does. Only if all readings agree at every tolerance, which they do not
    decide then, a tolerance is missing.
    """
    by_tolerance = held.any() and (held == held[0]).all()
    return NO_TOLERANCE if by_tolerance else MISSING[readings]


def depends_on(readings: Sequence[str], held: NDArray[np.bool_]) -> list[str]:
    """What the verdict on a statement depends on: parts of the names of readings, or the bound.

    The name of a reading consists of parts, for example ``rigid links, 50 ms``; ``held`` is the
    result of `holds`. The verdict depends on ``50 ms or 200 ms`` if a change of this part alone
    changes whether the statement is satisfied.
    """
    parts, found = [name.split(", ") for name in readings], dict[int, dict[str, None]]()
    for (one, first), (other, second) in combinations(zip(parts, held, strict=True), 2):
        apart = [k for k, pair in enumerate(zip(one, other, strict=True)) if len(set(pair)) > 1]
        if len(apart) == 1 and (first != second).any():
            found.setdefault(apart[0], {}).update({one[apart[0]]: None, other[apart[0]]: None})
    decisive = [" or ".join(names) for _, names in sorted(found.items())]
    if (held.any(axis=1) & ~held.all(axis=1)).any():
        decisive.append("the tolerance, which this study chose")
    return decisive
