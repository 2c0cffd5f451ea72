#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `mebots replay` with a flight that the models generated, and its errors for unusable logs."""

import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import twin
from logs import usd_log

import mebots
from mebots.flight.motion import GRAVITY_M_PER_S2

SOURCE = pathlib.Path(os.environ["MEBOTS_SOURCE"])
sys.path.insert(0, str(SOURCE / "tests" / "support"))

from page_content import page_content  # noqa: E402 - the path has to be known first

MEBOTS = str(pathlib.Path(os.environ["MEBOTS_BUILD"]) / "bin" / "mebots")


class FlightCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.flight = twin.fly(cls.folder)
        (cls.folder / "log00").write_bytes(twin.log_bytes(*cls.flight))
        cls.airframe = twin.airframe(cls.folder)


class Twins(FlightCase):
    def test_a_flight_of_the_models_has_errors_of_rounding_only(self):
        result = mebots.replay(self.folder / "log00", self.airframe)
        self.assertEqual(result.findings, [])
        self.assertAlmostEqual(result.summary["initial_charge"], 0.8, delta=0.005)  # the replay starts the rotors slowly
        self.assertLess(result.error("battery.voltage", "commands").rms, 1.5e-3)  # the log is rounded to millivolts
        for i in range(1, 5):
            self.assertLess(result.error(f"rotor[{i}].speed", "commands").rms, 2)  # of 2000; effect of the slow start
        for model in ("commands", "commands, measured voltage", "measured speeds"):
            thrust = result.error("thrust.vertical", model)
            self.assertEqual((thrust.n, thrust.excluded), (11, 0))
            self.assertLess(abs(thrust.relative), 2e-3)

    def test_a_wrong_thrust_coefficient_shows_in_the_thrust_alone(self):
        from mebots.flight.airframe import shipped

        rotor = shipped("rotor", "crazyflie_l250")
        rotor["thrust_coefficient"]["value"] *= 1.1
        (self.folder / "strong.json").write_text(json.dumps(rotor))
        result = mebots.replay(self.folder / "log00", twin.airframe(self.folder, "strong_drone.json", rotor="strong.json"))
        self.assertAlmostEqual(result.error("thrust.vertical", "measured speeds").relative, 0.1, delta=3e-3)
        self.assertLess(result.error("rotor[1].speed", "commands, measured voltage").rms, 2)  # of 2000; effect of the slow start

    def test_a_wrong_mass_shows_in_the_thrust_that_is_needed(self):
        result = mebots.replay(self.folder / "log00", self.airframe, mass=1.05 * twin.MASS_KG)
        self.assertAlmostEqual(result.error("thrust.vertical", "measured speeds").relative, 1 / 1.05 - 1, delta=3e-3)

    def test_windows_with_a_gap_are_excluded_and_counted(self):
        rows = [one.copy() if not isinstance(one, list) else [inner.copy() for inner in one] for one in self.flight]
        times, duty, rpm, millivolts, climb = rows
        keep = (times < 5) | (times > 5.4)
        file = self.folder / "gap"
        file.write_bytes(twin.log_bytes(times[keep], [one[keep] for one in duty], [one[keep] for one in rpm], millivolts[keep], climb[keep]))
        result = mebots.replay(file, self.airframe)
        thrust = result.error("thrust.vertical", "commands")
        self.assertEqual((thrust.n, thrust.excluded), (8, 3))  # the gap, and the second after it
        self.assertGreater(result.error("battery.voltage", "commands").excluded, 400)
        self.assertTrue(any(one.rule == "gap" for one in result.findings))


    def test_a_log_without_commands_gets_those_that_its_motion_needs(self):
        times, _, _, millivolts, climb = self.flight
        height = 1 + np.r_[0.0, np.cumsum((climb[1:] + climb[:-1]) / 2 * twin.STEP_S)]
        height -= height.min() - 1
        ground = np.r_[np.zeros(500), height]  # starts with a second on the ground
        rows = zip(ground.tolist(), np.r_[np.full(500, millivolts[0]), millivolts].astype(int).tolist(), strict=True)
        event = (1, "state", ["stateEstimate.z(f)", "pm.vbatMV(H)"])
        (self.folder / "height").write_bytes(usd_log([event], [(1, 2000 * i, row) for i, row in enumerate(rows)]))
        result = mebots.replay(self.folder / "height", self.airframe)
        self.assertEqual([one.quantity for one in result.errors], ["battery.voltage"])
        self.assertLess(abs(result.errors[0].mean), 0.05)
        self.assertTrue(any("no commands" in note for note in result.summary["notes"]))

    def test_a_hover_without_motion_is_compared_with_the_weight(self):
        times, duty, rpm, millivolts, _ = self.flight
        event = (twin.STATE[0], twin.STATE[1], twin.STATE[2][:-1])
        rows = zip(*[one.astype(int).tolist() for one in (*duty, *rpm, millivolts)], strict=True)
        records = [(event[0], round(1e6 * time), row) for time, row in zip(times.tolist(), rows, strict=True)]
        (self.folder / "hover").write_bytes(usd_log([event], records))
        self.assertIsNone(mebots.replay(self.folder / "hover", self.airframe).motion)
        thrust = mebots.replay(self.folder / "hover", self.airframe, hover=True).error("thrust.vertical", "measured speeds")
        self.assertAlmostEqual(thrust.measured, twin.MASS_KG * GRAVITY_M_PER_S2, places=6)


class Commands(FlightCase):
    def run_mebots(self, *words, code=0):
        done = subprocess.run([MEBOTS, "replay", *map(str, words)], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def test_a_flight_that_fails_leaves_the_folder_as_it_was(self):
        out = self.folder / "out"
        out.mkdir()
        (out / "inputs.csv").write_text("mine")
        whole = (self.folder / "log00").read_bytes()
        (self.folder / "short").write_bytes(whole[: len(whole) // 20])
        self.run_mebots(self.folder / "short", "--airframe", self.airframe, "--out", out, code=2)
        self.assertEqual([(file.name, file.read_text()) for file in out.iterdir()], [("inputs.csv", "mine")])
        self.run_mebots(self.folder / "log00", "--airframe", self.airframe, "--out", self.folder / "log00", code=2)
        (self.folder / "page" / "replay.html").mkdir(parents=True)
        said = self.run_mebots(self.folder / "log00", "--airframe", self.airframe, "--out", self.folder / "page", code=2)
        self.assertIn("replay.html in it is a folder", said)

    def test_the_command_writes_a_page_tables_and_a_mission_that_flies_again(self):
        out = self.folder / "out"
        said = self.run_mebots(self.folder / "log00", "--airframe", self.airframe, "--out", out)
        self.assertIn("battery.voltage", said)
        with (out / "errors.csv").open() as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual(len(rows), 15)
        content = json.loads((out / "replay.json").read_text())
        self.assertEqual(len(content["errors"]), 15)
        self.assertIn("30.0 g", content["mass"]["source"])
        page = page_content(out / "replay.html")
        self.assertEqual(page["kind"], "replay")
        self.assertIn("vertical thrust", page["answer"])
        self.assertTrue((out / "traces.csv").read_text().startswith("time [s],battery.voltage model [V]"))
        again = subprocess.run([MEBOTS, "run", str(out / "mission.json"), "--out", str(self.folder / "again")], capture_output=True, text=True)
        self.assertEqual(again.returncode, 0, again.stderr)

    def test_refuses_logs_that_cannot_be_replayed(self):
        airframe, out = ("--airframe", self.airframe), ("--out", self.folder / "bad")
        self.assertIn("no such file", self.run_mebots(self.folder / "nothing", *airframe, *out, code=2))
        (self.folder / "pose").write_bytes(usd_log([(8, "estPose", ["locSrv.x(f)"])], [(8, 0, (1.0,)), (8, 9, (1.0,))]))
        self.assertIn("motor[1].command", self.run_mebots(self.folder / "pose", *airframe, *out, code=2))
        self.assertIn("ai_deck", self.run_mebots(self.folder / "log00", *airframe, *out, "--decks", "ai_dek", code=2))
        self.assertIn("--window", self.run_mebots(self.folder / "log00", *airframe, *out, "--window", "100", code=2))
        short = [one[:400] if not isinstance(one, list) else [inner[:400] for inner in one] for one in self.flight]
        (self.folder / "short").write_bytes(twin.log_bytes(*short))
        self.assertIn("at least", self.run_mebots(self.folder / "short", *airframe, *out, code=2))
        (self.folder / "bad_drone.json").write_text('{"name": "x"}')
        self.assertIn("mass_without_cell", self.run_mebots(self.folder / "log00", "--airframe", self.folder / "bad_drone.json", *out, code=2))


if __name__ == "__main__":
    unittest.main()
