#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests scripts with `mebots link`: cflib's classes connect, log, set parameters and fly, as in its examples."""

import math
import threading
import time
import unittest

import cflib.crtp
from cflib.crazyflie import Crazyflie
from cflib.crazyflie.log import LogConfig
from cflib.crazyflie.mem import MemoryElement, Poly4D
from cflib.crazyflie.swarm import CachedCfFactory, Swarm
from cflib.crazyflie.syncCrazyflie import SyncCrazyflie
from cflib.crazyflie.syncLogger import SyncLogger
from cflib.positioning.motion_commander import MotionCommander
from cflib.positioning.position_hl_commander import PositionHlCommander
from cflib.utils.reset_estimator import reset_estimator
from support import CONFIG, LinkCase

cflib.crtp.init_drivers()
# Drones reach a position with an error of a few centimetres, because the integral part of the controller compensates drag
# slowly.
REACHED_M = 0.1
ONE_WORLD = CONFIG.with_name("link_4.json")


def block(period_ms, **variables):
    config = LogConfig("block", period_ms)
    for name, kind in variables.items():
        config.add_variable(name.replace("__", "."), kind)
    return config


class State:
    """Records a drone's log and clock while a script flies it."""

    def __init__(self, scf):
        self.rows = []
        self.time_ms = 0
        self._log = block(20, stateEstimate__x="float", stateEstimate__y="float", stateEstimate__z="float", stateEstimate__yaw="float",
                          supervisor__info="uint16_t", pm__vbat="FP16", pm__state="int8_t")  # fmt: skip
        scf.cf.log.add_config(self._log)
        self._log.data_received_cb.add_callback(self._take)
        self._log.start()
        while not self.rows or not self["supervisor.info"] & 8:  # until then, the drone's clock is unknown
            time.sleep(0.01)

    def _take(self, time_ms, data, _block):
        self.rows.append(data)
        self.time_ms = time_ms

    def wait(self, seconds):
        """Waits in simulated time, which may be slow on a busy machine."""
        end_ms = self.time_ms + 1000 * seconds
        late_s = time.monotonic() + 20 + 20 * seconds
        while self.time_ms < end_ms and time.monotonic() < late_s:
            time.sleep(0.01)

    def __getitem__(self, name):
        return self.rows[-1][name]

    @property
    def position(self):
        return tuple(self[f"stateEstimate.{axis}"] for axis in "xyz")


class CflibCase(LinkCase):
    def connect(self, *options, **more):
        port = self.start(*options, **more)
        scf = SyncCrazyflie(f"udp://127.0.0.1:{port}", cf=Crazyflie(rw_cache=str(self.folder / "cache")))
        scf.open_link()
        self.addCleanup(scf.close_link)
        scf.wait_for_params()
        return scf

    def assert_near(self, found, wanted, most=REACHED_M):
        self.assertLess(math.dist(found, wanted), most, f"{found} is not near {wanted}")


class Connection(CflibCase):
    def test_scan_finds_the_drones(self):
        self.start(port=19850)
        self.assertIn(["udp://127.0.0.1:19850", ""], cflib.crtp.scan_interfaces())

    def test_variables_arrive_at_their_period_in_simulated_time(self):
        scf = self.connect()
        config = block(50, stabilizer__roll="float", stabilizer__pitch="float", stabilizer__yaw="float", pm__vbat="FP16", acc__z="float",
                       pm__batteryLevel="uint8_t", motor__m1="uint16_t")  # fmt: skip
        with SyncLogger(scf, config) as logger:
            rows = [row for _, row in zip(range(20), logger, strict=False)]
        self.assertEqual({after[0] - before[0] for before, after in zip(rows, rows[1:], strict=False)}, {50})
        data = rows[-1][1]
        self.assertAlmostEqual(data["acc.z"], 1.0, delta=0.02)
        self.assertAlmostEqual(data["pm.vbat"], 4.15, delta=0.1)
        self.assertEqual((data["motor.m1"], data["pm.batteryLevel"]), (0, 90))

    def test_parameters_are_read_written_and_stored(self):
        scf = self.connect()
        seen = []
        scf.cf.param.add_update_callback(group="stabilizer", name="estimator", cb=lambda name, value: seen.append((name, value)))
        scf.cf.param.set_value("stabilizer.estimator", 1)
        scf.cf.param.set_value("stabilizer.estimator", 2)
        scf.cf.param.set_value_raw("led.bitmask", 0x08, 255)
        time.sleep(0.3)
        self.assertEqual(seen, [("stabilizer.estimator", "1"), ("stabilizer.estimator", "2")])
        scf.cf.param.request_param_update("led.bitmask")
        time.sleep(0.2)
        self.assertEqual(scf.cf.param.get_value("led.bitmask"), "255")
        self.assertEqual(scf.cf.param.get_value("deck.bcFlow2"), "1")
        with self.assertRaises(AttributeError):
            scf.cf.param.set_value("deck.bcFlow2", 0)
        answers = []
        scf.cf.param.set_value("pm.lowVoltage", 3.5)
        scf.cf.param.persistent_store("pm.lowVoltage", lambda *answer: answers.append(answer))
        time.sleep(0.2)
        scf.cf.param.persistent_get_state("pm.lowVoltage", lambda _name, state: answers.append(state))
        scf.cf.param.get_default_value("pm.lowVoltage", lambda _name, value: answers.append(value))
        time.sleep(0.2)
        self.assertEqual(answers[0], ("pm.lowVoltage", True))
        self.assertEqual((answers[1].is_stored, answers[1].stored_value), (True, 3.5))
        self.assertAlmostEqual(answers[2], 3.2, places=6)

    def test_a_controller_that_is_not_simulated_is_refused(self):
        scf = self.connect()
        texts = []
        scf.cf.console.receivedChar.add_callback(texts.append)
        scf.cf.param.set_value("stabilizer.controller", 2)
        time.sleep(0.3)
        self.assertEqual(scf.cf.param.get_value("stabilizer.controller"), "1")
        self.assertIn("PID", "".join(texts))


class Flights(CflibCase):
    def test_motion_commander_flies_distances_and_turns(self):
        self.fly_by_the_wall_clock(self.fly_with_motion_commander)

    def test_position_high_level_commander_flies_a_square(self):
        self.fly_by_the_wall_clock(self.fly_with_position_commander)

    def fly_by_the_wall_clock(self, fly):
        """Runs a flight whose commanders wait by the wall clock. Repeats it if the machine was too busy."""
        for attempt in range(3):
            try:
                return fly()
            except AssertionError:
                if attempt == 2 or not self.was_slow():
                    raise
                self.doCleanups()
                self.setUp()
        return None

    def fly_with_motion_commander(self):
        scf = self.connect()
        state = State(scf)
        with MotionCommander(scf, default_height=0.5) as commander:
            state.wait(1)
            commander.forward(0.8, velocity=0.5)
            commander.left(0.4, velocity=0.5)
            state.wait(0.5)
            self.assert_near(state.position, (0.8, 0.4, 0.5), 0.15)
            commander.turn_left(90)
            state.wait(0.5)
            self.assertAlmostEqual(state["stateEstimate.yaw"], 90, delta=8)
        state.wait(0.5)
        self.assertLess(state.position[2], 0.05)

    def fly_with_position_commander(self):
        scf = self.connect()
        state = State(scf)
        with PositionHlCommander(scf, default_height=0.5, default_velocity=0.5) as commander:
            commander.forward(0.5)
            commander.left(0.5)
            state.wait(1)
            self.assert_near(state.position, (0.5, 0.5, 0.5))
            commander.go_to(0, 0)
            state.wait(1)
            self.assert_near(state.position, (0, 0, 0.5))
        state.wait(0.5)
        self.assertLess(state.position[2], 0.05)

    def test_high_level_commander_takes_off_goes_and_lands(self):
        scf = self.connect()
        state = State(scf)
        reset_estimator(scf)
        commander = scf.cf.high_level_commander
        commander.takeoff(1.0, 2.0)
        state.wait(2.5)
        self.assert_near(state.position, (0, 0, 1))
        self.assertTrue(scf.cf.supervisor.is_flying)
        commander.go_to(0.5, -0.5, 0, math.pi / 2, 2.0, relative=True)
        state.wait(3)
        self.assert_near(state.position, (0.5, -0.5, 1))
        self.assertAlmostEqual(state["stateEstimate.yaw"], 90, delta=8)
        commander.spiral(math.pi, 0.5, 0.5, 0.0, 3.0)
        state.wait(3.5)
        self.assert_near(state.position, (-0.5, -0.5, 1), 0.2)
        commander.land(0.0, 2.0)
        state.wait(2.2)
        commander.stop()
        state.wait(0.3)
        self.assertLess(state.position[2], 0.05)
        self.assertEqual(state["supervisor.info"] & 0xE0, 0)  # the drone has not tumbled, locked or crashed
        self.check_replay()

    def check_replay(self):
        """Checks that a replay of the recorded packets gives the bits of the run. Deletes the packet of the take-off, and checks that the
        replay reports other bits."""
        printed = self.stop()
        bits = self.recording()[-1]["bits"]
        self.assertIn(bits, printed)
        self.assertIn(bits, self.replay())
        lines = (self.out / "link.jsonl").read_text().splitlines(keepends=True)
        take_off = next(at for at, line in enumerate(lines) if '"packet": "8007' in line)
        (self.out / "link.jsonl").write_text("".join(lines[:take_off] + lines[take_off + 1 :]))
        self.assertIn("had the bits", self.replay(code=1))

    def test_uploaded_trajectory_is_flown(self):
        scf = self.connect()
        state = State(scf)
        memory = scf.cf.mem.get_mems(MemoryElement.TYPE_TRAJ)[0]
        line = Poly4D.Poly([0, 0.2, 0, 0, 0, 0, 0, 0])
        memory.trajectory = [Poly4D(3.0, x=line)]
        self.assertTrue(memory.write_data_sync())
        commander = scf.cf.high_level_commander
        commander.define_trajectory(1, 0, 1)
        commander.takeoff(0.6, 1.5)
        state.wait(2)
        commander.start_trajectory(1, 1.0, relative_position=True)
        state.wait(4)
        self.assert_near(state.position, (0.6, 0, 0.6))

    def test_position_and_velocity_set_points_are_followed(self):
        scf = self.connect()
        state = State(scf)
        for _ in range(10):
            scf.cf.commander.send_velocity_world_setpoint(0, 0, 0.4, 0)
            state.wait(0.1)
        for _ in range(40):
            scf.cf.commander.send_position_setpoint(0.4, -0.3, 0.8, 45)
            state.wait(0.1)
        self.assert_near(state.position, (0.4, -0.3, 0.8))
        self.assertAlmostEqual(state["stateEstimate.yaw"], 45, delta=5)
        half = math.sqrt(0.5)
        for _ in range(40):
            scf.cf.commander.send_full_state_setpoint([0, 0, 0.6], [0] * 3, [0] * 3, [0, 0, half, half], 0, 0, 0)
            state.wait(0.1)
        self.assert_near(state.position, (0, 0, 0.6))
        self.assertAlmostEqual(state["stateEstimate.yaw"], 90, delta=5)

    def test_a_swarm_of_two_flies(self):
        port = self.start("--drones", "2", drones=2)
        uris = [f"udp://127.0.0.1:{port + i}" for i in range(2)]
        ends = {}

        def fly(scf, side):
            state = State(scf)
            scf.cf.high_level_commander.takeoff(0.5, 1.5)
            state.wait(2)
            scf.cf.high_level_commander.go_to(0.5, 0, 0, 0, 1.5, relative=True)
            state.wait(2.5)
            ends[side] = state.position
            scf.cf.high_level_commander.land(0.0, 1.5)
            state.wait(1.7)
            scf.cf.high_level_commander.stop()

        with Swarm(uris, factory=CachedCfFactory(rw_cache=str(self.folder / "cache"))) as swarm:
            swarm.parallel_safe(fly, args_dict={uri: [i] for i, uri in enumerate(uris)})
        self.assert_near(ends[0], (0.5, 0, 0.5))
        self.assert_near(ends[1], (0.5, 1, 0.5))


class Trouble(CflibCase):
    def test_a_script_that_falls_silent_in_flight_locks_the_drone(self):
        scf = self.connect()
        state = State(scf)
        for _ in range(10):
            scf.cf.commander.send_hover_setpoint(0, 0, 0, 0.3)
            state.wait(0.1)
        state.wait(2.6)
        self.assertIn("Is locked", scf.cf.supervisor.read_state_list())

    def test_a_fall_from_a_metre_is_a_crash(self):
        scf = self.connect()
        state = State(scf)
        scf.cf.high_level_commander.takeoff(1.0, 2.0)
        state.wait(2.5)
        scf.cf.high_level_commander.stop()
        state.wait(1.0)
        states = scf.cf.supervisor.read_state_list()
        self.assertIn("Is crashed", states)
        self.assertNotIn("Can fly", states)
        scf.cf.high_level_commander.takeoff(1.0, 2.0)
        state.wait(1.0)
        self.assertFalse(scf.cf.supervisor.is_flying)

    def test_drones_of_one_world_touch_each_other(self):
        port = self.start(config=ONE_WORLD, drones=4)
        uris = [f"udp://127.0.0.1:{port + i}" for i in range(2)]
        path = {}

        def fly(scf, index):
            state = State(scf)
            scf.cf.high_level_commander.takeoff(0.5, 1.5)
            state.wait(2)
            start = len(state.rows)
            if index == 0:  # flies to the place of the other drone, 0.5 m away
                scf.cf.high_level_commander.go_to(0, 0.5, 0, 0, 0.4, relative=True)
            state.wait(3)
            path[index] = [row["stateEstimate.y"] for row in state.rows[start:]]

        with Swarm(uris, factory=CachedCfFactory(rw_cache=str(self.folder / "cache"))) as swarm:
            swarm.parallel_safe(fly, args_dict={uri: [i] for i, uri in enumerate(uris)})
        self.assertAlmostEqual(path[1][0], 0.5, delta=0.01)
        self.assertGreater(max(path[1]), 0.53, "the other drone pushes it away")
        self.assertLess(path[0][-1], path[1][-1] - 0.05)
        printed = self.stop()
        self.assertIn(self.recording()[-1]["bits"], printed)
        self.assertIn(self.recording()[-1]["bits"], self.replay(config=ONE_WORLD))

    def test_a_weak_battery_warns_and_then_ends_the_link(self):
        lost = threading.Event()
        scf = self.connect("--set", "battery.cell.initial_state_of_charge=0.1")
        scf.cf.connection_lost.add_callback(lambda *_: lost.set())
        scf.cf.param.set_value("pm.lowVoltage", 3.8)
        state = State(scf)
        scf.cf.high_level_commander.takeoff(0.5, 1.0)
        self.assertTrue(lost.wait(120), "the connection was not lost")
        self.assertEqual(state["pm.state"], 3)
        self.assertLess(state["pm.vbat"], 3.8)
        self.assertIn("no drone has power", self.end())


if __name__ == "__main__":
    unittest.main()
