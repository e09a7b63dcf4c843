"""Which statements on Figs. 17 to 21 each run of `study.claims.set_ups` satisfies.

The statements, the names of their numbers and the bounds are those of
``data/published/claims.csv``. This module does not simulate anything.
"""

from itertools import combinations

import numpy as np
import pandas as pd

from study.claims import verdicts

RUNS = {
    "rigid": "rigid links",
    "particles": "particles",
    "beams": "beams",
    "schemes": "particles, other schemes",
}
"""Groups of runs: models of the links, and particles in schemes that may feed energy in."""
MEASURES = {"time with impacts": ("last separation", "time in which the force swings")}
"""Number of a statement -> names of the numbers of a run that it may mean."""


def statements() -> pd.DataFrame:
    """The paper's statements on Figs. 17 to 21: rows of `study.claims.verdicts.load`."""
    claims = verdicts.load()
    claims = claims[(claims.part == "crank-slider") & claims["where"].str.contains("Fig")]
    return claims.reset_index(drop=True)


def held(runs: pd.DataFrame, strictly: bool = False) -> pd.DataFrame:
    """Whether each run satisfies each statement: a column for each statement.

    A value is missing if the number was not computed. A statement is satisfied if one of its
    numbers is within one of its bounds. With ``strictly``, all numbers must be within all bounds,
    as in `study.claims.verdicts`. ``runs`` are those of `study.claims.set_ups.run` that finished.
    """
    columns = {}
    for claim in statements().itertuples():
        meant = MEASURES.get(claim.row, [claim.row])
        by = [verdicts.holds(runs[name], claim.relation, claim.bounds) for name in meant]
        holds = np.all(by, axis=(0, 2)) if strictly else np.any(by, axis=(0, 2))
        columns[claim.claim] = pd.array(holds, dtype="boolean")
        if claim.claim.startswith("methods_agree"):  # needs both flexible models
            columns[claim.claim][runs[claim.row].isna().to_numpy()] = pd.NA
    return pd.DataFrame(columns, index=runs.index)


def never_together(holds: pd.DataFrame) -> list[tuple[str, str]]:
    """Pairs of statements that are each satisfied in some run, but never in the same run."""
    some = holds.fillna(False).astype(bool)
    ever = [claim for claim in some if some[claim].any()]
    return [pair for pair in combinations(ever, 2) if not some[list(pair)].all(axis=1).any()]
