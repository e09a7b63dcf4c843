"""What decides a result: code by imports, and the data that this reads."""

import json

import pytest

from study import paths, provenance
from study.pages import catalogue


def reached(name):
    library = paths.ROOT / "study"
    return {p.relative_to(library).as_posix() for p in provenance.sources(library / name)}


def test_imports_are_followed_to_the_modules_that_define_the_names():
    # joint asks the package contact for two names of bodies.py, not for the laws
    assert reached("joint/curve.py") == {
        *("checks.py", "contact/bodies.py", "contact/materials.py", "joint/complementarity.py"),
        *("joint/compliance.py", "joint/curve.py", "joint/fem.py", "joint/definition.py"),
        *("joint/contact_kinematics.py", "joint/series.py", "joint/supports.py", "threads.py"),
        *("joint/large_displacement.py", "joint/nested_contact.py"),
        "parameters.py",
    }
    assert "contact/laws.py" in reached("dataset/fitting.py")
    assert reached("dataset/tolerance.py") == {"dataset/tolerance.py"}


def test_a_name_is_not_a_module_that_differs_in_case(monkeypatch):
    def is_file(path):
        return path.parent.is_dir() and path.name.lower() in {p.name for p in path.parent.iterdir()}

    monkeypatch.setattr(type(paths.ROOT), "is_file", is_file)
    provenance._imported.cache_clear()
    found = reached("dataset/design.py")
    provenance._imported.cache_clear()
    assert "joint/definition.py" in found
    assert "joint/Joint.py" not in found


def test_imports_inside_functions_count(tmp_path):
    path = tmp_path / "late.py"
    path.write_text("def f():\n    import study.measure.stability\n")
    assert paths.ROOT / "study/measure/stability.py" in provenance.sources(path)


@pytest.mark.parametrize(
    ("changed", "outdated"),
    [
        ("study/measure/stability.py", ["17"]),
        ("study/measure/timing.py", ["16", "26"]),
        ("study/claims/verdicts.py", ["21", "30"]),
        ("study/claims/identification.py", ["04", "13"]),
        ("study/claims/table_alone.py", ["04", "13"]),
        (
            "study/mechanism/beams.py",
            ["08", "09", "10", "11", "16", "17", "18", "26", "28", "30"],
        ),
        (
            "study/mechanism/scene.py",
            ["07", "08", "09", "10", "11", "16", "17", "18", "26", "28", "30"],
        ),
        ("study/pages/figures.py", [f"{n:02d}" for n in range(31)]),
        ("study/cli/build.py", []),
        ("study/pages/report/pages.py", []),
        ("data/published/claims.csv", ["21", "30"]),
        (
            "study/contact/coefficients.json",
            [f"{n:02d}" for n in range(31) if n not in (7, 19, 25)],
        ),
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
    costs = {"study/contact/relative_costs.json"}
    assert read("dataset/store.py") - materials == laws | stored | costs
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


def test_a_source_is_parsed_once_and_again_when_it_changed(tmp_path, monkeypatch):
    parsed = []
    monkeypatch.setattr(paths, "ROOT", tmp_path)
    monkeypatch.setattr(provenance, "_GRAPH", tmp_path / "build/imports.json")
    monkeypatch.setattr(provenance.ast, "parse", lambda *a: parsed.append(a) or PARSE(*a))
    folder = tmp_path / "study/room"
    folder.mkdir(parents=True)
    (folder / "__init__.py").write_text("from study.room.first import one\n")
    (folder / "first.py").write_text("import study.room.second\n")
    (folder / "second.py").write_text("one = 1\n")

    def reached():
        parsed.clear()
        for kept in (provenance._graph, provenance._listed):
            kept.cache_clear()  # as in another process
        for kept in (provenance._imported, provenance._content_sha256):
            kept.cache_clear()
        try:
            return [p.name for p in provenance.sources(folder / "second.py", folder / "first.py")]
        finally:
            provenance._graph.cache_clear()

    assert (reached(), len(parsed)) == (["first.py", "second.py"], 2)
    assert (reached(), len(parsed)) == (["first.py", "second.py"], 0)
    (folder / "second.py").write_text("from study.room import one\n")
    assert (reached(), len(parsed)) == (["first.py", "second.py"], 2)  # and the package
    (tmp_path / "build/imports.json").write_text("{")
    assert (reached(), len(parsed)) == (["first.py", "second.py"], 3)


PARSE = provenance.ast.parse
