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
from study.elastic import fem, series
from study.joint import FINITE_RESOLUTION, KINEMATICS, SOLVERS, Joint, Material, force_curve

CURVES = paths.DATA / "force_curves.csv"
PACKAGE = paths.DATA / "datapackage.json"
MEND = "study data build"

DEPTHS = tuple(np.round(np.arange(1, 41) * 0.025, 3).tolist())
ROOT_DEPTHS = tuple(np.round(np.linspace(0.005**0.5, 1, 32) ** 2, 6).tolist())
"""In equal steps of sqrt(depth_star), from 0.005 to 1."""
PAPER_R2_STARS = tuple(range(20, 301, 20))
WIDER_R2_STARS = (400, 600, 1000, 2000, 5000, 10_000)
PAPER_KINEMATICS = "linear"
"""The kinematics the notebooks take for the paper's finite elements: the only one of ours with
which the relative RMSE of Fig. 14 rises with R2*, as the paper reports (notebook 13)."""

SOURCES = tuple(
    paths.ROOT / "study" / name
    for name in (
        "elastic/__init__.py",
        "elastic/series.py",
        "elastic/fem.py",
        "complementarity.py",
        "kinematics.py",
        "joint.py",
    )
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
    """Joints that share their elastic bodies.

    Attributes
    ----------
    group : str
        What the study needs it for, a key of `GROUPS`.
    name : str
        Short name; first part of its cases' names.
    joint : dict
        Arguments of `study.joint.Joint` besides ``r2_star``, ``kinematics`` and materials.
    poisson : float
        Poisson's ratio of both bodies.
    modulus_ratio : float
        Young's modulus of the socket over that of the ball.
    r2_stars, kinematics : tuple
        Its cases are all combinations of these.
    depths : tuple
        Values of ``depth_star``.
    """

    group: str
    name: str
    joint: dict = field(default_factory=dict)
    poisson: float = 0.3
    modulus_ratio: float = 1.0
    r2_stars: tuple = (200,)
    kinematics: tuple = (PAPER_KINEMATICS,)
    depths: tuple = DEPTHS

    def cases(self):
        """Yield (case name, Joint) of every case."""
        ball = Material(2e11, self.poisson)
        socket = Material(2e11 * self.modulus_ratio, self.poisson)
        for kinematics in self.kinematics:
            for r2_star in self.r2_stars:
                name = f"{self.name}-{kinematics}-{r2_star:g}"
                materials = {"ball": ball, "socket": socket}
                yield name, Joint(r2_star, kinematics=kinematics, **materials, **self.joint)


GROUPS = {
    "paper": "the paper's design, R2* = 20..300, and the wider sweep of Figs. 13-15",
    "clamped": "the same with a clamped ball and the ratio that its Table 2 then asks for",
    "ratio": "how much the socket ratio matters",
    "poisson": "how much Poisson's ratio matters",
    "modulus": "how much unequal moduli matter",
    "support": "how much drive and rim matter",
    "fit": "what the coefficients of stiffened_hertz are fitted to",
    "judge": "what stiffened_hertz is judged by: drawn at random in its range",
}
CLAMPED_RATIO = 1.3
"""Socket ratio that explains Table 2 with a clamped ball (notebook 13)."""


def _sweep(group, values, set_up):
    return tuple(SetUp(group, f"{group}-{value:g}", **set_up(value)) for value in values)


def _judges():
    """Joints at random places of the range of stiffened_hertz, always the same.

    Every eighth has finite kinematics, every third is thin, nearly incompressible and of small
    R2*, where a law is hardest to find.
    """
    draw = np.random.default_rng(2024)
    for k in range(72):
        hard, finite = k % 3 == 0, k % 8 == 0
        width = 0.5 if hard else 1.0
        thickness = 0.1 * 20 ** (draw.random() * (0.25 if hard else 1))
        yield SetUp(
            "judge",
            f"judge-{k:02d}",
            {"socket_ratio": round(float(1 + thickness), 3)},
            poisson=round(float(0.45 - 0.25 * width * draw.random()), 3),
            r2_stars=(float(f"{20 * 500 ** (draw.random() * (0.3 if hard else 1)):.3g}"),),
            kinematics=("finite" if finite else "linear",),
            depths=ROOT_DEPTHS[2::4] if finite else ROOT_DEPTHS,
        )


DESIGN = (
    SetUp(
        "paper",
        "paper",
        r2_stars=PAPER_R2_STARS + WIDER_R2_STARS,
        kinematics=("linear", "small"),
    ),
    SetUp(
        "paper",
        "paper",
        r2_stars=(20, 60, 200, 600, 2000, 10_000),
        kinematics=("finite",),
        depths=DEPTHS[:20],
    ),
    SetUp(
        "clamped",
        f"clamped-{CLAMPED_RATIO:g}",
        {"ball_drive": "clamped", "socket_ratio": CLAMPED_RATIO},
        r2_stars=PAPER_R2_STARS + WIDER_R2_STARS,
        kinematics=("linear", "small"),
    ),
    *_sweep(
        "ratio",
        (1.05, 1.1, 1.15, 1.25, 1.3, 1.4, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 5.0),
        lambda ratio: {"joint": {"socket_ratio": ratio}},
    ),
    *_sweep(
        "poisson",
        (0.0, 0.1, 0.2, 0.25, 0.35, 0.4, 0.45, 0.48),
        lambda nu: {"poisson": nu},
    ),
    *_sweep(
        "modulus",
        (0.05, 0.1, 0.2, 0.5, 2.0, 5.0, 10.0, 20.0),
        lambda ratio: {"modulus_ratio": ratio},
    ),
    SetUp("support", "clamped", {"ball_drive": "clamped"}),
    SetUp("support", "clamped-1.315", {"ball_drive": "clamped", "socket_ratio": 1.315}),
    SetUp("support", "free-rim", {"rim": "free"}),
    *(
        SetUp(
            "fit",
            f"fit-{ratio:g}-{nu:g}",
            {"socket_ratio": ratio},
            poisson=nu,
            r2_stars=(20, 40, 120, 10_000),
            depths=ROOT_DEPTHS,
        )
        for ratio in (1.1, 1.13, 1.19, 1.27, 1.38, 1.5, 1.7, 2.0, 2.5, 3.0)
        for nu in (0.2, 0.25, 0.3, 0.35, 0.4, 0.43, 0.45)
    ),
    *(
        SetUp(
            "fit",
            f"fit-{ratio:g}-{nu:g}",
            {"socket_ratio": ratio},
            poisson=nu,
            r2_stars=(20,),
            kinematics=("finite",),
            depths=ROOT_DEPTHS[3::4],
        )
        for ratio in (1.1, 1.19, 1.5, 3.0)
        for nu in (0.2, 0.3, 0.4, 0.45)
    ),
    *_judges(),
)

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
    "group": {"enum": list(GROUPS)},
    "r2_star": {"minimum": 1},
    "socket_ratio": {"minimum": 1},
    "ball_drive": {"enum": list(fem.DRIVES)},
    "rim": {"enum": list(fem.RIMS)},
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

        - ``group``: what the study needs the case for, a key of `GROUPS`
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
    keep = np.ones(len(frame), dtype=bool)
    for column, wanted in filters.items():
        checks.choice("column", column, tuple(frame.columns))
        held = frame[column].unique()
        values = [wanted] if np.ndim(wanted) == 0 else list(wanted)
        for value in values:
            if value not in held:
                known = [f"{v:g}" if isinstance(v, float) else str(v) for v in held]
                known = ", ".join(known[:30] + ["..."] * (len(known) > 30))
                raise ValueError(f"{column} must be one of {known}, got {value}")
        keep &= frame[column].isin(values)
    if not keep.any():
        asked = ", ".join(f"{column} = {wanted}" for column, wanted in filters.items())
        raise ValueError(f"filters must leave a case, but none has {asked}")
    frame = frame[keep]
    return frame.reset_index(drop=True)


def paper_curves(kinematics=PAPER_KINEMATICS, group="paper", **filters):
    """Rows of the set-up taken for the paper's, R2* = 20..10,000: see `load` for the columns.

    Parameters
    ----------
    kinematics : {"linear", "small", "finite"}
    group : {"paper", "clamped"}
        The radially free ball with socket ratio 1.19, or the clamped one with 1.3.
    **filters
        As for `load`.

    Returns
    -------
    pandas.DataFrame
    """
    checks.choice("group", group, ("paper", "clamped"))
    return load(group=group, kinematics=kinematics, **filters)


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


def reference_forces():
    """Forces of independent origin, from ``data/published/joint.csv``.

    Returns
    -------
    pandas.DataFrame
        Source, joint, depth, force, and ``trust``: the relative accuracy to expect.
    """
    verify_files()
    return pd.read_csv(paths.DATA / "published/joint.csv")


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
            curve = force_curve(joint, set_up.depths)
            frames.append(_frame(set_up.group, name, joint, curve))
    return pd.concat(frames, ignore_index=True)


def _frame(group, name, joint, curve):
    return pd.DataFrame(
        {
            "group": group,
            "case": name,
            "r2_star": joint.r2_star,
            "socket_ratio": joint.socket_ratio,
            "poisson_ball": joint.ball.poisson,
            "poisson_socket": joint.socket.poisson,
            "modulus_ratio": joint.socket.youngs_modulus / joint.ball.youngs_modulus,
            "ball_drive": joint.ball_drive,
            "rim": joint.rim,
            "kinematics": joint.kinematics,
            "solver": curve.solver,
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
        Time that the cases took together, in s.
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
        "title": "Force-depth curves of spherical clearance joints, by series and finite elements",
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
    members = {group: [s for s in DESIGN if s.group == group] for group in GROUPS}
    return {
        "groups": {
            group: {"why": why, "cases": sum(1 for s in members[group] for _ in s.cases())}
            for group, why in GROUPS.items()
        },
        "resolution": {
            "series": series.RESOLUTION,
            "quadratic": fem.RESOLUTION,
            "finite": FINITE_RESOLUTION,
        },
        "set_ups_sha256": hashlib.sha256(repr(DESIGN).encode()).hexdigest(),
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
