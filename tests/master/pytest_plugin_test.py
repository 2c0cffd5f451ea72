#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that the plug-in of pytest collects the cases of FMUs, and reports where they diverge.

Usage: pytest_plugin_test.py PROBE.fmu CASES_OF_MOTORS MOTORS.fmu (with PYTHONPATH set to the package)
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROBE, MOTORS_CASES, MOTORS = (pathlib.Path(word).resolve() for word in sys.argv[1:4])


def pytest(*words):
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-p", "mebots.pytest_plugin", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout + done.stderr


class PytestPlugin(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "good.csv").write_text("time,steps\n1,10\n")
        (self.folder / "bad.csv").write_text("time,steps\n1,11\n")

    def cases(self, name="probe.mebots-test.json", **cases):
        (self.folder / name).write_text(json.dumps({"fmu": str(PROBE), "cases": cases}))

    def test_each_case_is_a_test(self):
        self.cases(good={"expected": "good.csv"}, also={"expected": "good.csv", "step": "1/10"})
        self.cases("CASES.json", third={"expected": "good.csv"})
        (self.folder / "other.json").write_text("{}")
        code, output = pytest(self.folder, "--verbose")
        self.assertEqual(code, 0, output)
        self.assertIn("3 passed", output)

    def test_a_failure_shows_the_first_divergence(self):
        self.cases(good={"expected": "good.csv"}, bad={"expected": "bad.csv"})
        for more in ([], ["--mebots-isolate"]):
            code, output = pytest(self.folder, *more)
            self.assertEqual(code, 1, output)
            self.assertIn("at 1 s steps is 10, expected 11", output)
            self.assertIn("1 failed, 1 passed", output)

    def test_a_file_that_cannot_be_read_is_an_error_of_the_collection(self):
        self.cases()
        code, output = pytest(self.folder)
        self.assertNotEqual(code, 0)
        self.assertIn("write at least one case", output)

    def test_an_fmu_may_be_given(self):
        code, output = pytest(MOTORS_CASES, "--mebots-fmu", MOTORS)
        self.assertEqual(code, 0, output)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
