"""The table of claims: what the paper says, how it is judged, what was found."""

import csv

from study.checks import StudyError
from study.report.site import anchor

COLUMNS = (
    *("claim", "where", "statement", "measure", "relation", "expected", "tolerance", "partly"),
    *("found", "lowest", "highest", "verdict", "figure", "evidence"),
)
VERDICTS = {"reproduced": "✓", "partly": "◐", "not reproduced": "✗", "cannot be decided": "?"}
"""Verdict -> sign, so that no verdict is told by its colour alone."""
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
        each once), ``readings`` (pairs of reading and what was found), ``limits`` (tolerances in
        words), ``sign`` and ``anchor``.

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
        limits = {"within": row["tolerance"], "partly": row["partly"]}
        row["limits"] = ", ".join(
            f"{k} {v}\N{NO-BREAK SPACE}%" for k, v in limits.items() if float(v or 0)
        )
        row["sign"], row["anchor"] = VERDICTS[row["verdict"]], f"claim-{anchor(row['claim'])}"
        if row["anchor"] in anchors:
            raise StudyError(f"{path.name}: claim {row['claim']} stands twice; {MEND}")
        anchors.add(row["anchor"])
    return rows
