"""The environment of Gymnasium."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import whipcord
from whipcord.errors import InputError

gymnasium = pytest.importorskip("gymnasium", reason="Gymnasium is not installed")
import whipcord.gym  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402


@pytest.fixture(scope="module")
def arm() -> whipcord.Case:
    return whipcord.load("examples/released-arm.toml")


def test_it_is_an_environment(arm: whipcord.Case) -> None:
    with warnings.catch_warnings():
        # Of observations without bounds.
        warnings.simplefilter("ignore")
        check_env(whipcord.gym.Reach(arm, steps=5), skip_render_check=True)


def test_an_episode_is_a_motion(arm: whipcord.Case) -> None:
    environment = whipcord.gym.Reach(arm, "5 ms", steps=40, greatest=[4.0, 2.0])
    first, _ = environment.reset(seed=3)
    again, _ = environment.reset(seed=3)
    other, _ = environment.reset(seed=4)
    assert np.array_equal(first, again) and not np.array_equal(first, other)
    place = environment.place
    # The place is that of an equilibrium: held long enough, its tensions lead there.
    simulation = whipcord.Simulation(arm, tension={"left": 0.0, "right": 0.0})
    rewards = []
    for k in range(40):
        observation, reward, terminated, truncated, info = environment.step([0.5, 0.25])
        simulation.step("5 ms", tension=[2.0, 0.5])
        assert np.array_equal(environment.simulation.tip, simulation.tip)
        assert not terminated and truncated == (k == 39)
        rewards.append(reward)
    assert info["distance"] == pytest.approx(np.linalg.norm(simulation.tip - place))
    assert np.allclose(observation[:3], (simulation.tip - place) / 0.3)
    # The velocity is that of the world.
    before = simulation.tip
    simulation.step(1e-6, tension=[2.0, 0.5])
    assert np.allclose(observation[6:9] * 0.3, (simulation.tip - before) / 1e-6, atol=2e-3)
    assert len(set(rewards)) == 40


def test_a_place_may_be_given(arm: whipcord.Case) -> None:
    environment = whipcord.gym.Reach(arm)
    environment.reset(options={"place": [0.01, 0.0, 0.29]})
    assert environment.place.tolist() == [0.01, 0.0, 0.29]
    for wrong in ([1.0], [np.nan, 0.0]):
        with pytest.raises(InputError, match="action"):
            environment.step(wrong)
    with pytest.raises(InputError, match="place"):
        environment.reset(options={"place": [1.0]})
    with pytest.raises(InputError, match="greatest"):
        whipcord.gym.Reach(arm, greatest=[1.0, 2.0, 3.0])
