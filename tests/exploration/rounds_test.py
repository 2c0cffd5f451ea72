#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests decisions between rounds, the front, and the designs that need the extra mebots[sweep]."""

import signal
import subprocess
import sys
import time
import unittest
import unittest.mock

from mebots.exploration import rounds as exploration_rounds
from mebots.exploration.comparison import Evidence
from mebots.exploration.study import read_study
from support import MEBOTS, StudyCase

# The probe computes real_out = gain real_in + offset, and after 1 s integral = real_in. For real_in from U(0, 3), a third of the missions
# ends "far".
OUT = {"summary": "deep.out", "minimize": True}


class Rounds(StudyCase):
    def test_the_estimate_of_missions_left_assumes_that_designs_continue_to_end_at_the_same_rate(self):
        study = read_study(self.study(objectives={"out": OUT}, draws={"replicates": 40, "variables": {"a.real_in": {"uniform": [0, 3]}}},
                                      rounds={"size": 10, "racing": True}))
        rounds = exploration_rounds.Rounds(study, Evidence(study, 16))
        self.assertEqual(rounds.likely_left(), 16 * 40)
        with unittest.mock.patch.object(rounds, "_race", lambda: rounds.status.__setitem__(slice(8), ["dropped"] * 8)):
            rounds.decide()
        self.assertEqual(rounds.most_left(), 8 * 30)
        self.assertAlmostEqual(rounds.likely_left(), 10 * (8 + 4 + 2), 9)

    def test_a_question_stops_the_designs_for_which_it_is_answered(self):
        self.study(draws={"replicates": 200, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}},
                   rounds={"size": 10, "stop": {"objective": "success", "above": 0.7}})
        self.sweep()
        for row in self.rows("designs.csv"):
            self.assertEqual(row["status"], "success not above 0.7")
            self.assertLess(int(row["missions"]), 100)
            self.assertEqual(int(row["missions"]) % 10, 0)
            self.assertLessEqual(float(row["success: high"]), 0.7)

    def test_a_width_stops_a_design_whose_interval_is_narrow_enough(self):
        self.study(draws={"replicates": 300, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}},
                   rounds={"size": 20, "stop": {"objective": "integral", "width": 0.6}})
        self.sweep()
        for row in self.rows("designs.csv"):
            self.assertEqual(row["status"], "interval of integral is at most 0.6")
            self.assertLess(float(row["integral: high"]) - float(row["integral: low"]), 0.6)

    def test_the_better_of_two_designs_is_found_by_pairs(self):
        """The difference is much smaller than the spread of each design, so only common draws reveal it."""
        self.study(design={"kind": "grid", "factors": {"a.offset": [0, 0.05]}}, objectives={"out": OUT},
                   draws={"replicates": 100, "variables": {"a.real_in": {"uniform": [0, 3]}, "a.gain": {"uniform": [1, 2]}}},
                   rounds={"size": 5, "stop": {"objective": "out", "best": True}})
        self.sweep()
        rows = self.rows("designs.csv")
        self.assertEqual([row["status"] for row in rows], ["the best by out", "not the best by out"])
        self.assertLess(int(rows[0]["missions"]), 20)
        self.assertEqual([row["front"] for row in rows], ["on", "off"])

    def test_racing_drops_what_breaks_a_constraint_or_is_dominated(self):
        self.study(design={"kind": "grid", "factors": {"a.offset": [0, 2, 4], "a.gain": [1]}},
                   draws={"replicates": 100, "variables": {"a.real_in": {"uniform": [0, 3]}}},
                   objectives={"out": OUT, "top": {"final": "a.offset"}}, constraints={"top": {"above": -1}},
                   rounds={"size": 10, "racing": True})
        self.sweep()
        rows = self.rows("designs.csv")
        self.assertEqual([row["status"] for row in rows], ["all flown", "dropped: dominated", "dropped: dominated"])
        self.assertEqual(rows[0]["missions"], "100")
        self.assertLess(int(rows[2]["missions"]), 40)
        self.study(design={"kind": "grid", "factors": {"a.offset": [0, 2, 4], "a.gain": [1]}},
                   draws={"replicates": 100, "variables": {"a.real_in": {"uniform": [0, 3]}}},
                   objectives={"out": OUT}, constraints={"out": {"above": 3}}, rounds={"size": 10, "racing": True})
        self.sweep(out="constrained")
        rows = self.rows("designs.csv", "constrained")
        self.assertEqual([row["front"] for row in rows], ["excluded", "on", "off"])
        self.assertEqual(rows[0]["status"], "dropped: breaks a constraint")

    def test_noise_is_not_ranked(self):
        self.study(design={"kind": "grid", "factors": {"a.string_in": ["one", "two"]}}, objectives={"out": OUT},
                   draws={"replicates": 20, "variables": {"a.real_in": {"uniform": [0, 3]}}})
        self.sweep()
        self.assertEqual([row["front"] for row in self.rows("designs.csv")], ["undecided", "undecided"])

    def test_the_front_holds_what_is_best_in_some_objective(self):
        self.study(design={"kind": "grid", "factors": {"a.offset": [0, 1, 2, 1.5], "a.gain": [1]}},
                   objectives={"out": OUT, "reach": {"expression": "min(deep.out - integral, 1.2)", "maximize": True}},
                   draws={"replicates": 30, "variables": {"a.real_in": {"uniform": [0, 3]}}})
        self.sweep()
        # Offset 0 has the smallest `out`. Offsets 1.5 and 2 both have the greatest `reach`, but 1.5 has a smaller `out`, so it dominates 2.
        front = [row["front"] for row in self.rows("designs.csv")]
        self.assertEqual(front[:2], ["on", "on"])
        self.assertEqual(front[2], "undecided")  # equal reach is not certain, so 2 is not certainly dominated
        self.assertEqual(front[3], "on")

    def test_a_tolerance_decides_ties(self):
        self.study(design={"kind": "grid", "factors": {"a.offset": [2, 1.5], "a.gain": [1]}},
                   objectives={"out": OUT, "reach": {"expression": "min(deep.out - integral, 1.2)", "maximize": True, "tolerance": 0.01}},
                   draws={"replicates": 30, "variables": {"a.real_in": {"uniform": [0, 3]}}})
        self.sweep()
        self.assertEqual([row["front"] for row in self.rows("designs.csv")], ["off", "on"])

    def test_decisions_are_the_same_for_any_jobs_and_after_a_kill(self):
        self.mission(fault="nap", fault_time=0)
        self.study(design={"kind": "grid", "factors": {"a.offset": [0, 1, 2]}}, objectives={"out": OUT},
                   draws={"replicates": 60, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}},
                   rounds={"size": 5, "racing": True})
        self.sweep("--jobs", "1", out="one")
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "two"), "--jobs", "2"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        journal = self.folder / "two" / "journal.jsonl"
        while not journal.exists() or journal.read_bytes().count(b"\n") < 18:
            time.sleep(0.005)
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.sweep("--jobs", "2", out="two")
        for name in ("missions.csv", "designs.csv"):
            self.assertEqual(self.bytes_of(name, "one"), self.bytes_of(name, "two"))
        self.assertLess(len(self.rows("missions.csv", "one")), 180)

    def test_missions_of_the_round_in_progress_do_not_count_as_known_before(self):
        self.study(design={"kind": "grid", "factors": {"a.offset": [0, 1, 2]}}, objectives={"out": OUT},
                   draws={"replicates": 30, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}},
                   rounds={"size": 5, "racing": True})
        self.assertNotIn("known before", self.sweep("--jobs", "2"))
        missions = len(self.rows("missions.csv"))
        self.assertIn(f"{missions} missions, {missions} of them known before, 0 failed", self.sweep("--jobs", "2"))

    def test_the_report_holds_every_design_and_the_command_that_flies_it_again(self):
        self.study()
        self.sweep()
        page = self.bytes_of("report.html").decode()
        self.assertEqual(self.report()["replay"]["designs"], ["--set a.gain=0.2", "--set a.gain=1"])
        self.assertNotRegex(page, r"(src|href)\s*=\s*[\"']?http")
        self.assertLess(len(page), 100_000)


class Extras(StudyCase):
    def test_sobols_sequence_fills_the_square_evenly(self):
        self.study(design={"kind": "sobol", "points": 16, "seed": 1, "factors": {
            "a.gain": {"uniform": [0, 4]}, "a.offset": {"uniform": [0, 4]}}}, draws=None)
        self.sweep()
        cells = {(int(float(row["a.gain"])), int(float(row["a.offset"]))) for row in self.rows("designs.csv")}
        self.assertEqual(len(cells), 16)

    def test_sobol_indices_are_those_of_a_sum(self):
        """The variances are 1/12 and 4/12, so their shares are a fifth and four fifths."""
        self.study(design={"kind": "sensitivity", "method": "sobol", "points": 128, "seed": 1, "factors": {
            "a.gain": {"uniform": [0, 1]}, "a.offset": {"uniform": [0, 2]}}}, objectives={"out": {"summary": "deep.out"}},
            draws={"replicates": 1, "variables": {"a.real_in": {"integer": [1, 1]}}})
        self.sweep()
        found = {row["factor"]: float(row["S1"]) for row in self.rows("sensitivity.csv")}
        self.assertAlmostEqual(found["a.gain"], 0.2, 1)
        self.assertAlmostEqual(found["a.offset"], 0.8, 1)

    def test_morris_effects_are_the_slopes(self):
        self.study(design={"kind": "sensitivity", "method": "morris", "points": 4, "seed": 1, "factors": {
            "a.gain": {"uniform": [0, 1]}, "a.offset": {"uniform": [0, 2]}}}, objectives={"out": {"summary": "deep.out"}},
            draws={"replicates": 1, "variables": {"a.real_in": {"integer": [1, 1]}}})
        self.sweep()
        found = {row["factor"]: float(row["mu_star"]) for row in self.rows("sensitivity.csv")}
        self.assertAlmostEqual(found["a.gain"], 1, 9)
        self.assertAlmostEqual(found["a.offset"], 2, 9)

    def test_a_search_closes_in_and_gives_the_same_bytes_for_any_jobs_and_when_called_again(self):
        for method in ("nsga2", "tpe"):
            self.study(design={"kind": "search", "method": method, "points": 8, "rounds": 8, "seed": 1, "factors": {
                "a.gain": {"uniform": [-10, 10]}, "a.offset": {"uniform": [-10, 10]}}},
                objectives={"miss": {"expression": "abs(deep.out - 3)", "minimize": True}},
                draws={"replicates": 2, "variables": {"a.real_in": {"uniform": [1, 1.001]}}})
            self.sweep("--jobs", "1", out=method)
            misses = [float(row["miss: mean"]) for row in self.rows("designs.csv", method)]
            self.assertEqual(len(misses), 64)
            self.assertLess(min(misses[32:]), min(misses[:8]))
            self.sweep("--jobs", "2", out=method + "_two")
            self.assertEqual(self.bytes_of("missions.csv", method), self.bytes_of("missions.csv", method + "_two"))
            journal = self.bytes_of("journal.jsonl", method)
            self.sweep("--jobs", "1", out=method)
            self.assertEqual(self.bytes_of("journal.jsonl", method), journal)

    def test_a_missing_package_is_reported_with_the_command_that_installs_it(self):
        self.study(design={"kind": "sobol", "points": 4, "factors": {"a.gain": {"uniform": [0, 1]}}})
        code = ("import sys; sys.modules['scipy'] = None; sys.modules['scipy.stats'] = None; from mebots.exploration.command import main; "
                f"sys.exit(main([{str(self.folder / 'study.json')!r}, '--out', {str(self.folder / 'out')!r}]))")
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"pip install '?mebots\[sweep\]")


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
