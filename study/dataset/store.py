"""The cached force-depth curves: how they are loaded, checked and described.

The numbers are in ``data/force_curves.csv``, one row per case and depth, and their description is
``data/datapackage.json`` (Frictionless Data Package). `design` has the joints.
"""

import json
import platform
from collections import Counter
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pandas as pd

from study import checks, contact, paths, provenance
from study.contact import hertz_correction
from study.contact.hertz_correction import TABLE
from study.contact.laws import COEFFICIENTS
from study.dataset import design, tolerance
from study.joint import Joint, Kinematics, force_curve
from study.joint.compliance import DRIVES, RESOLUTION, RIMS
from study.joint.curve import SOLVERS
from study.joint.joint import KINEMATICS

CURVES = paths.DATA / "force_curves.csv"
LINKS = paths.DATA / "links.csv"
SPEED = paths.DATA / "published/speed.csv"
PACKAGE = paths.DATA / "datapackage.json"
MATERIALS = paths.ROOT / "study/contact/materials.csv"  # no import: no curve depends on it
MEND = "study data build"
TITLE = "Force-depth curves of spherical clearance joints, by series and finite elements"
ORIGINS = {
    "force_curves.csv": "generated",
    "links.csv": "generated",
    "published/tables.csv": "published",
    "published/joint.csv": "reference",
    "published/mechanism.csv": "reference",
    "published/others.csv": "published",
    "published/speed.csv": "measured",
}
"""Data files whose hash is kept -> where their numbers come from."""
GENERATED = {
    CURVES: "joint/curve",
    COEFFICIENTS: "dataset/fitting",
    TABLE: "dataset/hertz_correction",
    LINKS: "choose/random_scenes",
}
"""Generated file -> module whose imports lead to all code that decides it."""
LIBRARY = (COEFFICIENTS, TABLE, MATERIALS)
"""Files of numbers beside the library's modules."""
COLUMNS = {
    "group": ("", "What the study needs the case for"),
    "case": ("", "Name of the case: set-up, kinematics and R2*"),
    "r2_star": ("1", "Dimensionless socket radius R2/dR"),
    "socket_ratio": ("1", "Outer over inner radius of the socket"),
    "poisson_ball": ("1", "Poisson's ratio of the ball"),
    "poisson_socket": ("1", "Poisson's ratio of the socket"),
    "modulus_ratio": ("1", "Young's modulus of the socket over that of the ball"),
    "layers": (
        "",
        "Socket's layers from the inside out, outer ratio:modulus over the ball's:Poisson's ratio "
        "of each, separated by semicolons; empty for one material",
    ),
    "ball_drive": ("", "Ball's equatorial plane: plane (radially free) or clamped"),
    "rim": ("", "Socket's edge at the equator: mirror plane or free"),
    "kinematics": ("", "Pairing of the surfaces: small, linear or finite"),
    "solver": ("", "series, or finite elements: quadratic or linear triangles"),
    "depth_star": ("1", "Dimensionless penetration depth d/dR"),
    "force_star": ("1", "Dimensionless force P/(E* dR^2)"),
    "contact_half_angle_deg": ("deg", "Polar angle of the contact's edge"),
    "peak_pressure_star": ("1", "Largest pressure p R2/(E* dR)"),
    "error_estimate": ("1", "Relative discretisation error of the force, estimated"),
}
"""Column of the curves -> its unit, empty for text, and meaning.

A new column also needs `ForceCurve.columns` and a line in ``data/README.md``."""
_CONSTRAINTS = {
    "group": {"enum": list(design.GROUPS)},
    "layers": {"required": False},
    "ball_drive": {"enum": list(DRIVES)},
    "rim": {"enum": list(RIMS)},
    "kinematics": {"enum": list(KINEMATICS)},
    "solver": {"enum": list(SOLVERS)},
    "contact_half_angle_deg": {"minimum": 0, "maximum": 90},
    "r2_star": {"minimum": 1},
    "socket_ratio": {"minimum": 1},
    "depth_star": {"minimum": 0},
    "force_star": {"minimum": 0},
    "peak_pressure_star": {"minimum": 0},
    "error_estimate": {"minimum": 0},
}


class DatasetError(checks.StudyError):
    """The dataset is missing, damaged or out of date; the message names file and remedy."""


def load(**filters: object) -> pd.DataFrame:
    """The dataset as a tidy frame, one row per case and depth: `COLUMNS`.

    Parameters
    ----------
    **filters
        Column name = value, or list of values, to keep.

    Raises
    ------
    DatasetError
        As `verify_files`.
    ValueError
        For an unknown column, or filters that leave no row.
    """
    frame = _read(CURVES, keep_default_na=False)  # no layers: an empty text
    for column in filters:
        checks.choice("column", column, tuple(frame.columns))
    asked = {column: _values(column, wanted) for column, wanted in filters.items()}
    found = {column: frame[column].isin(values) for column, values in asked.items()}
    matches = pd.DataFrame(found, index=frame.index)
    keep = matches.all(axis=1)
    for column, values in asked.items():
        others = matches.drop(columns=column).all(axis=1)  # what is left without this filter
        unknown = set(values) - set(frame[column])
        if unknown or (others.any() and not keep.any()):
            held = frame[column][others if others.any() else ~keep].unique()
            names = [f"{v:g}" if isinstance(v, float) else str(v) for v in held[:30]]
            known = ", ".join(names + ["..."] * (len(held) > 30))
            got = ", ".join(map(str, unknown or values))
            raise ValueError(f"{column} must be one of {known}, got {got}")
    if not keep.any():
        text = ", ".join(f"{column} = {values}" for column, values in asked.items())
        raise ValueError(f"filters must leave a case, but none has {text}")
    return frame[keep].reset_index(drop=True)


def _values(column, wanted):
    """Values of a filter as a list."""
    several = pd.api.types.is_list_like(wanted) and not isinstance(wanted, dict)
    values = list(wanted) if several else [wanted]
    for value in values:
        if not isinstance(value, str | float | int | np.number):
            got = checks.shown(value)
            raise ValueError(f"{column} must be a value or a list of values, got {got}")
    return values


def paper_curves(
    kinematics: Kinematics | list[Kinematics] = design.PAPER_KINEMATICS, **filters: object
) -> pd.DataFrame:
    """Curves of the paper's joint (`study.joint.paper_joint`), R2* = 20..10,000: see `load`."""
    return load(group="paper", kinematics=kinematics, **filters)


def published(where: str | None = None) -> pd.Series:
    """Numbers that the paper prints, by ``where``, ``row`` and ``quantity``.

    Parameters
    ----------
    where
        One table or figure, ``"Table 2"``: numbers by ``row`` and ``quantity``.
    """
    frame = _read(paths.DATA / "published/tables.csv")
    if where is not None:
        checks.choice("where", where, tuple(frame["where"].unique()))
    values = frame.set_index(["where", "row", "quantity"])["value"].sort_index()
    return values if where is None else values.loc[where]


def published_table_2() -> pd.DataFrame:
    """Table 2 with the signs that the paper leaves out: absolute values above 1 are negative.

    Columns ``determination``, ``determination_adjusted`` and ``RMSE``, a row per law.
    """
    table = published("Table 2").rename({"proposed": "hyperbolic_winkler"}).unstack()
    table = table.loc[list(contact.PAPER_LAWS), ["determination", "determination_adjusted", "RMSE"]]
    table[["determination", "determination_adjusted"]] = table[
        ["determination", "determination_adjusted"]
    ].where(table.determination < 1, -table)
    return table


def reference_forces() -> pd.DataFrame:
    """Forces of independent origin; ``trust`` is the relative accuracy to expect."""
    return _read(paths.DATA / "published/joint.csv")


def others() -> pd.DataFrame:
    """Numbers that others printed for a ball in a socket, and their joint: ``data/README.md``."""
    return _read(paths.DATA / "published/others.csv", dtype={"unit": str})


def measured(chart: str | None = None) -> pd.DataFrame:
    """Measured times and errors, of all charts of ``study.measure.speed.CHARTS`` or of one.

    The columns are ``study.measure.speed.COLUMNS``.
    """
    frame = _read(SPEED, dtype={"version": str, "setting": str}).fillna({"setting": ""})
    if chart is None:
        return frame
    checks.choice("chart", chart, tuple(frame["chart"].unique()))
    return frame[frame["chart"] == chart].reset_index(drop=True)


def keep_measured(frame: pd.DataFrame) -> None:
    """Write charts to ``data/published/speed.csv``, and its hash to the description.

    Charts, and programs in a chart, that the frame does not have are kept.
    """
    kept, by = measured(), ["chart", "program"]
    others = ~kept.set_index(by).index.isin(frame.set_index(by).index)
    order = {chart: n for n, chart in enumerate(kept["chart"].unique())}
    frame = pd.concat([frame, kept[others]], ignore_index=True)
    frame = frame.sort_values("chart", key=lambda names: names.map(order), kind="stable")
    package, name = _read_package(), SPEED.relative_to(paths.DATA).as_posix()
    with paths.whole(SPEED) as temporary:
        frame.to_csv(temporary, index=False, float_format="%.4g", lineterminator="\n")
    resources = [_resource(name) if r["path"] == name else r for r in package["resources"]]
    _write_description(package | {"resources": resources})


def links() -> pd.DataFrame:
    """Errors of rigid links: the columns of `study.choose.random_scenes.measure`."""
    return _read(LINKS)


def _read(path, **options):
    """A table of the dataset, whose hash is compared with the description's."""
    described = {paths.DATA / r["path"]: r for r in _read_package()["resources"]}
    _verify(path, described[path]["hash"], described[path]["origin"] == "generated")
    return pd.read_csv(path, **options)


def solve_case(group: str, name: str, joint: Joint, depths: tuple[float, ...]) -> pd.DataFrame:
    """One case of the design, in the columns of the dataset."""
    return pd.DataFrame({"group": group, "case": name} | force_curve(joint, depths).columns())


def write_table(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV, whole or not at all, if it does not agree with the kept one.

    Numbers have 9 significant digits, or fewer by `tolerance.DIGITS`. On another processor the last
    ones differ: a kept file that agrees stays as it is.
    """
    frame = frame.copy()
    for column, digits in tolerance.DIGITS.get(path.stem, {}).items():
        frame[column] = [float(f"{value:.{digits}g}") for value in frame[column]]
    with paths.scratch(path.parent) as folder:
        made = folder / path.name
        frame.to_csv(made, index=False, float_format="%.9g", lineterminator="\n")
        if not path.is_file() or tolerance.table_differs(path, made):
            paths.copy(made, path)


def write_hertz_correction(table: pd.DataFrame) -> None:
    """Write the table of `study.contact.hertz_correction`, if it does not agree with the kept one.

    On another processor a number may differ by one, and one at the limit of being left out by two.
    """
    if TABLE.is_file():
        keys = list(table.columns[: -len(hertz_correction.PLACES)])
        kept = pd.read_csv(TABLE).set_index(keys)
        if kept.sub(table.set_index(keys), fill_value=0).abs().to_numpy().max() <= 2:
            return
    with paths.whole(TABLE) as temporary:
        table.to_csv(temporary, index=False, lineterminator="\n")


def write_package(wall_time: float) -> None:
    """Describe the dataset in ``datapackage.json``: schema, units, hashes and provenance.

    ``wall_time`` is that of all cases, in s.
    """
    _refuse_damaged_published_files()
    _write_description(
        {
            "name": "spherical-clearance-joint-force-curves",
            "title": TITLE,
            "description": "Frictionless elastic contact of a ball in a socket; see README.md.",
            "profile": "data-package",
            "licenses": [{"name": "CC-BY-4.0", "title": "Creative Commons Attribution 4.0"}],
            "resources": [_resource(name) for name in ORIGINS],
            "provenance": {
                "command": MEND,
                "library_sha256": {
                    provenance.name(path): provenance.sha256(path.read_bytes()) for path in LIBRARY
                },
                "design": _design(),
                "made_by": _made_by(),
                "versions": {p: version(p) for p in ("numpy", "scipy", "scikit-fem")}
                | {"python": platform.python_version()},
                "wall_time_s": round(wall_time, 1),
            },
        }
    )


def _schema():
    fields = []
    for name, (unit, text) in COLUMNS.items():
        field = {"name": name, "type": "number" if unit else "string", "description": text}
        field |= {"unit": unit} if unit else {}
        fields.append(field | {"constraints": {"required": True} | _CONSTRAINTS.get(name, {})})
    return {"fields": fields, "primaryKey": ["case", "depth_star"]}


def _write_description(description):
    with paths.whole(PACKAGE) as temporary:
        temporary.write_text(json.dumps(description, indent=2) + "\n", encoding="utf-8")


def _resource(name):
    """Description of one data file, by its name in ``data/``."""
    path = paths.DATA / name
    table = {"profile": "tabular-data-resource", "schema": _schema()} if path == CURVES else {}
    return {
        "name": name.removesuffix(".csv").replace("/", "-").replace("_", "-"),
        "path": name,
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8",
        "bytes": path.stat().st_size,
        "hash": f"sha256:{provenance.sha256(path.read_bytes())}",
        "origin": ORIGINS[name],
    } | table


def _refuse_damaged_published_files():
    """Refuse damaged files that no build makes: a new hash would hide the damage."""
    try:
        stated = {r["path"]: r["hash"] for r in _read_package()["resources"]}
    except DatasetError:
        stated = {}  # there is nothing to compare with
    for name, origin in ORIGINS.items():
        if origin != "generated" and name in stated:  # a new file has no hash yet
            _verify(paths.DATA / name, stated[name], generated=False)


def _read_package():
    """Content of the description, checked for all that is used here."""
    paths.require_checkout(paths.DATA)
    name = provenance.name(PACKAGE)
    remedy = f"restore it with: git checkout -- {name}, or rebuild it with: {MEND}"
    try:
        package = json.loads(PACKAGE.read_text(encoding="utf-8"))
        for key in ("library_sha256", "design", "made_by"):
            package["provenance"][key]
        for path in LIBRARY:
            package["provenance"]["library_sha256"][provenance.name(path)]
        described = {r["path"]: r for r in package["resources"] if r["hash"]}
    except FileNotFoundError:
        raise DatasetError(f"{name} is missing; {remedy}") from None
    except (ValueError, KeyError, TypeError, AttributeError):
        raise DatasetError(f"{name} is damaged; {remedy}") from None
    if missing := set(ORIGINS) - set(described):
        raise DatasetError(f"{name} does not describe {', '.join(sorted(missing))}; {remedy}")
    if described[CURVES.name].get("schema") != _schema():
        raise DatasetError(f"{name} is damaged: the schema of {CURVES.name} differs; {remedy}")
    return package


def _verify(path, stated, generated):
    """Compare one file with the hash stated for it.

    By hashlib: frictionless (`quality`) would take a second to import at every load.
    """
    name, description = provenance.name(path), f"data/{PACKAGE.name}"
    # the description too: its hash may be the one that is wrong
    remedy = f"restore it with: git checkout -- {name} {description}"
    if generated:
        remedy += f", or rebuild it with: {MEND}"
    if not path.is_file():
        raise DatasetError(f"{name} is missing; {remedy}")
    if stated.removeprefix("sha256:") != provenance.sha256(path.read_bytes()):
        why = f"or its sha256 in {description}: they do not agree"
        raise DatasetError(f"{name} is damaged ({why}); {remedy}")


def _design():
    """Which cases there are and why; the hash is that of all parameters, defaults included."""
    cases = [(s.group, name, joint, s.depths) for s in design.DESIGN for name, joint in s.cases()]
    count = Counter(group for group, *_ in cases)
    return {
        "groups": {g: {"why": why, "cases": count[g]} for g, why in design.GROUPS.items()},
        "resolution": RESOLUTION,
        "cases_sha256": provenance.sha256(repr(cases).encode()),
    }


def sources(path: Path) -> list[Path]:
    """Source files that decide a generated file."""
    return provenance.sources(paths.ROOT / f"study/{GENERATED[path]}.py")


def _made_by():
    """Generated file -> digest of every file that decides it."""
    read = {
        COEFFICIENTS: [CURVES, paths.DATA / "published/tables.csv"],
        LINKS: [TABLE],
    }
    decide = {path: [*sources(path), *read.get(path, [])] for path in GENERATED}
    return {provenance.name(path): provenance.digests(files) for path, files in decide.items()}


def verify_files() -> None:
    """Compare the hash of every data file with that in its description.

    Raises
    ------
    DatasetError
        If a file is missing or damaged; names the remedy.
    """
    package = _read_package()
    stated = package["provenance"]
    for resource in package["resources"]:
        _verify(paths.DATA / resource["path"], resource["hash"], resource["origin"] == "generated")
    for path in LIBRARY:
        _verify(path, stated["library_sha256"][provenance.name(path)], path in GENERATED)


def verify_made_by() -> None:
    """Compare code, data and design that decide a generated file with those that made it.

    Raises
    ------
    DatasetError
        If a file was made by others, and is out of date; names the remedy.
    """
    stated = _read_package()["provenance"]
    if stated["design"] != _design():
        raise DatasetError(
            f"data/{CURVES.name} is out of date: the design (study/dataset/design.py), a default "
            f"of the joint or a resolution has changed since it was made; rebuild it with: {MEND}"
        )
    for name, digests in _made_by().items():
        before = stated["made_by"].get(name, {})
        changed = [file for file in digests | before if digests.get(file) != before.get(file)]
        if changed:
            why = f"{', '.join(changed)} changed since it was made; rebuild it with: {MEND}"
            raise DatasetError(f"{name} is out of date: {why}")


def summary(frame: pd.DataFrame) -> pd.DataFrame:
    """One row per case of a frame of `load`: its parameters, ranges and largest error."""
    keys = ["case", "r2_star", "socket_ratio", "poisson_ball", "modulus_ratio"]
    keys += ["layers"]
    keys += ["ball_drive", "rim", "kinematics", "solver"]
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
