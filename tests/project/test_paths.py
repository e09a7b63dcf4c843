"""Files are written whole or not at all."""

import pytest

from study import paths


def test_a_file_is_written_whole_or_not_at_all(tmp_path):
    path = tmp_path / "folder" / "table.csv"
    with paths.whole(path) as temporary:
        temporary.write_text("old")
    with pytest.raises(KeyboardInterrupt), paths.whole(path) as temporary:
        temporary.write_text("half")
        raise KeyboardInterrupt
    assert path.read_text() == "old"
    assert [p.name for p in path.parent.iterdir()] == ["table.csv"]


def test_a_path_is_shown_in_the_project_and_whole_outside_it(tmp_path):
    assert paths.shown(paths.FIGURES / "fig10.png") == "figures/fig10.png"
    assert paths.shown(tmp_path) == tmp_path.as_posix()
