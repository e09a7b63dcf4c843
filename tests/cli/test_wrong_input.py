"""Wrong input of every command is one line on standard error, with exit status 2 and no work."""

import os
import subprocess
import sys

import pytest

from study import paths

SIZES = "--socket-radius 12.5mm --clearance 40um --wall 6mm --socket bronze"
WRONG = [
    (f"joint {SIZES} --force 1 --r2-star 75", "r2_star and socket_radius must not both be given"),
    ("joint --socket-radius 1cm --force 1", "clearance and wall must be given"),
    ("joint", "a joint without dimensions is described by r2_star instead"),
    ("joint --r2-star 5 --depth-star 0.1", "r2_star must be >= 10 and <= 1e+09, got 5"),
    ("joint --r2star 9", "No such option '--r2star'. (Did you mean"),
    (f"joint {SIZES} --force -3kN", "force must be > 0 N, got -3000 N"),
    (f"joint {SIZES} --force 3kJ", "force must be a number in N, or with its unit, such as 3kN"),
    (f"joint {SIZES} --force 3 kN", "write 3kN, or '3 kN' in quotes"),
    (f"joint {SIZES} --force=3 lbf", "write 3lbf, or '3 lbf' in quotes"),
    ("joint --socket-radius 12.5 Mm", "write 12.5Mm, or '12.5 Mm' in quotes"),
    ("joint --socket-radius 12.5Mm --clearance 40um --wall 6mm", "Mm is a megametre, and mm or um"),
    ("export power adams --socket-radius 12.5 mm --clearance 40um", "write 12.5mm, or '12.5 mm'"),
    ("simulate --clearance 1e2 \u00b5m", "write 1e2\u00b5m, or '1e2 \u00b5m' in quotes"),
    ("fit examples/fit_your_curve.csv --clearance 40 nN", "write 40nN, or '40 nN' in quotes"),
    (f"joint {SIZES} --force=", "force is empty; give a value, or leave it out"),
    (f"joint {SIZES} --force 1 --depth 1um", "got depth and force"),
    (f"joint {SIZES} --force 1 --resolution 50", "resolution must be a multiple of 32, got 50"),
    (f"joint {SIZES} --outer-width 30mm --force 1", "outer_width must be < 0.025 m, got 0.03 m"),
    (f"joint {SIZES} --play 80um", "play and clearance must not both be given"),
    ("joint --bearing GE20E --radial-clearance 60um", "of a catalogue as --play"),
    ("joint --bearing GE21E", "bearing must be GE SIZE E, where SIZE is one of 4, 5"),
    ("joint --bearing GE20E --r2-star 50", "r2_star and bearing must not both be given"),
    ("joint --bearing GE20E --outer-diameter 29mm", "outer_diameter must be > 0.029061 m"),
    ("joint --bearing GE20E --bore 28mm", "radius of the pin must be <= 0.01137 m in a ball"),
    ("joint --bearing GE20E --play 50", "play must be < 0.029 m, got 50 m"),
    ("joint --bearing GE20E --play 9mm", "(twice socket_radius, or ball_diameter plus play)"),
    ("joint --bore 1cm --inner-width 1cm --ball-diameter 2cm --play 1mm --wall 5mm", "outer_width"),
    ("joint --ball-diameter 2cm --wall 5mm", "clearance must be given for a joint with dimensions"),
    ("joint --bearing GE20E --play 5mm --outer-diameter 4cm", "clearance follows from play"),
    (
        "joint --ball-diameter 2cm --play 1mm --wall 5mm --bore 1cm",
        "bore and inner_width must both",
    ),
    (f"joint {SIZES} --ball-diameter 2cm", "ball_diameter and socket_radius must not both be"),
    (f"joint {SIZES} --force 1 --tilt 999", "tilt must be >= 0 and <= 170 deg, got 999 deg"),
    ("joint --r2-star 50 --depth-star 0.1 --plot x.png", "plot requires a joint with dimensions"),
    (f"joint {SIZES} --plot x.png", "plot requires a joint with dimensions, and force, depth"),
    ("joint --r2-star 50 --output study", "output must be a file, got study"),
    ("joint nothing.csv", "'nothing.csv' does not exist"),
    ("joint README.md", "of README.md must have 1 cells"),
    ("joint examples/fit_your_curve.csv --jobs 0", "0 is not in the range"),
    ("laws examples/fit_your_curve.csv", "FILE must have one row, got 27 in"),
    ("laws --r2-star 50 --depth-star 30", "depth_star must be"),
    ("export winkel c --r2-star 50", "'winkel' is not one of"),
    ("export hertz c --r2-star 20 --depth 1um", "depth"),
    ("export power adams --r2-star 50", "must be one of c, matlab, csv, got 'adams'"),
    ("fit examples/fit_your_curve.csv --r2-star 200", "dimensions"),
    ("simulate --duration -1", "duration must be > 0"),
    ("simulate --clearence 1um", "(Did you mean one of: '--clearance'"),
    ("simulate --law hertz --wall 5mm", "wall does not apply to the law hertz; remove it"),
    ("simulate --law hooke", "law must be one of"),
    ("simulate --elements 2,2", "elements does not apply to model rigid"),
    ("simulate --elements 2 --model beams", "elements must be 2 values separated by ','"),
    ("simulate examples/fit_your_curve.csv --table motion", "table must be summary for a FILE"),
    ("data show --r2-star 7", "r2_star must be one that study data show lists, got 7.0"),
    ("data check --sample 0", "sample must be >= 1, got 0"),
    ("run -p r2_star=100", "-p and --accept must be given with a NAME"),
    ("run fig10 -p size=1", "parameter of 03-force-against-depth must be one of r2_star"),
    ("run fig10 -p r2_star", "-p must be KEY=VALUE, got 'r2_star'"),
    ("run fig10 -p r2_star=9 --accept", "-p cannot be used together with --accept or words"),
    ("run fig10 -p r2_star=9 -- -n", "-p cannot be used together with --accept or words"),
    ("list fig1", "NAME must be a notebook or result that study list shows, got fig1"),
    ("walk", "No such command 'walk'"),
]


@pytest.mark.parametrize(("words", "message"), WRONG)
def test_wrong_input_is_one_line_and_status_2(run, monkeypatch, words, message):
    monkeypatch.chdir(paths.ROOT)
    status, out, err = run(*words.split())
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err


def test_a_file_may_have_the_name_of_a_unit(run, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mm").write_text("r2_star,depth_star\n50,0.1\n")
    for words in ("--depth-star 0.1 mm", "--depth-star 0.1 mm --output N"):
        status, _, err = run("joint", *words.split())
        assert (status, "write" in err) == (0, False)


def test_a_unit_may_be_separate_in_quotes(run):
    words = ["joint", *SIZES.split()]
    assert run(*words, "--force", "3 kN") == run(*words, "--force", "3kN")


def test_an_unreachable_dask_scheduler_is_one_line(run, tmp_path):
    pytest.importorskip("distributed")
    (tmp_path / "cases.csv").write_text("r2_star\n50\n")
    status, _, err = run("joint", tmp_path / "cases.csv", "--dask", "no-address")
    assert status == 1
    assert "no Dask scheduler answers at no-address" in err.splitlines()[-1]


@pytest.mark.skipif(os.name != "posix", reason="has no limit of the size of files")
def test_a_file_that_cannot_be_written_is_named(tmp_path):
    """A limit of the size of files fails as a full device does."""
    limit = "import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN); "
    limit += "resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100)); "
    code = limit + "from study.cli import main; main()"
    words = ["joint", "--r2-star", "50", "--output", "table.csv"]
    command = [sys.executable, "-c", code, *words]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (1, "Error: [Errno 27] File too large: 'table.csv'\n")
    assert list(tmp_path.iterdir()) == []
