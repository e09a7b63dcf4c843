"""The cached force-depth curves: what they are, how they are built, checked and loaded.

The design stands here, the numbers in ``data/force_curves.csv`` (one row per case and depth)
and their description in ``data/datapackage.json`` (Frictionless Data Package).
"""

import hashlib
import json
import platform
from dataclasses import dataclass, field
from importlib.metadata import version

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from study import checks, paths
from study.contact.laws import COEFFICIENTS
from study.elastic import fem
from study.joint import KINEMATICS, SOCKET_RATIO, Joint, force_curve

CURVES = paths.DATA / "force_curves.csv"
PACKAGE = paths.DATA / "datapackage.json"
MEND = "study data build"

DEPTHS = np.round(np.arange(1, 41) * 0.025, 3)
PAPER_R2_STARS = tuple(range(20, 301, 20))
WIDER_R2_STARS = (400, 600, 1000, 2000, 5000, 10_000)
PAPER_KINEMATICS = "linear"
"""The kinematics the notebooks take for the paper's finite elements: the only one of ours with
which the relative RMSE of Fig. 14 rises with R2*, as the paper reports."""

SOURCES = tuple(
    paths.ROOT / "study" / name
    for name in ("elastic/__init__.py", "elastic/fem.py", "complementarity.py", "joint.py")
)
"""Modules that decide the numbers."""
PUBLISHED = {
    "published/tables.csv": "published",
    "published/joint.csv": "reference",
    "published/mechanism.csv": "reference",
}


class DatasetError(checks.StudyError):
    """The dataset is missing, damaged or out of date; the message names file and remedy."""


@dataclass(frozen=True)
class SetUp:
    """Joints that share their elastic bodies, and so their two factorisations.

    Attributes
    ----------
    name : str
        Short name; first part of its cases' names.
    why : str
        What the study needs it for.
    joint : dict
        Arguments of `study.joint.Joint` besides ``r2_star`` and ``kinematics``.
    r2_stars, kinematics : tuple
        Its cases are all combinations of these.
    """

    name: str
    why: str
    joint: dict = field(default_factory=dict)
    r2_stars: tuple = (200,)
    kinematics: tuple = (PAPER_KINEMATICS,)

    def cases(self):
        """Yield (case name, Joint) of every case."""
        for kinematics in self.kinematics:
            for r2_star in self.r2_stars:
                name = f"{self.name}-{kinematics}-{r2_star}"
                yield name, Joint(r2_star=r2_star, kinematics=kinematics, **self.joint)


DESIGN = (
    SetUp(
        "paper",
        "the paper's design, R2* = 20..300, and the wider sweep of Figs. 13-15",
        r2_stars=PAPER_R2_STARS + WIDER_R2_STARS,
        kinematics=("linear", "small"),
    ),
    *(
        SetUp(
            f"ratio-{ratio:g}",
            "how much the unstated socket ratio matters",
            {"socket_ratio": ratio},
        )
        for ratio in (1.1, 1.15, 1.25, 1.5, 2.0, 3.0)
    ),
    SetUp("clamped", "how much the unstated drive matters", {"ball_drive": "clamped"}),
    SetUp(
        "clamped-1.315",
        "the other pair of drive and ratio that Table 2's Hertz row allows",
        {"ball_drive": "clamped", "socket_ratio": 1.315},
    ),
    SetUp("mirror", "how much the rim matters", {"rim": "mirror"}),
)

_SCHEMA = [
    ("case", "string", "", "Name of the case: set-up, kinematics and R2*"),
    ("r2_star", "number", "1", "Dimensionless socket radius R2/dR"),
    ("socket_ratio", "number", "1", "Outer over inner radius of the socket"),
    ("poisson_ball", "number", "1", "Poisson's ratio of the ball"),
    ("poisson_socket", "number", "1", "Poisson's ratio of the socket"),
    ("modulus_ratio", "number", "1", "Young's modulus of the socket over that of the ball"),
    ("ball_drive", "string", "", "Ball's equatorial plane: plane (radially free) or clamped"),
    ("rim", "string", "", "Socket's edge at the equator: free or mirror"),
    ("kinematics", "string", "", "Pairing of the surfaces: small or linear (see study.joint)"),
    ("depth_star", "number", "1", "Dimensionless penetration depth d/dR"),
    ("force_star", "number", "1", "Dimensionless force P/(E* dR^2)"),
    ("contact_half_angle", "number", "deg", "Polar angle of the contact's edge"),
    ("peak_pressure_star", "number", "1", "Largest pressure p R2/(E* dR)"),
    ("error_estimate", "number", "1", "Relative discretisation error of the force, estimated"),
]
_CONSTRAINTS = {
    "r2_star": {"minimum": 1},
    "socket_ratio": {"minimum": 1},
    "ball_drive": {"enum": list(fem.DRIVES)},
    "rim": {"enum": list(fem.RIMS)},
    "kinematics": {"enum": list(KINEMATICS)},
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

        - ``case``: name of the case
        - ``r2_star``: dimensionless socket radius R2/dR
        - ``socket_ratio``: outer over inner radius of the socket
        - ``poisson_ball``, ``poisson_socket``: Poisson's ratios
        - ``modulus_ratio``: Young's modulus of the socket over that of the ball
        - ``ball_drive``: ``plane`` or ``clamped``
        - ``rim``: ``free`` or ``mirror``
        - ``kinematics``: ``small`` or ``linear`` (see `study.joint.Joint`)
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
    keep = np.ones(len(frame), dtype=bool)
    for column, wanted in filters.items():
        checks.choice("column", column, tuple(frame.columns))
        held = frame[column].unique()
        values = [wanted] if np.ndim(wanted) == 0 else list(wanted)
        for value in values:
            if value not in held:
                raise ValueError(
                    f"{column} must be one of {', '.join(map(str, held))}, got {value}"
                )
        keep &= frame[column].isin(values)
    if not keep.any():
        asked = ", ".join(f"{column} = {wanted}" for column, wanted in filters.items())
        raise ValueError(f"filters must leave a case, but none has {asked}")
    frame = frame[keep]
    return frame.reset_index(drop=True)


def paper_curves(kinematics=PAPER_KINEMATICS, **filters):
    """Rows of the set-up taken for the paper's, R2* = 20..10,000: see `load` for the columns.

    Parameters
    ----------
    kinematics : {"linear", "small"}
    **filters
        As for `load`.

    Returns
    -------
    pandas.DataFrame
    """
    return load(
        socket_ratio=SOCKET_RATIO,
        ball_drive="plane",
        rim="free",
        kinematics=kinematics,
        **filters,
    )


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
    values = frame.set_index(["where", "row", "quantity"])["value"].sort_index()
    return values if where is None else values.loc[where]


def solve_set_up(set_up):
    """All curves of one set-up, in the columns of the dataset.

    Runs on one thread, so that the numbers do not depend on how many processes run beside it.

    Parameters
    ----------
    set_up : SetUp

    Returns
    -------
    pandas.DataFrame
    """
    frames = []
    with threadpool_limits(limits=1):
        for name, joint in set_up.cases():
            curve = force_curve(joint, DEPTHS)
            frames.append(_frame(name, joint, curve))
    return pd.concat(frames, ignore_index=True)


def _frame(name, joint, curve):
    return pd.DataFrame(
        {
            "case": name,
            "r2_star": joint.r2_star,
            "socket_ratio": joint.socket_ratio,
            "poisson_ball": joint.ball.poisson,
            "poisson_socket": joint.socket.poisson,
            "modulus_ratio": joint.socket.youngs_modulus / joint.ball.youngs_modulus,
            "ball_drive": joint.ball_drive,
            "rim": joint.rim,
            "kinematics": joint.kinematics,
            "depth_star": curve.depth_star,
            "force_star": curve.force_star,
            "contact_half_angle": np.degrees(curve.contact_half_angle),
            "peak_pressure_star": curve.peak_pressure,
            "error_estimate": curve.error_estimate,
        }
    )


def write_curves(frame, path):
    """Write curves as CSV with 9 significant digits, whole or not at all."""
    with paths.whole(path) as temporary:
        frame.to_csv(temporary, index=False, float_format="%.9g", lineterminator="\n")


def write_package(wall_time):
    """Describe the dataset in ``datapackage.json``: schema, units, hashes and provenance.

    Parameters
    ----------
    wall_time : float
        Time that the finite-element cases took together, in s.
    """
    fields = [
        {"name": name, "type": kind, "description": text}
        | ({"unit": unit} if unit else {})
        | {"constraints": {"required": True} | _CONSTRAINTS.get(name, {})}
        for name, kind, unit, text in _SCHEMA
    ]
    schema = {"fields": fields, "primaryKey": ["case", "depth_star"]}
    _refuse_damaged_published_files()
    provenance = {
        "command": MEND,
        "coefficients_sha256": _sha256(COEFFICIENTS),
        "code_sha256": _code_hash(),
        "design": _design(),
        "versions": {p: version(p) for p in ("numpy", "scipy", "scikit-fem")}
        | {"python": platform.python_version()},
        "wall_time_s": round(wall_time, 1),
    }
    description = {
        "name": "spherical-clearance-joint-force-curves",
        "title": "Force-depth curves of spherical clearance joints, by finite elements",
        "description": "Frictionless elastic contact of a ball in a socket; see README.md.",
        "profile": "data-package",
        "licenses": [{"name": "CC-BY-4.0", "title": "Creative Commons Attribution 4.0"}],
        "resources": [
            _resource(CURVES, "force-curves", "generated", schema),
            *(
                _resource(paths.DATA / name, name[:-4].replace("/", "-"), origin, None)
                for name, origin in PUBLISHED.items()
            ),
        ],
        "provenance": provenance,
    }
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
    """Transcribed files keep the hash they have: a build does not bless a damaged one."""
    try:
        package = _read_package()
    except DatasetError:
        return  # there is nothing to compare with
    stated = {r["path"]: r["hash"] for r in package["resources"]}
    for name in set(PUBLISHED) & set(stated):  # a new file has no hash yet
        _verify(name, stated[name])


def _read_package():
    """Content of the description, with the keys that are used here present."""
    name = PACKAGE.relative_to(paths.ROOT)
    try:
        package = json.loads(PACKAGE.read_text(encoding="utf-8"))
        for key in ("code_sha256", "design", "coefficients_sha256"):
            package["provenance"][key]
        for resource in package["resources"]:
            resource["path"], resource["hash"]
    except FileNotFoundError:
        raise DatasetError(f"{name} is missing; make it with: {MEND}") from None
    except (ValueError, KeyError, TypeError):
        raise DatasetError(f"{name} is damaged; make it anew with: {MEND}") from None
    return package


def _verify(name, stated):
    """Compare one data file with the hash stated for it."""
    path = paths.DATA / name
    remedy = MEND if path == CURVES else f"git checkout -- data/{name}"
    if not path.is_file():
        raise DatasetError(f"data/{name} is missing; mend it with: {remedy}")
    if stated != f"sha256:{_sha256(path)}":
        raise DatasetError(
            f"data/{name} is damaged (its sha256 is not the one in data/{PACKAGE.name}); "
            f"mend it with: {remedy}"
        )


def _sha256(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _code_hash():
    text = "".join(path.read_text(encoding="utf-8") for path in SOURCES)
    return hashlib.sha256(text.encode()).hexdigest()


def _design():
    return {
        "depth_star": [float(d) for d in DEPTHS],
        "resolution": fem.RESOLUTION,
        "set_ups": [
            {
                "name": s.name,
                "why": s.why,
                "joint": s.joint,
                "r2_star": list(s.r2_stars),
                "kinematics": list(s.kinematics),
            }
            for s in DESIGN
        ],
    }


def verify_files():
    """Compare every data file with its description.

    Raises
    ------
    DatasetError
        If a file is missing, damaged (its hash differs) or out of date (other code or another
        design made it); the message names the file and the command that mends it.
    """
    package = _read_package()
    provenance = package["provenance"]
    for resource in package["resources"]:
        _verify(resource["path"], resource["hash"])
    if not COEFFICIENTS.is_file() or provenance["coefficients_sha256"] != _sha256(COEFFICIENTS):
        raise DatasetError(
            f"study/contact/{COEFFICIENTS.name} is missing or damaged; make it anew with: {MEND}"
        )
    made_by = provenance["code_sha256"], provenance["design"]
    if made_by != (_code_hash(), _design()):
        raise DatasetError(
            f"data/{CURVES.name} is out of date (the solver or the design has changed since it "
            f"was made); make it anew with: {MEND}"
        )


def summary(frame):
    """One row per case of a frame of `load`: its parameters, ranges and largest error."""
    keys = ["case", "r2_star", "socket_ratio", "ball_drive", "rim", "kinematics"]
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
