"""The cached force-depth curves: what they are, how they are built, checked and loaded.

The design stands in `design`, the numbers in ``data/force_curves.csv`` (one row per case
and depth), their description in ``data/datapackage.json`` (Frictionless Data Package).
"""

import json
import platform
from importlib.metadata import version

import numpy as np
import pandas as pd

from study import checks, contact, paths
from study.contact.laws import COEFFICIENTS
from study.dataset import agreement, design, provenance
from study.joint import fem, force_curve, series
from study.joint.compliance import DRIVES, RIMS
from study.joint.curve import FINITE_RESOLUTION, KINEMATICS, SOLVERS

CURVES = paths.DATA / "force_curves.csv"
PACKAGE = paths.DATA / "datapackage.json"
MEND = "study data build"

LINKS = paths.DATA / "links.csv"
GENERATED = {
    CURVES: "joint/curve",
    COEFFICIENTS: "dataset/fitting",
    LINKS: "choose/links",
}
"""Generated file -> module whose imports lead to all code that decides it."""
PEERS = paths.DATA / "published/peers.csv"
PUBLISHED = {
    "published/tables.csv": "published",
    "published/joint.csv": "reference",
    "published/mechanism.csv": "reference",
    "published/peers.csv": "measured",
}


class DatasetError(checks.StudyError):
    """The dataset is missing, damaged or out of date; the message names file and remedy."""


_SCHEMA = [
    ("group", "string", "", "What the study needs the case for"),
    ("case", "string", "", "Name of the case: set-up, kinematics and R2*"),
    ("r2_star", "number", "1", "Dimensionless socket radius R2/dR"),
    ("socket_ratio", "number", "1", "Outer over inner radius of the socket"),
    ("poisson_ball", "number", "1", "Poisson's ratio of the ball"),
    ("poisson_socket", "number", "1", "Poisson's ratio of the socket"),
    ("modulus_ratio", "number", "1", "Young's modulus of the socket over that of the ball"),
    ("ball_drive", "string", "", "Ball's equatorial plane: plane (radially free) or clamped"),
    ("rim", "string", "", "Socket's edge at the equator: mirror plane or free"),
    ("kinematics", "string", "", "Pairing of the surfaces: small, linear or finite"),
    ("solver", "string", "", "series, or finite elements: quadratic or linear triangles"),
    ("depth_star", "number", "1", "Dimensionless penetration depth d/dR"),
    ("force_star", "number", "1", "Dimensionless force P/(E* dR^2)"),
    ("contact_half_angle", "number", "deg", "Polar angle of the contact's edge"),
    ("peak_pressure_star", "number", "1", "Largest pressure p R2/(E* dR)"),
    ("error_estimate", "number", "1", "Relative discretisation error of the force, estimated"),
]
_CONSTRAINTS = {
    "group": {"enum": list(design.GROUPS)},
    "r2_star": {"minimum": 1},
    "socket_ratio": {"minimum": 1},
    "ball_drive": {"enum": list(DRIVES)},
    "rim": {"enum": list(RIMS)},
    "kinematics": {"enum": list(KINEMATICS)},
    "solver": {"enum": list(SOLVERS)},
    "depth_star": {"minimum": 0},
    "force_star": {"minimum": 0},
    "contact_half_angle": {"minimum": 0, "maximum": 90},
    "peak_pressure_star": {"minimum": 0},
    "error_estimate": {"minimum": 0},
}


def load(**filters):
    """The dataset as a tidy frame, one row per case and depth.

    Parameters
    ----------
    **filters
        Column name = value, or list of values, to keep.

    Returns
    -------
    pandas.DataFrame
        Columns

        - ``group``: what the study needs the case for, a key of `study.dataset.design.GROUPS`
        - ``case``: name of the case
        - ``r2_star``: dimensionless socket radius R2/dR
        - ``socket_ratio``: outer over inner radius of the socket
        - ``poisson_ball``, ``poisson_socket``: Poisson's ratios
        - ``modulus_ratio``: Young's modulus of the socket over that of the ball
        - ``ball_drive``: ``plane`` or ``clamped``
        - ``rim``: ``mirror`` or ``free``
        - ``kinematics``: ``small``, ``linear`` or ``finite`` (see `study.joint.Joint`)
        - ``solver``: ``series`` or ``quadratic`` (see `study.joint.force_curve`)
        - ``depth_star``: dimensionless penetration depth d/dR
        - ``force_star``: dimensionless force P/(E* dR^2)
        - ``contact_half_angle``: polar angle of the contact's edge, in deg
        - ``peak_pressure_star``: largest pressure p R2/(E* dR)
        - ``error_estimate``: estimated relative discretisation error of ``force_star``

    Raises
    ------
    DatasetError
        If a file is missing, damaged or out of date; names it and the command that mends it.
    ValueError
        For an unknown column, or filters that leave no row.
    """
    verify_files()
    frame = pd.read_csv(CURVES)
    for column in filters:
        checks.choice("column", column, tuple(frame.columns))
    filters = {column: _values(column, wanted) for column, wanted in filters.items()}
    kept = pd.DataFrame(index=frame.index)
    for column, wanted in filters.items():
        kept[column] = frame[column].isin(wanted)
    keep = kept.all(axis=1)
    for column, wanted in filters.items():
        others = kept.drop(columns=column).all(axis=1)  # what is left without this filter
        unknown = set(wanted) - set(frame[column])
        if unknown or (others.any() and not keep.any()):
            held = frame[column][others if others.any() else ~keep].unique()
            known = [f"{v:g}" if isinstance(v, float) else str(v) for v in held]
            known = ", ".join(known[:30] + ["..."] * (len(known) > 30))
            got = ", ".join(str(value) for value in unknown or wanted)
            raise ValueError(f"{column} must be one of {known}, got {got}")
    if not keep.any():
        asked = ", ".join(f"{column} = {wanted}" for column, wanted in filters.items())
        raise ValueError(f"filters must leave a case, but none has {asked}")
    frame = frame[keep]
    return frame.reset_index(drop=True)


def _values(column, wanted):
    """Values of a filter as a list, or ``ValueError``."""
    several = pd.api.types.is_list_like(wanted) and not isinstance(wanted, dict)
    values = list(wanted) if several else [wanted]
    for value in values:
        if not isinstance(value, str | float | int | np.number):
            shown = checks.shown(value)
            raise ValueError(f"{column} must be a value or a list of values, got {shown}")
    return values


def paper_curves(kinematics=design.PAPER_KINEMATICS, **filters):
    """Curves of the paper's joint (`study.joint.paper_joint`), R2* = 20..10,000.

    Parameters
    ----------
    kinematics : {"linear", "small", "finite"}
    **filters
        As for `load`.

    Returns
    -------
    pandas.DataFrame
        See `load` for the columns.
    """
    return load(group="paper", kinematics=kinematics, **filters)


def published(where=None):
    """Numbers that the paper prints, from ``data/published/tables.csv``.

    Parameters
    ----------
    where : str, optional
        Table or figure, e.g. ``"Table 2"``.

    Returns
    -------
    pandas.Series
        Value by (``row``, ``quantity``), or by (``where``, ``row``, ``quantity``).
    """
    verify_files()
    frame = pd.read_csv(paths.DATA / "published/tables.csv")
    if where is not None:
        checks.choice("where", where, tuple(frame["where"].unique()))
    values = frame.set_index(["where", "row", "quantity"])["value"].sort_index()
    return values if where is None else values.loc[where]


def published_table_2():
    """Table 2 with the signs that the paper leaves out: absolute values above 1 are negative.

    Returns
    -------
    pandas.DataFrame
        Columns ``R2``, ``R2_adj`` and ``RMSE``, a row per law, a key of `study.contact.LAWS`.
    """
    table = published("Table 2").rename({"proposed": "hyperbolic_winkler"}).unstack()
    table = table.loc[list(contact.PAPER_LAWS), ["R2", "R2_adj", "RMSE"]]
    table[["R2", "R2_adj"]] = table[["R2", "R2_adj"]].where(table.R2 < 1, -table)
    return table


def reference_forces():
    """Forces of independent origin, from ``data/published/joint.csv``.

    Returns
    -------
    pandas.DataFrame
        Source, joint, depth, force, and ``trust``: the relative accuracy to expect.
    """
    verify_files()
    return pd.read_csv(paths.DATA / "published/joint.csv")


def measured(chart=None):
    """Times and errors of laws, solvers and steppers, from ``data/published/peers.csv``.

    Parameters
    ----------
    chart : {"laws", "solvers", "steppers"}, optional

    Returns
    -------
    pandas.DataFrame
        Columns of ``study.measure.speed.COLUMNS``.
    """
    verify_files()
    frame = pd.read_csv(PEERS, dtype={"version": str, "setting": str}).fillna({"setting": ""})
    if chart is None:
        return frame
    checks.choice("chart", chart, tuple(frame["chart"].unique()))
    return frame[frame["chart"] == chart].reset_index(drop=True)


def keep_measured(frame):
    """Write charts to ``data/published/peers.csv``, and its hash to the description.

    Parameters
    ----------
    frame : pandas.DataFrame
        Columns of ``study.measure.speed.COLUMNS``. Charts that it does not hold are kept, and
        so are
        other programs in those that it holds.
    """
    kept = measured()
    new = set(zip(frame["chart"], frame["program"], strict=True))
    old = [(c, p) not in new for c, p in zip(kept["chart"], kept["program"], strict=True)]
    frame = pd.concat([frame, kept[old]], ignore_index=True)
    order = {chart: n for n, chart in enumerate(kept["chart"].unique())}
    frame = frame.sort_values("chart", key=lambda names: names.map(order), kind="stable")
    package, name = _read_package(), PEERS.relative_to(paths.DATA).as_posix()
    with paths.whole(PEERS) as temporary:
        frame.to_csv(temporary, index=False, float_format="%.4g", lineterminator="\n")
    resource = _resource(PEERS, name[:-4].replace("/", "-"), PUBLISHED[name], None)
    others = [r for r in package["resources"] if r["path"] != name]
    _write_description(package | {"resources": [*others, resource]})


def links():
    """Errors of rigid links on random scenes, from ``data/links.csv``.

    Returns
    -------
    pandas.DataFrame
        Columns of ``study.choose.links.measure``.
    """
    verify_files()
    return pd.read_csv(LINKS)


def solve_case(group, name, joint, depths):
    """One case of the design, in the columns of the dataset.

    Parameters
    ----------
    group, name : str
    joint : study.joint.Joint
    depths : tuple of float

    Returns
    -------
    pandas.DataFrame
    """
    return pd.DataFrame({"group": group, "case": name} | force_curve(joint, depths).columns())


def write_table(frame, path):
    """Write a table as CSV, whole or not at all, if it does not agree with the kept one.

    Numbers have 9 significant digits, or as many as `agreement.DIGITS` says: estimates have
    few that mean anything. On another processor the last ones differ; a kept file whose numbers
    all agree (`study.dataset.agreement.table_differs`) stays as it is.

    Parameters
    ----------
    frame : pandas.DataFrame
    path : pathlib.Path
    """
    frame = frame.copy()
    for column, digits in agreement.DIGITS.get(path.stem, {}).items():
        frame[column] = [float(f"{value:.{digits}g}") for value in frame[column]]
    with paths.scratch(path.parent) as folder:
        made = folder / path.name
        frame.to_csv(made, index=False, float_format="%.9g", lineterminator="\n")
        if not path.is_file() or agreement.table_differs(path, made):
            paths.copy(made, path)


def write_package(wall_time):
    """Describe the dataset in ``datapackage.json``: schema, units, hashes and provenance.

    Parameters
    ----------
    wall_time : float
        Time that the cases took together, in s.
    """
    _refuse_damaged_published_files()
    provenance = {
        "command": MEND,
        "coefficients_sha256": _sha256(COEFFICIENTS),
        "design": _design(),
        "made_by": _made_by(),
        "versions": {p: version(p) for p in ("numpy", "scipy", "scikit-fem")}
        | {"python": platform.python_version()},
        "wall_time_s": round(wall_time, 1),
    }
    description = {
        "name": "spherical-clearance-joint-force-curves",
        "title": "Force-depth curves of spherical clearance joints, by series and finite elements",
        "description": "Frictionless elastic contact of a ball in a socket; see README.md.",
        "profile": "data-package",
        "licenses": [{"name": "CC-BY-4.0", "title": "Creative Commons Attribution 4.0"}],
        "resources": [
            _resource(CURVES, "force-curves", "generated", _schema()),
            _resource(LINKS, "links", "generated", None),
            *(
                _resource(paths.DATA / name, name[:-4].replace("/", "-"), origin, None)
                for name, origin in PUBLISHED.items()
            ),
        ],
        "provenance": provenance,
    }
    _write_description(description)


def _schema():
    fields = [
        {"name": name, "type": kind, "description": text}
        | ({"unit": unit} if unit else {})
        | {"constraints": {"required": True} | _CONSTRAINTS.get(name, {})}
        for name, kind, unit, text in _SCHEMA
    ]
    return {"fields": fields, "primaryKey": ["case", "depth_star"]}


def _write_description(description):
    with paths.whole(PACKAGE) as temporary:
        temporary.write_text(json.dumps(description, indent=2) + "\n", encoding="utf-8")


def _resource(path, name, origin, schema):
    resource = {
        "name": name,
        "path": path.relative_to(paths.DATA).as_posix(),
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8",
        "bytes": path.stat().st_size,
        "hash": f"sha256:{_sha256(path)}",
        "origin": origin,
    }
    return resource | ({"profile": "tabular-data-resource", "schema": schema} if schema else {})


def _refuse_damaged_published_files():
    """Files from elsewhere keep the hash they have: a build does not bless a damaged one."""
    try:
        package = _read_package()
    except DatasetError:
        return  # there is nothing to compare with
    stated = {r["path"]: r["hash"] for r in package["resources"]}
    for name in set(PUBLISHED) & set(stated):  # a new file has no hash yet
        _verify(name, stated[name])


def _read_package():
    """Content of the description, with everything in it that is used here."""
    paths.require_checkout(paths.DATA)
    name = PACKAGE.relative_to(paths.ROOT)
    remedy = f"mend it with: git checkout -- {name}, or make it anew with: {MEND}"
    try:
        package = json.loads(PACKAGE.read_text(encoding="utf-8"))
        for key in ("coefficients_sha256", "design", "made_by"):
            package["provenance"][key]
        described = {r["path"]: r for r in package["resources"] if r["hash"]}
    except FileNotFoundError:
        raise DatasetError(f"{name} is missing; {remedy}") from None
    except (ValueError, KeyError, TypeError, AttributeError):
        raise DatasetError(f"{name} is damaged; {remedy}") from None
    names = {path.relative_to(paths.DATA).as_posix() for path in (CURVES, LINKS)} | set(PUBLISHED)
    if missing := names - set(described):
        raise DatasetError(f"{name} does not describe {', '.join(sorted(missing))}; {remedy}")
    if described[CURVES.name].get("schema") != _schema():
        raise DatasetError(f"{name} is damaged: the schema of {CURVES.name} is another; {remedy}")
    return package


def _verify(name, stated):
    """Compare one data file with the hash stated for it."""
    path = paths.DATA / name
    # the description too: its hash may be the one that is wrong
    remedy = f"git checkout -- data/{name} data/{PACKAGE.name}"
    if path in (CURVES, LINKS):
        remedy += f", or make it anew with: {MEND}"
    if not path.is_file():
        raise DatasetError(f"data/{name} is missing; mend it with: {remedy}")
    if stated != f"sha256:{_sha256(path)}":
        raise DatasetError(
            f"data/{name} is damaged (or its sha256 in data/{PACKAGE.name}: they do not agree); "
            f"mend it with: {remedy}"
        )


def _sha256(path):
    return provenance.digest(path.read_bytes())


def _design():
    """Which cases there are and why; the hash is of all parameters as they are resolved."""
    cases = [(s.group, name, joint, s.depths) for s in design.DESIGN for name, joint in s.cases()]
    return {
        "groups": {
            group: {"why": why, "cases": sum(case[0] == group for case in cases)}
            for group, why in design.GROUPS.items()
        },
        "resolution": {
            "series": series.RESOLUTION,
            "quadratic": fem.RESOLUTION,
            "finite": FINITE_RESOLUTION,
        },
        "cases_sha256": provenance.digest(repr(cases).encode()),
    }


def sources(path):
    """Source files that decide a generated file."""
    return provenance.sources(paths.ROOT / f"study/{GENERATED[path]}.py")


def _made_by():
    """Generated file -> digest of every file that decides it."""
    read = {COEFFICIENTS: [CURVES, paths.DATA / "published/tables.csv"], LINKS: [COEFFICIENTS]}
    return {
        path.relative_to(paths.ROOT).as_posix(): provenance.digests(
            [*sources(path), *read.get(path, [])]
        )
        for path in GENERATED
    }


def verify_files():
    """Compare every data file with its description.

    Raises
    ------
    DatasetError
        If a file is missing, damaged (its hash differs) or out of date (other code, other data
        or another design made it); the message names the file, what has changed and the command
        that mends it.
    """
    package = _read_package()
    stated = package["provenance"]
    for resource in package["resources"]:
        _verify(resource["path"], resource["hash"])
    if not COEFFICIENTS.is_file() or stated["coefficients_sha256"] != _sha256(COEFFICIENTS):
        raise DatasetError(
            f"study/contact/{COEFFICIENTS.name} is missing or damaged; mend it with: "
            f"git checkout -- study/contact/{COEFFICIENTS.name}, or make it anew with: {MEND}"
        )
    if stated["design"] != _design():
        raise DatasetError(
            f"data/{CURVES.name} is out of date: the design (study/design.py), a default of the "
            f"joint or a resolution has changed since it was made; make it anew with: {MEND}"
        )
    for name, digests in _made_by().items():
        before = stated["made_by"].get(name, {})
        changed = [file for file in digests | before if digests.get(file) != before.get(file)]
        if changed:
            raise DatasetError(
                f"{name} is out of date: {', '.join(changed)} changed since it was made; make it "
                f"anew with: {MEND}"
            )


def summary(frame):
    """One row per case of a frame of `load`: its parameters, ranges and largest error."""
    keys = ["case", "r2_star", "socket_ratio", "poisson_ball", "modulus_ratio"]
    keys += ["ball_drive", "rim", "kinematics", "solver"]
    return (
        frame.groupby(keys, sort=False)
        .agg(
            depths=("depth_star", "size"),
            largest_depth=("depth_star", "max"),
            largest_force=("force_star", "max"),
            largest_half_angle=("contact_half_angle", "max"),
            largest_error=("error_estimate", "max"),
        )
        .reset_index()
    )
