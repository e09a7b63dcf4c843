"""Times the charts of speed, and keeps the times: run by ``make speed``.

``python -m benchmarks laws steppers`` times some of them.
"""

import sys

from benchmarks.others import OTHERS
from study import checks
from study.dataset import store
from study.measure import charts

if __name__ == "__main__":
    chosen = [checks.choice("chart", name, charts.CHARTS) for name in sys.argv[1:]]
    store.verify()  # before minutes of timing
    for chart in chosen or charts.CHARTS:
        others = list(OTHERS[chart]()) if chart in OTHERS else []
        frame = charts.timed(chart, others)
        store.keep_measured(frame)
        programs = ", ".join(frame.program.unique())
        print(f"timed {chart} of {programs} on {frame.machine.iloc[0]}", flush=True)
