"""The command for a curve of your own: study fit."""

import json
import re

import numpy as np
import pytest

from study import paths
from study.choose import fit_curve
from study.joint import Joint

SIZES = ["--socket-radius", 12.5e-3, "--clearance", 40e-6, "--wall", 6e-3, "--socket", "bronze"]
MADE = paths.ROOT / "examples/fit_your_curve.csv"
STAR = [(0, 0), (0.1, 14), (0.2, 45), (0.3, 88), (0.4, 141), (0.5, 205)]


@pytest.fixture
def written(tmp_path):
    """Path of a CSV file with a head and rows."""

    def write(head, rows=STAR, separator=","):
        lines = [head, *(separator.join(map(str, row)) for row in rows)]
        (tmp_path / "curve.csv").write_text("\n".join(lines), encoding="utf-8")
        return tmp_path / "curve.csv"

    return write


def test_the_command_prints_what_the_function_returns(run):
    fit = ["--fit", "offset", "--fit", "clearance"]
    status, out, err = run("fit", MADE, *SIZES, *fit, "--json")
    assert (status, err) == (0, "")
    found, (depth, force) = json.loads(out), np.loadtxt(MADE, delimiter=",", skiprows=1).T
    joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
    expected = fit_curve(1e-6 * depth, force, joint, ("offset", "clearance"))
    assert [of["law"] for of in found["laws"]] == [of.law for of in expected.laws]
    assert found["laws"][0]["parameters"] == pytest.approx(expected.laws[0].parameters)
    assert found["power"]["exponent"] == pytest.approx(expected.power.exponent)
    assert found["left_out"] == expected.left_out
    _, out, _ = run("fit", MADE, *SIZES, *fit)
    assert "43.876" in next(line for line in out.splitlines() if line.startswith("tabulated"))
    assert "the standard error of n is 0.0082" in out
    assert re.search("hertz, steuermann: its best clearance is .* 0.333 to 3 times", out)


@pytest.mark.parametrize(
    ("head", "factors", "words"),
    [
        ("depth [mm],force [kN]", (1e3, 1e-3), ()),
        ("Depth (µm);Force_N", (1e6, 1), ()),
        ("depth/m\tforce", (1, 1), ("--force-unit", "N")),
        (
            "s,F in kN",
            (1e6, 1e-3),
            ("--depth-column=s", "--force-column=F in kN", "--depth-unit=um"),
        ),
    ],
)
def test_units_and_columns(run, written, head, factors, words):
    depth = np.linspace(1e-6, 20e-6, 9)
    rows = np.column_stack([depth, 1e12 * depth**1.6]) * factors
    separator = next(sign for sign in ";\t," if sign in head)
    power = json.loads(run("fit", written(head, rows, separator), *words, "--json")[1])["power"]
    assert (power["exponent"], power["coefficient"]) == pytest.approx((1.6, 1e12), rel=1e-6)
    assert power["depths"] == pytest.approx([1e-6, 20e-6])


def test_decimal_commas_and_units_in_cells(run, tmp_path):
    path = tmp_path / "curve.csv"
    depth = np.linspace(1, 20, 9)
    force = 1e12 * (1e-6 * depth) ** 1.6
    pairs = [*zip(depth.tolist(), force.tolist(), strict=True)]
    tables = [
        [
            "depth [um];force [kN]",
            *(f"{d!r};{f / 1e3!r}" for d, f in pairs),
        ],
        ["depth\tforce", *(f"{d!r}um\t{f!r} N" for d, f in pairs)],
        ["depth\tforce", *(f"{d!r} µm\t{f!r}N" for d, f in pairs)],
    ]
    for lines in tables:
        path.write_text("\n".join(lines).replace(".", ","), encoding="utf-8")
        power = json.loads(run("fit", path, "--json")[1])["power"]
        assert (power["exponent"], power["coefficient"]) == pytest.approx((1.6, 1e12), rel=1e-6)


def test_constants_of_the_user_are_compared_with_the_elastic_solution(run):
    joint = Joint(12.5e-3, 40e-6, 6e-3, socket="bronze")
    fit = joint.power_law()
    constants = f"{1.1 * fit.coefficient_mm!r},{fit.exponent!r}"
    words = ("--try-power", constants, "--units", "mm")
    found = json.loads(run("fit", *SIZES, *words, "--json")[1])
    assert found["coefficient"] == pytest.approx(1.1 * fit.coefficient)
    assert found["max_error"] == pytest.approx(0.1 + 1.1 * fit.error, rel=0.02)
    assert 0.09 < found["rms_error"] < 0.11
    assert "differs from the elastic solution" in run("fit", *SIZES, *words)[1]
    with_curve = json.loads(run("fit", MADE, *SIZES, *words, "--fit", "offset", "--json")[1])
    assert with_curve["tried"]["depths"] == with_curve["power"]["depths"]


def test_a_curve_in_clearances(run, written, tmp_path):
    path, plot = written("depth_star,force_star"), tmp_path / "plot.png"
    alone = json.loads(run("fit", path, "--json")[1])
    assert [of["law"] for of in alone["laws"]] == ["power"]
    status, out, err = run("fit", path, "--r2-star", 200, "--plot", plot)
    assert (status, err, plot.exists()) == (0, "", True)
    assert "from 0.1 to 0.5: n = 1.6661 and k = 653.11." in out
    assert "hertz" in out
    sized = json.loads(run("fit", path, *SIZES, "--json")[1])
    assert len(sized["laws"]) > 5


BAD = {
    "": "must have a line of column names and a row for each point",
    "depth um,force N\n": "must have a line of column names and a row for each point",
    "depth um,force N\n1,2\n2,nan": "force in row 2 must be a finite number, got nan",
    "depth um,force N\n1,2\n2,": "force in row 2 must be a number, got ''",
    "depth um,force N\n1,2\n2": "row 2 must have 2 cells",
    "depth um,depth mm,force N\n1,1,2": "depth um, depth mm; select one with --depth-column",
    "x,force N\n1,2": "no column is named depth; select one of x, force N with --depth-column",
    "depth,force N\n1,2": "the unit of the column depth must be m with or without a prefix",
    "depth um,force_star\n1,2": "got the units um and none",
    "depth um,force N\n1,2\n": "the same length >= 4",
}


@pytest.mark.parametrize("text", BAD)
def test_bad_files(run, tmp_path, text):
    path = tmp_path / "curve.csv"
    path.write_text(text, encoding="utf-8")
    status, out, err = run("fit", path, *SIZES)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert BAD[text] in err
