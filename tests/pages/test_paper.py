"""Paper and supplement: every number read, nothing missing, the same bytes."""

import json
import pkgutil
import re
import shutil

import numpy as np
import pandas as pd
import pytest
import typeset
import typst

from study import paths
from study.checks import StudyError
from study.contact import StiffenedHertz
from study.joint import Joint, reference_joint

SOURCE = paths.PAPER / "paper.typ"
TEXT = SOURCE.read_text(encoding="utf-8")
SUPPLEMENT = paths.PAPER / "supplement.typ"
BOTH = TEXT + SUPPLEMENT.read_text(encoding="utf-8")


@pytest.mark.parametrize("source", [SOURCE, SUPPLEMENT], ids=lambda path: path.stem)
def test_it_is_typeset_twice_to_the_same_bytes(tmp_path, source):
    first, second = tmp_path / "first.pdf", tmp_path / "second.pdf"
    typeset.typeset(source, first)
    typeset.typeset(source, second)
    assert first.read_bytes() == second.read_bytes()
    assert first.read_bytes().startswith(b"%PDF")
    assert str(paths.ROOT).encode() not in first.read_bytes()


def test_no_result_is_typed():
    """Typed are set-ups, such as a depth of 0.5, bounds of questions, levels, errors in a test."""
    text = re.sub(r'"[^"]*"|`[^`]*`|//.*|(?:doi|preprints.org|width:) \S+', "", BOTH)
    typed = set(re.findall(r"(?<![\w.])(\d+(?:\.\d+)?) %", text))
    assert typed == {"0.1", "1", "5", "10", "50", "70", "95"} | {
        "0.15",
        "0.2",
        "0.22",
    }  # of test_tilted.py
    typed = set(re.findall(r"(?<![\w.])\d+\.\d{3,}", text))
    assert typed == {"0.025", "0.005", "0.001"}


def test_the_worked_example_is_that_of_the_law():
    """The article evaluates its printed coefficients; their rounding changes the last digits."""
    (worked,) = json.loads(typst.query(SOURCE, "<worked>", field="value", **typeset.options()))
    law = StiffenedHertz.of(reference_joint(200))
    for name, derivative in (("force", False), ("slope", True)):
        assert worked[name] == pytest.approx(law(0.25, derivative=derivative), rel=1e-5)


def test_the_worked_example_of_the_closed_form_is_that_of_the_elastic_solution():
    (worked,) = json.loads(
        typst.query(SOURCE, "<closed-worked>", field="value", **typeset.options())
    )
    elastic = Joint.from_ratios(200, 1.5).solve(depth_star=0.25).force_star[0]
    assert worked["force"] == pytest.approx(elastic, rel=0.034)
    assert worked["force"] == pytest.approx(53.28, abs=0.005)  # by hand


def test_the_printed_power_law_has_the_stated_error():
    ranges = pd.read_csv(paths.FIGURES / "power_ranges.csv").set_index(["from", "to"])
    fitted = ranges.loc[(0.05, 0.5)]
    printed = [
        round(fitted[name], int(re.search(rf'"{name}"\), digits: (\d)', TEXT)[1]))
        for name in ("k_star", "n")
    ]
    depth = np.geomspace(0.05, 0.5, 200)
    elastic = reference_joint(200).table()(depth)
    error = 100 * np.abs(printed[0] * depth ** printed[1] / elastic - 1).max()
    assert error < np.ceil(100 * fitted.error_percent) / 100  # in the article: rounded upwards


def test_bounds_are_rounded_outwards():
    numbers = "rounded-up(4.517), rounded-up(9.96), rounded-up(0.18), rounded-up(0.0734, count: 1)"
    text = f'#import "/paper/numbers.typ": *\n#metadata(({numbers}, rounded-down(0.671))) <bounds>'
    (bounds,) = json.loads(
        typst.query(text.encode(), "<bounds>", field="value", **typeset.options())
    )
    assert bounds == ["4.6", "10", "0.18", "0.08", "0.67"]


def test_sources_have_title_and_authors_and_are_cited():
    entries = (paths.PAPER / "references.yml").read_text(encoding="utf-8")
    for entry in re.split(r"\n(?=\w)", entries.strip()):
        assert re.search(r"^  title: \S", entry, re.MULTILINE), entry
        assert re.search(r"^  author: \[", entry, re.MULTILINE), entry
        assert f"@{entry.partition(':')[0]}" in BOTH
    assert not re.search(r"_[A-Z]\w+_ \d{4}|doi 10", BOTH)  # cited in the text alone


def test_the_article_names_sections_that_the_supplement_has():
    named = set(re.findall(r'#S\("(\w+)"\)', TEXT))
    parts = re.findall(r'#part\("(\w+)"\)', SUPPLEMENT.read_text(encoding="utf-8"))
    look = (paths.PAPER / "look.typ").read_text(encoding="utf-8")
    assert named
    assert named <= set(parts)
    assert parts == re.findall(r'^  (\w+): "', look, re.MULTILINE)  # in the order of their numbers


@pytest.fixture
def copy(tmp_path, monkeypatch):
    """A copy of the article, which a test may change."""
    for name in ("figures", "data", "study"):
        (tmp_path / name).symlink_to(paths.ROOT / name)
    shutil.copy(paths.ROOT / "pyproject.toml", tmp_path)
    shutil.copytree(paths.PAPER, tmp_path / "paper")
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(paths, "FIGURES", tmp_path / "figures")
    return tmp_path


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"example_proves_the_law"', '"no_such_claim"'),
        ("@trend", "@no-such-label"),
        ("= Introduction <introduction>", "= Introduction #foo("),
    ],
)
def test_what_is_missing_stops_the_paper(copy, old, new):
    assert old in TEXT
    (copy / "paper/paper.typ").write_text(TEXT.replace(old, new), encoding="utf-8")
    with pytest.raises(StudyError, match=r"(paper|look|results|numbers)\.typ:\d+:"):
        typeset.typeset(copy / "paper/paper.typ", copy / "paper.pdf")
    assert not (copy / "paper.pdf").exists()


@pytest.mark.parametrize("source", [SOURCE, SUPPLEMENT], ids=lambda path: path.stem)
def test_authors_and_version_are_those_of_the_project(copy, source):
    def made(**changed):
        """The document if something else is in the project's file."""
        text = (paths.PAPER.parent / "pyproject.toml").read_text(encoding="utf-8")
        for name, value in changed.items():
            text, replaced = re.subn(f"(?m)^{name} = .+$", f"{name} = {value}", text)
            assert replaced == 1
        (copy / "pyproject.toml").write_text(text, encoding="utf-8")
        typeset.typeset(copy / "paper" / source.name, copy / "made.pdf")
        return (copy / "made.pdf").read_bytes()

    stored = made()
    assert made(version='"9.8.7"') != stored
    assert b"Ada Example" in made(authors='[{ name = "Ada Example" }]')
    assert b"Ada Example" not in stored


def test_the_index_of_equations_names_code_that_exists():
    named = re.findall(r"`(study\.[\w.]+)`", SUPPLEMENT.read_text(encoding="utf-8"))
    assert "study.contact.Hertz" in named
    for name in named:
        assert pkgutil.resolve_name(name)
