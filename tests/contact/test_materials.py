"""Materials by name: a whole table with sources, and what a name may look like."""

from study.contact import Material, material, materials


def test_table_is_complete_and_sourced():
    rows = materials.table()
    names = [row["name"] for row in rows]
    assert len({materials._plain(name) for name in names}) == len(names)
    for row in rows:
        assert row["name"].replace(" ", "").isalnum(), row  # no formula of a spreadsheet, no HTML
        assert all(row[name].strip() for name in ("condition", "source")), row
        assert 1e8 < row["youngs_modulus"] < 5e11, row
        assert 0.2 <= row["poisson"] < 0.5, row
        if row["yield_stress"] is not None:  # strains at yield are about 0.1 to 3 %
            assert 1e-3 < row["yield_stress"] / row["youngs_modulus"] < 0.03, row
    without = {row["name"] for row in rows if row["yield_stress"] is None}
    assert without == {"alumina", "cast iron", "PTFE fabric"}


def test_a_material_by_its_name_by_its_numbers_or_itself():
    for name in ("cast iron", "Cast-Iron", "CAST_IRON", " castiron "):
        assert material(name) == Material(1.1e11, 0.26)
    assert material("210e9,0.3") == Material(210e9, 0.3)
    found = material("2.1e11, 0.3, 5e8")
    assert (found, found.yield_stress) == (Material(2.1e11, 0.3), 5e8)
    assert material(found) is found
    assert material("bronze").yield_stress == 1.6e8
