"""The paper's checkable statements, each judged by numbers from this study's results.

``data/published/claims.csv`` holds the statements in our own words. Each names the result, row and
column of the number that judges it, what that number should be, and how far off it may be. The
notebooks compute the numbers. The tests, not the verdicts, judge whether the results are right.
"""

from collections.abc import Sequence
from functools import cache
from typing import Literal, get_args

import numpy as np
import pandas as pd

from study import checks, dataset, paths

Verdict = Literal["contradicted", "cannot be decided", "reproduced"]
Relation = Literal["=", "<", ">", "?"]
VERDICTS, RELATIONS = get_args(Verdict), get_args(Relation)
KINDS = ("stated", "implied only", "used to identify", "can hardly fail")
"""Only the verdict on a stated statement speaks for or against the paper. The others are not said
in so many words, served to identify the set-up, or hold by construction."""
COLUMNS = [
    *("claim", "part", "kind", "where", "statement", "measure", "relation", "expected"),
    *("tolerance", "figure", "evidence", "row", "column"),
]


class ClaimError(checks.StudyError):
    """A claim cannot be judged; the message names it and what is missing."""


def load() -> pd.DataFrame:
    """Load the claims, without verdicts.

    Returns
    -------
    pandas.DataFrame
        Columns ``claim``, ``part``, ``kind`` (of `KINDS`), ``where`` (in the paper),
        ``statement`` (our words), ``measure`` (the number that judges it), ``evidence``, ``row``
        and ``column`` (where that number is, see `readings`), ``relation``, ``expected`` (a
        number), ``tolerance`` (percent of ``expected``) and ``figure`` (a result that shows it).

    Raises
    ------
    ClaimError
        For a row that cannot be judged, or a file that is missing or no such table.
    """
    name = "data/published/claims.csv"
    try:
        claims = pd.read_csv(paths.DATA / "published/claims.csv", keep_default_na=False)[COLUMNS]
    except (FileNotFoundError, KeyError, ValueError):
        remedy = f"restore it with: git checkout -- {name}"
        raise ClaimError(f"{name} is missing or damaged; {remedy}") from None
    published = dataset.published()
    claims["tolerance"] = pd.to_numeric(claims.tolerance, errors="coerce")
    for row in claims.itertuples():
        if row.claim in set(claims.claim[: row.Index]):
            raise ClaimError(f"claim {row.claim} occurs twice")
        for column in ("claim", "part", "where", "statement", "measure"):
            text = str(getattr(row, column))
            if not text.isprintable() or text.startswith(checks.FORMULA):
                wanted = "one line that does not begin as a spreadsheet's formula"
                shown = f"{column} of {checks.shown(row.claim)} must be {wanted}"
                raise ClaimError(f"{shown}, got {checks.shown(text)}")
        if not 0 <= row.tolerance < np.inf:
            raise ClaimError(f"tolerance of {row.claim} must be a number >= 0, in percent")
        for column, known in (("kind", KINDS), ("relation", RELATIONS)):
            value = getattr(row, column)
            if value not in known:
                listed = ", ".join(known)
                raise ClaimError(f"{column} of {row.claim} must be one of {listed}, got {value!r}")
    claims["expected"] = [_expected(r.claim, r.expected, published) for r in claims.itertuples()]
    return claims


def _expected(claim, text, published):
    """A number, or the published one that ``where/row/quantity`` names; never 0."""
    key = tuple(text.split("/"))
    if len(key) == 3 and key not in published.index:
        raise ClaimError(f"claim {claim} expects {text}, which data/published/tables.csv lacks")
    try:
        value = float(published[key] if len(key) == 3 else text)
    except ValueError:
        raise ClaimError(f"expected of {claim} must be a number, got {text!r}") from None
    if value == 0 or not np.isfinite(value):
        raise ClaimError(f"expected of {claim} must not be 0 (tolerances are relative), got {text}")
    return value


@cache
def result(name: str) -> pd.DataFrame:
    """One result's numbers, from ``figures/``; ``ClaimError`` if they are missing."""
    path = paths.FIGURES / f"{name}.csv"
    if not path.is_file():
        raise ClaimError(f"figures/{name}.csv is missing; make it with: study run {name}")
    return pd.read_csv(path)


def readings(evidence: str, row: str, column: str) -> dict[str, float]:
    """Numbers that judge a claim, by reading: a model, material or duration that the paper allows.

    Parameters
    ----------
    evidence
        A result. Its column ``reading`` names the readings, if it has one.
    row
        Value of its column ``quantity``.
    column
        Column of the numbers.

    Raises
    ------
    ClaimError
        If the result, row or column is missing, or a number is not finite.
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
    """Judge every claim from the results in ``figures/``.

    Returns
    -------
    pandas.DataFrame
        That of `load` without ``row`` and ``column``, and ``found`` (readings with their numbers,
        as text), ``lowest``, ``highest`` and ``verdict``; ordered by kind, then by verdict.

    Raises
    ------
    ClaimError
        As for `load` and `readings`; names the claim.
    """
    result.cache_clear()
    claims = load()
    judged = claims.drop(columns=["row", "column"]).join(
        pd.DataFrame(map(_judge, claims.itertuples()))
    )
    for name, order in (("verdict", VERDICTS), ("kind", KINDS)):
        rank = judged[name].map(order.index)
        judged = judged.loc[rank.sort_values(kind="stable").index]
    return judged.reset_index(drop=True)


def _judge(claim):
    try:
        numbers = readings(claim.evidence, claim.row, claim.column)
    except ClaimError as error:
        raise ClaimError(f"claim {claim.claim}: {error}") from None
    values = list(numbers.values())
    return {
        "found": "; ".join(f"{reading}: {value:.4g}" for reading, value in numbers.items()),
        "lowest": min(values),
        "highest": max(values),
        "verdict": verdict(values, claim.relation, claim.expected, claim.tolerance),
    }


def verdict(
    values: Sequence[float], relation: Relation, expected: float, tolerance: float
) -> Verdict:
    """Verdict on one claim from its numbers, one per reading.

    ``reproduced`` if every reading holds, ``contradicted`` if none does, and ``cannot be
    decided`` if some do: the verdict then depends on what the paper does not say.

    Parameters
    ----------
    relation
        The number should equal ``expected`` (``=``), not exceed it (``<``), or not be less (``>``).
        With ``?`` the paper's text cannot decide. ``expected`` is not 0.
    tolerance
        Deviation from ``expected``, in percent of it, up to which a reading holds.
    """
    if relation == "?":
        return "cannot be decided"
    excess = (np.asarray(values) - expected) / abs(expected) * 100
    holds = {"=": np.abs(excess), "<": excess, ">": -excess}[relation] <= tolerance
    if holds.all():
        return "reproduced"
    return "cannot be decided" if holds.any() else "contradicted"
