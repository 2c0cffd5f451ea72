#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests parameters drawn from the intervals of data files: by `mebots run` after a run, and in a study."""

import json
import subprocess
import sys
import unittest

import mebots
from support import MEBOTS, SOURCE, StudyCase

NAMES = ["world.calibration.mass", "world.calibration.drag", "motors.calibration.thrust", "motors.calibration.power",
         "battery.calibration.resistance", "battery.calibration.capacity", "battery.calibration.cut_off_voltage",
         "battery.calibration.cut_off_delay"]


class Calibration(StudyCase):
    """Runs the first seconds of the hover mission."""

    def mission(self, **parameters):
        content = json.loads((SOURCE / "configs/hover.json").read_text())
        content["stop_time"] = 4
        for name, value in parameters.items():
            instance, variable = name.split(".", 1)
            content["instances"][instance]["parameters"][variable] = value
        (self.folder / "mission.json").write_text(json.dumps(content))

    def run_mission(self, *words):
        command = [MEBOTS, "run", "--verbose", str(self.folder / "mission.json"), "--out", str(self.folder / "run"), *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=170)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads((self.folder / "run/summary.json").read_text()), done.stdout + done.stderr

    def calibrated_study(self, **sections):
        self.study(design={"kind": "grid", "factors": {"battery.cell.initial_state_of_charge": [1]}},
                   draws={"replicates": 19}, uncertainty="calibration",
                   objectives={"delivered": {"summary": "energy.delivered"}}, **sections)

    def test_a_run_has_an_interval_for_each_number_of_its_summary(self):
        summary, text = self.run_mission()
        found = summary["uncertainty"]
        self.assertEqual(found["flights"], 19)
        self.assertEqual(found["parameters"], NAMES)
        self.assertEqual(sum(found["outcomes"].values()), 19)
        low, high = found["intervals"]["energy"]["delivered"]
        self.assertLess(low, summary["energy"]["delivered"])
        self.assertGreater(high, summary["energy"]["delivered"])
        self.assertRegex(text, r"flights last 4 to 4 s")
        self.assertRegex(text, r"energy\.delivered +\S+ J \(\S+ to \S+\)")

    def test_the_flight_itself_keeps_its_results(self):
        self.run_mission()
        drawn = (self.folder / "run/results.csv").read_bytes()
        summary, _ = self.run_mission("--uncertainty", "none")
        self.assertNotIn("uncertainty", summary)
        self.assertEqual((self.folder / "run/results.csv").read_bytes(), drawn)

    def test_a_study_with_the_same_seed_flies_the_same_draws(self):
        found = self.run_mission()[0]["uncertainty"]["intervals"]["energy"]["delivered"]
        self.calibrated_study()
        self.sweep()
        delivered = [float(row["delivered"]) for row in self.rows("missions.csv")]
        self.assertEqual([min(delivered), max(delivered)], found)
        for name in NAMES:
            drawn = [float(row[name]) for row in self.rows("missions.csv")]
            self.assertEqual(len(set(drawn)), 19)
            self.assertTrue(all(-1 < position < 1 for position in drawn))

    def test_does_not_draw_parameters_that_the_mission_or_a_factor_sets(self):
        self.mission(**{"battery.calibration.resistance": 1})
        found = self.run_mission()[0]["uncertainty"]
        self.assertEqual(found["parameters"], [name for name in NAMES if name != "battery.calibration.resistance"])
        self.study(design={"kind": "grid", "factors": {"world.calibration.mass": [-1, 1]}}, draws={"replicates": 2},
                   uncertainty="calibration", objectives={"delivered": {"summary": "energy.delivered"}})
        self.sweep()
        self.assertEqual([row["world.calibration.mass"] for row in self.rows("missions.csv")], ["-1", "-1", "1", "1"])

    def test_a_data_file_without_an_interval_is_named(self):
        self.mission(**{"battery.cell.name": "bitcraze_250"})
        _, text = self.run_mission()
        self.assertIn("battery: calibration.resistance has no effect: cell 'Bitcraze 250 mAh' has no interval of "
                      "resistance_factor", text)

    def test_a_mission_from_python_has_the_same_intervals(self):
        found = self.run_mission()[0]["uncertainty"]
        with mebots.Mission(self.folder / "mission.json", out=self.folder / "python") as mission:
            mission.run()
        self.assertEqual(mission.summary["uncertainty"], found)
        written = json.loads((self.folder / "python/summary.json").read_text())
        self.assertEqual(written["uncertainty"], found)

    def test_a_mission_from_python_runs_once_if_requested(self):
        with mebots.Mission(self.folder / "mission.json", uncertainty="none") as mission:
            mission.run()
        self.assertNotIn("uncertainty", mission.summary)
        with self.assertRaisesRegex(mebots.InputError, "uncertainty='maybe': 'calibration' or 'none' is expected"):
            mebots.Mission(self.folder / "mission.json", uncertainty="maybe")

    def test_there_are_no_draws_of_what_a_program_wrote_or_began_later(self):
        with mebots.Mission(self.folder / "mission.json") as mission:
            mission.run_until(1)
            state = mission.save_state()
            mission.write("world.setpoint.altitude", 1.5)
            mission.run()
        self.assertIn("a program wrote variables", mission.summary["uncertainty"]["skipped"])
        with mebots.Mission(self.folder / "mission.json") as mission:
            mission.start_from(state)
            mission.run()
        self.assertIn("started from a saved state", mission.summary["uncertainty"]["skipped"])

    def test_a_summary_names_parameters_without_an_interval(self):
        self.mission(**{"battery.cell.name": "bitcraze_250"})
        found = self.run_mission()[0]["uncertainty"]["without_effect"]
        self.assertTrue(any("calibration.resistance has no effect" in text for text in found), found)

    def test_mistakes_are_named(self):
        self.calibrated_study()
        content = json.loads((self.folder / "study.json").read_text())
        del content["draws"]
        (self.folder / "study.json").write_text(json.dumps(content))
        self.assertIn("'uncertainty' needs 'draws'", self.sweep(code=2))
        super().mission()  # of an FMU without calibration parameters
        self.study(uncertainty="calibration")
        self.assertIn("has a parameter calibration.*", self.sweep(code=2))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[1:]])
