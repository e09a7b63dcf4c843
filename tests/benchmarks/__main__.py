"""Times the charts with other programs, and keeps the times: run by ``make speed``."""

from benchmarks.others import OTHERS
from study.dataset import store
from study.measure import charts

if __name__ == "__main__":
    store.verify()  # before minutes of timing
    for chart, others in OTHERS.items():
        frame = charts.timed(chart, 5, charts.methods()[chart], list(others()))
        store.keep_measured(frame)
        programs = ", ".join(frame.program.unique())
        print(f"timed {chart} of {programs} on {frame.machine.iloc[0]}", flush=True)
