"""The table of claims: what the paper says, how it is judged, what was found."""

import csv

from study.checks import StudyError
from study.pages.report.site import anchor

COLUMNS = (
    *("claim", "kind", "where", "statement", "measure", "relation", "expected", "tolerance"),
    *("found", "lowest", "highest", "verdict", "figure", "evidence"),
)
VERDICTS = {"contradicted": "✗", "cannot be decided": "?", "reproduced": "✓"}
"""Verdict -> sign, so that no verdict is told by its colour alone."""
GROUPS = {
    "implied only": "Only implied by the paper",
    "used to identify": "What the set-up was identified by",
    "can hardly fail": "What can hardly fail",
}
"""Kinds of claims whose verdicts do not speak for or against the paper, in words."""
MEND = "make it anew with: study run claims"


def read_claims(path, known):
    """Claims as a list of dicts, checked.

    Parameters
    ----------
    path : pathlib.Path
        CSV with the columns `COLUMNS`.
    known : sequence of str
        Names of all figures and tables.

    Returns
    -------
    list of dict
        One per row: the columns as text, and ``shown_by`` (names of its figure and evidence,
        each once), ``readings`` (pairs of reading and what was found), ``limits`` (tolerance in
        words), ``group`` (its verdict, or its kind where the verdict does not speak for or
        against the paper), ``sign`` and ``anchor``.

    Raises
    ------
    study.checks.StudyError
        For a missing column, an unknown verdict or result, or a claim that stands twice.
    """
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    lacking = [c for c in COLUMNS if not rows or rows[0].get(c) is None]
    if lacking:
        raise StudyError(f"{path.name} lacks {', '.join(lacking)}; {MEND}")
    anchors = set()
    for row in rows:
        named = [*row["figure"].split(), *row["evidence"].split()]
        unknown = [name for name in named if name not in known]
        if row["verdict"] not in VERDICTS or unknown:
            wrong = ", ".join(unknown) or f"verdict {row['verdict']!r}"
            raise StudyError(f"{path.name}, {row['claim']}: {wrong} is not known; {MEND}")
        row["shown_by"] = list(dict.fromkeys(named))
        row["readings"] = [part.rpartition(": ")[::2] for part in row["found"].split("; ") if part]
        tolerance = row["tolerance"]
        row["limits"] = f"within {tolerance}\N{NO-BREAK SPACE}%" if float(tolerance or 0) else ""
        row["group"] = GROUPS.get(row["kind"]) or f"Stated by the paper: {row['verdict']}"
        row["sign"], row["anchor"] = VERDICTS[row["verdict"]], f"claim-{anchor(row['claim'])}"
        if row["anchor"] in anchors:
            raise StudyError(f"{path.name}: claim {row['claim']} stands twice; {MEND}")
        anchors.add(row["anchor"])
    return rows
