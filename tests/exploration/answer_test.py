#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the text of answers: headline, ranked table, fronts, and the number of missions that would decide."""

import json
import math
import random
import sys
import unittest
import unittest.mock

import mebots
from mebots.exploration import answer, answers, figures, front, live_page
from mebots.exploration.comparison import Estimate, Evidence
from mebots.exploration.study import Objective, read_study
from support import StudyCase, page_content


class Figures(unittest.TestCase):
    def test_quantities_have_the_prefix_that_people_use(self):
        self.assertEqual(figures.quantity(102700000.0, "Hz"), "102.7 MHz")
        self.assertEqual(figures.quantity(0.000379323454, "J"), "379.3 µJ")
        self.assertEqual(figures.quantity(29.976, "s"), "29.98 s")
        self.assertEqual(figures.quantity(5000.0, "s"), "5000 s")
        self.assertEqual(figures.quantity(0.0143, "m"), "14.3 mm")
        self.assertEqual(figures.quantity(0.3, "1"), "0.3")
        self.assertEqual(figures.quantity("lipol_350"), "lipol_350")
        self.assertEqual(figures.quantity(True), "true")

    def test_a_value_has_the_digits_that_its_interval_allows(self):
        energy = Objective("energy", "summary", "energy")
        self.assertEqual(figures.estimate_text(Estimate(40, 263.412, (262.1, 264.3)), energy, "J"), "263 J (262 to 264)")
        self.assertEqual(figures.estimate_text(Estimate(40, 0.26, (0.18, 0.36)), energy, "J"), "260 mJ (180 to 360)")
        self.assertEqual(figures.estimate_text(Estimate(4, -0.0009, (-0.069, 0.067)), energy, "m"), "-1 mm (-69 to 67)")
        self.assertEqual(figures.estimate_text(Estimate(5, 208.8829, (208.8827, 208.8830)), energy, "J"), "208.883 J")
        self.assertEqual(figures.estimate_text(Estimate(1, 208.8829, (-math.inf, math.inf)), energy, "J"), "208.9 J")
        self.assertEqual(figures.estimate_text(Estimate(0, None, (-math.inf, math.inf)), energy, "J"), "-")
        success = Objective("success", "outcome", ("passed",))
        self.assertEqual(figures.estimate_text(Estimate(40, 1.0, (0.912, 1.0), 40), success, ""), "40 of 40 (91 to 100 %)")

    def test_no_share_below_1_reads_as_100_percent(self):
        self.assertEqual([figures.percent(one) for one in (0.0, 0.001, 0.5, 0.9991, 1.0)], ["0 %", "0.1 %", "50 %", "99.91 %", "100 %"])


class Percentiles(unittest.TestCase):
    def test_by_the_nearest_rank(self):
        self.assertEqual(answers.percentile_of([1, 2, 3, 4], 50), 2)
        self.assertEqual(answers.percentile_of([1, 2, 3, 4], 51), 3)
        self.assertEqual(answers.percentile_of([7], 1), 7)

    def test_too_few_values_bound_one_side_only(self):
        self.assertEqual(answers.percentile_interval([1, 2, 3], 95, 0.05), (2, math.inf))
        self.assertEqual(answers.percentile_interval([], 50, 0.05), (-math.inf, math.inf))

    def test_intervals_hold_the_percentile_as_often_as_they_say(self):
        """The 80th percentile of U(0, 1) is 0.8. At level 0.9, 300 intervals miss it at most 30 times on average, and more than 51 times
        with a probability below 1e-4. Both percentile_interval() and percentile_sequence() are conservative."""
        chance = random.Random(1)
        samples = [sorted(chance.random() for _ in range(60)) for _ in range(300)]
        for interval in (answers.percentile_interval, answers.percentile_sequence):
            found = [interval(sample, 80, 0.1) for sample in samples]
            self.assertLess(sum(not low <= 0.8 <= high for low, high in found), 52)
            self.assertGreater(sum(high - low < 0.6 for low, high in found), 250)

    def test_a_sequence_holds_at_all_counts_at_once(self):
        chance, missed = random.Random(2), 0
        for _ in range(100):
            sample = []
            missed += any(
                not low <= 0.5 <= high
                for _ in range(100)
                for low, high in [answers.percentile_sequence((sample.append(chance.random()), sorted(sample))[1], 50, 0.1)])
        self.assertLess(missed, 26)  # at most 10 on average; 26 with a probability below 1e-5

    def test_clopper_and_pearsons_interval(self):
        low, high = answers.exact_share(40, 40, 0.05)
        self.assertAlmostEqual(low, 0.025 ** (1 / 40), 9)
        self.assertEqual(high, 1.0)
        low, high = answers.exact_share(2, 10, 0.05)  # R: binom.test(2, 10)
        self.assertAlmostEqual(low, 0.02521073, 7)
        self.assertAlmostEqual(high, 0.55609546, 7)


class Answers(StudyCase):
    DRAWS = {"replicates": 20, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}}

    def judge(self, values, **sections):
        """Returns the answer of a study with these values of the objective "out" by design and mission."""
        study = read_study(self.study(
            design={"kind": "grid", "factors": {"a.gain": [float(one) for one in range(len(values))]}},
            objectives={"success": {"outcome": "far"}, "out": {"summary": "deep.out", "minimize": True, "where": "success"}}, **sections))
        evidence = Evidence(study, len(values))
        for design, own in enumerate(values):
            for replicate, value in enumerate(own):
                evidence.put(design, replicate, (float(value is not None), value))
            evidence.count_to(design, len(own))
        names = [f"gain {one}" for one in range(len(values))]
        units = figures.Units(study, {"deep": {"out": "a.real_out"}})
        return answer.Judge(evidence, units, names, ["all flown"] * len(values)).answer(front.places(evidence)), evidence

    def test_names_the_best_design_and_those_that_may_be_as_good(self):
        chance = random.Random(3)
        noise = [chance.uniform(-1, 1) for _ in range(20)]
        far, near, best = ([mean + scale * one for one in noise] for mean, scale in ((50, 1), (10.1, -1), (10, 1)))
        found, _ = self.judge([far, near, best])
        self.assertRegex(found.headlines[0], r"^Lowest out among 3 designs with success in 20 of 20: gain 2, .* 1 design cannot be separated from it\. Their success is above 83 %\.$")
        self.assertEqual([(row.rank, row.design, row.note) for row in found.rows],
                         [(1, 2, "best so far"), (2, 1, "not separated from the best"), (3, 0, "worse")])
        self.assertRegex("\n".join(found.remarks), r"Further missions of each design needed to separate gain 2: about \d+ from gain 1\.")

    def test_designs_with_equal_values_share_a_rank(self):
        found, _ = self.judge([[7.0] * 4, [5.0] * 4, [5.0] * 4, [5.0] * 4, [6.0] * 4])
        self.assertEqual([(row.rank, row.design) for row in found.rows], [(1, 1), (1, 2), (1, 3), (4, 4), (5, 0)])
        self.assertRegex(found.headlines[0], r"^Lowest out among 5 designs with success in 4 of 4: gain 1, .* 2 designs have the same value\.")
        self.assertNotIn("cannot be separated", found.headlines[0])

    def test_a_design_that_fails_more_often_is_not_the_best_by_its_energy(self):
        found, _ = self.judge([[10.0 + one / 100 for one in range(20)], [1.0 + one / 100 for one in range(3)] + [None] * 17])
        self.assertIn("with success in 20 of 20: gain 0", found.headlines[0])
        self.assertEqual(found.rows[0].design, 0)

    def test_as_many_more_missions_as_it_says_separate_two_designs(self):
        chance = random.Random(4)
        drawn = [chance.gauss(0, 1) for _ in range(20)]
        shift = 10.2 - sum(drawn) / 20
        for sections in ({}, {"rounds": {"size": 20, "racing": True}}):

            def decided(repeats, sections=sections):
                pair = [[10.0] * 20 * repeats, [shift + one for one in drawn] * repeats]
                _, evidence = self.judge(pair, draws=self.DRAWS | {"replicates": 2000}, **sections)
                return evidence

            self.assertFalse(decided(1).surely_better(0, 1, "out"))
            needed = answer.missions_to_separate(decided(1), 0, 1, decided(1).study.objective("out"))
            self.assertTrue(decided(math.ceil(1 + needed / 20)).surely_better(0, 1, "out"))
            self.assertFalse(decided(1 + needed // 40).surely_better(0, 1, "out"))

    def test_designs_of_a_fixed_study_are_distinguished_by_their_pairs(self):
        """The differences between designs are much larger than the spread of their five missions."""
        found, _ = self.judge([[10 + one, 11 + one, 9 + one, 10.5 + one, 10.2 + one] for one in (0, 0.1, 0.2)])
        self.assertIn("All others are surely worse", found.headlines[0])

    def test_designs_that_agree_in_the_first_objective_are_ranked_by_the_next(self):
        self.study(draws=self.DRAWS, design={"kind": "grid", "factors": {"a.gain": [3, 2, 4]}},
                   objectives={"ended": {"end_reason": "stop_time", "maximize": True}, "out": {"summary": "deep.out", "minimize": True}})
        said = self.sweep()
        self.assertRegex(said, r"Highest ended: gain 2, 20 of 20 .* 2 designs cannot be separated from it\.")
        self.assertRegex(said, r"(?s)1  #1 .*2  #0 .*3  #2 ")

    def test_without_draws_a_mission_of_each_design_decides(self):
        found, evidence = self.judge([[10.0], [10.1]], draws=None)
        self.assertIn("The other one is surely worse", found.headlines[0])
        self.assertEqual(front.places(evidence), ["on", "off"])

    def test_constraints_that_are_not_decided_say_how_many_missions_would(self):
        found, _ = self.judge([[10.0] * 12 + [None] * 8, [11.0] * 20], constraints={"success": {"above": 0.5}})
        self.assertIn("among 2 designs with success above 0.5: gain 0", found.headlines[0])
        self.assertRegex("\n".join(found.remarks), r"Not decided for 1 design: success above 0\.5: about \d+ more missions of each would decide\.")

    def test_with_several_objectives_each_says_what_would_separate_its_best_design(self):
        chance = random.Random(5)
        study = read_study(self.study(
            draws=self.DRAWS, design={"kind": "grid", "factors": {"a.gain": [1.0, 2.0, 3.0]}},
            objectives={"energy": {"summary": "deep.out", "minimize": True}, "miss": {"final": "a.real_out", "minimize": True}}))
        evidence = Evidence(study, 3)
        for design, (energy, miss) in enumerate(((10, 5), (20, 4.8), (20, 9))):
            for replicate in range(20):
                evidence.put(design, replicate, (energy + chance.gauss(0, 0.1), miss + chance.gauss(0, 0.5)))
            evidence.count_to(design, 20)
        names = ["low", "flat", "bad"]
        places = front.places(evidence)
        self.assertEqual(places, ["on", "undecided", "off"])
        remarks = "\n".join(answer.Judge(evidence, figures.Units(study, {}), names, ["all flown"] * 3).answer(places).remarks)
        self.assertIn("Proven to be on it: #0 low. Proven to be off it: 1 design. Undecided: 1 design.", remarks)
        self.assertNotIn("by energy", remarks)
        self.assertRegex(remarks, r"separate \w+ by miss: about \d+ from \w+\.")

    def test_a_config_of_a_run_is_refused_in_one_sentence(self):
        with self.assertRaisesRegex(mebots.InputError, r"^\S+: this is the config of a run, not a study\. `mebots run \S+` runs it"):
            read_study(self.folder / "mission.json")

    def test_the_program_prints_it(self):
        self.study(draws=self.DRAWS, objectives={"out": {"summary": "deep.out", "minimize": True}, "top": {"final": "a.real_out", "maximize": True}})
        said = self.sweep()
        self.assertRegex(said, r"Lowest out: gain 0\.2, .* The other one is surely worse\.")
        self.assertRegex(said, r"Highest top: gain 1, ")
        self.assertIn("Pareto front by means: #0 gain 0.2; #1 gain 1.", said)
        self.assertNotIn("undecided", said)
        data = self.report()
        self.assertEqual(data["designs"]["rank"], [1, 2])
        self.assertIn(data["answer"]["headlines"][0], said)
        for text in data["objectives"][0]["text"]:
            self.assertIn(text, said)

    def test_a_page_shows_the_designs_while_it_runs_and_leads_to_the_report_at_the_end(self):
        seen, page = [], self.folder / "out" / "live.html"

        def look(now):
            self.assertIn("missions", now.standings().rows[0].__dict__)
            seen.append(page_content(page) if page.exists() else None)

        with unittest.mock.patch.object(live_page, "_EVERY_S", 0.0), unittest.mock.patch.object(live_page, "_SHARE", 0.0):
            mebots.sweep(self.study(draws=self.DRAWS), self.folder / "out", jobs=1, progress=look)
        self.assertEqual(seen[-1]["refresh_s"], 0.0)
        self.assertGreater(seen[-1]["missions_of"], 0)
        self.assertRegex(seen[-1]["answer"]["headlines"][0], r"\d+ flown, .* left")
        self.assertIn("url=report.html", page.read_text())

    def test_facts_and_percentiles_are_objectives(self):
        self.study(draws=self.DRAWS, objectives={
            "time": {"summary": "simulated_time"}, "steps": {"summary": "steps"}, "ended": {"end_reason": "stop_time"},
            "stopped": {"end_reason": ["stop_condition", "failed"]}, "rise": {"series": "a.integral", "of": "first_true"},
            "middle": {"series": "a.integral", "of": "median"}, "p90": {"summary": "integral", "percentile": 90}})
        self.sweep()
        rows = self.rows("missions.csv")
        self.assertEqual({(row["time"], row["steps"], row["ended"], row["stopped"], row["rise"]) for row in rows}, {("1", "10", "1", "0", "0.1")})
        for row in rows:
            self.assertAlmostEqual(float(row["middle"]), 0.5 * float(row["a.real_in"]), 9)
        own = sorted(float(row["p90"]) for row in rows if row["design"] == "0")
        self.assertEqual(float(self.rows("designs.csv")[0]["p90: percentile 90"]), own[17])

    def test_mistakes_of_percentiles_and_end_reasons_are_named(self):
        self.study(objectives={"a": {"outcome": "far", "percentile": 5}, "b": {"summary": "integral", "percentile": 100}, "c": {"end_reason": "tired"}})
        said = self.sweep(code=2)
        self.assertIn("an objective that is a share has no percentile", said)
        self.assertIn("a percentile must be above 0 and below 100, not 100", said)
        self.assertIn("tired", said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
