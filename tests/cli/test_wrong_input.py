"""Wrong input of every command: one line on standard error, exit status 2, and no work."""

import pytest

from study import paths

SIZES = ["--socket-radius", 12.5e-3, "--clearance", 40e-6, "--wall", 6e-3, "--socket", "bronze"]
BRONZE = ["joint", *SIZES]
RATIOS = ["joint", "--r2-star", 75, "--depth-star", 0.1]
TILTED = [*BRONZE, "--force", 1, "--ball-support", "clamped", "--tilt", 5]
LAW = ["--r2-star", 50, "--depth-star", 0.3]
CHOOSE = ["choose", "--tolerance", 0.01]
EXPORT = ["export", "--law", "hertz", "--format", "c"]
OPTION = ["simulate", "--law", "winkler", "--option"]

WRONG = [
    ([*BRONZE, "--force", 1, "--r2-star", 75], "--r2-star and --socket-radius must not both be gi"),
    (["joint", "--socket-radius", 0.01, "--force", 1], "--clearance, --wall must be given"),
    (["joint"], "a joint without dimensions is described by --r2-star"),
    (["joint", "--r2-star", 5, "--depth-star", 0.1], ">= 10, got 5; such a loose ball is not"),
    (["joint", "--r2star", "9", "--depth-star", "1"], "No such option '--r2star'"),
    ([*BRONZE, "--force", 1, "--resolution", 50], "--resolution must be a multiple of 32, got 50"),
    ([*BRONZE, "--force", "3kJ"], "--force must be a number in N, or with its unit, such as 3kN"),
    ([*BRONZE, "--force", "3e3_0"], "got '3e3_0'"),
    ([*BRONZE, "--joint", "none.toml"], "--joint must be a file that study joint --save wrote"),
    ([*BRONZE, "--ring-width", "30mm", "--force", 1], "--ring-width must be < 0.025 m, got 0.03 m"),
    (
        [*BRONZE, "--ring-width", "30mm", "--opening", 80],
        "--ring-width and --opening must not both be given",
    ),
    ([*TILTED, "--tolerance", 0.1], "--tolerance does not apply to a load off the axis"),
    ([*RATIOS, "--plot", "x.png"], "--plot is for a joint with dimensions"),
    ([*RATIOS, "--friction", 0.1], "--friction is for a joint with dimensions"),
    (["law", "hertz", "--r2-star", "0.5", "--depth-star", "1"], "--r2-star must be > 1, got 0.5"),
    (["law", "hertz", "--r2-star", "200"], "--depth-star must be given"),
    (
        ["law", "hertz", "--r2-star", "2_00", "--depth-star", "1"],
        "--r2-star must be a number, got '2_00'",
    ),
    (["law", "hertz", *LAW, "--ball-support", "clamped"], "--ball-support does not apply to the"),
    (["law", "winkler", *LAW, "--exponent", 2], "--exponent does not apply to the law winkler"),
    (["law", "tabulated", *LAW, "--n", 2], "--n does not apply to the law tabulated; remove it"),
    (["law", "steuermann", *LAW, "--n", 51], "--n must be >= 1 and <= 50, got 51"),
    ([*CHOOSE, *SIZES], "one of --depth, --force and --depth-star must be given, got none"),
    ([*CHOOSE, *SIZES, "--depth", 1e-6, "--force", 3], "must be given, got --depth and --force"),
    ([*CHOOSE, *SIZES, "--depth", -1], "--depth must be > 0 m, got -1 m"),
    ([*CHOOSE, *SIZES, "--depth", 1e-6, "--yield-stress", 1e9], "--yield-stress does not apply"),
    ([*CHOOSE, "--r2-star", 20, "--force", 3], "--force does not apply to a joint without dimens"),
    ([*CHOOSE, "--depth-star", 0.1], "--socket-radius, --clearance, --wall must be given"),
    ([*CHOOSE, "--r2-star", 20], "--depth-star must be given"),
    ([*EXPORT, "--depth", 1e-6], "a joint without dimensions is described by --r2-star"),
    ([*EXPORT, "--r2-star", 20, "--depth", 1e-6], "--depth does not apply to a joint without"),
    ([*EXPORT, *SIZES, "--depth", 1e-6, "--depth-star", 0.1], "must not both be given"),
    ([*EXPORT, "--r2-star", 20, "--option", "n=2"], "must be KEY=VALUE with KEY one of nothing"),
    (["fit", "--try-power", "1e9"], "--try-power must be two numbers separated by a comma"),
    (["fit", "--try-power", "1e9,-1", *SIZES], "exponent of --try-power must be > 0, got -1"),
    (["fit", "--try-power", "1e9,1.5"], "--try-power must be given with a joint with dimensions"),
    (["fit"], "FILE or --try-power must be given"),
    (["fit", "none.csv"], "FILE must be a CSV file"),
    (["fit", "examples/fit_your_curve.csv", "--r2-star", 200], "because the curve has units"),
    (["simulate", "--scene", "friction"], "--scene must be KEY=VALUE"),
    (["simulate", "--elements", "2,2", "--model", "auto"], "--elements does not apply to model au"),
    (["simulate", "--law", "hertz", "--wall", "5e-3"], "wall does not apply to the law hertz; rem"),
    ([*OPTION, "n=2"], "with KEY one of coefficient, got 'n=2'"),
    ([*OPTION, "coefficient"], "must be KEY=VALUE with KEY one of coefficient"),
    ([*OPTION, "coefficient=3", "--wall", "5e-3"], "--wall does not apply to a law with its own"),
    (["simulate", "--option", "n=2"], "one of nothing, as this law has no numbers to choose, got"),
    (["simulate", "--law", "steuermann", "--option", "n=0"], "n must be >= 1 and <= 50, got 0"),
    (["simulate", "--law", "power", "--option", "exponent=2"], "coefficient and exponent of the l"),
    (
        ["data", "show", "--r2-star", "7"],
        "(study data show lists them), such as 20, 20.1, ",
    ),
    (
        ["data", "show", "--case", "papr-small-200"],
        "such as paper-small-200, paper-small-20",
    ),
    (["data", "check", "--sample", 0], "--sample must be >= 1, got 0"),
    (["run", "-p", "r2_star=100"], "-p must be given with a NAME, for example: study run"),
    (["run", "fig10", "-p", "r2_star=210"], "must be one of 20, 40, 60, 80, 100, 120, 140, 16"),
    (["walk"], "No such command 'walk'"),
]


@pytest.mark.parametrize(("words", "message"), WRONG)
def test_wrong_input_is_one_line_and_status_2(run, monkeypatch, words, message):
    monkeypatch.chdir(paths.ROOT)
    status, out, err = run(*words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert message in err


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (["simulate", "--scene", "clearence=1e-5"], "clearance"),
        (["run", "fig10", "-p", "r2star=100"], "r2_star"),
        (["law", "hooke", "--r2-star", 200, "--depth-star", 0.1], None),
        (["run", "Fig.14"], "fig14"),
        (["run", "fig9"], "fig09"),
        (["run", "Figure 14"], "fig14"),
        (["run", "fig99"], None),
        (["run", "something-else-altogether"], None),
        (["measure", "--method", "lieu"], "liu"),
    ],
)
def test_a_wrong_name_is_answered_by_the_nearest_one(run, words, near):
    status, out, err = run(*words)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.endswith(f": did you mean {near}?\n") == bool(near)
    assert ("did you mean" in err) == bool(near)
