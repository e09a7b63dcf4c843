"""The benchmark: scores of values that somebody computed (see ``data/README.md``)."""

from math import inf

import pandas as pd

from study import checks, paths
from study.dataset import store

VALUES, ENTRIES = paths.DATA / "benchmark.csv", paths.DATA / "benchmark_entries.csv"
KEYS = ["case", "quantity"]


def read_entry(path: str) -> pd.DataFrame:
    """Rows of a CSV file: case, quantity, value, and time in s; ``ValueError`` if one is wrong."""
    try:
        rows = pd.read_csv(path, dtype=str, keep_default_na=False, skipinitialspace=True)
    except (OSError, ValueError) as error:
        raise ValueError(f"mine must be a CSV file that can be read, got {path}: {error}") from None
    if missing := {*KEYS, "value", "time"} - {*rows}:
        names = ", ".join(sorted(missing))
        raise ValueError(f"{path} must have columns case, quantity, value, time; missing: {names}")
    known = store.read(VALUES).groupby("case", sort=False).quantity.agg(list)
    for k, row in enumerate(rows.to_dict("records"), 1):
        checks.choice(f"case of row {k}", row["case"], known.index)
        checks.choice(f"quantity of row {k}", row["quantity"], known[row["case"]])
        for name, above in (("value", -inf), ("time", 0)):
            at = f"{name} of row {k}"
            checks.number(at, checks.read(at, row[name]), above=above)
    if rows.empty or rows.duplicated(KEYS).any():
        raise ValueError(f"{path} must have a row, and each quantity of a case once")
    return rows.astype({"value": float, "time": float})


def scored(rows: pd.DataFrame) -> pd.DataFrame:
    """Rows of entries with ``error``, relative to the value, and ``over_uncertainty``."""
    of = store.read(VALUES).set_index(KEYS).loc[[*zip(rows.case, rows.quantity, strict=True)]]
    error, uncertainty = abs(rows.value / of.value.to_numpy() - 1), of.uncertainty.to_numpy()
    over = error / uncertainty
    return rows.assign(error=error, uncertainty=uncertainty, over_uncertainty=over)
