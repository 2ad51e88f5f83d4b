"""Data sets on a Dask cluster.

A thin layer over :meth:`whipcord.Case.sweep`: each task makes one shard of the data set and writes its parts to a folder that all
workers share. A task whose worker dies runs again elsewhere and makes only the parts that are missing.

Needs ``dask`` and ``distributed``: ``pip install "whipcord[cluster]"``.

Examples
--------
>>> import whipcord, whipcord.dask  # doctest: +SKIP
>>> from distributed import Client  # doctest: +SKIP
>>> case = whipcord.load("robot.toml")  # doctest: +SKIP
>>> whipcord.dask.sweep(Client(), case, {"cables.a.tension": "0 N:20 N"}, "/shared/data", samples=10**7)  # doctest: +SKIP
"""

from __future__ import annotations

import os
from typing import Any

from . import _shards
from .case import Case
from .sweeping import Sweep, Vary

__all__ = ["sweep"]


def sweep(
    client: Any,
    case: Case,
    vary: Vary | None = None,
    out: str | os.PathLike[str] = "sweep",
    *,
    shards: int | None = None,
    retries: int = 3,
    **options: Any,
) -> Sweep:
    """Make a data set by the workers of a cluster.

    Parameters
    ----------
    client
        The ``distributed.Client`` of the cluster.
    case, vary, out
        As for :meth:`whipcord.Case.sweep`; all workers write to the same folder.
    shards
        Number of tasks; by default four for each worker.
    retries
        How often a task that raises an error runs again. What is wrong with the arguments is raised at once.
    **options
        Further arguments of :meth:`whipcord.Case.sweep`, but `shard` and `resume`.

    Returns
    -------
    Sweep
        What became of all rows. Parts that were there already are kept.
    """
    workers = len(client.scheduler_info(n_workers=-1)["workers"])
    count = _shards.checked(4 * max(workers, 1) if shards is None else shards)
    options["vary"] = vary
    path = os.path.abspath(out)
    # The first shard alone: what is wrong with the arguments is told before all workers fail on it.
    arguments = [(case, path, number, count, options) for number in range(count)]
    first = client.submit(_shards.shard, *arguments[0], pure=False).result()
    tasks = [client.submit(_shards.shard, *each, pure=False, retries=retries) for each in arguments[1:]]
    return _shards.whole([first, *client.gather(tasks)])
