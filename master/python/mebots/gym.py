# SPDX-License-Identifier: Apache-2.0
"""A mission as an environment of Gymnasium: an agent writes unconnected inputs and reads variables by their names.

    import mebots.gym

    def take_off(mission):
        mission.run_until(3)
        mission.write("world.setpoint.mode", 2)  # fly

    env = mebots.gym.MissionEnv(
        "configs/hover.json",
        prepare=take_off,
        actions={"world.setpoint.velocity.x": (-1, 1), "world.setpoint.velocity.y": (-1, 1)},
        observations=["world.drone.position.x", "world.drone.position.y", "battery.energy.delivered"],
        reward=lambda before, after: after["world.drone.position.x"] - before["world.drone.position.x"],
        period=0.1,
    )
    observation, info = env.reset(seed=1)

``gymnasium.make("mebots/Mission-v0", config=..., ...)`` returns the same environment. Needs Gymnasium: pip install 'mebots[gym]'.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mebots.errors import InputError
from mebots.exploration import chance
from mebots.extras import extra
from mebots.mission import Mission, Path, Scalar

if TYPE_CHECKING:
    import gymnasium
else:
    gymnasium = extra("gymnasium", "mebots.gym", "gymnasium", "gym")

Values = dict[str, float]
"""Values of the observed variables, and of ``time`` [s]."""

_ENDS = ("stop_condition", "terminated")
"""Reasons for which an episode is terminated; at the stop time it is truncated."""


@dataclasses.dataclass(frozen=True)
class State:
    """Describes a point of an episode: the values that were set so far, and the state of all FMUs. Can be pickled."""

    settings: dict[str, Scalar]
    data: bytes


class MissionEnv(gymnasium.Env):
    """An episode is a run of the mission. Equal seeds and actions give equal episodes, bit for bit.

    :param config: config, FMU or SSP, or the content of a config as a dict, as for ``mebots.Mission``.
    :param actions: maps each input to a tuple of its least and greatest value, or maps each input to a list of permitted values.
    An input must be unconnected. Tunable parameters may be used, too.
    :param observations: names of variables, or a dict that maps each name to its least and greatest value.
    :param reward: called with the ``Values`` before and after a step.
    :param prepare: called with the mission at the start of an episode, for example for a take-off, or to set constant inputs.
    :param period: time between actions [s]; the communication step by default.
    :param set: values for parameters and start values, in place of the config's.
    :param draws: parameters and start values that each ``reset`` draws, with their distributions as in a study:
        {"world.start.yaw_offset": {"uniform": [-0.3, 0.3]}}.
    :param stop_time: end of an episode [s], in place of the config's.
    :param isolate: True runs every FMU in its own process.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": []}

    def __init__(
        self,
        config: Path | Mapping[str, Any],
        *,
        actions: Mapping[str, tuple[float, float] | Sequence[float]],
        observations: Sequence[str] | Mapping[str, tuple[float, float]],
        reward: Callable[[Values, Values], float],
        prepare: Callable[[Mission], None] | None = None,
        period: float | None = None,
        set: Mapping[str, Scalar] | None = None,
        draws: Mapping[str, Any] | None = None,
        stop_time: float | None = None,
        isolate: bool = False,
    ) -> None:
        self._actions = dict(actions)
        self._names = list(observations)
        self._reward = reward
        self._prepare = prepare
        self._period_s = period
        self._set = dict(set or {})
        self._draws = dict(draws or {})
        self._stop_time_s = stop_time
        self._settings: dict[str, Scalar] = {}
        self._values: Values = {}
        self.action_space = _action_space(self._actions)
        self.observation_space = _observation_space(observations)
        # Records nothing, because agents need only current values.
        self.mission = Mission(config, in_memory=False, isolate=isolate, uncertainty="none")
        for name, values in self._actions.items():
            self.mission.set(name, values[0])  # raises InputError for an unknown name; reset() drops the value

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """Starts an episode. ``options``: {"state": State} continues from ``save_state`` of this config, in this
        process or another; {"set": {...}} are values for this episode only. Raises InputError for both together,
        because a state already contains its values, and for other options."""
        super().reset(seed=seed)
        options = options or {}
        state = options.get("state")
        _check_options(options)
        self.mission.reset()
        if self._stop_time_s is not None:
            self.mission.set_stop_time(self._stop_time_s)
        drawn = {name: chance.value(spread, self.np_random.random()) for name, spread in self._draws.items()}
        self._settings = state.settings if state is not None else self._set | drawn | options.get("set", {})
        for name, value in self._settings.items():
            self.mission.set(name, value)
        if state is not None:
            self.mission.start_from(state.data)
        self.mission.start()
        if self._prepare is not None and state is None:
            self._prepare(self.mission)
        self._begin_s, self._steps = self.mission.time, 0
        self._values = self._read()
        return self._observation(), self._info()

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Writes the action and simulates one period. Raises InputError if ``step_control`` performs a step that ends after the period."""
        for name, value in zip(self._actions, self._inputs(action), strict=True):
            self.mission.write(name, value)
        self._steps += 1
        self._run_until(self._begin_s + self._steps * (self._period_s or self.mission.step_size))
        before, self._values = self._values, self._read()
        terminated = self.mission.ended and self.mission.end_reason in _ENDS
        truncated = self.mission.ended and not terminated
        return self._observation(), float(self._reward(before, self._values)), terminated, truncated, self._info()

    def save_state(self) -> State:
        """Returns the current state of the episode. ``reset`` can continue from it."""
        return State(dict(self._settings), self.mission.save_state())

    def close(self) -> None:
        """Ends the mission."""
        self.mission.close()

    def _run_until(self, time_s: float) -> None:
        self.mission.run_until(time_s)
        if self.mission.time - time_s > 0.99 * self.mission.step_size:
            raise InputError(
                f"period: the mission stepped to {self.mission.time:g} s, past the end of the period at {time_s:g} s, because its "
                "config has 'step_control'. Remove 'step_control' from the config",
                "invalid_value",
            )

    def _inputs(self, action: Any) -> list[float]:
        if isinstance(self.action_space, gymnasium.spaces.Box):
            return [float(one) for one in action]
        return [float(values[int(at)]) for values, at in zip(self._actions.values(), action, strict=True)]

    def _read(self) -> Values:
        return {name: self.mission.value(name) for name in self._names} | {"time": self.mission.time}

    def _observation(self) -> np.ndarray:
        return np.array([self._values[name] for name in self._names], np.float32)

    def _info(self) -> dict[str, Any]:
        return {"time": self.mission.time, "outcome": self.mission.outcome}


def _check_options(options: Mapping[str, Any]) -> None:
    for key in options:
        if key not in ("state", "set"):
            raise InputError(f"options: there is no option '{key}'; 'state' and 'set' can be given", "unknown_name")
    if options.get("state") is not None and options.get("set"):
        names = ", ".join(f"'{name}'" for name in options["set"])
        raise InputError(
            f"options: 'set' ({names}) cannot change an episode that continues from a 'state'. Give one of the two", "invalid_value"
        )


def _action_space(actions: Mapping[str, tuple[float, float] | Sequence[float]]) -> gymnasium.spaces.Space:
    if not actions:
        raise InputError("actions: an environment needs an input, as in {'world.setpoint.velocity.x': (-1, 1)}", "missing_key")
    if all(isinstance(values, tuple) and len(values) == 2 for values in actions.values()):
        low, high = zip(*actions.values(), strict=True)
        return gymnasium.spaces.Box(np.array(low, np.float32), np.array(high, np.float32))
    for name, values in actions.items():
        if isinstance(values, tuple) or not len(values):
            raise InputError(
                f"actions: '{name}': {values!r}: all actions must be tuples (least, greatest), or all must be lists of values", "invalid_value"
            )
    return gymnasium.spaces.MultiDiscrete([len(values) for values in actions.values()])


def _observation_space(observations: Sequence[str] | Mapping[str, tuple[float, float]]) -> gymnasium.spaces.Box:
    bounds = list(observations.values()) if isinstance(observations, Mapping) else [(-np.inf, np.inf)] * len(observations)
    low, high = np.array(bounds, np.float32).reshape(-1, 2).T
    return gymnasium.spaces.Box(low, high)


gymnasium.register(id="mebots/Mission-v0", entry_point="mebots.gym:MissionEnv")
