"""Programs that run exported texts, where they are installed."""

import shutil

import pytest

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
OCTAVE = shutil.which("octave-cli") or shutil.which("octave")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler found")
needs_octave = pytest.mark.skipif(OCTAVE is None, reason="GNU Octave is not installed")
