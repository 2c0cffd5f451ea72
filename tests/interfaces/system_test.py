#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `mebots.System`: systems that a program builds."""

import json
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

import mebots

CONFIG = pathlib.Path(os.environ["MEBOTS_SOURCE"]) / "configs" / "battery_motors.json"


def rotors_on_a_battery(**more):
    system = mebots.System(step=0.002, stop_time=1, **more)
    motors = system.add("motors", "fmu_motors", {f"rotor[{i}].command": 0.6 for i in range(1, 5)})
    battery = system.add("battery", "fmu_battery")
    system.connect(battery["bus.voltage"], motors["bus.voltage"])
    system.connect(motors["power"], battery["motors.power"])
    system.connect("motors.avionics.power", "battery.avionics.power")
    return system


class Systems(unittest.TestCase):
    def test_it_gives_the_bits_of_the_same_config(self):
        voltages = []
        for mission in (rotors_on_a_battery().mission(record=["battery.bus.voltage"]), mebots.Mission(CONFIG, stop_time=1, record=["battery.bus.voltage"])):
            with mission:
                mission.run()
                voltages.append(mission["battery.bus.voltage"])
        np.testing.assert_array_equal(*voltages)

    def test_a_written_system_is_a_mission_of_a_study(self):
        with tempfile.TemporaryDirectory() as folder:
            file = rotors_on_a_battery(summary={"charge": "battery.cell.state_of_charge"}).write(f"{folder}/rotors.json")
            self.assertEqual(json.loads(file.read_text())["summary"], {"charge": "battery.cell.state_of_charge"})
            found = mebots.sweep({"mission": str(file), "design": {"kind": "grid", "factors": {"motors.rotor[1].command": [0.4, 0.6]}},
                                  "objectives": {"charge": {"summary": "charge", "maximize": True}}}, jobs=1)
            self.assertIn("Highest charge: command 0.4", str(found.answer))

    def test_a_config_that_is_changed_leaves_the_system_as_it_was(self):
        system = rotors_on_a_battery()
        system.config["instances"].clear()
        self.assertEqual(sorted(system.config["instances"]), ["battery", "motors"])

    def test_mistakes_are_named(self):
        system = rotors_on_a_battery()
        with self.assertRaisesRegex(mebots.InputError, "'battery'.*instance with this name"):
            system.add("battery", "fmu_battery")
        system.connect("motors.powr", "battery.motors.power")
        with self.assertRaisesRegex(mebots.InputError, "powr"):
            system.mission().run()


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
