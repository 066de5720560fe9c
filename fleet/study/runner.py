"""Running jobs: resume what a folder holds, run what is left, keep every result at once."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any, TypeAlias

from fleet.study import trust
from fleet.study.atomic import clear_drafts
from fleet.study.endings import BrokenOff, Interrupted
from fleet.study.job import Job, Outcome
from fleet.study.ledger import Counts
from fleet.study.local import LIMIT, Executor, LocalExecutor, usable_cores
from fleet.study.open_ledger import OpenLedger, writing
from fleet.study.parquet import bring_up_to_date
from fleet.study.result import StudyResult
from fleet.study.stop import Stop
from fleet.study.version import environment, program_version

ATTEMPTS = 2  # a job that kills so many workers is set aside

Progress: TypeAlias = Callable[[Counts], None]
Say: TypeAlias = Callable[[str], None]


def silent(_: object) -> None:
    """Watch nothing, say nothing."""


def run_jobs(
    jobs: Iterable[Job],
    out: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
    say: Say = silent,
    retry: bool = False,
    limit: float | None = LIMIT,
    meta: Mapping[str, Any] | None = None,
) -> StudyResult:
    """Run what the folder ``out`` does not hold yet, and write its tables.

    ``jobs`` are read once, before anything runs; they are what the folder's tables hold from
    then on. Each result is in the folder's ledger, on the disk, before it is counted. A job
    that raises, or kills its worker twice, is recorded and the others go on; ``retry`` runs
    those that failed in an earlier call again.

    Args:
        jobs: What to run, in order of preference.
        out: The folder, made if need be. One call at a time may work in it.
        workers: Processes on this machine; all usable cores if None.
        scheduler: The address of a Dask scheduler whose workers run the jobs instead.
        progress: Called with the counts when they change, and a few times a second.
        say: Called with a sentence about what is noticed on the way.
        retry: Run again what failed.
        limit: What takes longer [s] is ended, and counts as failed; None: nothing is.
        meta: More to be kept about the study, of plain values.

    Raises:
        BadInput: another process is at work in the folder, or it cannot be used.
        BrokenOff: the disk is full, or the Dask scheduler is lost. What is done is kept.
        Interrupted: Ctrl-C or SIGTERM; it is a KeyboardInterrupt. What is done is kept.
    """
    folder = Path(out)
    with writing(folder) as ledger:
        clear_drafts(folder)
        ledger.plan(jobs)
        trust.remember(ledger.code())
        ledger.describe({"made_by": environment(), "folder": str(Path.cwd()), **(meta or {})})
        _tell_changes(ledger, say)
        keys = ledger.todo(retry=retry)
        if keys:
            _run(ledger, keys, executor(workers, scheduler, len(keys), limit), progress)
        bring_up_to_date(ledger, folder)
    return StudyResult(folder)


def _run(
    ledger: OpenLedger,
    keys: list[str],
    runs: Executor,
    progress: Progress,
) -> None:
    """Run the jobs of these keys, to the end or until asked to stop."""
    counts = ledger.counts()
    done, failed = counts.done, counts.total - counts.done - len(keys)
    with ExitStack() as stack:
        stop = stack.enter_context(Stop())
        queue = Queue(keys, stop)
        stack.enter_context(closing(runs))
        progress(Counts(counts.total, done, failed))
        for ended in runs.run(lambda: ledger.job(key) if (key := queue.take()) else None):
            if stale := next((o for o in ended if o.status == "stale"), None):
                raise BrokenOff(stale.error)
            if outcomes := queue.settled(ended):
                ledger.record(outcomes)
                fine = sum(outcome.status == "done" for outcome in outcomes)
                done, failed = done + fine, failed + len(outcomes) - fine
            progress(Counts(counts.total, done, failed))
            if stop.over():
                break
        if stop.signal and done + failed < counts.total:
            raise Interrupted(done, counts.total, stop.signal)


class Queue:
    """Keys to be run; those whose worker died come again when all others are done."""

    def __init__(self, keys: Iterable[str], stop: Stop) -> None:
        self._keys = deque(keys)
        self._deaths: Counter[str] = Counter()
        self._stop = stop

    def take(self) -> str | None:
        """The next key; None: there is none, or nothing more is to be started."""
        return self._keys.popleft() if self._keys and not self._stop.signal else None

    def settled(self, outcomes: Iterable[Outcome]) -> list[Outcome]:
        """The outcomes that are final. A job that has killed too many workers is set aside."""
        final = []
        for outcome in outcomes:
            deaths = self._deaths.pop(outcome.key, 0)
            if outcome.status == "killed" and deaths + 1 < ATTEMPTS:
                self._deaths[outcome.key] = deaths + 1
                self._keys.append(outcome.key)
            else:
                final.append(outcome._replace(attempts=deaths + 1))
        return final


def executor(
    workers: int | None, scheduler: str | None, jobs: int, limit: float | None
) -> Executor:
    """What runs so many jobs: processes of this machine, or a Dask cluster."""
    if scheduler is None:
        return LocalExecutor(min(workers or usable_cores(), jobs), limit)
    from fleet.study.cluster import ClusterExecutor

    return ClusterExecutor(scheduler, limit)


def _tell_changes(ledger: OpenLedger, say: Say) -> None:
    same, others = ledger.aside(program_version())
    if same:
        say(f"the study has changed: {same} runs that are done are no part of it now; kept aside")
    if others:
        say(
            f"the program has changed: {others} runs are of another version;"
            f" kept aside, and run again with {program_version()} where the study has them"
        )
