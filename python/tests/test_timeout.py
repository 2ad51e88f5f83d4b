"""Time limits, and what Ctrl-C ends."""

from __future__ import annotations

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np
import pytest
import whipcord

FINGER = "examples/contact/gripping-finger.toml"


def long_finger() -> whipcord.Case:
    """Two metres of the gripping finger: it curls up against the ball, until the budget of the solve is spent."""
    text = pathlib.Path(FINGER).read_text().replace('length = "120 mm"', "length = 2")
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "long.toml")
        path.write_text(text)
        return whipcord.load(path)


def threads() -> int:
    return len(os.listdir("/proc/self/task")) if sys.platform == "linux" else threading.active_count()


def rests() -> bool:
    """Whether the process soon uses no more time."""
    for _ in range(50):
        begun = time.process_time()
        time.sleep(0.2)
        if time.process_time() - begun < 0.05:
            return True
    return False


def test_a_solve_that_takes_longer_raises() -> None:
    case = long_finger()
    with pytest.raises(whipcord.errors.WhipcordTimeout) as raised:
        case.solve(timeout=0.1)
    assert isinstance(raised.value, TimeoutError) and isinstance(raised.value, whipcord.SolveError)
    assert "the time limit was reached" in str(raised.value)
    last = raised.value.last_load
    assert last is None or 0 <= last < 1
    assert rests()


def test_batches_and_stiffness_end() -> None:
    case = whipcord.load("examples/table1/case-3.toml").replace(loads=whipcord.Loads(tip_force=[0, 0.05, 0]))
    tensions = np.linspace(0, 3, 200_000)[:, None]
    batch = case.solve_batch(tensions, timeout=0.2)
    assert not batch.ok[-1] and np.isnan(batch.position[~batch.ok]).all()
    assert isinstance(batch.error(len(tensions) - 1), whipcord.errors.WhipcordTimeout)
    weights = np.ones((len(tensions), 10, 3))
    gradients = case.pull_back_batch(tensions, position=weights, timeout=0.2)
    assert not gradients.ok[-1] and not gradients.commands[~gradients.ok].any()
    answers = whipcord.solve_cases([case] * 20_000, timeout=0.02)
    assert isinstance(answers[-1], whipcord.errors.WhipcordTimeout)
    with pytest.raises(whipcord.errors.WhipcordTimeout):
        case.stiffness(model=whipcord.models.Cosserat(steps=100_000), timeout=0.05)
    assert rests()


def test_a_comparison_ends_as_a_whole() -> None:
    with pytest.raises(whipcord.errors.WhipcordTimeout):
        whipcord.compare(long_finger(), timeout=0.3)
    case = whipcord.load("examples/table1/case-3.toml")
    steps = case.replace(steps=[whipcord.Step(tension=[tension]) for tension in (1.0, 2.0)])
    for compared in (case, steps):
        with pytest.raises(whipcord.errors.WhipcordTimeout):
            whipcord.compare(compared, timeout=1e-6)
    assert [run.error for run in whipcord.compare(case, by=["cosserat"], timeout=100)] == [None]
    with pytest.raises(whipcord.InputError, match="timeout"):
        whipcord.compare(case, timeout=-1)
    assert rests()


def test_a_benchmark_ends_as_a_whole() -> None:
    with pytest.raises(whipcord.errors.WhipcordTimeout, match="the models were not tried on all cases"):
        whipcord.benchmark("routing", timeout=0.3)
    assert rests()
    case = whipcord.load("examples/table1/case-3.toml")
    tried = whipcord.benchmark(case, by=["cosserat"], reference="cosserat:fine", timeout=100)
    assert tried.standings[0].model == "cosserat"
    for timeout in (-1, "soon"):
        with pytest.raises(whipcord.InputError, match="timeout"):
            whipcord.benchmark(case, timeout=timeout)  # type: ignore[arg-type]


def test_an_overlay_ends() -> None:
    case, photo = long_finger(), np.full((480, 640), 180, dtype=np.uint8)
    camera = whipcord.Camera.orthographic(scale=200, centre=(320, 100), size=(640, 480))
    with pytest.raises(whipcord.errors.WhipcordTimeout, match="not all models were solved"):
        whipcord.overlay(photo, case, camera=camera, models=["cosserat"], timeout=0.1)
    assert rests()
    case = whipcord.load("examples/table1/case-3.toml")
    assert len(whipcord.overlay(photo, case, camera=camera, models=["cosserat"], timeout=100)) == 1


def test_a_search_in_a_photograph_ends() -> None:
    photo = np.random.default_rng(1).integers(0, 255, (2000, 2000, 3), dtype=np.uint8)
    with pytest.raises(whipcord.errors.WhipcordTimeout, match="the search for disks or markers was not done"):
        whipcord.measure(photo, count=4, timeout=1e-3)
    assert rests()


def test_enough_time_changes_nothing() -> None:
    case = whipcord.load("examples/table1/case-3.toml")
    assert np.array_equal(case.solve(timeout=100).position, case.solve().position)
    for timeout in (0, -1, float("nan"), "soon"):
        with pytest.raises(whipcord.InputError, match="timeout"):
            case.solve(timeout=timeout)  # type: ignore[arg-type]


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("function", ["solve", "benchmark", "overlay"])
def test_ctrl_c_leaves_no_thread_at_work(function: str) -> None:
    case = whipcord.load("examples/table1/case-3.toml").replace(loads=whipcord.Loads(tip_force=[0, 0.05, 0]))
    # A solve of seconds.
    rod = whipcord.models.Cosserat(steps=100_000)
    photo = np.full((480, 640), 180, dtype=np.uint8)
    camera = whipcord.Camera.orthographic(scale=200, centre=(320, 100), size=(640, 480))
    # The limits are long enough to fail here if the signal does not end it.
    calls = {
        "solve": lambda: case.solve(model=rod, timeout=60),
        "benchmark": lambda: whipcord.benchmark("routing", timeout=60),
        "overlay": lambda: whipcord.overlay(photo, long_finger(), camera=camera, timeout=60),
    }
    # Threads that stay from the first solve on are there before.
    whipcord.load("examples/table1/case-3.toml").solve(timeout=100)
    before = threads()
    timer = threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        calls[function]()
    timer.join()
    assert rests()
    # A thread that has ended may be counted a moment longer.
    for _ in range(50):
        if threads() <= before:
            break
        time.sleep(0.1)
    assert threads() <= before


def test_the_command_ends() -> None:
    command = [sys.executable, "-m", "whipcord", "solve", FINGER, "--timeout", "soon"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 2 and "--timeout" in ended.stderr
