"""Loading and checking the force-depth curves and the other files of numbers.

The curves are in ``data/force_curves.csv``, with one row for each case and depth. The description
``data/datapackage.json`` (Frictionless Data Package) has the checksum of every file, and a table is
read only if its checksum agrees. `study.dataset.production` makes both.
"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from study import checks, contact, paths, provenance
from study.contact.costs import RELATIVE_COSTS
from study.contact.laws import COEFFICIENTS
from study.contact.stiffening import TABLE
from study.dataset.paper import PAPER_KINEMATICS

if TYPE_CHECKING:
    from study.joint import Kinematics

CURVES = paths.DATA / "force_curves.csv"
LINKS = paths.DATA / "links.csv"
SET_UPS = paths.DATA / "set_ups.csv"
CASES = paths.DATA / "solutions/cases.csv"
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
MATERIALS = paths.ROOT / "study/contact/materials.csv"  # no import: no curve depends on it
CONTACT_SIZE = paths.ROOT / "study/pages/report/contact_size.csv"
PUBLISHED = (TABLES, REFERENCES, OTHERS, SPEED)
LIBRARY = (COEFFICIENTS, RELATIVE_COSTS, TABLE, MATERIALS, CONTACT_SIZE)
"""Files of numbers in the folders of the modules that read them."""
MEND = "study data build"


class DatasetError(checks.StudyError):
    """The dataset is missing, damaged or outdated; the message names file and remedy."""


def load(**filters: Any) -> pd.DataFrame:
    """The force-depth curves as a table with one row for each case and depth.

    ``datapackage.json`` has the unit and the meaning of every column. A filter is the name of a
    column with a value, or a list of values: only rows with these values are returned. Raises
    `DatasetError` as `verify` does, and ``ValueError`` if a column or value is unknown or if no row
    is left.
    """
    curves = frame = read(CURVES, keep_default_na=False)  # no layers: an empty text
    for column, wanted in filters.items():
        checks.choice("column", column, tuple(curves.columns))
        values = [wanted] if np.isscalar(wanted) else list(wanted)
        left = frame[frame[column].isin(values)]
        unknown = set(values) - set(curves[column])
        if unknown or left.empty:
            held = (curves if unknown else frame)[column].unique()
            names = [f"{v:g}" if isinstance(v, float) else str(v) for v in held[:30]]
            known = ", ".join(names + ["..."] * (len(held) > 30))
            got = ", ".join(map(str, unknown or values))
            raise ValueError(f"{column} must be one of {known}, got {got}")
        frame = left
    return frame.reset_index(drop=True)


def paper_curves(
    kinematics: "Kinematics | list[Kinematics]" = PAPER_KINEMATICS, **filters: object
) -> pd.DataFrame:
    """Curves of the reference joint (`study.joint.paper_joint`), R2* = 20 to 10,000: see `load`."""
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
    """Published numbers of balls in sockets, with their joints: see ``data/README.md``."""
    return read(OTHERS, dtype={"unit": str})


def measured(chart: str | None = None) -> pd.DataFrame:
    """Measured times and errors, of all charts of `study.measure.charts` or of one.

    ``data/README.md`` describes their columns.
    """
    frame = read(SPEED, dtype={"version": str, "setting": str}).fillna({"setting": ""})
    if chart is None:
        return frame
    checks.choice("chart", chart, tuple(frame["chart"].unique()))
    return frame[frame["chart"] == chart].reset_index(drop=True)


def keep_measured(frame: pd.DataFrame) -> None:
    """Write `renewed` times to ``data/published/speed.csv``, and its checksum to the package."""
    keep(renewed(frame), SPEED, float_format="%.4g")


def keep(frame: pd.DataFrame, path: Path, **options: Any) -> None:
    """Write a table that no build makes, and its checksum to the description."""
    package = read_package()
    with paths.whole(path) as temporary:
        frame.to_csv(temporary, index=False, lineterminator="\n", **options)
    write_package(package, [path])


def renewed(frame: pd.DataFrame) -> pd.DataFrame:
    """New charts, together with the stored rows of other charts and of other programs."""
    kept, by = measured(), ["chart", "program"]
    others = ~kept.set_index(by).index.isin(frame.set_index(by).index)
    order = {chart: n for n, chart in enumerate(kept["chart"].unique())}
    frame = pd.concat([frame, kept[others]], ignore_index=True)
    return frame.sort_values("chart", key=lambda names: names.map(order), kind="stable")


def links() -> pd.DataFrame:
    """Errors of rigid links in random mechanisms: `study.choose.random_scenes.measure`."""
    return read(LINKS)


def set_ups() -> pd.DataFrame:
    """Random crank-sliders, with a row for each simulation: see ``data/README.md``."""
    return read(SET_UPS)


def read(path: Path, **options: Any) -> pd.DataFrame:
    """A table of the dataset, if its checksum is that in the description; see `verify`."""
    verify(path, read_package())
    return pd.read_csv(path, **options)


def read_package() -> dict[str, Any]:
    """Content of ``datapackage.json``, checked for all that is used here.

    Raises `DatasetError` if it is missing or damaged, which names the remedy.
    """
    paths.require_checkout(paths.DATA)
    name = provenance.name(PACKAGE)
    remedy = f"restore it with: git checkout -- {name}"
    try:
        package = json.loads(PACKAGE.read_text(encoding="utf-8"))
        package["provenance"]["design"], package["provenance"]["made_by"]
        stated = _stated_hashes(package)
        for resource in package["resources"]:
            if resource["path"] == CURVES.name:
                [(field["name"], field["type"]) for field in resource["schema"]["fields"]]
        for path in (CURVES, LINKS, SET_UPS, CASES, *SOLUTIONS.values(), *PUBLISHED, *LIBRARY):
            stated[path]
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise DatasetError(f"{name} is missing or damaged; {remedy}") from None
    return package


def _stated_hashes(package):
    """The hash of every file that the description names, by its path."""
    resources = {paths.DATA / r["path"]: r["hash"] for r in package["resources"] if r["origin"]}
    library = package["provenance"]["library_sha256"]
    stated = resources | {paths.ROOT / name: sha for name, sha in library.items()}
    return {path: text.removeprefix("sha256:") for path, text in stated.items()}


def verify(path: Path, package: dict[str, Any]) -> None:
    """Raise `DatasetError` if a file is missing, or if its checksum is not that in the description.

    By hashlib: frictionless (`production`) would take a second to import at every load.
    """
    name, description = provenance.name(path), f"data/{PACKAGE.name}"
    # the description too: its hash may be the one that is wrong
    remedy = f"restore it with: git checkout -- {name} {description}"
    if name in package["provenance"]["made_by"]:
        remedy += f", or rebuild it with: {MEND}"
    if not path.is_file():
        raise DatasetError(f"{name} is missing; {remedy}")
    if not is_as_stated(path, package):
        why = f"or its SHA-256 checksum in {description} is: they do not agree"
        raise DatasetError(f"{name} is damaged ({why}); {remedy}")


def is_as_stated(path: Path, package: dict[str, Any]) -> bool:
    """Whether a file exists and has the checksum that is in the description."""
    stated = _stated_hashes(package)[path]
    return path.is_file() and stated == provenance.sha256(path.read_bytes())


def verify_files() -> None:
    """`verify` every data file."""
    package = read_package()
    for path in _stated_hashes(package):
        verify(path, package)


def write_package(package: dict[str, Any], changed: list[Path]) -> None:
    """Write the description, with the present size and checksum of changed files."""
    for resource in package["resources"]:
        if (path := paths.DATA / resource["path"]) in changed:
            resource["bytes"] = path.stat().st_size
            resource["hash"] = f"sha256:{provenance.sha256(path.read_bytes())}"
    with paths.whole(PACKAGE) as temporary:
        temporary.write_text(json.dumps(package, indent=2) + "\n", encoding="utf-8")


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
