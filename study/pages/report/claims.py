"""The table of claims: the paper's statement, what is expected, the number found."""

import csv
from collections.abc import Collection
from pathlib import Path

from docutils.nodes import make_id

from study.checks import StudyError

COLUMNS = (
    *("claim", "kind", "where", "statement", "measure", "relation", "expected", "tolerance"),
    *("found", "lowest", "highest", "verdict", "figure", "evidence"),
)
VERDICTS = {"contradicted": "✗", "cannot be decided": "?", "reproduced": "✓"}
"""Verdict -> sign, as colour alone must not distinguish verdicts."""
GROUPS = {
    "implied only": "Only implied by the paper",
    "used to identify": "Used to identify the set-up",
    "can hardly fail": "Can hardly fail",
}
"""Kinds of claims that do not speak for or against the paper, in words."""
MEND = "rebuild it with: study run claims"


def read_claims(path: Path, known: Collection[str]) -> list[dict]:
    """Rows of the CSV, checked, each with its ``group``, ``anchor`` and results (``shown_by``).

    Raises
    ------
    StudyError
        For a missing column, a verdict or result that is not ``known``, or a repeated claim.
    """
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    lacking = [c for c in COLUMNS if not rows or rows[0].get(c) is None]
    if lacking:
        raise StudyError(f"{path.name} lacks {', '.join(lacking)}; {MEND}")
    anchors = set()
    for row in rows:
        row["shown_by"] = f"{row['figure']} {row['evidence']}".split()
        unknown = [name for name in row["shown_by"] if name not in known]
        if row["verdict"] not in VERDICTS or unknown:
            wrong = ", ".join(unknown) or f"verdict {row['verdict']!r}"
            raise StudyError(f"{path.name}, {row['claim']}: {wrong} is not known; {MEND}")
        row["group"] = GROUPS.get(row["kind"]) or f"Stated by the paper: {row['verdict']}"
        row["anchor"] = make_id(f"claim-{row['claim']}")
        if row["anchor"] in anchors:
            raise StudyError(f"{path.name}: claim {row['claim']} occurs twice; {MEND}")
        anchors.add(row["anchor"])
    return rows
