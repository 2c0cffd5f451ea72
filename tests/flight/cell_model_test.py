#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that the fast cell model in bench/flight agrees with fmu_battery."""

import json
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

import mebots

sys.path.insert(0, str(pathlib.Path(os.environ["MEBOTS_SOURCE"]) / "bench/flight"))
import cell_model  # noqa: E402

STEP_S = 0.05
DURATION_S = 120
MASS_KG = 0.0376


class FastCell(unittest.TestCase):
    def fmu_voltage(self, cell, charge, power_w):
        """Returns the cell voltage that fmu_battery computes, as the mean over each interval of the fast cell model. ``power_w`` gives the
        power as a function of the voltage."""
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "mission.json"
            file.write_text(json.dumps({
                "step": STEP_S, "stop_time": DURATION_S, "connections": [],
                "instances": {"battery": {"fmu": "fmu_battery", "parameters": {"cell.name": cell, "cell.initial_state_of_charge": charge}}},
            }))
            with mebots.Mission(file) as run:
                run.start()
                voltage = [run.value("battery.cell.voltage") - 0.4]
                for _ in range(round(DURATION_S / STEP_S)):
                    run.write("battery.motors.power", float(power_w(np.array(voltage[-1]))))
                    run.step()
                    voltage.append(run.value("battery.cell.voltage"))
        per_interval = round(cell_model.STEP_S / STEP_S)
        return np.array(voltage[1:]).reshape(-1, per_interval).mean(axis=1)

    def test_its_voltage_is_the_fmus(self):
        rotors = cell_model.Rotors()

        def power_w(voltage):
            return rotors.hovering(MASS_KG, voltage) + cell_model.AVIONICS_W

        for name, charge in (("bitcraze_250_flights", 0.95), ("bitcraze_250", 0.7), ("bitcraze_250_charged", 1.0)):
            cell = cell_model.Cell.load(name)
            rest_v = np.array([float(cell_model.at(cell.open_circuit, charge))])
            steps = round(DURATION_S / cell_model.STEP_S)
            fast = cell_model.discharge(cell, rest_v, np.array([1.0]), lambda k, voltage: power_w(voltage), steps, 0.0)[0]
            exact = self.fmu_voltage(name, charge, power_w)
            # Skips the first four intervals, in which the voltages of the RC pairs change fastest. In one interval, the charge changes the
            # voltage by 0.5 mV.
            self.assertLess(np.abs(fast - exact)[4:].max(), 2e-3, name)


if __name__ == "__main__":
    unittest.main()
