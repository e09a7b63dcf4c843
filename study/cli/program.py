"""The program, its commands, and how errors are reported.

The module of a command is loaded when the command is called.
"""

import os
import re
import sys
import warnings
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path

import click

COMMANDS = {
    "run": (
        "build",
        "Run the outdated notebooks and compare their results with the accepted ones.",
    ),
    "accept": ("build", "Accept results that differ: copy them to figures/."),
    "paper": ("build", "Typeset the article and its supplement."),
    "report": ("build", "Update all results, the article and the report."),
    "list": ("build", "List the figures and tables of the notebooks."),
    "data": ("data", "Show, check or rebuild the dataset of solved force-depth curves."),
    "measure": ("data", "Measure the speed of laws, solvers and steppers on this machine."),
    "joint": ("joint", "Solve one joint: force, depth, stiffness, pressure and stresses."),
    "law": ("laws", "Evaluate a contact law at given penetration depths."),
    "choose": ("laws", "Choose the fastest contact law that is accurate enough for a joint."),
    "fit": ("fit", "Compare the contact laws with your own curve, and fit unknown parameters."),
    "export": ("laws", "Export the contact law of one joint for use in another program."),
    "simulate": ("mechanism", "Simulate the crank-slider and list the impacts in its joint."),
    "sweep": ("sweep", "Solve many joints, or simulate many mechanisms, and write one table."),
}
"""Command -> its module, and a sentence on what it does."""
INTERRUPTED = 130  # status after Ctrl-C
_LISTED = re.compile(r"\b(one of (?P<known>.+)|is not one of (?P<words>.+)\.$)")
_ASKED = re.compile(r"\bgot '(?P<asked>[^'=]+)[^']*'$|: '(?P<word>[^']+)' is not one of")
_NEAR = 0.75  # similarity from which on a name is taken for a misspelling


class Program(click.Group):
    """The program, which loads the module of a command when it is needed."""

    def list_commands(self, ctx):
        """Names of the commands."""
        return list(COMMANDS)

    def get_command(self, ctx, name):
        """Command of a name, or None."""
        if name not in COMMANDS:
            return None
        from study.checks import UnitWarning  # late: the help of the program needs no NumPy

        warnings.simplefilter("ignore", UnitWarning)  # commands print the sentences
        return import_module(f"study.cli.{COMMANDS[name][0]}").COMMANDS[name]

    def format_commands(self, ctx, formatter):
        """Write the sentences on the commands."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, text) for name, (_, text) in COMMANDS.items()])


PROGRAM = Program(
    "study",
    help="Contact force laws for spherical clearance joints: solve a joint, choose and export a "
    "law, simulate a mechanism, and rebuild the results of the study.",
    epilog="Help on one command, with its options and an example: study joint --help",
    no_args_is_help=True,
)


def run():
    """Run the command line, and return its exit status."""
    root = Path(__file__).resolve().parents[2]
    for copied in Path(sys.argv[0]).resolve().parents[2:3]:  # above .venv/bin
        if copied != root and (copied / "study/paths.py").is_file():
            return _complain(
                f"the folder {copied} is a copy whose environment belongs to {root}; create a new "
                "environment with: make setup",
                1,
            )
    try:
        status = PROGRAM(standalone_mode=False)
        sys.stdout.flush()
    except click.exceptions.NoArgsIsHelpError as error:  # the help of a group is the answer
        print(error.format_message(), file=sys.stderr)
        return 2
    except click.ClickException as error:
        return _complain(_hinted(error.format_message()), 2)
    except ValueError as error:
        return _complain(_hinted(str(error)), 2)
    except BrokenPipeError:  # the reader, such as head, needs no more
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:  # its own text begins with a number
        return _complain(f"{error.filename}: {error.strerror}" if error.filename else str(error), 1)
    except MemoryError as error:
        return _complain(f"there is not enough memory: {error}".rstrip(": "), 1)
    except (click.Abort, KeyboardInterrupt) as error:
        return _complain(f"interrupted{error}", INTERRUPTED)
    except Exception as error:
        from study.checks import StudyError

        if not isinstance(error, StudyError):
            raise
        return _complain(str(error), 1)
    return status if isinstance(status, int) else 0


def _hinted(text):
    """A message with the most similar of the names that it lists, if it is a near miss."""
    listed, asked = _LISTED.search(text), _ASKED.search(text)
    if listed is None or asked is None:
        return text
    known = re.split(r", (?:got )?", listed["known"] or listed["words"])
    known = [name.strip("'") for name in known]
    near = get_close_matches(
        asked["asked"] or asked["word"], known[: -1 if listed["known"] else None], 1, _NEAR
    )
    return f"{text.rstrip('.')}: did you mean {near[0]}?" if near else text


def _complain(text, status):
    print(f"study: {' '.join(text.split())}", file=sys.stderr)
    return status
