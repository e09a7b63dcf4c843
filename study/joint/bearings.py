"""Catalogue dimensions: a joint from them, and spherical plain bearings by their designation."""

import csv
import re
from collections.abc import Mapping
from functools import lru_cache
from math import acos, degrees
from pathlib import Path
from typing import Any

from study import checks
from study.contact import material
from study.joint.supports import Pin
from study.parameters import Parameter

TABLE = Path(__file__).with_name("bearings.csv")
_NAME = re.compile(r"GE(\d+)(?:E|ES|ES2RS|DO|DO2RS)(C2|CN|C3)?")


@lru_cache(maxsize=1)
def table() -> tuple[dict[str, Any], ...]:
    """Rows of ``bearings.csv``, in m: dimensions, and the ends of the play in each class.

    They are radial spherical plain bearings of ISO 12240-1, dimension series E
    (``data/README.md``). Raises `study.checks.StudyError` if the file is missing or damaged.
    """
    rows: list[dict[str, Any]] = []
    with checks.intact("study/joint/bearings.csv"):
        for row in csv.DictReader(TABLE.read_text(encoding="utf-8").splitlines()):
            name = row.pop("name")
            values = {of: checks.read(of, text + unit(of), unit="m") for of, text in row.items()}
            rows.append({"name": name} | values)
    return tuple(rows)


def unit(column: str) -> str:
    """Unit of a column of ``bearings.csv``."""
    return "um" if column.endswith(("_min", "_max")) else "mm"


def find(text: str, name: str = "bearing") -> dict[str, Any]:
    """Find the row of a designation such as ``GE 20 E`` or ``GE 20 ES C3``.

    Raises ``ValueError`` if it is unknown; ``name`` is the name of the parameter in the message.
    """
    found = _NAME.fullmatch(_plain(text))
    row = next((of for of in table() if found and of["name"] == f"GE {found[1]} E"), None)
    if row is None:
        known = ", ".join(of["name"].removeprefix("GE ").removesuffix(" E") for of in table())
        raise ValueError(
            f"{name} must be GE SIZE E, where SIZE is one of {known}, possibly with a class of the "
            f"play, such as 'GE 20 E C3', got {text!r}; for another bearing, give bore, "
            "outer_diameter, inner_width, outer_width, ball_diameter and play instead"
        )
    return row


def play_ends(text: str) -> tuple[float, float]:
    """Minimum and maximum play in m of a bearing's class: C2, C3, or else normal."""
    row, of_class = find(text), _plain(text)[-2:].lower()
    of_class = of_class if of_class in ("c2", "c3") else "normal"
    return row[f"{of_class}_min"], row[f"{of_class}_max"]


def dimensions(text: str) -> dict[str, float]:
    """Catalogue dimensions of a bearing in m; the play is the mean of its class."""
    row = find(text)
    play = round(sum(play_ends(text)) / 2, 9)  # without the rounding of the sum
    return {of: row.get(of, play) for of in INSTEAD_OF}


def _read_designation(name, text):
    find(text, name)
    return text


def _plain(text):
    """A designation in capitals, without spaces, commas, hyphens and slashes."""
    return re.sub(r"[\s,/-]", "", text.upper())


def _length(meaning):
    return Parameter(meaning, "m", {"above": 0})


FROM_CATALOGUE: dict[str, Parameter] = {
    "bearing": Parameter(
        "Radial spherical plain bearing of ISO 12240-1, dimension series E, for example GE20E or "
        "GE20EC3. study data bearings lists the dimensions. The play is the mean of its class "
        "(normal, C2 or C3), and both rings are of bearing steel. Other values that are given "
        "replace those of the bearing",
        parse=_read_designation,
        kind=str,
    ),
    "ball_diameter": _length(
        "Ball diameter d_k; socket_radius is half of the sum of ball_diameter and play"
    ),
    "play": _length(
        "Play, which is the difference of the diameters of socket and ball, and twice the "
        "clearance; bearing catalogues call it radial clearance"
    ),
    "outer_diameter": _length("Outer diameter D of the socket, instead of wall"),
    "outer_width": _length(
        "Width C of a ring-shaped socket that is open on both sides, instead of opening"
    ),
    "bore": _length(
        "Diameter d of the bore of a ball on a rigid pin, with inner_width, instead of ball_support"
    ),
    "inner_width": _length("Width B of a ball with a bore"),
}
"""Catalogue dimensions, which can be given instead of arguments of `study.joint.joint.Joint`."""
INSTEAD_OF = {
    "bore": "ball_support",
    "outer_diameter": "wall",
    "inner_width": "ball_support",
    "outer_width": "opening",
    "ball_diameter": "socket_radius",
    "play": "clearance",
}
"""Catalogue dimension -> the argument that it replaces."""


def arguments(values: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of `study.joint.joint.Joint` from values that may be catalogue dimensions.

    Raises ``ValueError`` if a dimension and the argument that it replaces are both given, or if a
    value is missing or outside its range.
    """
    made = dict(values)
    if "bearing" in made:
        if "clearance" in made:  # which could be the radial clearance of the catalogue
            raise ValueError(
                "clearance must not be given with bearing; give play, which is twice as large"
            )
        steel, row = material("bearing steel"), dimensions(made.pop("bearing"))
        row = {name: of for name, of in row.items() if INSTEAD_OF[name] not in made}
        made = {"ball": steel, "socket": steel} | row | made
    given = {name: made.pop(name) for name in INSTEAD_OF if name in made}
    for name in given:
        if (other := INSTEAD_OF[name]) in made:
            raise ValueError(f"{name} and {other} must not both be given; remove one of them")
    if "play" in given:
        limit = {"below": given["ball_diameter"]} if "ball_diameter" in given else {}
        made["clearance"] = checks.number("play", given["play"], "m", **limit) / 2
    if "ball_diameter" in given and "clearance" in made:
        made["socket_radius"] = given["ball_diameter"] / 2 + made["clearance"]
    if ("bore" in given) != ("inner_width" in given):
        raise ValueError("bore and inner_width must both be given, or neither of them")
    if "bore" in given:
        made["ball_support"] = Pin(given["bore"] / 2, given["inner_width"])
        if not {"outer_width", "opening"} & {*given, *made}:
            raise ValueError("outer_width (or opening) must be given with bore")
    if missing := [n for n in SIZES if n not in made and SIZES[n] not in given]:
        instead = " and ".join(SIZES[name] for name in missing)
        raise ValueError(
            f"{' and '.join(missing)} must be given for a joint with dimensions, or {instead} of a "
            "catalogue"
        )
    inner = 2 * made["socket_radius"]
    if "outer_diameter" in given:
        outer = given["outer_diameter"]
        if outer <= inner:
            raise checks.RangeError(
                f"outer_diameter must be > {inner:g} m, the inner diameter of the socket (twice "
                f"socket_radius, or ball_diameter plus play), got {outer:g} m"
            )
        made["wall"] = (outer - inner) / 2
    if "outer_width" in given:
        width = checks.number("outer_width", given["outer_width"], "m", below=inner)
        first = degrees(acos(width / inner))  # the rims are half the width from the centre
        made["opening"] = f"{first:.6f}:{180 - first:.6f}"
    return made


SIZES = {"socket_radius": "ball_diameter", "clearance": "play", "wall": "outer_diameter"}
"""What every joint with dimensions needs, and the catalogue dimension instead of it."""
