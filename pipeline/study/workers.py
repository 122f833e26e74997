"""Where the runs of a study are carried out: processes of this machine, or a cluster's workers.

dask.distributed takes a second to load, so it is loaded when there is something to run.
"""

# SPDX-License-Identifier: GPL-3.0-or-later

import contextlib
import logging
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from pipeline.errors import CaseError, StageError
from pipeline.machine import cores
from pipeline.study.one import carry_out
from pipeline.study.plan import Task
from pipeline.study.quantity import Results

if TYPE_CHECKING:
    from distributed import Client

SLURM = "slurm"
"""The scheduler's address that asks for a cluster of SLURM jobs."""

_PATIENCE = "30s"


def carried_out(
    tasks: Iterable[Task], workers: int | None, scheduler: str | None
) -> Iterator[tuple[Task, Results | BaseException]]:
    """Carry out tasks on workers and give each with its results, or with its error, as it ends.

    Parameters
    ----------
    tasks : iterable of Task
    workers : int, optional
        Processes of this machine (as many as it has cores unless given), or jobs of SLURM.
    scheduler : str, optional
        Address of a running dask scheduler, whose workers see the study's folder under the same path; or `SLURM`.

    Raises
    ------
    CaseError
        If an option would be ignored or is missing.
    StageError
        If the scheduler cannot be reached.
    """
    from distributed import as_completed

    with client_of(workers, scheduler) as client:
        # a task is named for its run, or dask would take two studies' tasks for one
        futures = {client.submit(carry_out, task, key=f"{task.name}-{task.key}", retries=0): task for task in tasks}
        for future in as_completed(futures):
            problem = future.exception()
            yield futures[future], future.result() if problem is None else problem
            future.release()


@contextlib.contextmanager
def client_of(workers: int | None, scheduler: str | None) -> "Iterator[Client]":
    """Give what carries out tasks: processes of this machine, jobs of SLURM, or the workers of a running scheduler.

    Parameters
    ----------
    workers, scheduler
        As in `carried_out`.

    Raises
    ------
    CaseError, StageError
        As in `carried_out`.
    """
    import dask
    from distributed import Client, LocalCluster

    # a run that takes its worker down, as one without memory does, would do so again
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}):
        if scheduler is None:
            count = workers or cores()
            with (
                LocalCluster(
                    n_workers=count,
                    threads_per_worker=1,
                    processes=True,
                    # a port of its own, that only this machine sees: two studies may run at once
                    dashboard_address="127.0.0.1:0",
                    memory_limit=0,
                    silence_logs=logging.CRITICAL,
                ) as cluster,
                Client(cluster) as client,
            ):
                yield client
        elif scheduler == SLURM:
            with _slurm_cluster(workers) as cluster, Client(cluster) as client:
                yield client
        else:
            if workers is not None:
                raise CaseError("--workers: a running scheduler has workers of its own; leave --workers out")
            try:
                client = Client(scheduler, timeout=_PATIENCE)
            except (OSError, ValueError) as problem:
                raise StageError(
                    f"no dask scheduler answers at {scheduler!r} ({problem}); start one with `dask scheduler`, and "
                    "give the address it prints, like tcp://host:8786"
                ) from problem
            with client:
                yield client


def _slurm_cluster(workers: int | None) -> "contextlib.AbstractContextManager[object]":
    try:
        from dask_jobqueue import SLURMCluster
    except ImportError as problem:
        raise StageError(
            "--scheduler slurm needs dask-jobqueue: pip install 'fibertwin[cluster]', and describe the jobs in "
            "~/.config/dask/jobqueue.yaml"
        ) from problem
    if workers is None:
        raise CaseError("--scheduler slurm: say with --workers how many jobs to ask for")
    cluster: contextlib.AbstractContextManager[object] = SLURMCluster()
    cluster.scale(workers)  # type: ignore[attr-defined]
    return cluster
