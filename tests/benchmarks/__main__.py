"""Times the charts of speed, and keeps the times: run by ``make speed``.

``python -m benchmarks laws steppers`` times some of them.
"""

import sys

from benchmarks import second
from benchmarks.others import OTHERS
from study import checks
from study.dataset import store
from study.measure import charts

if __name__ == "__main__":
    known = (*charts.CHARTS, "second")
    chosen = [checks.choice("chart", name, known) for name in sys.argv[1:]]
    store.verify()  # before minutes of timing
    for chart in chosen or known:
        frame = second.timed() if chart == "second" else charts.timed(chart, [*OTHERS[chart]()])
        store.keep_measured(frame)
        programs = ", ".join(frame.program.unique())
        print(f"timed {chart} of {programs} on {frame.machine.iloc[0]}", flush=True)
