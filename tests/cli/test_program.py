"""The program as a user types it: help, one-line errors, exit statuses, tables on a terminal."""

import os
import re
import shlex
import subprocess
import sys
from functools import wraps
from io import StringIO
from pkgutil import resolve_name

import pandas as pd
import pytest
from typer.main import get_group

from study import dataset, paths
from study.cli import options, output
from study.pages import catalogue

SIZES = ["joint", "--socket-radius", "12.5e-3", "--clearance", "40e-6", "--wall", "6e-3"]
CHOOSE = ["choose", "--r2-star", 200, "--depth-star", 0.3, "--tolerance", 0.1]
PROCESS = os.environ | {"PYTHONPATH": str(paths.ROOT)}


def commands(group, *words):
    """Words of every command."""
    for name in group.list_commands(None):
        command = group.get_command(None, name)
        if hasattr(command, "list_commands"):
            yield from commands(command, *words, name)
        else:
            yield (*words, name)


UNIT = (
    r"\bin (m|N|deg|Pa|s|kg m\^2)\b|\bclearances?\b|\bratio\b|\bover\b|relative|no unit|local error"
)


@pytest.mark.parametrize("words", [*commands(get_group(options.app))])
def test_every_option_is_explained_and_every_number_has_its_unit(run, words):
    status, out, _ = run(*words, "--help")
    assert status == 0
    listed = re.split(r"\n  (?=-)", out.partition("Options:\n")[2])[1:]
    for entry in (" ".join(text.split()) for text in listed):
        name, kind, text = re.fullmatch(r"(-\S+)( [A-Z]+| <\S+>)? (.+)", entry).groups()
        assert len(text) > 10, (words, name)
        assert kind != " NUMBER" or re.search(UNIT, text), (words, entry)


def test_the_program_lists_every_command_with_its_own_first_sentence(run):
    listed = " ".join(run("--help")[1].split())
    assert all(f" {name} {text}" in listed for name, (_, text) in options.COMMANDS.items())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["law", "hertz", "--r2-star", "0.5", "--depth-star", "1"], "r2_star must be > 1, got 0.5"),
        (["law", "hertz", "--r2-star", "200"], "Missing option '--depth-star'"),
        (["law", "hertz", "--r2-star", "x", "--depth-star", "1"], "it must be a number, got 'x'"),
        (["law", "hertz", "--r2-star", "2_00", "--depth-star", "1"], "a number, got '2_00'"),
        (["law", "hertz", "--r2-star", "\uff19", "--depth-star", "1"], "a number, got '\uff19'"),
        (["simulate", "--outputs", "0x64"], "it must be a whole number, got '0x64'"),
        (["joint", "--r2star", "9", "--depth-star", "1"], "No such option: --r2star"),
        (["run", "-p", "r2_star=100"], "-p must be given with a NAME, as in: study run fig10 -p r"),
        (["run", "fig10", "-p", "r2_star"], "-p must be key=value"),
        (["run", "fig10", "-p", "radius=1"], "parameter must be one of"),
        (["run", "fig10", "-p", "r2_star=big"], "parameter r2_star must be of type float"),
        (["run", "fig17", "-p", "outputs=1_00"], "outputs must be of type int, got '1_00'"),
        (["run", "--jobs", "0"], "jobs must be >= 1, got 0"),
        (["measure", "--repeats", "0"], "repeats must be >= 1, got 0"),
        (["walk"], "No such command 'walk'"),
    ],
)
def test_wrong_use_is_one_line_and_status_2(run, words, message):
    status, out, err = run(*words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (["simulate", "--scene", "clearence=1e-5"], "clearance"),
        ([*SIZES, "--force", 1, "--ball", "stel"], "steel"),
        (["law", "hertzz", "--r2-star", 200, "--depth-star", 0.1], "hertz"),
        (["run", "fig10", "-p", "r2star=100"], "r2_star"),
        (["run", "fig10", "-p", "kinematics=smal"], "small"),
        (["law", "hooke", "--r2-star", 200, "--depth-star", 0.1], None),
        (["simulate", "--scene", "volume=1"], None),
    ],
)
def test_a_wrong_name_is_answered_by_the_nearest_one(run, words, near):
    status, out, err = run(*words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.endswith(f": did you mean {near}?\n") == bool(near)
    assert ("did you mean" in err) == bool(near)


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("Fig.14", "fig14"),
        ("fig9", "fig09"),
        ("Table-2", "table2"),
        ("14", "fig14 or 14-where-the-laws-apply"),
        ("fgi10", "fig10"),
        ("where-the-laws-apply", "14-where-the-laws-apply"),
        ("something-else-altogether", None),
    ],
)
def test_an_unknown_result_is_answered_by_the_nearest_one(run, name, near):
    hint = f": did you mean {near}?" if near else ""
    wanted = f"NAME must be one that `study list` shows, got {name!r}{hint}"
    for command in ("run", "list"):
        assert run(command, name) == (2, "", f"study: {wanted}\n")


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
        assert re.search(r"^  fig10: force against depth", out, re.M)
        assert ("  trend: " in out) == (name != "fig10")
        assert "-p NAME=VALUE" in out
        assert re.search(r"^  r2_star: 200.0 \[20 to 10000\]: socket radius", out, re.M)
        assert re.search(r"^  kinematics: linear \[linear, small\]: ", out, re.M)


@pytest.mark.parametrize(
    "words",
    [
        ["joint", "--r2-star", 75, "--depth-star", 0.1, "--depth-star", 0.5],
        ["simulate", "--duration", 0.05],
        [*CHOOSE, "--yield-stress", 2e8],
        [*SIZES, "--force", 1000],
        ["data", "check"],
    ],
)
def test_a_table_is_never_broken(run, on_a_terminal, words):
    """Every number and name stands whole: on 80 columns, and in one line where it is piped."""
    wide = run(*words)[1]
    narrow = on_a_terminal(*words)
    assert max(len(line) for line in narrow if not line.startswith("study export ")) <= 80
    words = re.compile(r"[^\s,:─]*[^\s,:.─]")
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


def test_a_process_ends_with_the_status_of_its_command():
    wrong = [sys.executable, "-m", "study.cli", "law", "hertz", "--r2-star", "200"]
    done = subprocess.run(wrong, capture_output=True, text=True, env=PROCESS)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "study: Missing option '--depth-star'.\n"


def test_no_dask_scheduler_is_one_line_and_status_1(run):
    pytest.importorskip("distributed")
    status, _, err = run("run", "fig09", "--dask", "tcp://127.0.0.1:9")
    assert (status, err.count("\n")) == (1, 1)
    assert err.startswith("study: no Dask scheduler answers at tcp://127.0.0.1:9")


@pytest.mark.parametrize(
    ("why", "told"), [("", ""), ("Unable to allocate 1 GiB", ": Unable to allocate 1 GiB")]
)
def test_too_little_memory_is_one_line_and_status_1(run, monkeypatch, why, told):
    def load():
        raise MemoryError(why)

    monkeypatch.setattr(dataset, "load", load)
    assert run("data", "show") == (1, "", f"study: too little memory{told}\n")


def test_a_solution_under_too_low_a_limit_of_memory_is_refused():
    """Else OpenBLAS asks for memory for ever."""
    joint = "joint --r2-star 200 --depth-star 0.1 --ball-support clamped"
    command = f"ulimit -v 550000 && exec {shlex.quote(sys.executable)} -m study.cli {joint}"
    done = subprocess.run(["sh", "-c", command], cwd=paths.ROOT, capture_output=True, text=True)
    told = "study: too little memory for a solution: ulimit -v is 550000, and must be at least "
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert done.stderr.startswith(told)


def interrupt(*_, **__):
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("called", "kept", "words"),
    [
        ("dataset:load", "", ["data", "show"]),
        ("export:export", "", ["export", "--law", "hertz", "--format", "c"]),
        ("choose:choose", "", CHOOSE),
        ("joint:DimensionalJoint.solve", "", [*SIZES, "--force", 1]),
        ("dataset.production:to_make", options.KEPT, ["data", "build"]),
        ("measure.charts:measure", options.KEPT, ["measure"]),
    ],
)
def test_interruption_is_one_line_and_status_130(run, monkeypatch, called, kept, words):
    name = f"study.{called}"
    monkeypatch.setattr(name.replace(":", "."), wraps(resolve_name(name))(interrupt))
    assert run(*words) == (130, "", f"study: interrupted{kept}\n")


@pytest.mark.parametrize(
    ("words", "work"),
    [
        (["simulate"], "study.cli.mechanism:simulate"),
        (["measure", "--chart", "laws"], "study.measure.charts:measure"),
        (["export", "--law", "tabulated", "--format", "csv"], "study.export:export"),
    ],
)
def test_output_that_cannot_be_written_is_refused_before_the_work(
    run, monkeypatch, tmp_path, words, work
):
    monkeypatch.setattr(work.replace(":", "."), wraps(resolve_name(work))(interrupt))
    (tmp_path / "folder.csv").mkdir()
    (tmp_path / "file").touch()
    (tmp_path / "closed").mkdir()
    access = os.access
    closed = lambda path, mode: "closed" not in str(path) and access(path, mode)  # noqa: E731
    monkeypatch.setattr("os.access", closed)
    in_a_folder = "--output must be in a folder that can be written to, got "
    for name, message in (
        ("nowhere/x.csv", in_a_folder),
        ("file/x.csv", in_a_folder),
        ("closed/x.csv", in_a_folder),
        ("folder.csv", "--output must be a file, got the folder "),
        ("x.txt", "--output must end in .csv, got "),
    ):
        told = f"study: {message}{tmp_path / name}\n"
        assert run(*words, "--output", tmp_path / name) == (2, "", told)
