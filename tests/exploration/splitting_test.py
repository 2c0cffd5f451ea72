#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rare events, on a random walk whose chance to reach a height is known in closed form."""

import json
import math
import subprocess
import sys
import unittest

from support import BUILD, MEBOTS, PROBE, StudyCase

STEPS = 100


def chance_to_reach(height):
    """Of a walk of STEPS steps of +1 or -1: P(max >= m) = P(S >= m) + P(S > m), by reflection (Feller, volume 1, III.7)."""
    def more(least):
        return sum(math.comb(STEPS, ups) for ups in range(STEPS + 1) if 2 * ups - STEPS >= least) / 2**STEPS

    return more(height) + more(height + 1)


class RareEvents(StudyCase):
    def mission(self):
        (self.folder / "mission.json").write_text(json.dumps({
            "step": 1, "stop_time": STEPS, "instances": {"walk": {"fmu": str(BUILD / "test_fmus" / "walk.fmu")}},
            "connections": [], "outcomes": [{"outcome": "high", "when": [{"variable": "walk.top", "above": 11.5}]}],
            "summary": {"top": "walk.top"}}))

    def sweep_of_rare(self, code):
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "out")]
        done = subprocess.run(command, capture_output=True, text=True, timeout=170)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def rare(self, levels, missions, estimates, seed=1, **more):
        return self.study(
            design={"kind": "grid", "factors": {"/stop_time": [STEPS]}}, objectives=None,
            draws={"replicates": estimates, "seed": seed, "variables": {"walk.seed": {"integer": [1, 2000000000]}}},
            splitting={"score": "walk.height", "levels": levels, "missions": missions, "reseed": ["walk.seed"]} | more)

    def test_a_probability_of_one_in_ten_thousand_is_found_with_a_tenth_of_the_simulated_time(self):
        height = 39
        exact = chance_to_reach(height)
        self.assertLess(abs(math.log10(exact) + 4), 0.15)
        self.rare([9, 15, 21, 27, 33, height], 200, 12)
        self.sweep()
        (answer,) = self.rows("designs.csv")
        found, relative = float(answer["probability"]), float(answer["relative_error"])
        self.assertLess(relative, 0.2)
        self.assertLess(float(answer["probability: low"]), exact)
        self.assertGreater(float(answer["probability: high"]), exact)
        self.assertLess(abs(found / exact - 1), 3 * relative)
        # As many missions as plain counting needs for this relative error: (1 - p) / (p e^2), each of them whole.
        plain_s = (1 - exact) / (exact * relative**2) * STEPS
        self.assertGreater(plain_s / float(answer["simulated_time [s]"]), 10)

    def test_it_agrees_with_counting_where_that_is_possible(self):
        """At height 12, which every fourth walk reaches, by one level, by three, and by counting."""
        exact = chance_to_reach(12)
        for number, levels in enumerate(([12], [4, 8, 12])):
            self.rare(levels, 50, 12)
            self.sweep(out=f"rare{number}")
            (answer,) = self.rows("designs.csv", f"rare{number}")
            self.assertLess(float(answer["probability: low"]), exact)
            self.assertGreater(float(answer["probability: high"]), exact)
        self.study(design={"kind": "grid", "factors": {"/stop_time": [STEPS]}},
                   draws={"replicates": 600, "seed": 1, "variables": {"walk.seed": {"integer": [1, 2000000000]}}},
                   objectives={"success": {"outcome": "high"}})
        self.sweep(out="counted")
        (counted,) = self.rows("designs.csv", "counted")
        self.assertLess(float(counted["success: low"]), exact)
        self.assertGreater(float(counted["success: high"]), exact)
        # One level is counting: its missions are those with the same draws.
        successes = int(counted["success: successes"])
        self.assertEqual(sum(int(row["reached"]) for row in self.rows("levels.csv", "rare0")), successes)

    def test_the_same_bytes_come_for_any_jobs_and_after_a_kill(self):
        self.rare([4, 8], 20, 2)
        self.sweep("--jobs", "1", out="one")
        self.sweep("--jobs", "2", out="two")
        lines = (self.folder / "one" / "journal.jsonl").read_text().splitlines(keepends=True)
        (self.folder / "again").mkdir()
        (self.folder / "again" / "journal.jsonl").write_text("".join(lines[:50]))  # states of the first level are gone
        self.sweep(out="again")
        for name in ("levels.csv", "designs.csv"):
            self.assertEqual(self.bytes_of(name, "one"), self.bytes_of(name, "two"))
            self.assertEqual(self.bytes_of(name, "one"), self.bytes_of(name, "again"))

    def test_levels_may_fall_and_what_is_never_reached_has_probability_0(self):
        self.rare([-4, -8], 40, 4)
        self.sweep()
        (answer,) = self.rows("designs.csv")
        self.assertGreater(float(answer["probability: high"]), chance_to_reach(8))
        self.assertLess(float(answer["probability: low"]), chance_to_reach(8))
        self.rare([50, 101], 5, 2)
        self.sweep(out="never")
        (answer,) = self.rows("designs.csv", "never")
        self.assertEqual((answer["probability"], answer["relative_error"]), ("0", ""))

    def test_after_too_many_failures_it_ends_without_an_answer(self):
        config = json.loads((self.folder / "mission.json").read_text())
        config["instances"]["bad"] = {"fmu": PROBE, "parameters": {"fault": "fatal", "fault_time": 3}}
        (self.folder / "mission.json").write_text(json.dumps(config))
        self.study(design={"kind": "grid", "factors": {"/stop_time": [STEPS]}}, objectives=None, limits={"failures": 3},
                   draws={"replicates": 2, "variables": {"walk.seed": {"integer": [1, 2000000000]}}},
                   splitting={"score": "walk.height", "levels": [2, 8, 12], "missions": 10, "reseed": ["walk.seed"]})
        done = self.sweep_of_rare(code=1)
        (answer,) = self.rows("designs.csv")
        self.assertGreaterEqual(int(answer["failed"]), 3)
        self.assertEqual(answer["probability"], "", done)
        self.assertEqual({row["level"] for row in self.rows("levels.csv")}, {"2"})

    def test_its_mistakes_are_told(self):
        self.rare([4, 4], 20, 2)
        self.assertIn("rise", self.sweep(code=2))
        self.rare([4, 8], 20, 2, reseed=["walk.sead"])
        self.assertIn("walk.seed", self.sweep(code=2))
        self.rare([4, 8], 20, 2, score="walk.hight")
        self.assertIn("Did you mean 'height'", self.sweep(code=2))


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
