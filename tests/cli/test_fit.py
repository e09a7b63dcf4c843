"""Curves of the user as files: heads, units and decimal commas."""

import numpy as np
import pytest

from study.cli.fit import curve_of

DEPTH, FORCE = np.linspace(1e-6, 20e-6, 9), np.linspace(100, 30000, 9)
HEADS = {
    "depth [mm],force [kN]": ("{:.6f},{:.6f}", 1e3, 1e-3),
    "depth (µm),note,force": ("{:.6f},seen,{:.6f}", 1e6, 1),
    "depth,force": ("{:.6f} µm,{:.6f}kN", 1e6, 1e-3),
}


@pytest.mark.parametrize("has_commas", [False, True])
@pytest.mark.parametrize("head", HEADS)
def test_units_are_read_from_heads_or_cells(tmp_path, head, has_commas):
    row, *factors = HEADS[head]
    pairs = np.transpose([DEPTH * factors[0], FORCE * factors[1]]).tolist()
    text = "\n".join([head, *(row.format(*pair) for pair in pairs)])
    if has_commas:
        text = text.replace(",", ";").replace(".", ",")
    (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
    values, is_star = curve_of(tmp_path / "curve.csv")
    assert values == pytest.approx(np.array([DEPTH, FORCE]))
    assert not is_star


BAD = {
    "s,force [N]\n1,2": "CURVE must have the columns depth and force, such as depth [um] and",
    "depth [inch],force\n1,2": "the unit of depth must be m with or without a prefix, or in, got i",
    "depth [um],depth [mm],force\n1,1,2": "each column must have a different name",
    "depth,force_star\n1,2": "got depth, force_star",
    "depth,force\n1,2\n2,": "force in row 2 must be a number in N",
    "depth [um],force\n1um,2": "row 1: depth [um] must be a number, got '1um'",
    "depth,force\n1,nan": "force in row 1 must be finite, got nan",
}


@pytest.mark.parametrize("text", BAD)
def test_what_is_no_curve(run, tmp_path, text):
    (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
    status, out, err = run("fit", tmp_path / "curve.csv")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert BAD[text] in err


def test_a_normalised_curve_of_a_joint_with_dimensions(run, tmp_path):
    rows = ["depth_star,force_star", *(f"{x:.3f},{800 * x**1.6:.3f}" for x in DEPTH / 40e-6)]
    (tmp_path / "curve.csv").write_text("\n".join(rows), encoding="utf-8")
    words = ["fit", tmp_path / "curve.csv"]
    sized = ["--socket-radius", "12.5mm", "--clearance", "40um", "--wall", "6mm"]
    plot = tmp_path / "laws.png"
    status, out, err = run(*words, *sized, "--plot", plot)
    assert (status, err, plot.stat().st_size > 1000) == (0, "", True)
    relative = dict(line.split(",")[::3][:2] for line in out.splitlines())
    _, of_ratios, _ = run(*words, "--r2-star", 312.5, "--socket-ratio", 1.48)
    same = dict(line.split(",")[::3][:2] for line in of_ratios.splitlines())
    assert float(relative["hertz"]) == pytest.approx(float(same["hertz"]))
