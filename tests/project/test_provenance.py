"""What decides a result: code by imports, and the data that this reads."""

import json
import subprocess
import sys

import pytest
from helpers.copied import copy_project, environment

from study import paths, provenance
from study.pages import catalogue


def reached(name):
    library = paths.ROOT / "study"
    return {p.relative_to(library).as_posix() for p in provenance.sources(library / name)}


def test_imports_are_followed_to_the_modules_that_define_the_names():
    # joint asks the package contact for two names of bodies.py, not for the laws
    found = reached("joint/curve.py")
    assert {"joint/curve.py", "joint/series.py", "contact/bodies.py"} <= found
    assert "contact/laws.py" not in found
    assert "contact/laws.py" in reached("dataset/fitting.py")
    assert reached("dataset/tolerance.py") == {"dataset/tolerance.py"}


def test_imports_inside_functions_count(tmp_path):
    path = tmp_path / "late.py"
    path.write_text("def f():\n    import study.measure.stability\n")
    assert paths.ROOT / "study/measure/stability.py" in provenance.sources(path)


@pytest.mark.parametrize(
    ("changed", "outdated"),
    [
        ("study/measure/stability.py", ["17"]),
        ("study/claims/verdicts.py", ["21", "30"]),
        ("study/claims/identification.py", ["04", "13", "32"]),
        (
            "study/mechanism/beams.py",
            ["08", "09", "10", "11", "16", "17", "18", "26", "28", "30", "33"],
        ),
        ("study/pages/figures.py", [notebook.name[:2] for notebook in catalogue.CATALOGUE]),
        ("study/cli/build.py", []),
        ("data/published/claims.csv", ["21", "30"]),
    ],
)
def test_a_change_makes_outdated_what_reaches_it_and_nothing_else(changed, outdated):
    path = paths.ROOT / changed
    assert path.is_file()
    assert [nb.name[:2] for nb in catalogue.CATALOGUE if path in nb.inputs()] == outdated


def test_data_that_a_module_names_decide_what_it_makes():
    def read(module):
        inputs = provenance.inputs(paths.ROOT / "study" / module)
        return {provenance.name(path) for path in inputs if path.suffix != ".py"}

    laws = {"study/contact/coefficients.json", "study/contact/stiffening.csv"}
    materials = {"study/contact/materials.csv"}
    described = json.loads((paths.DATA / "datapackage.json").read_text())["resources"]
    stored = {f"data/{resource['path']}" for resource in described}
    stored.remove("data/published/mechanism.csv")  # which only tests read
    assert read("contact/laws.py") == laws
    assert read("contact/materials.py") == materials
    assert laws | stored <= read("dataset/store.py")
    assert "data/published/claims.csv" in read("claims/verdicts.py")
    assert read("mechanism/beams.py") <= laws | materials


def test_one_digest_changes_with_content_name_and_what_else_is_told(tmp_path):
    files = [tmp_path / name for name in ("one.py", "two.py", "three.py")]
    for path, text in zip(files, "aab", strict=True):
        path.write_text(text)
    one, two, three = files
    of = [[one], [two], [three], [one, two], []]
    told = {provenance.digest(some) for some in of} | {provenance.digest([one], "1.0")}
    assert len(told) == 6
    before = provenance.digest([two, one, one])
    assert before == provenance.digest(iter([one, two]))
    two.write_text("other")
    assert provenance.digest(files[:2]) != before
    two.unlink()
    assert provenance.digest(files[:2]) != before


@pytest.mark.parametrize(
    ("after", "decides"),
    [
        ('"""Other words."""\n\n\ndef f():\n    return """a\n\n# b"""\n', False),
        ('# why\ndef f():  # this\n\n    """Say."""\n    return """a\n\n# b"""\n', False),
        ('"""Words."""\ndef f():\n    return """a\n# b"""\n', True),
        ('"""Words."""\ndef f():\n    return """a\n\n# c"""\n', True),
        ('"""Words."""\ndef f():\n    return (\n"a"\n)\n', True),
    ],
)
def test_comments_and_docstrings_decide_nothing_but_texts_that_are_shown(tmp_path, after, decides):
    path = tmp_path / "module.py"
    path.write_text('"""Words."""\ndef f():\n    return """a\n\n# b"""\n')
    before, before_in_words = provenance.digest([path]), provenance.digest([path], words=True)
    path.write_text(after)
    assert (provenance.digest([path]) != before) == decides
    assert provenance.digest([path], words=True) != before_in_words


CHANGING = """
from pathlib import Path
from study import provenance
folder = provenance.paths.ROOT / "study/contact"
Path(folder / "first.py").write_text("import study.contact.{}\\n")
print(*sorted(path.name for path in provenance.sources(folder / "first.py")))
"""


def test_imports_that_were_kept_are_read_again_when_their_source_changed(tmp_path):
    root = copy_project(tmp_path / "project")
    for module in ("friction", "damping"):
        command = [sys.executable, "-c", CHANGING.format(module)]
        options = {"cwd": root, "env": environment(root), "capture_output": True, "text": True}
        assert f"{module}.py" in subprocess.run(command, **options).stdout.split()
    assert (root / "study/contact/first.py").is_file()
