"""The paper's checkable statements, each judged by numbers from this study's results.

``data/published/claims.csv`` has the statements, reworded. Each names the result, row and
column of the number that decides on it, the expected number, and its tolerance. Where
the paper leaves something open, there is a number for every reading; where it states no bound,
this study chose the bound, and half and twice this bound are applied too. The notebooks compute the
numbers; tests check whether the numbers are right.
"""

from collections.abc import Sequence
from itertools import combinations, product
from typing import Literal, get_args

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study import checks, dataset, paths

Verdict = Literal["contradicted", "undecided", "reproduced"]
Relation = Literal["=", "<", ">"]
VERDICTS, RELATIONS = get_args(Verdict), get_args(Relation)
KINDS = ("stated", "implied only", "used to identify", "trivially satisfied")
"""Only the verdict on a stated statement speaks for or against the paper. The others are not said
in so many words, served to identify the set-up or follow from what did, or nearly any result
would meet them."""
COLUMNS = [
    *("claim", "part", "kind", "where", "statement", "measure", "relation", "expected"),
    *("tolerance", "assumes", "figure", "evidence", "row", "column"),
]


class ClaimError(checks.StudyError):
    """A claim cannot be judged; the message names it and what is missing."""


def load() -> pd.DataFrame:
    """Load the claims, without verdicts: a table of text with the columns `COLUMNS`.

    ``kind`` is one of `KINDS`, ``statement`` is reworded, ``measure`` describes the number that
    decides on it, and ``evidence``, ``row`` and ``column`` say where that is (see `readings`).
    ``expected`` and ``tolerance`` (in percent of it) are a number each, or two as ``5 to 20`` where
    this study chose the bound. ``assumes`` is what the number depends on, ``figure`` a result that
    shows it. The further column ``bounds`` has pairs of the numbers expected and tolerance.

    Raises `ClaimError` for a row that cannot be judged, or if the file is missing or no such table.
    """
    name, as_text = "data/published/claims.csv", {"keep_default_na": False, "dtype": str}
    try:
        claims = pd.read_csv(paths.DATA / "published/claims.csv", **as_text)[COLUMNS]
    except (FileNotFoundError, KeyError, ValueError):
        remedy = f"restore it with: git checkout -- {name}"
        raise ClaimError(f"{name} is missing or damaged; {remedy}") from None
    published, bounds = dataset.published(), []
    for row in claims.itertuples():
        try:
            checks.choice(f"kind of {row.claim}", row.kind, KINDS)
            checks.choice(f"relation of {row.claim}", row.relation, RELATIONS)
            bounds.append(_bounds(row, published))
        except ValueError as error:
            raise ClaimError(str(error)) from None
    shown = [" to ".join(dict.fromkeys(f"{number:g}" for number, _ in pairs)) for pairs in bounds]
    return claims.assign(expected=shown, bounds=bounds)


def _bounds(claim, published):
    """Pairs of an expected number and a tolerance in percent, with which a claim is judged."""
    expected, key = claim.expected, tuple(claim.expected.split("/"))
    if len(key) == 3:
        if key not in published.index:
            lacking = "which data/published/tables.csv lacks"
            raise ValueError(f"claim {claim.claim} expects {expected}, {lacking}")
        expected = str(published[key])
    numbers = []
    for name, text in ("expected", expected), ("tolerance", claim.tolerance):
        what = f"{name} of {claim.claim}"
        numbers.append([checks.read(what, part) for part in text.split(" to ")])
        checks.number(what, numbers[-1], least=0 if name == "tolerance" else None)
    if 0 in numbers[0]:
        raise ValueError(f"expected of {claim.claim} must not be 0: tolerances are relative")
    return list(product(*numbers))


def result(name: str) -> pd.DataFrame:
    """One result's numbers, from ``figures/``; ``ClaimError`` if they are missing."""
    path = paths.FIGURES / f"{name}.csv"
    if not path.is_file():
        raise ClaimError(f"figures/{name}.csv is missing; make it with: study run {name}")
    return pd.read_csv(path)


def readings(evidence: str, row: str, column: str) -> dict[str, float]:
    """Numbers that decide on a claim, by reading: a model, material or duration that is allowed.

    They stand in a ``column`` of the result ``evidence`` where its column ``quantity`` is ``row``;
    its column ``reading``, if it has one, names the readings. Raises `ClaimError` if the result,
    row or column is missing, or a number is not finite.
    """
    table, remake = result(evidence), f"remake it with: study run {evidence}"
    for name in ("quantity", column):
        if name not in table:
            raise ClaimError(f"figures/{evidence}.csv has no column {name!r}; {remake}")
    rows = table[table.quantity == row]
    if rows.empty:
        raise ClaimError(f"figures/{evidence}.csv has no quantity {row!r}; {remake}")
    names = rows.get("reading", ["this study"] * len(rows))
    numbers = pd.to_numeric(rows[column], errors="coerce")
    if not np.isfinite(numbers).all():
        raise ClaimError(f"{column} of {row!r} in figures/{evidence}.csv must be finite numbers")
    return dict(zip(names, numbers, strict=True))


def judge() -> pd.DataFrame:
    """Judge every claim from the results in ``figures/``, ordered by kind, then by verdict.

    The table is that of `load` without ``row``, ``column`` and ``assumes``, and with ``found``
    (readings with their numbers, as text), ``lowest``, ``highest``, ``verdict`` and ``depends_on``.
    Raises `ClaimError` as `load` and `readings` do, and names the claim.
    """
    claims = load()
    judged = claims.drop(columns=["row", "column", "assumes", "bounds"]).join(
        pd.DataFrame(map(_judge, claims.itertuples()))
    )
    order = (*KINDS, *VERDICTS).index
    return judged.sort_values(["kind", "verdict"], key=lambda x: x.map(order), ignore_index=True)


def _judge(claim):
    try:
        numbers = readings(claim.evidence, claim.row, claim.column)
    except ClaimError as error:
        raise ClaimError(f"claim {claim.claim}: {error}") from None
    values = list(numbers.values())
    held = holds(values, claim.relation, claim.bounds)
    return {
        "found": "; ".join(f"{reading}: {value:.4g}" for reading, value in numbers.items()),
        "lowest": min(values),
        "highest": max(values),
        "verdict": verdict(values, claim.relation, claim.bounds),
        "depends_on": "; ".join(depends_on(list(numbers), held)) or claim.assumes,
    }


def holds(
    values: Sequence[float], relation: Relation, bounds: Sequence[tuple[float, float]]
) -> NDArray[np.bool_]:
    """Whether a statement holds: shape (readings, bounds).

    A number should equal the expected one (``=``), not exceed it (``<``), or not be less (``>``).
    Bounds are expected numbers, not 0, and deviations in percent of them up to which it holds.
    """
    expected, tolerance = np.asarray(bounds, float).T
    excess = (np.asarray(values)[:, None] - expected) / np.abs(expected) * 100
    return {"=": np.abs(excess), "<": excess, ">": -excess}[relation] <= tolerance


def verdict(
    values: Sequence[float], relation: Relation, bounds: Sequence[tuple[float, float]]
) -> Verdict:
    """Verdict on one claim from its numbers, one per reading; parameters as for `holds`.

    ``reproduced`` if it holds in every reading with every bound, ``contradicted`` if in none, and
    ``undecided`` otherwise: the verdict then depends on what the paper does not say. That
    is so, too, if readings lie on both sides of a number that is stated.
    """
    held = holds(values, relation, bounds)
    if held.all():
        return "reproduced"
    between = relation == "=" and min(values) < min(bounds)[0] < max(values)
    return "undecided" if held.any() or between else "contradicted"


def depends_on(readings: Sequence[str], held: NDArray[np.bool_]) -> list[str]:
    """What decides whether a statement holds: parts of its readings' names, or the bound.

    Readings have names in parts, as ``rigid links, 50 ms``; ``held`` is from `holds`. ``50 ms or
    200 ms`` decides if a change of this part alone changes whether the statement holds.
    """
    parts, found = [name.split(", ") for name in readings], {}
    for (one, first), (other, second) in combinations(zip(parts, held, strict=True), 2):
        apart = [k for k, pair in enumerate(zip(one, other, strict=True)) if len(set(pair)) > 1]
        if len(apart) == 1 and (first != second).any():
            found.setdefault(apart[0], {}).update({one[apart[0]]: None, other[apart[0]]: None})
    decisive = [" or ".join(names) for _, names in sorted(found.items())]
    if (held.any(axis=1) & ~held.all(axis=1)).any():
        decisive.append("the tolerance, which this study chose")
    return decisive
