"""Loading and checking the force-depth curves and the other files of numbers.

The curves are in ``data/force_curves.csv``, with one row for each case and depth.
``data/datapackage.json`` (Frictionless Data Package) describes the columns of every table, and
``data/SHA256SUMS`` has the hash of every file: a table is read only if its hash agrees.
"""

from collections.abc import Iterable
from difflib import get_close_matches
from io import StringIO
from numbers import Real
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from filelock import FileLock

from study import checks, contact, paths
from study.contact.laws import COEFFICIENTS
from study.contact.stiffening import TABLE
from study.dataset.compare import DIGITS, differs
from study.dataset.paper import PAPER_KINEMATICS

if TYPE_CHECKING:
    from study.joint import Kinematics

CURVES = paths.DATA / "force_curves.csv"
CASES = paths.DATA / "solutions/cases.json"
SOLUTIONS = {
    "axial": paths.DATA / "solutions/axial_curves.csv",
    "stress": paths.DATA / "solutions/stresses.csv",
    "tilted": paths.DATA / "solutions/tilted_contacts.csv",
    "loaded": paths.DATA / "solutions/loaded_joints.csv",
}
"""Kind of solution -> file; `study.dataset.solutions` reads them."""
TABLES = paths.DATA / "published/tables.csv"
REFERENCES = paths.DATA / "published/joint.csv"
OTHERS = paths.DATA / "published/others.csv"
SPEED = paths.DATA / "published/speed.csv"
PACKAGE = paths.DATA / "datapackage.json"
HASHES = paths.DATA / "SHA256SUMS"
MATERIALS = paths.STUDY / "contact/materials.csv"
RELATIVE_COSTS = paths.STUDY / "choose/relative_costs.json"
LOOKS = paths.STUDY / "pages/looks.csv"
LIBRARY = (COEFFICIENTS, RELATIVE_COSTS, TABLE, MATERIALS, LOOKS)
"""Files of numbers in the folders of the modules that read them."""


MANY = 30
"""Values of a column that a message lists; of more, it lists only the nearest."""


class DatasetError(checks.StudyError):
    """The dataset is missing or damaged; the message names file and remedy."""


def load(**filters: Any) -> pd.DataFrame:
    """The force-depth curves as a table with one row for each case and depth.

    ``datapackage.json`` has the unit and the meaning of every column. A filter is the name of a
    column with a value, or a list of values: only rows with these values are returned. Raises
    `DatasetError` as `read` does, and ``ValueError`` if a column or value is unknown or if no row
    is left.
    """
    curves = frame = read(CURVES, keep_default_na=False)  # no layers: an empty text
    for column, wanted in filters.items():
        checks.choice("column", column, tuple(curves.columns))
        values = [wanted] if np.isscalar(wanted) else list(wanted)
        left = frame[frame[column].isin(values)]
        unknown = [value for value in values if value not in set(curves[column])]
        if unknown or left.empty:
            wrong = (unknown or values)[0]
            raise ValueError(_allowed(column, (curves if unknown else frame)[column], wrong))
        frame = left
    return frame.reset_index(drop=True)


def _allowed(column, values, wrong):
    """The message for a value that a column does not have."""
    known = values.unique()
    which = "one of"
    if len(known) > MANY:
        if values.dtype == float and isinstance(wrong, Real) and np.isfinite(wrong):
            known = sorted(known, key=lambda value: abs(value - wrong))[:6]
        else:
            known = get_close_matches(str(wrong), map(str, known), 3) or known[:6]
        which = "a value of the dataset (study data show lists them), such as"
    known = ", ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in known)
    return f"{column} must be {which} {known}, got {wrong}"


def paper_curves(
    kinematics: "Kinematics | list[Kinematics]" = PAPER_KINEMATICS, **filters: object
) -> pd.DataFrame:
    """Curves of `study.joint.reference_joint` for R2* = 20 to 10,000, filtered as by `load`."""
    return load(group="paper", kinematics=kinematics, **filters)


def published(where: str | None = None) -> pd.Series:
    """Numbers that the paper prints, by ``where``, ``row`` and ``quantity``.

    With ``where``, for example ``"Table 2"``, only the numbers of this table or figure are
    returned, by ``row`` and ``quantity``.
    """
    frame = read(TABLES)
    if where is not None:
        checks.choice("where", where, tuple(frame["where"].unique()))
    values = frame.set_index(["where", "row", "quantity"])["value"].sort_index()
    return values if where is None else values.loc[where]


def published_table_2() -> pd.DataFrame:
    """Table 2 with the signs that the paper leaves out: absolute values above 1 are negative.

    It has a row for each law, and the columns ``kappa_as_printed``, ``kappa_adjusted_as_printed``
    and ``RMSE``. The paper's coefficient of determination kappa differs from that by the usual
    definition (`study.claims.statistics`).
    """
    table = published("Table 2").rename({"proposed": "hyperbolic_winkler"}).unstack()
    names = {
        "determination": "kappa_as_printed",
        "determination_adjusted": "kappa_adjusted_as_printed",
        "RMSE": "RMSE",
    }
    table = table.loc[list(contact.PAPER_LAWS), list(names)].rename(columns=names)
    signed = list(table.columns[:2])
    table[signed] = table[signed].where(table.kappa_as_printed < 1, -table)
    return table


def reference_forces() -> pd.DataFrame:
    """Forces from independent solutions; ``trust`` is the relative deviation to allow."""
    return read(REFERENCES)


def others() -> pd.DataFrame:
    """Published numbers of balls in sockets, with their joints."""
    return read(OTHERS, dtype={"unit": str})


def measured(chart: str | None = None) -> pd.DataFrame:
    """Measured times and errors, of all charts of `study.measure.charts` or of one."""
    frame = read(SPEED, dtype={"version": str, "setting": str}).fillna({"setting": ""})
    if chart is None:
        return frame
    checks.choice("chart", chart, tuple(frame["chart"].unique()))
    return frame[frame["chart"] == chart].reset_index(drop=True)


def keep_measured(frame: pd.DataFrame) -> None:
    """Write `renewed` times to ``data/published/speed.csv``, and the hash of this file."""
    with paths.whole(SPEED) as temporary:
        renewed(frame).to_csv(temporary, index=False, lineterminator="\n", float_format="%.4g")
    write_hashes([SPEED])


def renewed(frame: pd.DataFrame) -> pd.DataFrame:
    """New rows in the places of the stored rows of the same chart, program and method.

    A new method comes at the end of its chart, and all other rows are those that are stored.
    """
    stored, by = measured(), ["chart", "program", "method"]
    places: dict[Any, float] = {row.chart: row.Index + 0.5 for row in stored.itertuples()}
    for row in stored.iloc[::-1].itertuples():
        places[row.chart, row.program, row.method] = row.Index
    keys = [tuple(row) for row in frame[by].to_numpy()]
    others = stored[[tuple(row) not in keys for row in stored[by].to_numpy()]]
    order = [places.get(key, places.get(key[0], np.inf)) for key in keys] + [*others.index]
    rows = pd.concat([frame, others], ignore_index=True)
    return rows.iloc[np.argsort(order, kind="stable")].reset_index(drop=True)


def read(path: Path, **options: Any) -> pd.DataFrame:
    """A table of the dataset. Raises `DatasetError` if it is missing or damaged (`verify`)."""
    verify([path])
    return pd.read_csv(path, **options)


def files() -> list[Path]:
    """Every file of numbers, and the description of the tables."""
    found = [path for suffix in ("csv", "json") for path in paths.DATA.rglob(f"*.{suffix}")]
    return [*sorted(path for path in found if not path.parent.name.startswith(".")), *LIBRARY]


def verify(some: Iterable[Path] | None = None) -> None:
    """Raise `DatasetError` for a file, by default of all, that is not as ``SHA256SUMS`` has it."""
    paths.require_checkout(paths.DATA)
    stated = _stated_hashes()
    for path in sorted({*stated, *files()}) if some is None else some:
        name, hashes = paths.shown(path), paths.shown(HASHES)
        restore = f"restore both with: git checkout -- {name} {hashes}"
        if not path.is_file():
            raise DatasetError(f"{name} is missing; restore it with: git checkout -- {name}")
        if path not in stated:
            raise DatasetError(
                f"{hashes} does not name {name}; restore it with: git checkout -- "
                f"{hashes}. If you added the file, accept it with: study data accept {name}"
            )
        if paths.sha256(path) != stated[path]:
            raise DatasetError(
                f"{name} is not the file whose SHA-256 hash is in {hashes}; {restore}. If you "
                f"edited it, accept it with: study data accept {name}"
            )


def write_hashes(changed: Iterable[Path]) -> None:
    """Renew the hashes of some files in ``SHA256SUMS``, and leave out files that are gone."""
    paths.BUILD.mkdir(exist_ok=True)
    with FileLock(paths.BUILD / "hashes.lock"):  # several jobs write tables
        stated = _stated_hashes() | {path: paths.sha256(path) for path in changed}
        lines = [
            f"{sha}  {Path(relpath(path, paths.DATA)).as_posix()}\n"
            for path, sha in sorted(stated.items())
            if path.is_file()
        ]
        with paths.whole(HASHES) as temporary:
            temporary.write_text("".join(lines), encoding="utf-8", newline="\n")


def _stated_hashes():
    """Hash of every file that ``SHA256SUMS`` names, in the form that ``sha256sum`` reads."""
    try:
        lines = HASHES.read_text(encoding="utf-8").splitlines()
        pairs = [line.split("  ", 1) for line in lines]
        return {(paths.DATA / name).resolve(): sha for sha, name in pairs}
    except (OSError, ValueError):
        name = paths.shown(HASHES)
        restore = f"restore it with: git checkout -- {name}"
        raise DatasetError(f"{name} is missing or damaged; {restore}") from None


def as_csv(frame: pd.DataFrame, name: str) -> str:
    """Text of a table with 9 significant digits, or fewer as `study.dataset.compare.DIGITS` says.

    The digits that are left out differ on another processor.
    """
    frame = frame.copy()
    for column, digits in DIGITS.get(name, {}).items():
        frame[column] = [float(f"{value:.{digits}g}") for value in frame[column]]
    return frame.to_csv(index=False, float_format="%.9g", lineterminator="\n")


def write_table(frame: pd.DataFrame, path: Path) -> None:
    """Write a table and its hash, unless it agrees with the stored file."""
    text = as_csv(frame, path.stem)
    if not path.is_file() or differs(path, StringIO(text), path.stem):
        with paths.whole(path) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")
        write_hashes([path])


def summary(frame: pd.DataFrame) -> pd.DataFrame:
    """One row for each case of a table of `load`: parameters, and maxima of the results."""
    keys = [*frame.loc[:, "case":"solver"].columns]
    return (
        frame.groupby(keys, sort=False)
        .agg(
            depths=("depth_star", "size"),
            largest_depth=("depth_star", "max"),
            largest_force=("force_star", "max"),
            largest_half_angle_deg=("contact_half_angle_deg", "max"),
            largest_error=("error_estimate", "max"),
        )
        .reset_index()
    )
