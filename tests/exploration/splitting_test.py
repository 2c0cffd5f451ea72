#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests rare events with a random walk whose probability of reaching a height has a closed form."""

import json
import math
import shlex
import statistics
import subprocess
import sys
import unittest

import mebots
from mebots.exploration.splitting import MOST_LEVELS, next_level
from support import BUILD, MEBOTS, STEADY, StudyCase

STEPS = 100
HEIGHT = 39


def chance_to_reach(height):
    """Returns the probability that a walk of STEPS steps of +1 or -1 reaches a height: P(max >= m) = P(S >= m) + P(S > m), by the
    reflection principle (Feller, volume 1, III.7)."""
    def more(least):
        return sum(math.comb(STEPS, ups) for ups in range(STEPS + 1) if 2 * ups - STEPS >= least) / 2**STEPS

    return more(height) + more(height + 1)


class WalkCase(StudyCase):
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
        """Writes a study and returns its file. ``levels`` is a list, or the goal if the study must find the levels."""
        way = {"levels": levels} if isinstance(levels, list) else {"above": levels}
        return self.study(
            design={"kind": "grid", "factors": {"/stop_time": [STEPS]}}, objectives=None,
            draws={"replicates": estimates, "seed": seed, "variables": {"walk.seed": {"integer": [1, 2000000000]}}},
            splitting={"score": "walk.height", "missions": missions, "reseed": ["walk.seed"]} | way | more)

    def counted(self, missions):
        """Counts the walks that reach the height 12 in a study without splitting. Returns the row of its only design in designs.csv."""
        self.study(design={"kind": "grid", "factors": {"/stop_time": [STEPS]}},
                   draws={"replicates": missions, "seed": 1, "variables": {"walk.seed": {"integer": [1, 2000000000]}}},
                   objectives={"success": {"outcome": "high"}})
        self.sweep(out="counted")
        (design,) = self.rows("designs.csv", "counted")
        return design


class RareEvents(WalkCase):
    def test_one_level_is_counting_mission_by_mission(self):
        self.rare([12], 30, 4)
        self.sweep()
        successes = int(self.counted(120)["success: successes"])  # of the same draws
        self.assertEqual(sum(int(row["reached"]) for row in self.rows("levels.csv")), successes)
        self.assertGreater(successes, 0)
        (answer,) = self.rows("designs.csv")
        self.assertAlmostEqual(float(answer["probability"]), successes / 120, places=12)

    def test_the_probability_is_the_mean_over_estimates_of_the_product_of_shares(self):
        self.rare([4, 8, 12], 30, 4)
        self.sweep()
        estimates = [1.0] * 4
        for row in self.rows("levels.csv"):
            estimates[int(row["estimate"])] *= int(row["reached"]) / int(row["missions"])
        (answer,) = self.rows("designs.csv")
        self.assertAlmostEqual(float(answer["probability"]), statistics.mean(estimates), places=12)
        error = statistics.stdev(estimates) / math.sqrt(4) / statistics.mean(estimates)
        self.assertAlmostEqual(float(answer["relative_error"]), error, places=12)

    def test_a_scenario_sets_a_tunable_parameter_as_a_program_does(self):
        def heights(scenarios, write):
            mission = mebots.Mission(self.folder / "mission.json", scenarios=scenarios, record=["walk.height"])
            mission.run_until(50)
            for value in write:
                mission.write("walk.seed", value)
            mission.run()
            return list(mission["walk.height"])

        scenario = self.folder / "scenario.json"
        scenario.write_text(json.dumps({"scenario": [{"variable": "walk.seed", "set": 7, "from": 50}]}))
        self.assertEqual(heights([scenario], []), heights([], [7]))
        self.assertNotEqual(heights([scenario], []), heights([], []))

    def test_levels_are_found_on_the_way_down_too_and_for_each_design_of_its_own(self):
        self.study(
            design={"kind": "grid", "factors": {"/stop_time": [20, STEPS]}}, objectives=None,
            draws={"replicates": 4, "seed": 1, "variables": {"walk.seed": {"integer": [1, 2000000000]}}},
            splitting={"score": "walk.height", "below": -14, "missions": 60, "reseed": ["walk.seed"]})
        self.sweep()
        found = {design: [float(row["level"]) for row in self.rows("levels.csv") if (row["design"], row["estimate"]) == (design, "pilot")] for design in "01"}
        self.assertNotEqual(found["0"], found["1"])
        for levels in found.values():
            self.assertEqual(levels, sorted(set(levels), reverse=True))
            self.assertEqual(levels[-1], -14)
        self.assertLess(float(self.rows("designs.csv")[1]["probability: low"]), chance_to_reach(14))
        self.assertGreater(float(self.rows("designs.csv")[1]["probability: high"]), chance_to_reach(14))

    def test_the_next_level_is_the_one_that_the_best_fifth_reached(self):
        bests = [float(best) for best in range(1, 11)]
        self.assertEqual(next_level(bests, None, 99, 0), 9)
        self.assertEqual(next_level(bests, None, 8, 0), 8, "no further than the goal")
        self.assertEqual(next_level([3.0] * 9 + [4.0], 3, 99, 2), 4, "most stayed where they set out")
        self.assertEqual(next_level([3.0] * 10, 3, 99, 2), 99, "nobody came any further")
        self.assertEqual(next_level([3.0] * 9 + [4.0], None, 99, 0), 4, "all begin at the lowest")
        self.assertEqual(next_level([], 3, 99, 2), 99)
        self.assertEqual(next_level(bests, None, 99, MOST_LEVELS - 1), 99)

    def test_the_report_has_it_and_a_single_run_repeats_a_mission_that_reached_the_end(self):
        self.rare(24, 40, 4)
        self.sweep()
        (design,) = self.report()["designs"]
        (answer,) = self.rows("designs.csv")
        self.assertEqual(design["answer"], [float(answer[name]) for name in ("probability", "probability: low", "probability: high", "relative_error")])
        self.assertEqual(design["levels"][-1], 24)
        self.assertGreater(len(design["levels"]), 1)
        self.assertEqual([len(reached) for reached in design["reached"]], [len(design["levels"])] * 4)
        self.assertAlmostEqual(design["mean_shares"][-1], design["answer"][0], 12)
        words = shlex.split(design["command"])
        done = subprocess.run([MEBOTS, *words[1:], "--quiet"], capture_output=True, text=True, timeout=100)
        self.assertEqual(done.returncode, 0, done.stderr)
        out = words[words.index("--out") + 1]
        with open(out + "/summary.json", encoding="utf-8") as file:
            summary = json.load(file)
        self.assertGreaterEqual(summary["top"], 24)
        scenario = json.loads((self.folder / "out" / "rare" / "design_0.json").read_text())["scenario"]
        self.assertEqual(len(scenario), len(design["levels"]) - 1)
        self.assertEqual(summary["outcome"], "high")

    def test_the_same_bytes_come_for_any_jobs_and_after_a_kill(self):
        for levels in ([4, 8], 8):
            out = {name: f"{name} {levels}" for name in ("one", "two", "again")}
            self.rare(levels, 20, 2)
            self.sweep("--jobs", "1", out=out["one"])
            self.sweep("--jobs", "2", out=out["two"])
            lines = (self.folder / out["one"] / "journal.jsonl").read_text().splitlines(keepends=True)
            (self.folder / out["again"]).mkdir()
            (self.folder / out["again"] / "journal.jsonl").write_text("".join(lines[:50]))  # the states of the first level no longer exist
            self.sweep(out=out["again"])
            for name in ("levels.csv", "designs.csv"):
                self.assertEqual(self.bytes_of(name, out["one"]), self.bytes_of(name, out["two"]))
                self.assertEqual(self.bytes_of(name, out["one"]), self.bytes_of(name, out["again"]))

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
        config["instances"]["bad"] = {"fmu": STEADY, "parameters": {"fault": "error", "fault_time": 3}}
        (self.folder / "mission.json").write_text(json.dumps(config))
        self.study(design={"kind": "grid", "factors": {"/stop_time": [STEPS]}}, objectives=None, limits={"failures": 3},
                   draws={"replicates": 2, "variables": {"walk.seed": {"integer": [1, 2000000000]}}},
                   splitting={"score": "walk.height", "levels": [2, 8, 12], "missions": 10, "reseed": ["walk.seed"]})
        done = self.sweep_of_rare(code=1)
        (answer,) = self.rows("designs.csv")
        self.assertGreaterEqual(int(answer["failed"]), 3)
        self.assertEqual(answer["probability"], "", done)
        self.assertEqual({row["level"] for row in self.rows("levels.csv")}, {"2"})

    def test_its_mistakes_are_reported(self):
        self.rare([4, 4], 20, 2)
        self.assertIn("rise", self.sweep(code=2))
        self.rare([4, 8], 20, 2, below=3)
        self.assertIn("levels, above, below", self.sweep(code=2))
        self.rare([4, 8], 20, 2, reseed=["walk.sead"])
        self.assertIn("walk.seed", self.sweep(code=2))
        self.rare([4, 8], 20, 2, score="walk.hight")
        self.assertIn("Did you mean 'height'", self.sweep(code=2))


class RareEventsAgainstTheory(WalkCase):
    """Compares probabilities from many missions with closed forms and with counting."""

    def check_one_in_ten_thousand(self, levels, estimates):
        """Splitting must reach a relative error of 20 % with a tenth of the simulated time that counting needs."""
        exact = chance_to_reach(HEIGHT)
        self.assertLess(abs(math.log10(exact) + 4), 0.15)
        self.rare(levels, 200, estimates)
        self.sweep()
        (answer,) = self.rows("designs.csv")
        found, relative = float(answer["probability"]), float(answer["relative_error"])
        self.assertLess(relative, 0.2)
        self.assertLess(float(answer["probability: low"]), exact)
        self.assertGreater(float(answer["probability: high"]), exact)
        self.assertLess(abs(found / exact - 1), 3 * relative)
        # Without splitting, the relative error e of the probability p needs (1 - p) / (p e^2) missions.
        plain_s = (1 - exact) / (exact * relative**2) * STEPS
        print(f"{found:.3g} ({exact:.3g}), error {relative:.2g}, {plain_s / float(answer['simulated_time [s]']):.0f} times less simulated")
        self.assertGreater(plain_s / float(answer["simulated_time [s]"]), 10)

    def test_a_probability_of_one_in_ten_thousand_is_found_with_a_tenth_of_the_simulated_time(self):
        self.check_one_in_ten_thousand([9, 15, 21, 27, 33, HEIGHT], 12)

    def test_so_it_is_by_levels_that_pilot_missions_found(self):
        self.check_one_in_ten_thousand(HEIGHT, 12)
        pilot = [row for row in self.rows("levels.csv") if row["estimate"] == "pilot"]
        levels = [float(row["level"]) for row in pilot]
        self.assertGreater(len(levels), 3)
        self.assertEqual(levels, sorted(set(levels)))
        self.assertEqual(levels[-1], HEIGHT)
        for row in pilot[:-1]:  # a fifth of the missions, or more if many have the same score
            self.assertGreaterEqual(int(row["reached"]), 40)
            self.assertLess(int(row["reached"]), 80)
        own = [row["level"] for row in self.rows("levels.csv") if row["estimate"] == "3"]
        self.assertEqual([float(level) for level in own], levels)

    def test_it_agrees_with_counting_where_that_is_possible(self):
        """Compares splitting with counting for height 12, which one walk in four reaches."""
        exact = chance_to_reach(12)
        self.rare([4, 8, 12], 50, 12)
        self.sweep()
        (answer,) = self.rows("designs.csv")
        self.assertLess(float(answer["probability: low"]), exact)
        self.assertGreater(float(answer["probability: high"]), exact)
        counted = self.counted(600)
        self.assertLess(float(counted["success: low"]), exact)
        self.assertGreater(float(counted["success: high"]), exact)


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
