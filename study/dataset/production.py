"""Generates, describes and checks the dataset, and finds which of its files are outdated.

``data/datapackage.json`` contains the description: schema and units, which are written by hand, and
the checksum of every file. Its provenance states the code, the data and the design from which each
generated file was made.
"""

import os
import platform
from collections import Counter
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pandas as pd

from study import paths, provenance
from study.contact import stiffening
from study.dataset import design, solutions, store, tolerance
from study.joint import Joint, force_curve
from study.joint.compliance import RESOLUTION

FROM_NOTHING = "STUDY_DATA_FROM_NOTHING"  # if it is set, data/task_data.py makes every file
GENERATED = {
    store.CURVES: "joint/curve",
    store.COEFFICIENTS: "dataset/fitting",
    store.RELATIVE_COSTS: "dataset/fitting",
    store.TABLE: "dataset/stiffening_fit",
    store.CONTACT_SIZE: "dataset/stiffening_fit",
    store.SOLUTIONS["axial"]: "joint/curve",
    store.SOLUTIONS["stress"]: "joint/stress",
    store.SOLUTIONS["tilted"]: "joint/tilted",
    store.SOLUTIONS["loaded"]: "joint/dimensional",
    store.LINKS: "choose/random_scenes",
    store.SET_UPS: "claims/set_ups",
}
"""Generated file -> module whose imports lead to all code on which the file depends."""
MADE_FROM = {
    store.COEFFICIENTS: [store.CURVES, store.TABLES],
    store.RELATIVE_COSTS: [store.SPEED],
    store.LINKS: [store.TABLE],
    store.SET_UPS: [store.TABLE, store.COEFFICIENTS],
} | {path: [store.CASES] for path in store.SOLUTIONS.values()}
"""Generated file -> data on which it also depends; files come after those that they depend on."""
ERROR_LIMIT = 5e-3  # maximum of the estimated discretisation error of a row
HERTZ_SLOPE = (1.45, 3.0)
"""Range of d ln P / d ln d at the smallest depths: 1.5 for Hertz's law, 2 for a thin layer, and 3
for an incompressible thin layer."""
AGREEMENT = 1e-6  # maximum relative difference of forces that are solved again


def to_make() -> set[Path]:
    """Files that a build makes: damaged or outdated ones, and those that are made from them.

    The description is renewed with any other file, and alone if only the materials have changed.
    Raises `study.dataset.DatasetError` if the description or a published file is missing or
    damaged.
    """
    if os.environ.get(FROM_NOTHING):
        return {*GENERATED, store.PACKAGE}
    package = _undamaged()
    made = {path for path in GENERATED if not store.is_as_stated(path, package)}
    made |= set(out_of_date())
    for path, data in MADE_FROM.items():
        made |= {path} if made & set(data) else set()
    if made or not store.is_as_stated(store.MATERIALS, package):
        made.add(store.PACKAGE)
    return made


def code(path: Path) -> str:
    """Digest of the code on which a generated file depends."""
    return provenance.digest(_sources(path))


def solve_case(group: str, name: str, joint: Joint, depths: tuple[float, ...]) -> pd.DataFrame:
    """One case of the design, in the columns of the dataset."""
    return pd.DataFrame({"group": group, "case": name} | force_curve(joint, depths).columns())


def write_table(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV, completely or not at all, unless it agrees with the stored file.

    Numbers have 9 significant digits, or fewer if `tolerance.DIGITS` says so. The last digits
    differ on another processor; a stored file that agrees within the tolerance is not changed.
    """
    frame = frame.copy()
    for column, digits in tolerance.DIGITS.get(path.stem, {}).items():
        frame[column] = [float(f"{value:.{digits}g}") for value in frame[column]]
    with paths.scratch(path.parent) as folder:
        made = folder / path.name
        frame.to_csv(made, index=False, float_format="%.9g", lineterminator="\n")
        if not path.is_file() or tolerance.table_differs(path, made):
            paths.copy(made, path)


def write_coefficients(table: pd.DataFrame, path: Path) -> None:
    """Write a table of Chebyshev coefficients, unless it agrees with the stored file.

    On another processor a number may differ by one unit, and a number at the limit below which it
    is left out by two units.
    """
    if path.is_file():
        keys = list(table.columns[: -len(stiffening.PLACES)])
        kept = pd.read_csv(path).set_index(keys)
        if kept.sub(table.set_index(keys), fill_value=0).abs().to_numpy().max() <= 2:
            return
    with paths.whole(path) as temporary:
        table.to_csv(temporary, index=False, lineterminator="\n")


def write_description() -> None:
    """Write checksums and provenance of the present files to ``datapackage.json``."""
    package = _undamaged()
    package["provenance"] = {
        "command": store.MEND,
        "library_sha256": {
            provenance.name(path): provenance.sha256(path.read_bytes()) for path in store.LIBRARY
        },
        "design": _design(),
        "made_by": _made_by(),
        "versions": {p: version(p) for p in ("numpy", "scipy", "scikit-fem")}
        | {"python": platform.python_version()},
    }
    store.write_package(package, list(GENERATED))


def _undamaged():
    """The description, if no file is damaged that no build makes: its new hash would hide that."""
    package = store.read_package()
    for resource in package["resources"]:
        if resource["origin"] != "generated":
            store.verify(paths.DATA / resource["path"], package)
    return package


def verify_made_by() -> None:
    """Raise `study.dataset.DatasetError` if a file is outdated (`out_of_date`)."""
    for path, why in out_of_date().items():
        raise store.DatasetError(
            f"{provenance.name(path)} is outdated: {why} since it was made; "
            f"rebuild it with: {store.MEND}"
        )


def out_of_date() -> dict[Path, str]:
    """Outdated files, and what has changed since they were made: code, data or the design."""
    stated, changes = store.read_package()["provenance"], {}
    for path, digests in zip(GENERATED, _made_by().values(), strict=True):
        before = stated["made_by"].get(provenance.name(path), {})
        changed = [file for file in digests | before if digests.get(file) != before.get(file)]
        if changed:
            changes[path] = f"{', '.join(changed)} changed"
    if stated["design"] != _design():
        changes = {
            store.CURVES: "the design (study/dataset/design.py), a default of the joint or a "
            "resolution has changed"
        } | changes
    return changes


def _sources(path):
    return provenance.sources(paths.ROOT / f"study/{GENERATED[path]}.py")


def _made_by():
    """Generated file -> digest of every file that decides it."""
    decide = {path: [*_sources(path), *MADE_FROM.get(path, [])] for path in GENERATED}
    return {provenance.name(path): provenance.digests(files) for path, files in decide.items()}


def _design():
    """Groups of cases with their purpose; the hash is of all parameters, including defaults."""
    cases = design.every_case()
    count = Counter(group for group, *_ in cases)
    return {
        "groups": {g: {"why": why, "cases": count[g]} for g, why in design.GROUPS.items()},
        "resolution": RESOLUTION,
        "cases_sha256": provenance.sha256(repr(cases).encode()),
    }


def check() -> list[tuple[str, str]]:
    """Check files, schema and physics of the dataset, and solve some cases again.

    Returns the name of each check and what it found. The first check that fails raises
    `study.dataset.DatasetError` with file, case and remedy.
    """
    store.verify_files()
    verify_made_by()
    frame = store.load()
    return [
        ("files", "all checksums agree; made by the present code and design"),
        ("schema", _check_schema(len(frame.columns))),
        ("cases", _check_cases(frame)),
        *_check_physics(frame),
        ("solved again", _check_anew(frame)),
        ("kept solutions", check_solutions()),
    ]


def _fail(what, path=store.CURVES):
    remedy = f"rebuild it with: {store.MEND}"
    if path == store.PACKAGE:
        remedy = f"restore it with: git checkout -- data/{path.name}"
    raise store.DatasetError(f"data/{path.name}: {what}; {remedy}")


def _check_schema(columns):
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
    return f"{report.stats['tasks']} files as described, {columns} columns"


def _check_cases(frame):
    sizes = {name: len(depths) for _, name, _, depths in design.every_case()}
    if frame.groupby("case").size().to_dict() != sizes:
        _fail(
            f"must have {len(sizes)} cases with {sum(sizes.values())} rows, got {len(frame)} rows"
        )
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
        ("force increases", steps, 0, np.inf, "minimum increase {:.3g}", np.min),
        (
            "stiffness increases",
            stiffening,
            -1e-2,
            np.inf,
            "minimum relative change {:.2g}",
            np.min,
        ),
        ("initial exponent", slopes, *HERTZ_SLOPE, "minimum {:.3f}", np.min),
        ("error estimate", estimates, 0, ERROR_LIMIT, "maximum {:.2g}", np.max),
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
    _, name, joint, depths = next(case for case in design.every_case() if case[0] == "ratio")
    depths = [depths[k] for k in (1, 9, 39)]
    anew = force_curve(joint, depths).force_star
    cached = frame[(frame.case == name) & frame.depth_star.isin(depths)].force_star.to_numpy()
    difference = float(np.abs(anew / cached - 1).max())
    if difference > AGREEMENT:
        what = f"case {name} solved again must agree within a relative error of {AGREEMENT:g}"
        _fail(f"{what}, got {difference:.2g}")
    return f"{name}: relative difference {difference:.1g}"


def check_solutions(fraction: float = 0.0) -> str:
    """Solve a random fraction of the cases of each kind again, at least one, and compare them.

    Raises `study.dataset.DatasetError` for a case that differs by more than `AGREEMENT`, or that
    has no results.
    """
    draw, drawn = np.random.default_rng(), []
    for kind, path in store.SOLUTIONS.items():
        cases = [case for case in solutions.cases() if case.kind == kind]
        kept = store.read(path)
        if differing := {case.name for case in cases} ^ set(kept.case):
            names = ", ".join(sorted(differing))
            _fail(
                f"its cases must be those of {store.CASES.name}; only one of both has {names}", path
            )
        count = max(1, int(np.ceil(fraction * len(cases))))
        drawn += [cases[k] for k in draw.choice(len(cases), count, replace=False)]
        for case in drawn[-count:]:
            _compare(kept[kept.case == case.name], solutions.solve(case), path)
    return f"{len(drawn)} random cases agree"


def _compare(kept, anew, path):
    with paths.scratch() as folder:
        tables = folder / "kept" / path.name, folder / "anew" / path.name
        for table, rows in zip(tables, (kept, anew), strict=True):
            table.parent.mkdir()
            write_table(rows, table)
        if differs := tolerance.table_differs(*tables):
            _fail(f"case {kept.case.iloc[0]} solved again differs: {differs}", path)
