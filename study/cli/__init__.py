"""The command line, study: notebooks, paper, report, dataset, laws, joints and simulations.

Wrong input is reported in one line on standard error, with exit status 2. Other failures have exit
status 1.
"""

import sys


def main():
    """Run the command line and exit with its status."""
    if sys.stdout is None or sys.stderr is None:  # a shell's >&- closes them
        if sys.stderr is not None:
            print("study: the standard output is closed; give it a file", file=sys.stderr)
        sys.exit(1)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="replace")  # a line with "?" is better than none
    try:
        from study.cli.program import run  # late: Ctrl-C while packages load is one line, too

        status = run()
    except KeyboardInterrupt:
        print("study: interrupted", file=sys.stderr)
        status = 130
    sys.exit(status)
