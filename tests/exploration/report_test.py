#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests report.html: its numbers equal those of the tables, and effects and importances of known functions are correct."""

import itertools
import unittest
import unittest.mock

import numpy as np

from mebots.exploration import effects, report, report_missions
from mebots.exploration.comparison import Evidence
from mebots.exploration.study import read_study
from support import StudyCase


def factor(name, values):
    return effects.Factor(name, name, "", 1.0, list(values), [str(one) for one in sorted(set(values))], np.array([sorted(set(values)).index(one) for one in values]))


class Effects(StudyCase):
    def grid(self, first, second):
        pairs = list(itertools.product(range(first), range(second)))
        return [factor("a", [one for one, _ in pairs]), factor("b", [two for _, two in pairs])], np.array(pairs, float)

    def study_of(self, kind):
        factors = {"a.gain": [1, 2]} if kind == "grid" else {"a.gain": {"uniform": [0, 1]}}
        more = {} if kind == "grid" else {"points": 40, "seed": 1}
        return read_study(self.study(design={"kind": kind, "factors": factors} | more))

    def test_a_sum_of_effects_has_no_interaction_and_known_shares(self):
        factors, points = self.grid(4, 4)
        found = effects.importances(self.study_of("grid"), factors, [(0, 1)], 3 * points[:, 0] + points[:, 1])
        self.assertAlmostEqual(found.factors[0], 0.9, 12)
        self.assertAlmostEqual(found.factors[1], 0.1, 12)
        self.assertAlmostEqual(found.pairs[0], 0.0, 9)
        self.assertEqual(effects.level_means(factors[0], 3 * points[:, 0] + points[:, 1]), [1.5, 4.5, 7.5, 10.5])

    def test_a_product_of_signs_is_an_interaction_alone(self):
        factors, points = self.grid(2, 2)
        values = (2 * points[:, 0] - 1) * (2 * points[:, 1] - 1)
        found = effects.importances(self.study_of("grid"), factors, [(0, 1)], values)
        np.testing.assert_allclose([*found.factors, *found.pairs], [0, 0, 1], atol=1e-12)
        self.assertEqual(effects.pair_means((factors[0], factors[1]), values), [1, -1, -1, 1])

    def test_a_factor_without_effect_explains_nothing_of_sampled_designs(self):
        """By chance, the five levels of a factor explain a tenth of the variance of 40 designs."""
        lot = np.random.default_rng(1)
        shares = []
        for _ in range(200):
            ones, twos = lot.integers(0, 5, 40).tolist(), lot.integers(0, 5, 40).tolist()
            found = effects.importances(self.study_of("random"), [factor("a", ones), factor("b", twos)], [], np.array(ones) + lot.normal(size=40))
            shares.append(found.factors)
        strong, idle = np.mean(shares, axis=0)
        # The factor has a variance of 2, and the noise of 1, so the factor has 2/3 of the variance.
        self.assertAlmostEqual(strong, 2 / 3, delta=0.08)
        self.assertLess(idle, 0.03)

    def test_equal_values_have_no_importance(self):
        factors, points = self.grid(2, 2)
        self.assertIsNone(effects.importances(self.study_of("grid"), factors, [], np.full(len(points), 5.0)))

    def test_factors_with_many_values_are_divided_into_parts_of_equal_size_with_units(self):
        values = [{"soc.core.clock": 50e6 * 1.01**one} for one in range(100)]

        class Units:
            def of_factor(self, name):
                return "Hz"

        (found,) = effects.factors_of(["soc.core.clock"], values, Units())
        self.assertEqual((found.unit, found.label, len(found.levels)), ("MHz", "clock", 5))
        self.assertEqual(found.levels[0], "50 to 60.9 MHz")
        self.assertEqual(np.bincount(found.level).tolist(), [20] * 5)

    def test_short_names_tell_factors_apart(self):
        self.assertEqual(effects.short_names(["battery.cell.name", "a.gain", "b.gain", "/stop_time"]), ["cell.name", "a.gain", "b.gain", "stop_time"])


class Reports(StudyCase):
    def test_the_numbers_are_those_of_the_tables(self):
        self.study()
        self.sweep()
        found, rows = self.report(), self.rows("designs.csv")
        for at, objective in enumerate(found["objectives"]):
            self.assertEqual(objective["mean"], [float(row[f"{objective['label']}: mean"]) for row in rows])
            missions = [float(row[objective["label"]]) for row in self.rows("missions.csv")]
            for mine, given in zip(found["missions"]["values"][at], missions, strict=True):
                self.assertAlmostEqual(mine, given, delta=1e-5 * abs(given))
            for design, own in enumerate(found["quantiles"][at]):
                self.assertAlmostEqual(own[3], np.median(missions[10 * design : 10 * design + 10]), delta=1e-5 * abs(own[3]))
        outcomes = [found["missions"]["outcomes"][one] for one in found["missions"]["outcome"]]
        self.assertEqual(outcomes, [row["outcome"] for row in self.rows("missions.csv")])
        self.assertEqual(found["courses"][0]["counts"][-1], 10)
        last = found["courses"][0]
        self.assertEqual([own[-1] for own in last["mean"]], [one["mean"][last["design"]] for one in found["objectives"]])

    def test_of_many_missions_every_nth_is_in_the_page_and_quantiles_are_of_all(self):
        study = read_study(self.study(draws={"replicates": 30_000, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}}))
        evidence = Evidence(study, 2)
        for design in range(2):
            evidence.put_rows(design, 0, np.stack([np.ones(30_000), np.arange(30_000.0)], axis=1))
            evidence.count_to(design, 30_000)
        found = report_missions.missions_of(evidence, [0, 1], None)
        self.assertEqual((found["every"], found["counts"]), (2, [15_000, 15_000]))
        self.assertEqual(found["values"][1][:3], [0, 2, 4])
        self.assertEqual(report_missions.quantiles_of(evidence, [0, 1])[1][0][-1], 29_999)

    def test_of_many_designs_the_best_and_every_nth_are_in_the_page(self):
        class Rows:
            rows = [type("Row", (), {"design": design}) for design in range(20_000, 0, -1)]

        content = type("Content", (), {"designs": range(20_001), "answer": Rows, "places": ["on" if design == 7 else "off" for design in range(20_001)]})
        kept = report._kept_designs(content)
        self.assertLessEqual(len(kept), report.MOST_DESIGNS + 1)
        self.assertTrue({20_000, 19_001, 7, 0} <= set(kept))
        self.assertEqual(kept, sorted(set(kept)))

    def test_a_factor_that_changes_the_config_has_no_command(self):
        self.study(design={"kind": "grid", "factors": {"/step": [0.1, 0.05]}})
        self.sweep()
        self.assertIsNone(self.report()["replay"])

    def test_without_pages_the_answer_is_text(self):
        from mebots import page

        def refuse(title, content):
            raise page.Error("built without pages", "not_offered")

        with unittest.mock.patch.object(page._mebots, "data_page", refuse):
            page.write_page(self.folder / "x.html", "a < b", {}, {}, "Lowest energy: 5 J")
        text = (self.folder / "x.html").read_text()
        self.assertIn("Lowest energy: 5 J", text)
        self.assertIn("a &lt; b", text)


if __name__ == "__main__":
    unittest.main()
