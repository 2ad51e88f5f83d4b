"""A robot in motion as an environment of Gymnasium, for reinforcement learning.

>>> import whipcord
>>> import whipcord.gym
>>> environment = whipcord.gym.Reach(whipcord.load("examples/released-arm.toml"), greatest=4.0)
>>> observation, _ = environment.reset(seed=1)
>>> observation, reward, terminated, truncated, _ = environment.step([0.5, 0.0])
>>> observation.shape, bool(reward < 0), terminated, truncated
((11,), True, False, False)

Needs the package gymnasium (``pip install "whipcord[gym]"``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

try:
    import gymnasium
except ImportError as error:
    raise ImportError('whipcord.gym needs the package gymnasium: pip install "whipcord[gym]"') from error

from ._commands import whole
from ._tables import Quantity
from .errors import InputError, MotionError
from .simulating import Simulation, step_length
from .solution import rotation

if TYPE_CHECKING:
    from .case import Case

__all__ = ["Reach"]

Array = npt.NDArray[np.float64]


class Reach(gymnasium.Env[Array, Array]):
    """The tip is to come to a place, and stay there.

    An episode begins with the robot at rest and a place that its tip has in equilibrium under random tensions. An action is a number from 0 to 1 for each
    cable: the part of its greatest tension that it has during the step. What is observed: position of the tip less the place, and position and velocity of the
    tip, each as a part of the length of the backbone (a second), and the parts of the greatest tensions that the cables have. The reward of a step is minus the
    distance of the tip from the place as a part of the length, less 1 % of the mean square of the changes of the action. An episode is
    truncated after its steps; it is terminated, with a reward of −10, where a motion has no result.

    Parameters
    ----------
    case
        Robot, loads and base. Damping, method and the rest are those of ``[motion]`` of its file; its commands over time are not used.
    dt
        Length of a step in s.
    steps
        Steps of an episode.
    greatest
        Greatest tension in N: of all cables, or (c,) of each.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self, case: Case, dt: Quantity = "10 ms", *, steps: int = 100, greatest: float | npt.ArrayLike = 5.0
    ) -> None:
        cables = len(case.robot.cables)
        limit = np.asarray(greatest, dtype=np.float64)
        if limit.shape not in ((), (cables,)) or not (np.isfinite(limit).all() and (limit > 0).all()):
            message = f"greatest must be a positive tension in N, or one for each of {cables} cables, but is {greatest!r}"
            raise InputError(message, path="greatest")
        self._dt, self._steps = step_length(dt), whole(steps, "steps")
        self._greatest: Array = np.broadcast_to(limit, cables).copy()
        self._case, self._length = case, float(case.robot.backbone.length)
        still = dict.fromkeys((cable.name for cable in case.robot.cables), 0.0)
        self._simulation = Simulation(case, tension=still)
        self._start = self._simulation.state
        self._place = self._start.tip
        self._action, self._count = np.zeros(cables), 0
        self.action_space = gymnasium.spaces.Box(0.0, 1.0, (cables,), np.float64)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (9 + cables,), np.float64)

    @property
    def simulation(self) -> Simulation:
        """The robot in motion."""
        return self._simulation

    @property
    def place(self) -> Array:
        """(3,) where the tip is to come, in m."""
        return self._place

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begins an episode.

        Parameters
        ----------
        seed
            Seed of the random numbers.
        options
            ``{"place": [x, y, z]}`` in m gives the place; else it is random.
        """
        super().reset(seed=seed)
        self._simulation.restore(self._start)
        self._action, self._count = np.zeros(len(self._greatest)), 0
        if options is not None and "place" in options:
            place = np.asarray(options["place"], dtype=np.float64)
            if place.shape != (3,) or not np.isfinite(place).all():
                raise InputError(f"place must be three numbers in m, but is {options['place']!r}", path="options")
            self._place = place
        else:
            tensions = self.np_random.uniform(0.0, self._greatest)
            self._place = np.array(self._case.solve(tension=tensions.tolist()).tip)
        return self._observation(), {}

    def step(self, action: npt.ArrayLike) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Takes a step.

        Parameters
        ----------
        action
            (c,) from 0 to 1: the part of its greatest tension that each cable has.
        """
        given = np.asarray(action, dtype=np.float64)
        if given.shape != self._action.shape or not np.isfinite(given).all():
            message = f"action must be {len(self._action)} finite numbers, one for each cable, but is {action!r}"
            raise InputError(message, path="action")
        asked = np.clip(given, 0.0, 1.0)
        change = float(np.mean((asked - self._action) ** 2))
        self._action = asked
        self._count += 1
        try:
            self._simulation.step(self._dt, tension=(asked * self._greatest).tolist())
        except MotionError:
            return self._observation(), -10.0, True, False, {}
        distance = float(np.linalg.norm(self._simulation.tip - self._place))
        reward = -distance / self._length - 0.01 * change
        return self._observation(), reward, False, self._count >= self._steps, {"distance": distance}

    def _observation(self) -> Array:
        tip, state = self._simulation.tip, self._simulation.state
        velocity = rotation(state.orientation[-1]) @ state.velocity[-1, :3]
        parts = ((tip - self._place) / self._length, tip / self._length, velocity / self._length, self._action)
        return np.concatenate(parts)
