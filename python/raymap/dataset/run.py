"""Who makes the results of a data set: processes of this machine, or a Dask cluster."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing, contextmanager
from typing import Any
from uuid import uuid4

from .._cluster import KILLED, dask_results
from .._errors import Cancelled
from .._progress import pace_text
from .children import Children
from .files import readable
from .work import Job, Outcome, work


def run_jobs(
    jobs: list[Job],
    workers: int,
    client: Any,
    report: Callable[[str, float], object] | None,
    results: list[Outcome],
) -> None:
    """Does all jobs, on the cluster of a `dask.distributed.Client` or with as many workers of this machine.

    Appends each outcome to `results`.

    Raises:
        Cancelled: `report` returned False.
    """
    running = closing(_dask_outcomes(jobs, client)) if client is not None else _on_this_machine(jobs, workers)
    with running as outcomes:
        start = time.monotonic()
        for outcome in outcomes:
            results.append(outcome)
            share = len(results) / len(jobs)
            if report is not None and report(_progress_text(results, len(jobs), start), share) is False:
                raise Cancelled("cancelled by progress")


@contextmanager
def _on_this_machine(jobs: list[Job], workers: int) -> Iterator[Iterator[Outcome]]:
    children = Children()
    with ThreadPoolExecutor(workers) as pool:
        try:
            futures = as_completed([pool.submit(work, job, children) for job in jobs])
            yield (future.result() for future in futures)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            children.close()


def _dask_outcomes(jobs: list[Job], client: Any) -> Generator[Outcome]:
    run = uuid4().hex
    names = {f"raymap-{run}-{k}-{readable(job.name)}": job.name for k, job in enumerate(jobs)}
    for key, outcome in dask_results(client, work, jobs, list(names)):
        if outcome is KILLED:
            outcome = Outcome(names[key], "unfinished", False, "its workers were killed again and again")
        yield outcome


def _progress_text(results: list[Outcome], count: int, start: float) -> str:
    """Returns the state of a run. Meshes that were finished before say nothing about its rate."""
    new = sum(outcome.is_new for outcome in results)
    failed = sum(outcome.state == "quarantined" for outcome in results)
    text = f"{len(results)} of {count} meshes" + (f", {failed} quarantined" if failed else "")
    return text + pace_text(new, count - len(results), start)
