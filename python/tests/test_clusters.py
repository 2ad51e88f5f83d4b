"""Data sets by several workers, one of which is killed."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import whipcord
from whipcord.errors import InputError

VARY = {"cables.a.tension": "0 N:3 N", "cables.b.tension": "0 N:3 N", "backbone.length": "99 mm:101 mm"}
ROWS = 24_000
OPTIONS: dict[str, Any] = {"samples": ROWS, "sampling": "sobol", "rows_per_part": 200, "shards": 6}


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.glob("part-*.parquet")}


def killing(sweep: Callable[[], whipcord.Sweep], folder: Path, victims: Callable[[], list[int]]) -> whipcord.Sweep:
    """The data set, during which one worker is killed when some parts of several shards are written."""
    found: list[whipcord.Sweep | BaseException] = []

    def work() -> None:
        try:
            found.append(sweep())
        except BaseException as error:
            found.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    until = time.monotonic() + 120
    # Behind those of the first shard, which runs alone.
    while len(contents(folder)) < ROWS // 200 // 6 + 8:
        assert thread.is_alive() and time.monotonic() < until, found
        time.sleep(0.002)
    os.kill(victims()[0], signal.SIGKILL)
    thread.join(timeout=120)
    (made,) = found
    assert isinstance(made, whipcord.Sweep), made
    return made


@pytest.fixture(scope="module")
def segment() -> whipcord.Case:
    return whipcord.load("examples/three-cable-segment.toml")


@pytest.fixture(scope="module")
def single(segment: whipcord.Case, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    options = {name: value for name, value in OPTIONS.items() if name != "shards"}
    return contents(segment.sweep(VARY, tmp_path_factory.mktemp("single"), **options).folder)


def test_dask(segment: whipcord.Case, single: dict[str, bytes], tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    import whipcord.dask

    cluster = distributed.LocalCluster(n_workers=3, threads_per_worker=1, dashboard_address=None)
    with cluster, distributed.Client(cluster) as client:
        with pytest.raises(InputError, match="cables.z.tension"):
            whipcord.dask.sweep(client, segment, {"cables.z.tension": "1 N"}, tmp_path / "wrong")
        pids = client.run(os.getpid)
        out = tmp_path / "data"
        made = killing(
            lambda: whipcord.dask.sweep(client, segment, VARY, out, **OPTIONS), out, lambda: list(pids.values())
        )
    assert (made.rows, made.failed) == (ROWS, 0)
    assert contents(out) == single


# Ray Data warns of settings of its own.
@pytest.mark.filterwarnings("ignore::DeprecationWarning:ray\\.data.*")
def test_ray(segment: whipcord.Case, single: dict[str, bytes], tmp_path: Path) -> None:
    ray = pytest.importorskip("ray")
    import whipcord.ray

    def workers() -> list[int]:
        """Processes that run a shard, which Ray names so."""
        named = {int(path.parent.name): path.read_bytes() for path in Path("/proc").glob("[0-9]*/cmdline")}
        return [pid for pid, name in named.items() if name.startswith(b"ray::shard")]

    ray.init(num_cpus=3, object_store_memory=80_000_000, include_dashboard=False, logging_level="ERROR")
    try:
        with pytest.raises(InputError, match="cables.z.tension"):
            whipcord.ray.sweep(segment, {"cables.z.tension": "1 N"}, tmp_path / "wrong")
        out = tmp_path / "data"
        made = killing(lambda: whipcord.ray.sweep(segment, VARY, out, **OPTIONS), out, workers)
        read = ray.data.read_parquet([str(path) for path in made.files])
        assert read.count() == ROWS
        assert read.max("row") == ROWS - 1
    finally:
        ray.shutdown()
    assert (made.rows, made.failed) == (ROWS, 0)
    assert contents(out) == single
