"""Many answers at once."""

from __future__ import annotations

import _thread
import csv
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from subprocess import PIPE

import numpy as np
import pytest
import whipcord


def test_rows_are_single_solves_to_the_last_bit(segment: whipcord.Case) -> None:
    rows = np.random.default_rng(1).uniform(0, 2, size=(40, 3))
    batch = segment.solve_batch(rows)
    assert batch.position.shape == (40, len(batch.arc_length), 3)
    for i in (0, 7, 39):
        solution = segment.solve(tension=rows[i])
        assert np.array_equal(batch.position[i], solution.position)
        assert np.array_equal(batch.orientation[i], solution.orientation)
        assert np.array_equal(batch.tension[i], solution.tension)
        assert np.array_equal(batch.length[i], solution.length)
        assert batch.stable[i] and solution.stable
    # The eigenvalue where it is asked for.
    asked = whipcord.models.Cosserat(stability="eigenvalue")
    values = segment.solve_batch(rows, model=asked).diagnostic("stability")
    for i in (0, 7, 39):
        assert values[i] == segment.solve(tension=rows[i], model=asked).diagnostics.stability
    for threads in (1, 3):
        assert np.array_equal(segment.solve_batch(rows, threads=threads).position, batch.position)


def test_rows_under_load_and_by_length_and_along_a_path() -> None:
    case = whipcord.load("examples/wall-mounted-arm.toml")
    rows = np.full((20, 1), 15.0)
    cold, warm = case.solve_batch(rows), case.solve_batch(rows, path=True, stations=7)
    assert cold.ok.all() and warm.position.shape == (20, 7, 3)
    assert np.allclose(cold.tip, warm.tip, atol=1e-9)
    assert warm.diagnostic("iterations").sum() < cold.diagnostic("iterations").sum()
    by_length = case.solve_batch(shortening=[[0.001], [0.002]])
    assert np.array_equal(by_length.position[1], case.solve(shortening=[0.002]).position)


def test_integers_lists_and_strided_rows_will_do(case: whipcord.Case) -> None:
    expected = case.solve_batch(np.array([[1.0], [2.0]])).position
    strided = np.array([[1.0, 9.0], [2.0, 9.0]])[:, :1]
    for rows in ([[1], [2]], np.array([[1], [2]]), np.array([[1.0], [2.0]], np.float32), strided):
        assert np.array_equal(case.solve_batch(rows).position, expected)
    assert case.solve_batch(np.empty((0, 1))).position.shape == (0, 10, 3)


def test_ten_thousand_rows_of_a_hundred_thousand_fail_and_are_flagged(
    case: whipcord.Case,
) -> None:
    rows = np.linspace(0, 4, 100_000)[:, None]
    wrong = np.arange(0, 100_000, 10)
    rows[wrong] = 1e6
    rows[wrong[1::3]] = np.nan
    rows[wrong[2::3]] = -1
    batch = case.solve_batch(rows, stations=2)
    assert np.array_equal(batch.failed, wrong)
    assert batch.ok.sum() == 90_000
    # A row without an answer holds NaN everywhere, and no other row does.
    failed = ~batch.ok
    for array in (batch.position, batch.orientation, batch.tension, batch.length):
        empty = np.isnan(array).reshape(len(rows), -1)
        assert np.array_equal(empty.all(axis=1), failed) and np.array_equal(empty.any(axis=1), failed)
    assert not batch.stable[wrong].any() and not batch.unstable[wrong].any()
    assert batch.stable[batch.ok].all()
    assert isinstance(batch.error(0), whipcord.errors.SectionFoldsError)
    assert "finite" in str(batch.error(10)) and "negative" in str(batch.error(20))
    assert batch.error(1) is None
    assert np.isnan(batch.diagnostic("residual")[wrong]).all()
    with pytest.raises(whipcord.errors.SectionFoldsError):
        batch.raise_for_failed()
    with pytest.raises(IndexError):
        batch.error(100_000)
    assert "10000 failed" in repr(batch)


def test_progress_is_shown(case: whipcord.Case, capsys: pytest.CaptureFixture[str]) -> None:
    case.solve_batch(np.ones((1000, 1)), progress=True)
    assert "1.00k/1.00k" in capsys.readouterr().err


def test_ctrl_c_interrupts_a_long_batch() -> None:
    case = whipcord.load("examples/wall-mounted-arm.toml")
    # Half a minute of work or more.
    rows = np.full((1_000_000, 1), 5.0)
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        case.solve_batch(rows, stations=2)
    timer.join()
    # Nothing is left behind that would go on.
    assert case.solve_batch(rows[:100]).ok.all()


SLOW = """
import whipcord
arm = whipcord.load("examples/wall-mounted-arm.toml")
long = arm.replace(steps=[whipcord.Step(tension=[5.0])] * 3000)
finely = whipcord.models.Cosserat(steps=5000)
print("ready", flush=True)
{work}
print("done", flush=True)
"""


@pytest.mark.parametrize("call", ["solve", "solve_steps", "differentiate"])
def test_ctrl_c_does_not_wait_for_a_slow_answer(call: str) -> None:
    # Minutes of work, in a process of its own: what nobody waits for ends with it.
    code = SLOW.format(work=f"long.{call}(model=finely)")
    process = subprocess.Popen([sys.executable, "-c", code], stdout=PIPE, stderr=PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "ready\n"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    try:
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert out == "" and "KeyboardInterrupt" in err


def test_the_interpreter_is_free_meanwhile(case: whipcord.Case) -> None:
    ticks = []
    stop = threading.Event()

    def tick() -> None:
        while not stop.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begun = time.perf_counter()
    case.solve_batch(np.ones((200_000, 1)), threads=1, stations=2)
    ended = time.perf_counter()
    stop.set()
    thread.join()
    assert sum(begun < at < ended for at in ticks) > 3


def test_a_batch_becomes_a_table(segment: whipcord.Case) -> None:
    batch = segment.solve_batch(np.ones((3, 3)), stations=4)
    frame = batch.to_pandas()
    assert len(frame) == 12 and frame["row"].tolist() == [0] * 4 + [1] * 4 + [2] * 4
    assert np.array_equal(frame["z"].to_numpy(), batch.position[:, :, 2].ravel())
    data = batch.to_xarray()
    assert dict(data.sizes) == {"row": 3, "station": 4, "axis": 3, "component": 4, "cable": 3}
    units = {name: data[name].attrs["units"] for name in ("position", "tension", "length", "arc_length")}
    assert units == {"position": "m", "tension": "N", "length": "m", "arc_length": "m"}


def test_a_batch_is_written_as_csv(segment: whipcord.Case, tmp_path: Path) -> None:
    batch = segment.solve_batch([[1.0, 0.5, 1 / 3], [1e9] * 3], stations=4)
    batch.to_csv(tmp_path / "rows.csv")
    with open(tmp_path / "rows.csv", newline="") as file:
        lines = list(csv.DictReader(file))
    frame = batch.to_pandas()
    assert list(lines[0]) == list(frame.columns) and len(lines) == 8
    for name in frame.columns.drop(["ok", "unstable", "error"]):
        written = [float(line[name]) for line in lines]
        assert np.array_equal(written, frame[name].to_numpy(), equal_nan=True), name
    assert [line["ok"] for line in lines] == ["True"] * 4 + ["False"] * 4
    assert [line["unstable"] for line in lines] == ["False"] * 8
    assert [line["error"] for line in lines] == frame["error"].tolist()
    assert [line["x"] for line in lines[4:]] == ["nan"] * 4 and lines[4]["error"] != ""
    with pytest.raises(FileNotFoundError, match="rows"):
        batch.to_csv(tmp_path / "none" / "rows.csv")


def test_batches_and_gradients_are_pickled(case: whipcord.Case) -> None:
    rows = [[1.0], [1e6], [2.0], [-1.0]]
    batch = case.solve_batch(rows, stations=4)
    gradients = case.pull_back_batch(rows, position=np.ones((4, 10, 3)))
    again = pickle.loads(pickle.dumps(batch))
    # Of a copy too.
    again = pickle.loads(pickle.dumps(again))
    for name in ("arc_length", "position", "orientation", "tension", "length", "ok", "failed"):
        assert np.array_equal(getattr(again, name), getattr(batch, name), equal_nan=True), name
    for name in ("iterations", "residual", "stability", "discretization_error", "steps", "stability_lost_at"):
        assert np.array_equal(again.diagnostic(name), batch.diagnostic(name), equal_nan=True), name
    for thing in (again, batch):
        with pytest.raises(whipcord.InputError, match="there is no diagnostic `x`: choose iterations"):
            thing.diagnostic("x")
    assert (again.case, again.model, repr(again)) == (batch.case, batch.model, repr(batch))
    copy = pickle.loads(pickle.dumps(gradients))
    assert np.array_equal(copy.commands, gradients.commands)
    for mine, other in ((again, batch), (copy, gradients)):
        assert len(mine) == 4 and mine.error(0) is None
        for row in (1, 3):
            assert type(mine.error(row)) is type(other.error(row))
            assert str(mine.error(row)) == str(other.error(row))
        with pytest.raises(whipcord.errors.SectionFoldsError):
            mine.raise_for_failed()


def test_gradients_of_failed_rows_are_zero_and_flagged(case: whipcord.Case) -> None:
    weights = np.ones((3, 10, 3))
    gradients = case.pull_back_batch([[1.0], [1e6], [2.0]], position=weights)
    assert gradients.ok.tolist() == [True, False, True]
    assert gradients.commands[1] == 0 and gradients.commands[0] != 0
    with pytest.raises(whipcord.InputError, match=r"position must have the shape \(3, 10, 3\)"):
        case.pull_back_batch([[1.0], [1.0], [2.0]], position=weights[:, :-1])


def test_cases_of_other_robots_and_loads_are_solved_at_once(case: whipcord.Case) -> None:
    others = [
        case,
        whipcord.load("examples/wall-mounted-arm.toml"),
        case.replace(tension=[1e6]),
        whipcord.load("examples/rubbing-finger.toml"),
    ]
    first, second, third, fourth = whipcord.solve_cases(others, stations=7, threads=2)
    assert isinstance(first, whipcord.Solution) and isinstance(second, whipcord.Solution)
    assert np.array_equal(first.position, case.solve(stations=7).position)
    assert second == others[1].solve(stations=7) and second.case == others[1]
    assert isinstance(third, whipcord.errors.SectionFoldsError)
    assert fourth == others[3].solve(stations=7)
    (refused,) = whipcord.solve_cases(others[3:], model="constant-curvature")
    assert isinstance(refused, whipcord.ModelError)
    assert whipcord.solve_cases([]) == []


@pytest.mark.parametrize("name", ["position", "rotation", "cable_tension", "cable_length"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_weights_that_are_no_numbers_are_refused(case: whipcord.Case, name: str, value: float) -> None:
    weights = np.zeros((2, 1) if name.startswith("cable") else (2, 10, 3))
    weights[1, 0] = value
    with pytest.raises(whipcord.InputError, match=f"{name} must be finite numbers.* in row 1") as error:
        case.pull_back_batch([[1.0], [2.0]], **{name: weights})
    assert error.value.path == name
    single = name.removeprefix("cable_")
    _, derivatives = case.differentiate()
    with pytest.raises(whipcord.InputError, match=f"{single} must be finite numbers") as error:
        derivatives.pull_back(**{single: weights[1]})
    assert error.value.path == single


def test_unstable_rows_are_answers_and_are_marked() -> None:
    """Linkages under the pull of a cable in their centre, by less and by more than what buckles their sections."""
    robot = whipcord.load("examples/table1/case-3.toml").robot
    central = whipcord.Cable(name="central", routing=whipcord.Routing.straight(angle=0, radius=0))
    rod = whipcord.Case(robot.replace(cables=[central]))
    held, buckled = (rod.solve(tension=[pull], model="pseudo-rigid-body") for pull in (5.0, 150.0))
    assert held.stable is True and held.diagnostics.stability_absent is None
    assert buckled.stable is False and "unstable" in repr(buckled)
    stable = rod.solve_batch([[1.0], [5.0], [-1.0]], model="pseudo-rigid-body")
    unstable = rod.solve_batch([[150.0], [160.0], [-1.0]], model="pseudo-rigid-body")
    assert stable.ok.tolist() == unstable.ok.tolist() == [True, True, False]
    assert stable.stable.tolist() == [True, True, False] and not stable.unstable.any()
    assert unstable.unstable.tolist() == [True, True, False] and not unstable.stable.any()
    assert "2 unstable" in repr(unstable) and "unstable" not in repr(stable)
    assert np.array_equal(pickle.loads(pickle.dumps(unstable)).unstable, unstable.unstable)
    lines = whipcord.export.batch_columns(unstable)
    assert lines["unstable"].sum() == 2 * len(unstable.arc_length)
    assert np.isnan(lines["x"][-1]) and "negative" in lines["error"][-1] and lines["error"][0] == ""
    # Without a verdict there is neither.
    beside = whipcord.Case(_with_cable(robot.replace(cables=[])))
    four_bar = beside.solve_batch(shortening=[[0.0]], model="four-bar")
    assert four_bar.ok.all() and not four_bar.stable.any() and not four_bar.unstable.any()


def _with_cable(robot: whipcord.Robot) -> whipcord.Robot:
    return robot.replace(cables=[whipcord.Cable(name="slack", holes=[1] * 10)])


def test_one_kind_of_command_drives_a_batch(case: whipcord.Case) -> None:
    with pytest.raises(whipcord.errors.InputError, match="leave out shortening to drive by tension"):
        case.solve_batch([[1.0]], shortening=[[0.001]])
    with pytest.raises(whipcord.errors.InputError, match="give tensions, shortenings or commands of motors"):
        case.solve_batch()
