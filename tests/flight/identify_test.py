#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `mebots identify` and `mebots new-cell` with flights that the models generated."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
import twin

import mebots
from mebots.flight.airframe import shipped
from mebots.flight.cell_fit import CellFit
from mebots.flight.identify import describe_cell, fitted_cell, identify
from mebots.flight.new_cell import new_cell

MEBOTS = str(pathlib.Path(os.environ["MEBOTS_BUILD"]) / "bin" / "mebots")


class FolderCase(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def log(self, name="log00", **flight):
        file = self.folder / name
        file.write_bytes(twin.log_bytes(*twin.fly(self.folder, **flight)))
        return file

    def valid(self, *files):
        done = subprocess.run([MEBOTS, "validate", *map(str, files)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)


class Thrust(FolderCase):
    def test_the_thrust_coefficient_of_a_twin_is_found(self):
        rotor = shipped("rotor", "crazyflie_l250")
        rotor["thrust_coefficient"]["value"] *= 0.96
        (self.folder / "weak.json").write_text(json.dumps(rotor))
        log = self.log(rotor=str(self.folder / "weak.json"))
        out = self.folder / "fitted.json"
        found = identify([log], twin.airframe(self.folder), out, fit=["thrust"], mass=twin.MASS_KG).estimates[0]
        self.assertAlmostEqual(found.value / found.base, 0.96, delta=1e-3)
        self.assertTrue(found.low < rotor["thrust_coefficient"]["value"] < found.high)
        self.valid(out, self.folder / "fitted.rotor.json")
        again = mebots.replay(log, out, mass=twin.MASS_KG)
        self.assertLess(abs(again.error("thrust.vertical", "measured speeds").relative), 1e-3)

    def test_the_mass_of_a_twin_is_found(self):
        out = self.folder / "fitted.json"
        found = identify([self.log()], twin.airframe(self.folder), out, fit=["mass"], mass=0.033).estimates[0]
        self.assertAlmostEqual(found.value, twin.MASS_KG, delta=3e-5)
        self.valid(out)
        self.assertAlmostEqual(mebots.replay(self.log(), out).summary["mass"]["value"], twin.MASS_KG, delta=3e-5)

    def test_a_log_counts_once_and_a_mass_in_grams_is_refused(self):
        log, airframe, out = self.log(), twin.airframe(self.folder), self.folder / "fitted.json"
        for logs, mass, message in (([log, log], None, "same content"), ([log], 34.7, "give it in kg")):
            with self.assertRaises(mebots.InputError) as caught:
                identify(logs, airframe, out, fit=["thrust"], mass=mass)
            self.assertIn(message, str(caught.exception))
        self.assertFalse(out.exists())

    def test_mass_and_thrust_together_are_refused_with_the_reason(self):
        with self.assertRaises(mebots.InputError) as caught:
            identify([self.log()], twin.airframe(self.folder), self.folder / "fitted.json", fit=["thrust", "mass"])
        self.assertIn("ratio of thrust to mass", str(caught.exception))


class Cells(FolderCase):
    def test_the_resistance_of_a_twin_is_found_and_what_is_not_determined_is_kept(self):
        cell = shipped("cell", "bitcraze_250")
        for curve in (cell["series_resistance"], cell["pair1_resistance"], cell["pair2_resistance"]):
            curve["exponential"][0] *= 1.5
            curve["polynomial"] = [1.5 * one for one in curve["polynomial"]]
        for curve in (cell["pair1_capacitance"], cell["pair2_capacitance"]):
            curve["exponential"][0] /= 1.5
            curve["polynomial"] = [one / 1.5 for one in curve["polynomial"]]
        (self.folder / "worn.json").write_text(json.dumps(cell))
        log = self.log(cell=str(self.folder / "worn.json"), charge=0.9, duration_s=60)
        out = self.folder / "fitted.json"
        found = identify([log], twin.airframe(self.folder), out, fit=["cell"], mass=twin.MASS_KG)
        self.valid(out, self.folder / "fitted.cell.json")
        estimates = {one.name: one for one in found.estimates}
        # The tolerance is large, because the load is nearly constant, and because the fit also determines the initial charge and the load
        # before the log.
        self.assertAlmostEqual(estimates["series_resistance"].value, 1.5, delta=0.1)
        self.assertEqual(len(estimates) + sum("stays at the base's value" in note for note in found.notes), 3)
        self.assertRegex(found.residuals[0], r"rms \d\.\d mV; with the base cell \d\d")


    def test_an_aged_cell_has_its_own_capacity_and_intervals_that_a_draw_can_use(self):
        base = shipped("cell", "bitcraze_250_flights")
        base["capacity_factor"] |= {"value": 0.8, "interval": [0.7, 0.9]}
        found = CellFit({"capacity": (1.1, 1.0, 1.2), "series_resistance": (1.2, 1.14, 1.26)}, {"polarisation": "not requested"}, 0.01, 0.02, 100)
        estimates = []
        describe_cell(base, found, 1, estimates, [], [])
        capacity = next(one for one in estimates if one.name == "capacity")
        np.testing.assert_allclose([capacity.value, capacity.low, capacity.base], [1.1 * 720, 720, 720])
        cell = fitted_cell(base, found, "a log")
        np.testing.assert_allclose(cell["capacity"]["interval"], [900, 1080])
        self.assertNotIn("interval", cell["capacity_factor"])
        np.testing.assert_allclose(cell["resistance_factor"]["interval"], [0.95, 1.05])
        (self.folder / "cell.json").write_text(json.dumps(cell))
        self.valid(self.folder / "cell.json")


class NewCells(FolderCase):
    WORDS = ("--name", "Maker 300", "--capacity", "300", "--mass", "8.1", "--c-rate", "25")

    def run_mebots(self, *words, code=0):
        done = subprocess.run([MEBOTS, "new-cell", str(self.folder / "cell.json"), *words], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_the_rule_for_the_resistance_holds_only_for_usual_c_rates(self):
        for c_rate in (1, 9.9, 41):
            with self.assertRaisesRegex(mebots.InputError, "--c-rate .*--resistance"):
                new_cell(self.folder / "cell.json", name="x", capacity=250, mass=7, c_rate=c_rate)
        self.assertFalse((self.folder / "cell.json").exists())
        new_cell(self.folder / "cell.json", name="x", capacity=240, mass=7, c_rate=1, resistance=0.08)

    def test_computes_a_cell_from_the_printed_data_of_a_seller(self):
        said = self.run_mebots(*self.WORDS)
        self.assertIn("series_resistance: 0.0625 Ohm", said)
        self.valid(self.folder / "cell.json")
        cell = json.loads((self.folder / "cell.json").read_text())
        self.assertEqual(cell["capacity"]["interval"], [972, 1080])
        self.assertAlmostEqual(cell["continuous_current"]["value"], 7.5)
        np.testing.assert_allclose(cell["mass"]["interval"], [0.00805, 0.00815])

    def test_a_measured_resistance_takes_the_place_of_the_estimate(self):
        self.run_mebots(*self.WORDS, "--resistance", "0.11")
        cell = json.loads((self.folder / "cell.json").read_text())
        self.assertAlmostEqual(cell["resistance_factor"]["value"] * cell["series_resistance"]["polynomial"][0], 0.11)
        self.assertNotIn("interval", cell["resistance_factor"])

    def test_a_discharge_is_fitted(self):
        """Discharges a shipped cell at 2 A with pauses, which separate resistance and polarisation."""
        times = np.arange(0, 380, 0.05)
        amperes = np.where(times % 60 < 45, 2.0, 0.1)
        mission = {
            "step": 0.05, "stop_time": 379.9,
            "instances": {"battery": {"fmu": "fmu_battery", "parameters": {"cell.name": "lipol_350"}}},
            "connections": [], "inputs": {"file": "power.csv", "to": {"power": "battery.motors.power"}},
        }
        np.savetxt(self.folder / "power.csv", np.column_stack([times, 3.7 * amperes]), fmt="%.9g", delimiter=",", header="time,power", comments="")
        (self.folder / "mission.json").write_text(json.dumps(mission))
        with mebots.Mission(self.folder / "mission.json") as run:
            run.run()
            rows = np.column_stack([run.times, run["battery.cell.voltage"], run["battery.cell.current"]])
        np.savetxt(self.folder / "bench.csv", rows, fmt="%.6g", delimiter=",", header="t,u,i", comments="")
        columns = {"u": {"signal": "battery.voltage", "unit": "V"}, "i": {"signal": "battery.current", "unit": "A"}}
        (self.folder / "columns.json").write_text(json.dumps({"time": {"column": "t"}, "columns": columns}))
        found = new_cell(
            self.folder / "cell.json", name="x", capacity=350, mass=9.2, c_rate=15,
            discharge=self.folder / "bench.csv", mapping=self.folder / "columns.json",
        )
        self.valid(self.folder / "cell.json")
        cell, truth = json.loads((self.folder / "cell.json").read_text()), shipped("cell", "lipol_350")
        for curve in ("series_resistance", "pair1_resistance"):
            fitted, real = (one[curve]["polynomial"][0] * one["resistance_factor"]["value"] for one in (cell, truth))
            self.assertAlmostEqual(fitted / real, 1, delta=0.05, msg=curve)
        self.assertAlmostEqual(cell["capacity"]["value"] / truth["capacity"]["value"], 1, delta=0.03)
        self.assertIn("capacity", [one.name for one in found.estimates])

    def test_figures_that_cannot_be_are_refused(self):
        self.assertIn("--capacity", self.run_mebots("--name", "x", "--capacity", "0", "--mass", "8", "--c-rate", "25", code=2))


if __name__ == "__main__":
    unittest.main()
