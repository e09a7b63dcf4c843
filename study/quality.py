"""Is the cached dataset what it claims to be? Files, schema, physics, and one case solved anew."""

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from study import dataset
from study.joint import force_curve

ERROR_LIMIT = 5e-3  # largest discretisation error estimate that a row may have
HERTZ_SLOPE = (1.45, 1.75)  # d ln P / d ln d at the smallest depths; Hertz has 1.5


def check():
    """Check files, schema and physics of the dataset, and solve one case anew.

    Returns
    -------
    list of (str, str)
        What was checked, and the number found; in the order of checking.

    Raises
    ------
    study.dataset.DatasetError
        At the first check that fails; names the file, the case and the remedy.
    """
    dataset.verify_files()
    report = [("files", "every hash as stated, made by this code and design")]
    report.append(("schema", _check_schema()))
    frame = dataset.load()
    report += _check_physics(frame)
    report.append(("solved anew", _check_anew(frame)))
    return report


def _fail(what):
    raise dataset.DatasetError(
        f"data/{dataset.CURVES.name}: {what}; make it anew with: {dataset.MEND}"
    )


def _check_schema():
    from frictionless import Package  # takes a second to import, and only this needs it

    report = Package(dataset.PACKAGE).validate()
    errors = report.flatten(["note", "rowNumber", "fieldName"])
    if errors:
        note, row, column = errors[0]
        place = f" (row {row}, column {column})" if row else ""
        raise dataset.DatasetError(
            f"data/{dataset.PACKAGE.name}: {note}{place}; make it anew with: {dataset.MEND}"
        )
    frame = pd.read_csv(dataset.CURVES)
    wanted = sum(len(s.r2_stars) * len(s.kinematics) for s in dataset.DESIGN)
    if frame.case.nunique() != wanted or len(frame) != wanted * len(dataset.DEPTHS):
        _fail(f"must hold {wanted} cases of {len(dataset.DEPTHS)} depths, got {len(frame)} rows")
    return f"{wanted} cases of {len(dataset.DEPTHS)} depths, {len(frame.columns)} columns"


def _check_physics(frame):
    table = frame.pivot(index="case", columns="depth_star", values="force_star")
    force, depth = table.to_numpy(), table.columns.to_numpy()
    steps = np.diff(force, axis=1)
    slopes = np.log(force[:, 1] / force[:, 0]) / np.log(depth[1] / depth[0])
    stiffening = np.diff(steps, axis=1) / steps[:, 1:]
    found = [
        ("force increases", steps.min(axis=1), 0, np.inf, "smallest step {:.3g}"),
        ("force is convex", stiffening.min(axis=1), -1e-2, np.inf, "least stiffening {:.2g}"),
        ("slope as Hertz", slopes, *HERTZ_SLOPE, "exponent {:.3f} at least"),
        (
            "error estimate",
            frame.groupby("case").error_estimate.max().to_numpy(),
            0,
            ERROR_LIMIT,
            "largest {:.2g}",
        ),
    ]
    report = []
    for what, values, low, high, text in found:
        bad = ~((values >= low) & (values <= high))
        if bad.any():
            _fail(
                f"case {table.index[bad][0]}: {what} must be in [{low:g}, {high:g}], got "
                f"{values[bad][0]:.4g}"
            )
        shown = values.max() if what == "error estimate" else values.min()
        report.append((what, text.format(shown)))
    return report


def _check_anew(frame):
    set_up = next(s for s in dataset.DESIGN if s.name == "ratio-1.25")
    name, joint = next(set_up.cases())
    depths = dataset.DEPTHS[[1, 9, 39]]
    with threadpool_limits(limits=1):
        anew = force_curve(joint, depths).force_star
    cached = frame[(frame.case == name) & frame.depth_star.isin(depths)].force_star.to_numpy()
    difference = float(np.abs(anew / cached - 1).max())
    if difference > 1e-6:
        _fail(f"case {name} solved anew must agree to 1e-06, got {difference:.2g}")
    return f"{name} agrees to {difference:.1g}"
