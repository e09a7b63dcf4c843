"""The command line, study: notebooks, paper, report, dataset, laws, joints and simulations.

A user's mistake is one line on standard error and exit status 2; a failure is exit status 1.
"""

import sys

import typer

from study import checks
from study.cli import build, joints, mechanism, stored  # noqa: F401  (each adds its commands)
from study.cli.options import INTERRUPTED, app

UsageError = typer.BadParameter.__base__  # of every wrong option or argument


def main():
    """Run the command line and exit with its status."""
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="replace")  # a line of "?" is better than none
    try:
        status = app(standalone_mode=False)
    except (UsageError, ValueError) as error:
        text = error.format_message() if isinstance(error, UsageError) else str(error)
        if text.startswith("Usage:"):  # a command group alone: its help is the answer
            print(text, file=sys.stderr)
            sys.exit(2)
        _complain(text, 2)
    except (checks.StudyError, OSError) as error:
        _complain(str(error), 1)
    if status == INTERRUPTED:
        _complain("interrupted; what was finished is kept", status)
    sys.exit(status or 0)


def _complain(text, status):
    print(f"study: {' '.join(text.split())}", file=sys.stderr)
    sys.exit(status)
