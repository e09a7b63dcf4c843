"""Is the cached dataset what it claims to be? Files, schema, physics, and one case solved anew."""

import numpy as np
import pandas as pd

from study import dataset
from study.dataset import design
from study.joint import force_curve

ERROR_LIMIT = 5e-3  # largest discretisation error estimate that a row may have
HERTZ_SLOPE = (1.45, 2.0)  # d ln P / d ln d at the smallest depths: 1.5 Hertz, 2 a thin soft layer


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
    sizes = {name: len(s.depths) for s in design.DESIGN for name, _ in s.cases()}
    if frame.groupby("case").size().to_dict() != sizes:
        _fail(f"must hold {len(sizes)} cases with {sum(sizes.values())} rows, got {len(frame)}")
    return f"{len(sizes)} cases with {len(frame)} rows, {len(frame.columns)} columns"


def _check_physics(frame):
    cases = dict(list(frame.groupby("case", sort=False)))
    depth = [case.depth_star.to_numpy() for case in cases.values()]
    force = [case.force_star.to_numpy() for case in cases.values()]
    pairs = list(zip(depth, force, strict=True))
    stiffness = [np.diff(f, prepend=0) / np.diff(d, prepend=0) for d, f in pairs]
    stiffening = np.array([(np.diff(k) / k[1:]).min() for k in stiffness])
    slopes = np.array([np.log(f[1] / f[0]) / np.log(d[1] / d[0]) for d, f in pairs])
    steps = np.array([np.diff(f).min() for f in force])
    found = [
        ("force increases", steps, 0, np.inf, "smallest step {:.3g}"),
        ("force is convex", stiffening, -1e-2, np.inf, "least stiffening {:.2g}"),
        ("slope as Hertz", slopes, *HERTZ_SLOPE, "exponent {:.3f} at least"),
        (
            "error estimate",
            frame.groupby("case", sort=False).error_estimate.max().to_numpy(),
            0,
            ERROR_LIMIT,
            "largest {:.2g}",
        ),
    ]
    report = []
    for what, values, low, high, text in found:
        bad = ~((values >= low) & (values <= high))
        if bad.any():
            case = list(cases)[int(bad.argmax())]
            found = f"{what} must be in [{low:g}, {high:g}], got {values[bad][0]:.4g}"
            _fail(f"case {case}: {found}")
        shown = values.max() if what == "error estimate" else values.min()
        report.append((what, text.format(shown)))
    return report


def _check_anew(frame):
    set_up = next(s for s in design.DESIGN if s.name == "ratio-1.25")
    name, joint = next(set_up.cases())
    depths = [design.DEPTHS[k] for k in (1, 9, 39)]
    anew = force_curve(joint, depths).force_star
    cached = frame[(frame.case == name) & frame.depth_star.isin(depths)].force_star.to_numpy()
    difference = float(np.abs(anew / cached - 1).max())
    if difference > 1e-6:
        _fail(f"case {name} solved anew must agree to 1e-06, got {difference:.2g}")
    return f"{name} agrees to {difference:.1g}"
