"""Materials by name: a whole table with sources, and what a name may look like."""

import pytest

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
