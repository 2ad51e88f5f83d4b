"""Data sets on a Ray cluster.

A thin layer over :meth:`whipcord.Case.sweep`: each task makes one shard of the data set and writes its parts to a folder that all
nodes share. A task whose worker or node dies runs again elsewhere and makes only the parts that are missing. The folder is one table
for Ray Data: ``ray.data.read_parquet([str(path) for path in made.files])``.

Needs ``ray``: ``pip install "whipcord[cluster]"``.

Examples
--------
>>> import whipcord, whipcord.ray  # doctest: +SKIP
>>> case = whipcord.load("robot.toml")  # doctest: +SKIP
>>> whipcord.ray.sweep(case, {"cables.a.tension": "0 N:20 N"}, "/shared/data", samples=10**7)  # doctest: +SKIP
"""

from __future__ import annotations

import os
from typing import Any

from . import _shards
from .case import Case
from .sweeping import Sweep, Vary

__all__ = ["sweep"]


def sweep(
    case: Case,
    vary: Vary | None = None,
    out: str | os.PathLike[str] = "sweep",
    *,
    shards: int | None = None,
    retries: int = 3,
    cpus: float = 1,
    **options: Any,
) -> Sweep:
    """Make a data set by the workers of the Ray cluster that the process is connected to.

    Parameters
    ----------
    case, vary, out
        As for :meth:`whipcord.Case.sweep`; all workers write to the same folder.
    shards
        Number of tasks; by default four for each processor of the cluster.
    retries
        How often a task whose worker dies runs again.
    cpus
        Processors that Ray reserves for a task. How many threads a task has is said by the environment variable ``RAYON_NUM_THREADS``.
    **options
        Further arguments of :meth:`whipcord.Case.sweep`, but `shard` and `resume`.

    Returns
    -------
    Sweep
        What became of all rows. Parts that were there already are kept.
    """
    import ray

    if not ray.is_initialized():
        ray.init()
    processors = int(ray.cluster_resources().get("CPU", 1))
    count = _shards.checked(4 * processors if shards is None else shards)
    options["vary"] = vary
    path = os.path.abspath(out)
    task = ray.remote(num_cpus=cpus, max_retries=retries)(_shards.shard)
    shared = ray.put(case)
    # The first shard alone: what is wrong with the arguments is told before all workers fail on it.
    try:
        first = ray.get(task.remote(shared, path, 0, count, options))
    except ray.exceptions.RayTaskError as error:
        raise error.cause from error
    others = [task.remote(shared, path, number, count, options) for number in range(1, count)]
    return _shards.whole([first, *ray.get(others)])
