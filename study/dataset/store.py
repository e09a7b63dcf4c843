"""Loading and checking the force-depth curves and the other files of numbers.

The curves are in ``data/force_curves.csv``, with one row for each case and depth.
``data/datapackage.json`` (Frictionless Data Package) describes the columns of every table, and
``data/SHA256SUMS`` has the hash of every file: a table is read only if its hash agrees.
"""

from collections.abc import Iterable
from io import StringIO
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from filelock import FileLock

from study import checks, contact, paths
from study.contact.laws import COEFFICIENTS
from study.contact.materials import MATERIALS
from study.contact.stiffening import TABLE
from study.dataset.compare import DIGITS, differs
from study.joint.bearings import TABLE as BEARINGS

if TYPE_CHECKING:
    from study.joint import Kinematics

R2_STAR = 200
"""R2* of the paper's comparison of laws (Fig. 10 and Table 2), and of the joint's variations."""
PAPER_KINEMATICS: "Kinematics" = "linear"
"""Kinematics of the paper's finite elements, inferred from Table 2 (notebook 13). Only with these
does the relative RMSE of Fig. 14 rise, and its coefficient of determination fall, with R2*."""
CURVES = paths.DATA / "force_curves.csv"
CASES = paths.DATA / "solutions/cases.json"
SOLUTIONS = {
    "axial": paths.DATA / "solutions/axial_curves.csv",
    "stress": paths.DATA / "solutions/stresses.csv",
    "tilted": paths.DATA / "solutions/tilted_contacts.csv",
    "loaded": paths.DATA / "solutions/loaded_joints.csv",
}
"""Kind of solution -> file; `study.dataset.cached` reads them."""
TABLES = paths.DATA / "published/tables.csv"
SPEED = paths.DATA / "published/speed.csv"
PACKAGE = paths.DATA / "datapackage.json"
HASHES = paths.DATA / "SHA256SUMS"
RELATIVE_COSTS = paths.STUDY / "choose/relative_costs.json"
LOOKS = paths.STUDY / "pages/looks.csv"
LIBRARY = (COEFFICIENTS, RELATIVE_COSTS, TABLE, MATERIALS, BEARINGS, LOOKS)
"""Files of numbers in the folders of the modules that read them."""


class DatasetError(checks.StudyError):
    """The dataset is missing or damaged; the message names file and remedy."""


def load(**filters: Any) -> pd.DataFrame:
    """The force-depth curves as a table with one row for each case and depth.

    A filter is the name of a column with a value, or a list of values: only rows with these values
    are returned. Raises `DatasetError` as `read` does, and ``ValueError`` if a column or value is
    unknown or if no row is left.
    """
    curves = frame = read(CURVES, keep_default_na=False)  # no layers: an empty text
    for column, wanted in filters.items():
        checks.choice("column", column, tuple(curves.columns))
        values: list[Any] = [wanted] if np.isscalar(wanted) else list(wanted)
        left = frame[frame[column].isin(values)]
        unknown = [value for value in values if value not in set(curves[column])]
        if unknown or left.empty:
            known = (curves if unknown else frame)[column].unique().tolist()
            is_word = isinstance(known[0], str) and column != "case"
            allowed = f"one of {', '.join(known)}" if is_word else "one that study data show lists"
            raise ValueError(f"{column} must be {allowed}, got {(unknown or values)[0]}")
        frame = left
    return frame.reset_index(drop=True)


def paper_curves(
    kinematics: "Kinematics | list[Kinematics]" = PAPER_KINEMATICS, **filters: object
) -> pd.DataFrame:
    """Curves of `study.joint.reference_joint` for R2* = 20 to 10,000, filtered as by `load`."""
    return load(group="paper", kinematics=kinematics, **filters)


def published(where: str | None = None) -> pd.Series:
    """Numbers that the paper prints, by ``where``, ``row`` and ``quantity``.

    With ``where``, for example ``"Table 2"``, they are those of this table or figure.
    """
    frame = read(TABLES)
    if where is not None:
        checks.choice("where", where, tuple(frame["where"].unique()))
    values = frame.set_index(["where", "row", "quantity"])["value"].sort_index()
    return values if where is None else values.loc[where]


def published_table_2() -> pd.DataFrame:
    """Table 2 with the signs that the paper leaves out: absolute values above 1 are negative.

    The paper's coefficient of determination kappa differs from that by the usual definition
    (`study.claims.statistics`).
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
    return read(paths.DATA / "published/joint.csv")


def others() -> pd.DataFrame:
    """Published numbers of balls in sockets, with their joints."""
    return read(paths.DATA / "published/others.csv", dtype={"unit": str})


def measured(chart: str | None = None) -> pd.DataFrame:
    """Measured times and errors, of all charts of `study.measure.charts` or of one."""
    frame = read(SPEED, dtype={"version": str, "setting": str}).fillna({"setting": ""})
    if chart is None:
        return frame
    checks.choice("chart", chart, tuple(frame["chart"].unique()))
    return frame[frame["chart"] == chart].reset_index(drop=True)


def renewed(frame: pd.DataFrame) -> pd.DataFrame:
    """The stored times, with those of ``frame`` instead of the same methods of charts and programs.

    What was not timed, such as a program that is not installed, keeps its stored times.
    """
    stored, same = measured(), ["chart", "program", "method"]
    timed = pd.MultiIndex.from_frame(frame[same])
    rows = pd.concat([frame, stored[~pd.MultiIndex.from_frame(stored[same]).isin(timed)]])
    charts = [*dict.fromkeys([*stored.chart, *frame.chart])]
    return rows.sort_values("chart", key=lambda of: of.map(charts.index), kind="stable")


def keep_measured(frame: pd.DataFrame) -> None:
    """Write the `renewed` times, and the hash of their file."""
    with paths.whole(SPEED) as temporary:
        rows = renewed(frame)
        rows.to_csv(temporary, index=False, lineterminator="\n", float_format="%.4g")
    write_hashes([SPEED])


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
        if not path.is_file() or path not in stated or paths.sha256(path) != stated[path]:
            state = "is not the file" if path.is_file() else "is missing, or not the file"
            raise DatasetError(
                f"{name} {state} whose SHA-256 hash is in {hashes}; restore both with: git "
                f"checkout -- {name} {hashes}. If you edited it, renew its hash with: python "
                f"data/build.py hash {name}"
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
