"""Files are written whole or not at all, and what killed processes leave is removed."""

import os
import socket
import subprocess
import sys

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


def test_a_file_follows_umask_keeps_its_mode_and_is_written_through_a_link(tmp_path):
    new, kept, link = tmp_path / "new.csv", tmp_path / "kept.csv", tmp_path / "link.csv"
    kept.touch()
    kept.chmod(0o600)
    link.symlink_to(kept)
    before = os.umask(0o027)
    try:
        for path in (new, link):
            with paths.whole(path) as temporary:
                temporary.write_text("text")
    finally:
        os.umask(before)
    assert new.stat().st_mode & 0o777 == 0o640
    assert (kept.read_text(), kept.stat().st_mode & 0o777, link.is_symlink()) == (
        "text",
        0o600,
        True,
    )


def test_what_killed_processes_left_is_removed_and_nothing_else(tmp_path, monkeypatch):
    for name in ("STUDY", "DATA", "FIGURES", "BUILD"):
        monkeypatch.setattr(paths, name, tmp_path)
    done = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], stdout=-1)
    left = tmp_path / f".part-{socket.gethostname()}-{int(done.stdout)}-a"
    others = [tmp_path / f".part-{socket.gethostname()}-{os.getpid()}-a", tmp_path / "fig01.csv"]
    for path in (left, *others):
        path.mkdir()
    paths.remove_abandoned()
    assert sorted(tmp_path.iterdir()) == sorted(others)
