"""The program as a user types it: help, one-line errors, exit statuses, tables on a terminal."""

import math
import re
import shlex
import subprocess
import sys
from functools import wraps
from io import StringIO

import pandas as pd
import pytest

from study import paths
from study.cli import options, output, program
from study.cli.program import COMMANDS, PROGRAM
from study.mechanism import simulate
from study.pages import catalogue

SIZES = ["joint", "--socket-radius", "12.5e-3", "--clearance", "40e-6", "--wall", "6e-3"]
CHOOSE = ["choose", "--r2-star", 200, "--depth-star", 0.3, "--tolerance", 0.1]


def commands(group, *words):
    """Words of every command."""
    for name in group.list_commands(None):
        command = group.get_command(None, name)
        if hasattr(command, "list_commands"):
            yield from commands(command, *words, name)
        else:
            yield (*words, name)


UNIT = r"\bin (m|N|deg|Pa|s|kg)\b|clearances?\b|\bratio\b|divided by|over|relative|no unit|R2/"


def found(words):
    """Command of some words."""
    command = PROGRAM
    for word in words:
        command = command.get_command(None, word)
    return command


@pytest.mark.parametrize("words", [*commands(PROGRAM)])
def test_every_option_is_explained_and_every_number_has_its_unit(run, words):
    status, out, _ = run(*words, "--help")
    assert status == 0
    assert re.search(rf"\n  Examples?:\n    study {' '.join(words)}\b", out)
    assert max(map(len, out.partition("  Example")[0].splitlines())) <= 80
    listed = "".join(out.split())
    command = found(words)
    shown = {option.name for options in command.sections.values() for option in options}
    of_joint = "" if words == ("joint",) else run("joint", "--help")[1]
    for parameter in command.params:
        explained = " ".join(parameter.help.split())
        assert len(explained) > 10, (words, parameter.name)
        assert re.search(r"\.( \[|$)", explained), (words, explained)
        if parameter.name in shown or parameter in command.arguments:
            assert "".join(explained.split()) in listed
        else:  # an option of a joint, which one command explains for all
            assert "".join(explained.split()) in "".join(of_joint.split())
        if parameter.metavar == "NUMBER":
            assert re.search(UNIT, explained), (words, parameter.name)


LONG = ("run", "accept", "report", "paper", "measure", "data check", "data build", "data accept")
"""Commands whose examples take minutes, or change files of the project."""


@pytest.mark.slow
@pytest.mark.parametrize("words", [*commands(PROGRAM)])
def test_examples_of_the_help_run(run, words, monkeypatch, tmp_path):
    if " ".join(words) in LONG:
        pytest.skip("it takes minutes, or changes files of the project")
    monkeypatch.setattr("study.cli.sweep.PLAIN_EVERY", math.inf)  # s: no progress if it is slow
    (tmp_path / "examples").symlink_to(paths.ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    shown = found(words).epilog.replace("\\\n", "").splitlines()[2:]
    assert shown
    for line in shown:
        program, *rest = shlex.split(line)
        status, out, err = run(*rest)
        assert (program, status, err) == ("study", 0, ""), line
        assert out or list(tmp_path.iterdir())


def test_the_program_lists_every_command_with_its_own_first_sentence(run):
    listed = " ".join(run("--help")[1].split())
    assert all(f" {name} {text}" in listed for name, (_, text) in COMMANDS.items())


def test_list_is_csv_where_piped_and_by_notebook_on_a_terminal(run, on_a_terminal):
    status, out, err = run("list")
    assert (status, err) == (0, "")
    table = pd.read_csv(StringIO(out))
    assert list(table) == ["name", "notebook", "shows"]
    every = {n: made.shows for nb in catalogue.CATALOGUE for n, made in nb.results.items()}
    assert dict(zip(table.name, table.shows, strict=True)) == every
    lines = on_a_terminal("list")
    assert max(map(len, lines)) <= 80
    heads = [line for line in lines if not line.startswith(" ")]
    assert [head.split(":")[0] for head in heads] == [nb.name for nb in catalogue.CATALOGUE]


def test_list_of_a_name_tells_the_parameters_of_its_notebook(run):
    for name in ("fig10", "03-force-against-depth"):
        status, out, err = run("list", name)
        assert (status, err) == (0, "")
        assert out.startswith("03-force-against-depth:\n")
        assert "\n  fig10: contact force over" in out
        assert ("  trend: " in out) == (name != "fig10")
        assert "\n  r2_star: 200.0 [a radius of the dataset]: " in out


@pytest.mark.parametrize(
    "words",
    [
        ["joint", "--r2-star", 75, "--depth-star", 0.1, "--depth-star", 0.5],
        ["simulate", "--duration", 0.05],
        [*CHOOSE, "--yield-stress", 2e8],
        [*SIZES, "--force", 1000],
    ],
)
def test_a_table_is_never_broken(run, on_a_terminal, words):
    """Every number and word stands whole: on 80 columns, and in one line where it is piped."""
    wide = run(*words)[1]
    narrow = on_a_terminal(*words)
    assert max(len(line) for line in narrow if not line.startswith("study export ")) <= 80
    words = re.compile(r"[^\s,:─_]*[^\s,:.─_]")
    assert set(words.findall(wide)) <= set(words.findall(" ".join(narrow)))
    assert any(line.startswith("─") for line in wide.splitlines())


def test_what_is_being_done_is_told_on_a_terminal_until_it_is(monkeypatch, capsys):
    for is_terminal, told in (
        (True, ["Solving the joint ...", "half of it", ""]),
        (False, []),
    ):
        monkeypatch.setattr(sys.stderr, "isatty", lambda shown=is_terminal: shown)
        with output.working("Solving the joint") as tell:
            tell("half of it")
        lines = capsys.readouterr().err.split("\r")[1:]
        assert [line.removesuffix("\x1b[K") for line in lines] == told


def test_no_dask_scheduler_is_one_line_and_status_1(run, tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("study.sweep.run.ANSWERS_WITHIN", 0.5)
    words = ("--random", 2, "--range", "r2_star=50:90", "--output", tmp_path / "x.csv")
    status, _, err = run("sweep", "joints", *words, "--dask", "tcp://127.0.0.1:9")
    assert (status, err.count("\n")) == (1, 1)
    assert err.startswith("study: no Dask scheduler answers at tcp://127.0.0.1:9")


def test_a_solution_under_too_low_a_limit_of_memory_is_refused():
    """Else OpenBLAS asks for memory for ever."""
    joint = "joint --r2-star 200 --depth-star 0.1 --ball-support clamped"
    command = f"ulimit -v 550000 && exec {shlex.quote(sys.executable)} -m study.cli {joint}"
    done = subprocess.run(["sh", "-c", command], cwd=paths.ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert re.search(r"memory .* ulimit -v must be >= \d+ KiB, got 550000 KiB", done.stderr)


def interrupt(*_, **__):
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("called", "kept", "words"),
    [
        ("study.dataset.load", "", ["data", "show"]),
        ("study.pages.workflow.run", options.KEPT, ["data", "build"]),
    ],
)
def test_interruption_is_one_line_and_status_130(run, monkeypatch, called, kept, words):
    monkeypatch.setattr(called, interrupt)
    assert run(*words) == (130, "", f"study: interrupted{kept}\n")


def test_ctrl_c_while_packages_load_is_one_line(run, monkeypatch):
    monkeypatch.setattr(program, "run", interrupt)
    assert run("joint") == (130, "", "study: interrupted\n")


def test_a_closed_output_is_one_line(tmp_path):
    command = f"exec {shlex.quote(sys.executable)} -m study.cli --help >&-"
    done = subprocess.run(["sh", "-c", command], cwd=paths.ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (
        1,
        "study: the standard output is closed; give it a file\n",
    )


def test_output_that_cannot_be_written_is_refused_before_the_work(run, monkeypatch, tmp_path):
    monkeypatch.setattr("study.cli.mechanism.simulate", wraps(simulate)(interrupt))
    (tmp_path / "folder.csv").mkdir()
    (tmp_path / "file").touch()
    in_a_folder = "--output must be in an existing folder with write permission, got "
    for name, message in (
        ("nowhere/x.csv", in_a_folder),
        ("file/x.csv", in_a_folder),
        ("folder.csv", "--output must be a file, got the folder "),
        ("x.txt", "--output must end in .csv, got "),
    ):
        told = f"study: {message}{tmp_path / name}\n"
        assert run("simulate", "--output", tmp_path / name) == (2, "", told)
