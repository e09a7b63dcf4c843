"""The paper: every number read, nothing missing, the same bytes."""

import re
import shutil

import pytest
import typst

from study import paths
from study.checks import StudyError
from study.pages import typeset

TEXT = typeset.SOURCE.read_text(encoding="utf-8")


def test_the_paper_is_typeset_twice_to_the_same_bytes(tmp_path):
    first, second = tmp_path / "first.pdf", tmp_path / "second.pdf"
    typeset.typeset(output=first)
    typeset.typeset(output=second)
    assert first.read_bytes() == second.read_bytes()
    assert first.read_bytes().startswith(b"%PDF")
    assert str(paths.ROOT).encode() not in first.read_bytes()
    pages = typst.compile(typeset.SOURCE, root=paths.ROOT, ignore_system_fonts=True, format="svg")
    assert 8 <= len(pages) <= 10


def copy(tmp_path, monkeypatch, old, new):
    """The paper's folder beside the results, with one thing changed in its text."""
    root = tmp_path / "project"
    root.mkdir()
    for name in ("figures", "data", "study"):
        (root / name).symlink_to(paths.ROOT / name)
    (root / "paper").mkdir()
    assert old in TEXT
    for path in paths.PAPER.glob("*.*"):
        text = path.read_text(encoding="utf-8")
        text = text.replace(old, new) if path == typeset.SOURCE else text
        (root / "paper" / path.name).write_text(text, encoding="utf-8")
    monkeypatch.setattr(paths, "ROOT", root)
    return root / "paper/paper.typ"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"example_proves_the_law"', '"no_such_claim"'),
        ('picture("trend"', 'picture("no-such-figure"'),
        ('at("determination", "correct")', 'at("determination", "corect")'),
        ('published("Fig. 14"', 'published("Fig. 99"'),
        ("@trend", "@no-such-label"),
        ("= Question", "= Question #foo("),
    ],
)
def test_what_is_missing_stops_the_paper(tmp_path, monkeypatch, old, new):
    source = copy(tmp_path, monkeypatch, old, new)
    with pytest.raises(StudyError, match=r"^paper/(paper|results|numbers)\.typ, line \d+: "):
        typeset.typeset(source, tmp_path / "paper.pdf")
    assert not (tmp_path / "paper.pdf").exists()


def test_a_missing_number_stops_the_paper(tmp_path, monkeypatch):
    source, pdf = copy(tmp_path, monkeypatch, "", ""), tmp_path / "paper.pdf"
    typeset.typeset(source, pdf)
    whole = pdf.read_bytes()
    figures = source.parents[1] / "figures"
    figures.unlink()  # a link
    shutil.copytree(paths.FIGURES, figures)
    table = figures / "table2.csv"
    lines = table.read_text(encoding="utf-8").splitlines(keepends=True)
    table.write_text("".join(line for line in lines if not line.startswith("hertz,RMSE")))
    with pytest.raises(StudyError, match=r"^paper/.*figures/table2.csv has no row with "):
        typeset.typeset(source, pdf)
    assert pdf.read_bytes() == whole


def test_the_references_asked_of_such_a_paper_are_cited():
    entries = (paths.PAPER / "references.yml").read_text(encoding="utf-8")
    keys = re.findall(r"^(\w+):$", entries, re.MULTILINE)
    assert len(keys) >= 16
    for key in keys:
        assert f"@{key}" in TEXT, key
    without = {"yao2024", "steuermann1939", "pytask", "papermill"}  # have none that is known
    without |= {"ciavarella2007", "mak2002", "jin1999", "rockerarm"}  # in what could be read
    for key, entry in zip(keys, re.split(r"^\w+:\n", entries, flags=re.MULTILINE)[1:], strict=True):
        assert ("doi:" in entry) != (key in without), key
