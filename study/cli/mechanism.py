"""The command for the crank-slider: simulate."""

from functools import partial
from inspect import signature
from pathlib import Path
from typing import get_args

from study import compiled
from study.checks import StudyError
from study.choose.model import QUANTITIES, choose_model
from study.cli import options as cli
from study.cli.output import check_output, show, table_of, working
from study.contact import LAWS, SOCKET_RATIO
from study.joint import limits
from study.joint.options import PARAMETERS
from study.mechanism import MechanismError, Scene, compare
from study.mechanism.law_in_scene import LAW, of_name
from study.mechanism.response import IMPACT_COLUMNS, exceeded_limits
from study.mechanism.simulate import Model, simulate
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
SOCKET = ("wall", "socket_ratio", "liner")
"""Options that describe the socket of the clearance joint."""
_KEYS = ", ".join(f"{name} ({about.unit or '-'})" for name, about in described(Scene).items())
_OF = {of.name: of for of in cli.options_of(simulate, *described(simulate)) if of.name != "scene"}


@cli.command(
    "simulate",
    {
        "Mechanism and joint": [
            cli.option(
                "--scene",
                "Change a mechanism parameter, as KEY=VALUE; may be repeated. The keys and their "
                f"units are: {_KEYS}. With the default damping, exact, an impact has the given "
                "coefficient of restitution; the other models are lankarani-nikravesh (which Yao "
                "et al. use), hunt-crossley and flores.",
                multiple=True,
            ),
            _OF["joint"],
            cli.option(
                "--law",
                f"Contact law: {', '.join(LAWS)}. tabulated is a table of the joint's elastic "
                "solution. Default: stiffened_hertz, or tabulated if --wall or --liner is given.",
                tuple(LAWS),
            ),
            cli.LAW_NUMBER,
            *(cli.option_of(name, PARAMETERS[name]) for name in SOCKET),
        ],
        "Model of the links": [
            cli.option(
                "--model",
                "Model of the links: rigid, particles or beams; auto picks the simplest model "
                "within --tolerance. Default: rigid.",
                (*get_args(Model), "auto"),
            ),
            _OF["elements"],
            _OF["method"],
            cli.option(
                "--quantity",
                "With --model auto: part of the slider's motion whose error --tolerance limits. "
                "Default: slider_position.",
                QUANTITIES,
            ),
        ],
        "Time and accuracy": [
            _OF["duration"],
            _OF["outputs"],
            _OF["tolerance"],
            _OF["step"],
            cli.switch(
                "--once",
                "Do not repeat the simulation at a second tolerance. The repetition shows until "
                "when the motion does not depend on the tolerance.",
            ),
        ],
        "Output": [
            cli.JSON,
            cli.option("--output", "CSV file for the motion over time.", Path),
        ],
    },
    examples=[
        "simulate --scene clearance=100um --duration 50ms --output motion.csv",
        "simulate --model auto --tolerance 0.01 --duration 50ms",
    ],
)
def simulate_mechanism(as_json, once, scene=(), option=(), output=None, **options):
    """Simulate a crank-slider with a clearance joint: the final state and every impact.

    A number may have its unit, such as 100um, and is in SI units without one. By default the
    mechanism has the dimensions, masses and drive of Yao et al., section 4.3, and rigid links.
    Contact law and damping are those of this study; for theirs, give --law hyperbolic_winkler
    --scene damping=lankarani-nikravesh.

    With --model auto, rigid links and links of particles are run, and the simplest model is used
    whose --quantity differs from that of a finer one by at most --tolerance. This is the RMS
    difference divided by the RMS change of the quantity since t = 0.
    """
    changed = Scene(**cli.key_values("scene", scene, described(Scene)))
    check_output(output, ".csv")
    if "elements" in options:
        options["elements"] = described(simulate)["elements"].read("elements", options["elements"])
    socket = {name: options.pop(name) for name in SOCKET if name in options}
    if option:
        cli.left_out(socket, (), "a law with its own numbers (--option)")
        options["law"] = cli.law_of(options.get("law", LAW), option)
    elif socket:
        options["law"] = of_name(changed, options.get("law"), **socket)
    parameters = signature(simulate).parameters
    model, total = (options.get(name, parameters[name].default) for name in ("model", "duration"))
    choice, run = None, partial(simulate, changed, **options)
    if model != "auto":
        cli.left_out(options, parameters, f"model {model}")
    else:
        del options["model"]
        allowed = signature(choose_model).parameters
        cli.left_out(options, allowed, "model auto, which chooses it")
        if "tolerance" not in options:
            raise ValueError(
                "--tolerance must be given with --model auto: it is the maximum error of the "
                "simplified model"
            )
        with working("Choosing the model"):
            choice = choose_model(changed, **options)
        run = choice.simulate
    is_compiled = any(compiled.folder().rglob("*.nbc"))
    failed = None
    with working(
        "Simulating" if is_compiled else "Compiling the time integration (only once)"
    ) as tell:
        try:
            response = run(progress=lambda time: tell(f"simulated {time:.4g} of {total:g} s"))
        except MechanismError as error:
            if error.response is None:
                raise
            failed, response = error, error.response
    agreement = (None, [])
    if not once and not failed:
        with working("Repeating the simulation at a second tolerance"):
            agreement = _agreement(response, run)
    exceeded = exceeded_limits(changed, response, socket.get("socket_ratio", SOCKET_RATIO))
    _show(response, choice, agreement, exceeded, as_json)
    if output is not None:  # last, so that the results are printed even if the disk is full
        response.save(output)
    if failed is not None:
        raise failed
    if not response.complete:
        raise cli.InterruptionError(cli.KEPT)


def _agreement(response, run):
    """Until when a second run agrees with the first one, as an object and as sentences.

    The response is shown even if the second run is interrupted or fails.
    """
    try:
        agreement = compare.second_run(response, run)
    except KeyboardInterrupt:
        return None, [
            "The run at a second tolerance, which shows until when the motion can be predicted, "
            "was interrupted."
        ]
    except StudyError as error:
        return None, [f"The run at a second tolerance failed: {error}."]
    if agreement is None:
        return None, []
    end, later = "to the end", ""
    if not agreement.lasts:
        end = f"until {agreement.until:.6g} s"
        later = " From then on the motion is chaotic and cannot be predicted."
    text = (
        f"A run at a second tolerance agrees {end}: the eccentricities differ by at most "
        f"{agreement.largest_distance:.1g} clearances, and the forces by a fraction of at most "
        f"{agreement.force_difference:.1g}.{later}"
    )
    return agreement._asdict(), [text]


def _show(response, choice, agreement, exceeded, as_json):
    """Show the chosen model, the end of the motion and the impacts."""
    end = {head: float(getattr(response, name)[-1]) for head, name in END.items()}
    end["contacts"] = response.contacts
    end["last_separation s"] = response.last_separation
    end |= {name: getattr(response, name) for name in ("energy_error", "complete")}
    names = response.impact_rows.dtype.names
    rows = [
        {name: None if x != x else x for name, x in zip(names, row, strict=True)}  # no NaN in JSON
        for row in response.impact_rows.tolist()
    ]
    asked, delivered = response.restitution, response.delivered_restitution
    values = {head.split()[0]: value for head, value in end.items()}
    values |= {"law": str(response.law or "none"), "restitution": asked}
    values |= {"delivered_restitution": delivered, "agreement": agreement[0]}
    values["applicability"] = limits.in_short(exceeded)
    parts = [f"Law: {values['law']}.", {head: [value] for head, value in end.items()}]
    if choice:
        values["choice"] = {name: of for name, of in vars(choice).items() if name != "simulate"}
        parts[:0] = [
            "The simplest model that is accurate enough for the "
            f"{choice.quantity.replace('_', ' ')} over {end['time s']:g} s: {choice.model} links, "
            f"{choice.joint} joint. It differs from a finer model by {choice.error:.2g}.\nModels "
            "in order of detail (error is the difference to a finer model; relative_cost is the "
            "computing time, measured now):",
            table_of(choice.evidence),
        ]
    units = {name: of.unit for name, of in IMPACT_COLUMNS.items()}
    parts.append(
        {
            f"{name} {units.get(name, '')}": [row[name] for row in rows[:SHOWN]]
            for name in ("time", *names)
        }
    )
    if rows and abs(delivered - asked) > 0.005:
        parts.append(
            f"Warning: The damping model gives a coefficient of restitution of {delivered:.3g} "
            f"instead of {asked:g}."
        )
    if len(rows) > SHOWN:
        parts.append(f"{len(rows) - SHOWN} more contacts are not shown; --json prints all.")
    parts += [f"Warning: {text}" for text in exceeded.values()]
    show(values | {"impacts": rows}, as_json, *parts, *agreement[1])


COMMANDS = {"simulate": simulate_mechanism}
