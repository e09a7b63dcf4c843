"""The paper's checkable statements, each judged by a number from this study's results.

``data/published/claims.csv`` holds the statements in our own words, and for each what it is
judged by: a rule of `rules`, what its number should be and how far off it may be. What a
statement means is judged here; whether the results themselves are right is judged by the tests.
"""

import numpy as np
import pandas as pd

from study import checks, dataset, paths
from study.claims.rules import RULES, ClaimError, result

VERDICTS = ("contradicted", "cannot be decided", "reproduced")
KINDS = ("stated", "implied only", "used to identify", "can hardly fail")
"""What a statement's verdict says: only that of a stated one speaks for or against the paper. The
others are not said in so many words, served to identify the set-up, or hold by construction."""
RELATIONS = ("=", "<", ">", "?")


def load():
    """The claims as they are kept, without verdicts.

    Returns
    -------
    pandas.DataFrame
        Columns ``claim``, ``part``, ``kind`` (of `KINDS`), ``where`` (in the paper),
        ``statement`` (our words), ``measure`` (the number that judges it), ``rule`` and ``of``
        (how it is computed), ``relation``, ``expected`` (a number), ``tolerance`` (percent of
        ``expected``), ``figure`` (a result that shows it) and ``evidence`` (the results that
        it is computed from, separated by spaces).

    Raises
    ------
    ClaimError
        If a claim has no rule, an unknown kind or relation, a name that stands twice or a
        tolerance that is no number >= 0, or expects 0, what is no number, or a number that the
        published tables do not hold.
    """
    frame = pd.read_csv(paths.DATA / "published/claims.csv", keep_default_na=False)
    stated = dataset.published()
    frame["tolerance"] = pd.to_numeric(frame["tolerance"], errors="coerce")
    for row in frame.itertuples():
        if row.claim in set(frame.claim[: row.Index]):
            raise ClaimError(f"claim {row.claim} stands twice")
        if not 0 <= row.tolerance < np.inf:
            raise ClaimError(f"tolerance of {row.claim} must be a number >= 0, in percent")
        if row.rule not in RULES:
            raise ClaimError(
                f"claim {row.claim} has no rule: {row.rule!r} is not in study.claims.rules"
            )
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


def judge():
    """Judge every claim from the results in ``figures/``.

    Returns
    -------
    pandas.DataFrame
        That of `load` without ``rule`` and ``of``, and ``found`` (readings with their numbers,
        as text), ``lowest`` and ``highest`` (of the numbers) and ``verdict``; ordered by kind
        and, within it, by verdict.

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
        except ClaimError as error:
            raise ClaimError(f"claim {row.claim}: {error}") from None
        except LookupError as error:  # results of other parameters than the catalogue's
            message = f"claim {row.claim}: rule {row.rule} finds no {error} in {row.evidence}"
            raise ClaimError(f"{message}; make them anew with: study run {row.evidence}") from None
        if not found or not np.isfinite(list(found.values())).all():
            raise ClaimError(f"claim {row.claim} must be judged by finite numbers, got {found}")
        terms = row.relation, row.expected, row.tolerance
        text = "; ".join(f"{reading}: {value:.4g}" for reading, value in found.items())
        ends = {"lowest": min(found.values()), "highest": max(found.values())}
        rows.append({"found": text, **ends, "verdict": verdict(list(found.values()), *terms)})
    judged = frame.drop(columns=["rule", "of"]).join(pd.DataFrame(rows))
    return judged.sort_values(["kind", "verdict"], key=_rank, kind="stable", ignore_index=True)


def _rank(column):
    return column.map({name: n for n, name in enumerate(KINDS + VERDICTS)})


def verdict(values, relation, expected, tolerance):
    """Verdict on one claim from its numbers, one per reading.

    Parameters
    ----------
    values : sequence of float
    relation : {"=", "<", ">", "?"}
        The number should equal ``expected``, not exceed it, or not be less; or what is given in
        the paper cannot tell.
    expected : float
        Not 0.
    tolerance : float
        Deviation from ``expected``, in percent of it, up to which a reading holds.

    Returns
    -------
    str
        ``reproduced`` if every reading holds, ``contradicted`` if none does, and ``cannot be
        decided`` if some do, so that the verdict hangs on what the paper does not say.

    Raises
    ------
    ValueError
        For an unknown relation, a value outside its range, or no number at all.
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
