"""Files are written whole or not at all, and what killed processes leave is removed."""

import errno
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


def test_a_full_disk_is_told_with_the_name_of_the_file(tmp_path):
    path = tmp_path / "table.csv"
    message = rf"No space left on device: '{path}'"
    with pytest.raises(OSError, match=message), paths.whole(path):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))  # as of a write
    assert list(tmp_path.iterdir()) == []


def test_what_killed_processes_left_is_removed_and_nothing_else(tmp_path, monkeypatch):
    for name in ("ROOT", "DATA", "FIGURES", "BUILD"):
        monkeypatch.setattr(paths, name, tmp_path / name)
        (tmp_path / name).mkdir()
    monkeypatch.setattr(paths.tempfile, "gettempdir", lambda: str(tmp_path))
    done = subprocess.run([sys.executable, "-c", "import os; print(os.getpid())"], stdout=-1)
    dead, host = int(done.stdout), socket.gethostname()
    left = [
        tmp_path / "FIGURES" / f".part-{host}-{dead}-a",
        tmp_path / "DATA" / "published" / f".part-{host}-{dead}-b",
        tmp_path / f".part-{host}-{dead}-kernel",
    ]
    others = [
        tmp_path / "FIGURES" / f".part-{host}-{os.getpid()}-a",
        tmp_path / "FIGURES" / f".part-another-{dead}-a",
        tmp_path / "FIGURES" / "fig01.csv",
    ]
    for path in (*left, *others):
        path.mkdir(parents=True)
        (path / "table.csv").touch()
    paths.remove_abandoned()
    assert not any(path.exists() for path in left)
    assert all(path.exists() for path in others)
