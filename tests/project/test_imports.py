"""What an import or a quick command loads."""

import subprocess
import sys

import pytest

HEAVY = {"numba", "pandas", "skfem", "matplotlib"}
OF_COMMANDS = HEAVY | {"snakemake", "sqlalchemy", "papermill", "study.mechanism"}
COMMAND = "from study.cli import main; main({!r}.split(), standalone_mode=False)"


@pytest.mark.parametrize(
    ("code", "heavy"),
    [
        ("import study.contact", HEAVY),
        ("from study.mechanism import Scene, simulate", {"skfem", "matplotlib", "study.dataset"}),
        ("from study.joint import Joint, Material", HEAVY),
        (COMMAND.format("--help"), {"numpy"}),
        (COMMAND.format("list"), {*OF_COMMANDS, "scipy"}),
        (COMMAND.format("joint --help"), {*OF_COMMANDS, "scipy.linalg"}),
        (COMMAND.format("joint --r2-star 200 --depth-star 0.1"), OF_COMMANDS),
        (COMMAND.format("export hertz c --r2-star 200"), OF_COMMANDS),
    ],
)
def test_an_import_or_a_command_loads_what_it_needs(code, heavy):
    code += "\nimport sys\nprint('LOADED', *sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert not heavy & {*done.stdout.split("LOADED ")[1].split()}
