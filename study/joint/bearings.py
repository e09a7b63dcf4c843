"""The words of a bearing catalogue: a joint from them, and spherical plain bearings by name."""

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
CLASSES = {"C2": "c2", "C3": "c3"}
"""Class of the play other than normal in a designation, and in the columns of the table."""
WORDS = "bore", "outer_diameter", "inner_width", "outer_width", "ball_diameter"
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
            units = {of: "um" if of.endswith(("_min", "_max")) else "mm" for of in row}
            values = {of: checks.read(of, text + units[of], unit="m") for of, text in row.items()}
            rows.append({"name": name} | values)
    return tuple(rows)


def find(text: str, name: str = "bearing") -> dict[str, Any]:
    """Row of `table` of a designation such as ``GE 20 E`` or ``GE 20 ES C3``, else ``ValueError``.

    ``name`` is that of the parameter, for the message.
    """
    found = _NAME.fullmatch(_plain(text))
    row = next((of for of in table() if found and of["name"] == f"GE {found[1]} E"), None)
    if row is None:
        known = ", ".join(of["name"].removeprefix("GE ").removesuffix(" E") for of in table())
        raise ValueError(
            f"{name} must be GE SIZE E, where SIZE is one of {known}, possibly with a class of the "
            f"play, such as GE 20 E C3, got {text!r}; give the dimensions of another bearing"
        )
    return row


def play_ends(text: str) -> tuple[float, float]:
    """Minimum and maximum play in m of a bearing's class: C2, C3, or else normal."""
    row, of_class = find(text), CLASSES.get(_plain(text)[-2:], "normal")
    return row[f"{of_class}_min"], row[f"{of_class}_max"]


def read_bearing(name: str, text: str) -> dict[str, Any]:
    """Values of a joint from the designation of a bearing.

    The play is the mean of its class. Both rings are of bearing steel.
    """
    row, steel = find(text, name), material("bearing steel")
    sizes = {of: row[of] for of in WORDS}
    play = round(sum(play_ends(text)) / 2, 9)  # without the rounding of the sum
    return sizes | {"play": play, "ball": steel, "socket": steel}


def _plain(text):
    """A designation in capitals, without spaces, hyphens and slashes."""
    return re.sub(r"[\s/-]", "", text.upper())


FROM_CATALOGUE: dict[str, Parameter] = {
    "bearing": Parameter(
        "Radial spherical plain bearing of ISO 12240-1, dimension series E, sizes 4 to 60: GE 20 E "
        "has the dimensions of study data bearings, the mean play of the normal class (GE 20 E C2 "
        "and GE 20 E C3: of these classes), and rings of bearing steel. A value that is given too "
        "replaces that of the bearing",
        parse=read_bearing,
        kind=dict,
    ),
    "ball_diameter": Parameter(
        "Ball diameter d_k, instead of socket_radius, which is half of the sum of ball_diameter "
        "and play",
        "m",
        {"above": 0},
    ),
    "play": Parameter(
        "Total play of the ball in the socket, instead of the clearance, which is half of it; "
        "bearing catalogues call this play radial clearance",
        "m",
        {"above": 0},
    ),
    "outer_diameter": Parameter("Outer diameter D of the socket, instead of wall", "m"),
    "outer_width": Parameter(
        "Width C of a ring-shaped socket that is open on both sides, instead of opening",
        "m",
        {"above": 0},
    ),
    "bore": Parameter(
        "Diameter d of the bore of a ball that a rigid pin holds, with inner_width, instead of "
        "ball_support",
        "m",
        {"above": 0},
    ),
    "inner_width": Parameter("Width B of a ball with a bore", "m", {"above": 0}),
}
"""What catalogues print, and can be given instead of the arguments of `study.joint.joint.Joint`."""
INSTEAD_OF = {
    "ball_diameter": "socket_radius",
    "play": "clearance",
    "outer_diameter": "wall",
    "outer_width": "opening",
    "bore": "ball_support",
    "inner_width": "ball_support",
}
"""Word of a catalogue -> the argument that it replaces."""


def without_words(values: dict[str, Any]) -> dict[str, Any]:
    """Arguments of `study.joint.joint.Joint` from values in which words of a catalogue may be.

    Raises ``ValueError`` if a word and the argument that it replaces are both given, or if a value
    is outside its range.
    """
    if "bearing" in values:
        values = dict(values)
        replaced = [word for word, of in INSTEAD_OF.items() if of in values]
        row = {word: of for word, of in values.pop("bearing").items() if word not in replaced}
        values = row | values
    for word, other in INSTEAD_OF.items():
        if word in values and other in values:
            raise ValueError(f"{word} and {other} must not both be given; remove one of them")
    words = {word: values[word] for word in INSTEAD_OF if word in values}
    made = {name: of for name, of in values.items() if name not in words}
    if "play" in words:
        made["clearance"] = words["play"] / 2
    if "ball_diameter" in words and "clearance" in made:
        made["socket_radius"] = words["ball_diameter"] / 2 + made["clearance"]
    radius = made.get("socket_radius")
    if radius is not None and "outer_diameter" in words:
        outer = checks.number("outer_diameter", words["outer_diameter"], "m", above=2 * radius)
        made["wall"] = outer / 2 - radius
    if radius is not None and "outer_width" in words:
        width = checks.number("outer_width", words["outer_width"], "m", below=2 * radius)
        first = degrees(acos(width / 2 / radius))  # the rims are half the width from the centre
        made["opening"] = f"{first:.6f}:{180 - first:.6f}"
    if ("bore" in words) != ("inner_width" in words):
        raise ValueError("bore and inner_width must both be given, or neither of them")
    if "bore" in words:
        made["ball_support"] = Pin(words["bore"] / 2, words["inner_width"])
    return made


def in_words(values: Mapping[str, str]) -> str:
    """Dimensions and play of a bearing, or the given texts that replace them, as a sentence."""
    text, shown = values["bearing"], []
    for word, size in read_bearing("bearing", text).items():
        if word in values:
            shown.append(f"{word} {values[word]} (given)")
        elif word in INSTEAD_OF and INSTEAD_OF[word] not in values:
            is_play = word == "play"
            number = f"{size * 1e6:g} um (mean of its class)" if is_play else f"{size * 1e3:g} mm"
            shown.append(f"{word} {number}")
    return f"Bearing {text}: {', '.join(shown)}."
