"""Commands that bring a robot to a target."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import whipcord
from whipcord.errors import InputError, WhipcordTimeout

LIMITS = whipcord.Limits(tension=["0.5 N", "40 N"])


@pytest.fixture(scope="module")
def arm() -> whipcord.Case:
    return whipcord.load("examples/two-segment-arm.toml")


def test_a_tip_is_reached_within_the_limits(arm: whipcord.Case) -> None:
    goal = np.array([0.06, 0.03, 0.28])
    answer = arm.reach(tip=goal, limits=LIMITS)
    assert answer.ok and answer.status == "reached"
    assert np.linalg.norm(answer.solution.tip - goal) <= 3e-6
    assert (answer.tension >= 0.5).all() and (answer.tension <= 40).all()
    assert answer.null_space.shape == (3, 6) and answer.command.shape == (6,)
    assert answer.actuators[0] == ("tension", "upper-1") and answer.motors == ()
    # The case with these commands gives the shape, and so does a solve with these tensions.
    again = arm.solve(tension=answer.tension)
    assert np.allclose(again.position, answer.solution.position, atol=1e-9)
    assert np.allclose(answer.case.solve().position, answer.solution.position, atol=1e-9)
    assert pickle.loads(pickle.dumps(answer.case)) == answer.case
    near = arm.reach(tip=goal, limits=LIMITS, least="change")

    # Changes count relative to the tension that bends the robot by half a turn: twice as much for the upper cables.
    def change(tension: np.ndarray) -> float:
        return float(np.linalg.norm((tension - np.array(arm.tension)) / [2, 2, 2, 1, 1, 1]))

    assert near.ok and change(near.tension) < change(answer.tension)
    assert np.linalg.norm(answer.tension) < np.linalg.norm(near.tension)


def test_targets_of_every_kind(arm: whipcord.Case) -> None:
    solved = arm.solve(tension=[9, 1, 2, 3, 1, 4])
    tip = solved.tip
    assert arm.reach(pose=(tip, solved.orientation[-1])).ok
    posed = {"position": list(tip), "orientation": list(solved.orientation[-1])}
    assert arm.reach(pose=posed).ok
    assert arm.reach(axis=[0, 1, 3]).ok
    shape = np.full_like(solved.position, np.nan)
    shape[[7, 14]] = solved.position[[7, 14]]
    answer = arm.reach(shape=shape, tolerance="0.01 mm")
    assert answer.ok and answer.error <= 1e-5
    by_length = arm.reach(tip=tip, by="lengths")
    assert by_length.ok and by_length.actuators[0] == ("shortening", "upper-1")
    assert arm.reach(tip=["60 mm", "3 cm", 0.28], model="cosserat-disks").ok


def test_what_is_not_reached_has_the_nearest_commands(arm: whipcord.Case) -> None:
    answer = arm.reach(tip=[0, 0, 0.5])
    assert not answer.ok and answer.status == "nearest" and answer.error > 0.19
    segment = whipcord.load("examples/three-cable-segment.toml")
    proven = segment.reach(tip=[0, 0, 0.14], limits={"tension": [0, "8 N"]}, prove=True)
    assert proven.status == "unreachable_proven"
    assert proven.lower_bound is not None and 0 < proven.lower_bound <= proven.error
    assert segment.reach(tip=[0, 0, 0.14], prove=True).no_proof is not None


def test_the_target_of_a_file_and_its_limits_count() -> None:
    case = whipcord.load("examples/reaching-arm.toml")
    answer = case.reach()
    assert answer.ok and answer.error <= 1e-4 and (answer.tension >= 0.5).all()
    # They are part of the text, and stay with other commands.
    for other in (type(case).from_toml(case.to_toml()), case.replace(tension=[1] * 6)):
        found = other.reach()
        assert found.ok and found.error <= 1e-4 and (found.tension >= 0.5).all()
    assert case.reach(limits={"tension": [1, 40]}).tension.min() >= 1


def test_many_targets_are_single_answers_for_any_number_of_threads(arm: whipcord.Case) -> None:
    targets = np.random.default_rng(1).uniform([-0.08, -0.08, 0.2], [0.08, 0.08, 0.31], (24, 3))
    targets[5], targets[6] = np.nan, [0, 0, 1]
    batch = arm.reach_batch(targets, limits=LIMITS, threads=1)
    assert batch.status[5] == "failed" and batch.reasons[5] and batch.status[6] == "nearest"
    assert batch.ok.sum() > 10 and batch.tension.shape == (24, 6) and batch.position.shape == (24, 15, 3)
    assert np.isnan(batch.tension[~batch.ok]).all() and np.isnan(batch.position[~batch.ok]).all()
    assert np.isfinite(batch.error[6]) and np.isnan(batch.error[5])
    assert (np.linalg.norm(batch.position[batch.ok, -1] - targets[batch.ok], axis=1) <= 3e-6).all()
    for threads in (2, 3):
        other = arm.reach_batch(targets, limits=LIMITS, threads=threads)
        assert other.status.tolist() == batch.status.tolist()
        assert np.array_equal(other.tension, batch.tension, equal_nan=True)
    # An answer does not depend on the rows before it.
    turned = arm.reach_batch(targets[::-1], limits=LIMITS, threads=1)
    assert np.array_equal(turned.tension[::-1], batch.tension, equal_nan=True)
    row = int(np.flatnonzero(batch.ok)[3])
    assert np.array_equal(arm.reach(tip=targets[row], limits=LIMITS).tension, batch.tension[row])
    nearest = arm.reach_batch(targets[5:7], limits=LIMITS, nearest=True)
    assert np.isfinite(nearest.tension[1]).all() and np.isnan(nearest.tension[0]).all()
    assert len(arm.reach_batch(np.empty((0, 3)))) == 0


def test_a_path_is_followed(arm: whipcord.Case) -> None:
    turn = np.linspace(0, np.pi, 13)
    path = np.c_[0.04 * np.cos(turn), 0.04 * np.sin(turn), np.full(13, 0.285)]
    followed = arm.follow(path, np.arange(13.0), limits={"tension": [0.5, 40], "rate": "10 N/s"})
    assert followed.ok.all() and followed.jumps == () and followed.time[-1] == 12
    assert (abs(np.diff(followed.tension, axis=0)) <= 10 + 1e-9).all()
    hurried = arm.follow(path, 1e-3 * np.arange(13.0), limits={"rate": "10 N/s"})
    assert not hurried.ok.all() and np.isnan(hurried.tension[~hurried.ok]).all()


def test_what_cannot_be_asked_is_said(arm: whipcord.Case, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no target"):
        arm.reach()
    with pytest.raises(InputError, match="`tip` must have 3 values"):
        arm.reach(tip=[0, 1])
    with pytest.raises(InputError, match="must be a finite number"):
        arm.reach(tip=[0, np.nan, 1])
    with pytest.raises(InputError, match="must have a direction"):
        arm.reach(axis=[0, 0, 0])
    with pytest.raises(InputError, match="cannot stand beside"):
        arm.reach(tip=[0, 0, 0.3], pose=([0, 0, 0.3], [1, 0, 0, 0]))
    with pytest.raises(InputError, match="one point for each disk"):
        arm.reach(shape=[[0, 0, 0]])
    with pytest.raises(InputError, match="lesser value first"):
        arm.reach(tip=[0, 0, 0.3], limits={"tension": [5, 1]})
    with pytest.raises(InputError, match="the robot has no motors"):
        arm.reach(tip=[0, 0, 0.3], by="motors")
    with pytest.raises(InputError, match="choose tensions, lengths or motors"):
        arm.reach(tip=[0, 0, 0.3], by="hand")
    with pytest.raises(InputError, match="greater than zero"):
        arm.reach(tip=[0, 0, 0.3], tolerance=0)
    with pytest.raises(InputError, match="did you mean `tension`"):
        arm.reach(tip=[0, 0, 0.3], least="tensions")
    with pytest.raises(InputError, match="shape .N, 3. or .N, 7."):
        arm.reach_batch([0.0, 0.0, 0.3])
    with pytest.raises(InputError, match="times of a path must ascend"):
        arm.follow([[0, 0, 0.3], [0, 0, 0.299]], [1.0, 1.0])
    with pytest.raises(InputError, match="belong together"):
        arm.follow([[0, 0, 0.3]])
    with pytest.raises(WhipcordTimeout):
        arm.reach(tip=[0, 0, 0.5], timeout=1e-9)


def test_shapes_to_start_from_are_kept_in_a_file(arm: whipcord.Case, tmp_path: Path) -> None:
    atlas = tmp_path / "atlas.parquet"
    goal = [0.06, 0.03, 0.28]
    first = arm.reach(tip=goal, limits=LIMITS, atlas=atlas)
    kept = atlas.read_bytes()
    second = arm.reach(tip=goal, limits=LIMITS, atlas=atlas)
    many = arm.reach_batch([goal], limits=LIMITS, atlas=atlas)
    assert first.ok and (first.command == second.command).all() and (first.command == many.command[0]).all()
    assert atlas.read_bytes() == kept
    atlas.write_text("a letter")
    with pytest.raises(InputError, match="is no atlas") as refused:
        arm.reach(tip=goal, limits=LIMITS, atlas=atlas)
    assert refused.value.path == "atlas" and atlas.read_text() == "a letter"
