"""Throughput and memory of parameter studies: run with ``make bench``.

Each study is a process of its own, so that its memory is its own. The time is with the start of
its workers. Nothing fails for being slow.
"""

import json
import subprocess
import sys

import pytest

SOCKETS = ",".join(f"{1.1 + 0.04 * k:.2f}" for k in range(20))
RANGES = {
    "joints": {"r2_star": "20:2000:log", "socket_ratio": "1.1:2", "modulus_ratio": "0.3:3:log"},
    "joints of 20 sockets": {"r2_star": "20:2000:log", "socket_ratio": SOCKETS},
    "scenes of 0.1 s": {"clearance": "2e-5:2e-4:log", "restitution": "0.2:0.95"},
}
CODE = """
import json, resource, sys, tempfile, time
from pathlib import Path
from study.sweep import random_cases, run_study

kind, count, jobs, ranges = json.loads(sys.argv[1])
given = random_cases(count, ranges)
with tempfile.TemporaryDirectory() as folder:
    output = Path(folder) / "table.csv"
    run_study(given[:2], kind, output, jobs=1)  # compiled from here on
    start = time.perf_counter()
    found = run_study(given, kind, output, jobs=jobs)
    seconds = time.perf_counter() - start
of = resource.RUSAGE_CHILDREN if jobs > 1 else resource.RUSAGE_SELF
print(json.dumps([seconds, resource.getrusage(of).ru_maxrss / 1024, len(found.failures)]))
"""
STUDIES = [
    (kind, count, jobs)
    for kind in ("joints", "scenes of 0.1 s")
    for count, jobs in ((100, 2), (300, 2), (1000, 2), (1000, 1))
] + [("joints of 20 sockets", 1000, 2)]


@pytest.mark.parametrize(("kind", "count", "jobs"), STUDIES)
def test_random_cases(benchmark, kind, count, jobs):
    given = json.dumps([kind.split()[0], count, jobs, RANGES[kind]])
    command = [sys.executable, "-c", CODE, given]
    found = []

    def study():
        found.append(subprocess.run(command, capture_output=True, text=True, check=True).stdout)

    benchmark.group = "random cases"
    benchmark.pedantic(study, rounds=1)
    seconds, memory, failed = json.loads(found[-1])
    assert failed == 0
    benchmark.stats.name = (
        f"{count} {kind}, {jobs} process{'es' * (jobs > 1)}: {count / seconds:.0f} cases/s, "
        f"largest process {memory:.0f} MB"
    )
