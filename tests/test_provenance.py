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
        *("checks.py", "contact/bodies.py", "joint/complementarity.py", "joint/compliance.py"),
        *("joint/curve.py", "joint/fem.py", "contact/materials.py", "joint/joint.py"),
        *("joint/contact_kinematics.py", "joint/series.py", "threads.py"),
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
    assert "joint/joint.py" in found
    assert "joint/Joint.py" not in found


def test_imports_inside_functions_count(tmp_path):
    path = tmp_path / "late.py"
    path.write_text("def f():\n    import study.measure.stability\n")
    assert paths.ROOT / "study/measure/stability.py" in provenance.sources(path)


@pytest.mark.parametrize(
    ("changed", "stale"),
    [
        ("study/measure/stability.py", ["17", "18"]),
        ("study/measure/speed.py", ["16", "26"]),
        ("study/claims/verdicts.py", ["21"]),
        ("study/claims/identification.py", ["04", "13"]),
        ("study/mechanism/beams.py", ["08", "09", "10", "11", "16", "17", "18", "26"]),
        ("study/mechanism/scene.py", ["07", "08", "09", "10", "11", "16", "17", "18", "26"]),
        ("study/pages/figures.py", [f"{n:02d}" for n in range(27)]),
        ("study/cli/build.py", []),
        ("study/pages/report/sources.py", []),
        ("data/published/claims.csv", ["21"]),
        ("study/contact/coefficients.json", [f"{n:02d}" for n in range(27)]),
    ],
)
def test_a_change_makes_stale_what_reaches_it_and_nothing_else(changed, stale):
    path = paths.ROOT / changed
    assert path.is_file()
    assert [nb.name[:2] for nb in catalogue.CATALOGUE if path in nb.inputs()] == stale


def test_data_that_modules_read_are_there_and_named_in_them():
    for module, names in provenance.READS.items():
        text = (paths.ROOT / "study" / module).read_text()
        for name in names:
            assert (paths.ROOT / name).is_file()
            assert name.split("/")[-1] in text


def test_every_data_file_of_the_dataset_decides_what_loads_it():
    described = json.loads((paths.DATA / "datapackage.json").read_text())["resources"]
    read = {f"data/{resource['path']}" for resource in described}
    assert read - {"data/published/mechanism.csv"} == set(provenance.READS["dataset/store.py"])
