"""Programs that run exported texts, where they are installed."""

import ctypes
import shutil
import subprocess

import pytest
from other_programs import calculix

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
OCTAVE = shutil.which("octave-cli") or shutil.which("octave")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler found")
needs_octave = pytest.mark.skipif(OCTAVE is None, reason="GNU Octave is not installed")
needs_calculix = pytest.mark.skipif(calculix.version() is None, reason="ccx is not installed")


def compiled(text, folder):
    """Library of a text in C, which must compile without any warning."""
    source, library = folder / "law.c", folder / "law.so"
    source.write_text(text)
    words = ["-std=c89", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-fPIC"]
    subprocess.run([COMPILER, *words, source, "-o", library, "-lm"], check=True)
    return ctypes.CDLL(library)


def in_octave(lines, folder):
    """What lines of MATLAB print, which may call functions in files of a folder."""
    script = folder / "compare.m"
    script.write_text("\n".join(lines))
    words = [OCTAVE, "--quiet", "--no-init-file", "--no-gui", str(script)]
    done = subprocess.run(words, cwd=folder, check=True, capture_output=True, text=True)
    assert "warning" not in done.stderr
    return done.stdout
