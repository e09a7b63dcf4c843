"""Materials by name: a whole table with sources, and what a name may look like."""

import re

import pytest

from study import checks
from study.contact import Material, material, materials

WANTED = "steel stainless bronze brass cast_iron aluminium titanium CoCr alumina UHMWPE PTFE POM"
WANTED += " PEEK PA66 PTFE_fabric"


def test_table_is_complete_and_sourced():
    rows = materials.table()
    names = [row["name"] for row in rows]
    assert {name.replace("_", " ") for name in WANTED.split()} <= set(names)
    assert len({materials._plain(name) for name in names}) == len(names)
    for row in rows:
        assert row["name"].replace(" ", "").isalnum(), row  # no formula of a spreadsheet, no HTML
        assert all(row[name].strip() for name in ("condition", "source")), row
        assert 1e8 < row["youngs_modulus"] < 5e11, row
        assert 0.2 <= row["poisson"] < 0.5, row
        if row["yield_stress"] is not None:  # strains at yield are about 0.1 to 3 %
            assert 1e-3 < row["yield_stress"] / row["youngs_modulus"] < 0.03, row


def test_brittle_materials_and_fabrics_have_no_yield_stress():
    without = {row["name"] for row in materials.table() if row["yield_stress"] is None}
    assert without == {"alumina", "cast iron", "PTFE fabric"}


@pytest.mark.parametrize("name", ["cast iron", "Cast-Iron", "CAST_IRON", " castiron "])
def test_names_are_found_however_they_are_written(name):
    assert material(name) == Material(1.1e11, 0.26)


def test_a_material_by_its_numbers_or_itself():
    assert material("210e9,0.3") == Material(210e9, 0.3)
    found = material("2.1e11, 0.3, 5e8")
    assert (found, found.yield_stress) == (Material(2.1e11, 0.3), 5e8)
    assert material(found) is found
    assert material("bronze").yield_stress == 1.6e8


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("bronz", "material must be one of steel, bearing steel, stainless, bronze,"),
        ("210e9", "210GPa,0.3, got '210e9'"),
        (3, "material must be a Material, got 3"),
        ("210,0.3", "Young's modulus of material must be >= 100000 Pa, got 210 Pa: did you mean"),
        ("69000,0.33", "got 69000 Pa: did you mean 69e9?"),
        (Material(210, 0.3), "got 210 Pa: did you mean 210e9?"),
    ],
)
def test_wrong_materials(given, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        material(given)


@pytest.mark.parametrize("content", ["", "name,poisson\nsteel,0.3\n", "name\n"])
def test_a_damaged_table_is_one_clear_error(content, tmp_path, monkeypatch):
    monkeypatch.setattr(materials, "MATERIALS", tmp_path / "materials.csv")
    (tmp_path / "materials.csv").write_text(content)
    materials.table.cache_clear()
    with pytest.raises(
        checks.StudyError,
        match=r"is missing or damaged.* git checkout -- study/contact/materials.csv, ",
    ):
        materials.table()
    materials.table.cache_clear()


@pytest.mark.parametrize(
    ("row", "why"),
    [
        ("steel,abc,0.3,,c,s", "(youngs_modulus of steel must be a number, got 'abc')"),
        ("steel,210,0.3,,c,s", "Young's modulus of steel must be >= 100000 Pa, got 210"),
    ],
)
def test_a_wrong_row_of_the_table_is_told(row, why, tmp_path, monkeypatch):
    monkeypatch.setattr(materials, "MATERIALS", tmp_path / "materials.csv")
    head = "name,youngs_modulus,poisson,yield_stress,condition,source\nbrass,1e11,0.3,,c,s\n"
    (tmp_path / "materials.csv").write_text(head + row)
    materials.table.cache_clear()
    with pytest.raises(checks.StudyError, match=re.escape(why)) as told:
        material("brass")
    materials.table.cache_clear()
    assert "\n" not in str(told.value)
