# SPDX-License-Identifier: Apache-2.0
"""Test support for `mebots sweep`: a small mission with the FMU probe, studies of this mission, and calls of the program."""

import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["MEBOTS_BUILD"])
SOURCE = pathlib.Path(os.environ["MEBOTS_SOURCE"])
MEBOTS = str(BUILD / "bin" / "mebots")
BANK = str(BUILD / "test_fmus" / "bank.fmu")
PROBE = str(BUILD / "test_fmus" / "probe.fmu")
sys.path.insert(0, str(SOURCE / "tests" / "support"))

from page_content import page_content  # noqa: E402 - the path has to be known first

STEADY = str(BUILD / "test_fmus" / "steady.fmu")


class StudyCase(unittest.TestCase):
    """Creates a folder with a mission and a study for each test."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        self.mission()

    FMU = PROBE

    def mission(self, **parameters):
        (self.folder / "mission.json").write_text(json.dumps({
            "step": 0.1, "stop_time": 1,
            "instances": {"a": {"fmu": self.FMU, "parameters": {"gain": 2, "real_in": 3} | parameters}},
            "connections": [],
            "outcomes": [{"outcome": "far", "when": [{"variable": "a.integral", "above": 2}]}, {"outcome": "near"}],
            "summary": {"integral": "a.integral", "deep": {"out": "a.real_out"}},
        }))

    def study(self, **sections):
        """Writes a study with two designs and ten draws, and returns its file. ``sections`` replace sections of the study."""
        content = {
            "mission": "mission.json",
            "design": {"kind": "grid", "factors": {"a.gain": [0.2, 1]}},
            "draws": {"replicates": 10, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}},
            "objectives": {"success": {"outcome": "far"}, "integral": {"summary": "integral"}},
        } | sections
        file = self.folder / "study.json"
        file.write_text(json.dumps({key: value for key, value in content.items() if value is not None}))
        return file

    def sweep(self, *words, out="out", code=0):
        """Runs the program. Returns its output on both streams."""
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / out), *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=170)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        if code == 1:
            self.assertTrue((self.folder / out / "report.html").exists(), done.stderr)
        return done.stdout + done.stderr

    def bytes_of(self, name, out="out"):
        return (self.folder / out / name).read_bytes()

    def report(self, out="out", name="report.html"):
        """Returns the content of the study's page."""
        return page_content(self.folder / out / name)

    def rows(self, name, out="out"):
        with open(self.folder / out / name, newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))

    def flight(self, row, out="out"):
        """Returns the folder with the results of a mission in missions.csv."""
        return self.folder / out / "flights" / row["mission"][:2] / row["mission"]
