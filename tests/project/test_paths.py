"""Files are written whole or not at all, and what killed processes leave is removed."""

import errno
import os
import socket
import subprocess
import sys
from pathlib import Path

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


def test_a_folder_that_cannot_be_made_is_told_without_a_temporary_name(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="file") as caught, paths.whole(tmp_path / "file/table.csv"):
        pass
    assert ".part-" not in str(caught.value)


def test_a_file_is_copied_to_another_file_system(tmp_path):
    other = Path("/dev/shm")
    if not other.is_dir() or other.stat().st_dev == tmp_path.stat().st_dev:
        pytest.skip("there is no other file system here")
    (tmp_path / "table.csv").write_text("x\n1\n")
    with paths.scratch(other) as folder:
        paths.copy(tmp_path / "table.csv", folder / "table.csv")
        assert (folder / "table.csv").read_text() == "x\n1\n"
    assert not folder.exists()


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
