"""What Python adds: ``make bench-python``, or ``python python/benchmarks/overhead.py`` with the package installed.

The library's own time of a solve is that of ``whipcord solve --json``, a median on the same machine. Its
batches are measured by ``cargo bench -p whipcord --bench batch -- default_options``, with the robot of case III
and as many rows to the piece as here; the rows per second of both are to be compared.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import whipcord

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "examples/table1/case-3.toml"


def median(work: Callable[[], object], count: int, repeats: int = 21) -> float:
    """Median time in s of one call, over repeats of so many."""
    times = []
    for _ in range(repeats):
        begun = time.perf_counter()
        for _ in range(count):
            work()
        times.append((time.perf_counter() - begun) / count)
    return statistics.median(times)


def main() -> None:
    case = whipcord.load(FILE)
    tension = np.array([3.92266])
    for name, call in (
        ("default options", lambda: case.solve(tension=tension)),
        ("and its positions", lambda: case.solve(tension=tension).position),
    ):
        print(f"solve, {name}: {1e6 * median(call, 1000):.1f} µs")
    command = [str(Path(sys.executable).parent / "whipcord"), "solve", str(FILE), "--json"]
    told = [json.loads(subprocess.check_output(command)) for _ in range(5)]
    alone = statistics.median(answer["diagnostics"]["solve_time"] for answer in told)
    print(f"solve, the library alone: {1e6 * alone:.1f} µs")
    coarse = whipcord.models.Cosserat(steps=1, stability=False)
    cheap = median(lambda: case.solve(tension=tension, model=coarse, stations=2), 1000)
    print(f"solve, one step to a section, so nearly all of it overhead: {1e6 * cheap:.1f} µs")

    # As in the benchmark of the library: from nothing to the weight of 400 g.
    rows = np.arange(100_000)[:, None] * 7919 % 100_000 * (3.92266 / 100_000)
    for threads in (1, 2):
        took = median(lambda threads=threads: case.solve_batch(rows, threads=threads), 1, 7)
        print(f"solve_batch, {threads} threads: {len(rows) / took:.0f} rows/s")
    rows[::10] = 1e6
    took = median(lambda: case.solve_batch(rows, threads=1), 1, 3)
    print(f"solve_batch, 1 thread, every tenth row without an answer: {len(rows) / took:.0f} rows/s")
    weights = np.ones((10_000, 10, 3))
    took = median(lambda: case.pull_back_batch(rows[:10_000] % 4, position=weights, threads=1), 1, 3)
    print(f"pull_back_batch, 1 thread: {10_000 / took:.0f} rows/s")


if __name__ == "__main__":
    main()
