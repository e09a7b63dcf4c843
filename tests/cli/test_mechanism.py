"""The command for the crank-slider: its numbers are the library's, and agree at two tolerances."""

import json
import re
from functools import wraps

import pandas as pd
import pytest

from study.contact import Steuermann
from study.mechanism import MechanismError, Scene, compare, simulate


def test_simulate_prints_the_end_and_every_impact(run):
    words = ["--model", "rigid", "--joint", "clearance", "--law", "hertz", "--duration", 0.1]
    status, out, err = run("simulate", *words, "--json")
    assert (status, err) == (0, "")
    found, response = json.loads(out), simulate(law="hertz")
    assert found["x_slider"] == response.slider_position[-1]
    assert found["theta"] == response.crank_angle[-1]
    assert {"v_slider", "a_slider", "energy_error"} < set(found)
    assert len(found["impacts"]) == len(response.impacts) > 3
    first = found["impacts"][0]
    assert first["time"] == response.impacts.time[0]
    assert {"approach_speed", "peak_force"} < set(first)
    assert found["impacts"][-1]["separation_speed"] is None


def test_simulate_takes_mechanism_parameters_and_settings(run, tmp_path):
    table = tmp_path / "motion.csv"
    words = ["--scene", "crank_inertia=1e-4", "--scene", "coupler_inertia=3e-4"]
    words += ["--scene", "restitution=0.9", "--duration", 0.004, "--output", table]
    words += ["--model", "particles", "--elements", "2,4", "--method", "lagged"]
    status, out, _ = run("simulate", *words, "--json")
    assert status == 0
    scene = Scene(restitution=0.9, crank_inertia=1e-4, coupler_inertia=3e-4)
    options = {"model": "particles", "elements": (2, 4), "method": "lagged", "duration": 0.004}
    response = simulate(scene, **options)
    assert json.loads(out)["x_slider"] == response.slider_position[-1]
    assert pd.read_csv(table).slider_position.to_numpy() == pytest.approx(
        response.motion.slider_position.to_numpy(), rel=1e-11
    )


def test_simulate_states_its_law_of_the_joint_of_the_scene(run):
    words = ("simulate", "--duration", "0.002", "--once")
    bodies = ("--scene", "ball=steel", "--scene", "socket=bronze")

    def law(*more):
        return json.loads(run(*words, *more, "--json")[1])["law"]

    sizes = "Joint(socket_radius=0.01, clearance=5e-05, wall="
    assert law("--law", "tabulated").startswith(f"tabulated of {sizes}0.00298, ")
    assert law("--wall", "5e-3").startswith(f"tabulated of {sizes}0.005, ")
    assert "liner=0.0005,500000000,0.46" in law("--liner", "0.5e-3,PTFE", "--wall", "3e-3")
    stiffened = ("--law", "stiffened_hertz", "--socket-ratio", "1.5", *bodies)
    told = f"stiffened_hertz of {sizes}0.005, ball=steel, socket=bronze, rim=mirror)"
    assert law(*stiffened) == told
    assert run(*words, *stiffened)[1].startswith(f"Law: {told}.\n")
    assert law("--joint", "ideal") == "none"


def test_simulate_gives_a_law_its_numbers(run):
    words = ("simulate", "--duration", "0.002", "--once", "--json")
    options = ("--law", "steuermann", "--option", "n=2", "--option", "radius=profile")
    found = json.loads(run(*words, *options)[1])
    response = simulate(law=Steuermann(2, "profile"), duration=0.002)
    assert found["law"] == repr(response.law) == "Steuermann(n=2, radius=profile)"
    assert found["impacts"][0]["peak_force"] == response.impacts.peak_force[0]


def test_simulate_says_which_restitution_is_delivered(run):
    words = ("simulate", "--duration", "0.002", "--once")
    paper = (*words, "--scene", "damping=lankarani-nikravesh")
    assert re.search(r"^Warning: .* restitution of 0\.725 instead of 0\.5\.$", run(*paper)[1], re.M)
    assert "restitution of" not in run(*words)[1]
    assert "restitution of" not in run(*paper, "--joint", "ideal")[1]
    for command, delivered in ((words, 0.5), (paper, 0.72524)):
        found = json.loads(run(*command, "--json")[1])
        assert found["restitution"] == 0.5
        assert found["delivered_restitution"] == pytest.approx(delivered, abs=1e-5)


def test_simulate_says_how_far_it_can_be_trusted(run):
    told = run("simulate", "--duration", "0.01")[1].splitlines()[-1]
    assert "at a second tolerance agrees to the end: " in told
    agreement = json.loads(run("simulate", "--duration", "0.01", "--json")[1])["agreement"]
    assert (agreement["lasts"], agreement["impacts"]) == (True, [5, 5])
    scene = ("--scene", "restitution=1", "--scene", "friction=0")
    told = run("simulate", *scene)[1].splitlines()[-1]
    assert re.search(r"agrees until 0\.0\d+ s: .* chaotic", told)
    assert json.loads(run("simulate", "--joint", "ideal", "--json")[1])["agreement"] is None


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (KeyboardInterrupt(), "The run at a second tolerance, .* was interrupted"),
        (MechanismError("no step"), "The run at a second tolerance failed: no step"),
    ],
)
def test_a_second_run_that_ends_early_loses_nothing(run, tmp_path, monkeypatch, error, told):
    def second_run(*_):
        raise error

    monkeypatch.setattr(compare, "second_run", second_run)
    output = tmp_path / "motion.csv"
    status, out, _ = run("simulate", "--duration", "0.01", "--output", output)
    assert status == 0
    assert f"{simulate(duration=0.01).impacts.peak_depth[0]:.6g}" in out
    assert re.match(told, out.splitlines()[-1])
    assert output.is_file()
    assert "second tolerance" not in run("simulate", "--duration", "0.01", "--once")[1]


def test_simulate_auto_tells_what_it_chose(run):
    words = ["--model", "auto", "--tolerance", 0.001, "--duration", 0.05]
    status, out, err = run("simulate", *words, "--json")
    assert (status, err) == (0, "")
    choice = json.loads(out)["choice"]
    assert choice["error"] <= 0.001
    assert [row["model"] for row in choice["evidence"]][:2] == ["rigid", "rigid"]
    words += ["--quantity", "slider_velocity", "--tolerance", 0.1, "--law", "hertz"]
    _, out, _ = run("simulate", *words)
    assert re.match(r"The simplest model .* slider velocity over 0\.05 s: rigid links", out)


def test_an_interrupted_simulation_prints_and_writes_what_it_has(run, tmp_path, monkeypatch):
    @wraps(simulate)
    def interrupted(*words, progress, **options):
        def stop(time):
            if time > 0.02:
                raise KeyboardInterrupt

        return simulate(*words, progress=stop, **options)

    monkeypatch.setattr("study.cli.mechanism.simulate", interrupted)
    table = tmp_path / "motion.csv"
    status, out, err = run("simulate", "--json", "--output", table)
    assert (status, err) == (130, "study: interrupted; what was finished is kept\n")
    found = json.loads(out)
    assert not found["complete"]
    assert 0.02 < found["time"] <= 0.1  # told now and then
    assert pd.read_csv(table).time.iloc[-1] == pytest.approx(found["time"])
