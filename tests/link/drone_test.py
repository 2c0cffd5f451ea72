#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests parts of a linked drone: trajectories, planner, set-points and supervisor."""

import math
import random
import struct
import unittest

from mebots.link.angles import arc_tangent, sine_and_cosine
from mebots.link.control import Mode
from mebots.link.crtp import MAX_DATA, Packet
from mebots.link.drone import Drone
from mebots.link.planner import Planner
from mebots.link.readings import Readings
from mebots.link.scalars import FLOAT, HALF, INT8, INT16, UINT8
from mebots.link.supervisor import State
from mebots.link.trajectories import Ends, Path, Piece, between

STANDING = Readings((0.0, 0.0, 0.0145), (0.0, 0.0, 0.0), 0.0, 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 9.81), (0.0,) * 4, 0.0, 4.1, False)


def derivative(coefficients):
    return [power * one for power, one in enumerate(coefficients)][1:]


def value(coefficients, t):
    return sum(one * t**power for power, one in enumerate(coefficients))


class Angles(unittest.TestCase):
    def test_they_agree_with_the_c_library(self):
        chance = random.Random(1)
        for _ in range(2000):
            angle = chance.uniform(-20, 20)
            sine, cosine = sine_and_cosine(angle)
            self.assertAlmostEqual(sine, math.sin(angle), delta=1e-15)
            self.assertAlmostEqual(cosine, math.cos(angle), delta=1e-15)
            x, y = chance.uniform(-2, 2), chance.uniform(-2, 2)
            self.assertAlmostEqual(arc_tangent(y, x), math.atan2(y, x), delta=1e-14)


class Trajectories(unittest.TestCase):
    def test_a_polynomial_meets_its_ends_without_jerk(self):
        for duration in (0.5, 2.0, 7.0):
            start, end = Ends(1.0, 2.0, 3.0), Ends(-2.0, 0.5, 0.7)
            polynomial = between(start, end, duration)
            for t, ends in ((0.0, start), (duration, end)):
                rows = [polynomial]
                for _ in range(3):
                    rows.append(derivative(rows[-1]))
                for row, wanted in zip(rows, (*vars_of(ends), 0.0), strict=True):
                    self.assertAlmostEqual(value(row, t), wanted, delta=1e-9)

    def test_stretched_and_reversed_paths_pass_the_same_points(self):
        chance = random.Random(2)
        pieces = [Piece(tuple([chance.uniform(-1, 1) for _ in range(8)] for _ in range(4)), 1.5) for _ in range(2)]
        forward, slow, back = Path(pieces, 0.0), Path(pieces, 0.0, 2.0), Path(pieces, 0.0, 1.0, True)
        for t in (0.2, 1.1, 1.7, 2.9):
            self.assertEqual(len(forward.at(t).position_m), 3)
            for ours, other in ((slow.at(2 * t), 0.5), (back.at(3 - t), -1.0)):
                for axis in range(3):
                    self.assertAlmostEqual(ours.position_m[axis], forward.at(t).position_m[axis], delta=1e-9)
                    self.assertAlmostEqual(ours.velocity_m_per_s[axis], other * forward.at(t).velocity_m_per_s[axis], delta=1e-9)

    def test_a_spiral_keeps_its_distance_from_the_centre(self):
        """The path is a polynomial of degree 7. For a quarter circle, its distance from the centre is within 0.8 % of the radius."""
        for clockwise, centre in ((True, (0.0, -1.0)), (False, (0.0, 1.0))):
            planner = Planner()
            planner.spiral(math.pi / 2, (1.0, 1.0), 0.5, 4.0, 0.0, sideways=False, clockwise=clockwise)
            for tick in range(401):
                x, y, _ = planner.goal(tick / 100.0).position_m
                self.assertAlmostEqual(math.hypot(x - centre[0], y - centre[1]), 1.0, delta=0.008)
            self.assertAlmostEqual(planner.goal(4.0).position_m[2], 0.5, delta=1e-9)
            self.assertAlmostEqual(planner.goal(4.0).position_m[0], 1.0, delta=1e-9)
            self.assertAlmostEqual(planner.goal(4.0).position_m[1], centre[1], delta=1e-9)

    def test_a_linear_path_has_a_constant_speed(self):
        planner = Planner()
        planner.go_to((1.0, 2.0, 3.0), 0.0, 2.0, 0.0, relative=False, linear=True)
        for t in (0.0, 0.7, 1.9):
            for axis, wanted in enumerate((0.5, 1.0, 1.5)):
                self.assertAlmostEqual(planner.goal(t).velocity_m_per_s[axis], wanted, delta=1e-9)


def vars_of(ends):
    return ends.value, ends.rate, ends.acceleration


class Scalars(unittest.TestCase):
    def test_values_are_cut_as_in_c(self):
        self.assertEqual(UINT8.pack(257.9), b"\1")
        self.assertEqual(INT8.unpack(INT8.pack(-1.9)), -1)
        self.assertEqual(INT16.unpack(INT16.pack(40000)), 40000 - 65536)
        self.assertEqual(HALF.unpack(HALF.pack(1e9)), math.inf)
        self.assertEqual(FLOAT.unpack(FLOAT.pack(-1e99)), -math.inf)
        self.assertEqual(UINT8.pack(math.nan), b"\0")


class Firmware(unittest.TestCase):
    def setUp(self):
        self.drone = Drone(["bcFlow2"], STANDING)
        self.run_for(0.4)

    def run_for(self, seconds, now=STANDING):
        """Runs the drone for this time. Returns the inputs of the last period."""
        inputs = None
        for _ in range(round(100 * seconds)):
            inputs = self.drone.control()
            self.drone.advance(now)
        return inputs

    def send(self, port, data, channel=0):
        return self.drone.handle(Packet(port, channel, data))

    def hover(self):
        self.send(7, struct.pack("<Bffff", 10, 0.1, 0.2, 45.0, 0.4))

    def test_it_arms_itself_and_flies_on_a_set_point(self):
        self.assertEqual(self.drone.supervisor.state, State.READY)
        self.hover()
        inputs = self.run_for(0.1)
        self.assertEqual(inputs.mode, Mode.FLY)
        self.assertAlmostEqual(inputs.forward_m_per_s, 0.1, places=6)
        self.assertAlmostEqual(inputs.left_m_per_s, 0.2, places=6)
        self.assertAlmostEqual(inputs.yaw_rate_rad_per_s, math.pi / 4, places=6)
        self.assertAlmostEqual(inputs.altitude_m, 0.4, places=6)

    def test_a_take_off_is_accepted_as_soon_as_the_supervisor_says_that_the_drone_can_fly(self):
        take_off = struct.pack("<BBff?f", 7, 0, 1.0, 0.0, False, 2.0)
        beside = STANDING._replace(position_m=(0.0, 1.0, 0.0145))
        drone = Drone(["bcFlow2"], beside)
        for _ in range(40):
            can_fly = drone.info & 8 != 0
            (answer,) = drone.handle(Packet(8, 0, take_off))
            self.assertEqual(answer.data[3] == 0, can_fly, f"at {drone.now_ms} ms")
            drone.control()
            if can_fly:
                self.assertEqual(drone.setpoint.position_m, (0.0, 1.0))  # it rises vertically
                return
            drone.advance(beside)
        self.fail("the drone never could fly")

    def test_old_set_points_level_the_drone_out_and_then_lock_it(self):
        flying = STANDING._replace(motors=(0.5,) * 4, velocity_m_per_s=(0.3, 0.0, 0.0))
        self.hover()
        self.run_for(0.4, flying)
        self.assertEqual(self.drone.supervisor.state, State.FLYING)
        inputs = self.run_for(0.3, flying)
        self.assertEqual(self.drone.supervisor.state, State.LEVEL_OUT)
        self.assertEqual((inputs.forward_m_per_s, inputs.left_m_per_s), (0.3, 0.0))
        self.assertEqual(self.run_for(1.5, flying).mode, Mode.OFF)
        self.assertEqual(self.drone.supervisor.state, State.LOCKED)

    def test_the_high_level_commander_waits_until_set_points_are_handed_over(self):
        self.hover()
        self.send(8, struct.pack("<BBff?f", 7, 0, 1.0, 0.0, False, 2.0))
        self.assertEqual(self.run_for(0.1).altitude_m, self.run_for(0.1).altitude_m)
        self.send(7, struct.pack("<BI", 0, 0), channel=1)
        self.assertNotEqual(self.run_for(0.1).altitude_m, self.run_for(0.1).altitude_m)

    def test_positions_become_velocities_along_the_heading(self):
        """The firmware's gain is 2 1/s, and its limit is 1.1 m/s."""
        turned = STANDING._replace(yaw_rad=math.pi / 2)
        self.send(7, struct.pack("<Bffff", 7, 0.2, 0.1, 0.5, 90.0))
        inputs = self.run_for(0.02, turned)
        self.assertAlmostEqual(inputs.forward_m_per_s, 0.2, delta=1e-6)
        self.assertAlmostEqual(inputs.left_m_per_s, -0.4, delta=1e-6)
        self.assertAlmostEqual(inputs.yaw_rate_rad_per_s, 0.0, delta=1e-6)
        self.send(7, struct.pack("<Bffff", 7, 9.0, 0.0, 0.5, 90.0))
        self.assertAlmostEqual(self.run_for(0.02, turned).left_m_per_s, -1.1, delta=1e-6)

    def test_limits_of_log_blocks_are_the_firmwares(self):
        """The firmware's limits are 16 blocks, 128 variables and 26 bytes. The error numbers are those of its C
        library.
        """

        def create(number, fields, command=6):
            return self.send(5, bytes([command, number]) + bytes((1, 0, 0)) * fields, channel=1)[0].data[2]

        self.assertEqual([create(number, 8) for number in range(16)], [0] * 16)
        self.assertEqual(create(0, 1, command=7), 12)  # the 129th variable
        self.assertEqual((create(3, 1), create(16, 1), create(99, 1, command=7)), (17, 12, 2))
        self.send(5, b"\5", channel=1)
        self.assertEqual((create(1, 9), create(1, 9, command=7), create(1, 9, command=7)), (0, 0, 7))

    def test_attitude_set_points_are_refused_with_a_text(self):
        answers = self.send(3, struct.pack("<fffH", 10.0, 0.0, 0.0, 40000))
        self.assertIn(b"roll, pitch", b"".join(answer.data for answer in answers if answer.port == 0))
        self.assertEqual(self.run_for(0.1).mode, Mode.OFF)

    def test_a_voltage_that_stays_low_is_reported_after_5_s(self):
        low = STANDING._replace(bus_voltage_v=3.1)
        self.run_for(4.9, low)
        self.assertEqual(self.drone.power.state, 0)
        self.run_for(0.5, low)
        self.assertEqual(self.drone.power.state, 3)

    def test_without_supply_it_does_not_answer(self):
        self.run_for(0.1, STANDING._replace(bus_voltage_v=0.0))
        self.assertEqual(self.send(15, b"\0", channel=1), [])

    def test_random_packets_have_no_effect_on_its_health(self):
        chance = random.Random(3)
        for number in range(60000):
            port = chance.choice((0, 2, 3, 4, 5, 6, 7, 8, 13, 15))
            data = bytes(chance.randrange(14 if chance.random() < 0.3 else 256) for _ in range(chance.randrange(MAX_DATA + 1)))
            for answer in self.send(port, data, chance.randrange(4)):
                self.assertLessEqual(len(answer.encode()), MAX_DATA + 1)
            if number % 20 == 0:
                self.assertTrue(all(math.isfinite(one) for one in self.drone.control()))
                self.drone.advance(STANDING)
        self.assertNotEqual(self.drone.supervisor.state, State.CRASHED)


if __name__ == "__main__":
    unittest.main()
