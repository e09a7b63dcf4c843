"""Call Snakemake for the targets of a command, and be the jobs that the Snakefile names.

Snakemake decides what is outdated and runs it in parallel. A job is ``python -m
study.pages.workflow notebook NAME``, or ``check``, ``typeset`` or ``report``.
"""

import io
import os
import re
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import redirect_stderr
from functools import partial
from typing import Any

from study import checks, paths
from study.checks import StudyError
from study.threads import check_memory

MEMORY = 2_800_000  # KiB that any notebook needs
_DONE = re.compile(r"\d+ of \d+ steps \(.+\) done|Nothing to be done")


def run(
    targets: Iterable[str],
    *,
    jobs: int | None = None,
    config: str = "",
    force: bool = False,
    more: Sequence[str] = (),
    first: Callable[[], Any] = lambda: None,
) -> None:
    """Bring targets of the Snakefile up to date, in as many processes as ``jobs``.

    The default is one process for each core. ``config`` is for the Snakefile, and ``more`` are
    further words for Snakemake, which then prints its whole log. ``first`` is done before, under
    the lock of the run. What is finished stays finished after ``KeyboardInterrupt``.

    Raises `study.checks.StudyError` if a job fails (the job has printed why), if Snakemake does, if
    the limit of memory is too low, or if another run is working in this folder.
    """
    from snakemake.cli import main as snakemake

    paths.require_checkout(paths.NOTEBOOKS)
    check_memory(MEMORY, "a rebuild")
    cores = "all" if jobs is None else str(checks.whole("jobs", jobs, least=1))
    words = ["--snakefile", str(paths.ROOT / "Snakefile"), "--directory", str(paths.ROOT)]
    words += ["--cores", cores, "--scheduler", "greedy", "--keep-going", "--rerun-incomplete"]
    words += ["--max-checksum-file-size", "100MB"]  # a new time alone is no change
    words += ["--nolock"]  # but our own lock, which a killed process does not leave
    words += ["--force"] if force else []
    words += ["--config", config] if config else []
    words += more or ["--quiet", "host", "reason", "rules"]
    log: Any = sys.stderr if more else _Log()
    interrupted = threading.Event()

    def interrupt(*_):
        interrupted.set()
        raise KeyboardInterrupt

    before, status = signal.signal(signal.SIGINT, interrupt), None
    try:
        with paths.locked(paths.BUILD / "running", wait=False), redirect_stderr(log):
            paths.remove_abandoned()
            first()
            snakemake([*words, "--", *targets])
    except BlockingIOError:  # both would write the same results
        busy = f"another run is working in {paths.ROOT}; wait until it has ended"
        raise StudyError(busy) from None
    except SystemExit as end:
        status = end.code
    finally:
        signal.signal(signal.SIGINT, before)
    if interrupted.is_set():
        raise KeyboardInterrupt
    if status:
        raise StudyError("Snakemake ended with an error" if more else log.reason())


class _Log(io.StringIO):
    """Snakemake's log, of which only the lines on its progress are shown."""

    def write(self, text):
        if _DONE.match(text):
            print(text.rstrip(), flush=True)
        return super().write(text)

    def reason(self):
        """Why a run failed: jobs, which have printed their reasons, or the last lines."""
        if failed := re.findall(r"^Command '.* (\S+)' (?:returned|died)", self.getvalue(), re.M):
            return f"{len(failed)} of the jobs failed: {', '.join(failed)}"
        return f"Snakemake: {' '.join(self.getvalue().split()[-60:])}"


def main(job: str, *words: str) -> None:
    """Be the job of the Snakefile with this name."""
    be_job(words[0] if words else job, partial(_JOBS[job], *words))


def be_job(name: str, work: Callable[[], None]) -> None:
    """Do the work of a job; print one line when it is done, or on standard error why it failed.

    The job tidies up when it is interrupted or terminated, and ends soon after Snakemake.
    """
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    threading.Thread(target=_end_with, args=(os.getppid(),), daemon=True).start()
    os.environ[paths.READ_VARIABLE] = str(paths.RESULTS)
    start = time.monotonic()
    try:
        work()
    except (StudyError, ValueError, KeyError, OSError) as error:
        of = "" if isinstance(error, StudyError) else f"{name}: "
        print(f"failed: {of}{' '.join(str(error).split())}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        sys.exit(130)
    print(f"{name}  ({time.monotonic() - start:.1f} s)", flush=True)


def _end_with(parent):
    """End this job soon after Snakemake, which may be killed without ending its jobs."""
    while os.getppid() == parent:
        time.sleep(1)
    os._exit(1)


def _check():
    from study import dataset

    dataset.verify()


def _notebook(name):
    from study.pages.catalogue import select
    from study.pages.execute import execute

    (notebook,) = select([name])
    execute(notebook, paths.RESULTS, notebook.executed)


def _typeset():
    from study.pages.typeset import typeset_all

    typeset_all()


def _report():
    from study.pages import report

    report.write(paths.BUILD / "report")


_JOBS: dict[str, Callable[..., None]] = {
    "check": _check,
    "notebook": _notebook,
    "typeset": _typeset,
    "report": _report,
}

if __name__ == "__main__":
    main(*sys.argv[1:])
