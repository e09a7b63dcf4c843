"""The paper's checkable statements, each judged by a number from this study's results.

``data/published/claims.csv`` holds the statements in our own words, and for each what it is
judged by: a rule of `study.rules`, what its number should be and how far off it may be. What a
statement means is judged here; whether the results themselves are right is judged by the tests.
"""

import numpy as np
import pandas as pd

from study import dataset, paths
from study.rules import RULES, ClaimError, result

VERDICTS = ("reproduced", "partly", "not reproduced", "cannot be decided")
RELATIONS = ("=", "<", ">")


def load():
    """The claims as they are kept, without verdicts.

    Returns
    -------
    pandas.DataFrame
        Columns ``claim``, ``part``, ``where`` (in the paper), ``statement`` (our words),
        ``measure`` (the number that judges it), ``rule`` and ``of`` (how it is computed),
        ``relation``, ``expected`` (a number), ``tolerance`` and ``partly`` (percent of
        ``expected``), ``figure`` (a result that shows it) and ``evidence`` (the results that
        it is computed from, separated by spaces).

    Raises
    ------
    ClaimError
        If a claim has no rule, an unknown relation or a name that stands twice, tolerances that
        are no numbers with 0 <= tolerance <= partly, or expects 0, what is no number, or a
        number that the published tables do not hold.
    """
    frame = pd.read_csv(paths.DATA / "published/claims.csv", keep_default_na=False)
    stated = dataset.published()
    for column in ("tolerance", "partly"):
        frame[column] = pd.to_numeric(frame[column], errors="coerce")
    for row in frame.itertuples():
        if row.claim in set(frame.claim[: row.Index]):
            raise ClaimError(f"claim {row.claim} stands twice")
        if not 0 <= row.tolerance <= row.partly:
            raise ClaimError(f"claim {row.claim} must have tolerances 0 <= tolerance <= partly")
        if row.rule not in RULES:
            raise ClaimError(f"claim {row.claim} has no rule: {row.rule!r} is not in study.rules")
        if row.relation not in RELATIONS:
            known = ", ".join(RELATIONS)
            raise ClaimError(
                f"relation of {row.claim} must be one of {known}, got {row.relation!r}"
            )
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


def judge():
    """Judge every claim from the results in ``figures/``.

    Returns
    -------
    pandas.DataFrame
        That of `load` without ``rule`` and ``of``, and ``found`` (readings with their numbers,
        as text), ``lowest`` and ``highest`` (of the numbers) and ``verdict``.

    Raises
    ------
    ClaimError
        If a result that a claim is judged by is missing, or a number is not finite.
    """
    result.cache_clear()
    frame = load()
    rows = []
    for row in frame.itertuples():
        for name in row.evidence.split():
            result(name)
        try:
            found = RULES[row.rule](row.of)
        except (LookupError, ValueError, TypeError, AttributeError) as error:
            message = f"{row.claim}: rule {row.rule} fails for {row.of!r} ({error!r})"
            raise ClaimError(message) from None
        if not found or not np.isfinite(list(found.values())).all():
            raise ClaimError(f"claim {row.claim} must be judged by finite numbers, got {found}")
        terms = row.relation, row.expected, row.tolerance, row.partly
        text = "; ".join(f"{reading}: {value:.4g}" for reading, value in found.items())
        ends = {"lowest": min(found.values()), "highest": max(found.values())}
        rows.append({"found": text, **ends, "verdict": verdict(list(found.values()), *terms)})
    return frame.drop(columns=["rule", "of"]).join(pd.DataFrame(rows))


def verdict(values, relation, expected, tolerance, partly):
    """Verdict on one claim from its numbers, one per reading.

    Parameters
    ----------
    values : sequence of float
    relation : {"=", "<", ">"}
        The number should equal ``expected``, not exceed it, or not be less.
    expected : float
        Not 0.
    tolerance, partly : float
        Deviations from ``expected``, in percent of it, up to which a reading holds, and holds
        in part.

    Returns
    -------
    str
        ``reproduced`` if every reading holds, ``not reproduced`` if none holds even in part,
        ``cannot be decided`` if some hold and others do not even in part, so that the verdict
        hangs on what the paper does not say; else ``partly``.
    """
    excess = (np.asarray(values) - expected) / abs(expected) * 100
    excess = {"=": np.abs(excess), "<": excess, ">": -excess}[relation]
    holds, in_part = excess <= tolerance, excess <= partly
    if holds.all():
        return "reproduced"
    if not in_part.any():
        return "not reproduced"
    if holds.any() and not in_part.all():
        return "cannot be decided"
    return "partly"
