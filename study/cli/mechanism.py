"""The command for the crank-slider: simulate."""

from functools import partial
from inspect import signature
from pathlib import Path
from typing import Literal, get_args

from study import compiled, paths
from study.checks import StudyError
from study.choose import choose_model
from study.choose.links import QUANTITIES
from study.cli import options as cli
from study.cli.output import columns, named_fields, show, working
from study.contact import LAWS, SOCKET_RATIO
from study.joint import DimensionalJoint, RatioJoint, applicability
from study.mechanism import Scene, compare
from study.mechanism.response import IMPACT_COLUMNS
from study.mechanism.simulate import Model, simulate
from study.mechanism.validity import exceeded_limits
from study.parameters import described

SHOWN = 20  # impacts in a printed table
END = {
    "time s": "time",
    "theta rad": "crank_angle",
    "x_slider m": "slider_position",
    "v_slider m/s": "slider_velocity",
    "a_slider m/s^2": "slider_acceleration",
}
"""What is printed of the end -> the response's column."""
SCENE = (
    "KEY=VALUE of a mechanism parameter; may be repeated; KEY (unit): "
    + ", ".join(f"{name} ({about.unit or '-'})" for name, about in described(Scene).items())
    + ". The default damping, exact, delivers the restitution; others are lankarani-nikravesh (the "
    "paper's), hunt-crossley and flores."
)
_SETTINGS = ("joint", "duration", "outputs", "tolerance", "step", "elements", "method")
OPTIONS = {
    "model": cli.further(
        Literal[(*get_args(Model), "auto")],
        "Model of the links: rigid, particles or beams; auto picks the simplest within "
        "--tolerance. [default: rigid]",
    ),
    "law": cli.further(
        Literal[(*LAWS, "tabulated")],
        "Contact law; tabulated, the default beside --wall or --liner, is the table of the "
        "solved joint. [default: stiffened_hertz]",
    ),
    **cli.options_of(simulate, *_SETTINGS),
    **cli.options_of(DimensionalJoint, "wall", "liner"),
    **cli.options_of(RatioJoint, "socket_ratio"),
    "quantity": cli.further(
        Literal[QUANTITIES],
        "Part of the slider's motion that --tolerance is for. [default: slider_position]",
    ),
}
"""A simulation, and the choice of its model."""


@cli.command("simulate")
def simulate_mechanism(
    scene: list[str] = cli.option(SCENE, default=()),
    output: Path = cli.OUTPUT,
    as_json: bool = cli.JSON,
    once: bool = cli.switch(
        "--once", "Leave out the second run, which says how far to trust the first."
    ),
    **options: OPTIONS,
):
    """Simulate the crank-slider: where it is at the end, and every impact (SI units).

    --model auto takes the simplest model within --tolerance. This is then the largest error of the
    --quantity: its RMS over that of the change since t = 0.
    """
    changed = _scene(scene)
    cli.check_output(output, ".csv")
    if "elements" in options:
        options["elements"] = described(simulate)["elements"].read("elements", options["elements"])
    if options.keys() & {"wall", "liner"}:
        options.setdefault("law", "tabulated")
    parameters = signature(simulate).parameters
    if options.get("model") == "auto":
        choice = _choice(changed, **options)
        run = choice.simulate
    else:
        choice, run = None, partial(simulate, changed, **options)
        why = f"model {options.get('model', parameters['model'].default)} has none"
        cli.left_out(options, [*parameters, "socket_ratio", "wall", "liner"], why)  # of some laws
    total = options.get("duration", parameters["duration"].default)
    is_compiled = compiled.is_kept(paths.ROOT / "study/mechanism/rigid.py")
    with working("Simulating" if is_compiled else "Compiling the stepping loops, once") as tell:
        response = run(progress=lambda time: tell(f"simulated {time:.4g} of {total:g} s"))
    end = {head: float(getattr(response, name)[-1]) for head, name in END.items()}
    end |= {
        "contacts": len(response.impact_rows),
        "last_separation s": response.last_separation,
        "energy_error": response.energy_error,
        "complete": response.complete,
    }
    exceeded = exceeded_limits(changed, response, options.get("socket_ratio", SOCKET_RATIO))
    with working("Simulating once more, at another tolerance"):
        trust = (None, []) if once else _trust(response, run)
    _show(end, response, choice, trust, exceeded, as_json)
    if output is not None:  # last, so that the results are printed even if the disk is full
        response.save(output)
    if not response.complete:
        raise cli.InterruptionError(cli.KEPT)


def _trust(response, run):
    """How long a second run is the same motion, as an object and in words.

    The response is shown even where the second run is interrupted or fails.
    """
    try:
        agreement = compare.second_run(response, run)
    except KeyboardInterrupt:
        return None, ["The second run, which says how far to trust this one, was interrupted."]
    except StudyError as error:
        return None, [f"A second run, at another tolerance, failed: {error}."]
    if agreement is None:
        return None, []
    end, later = "to the end", ""
    if not agreement.lasts:
        end = f"until {agreement.until:.6g} s"
        later = " What follows is one of many motions that begin alike: tiny errors grow."
    text = (
        f"A second run, at another tolerance, is the same motion {end}: the eccentricities differ "
        f"by at most {agreement.largest_distance:.1g} clearances, the forces by "
        f"{agreement.force_difference:.1g}.{later}"
    )
    return agreement._asdict(), [text]


def _choice(scene, model, **options):
    cli.left_out(options, signature(choose_model).parameters, f"model {model} chooses it")
    if "tolerance" not in options:
        raise ValueError("tolerance must be given: the largest error that model auto may make")
    with working("Choosing the model"):
        return choose_model(scene, **options)


def _show(end, response, choice, trust, exceeded, as_json):
    names = response.impact_rows.dtype.names
    rows = [
        {name: None if x != x else x for name, x in zip(names, row, strict=True)}  # no NaN in JSON
        for row in response.impact_rows.tolist()
    ]
    asked, delivered = response.restitution, response.delivered_restitution
    values = {head.split()[0]: value for head, value in end.items()} | {"law": response.law}
    values |= {"restitution": asked, "delivered_restitution": delivered}
    agreement, in_words = trust
    values |= {"agreement": agreement, "applicability": applicability.in_short(exceeded)}
    table = {
        f"{name} {IMPACT_COLUMNS.get(name, '')}": [row[name] for row in rows[:SHOWN]]
        for name in ("time", *names)
    }
    parts = [f"Law {response.law}.", {head: [value] for head, value in end.items()}, table]
    if choice:
        values["choice"] = named_fields(choice)
        parts = [*_in_words(choice, end["time s"]), *parts]
    if rows and abs(delivered - asked) > 0.005:
        parts.append(f"Damping delivers the restitution {delivered:.3g}, not {asked:g}.")
    if len(rows) > SHOWN:
        parts.append(f"{len(rows) - SHOWN} more contacts: --json prints all.")
    parts += [f"Beyond a limit: {text}" for text in exceeded.values()]
    show(values | {"impacts": rows}, as_json, *parts, *in_words)


def _in_words(choice, duration):
    """The chosen model in words, and all models that were compared."""
    return [
        f"The simplest model whose {choice.quantity.replace('_', ' ')} is known well enough over "
        f"{duration:g} s:\n{choice.model} links, {choice.joint} joint, law {choice.law}, within "
        f"{choice.error_bound:.2g}. In order of detail (costs: times here):",
        columns(choice.evidence),
        f"At a depth of {choice.depth_star:.2g} clearances the links have "
        f"{choice.compliance_ratio:.2g} times the contact's compliance. The slider's frequency on "
        f"the contact is {choice.frequency_ratio:.2g} times the crank's axial one.",
        *([f"Particles were run, as {choice.note}."] if choice.note else []),
    ]


def _scene(settings):
    known, values = described(Scene), {}
    for setting in settings:
        key, equals, text = setting.partition("=")
        if not equals or key not in known:
            names = ", ".join(known)
            raise ValueError(f"--scene must be KEY=VALUE with KEY one of {names}, got {setting!r}")
        values[key] = known[key].read(key, text)
    return Scene(**values)
