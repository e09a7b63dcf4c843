"""Comparison of two tables with the same name; on another processor the last digits differ."""

from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd

TOLERANCE = 1e-6
"""Maximum difference of two numbers that agree, relative to the larger."""
OF_DIFFERENCES = 1e-12
"""Added to this tolerance, for rounding errors of differences between numbers of magnitude 1."""
CHAOTIC = (
    *("fig17", "fig18", "fig19", "fig20", "fig21", "first_impacts", "impacts", "error_budget"),
    *("variants", "durations", "agreement", "convergence"),
    *("flexible_convergence", "stability_map", "lagged_windows"),
    *("numbers_08", "numbers_09"),
    *("visited", "ladder", "ladder_durations"),
    *("energy_test", "beam_steps", "answer_failure"),
)
"""Results of simulated impacts, each of which increases the rounding error of the one before."""
CHAOTIC_TOLERANCE = 1e-3
"""Used for these instead of `TOLERANCE`, relative to the number plus 1/1000 of the maximum of its
column."""
RESIDUALS = "energy_error", "contact_energy_error"
DIGITS = {
    "stability_steps": {"y": 3},
    "stability_impacts": {"y": 3},
    "stability_contact": {"y": 3},
    "energy_test": dict.fromkeys((*RESIDUALS, "force_error", "halved_step"), 3),
    "answer_failure": {"contact_energy_error": 3, "error_percent": 3},
    "beam_steps": dict.fromkeys((*RESIDUALS, "force_1_N", "force_2_N", "force_3_N"), 3),
    "freed": {"ratio": 5, "factor": 4},
    "ladder_mechanisms": dict.fromkeys(("to_next", "to_second", "to_judge", "finest_to_judge"), 2),
    "ladder_durations": {"position_percent": 2, "largest_um": 2},
    "answer_model": {"position_percent": 2},
    "ratio_line": {"ratio": 5},
    "force_curves": {"error_estimate": 3, "contact_half_angle_deg": 5},
    "axial_curves": {"error_estimate": 3, "contact_half_angle_deg": 7},
    "tilted_contacts": {"error_estimate": 3},
    "loaded_joints": {
        "peak_error": 3,
        "error_estimate": 3,
        "contact_from_deg": 7,
        "contact_to_deg": 7,
    },
}
"""Columns with fewer digits, in which a difference of one unit of the last digit is allowed."""


def differs(kept: Path | StringIO, made: Path | StringIO, name: str) -> str | None:
    """Where two CSV tables of a name differ by more than their tolerance, or None.

    If rows have changed places, they are matched by the columns that contain words.
    """
    try:
        old, new = (pd.read_csv(table, dtype=str, keep_default_na=False) for table in (kept, made))
    except ValueError:  # of pandas, for a file that is no table
        return "which cannot be compared: it or the accepted table (git restores it) is damaged"
    if list(old) != list(new):
        return f"columns: {_changed(list(old), list(new))}"
    if len(old) != len(new):
        return f"rows: accepted {len(old)}, now {len(new)}"
    words = [c for c in old if _numbers(old[c]).isna().all() and _numbers(new[c]).isna().all()]
    if not old[words].equals(new[words]):
        old, new = (table.sort_values(words, kind="stable") for table in (old, new))
    excess = np.array([_excess(old[column], new[column], name, column) for column in old])
    if not (excess > 1).any():
        return None
    row, column = np.argwhere(excess.T > 1)[0]
    place = f"row {old.index[row] + 2}, column {old.columns[column]}"
    numbers = f"accepted {old.iloc[row, column]}, now {new.iloc[row, column]}"
    return f"{place}: {numbers} ({np.count_nonzero(excess > 1)} in all)"


def _changed(old, new):
    """Names that were added to a list or removed from it, or that there are the same ones."""
    added, removed = ([n for n in a if n not in b] for a, b in ((new, old), (old, new)))
    changes = {"added": added, "removed": removed}
    found = [f"{how} {', '.join(names)}" for how, names in changes.items() if names]
    return "; ".join(found) or "in another order"


def _numbers(column):
    return pd.to_numeric(column, errors="coerce")


def _excess(old, new, result, column):
    """Differences of two columns in units of the tolerance; infinite where text differs."""
    changed = old.to_numpy() != new.to_numpy()
    excess = np.where(changed, np.inf, 0.0)
    numbers = [_numbers(values).to_numpy(float) for values in (old, new)]
    both = changed & np.isfinite(numbers).all(axis=0)
    if both.any():
        size = np.fmax(*np.abs(numbers))  # NaN where both are
        limit = OF_DIFFERENCES + TOLERANCE * size
        if result in CHAOTIC:
            limit = CHAOTIC_TOLERANCE * (size + 1e-3 * np.nanmax(size))
        if digits := DIGITS.get(result, {}).get(column):
            last = np.floor(np.log10(np.maximum(size, OF_DIFFERENCES))) + 1 - digits
            limit = limit + 10.0**last
        excess[both] = (np.abs(numbers[0] - numbers[1]) / limit)[both]
    return excess
