"""The paper's checkable statements, each judged by a number from this study's results.

``data/published/claims.csv`` holds the statements in our own words. Each names a rule of `rules`,
what its number should be, and how far off it may be. The tests, not the verdicts, judge whether the
results are right.
"""

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np
import pandas as pd

from study import checks, dataset, paths
from study.claims.rules import RULES, ClaimError, result

Verdict = Literal["contradicted", "cannot be decided", "reproduced"]
Relation = Literal["=", "<", ">", "?"]
VERDICTS, RELATIONS = get_args(Verdict), get_args(Relation)
KINDS = ("stated", "implied only", "used to identify", "can hardly fail")
"""Only the verdict on a stated statement speaks for or against the paper. The others are not said
in so many words, served to identify the set-up, or hold by construction."""


def load() -> pd.DataFrame:
    """Load the claims, without verdicts.

    Returns
    -------
    pandas.DataFrame
        Columns ``claim``, ``part``, ``kind`` (of `KINDS`), ``where`` (in the paper),
        ``statement`` (our words), ``measure`` (the number that judges it), ``rule`` and ``of``
        (how it is computed), ``relation``, ``expected`` (a number), ``tolerance`` (percent of
        ``expected``), ``figure`` (a result that shows it) and ``evidence`` (the results it is
        computed from, separated by spaces).

    Raises
    ------
    ClaimError
        For a row that cannot be judged.
    """
    frame = pd.read_csv(paths.DATA / "published/claims.csv", keep_default_na=False)
    stated = dataset.published()
    frame["tolerance"] = pd.to_numeric(frame["tolerance"], errors="coerce")
    for row in frame.itertuples():
        if row.claim in set(frame.claim[: row.Index]):
            raise ClaimError(f"claim {row.claim} occurs twice")
        if not 0 <= row.tolerance < np.inf:
            raise ClaimError(f"tolerance of {row.claim} must be a number >= 0, in percent")
        if row.rule not in RULES:
            known = "is not in study.claims.rules"
            raise ClaimError(f"claim {row.claim} has no rule: {row.rule!r} {known}")
        for column, known in (("kind", KINDS), ("relation", RELATIONS)):
            value = getattr(row, column)
            if value not in known:
                listed = ", ".join(known)
                raise ClaimError(f"{column} of {row.claim} must be one of {listed}, got {value!r}")
    frame["expected"] = [_expected(row.claim, row.expected, stated) for row in frame.itertuples()]
    return frame


def _expected(claim, text, stated):
    """A number, or the published one that ``where/row/quantity`` names; never 0."""
    key = tuple(text.split("/"))
    if len(key) == 3 and key not in stated.index:
        raise ClaimError(f"claim {claim} expects {text}, which data/published/tables.csv lacks")
    try:
        value = float(stated[key] if len(key) == 3 else text)
    except ValueError:
        raise ClaimError(f"expected of {claim} must be a number, got {text!r}") from None
    if value == 0 or not np.isfinite(value):
        raise ClaimError(f"expected of {claim} must not be 0 (tolerances are relative), got {text}")
    return value


def judge() -> pd.DataFrame:
    """Judge every claim from the results in ``figures/``.

    Returns
    -------
    pandas.DataFrame
        That of `load` without ``rule`` and ``of``, and ``found`` (readings with their numbers,
        as text), ``lowest``, ``highest`` and ``verdict``; ordered by kind, then by verdict.

    Raises
    ------
    ClaimError
        If a result that a claim is judged by is missing, or a number is not finite.
    """
    result.cache_clear()
    claims, rank = load(), {name: n for n, name in enumerate(KINDS + VERDICTS)}
    found = pd.DataFrame(map(_judge, claims.itertuples()))
    order = {"key": lambda column: column.map(rank), "kind": "stable", "ignore_index": True}
    return claims.drop(columns=["rule", "of"]).join(found).sort_values(["kind", "verdict"], **order)


def _judge(claim):
    for name in claim.evidence.split():
        result(name)
    try:
        found = RULES[claim.rule](claim.of)
    except ClaimError as error:
        raise ClaimError(f"claim {claim.claim}: {error}") from None
    except LookupError as error:  # results of other parameters than the catalogue's
        message = f"claim {claim.claim}: rule {claim.rule} finds no {error} in {claim.evidence}"
        raise ClaimError(f"{message}; rebuild it with: study run {claim.evidence}") from None
    values = list(found.values())
    if not found or not np.isfinite(values).all():
        raise ClaimError(f"claim {claim.claim} must be judged by finite numbers, got {found}")
    return {
        "found": "; ".join(f"{reading}: {value:.4g}" for reading, value in found.items()),
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
    values = np.atleast_1d(checks.number("values", values))
    if values.size == 0:
        raise ValueError("values must hold a number, got none")
    checks.choice("relation", relation, RELATIONS)
    checks.number("tolerance", tolerance, "%", least=0, scalar=True)
    if checks.number("expected", expected, scalar=True) == 0:
        raise ValueError("expected must not be 0 (tolerances are relative), got 0")
    if relation == "?":
        return "cannot be decided"
    excess = (values - expected) / abs(expected) * 100
    holds = {"=": np.abs(excess), "<": excess, ">": -excess}[relation] <= tolerance
    if holds.all():
        return "reproduced"
    return "cannot be decided" if holds.any() else "contradicted"
