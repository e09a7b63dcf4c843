"""Figures and tables of the catalogue, in the paper's order, with their files."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

from study.pages.catalogue import CATALOGUE, Notebook

ROWS = 200  # of a table that a page shows


@dataclass(frozen=True)
class Result:
    """A figure or table and where its files are.

    Attributes
    ----------
    name, caption : str
    notebook : study.pages.catalogue.Notebook
        What makes it.
    image : pathlib.Path or None
        PNG of a figure.
    numbers : pathlib.Path
        CSV.
    """

    name: str
    caption: str
    notebook: Notebook
    image: Path | None
    numbers: Path

    @property
    def files(self):
        """Its files."""
        return [file for file in (self.image, self.numbers) if file]

    @property
    def label(self):
        """Its name for readers: ``Fig. 10``, ``Table 2``, else the name itself."""
        match = re.fullmatch(r"(fig|table)(\d+)", self.name)
        if not match:
            return self.name.replace("_", " ")
        return f"{'Fig.' if match[1] == 'fig' else 'Table'} {int(match[2])}"

    def size(self):
        """Width and height of the image at 100 of its 200 dots per inch."""
        header = self.image.read_bytes()[16:24]
        return [int.from_bytes(header[k : k + 4], "big") // 2 for k in (0, 4)]

    def table(self):
        """Head, first rows as text, number of all rows, and which columns hold numbers."""
        with open(self.numbers, encoding="utf-8", newline="") as file:
            head, *rows = csv.reader(file)
        numeric = [all(map(_is_number, column)) for column in zip(*rows[:ROWS], strict=True)]
        return {"head": head, "rows": rows[:ROWS], "count": len(rows), "numeric": numeric}


def results(folder):
    """Every result of the catalogue: the paper's figures, its tables, then the others.

    Parameters
    ----------
    folder : pathlib.Path
        Where the files are.

    Returns
    -------
    list of Result
    """
    found = [
        Result(
            name,
            caption,
            notebook,
            folder / f"{name}.png" if name in notebook.figures else None,
            folder / f"{name}.csv",
        )
        for notebook in CATALOGUE
        for name, caption in notebook.results.items()
    ]
    order = {name: k for k, name in enumerate(r.name for r in found)}

    def place(result):
        match = re.fullmatch(r"(fig|table)(\d+)", result.name)
        if match:
            return (0 if match[1] == "fig" else 1), int(match[2])
        return 2, order[result.name]

    return sorted(found, key=place)


def _is_number(text):
    try:
        float(text or "nan")
    except ValueError:
        return False
    return True
