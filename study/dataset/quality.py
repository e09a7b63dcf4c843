"""Checks of the cached dataset: files, schema, physics, and one case solved again."""

import numpy as np

from study.dataset import design, production, store
from study.joint import force_curve

ERROR_LIMIT = 5e-3  # largest discretisation error estimate that a row may have
HERTZ_SLOPE = (1.45, 3.0)
"""d ln P / d ln d at the smallest depths: 1.5 Hertz, 2 a thin layer, 3 an incompressible one."""
AGREEMENT = 1e-6  # relative, of forces solved again


def check() -> list[tuple[str, str]]:
    """Checks of the dataset, with the number that each found: files, schema, physics, one case.

    The first that fails raises `study.dataset.DatasetError`: file, case and remedy.
    """
    store.verify_files()
    production.verify_made_by()
    frame = store.load()
    return [
        ("files", "every hash as stated, made by this code and design"),
        ("schema", _check_schema()),
        ("cases", _check_cases(frame)),
        *_check_physics(frame),
        ("solved again", _check_anew(frame)),
    ]


def _fail(what, path=store.CURVES):
    remedy = f"rebuild it with: {store.MEND}"
    if path == store.PACKAGE:
        remedy = f"restore it with: git checkout -- data/{path.name}"
    raise store.DatasetError(f"data/{path.name}: {what}; {remedy}")


def _check_schema():
    # only this needs it, and it takes a second to import
    from frictionless import FrictionlessException, Package

    try:
        report = Package(store.PACKAGE).validate()
    except FrictionlessException as error:
        _fail(str(error), store.PACKAGE)
    wrong = report.flatten(["note", "message", "rowNumber", "fieldName"])
    for note, message, row, column in wrong:
        where = f" (row {row}, column {column})" if row else ""
        _fail((note or message) + where, store.PACKAGE)
    resources = store.read_package()["resources"]
    (schema,) = (r["schema"] for r in resources if r["path"] == store.CURVES.name)
    for field in schema["fields"]:  # that the types are the columns', frictionless has seen
        if ("unit" in field) != (field["type"] == "number"):
            wanted = f"column {field['name']}, a {field['type']}"
            _fail(f"must describe {wanted}, got {field}", store.PACKAGE)
    return f"{report.stats['tasks']} files as described, {len(schema['fields'])} columns"


def _check_cases(frame):
    sizes = {name: len(s.depths) for s in design.DESIGN for name, _ in s.cases()}
    if frame.groupby("case").size().to_dict() != sizes:
        _fail(f"must hold {len(sizes)} cases with {sum(sizes.values())} rows, got {len(frame)}")
    return f"{len(sizes)} with {len(frame)} rows"


def _check_physics(frame):
    by_case = frame.groupby("case", sort=False)
    pairs = [(case.depth_star.to_numpy(), case.force_star.to_numpy()) for _, case in by_case]
    stiffness = [np.diff(f, prepend=0) / np.diff(d, prepend=0) for d, f in pairs]
    slopes = [np.log(f[1] / f[0]) / np.log(d[1] / d[0]) for d, f in pairs]
    steps = [np.diff(f).min() for _, f in pairs]
    stiffening = [(np.diff(k) / k[1:]).min() for k in stiffness]
    estimates = by_case.error_estimate.max()
    checks = [
        ("force increases", steps, 0, np.inf, "smallest step {:.3g}", np.min),
        ("force is convex", stiffening, -1e-2, np.inf, "least stiffening {:.2g}", np.min),
        ("slope as Hertz", slopes, *HERTZ_SLOPE, "exponent {:.3f} at least", np.min),
        ("error estimate", estimates, 0, ERROR_LIMIT, "largest {:.2g}", np.max),
    ]
    report = []
    for what, values, low, high, text, worst in checks:
        values = np.asarray(values)
        bad = ~((values >= low) & (values <= high))
        if bad.any():
            case = estimates.index[bad.argmax()]
            _fail(f"case {case}: {what} must be in [{low:g}, {high:g}], got {values[bad][0]:.4g}")
        report.append((what, text.format(worst(values))))
    return report


def _check_anew(frame):
    set_up = next(s for s in design.DESIGN if s.group == "ratio")
    name, joint = next(set_up.cases())
    depths = [design.DEPTHS[k] for k in (1, 9, 39)]
    anew = force_curve(joint, depths).force_star
    cached = frame[(frame.case == name) & frame.depth_star.isin(depths)].force_star.to_numpy()
    difference = float(np.abs(anew / cached - 1).max())
    if difference > AGREEMENT:
        _fail(f"case {name} solved again must agree to {AGREEMENT:g}, got {difference:.2g}")
    return f"{name} agrees to {difference:.1g}"
