"""The command for the crank-slider: simulate."""

import sys
from dataclasses import fields
from functools import partial
from inspect import signature
from pathlib import Path

from study import checks
from study.cli.options import KEPT, InterruptionError, check_output, command, left_out
from study.cli.output import bar, named_fields, show, waiting

SHOWN = 20  # impacts in a printed table
END_UNITS = {
    "time": "s",
    "theta": "rad",
    "x_slider": "m",
    "v_slider": "m/s",
    "a_slider": "m/s^2",
    "last_separation": "s",
}


@command(
    "simulate",
    "study.mechanism:simulate model joint law duration outputs tolerance step elements method",
    "study.choose:choose_model quantity socket_ratio",
)
def simulate_mechanism(
    scene: list[str] = (),
    inertia: str = "rods",
    output: Path | None = None,
    as_json: bool = False,
    **given,
):
    """Simulate the crank-slider: where it is at the end, and every impact (SI units).

    --model auto takes the simplest model within --tolerance. This is then the largest error of the
    --quantity: its RMS over that of the change since t = 0.
    """
    from study import mechanism
    from study.choose import choose_model
    from study.compiled import CACHE
    from study.mechanism.response import IMPACT_COLUMNS

    changed = _scene(scene, inertia)
    check_output(output, ".csv")
    if "elements" in given:
        given["elements"] = checks.read_several("--elements", given["elements"], kind=int)
    if sys.stderr.isatty() and not any(CACHE.rglob("*.nbi")):
        print("Compiling the stepping loops, once ...", file=sys.stderr)
    auto = given.get("model") == "auto"
    options = signature(choose_model if auto else mechanism.simulate).parameters
    model = given.pop("model") if auto else given.get("model", options["model"].default)
    why = f"model {model} {'chooses it' if auto else 'has none'}"
    of_law = {"socket_ratio"} if given.get("law") == "stiffened_hertz" else set()
    left_out(sorted(given.keys() - options - of_law), given, why)
    if auto and "tolerance" not in given:
        raise ValueError("tolerance must be given: the largest error that model auto may make")
    with waiting("Choosing the model"):
        choice = choose_model(changed, **given) if auto else None
    run = choice.simulate if auto else partial(mechanism.simulate, changed, **given)
    with bar("simulated {task.completed:.4g} of {task.total:g} s") as shown:
        task = shown.add_task("", total=given.get("duration", options["duration"].default))
        response = run(progress=lambda time: shown.update(task, completed=time))
    last = response.motion.iloc[-1]
    end = {
        "time": last.time,
        "theta": last.crank_angle,
        "x_slider": last.slider_position,
        "v_slider": last.slider_velocity,
        "a_slider": last.slider_acceleration,
        "contacts": len(response.impacts),
        "last_separation": response.last_separation,
        "energy_error": response.energy_error,
        "complete": response.complete,
    }
    impacts = response.impacts.astype(object).where(response.impacts.notna(), None)
    columns, rest = sorted(impacts, key=lambda name: name != "time"), len(impacts) - SHOWN
    show(
        end
        | {"law": response.law}
        | ({"choice": named_fields(choice)} if choice else {})
        | {"impacts": impacts.to_dict("records")},
        as_json,
        *(_told(choice, last.time) if choice else []),
        f"Law {response.law}.",
        {f"{name} {END_UNITS.get(name, '')}": [value] for name, value in end.items()},
        {f"{name} {IMPACT_COLUMNS.get(name, '')}": impacts[name].head(SHOWN) for name in columns},
        *([f"{rest} more contacts: --json prints all."] if rest > 0 else []),
    )
    if output is not None:  # last, so that the results are printed even if the disk is full
        response.save(output)
    if not response.complete:
        raise InterruptionError(KEPT)


def _told(choice, duration):
    """The chosen model in words, and all models that were compared."""
    names = ("model", "joint", "law", "settings", "error_bound", "relative_cost", "links")
    return [
        f"The simplest model whose {choice.quantity.replace('_', ' ')} is known well enough over "
        f"{duration:g} s:\n{choice.model} links, {choice.joint} joint, law {choice.law}, within "
        f"{choice.error_bound:.2g}. In order of detail (costs: times here):",
        {name: [row[name] for row in choice.evidence] for name in names},
        f"At a depth of {choice.depth_star:.2g} clearances the links have "
        f"{choice.compliance_ratio:.2g} times the contact's compliance. The slider's frequency on "
        f"the contact is {choice.frequency_ratio:.2g} times the crank's axial one.",
        *([f"Particles were run, as {choice.note}."] if choice.note else []),
    ]


def _scene(settings, inertia):
    """The paper's scene with settings ``KEY=VALUE`` and the inertias changed."""
    from study.mechanism import Scene

    known, texts = [field.name for field in fields(Scene)], {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals or key not in known:
            names = ", ".join(known)
            raise ValueError(f"--scene must be KEY=VALUE with KEY one of {names}, got {setting!r}")
        texts[key] = text
    rods = {"crank_inertia": None, "coupler_inertia": None}
    if inertia != "rods":
        rods = dict(zip(rods, checks.read_several("--inertia", inertia), strict=True))
    return Scene.read(texts, **rods)
