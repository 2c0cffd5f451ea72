#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `mebots.gym` with Gymnasium's checker, and its seeds, saved states and ends of episodes."""

import json
import os
import pathlib
import pickle
import subprocess
import sys
import time
import unittest
import warnings

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env

import mebots.gym

SOURCE = pathlib.Path(os.environ["MEBOTS_SOURCE"])
HOVER = SOURCE / "configs" / "hover.json"
ROTORS = SOURCE / "configs" / "battery_motors.json"
POSITION = {f"world.drone.position.{axis}": (-100, 100) for axis in "xyz"}
LEAST_STEPS_PER_S = 50  # on a busy machine, under ctest


def take_off(mission):
    mission.run_until(3)
    mission.write("world.setpoint.mode", 2)


def hover(**more):
    given = {
        "actions": {"world.setpoint.velocity.x": (-1, 1), "world.setpoint.velocity.y": (-1, 1)},
        "observations": POSITION | {"battery.cell.voltage": (0, 5)},
        "reward": lambda before, after: after["world.drone.position.x"] - before["world.drone.position.x"],
        "prepare": take_off, "period": 0.1, "stop_time": 6,
    }  # fmt: skip
    return mebots.gym.MissionEnv(HOVER, **given | more)


def episode(env, actions, **reset):
    """Runs an episode. Returns everything that an agent receives."""
    seen = [env.reset(**reset)[0]]
    rewards = []
    for action in actions:
        observation, reward, *_ = env.step(np.array(action, np.float32))
        seen.append(observation)
        rewards.append(reward)
    return np.array(seen), rewards


class Environments(unittest.TestCase):
    def test_passes_the_checker_of_gymnasium(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            check_env(hover(), skip_render_check=True)
            made = gymnasium.make("mebots/Mission-v0", config=ROTORS, actions={f"motors.rotor[{i}].command": (0, 1) for i in range(1, 5)},
                                  observations={"battery.bus.voltage": (0, 5)}, reward=lambda before, after: 0.0)
            check_env(made.unwrapped, skip_render_check=True)

    def test_actions_move_the_drone_and_make_the_reward(self):
        seen, rewards = episode(hover(), [(0.5, 0)] * 20, seed=1)
        self.assertGreater(seen[-1][0], 0.5)
        self.assertLess(abs(seen[-1][1]), 0.1)
        self.assertAlmostEqual(sum(rewards), seen[-1][0] - seen[0][0], 5)
        self.assertGreater(seen[0][2], 0.5, "prepare() took off")

    def test_a_seed_draws_the_same_episode_and_another_one_another(self):
        env = hover(draws={"world.start.offset.x": {"uniform": [-0.3, 0.3]}})
        first, _ = episode(env, [(0.5, 0.1)] * 5, seed=1)
        other, _ = episode(env, [(0.5, 0.1)] * 5, seed=2)
        again, _ = episode(env, [(0.5, 0.1)] * 5, seed=1)
        np.testing.assert_array_equal(first, again)
        self.assertNotEqual(first[0][0], other[0][0])
        self.assertLessEqual(abs(first[0][0] - other[0][0]), 0.65)
        following, _ = episode(env, [(0.5, 0.1)] * 5)
        self.assertNotEqual(following[0][0], again[0][0], "an episode without a seed draws on")

    def test_an_episode_continues_from_a_saved_state_also_in_another_process(self):
        env = hover(draws={"world.start.offset.x": {"uniform": [-0.3, 0.3]}})
        episode(env, [(0.5, 0)] * 5, seed=3)
        state = env.save_state()
        rest = [env.step(np.array((0, 0.5), np.float32))[0] for _ in range(5)]
        continued, _ = episode(env, [(0, 0.5)] * 5, options={"state": state})
        np.testing.assert_array_equal(continued[1:], rest)
        code = "import sys, pickle, gym_test as t; seen, _ = t.episode(t.hover(), [(0, 0.5)] * 5, options={'state': pickle.load(sys.stdin.buffer)}); sys.stdout.buffer.write(pickle.dumps(seen))"
        done = subprocess.run([sys.executable, "-c", code], input=pickle.dumps(state), capture_output=True, timeout=100, cwd=pathlib.Path(__file__).parent)
        self.assertEqual(done.returncode, 0, done.stderr)
        np.testing.assert_array_equal(pickle.loads(done.stdout), continued)

    def test_an_episode_is_truncated_at_the_stop_time_and_terminated_by_a_stop_condition(self):
        env = hover(period=0.5, stop_time=4)
        env.reset(seed=1)
        ends = [env.step(np.zeros(2, np.float32))[2:4] for _ in range(2)]
        self.assertEqual(ends, [(False, False), (False, True)])
        env = hover(actions={"world.setpoint.mode": [0, 1]}, period=0.5, stop_time=100)
        env.reset()
        for _ in range(40):
            _, _, terminated, truncated, info = env.step([0])  # motors off in the air
            if terminated or truncated:
                break
        self.assertEqual((terminated, truncated), (True, False), info)

    def test_values_to_choose_from_are_written_as_they_are(self):
        env = hover(actions={"world.setpoint.velocity.x": [-0.5, 0, 0.5], "world.setpoint.velocity.y": [0]})
        self.assertEqual(env.action_space, gymnasium.spaces.MultiDiscrete([3, 1]))
        back, _ = episode(env, [(0, 0)] * 20, seed=1)
        forth, _ = episode(env, [(2, 0)] * 20, seed=1)
        self.assertLess(back[-1][0], -0.5)
        self.assertGreater(forth[-1][0], 0.5)

    def test_mistakes_name_what_is_wrong(self):
        with self.assertRaisesRegex(mebots.InputError, "setpoint.forward"):
            hover(actions={"world.setpoint.forward": (-1, 1)})
        with self.assertRaisesRegex(mebots.InputError, "all actions must be tuples"):
            hover(actions={"world.setpoint.velocity.x": (-1, 1), "world.setpoint.velocity.y": [0, 1]})
        with self.assertRaisesRegex(mebots.InputError, "needs an input"):
            hover(actions={})
        env = hover(actions={"motors.rotor[1].command": (0, 1)}, prepare=None)
        env.reset()
        with self.assertRaisesRegex(mebots.InputError, "rotor"):  # the rotor has a connection
            env.step(np.array([1], np.float32))

    def test_options_that_would_have_no_effect_are_refused(self):
        env = hover()
        env.reset(seed=1)
        state = env.save_state()
        with self.assertRaisesRegex(mebots.InputError, "'set' \\('world.start.offset.x'\\) cannot change"):
            env.reset(options={"state": state, "set": {"world.start.offset.x": 0.1}})
        with self.assertRaisesRegex(mebots.InputError, "no option 'sets'"):
            env.reset(options={"sets": {}})

    def test_steps_past_the_end_of_a_period_are_refused(self):
        config = json.loads(ROTORS.read_text()) | {"step_control": {"max_step": 0.05}}
        env = mebots.gym.MissionEnv(config, actions={f"motors.rotor[{i}].command": (0, 1) for i in range(1, 5)},
                                    observations=["battery.bus.voltage"], reward=lambda before, after: 0.0, period=0.02)
        env.reset(seed=1)
        with self.assertRaisesRegex(mebots.InputError, "step_control"):
            for _ in range(100):
                env.step(np.full(4, 0.5, np.float32))

    def test_it_is_fast_enough_for_learning(self):
        env = gymnasium.make("mebots/Mission-v0", config=ROTORS, actions={f"motors.rotor[{i}].command": (0, 1) for i in range(1, 5)},
                             observations={"battery.bus.voltage": (0, 5)}, reward=lambda before, after: 0.0, disable_env_checker=True)
        env.reset(seed=1)
        action = np.full(4, 0.5, np.float32)
        begin = time.perf_counter()
        for _ in range(2000):
            env.step(action)
        rate = 2000 / (time.perf_counter() - begin)
        print(f"battery_motors, 2 ms: {rate:.0f} steps/s")
        self.assertGreater(rate, LEAST_STEPS_PER_S)
        begin = time.perf_counter()
        for _ in range(10):
            env.reset()
        print(f"a reset: {1e3 * (time.perf_counter() - begin) / 10:.1f} ms")


if __name__ == "__main__":
    unittest.main()
