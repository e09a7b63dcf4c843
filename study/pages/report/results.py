"""Figures and tables of the catalogue, in the paper's order, with their files."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

from study.pages.catalogue import CATALOGUE, Notebook


@dataclass(frozen=True)
class Result:
    """A figure, which has an image, or a table; both have their numbers as CSV."""

    name: str
    caption: str
    notebook: Notebook
    numbers: Path
    image: Path | None

    @property
    def files(self) -> list[Path]:
        """Its files."""
        return [file for file in (self.image, self.numbers) if file]

    @property
    def place(self) -> tuple[int, int]:
        """Where it comes: the paper's figures, the paper's tables, the others."""
        match = re.fullmatch(r"(fig|table)(\d+)", self.name)
        return (["fig", "table"].index(match[1]), int(match[2])) if match else (2, 0)

    @property
    def label(self) -> str:
        """Its name for readers: ``Fig. 10``, ``Table 2``, else the name itself."""
        kind, number = self.place
        return f"{('Fig.', 'Table')[kind]} {number}" if kind < 2 else self.name.replace("_", " ")

    def size(self) -> list[int]:
        """Width and height of the image at 100 of its 200 dots per inch."""
        header = self.image.read_bytes()[16:24]
        return [int.from_bytes(header[k : k + 4], "big") // 2 for k in (0, 4)]

    def rows(self) -> list[list[str]]:
        """Lines of the CSV, head first."""
        with open(self.numbers, encoding="utf-8", newline="") as file:
            return list(csv.reader(file))


def results(folder: Path) -> list[Result]:
    """Every result of the catalogue, with its files in ``folder``."""
    found = []
    for notebook in CATALOGUE:
        for name, caption in notebook.results.items():
            image = folder / f"{name}.png" if name in notebook.figures else None
            found.append(Result(name, caption, notebook, folder / f"{name}.csv", image))
    return sorted(found, key=lambda result: result.place)
