"""Tables of a user: CSV files, separated by commas, semicolons or tabs."""

import csv
import re
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

_DECIMAL_COMMA = re.compile(r"([+-]?\d*),(\d+(?:[eE][+-]?\d+)?)(\s*[^\d,]*)")


class UserTable(NamedTuple):
    """Names of the columns and cells of the rows, without blanks around them."""

    names: list[str]
    rows: list[list[str]]


def read_table(path: Path, name: str = "FILE", pairs: Collection[str] = ()) -> UserTable:
    """Cells of a CSV file by row; rows without any text are left out.

    The separator is the sign among comma, semicolon and tab that the first line has most often. If
    it is not the comma, a number such as ``0,25`` has a decimal comma, which becomes a point,
    except in columns of ``pairs``, such as ``4,8``.

    Raises ``ValueError`` if the file is not CSV text in UTF-8, if two columns have the same name,
    or if the rows have different lengths.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
        lines = [line for line in text.splitlines(keepends=True) if line.strip(" ,;\t\r\n")]
        separator = max(",;\t", key="".join(lines[:1]).count)
        rows = [*csv.reader(lines, delimiter=separator, strict=True)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        why = getattr(error, "strerror", None) or "it is not CSV text in UTF-8"
        raise ValueError(f"{name} must be a CSV file, got {path}: {why}") from None
    names, *rows = [[cell.strip() for cell in row] for row in rows] or [[]]
    if len(set(names)) < len(names):
        raise ValueError(f"each column must have a different name, got {', '.join(names)}")
    for number, row in enumerate(rows, 1):
        if len(row) != len(names):
            raise ValueError(
                f"row {number} must have {len(names)} cells, as many as there are column names, "
                f"got {len(row)}"
            )
    if separator != ",":
        rows = [
            [
                cell if of in pairs else _with_point(cell)
                for of, cell in zip(names, row, strict=True)
            ]
            for row in rows
        ]
    return UserTable(names, rows)


def _with_point(cell):
    found = _DECIMAL_COMMA.fullmatch(cell)
    return f"{found[1]}.{found[2]}{found[3]}" if found else cell
