#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the Pareto front with its definition, for each method, and for many designs."""

import random
import sys
import unittest
import unittest.mock

import numpy as np

from mebots.exploration import front, pareto
from mebots.exploration.comparison import Evidence
from mebots.exploration.study import read_study
from support import StudyCase


def by_definition(points):
    return [at for at, point in enumerate(points)
            if not any((other >= point).all() and (other > point).any() for other in points)]


def places_by_definition(evidence):
    """Computes front.places() by comparing each pair of designs."""
    designs = range(len(evidence.counts))
    feasible = [evidence.feasible(design) for design in designs]
    leaders = evidence.leaders([design for design in designs if feasible[design]])
    result = []
    for design in designs:
        if feasible[design] is False:
            result.append("excluded")
        elif any(evidence.dominates(leader, design) for leader in leaders if leader != design):
            result.append("off")
        elif feasible[design] and all(evidence.not_dominated_by(design, rival) for rival in designs
                                      if rival != design and feasible[rival] is not False):
            result.append("on")
        else:
            result.append("undecided")
    return result


class Points(unittest.TestCase):
    def test_no_other_point_dominates_those_of_the_front(self):
        chance = np.random.default_rng(1)
        for size in (1, 2, 3, 17, 400):
            for columns in (1, 2, 3, 4):
                for points in (chance.random((size, columns)), chance.integers(0, 4, (size, columns)).astype(float)):
                    self.assertEqual(pareto.front(points), by_definition(points))
                    with unittest.mock.patch.object(pareto, "moocore", None):
                        self.assertEqual(pareto.front(points), by_definition(points))

    def test_infinities_are_allowed(self):
        points = np.array([[np.inf, 0.0], [1.0, 1.0], [-np.inf, 2.0], [-np.inf, 1.0]])
        self.assertEqual(pareto.front(points), [0, 1, 2])


class Places(StudyCase):
    def evidence(self, designs, replicates, noise, **sections):
        study = read_study(self.study(
            objectives={"out": {"summary": "deep.out", "minimize": True}, "integral": {"summary": "integral", "maximize": True, **sections}}))
        evidence = Evidence(study, designs)
        chance = random.Random(2)
        for design in range(designs):
            at = design / max(designs - 1, 1)
            for replicate in range(replicates):
                shared = chance.gauss(0, noise) if design % 3 else 0.0
                evidence.put(design, replicate, (at + shared, at * at + shared + 0.3 * (design % 5 == 0)))
            evidence.count_to(design, replicates)
        return evidence

    def test_are_those_of_all_pairs(self):
        seen = set()
        for noise in (0.0, 0.001, 0.02, 0.3):
            for tolerance in (0.0, 0.05):
                evidence = self.evidence(40, 12, noise, tolerance=tolerance)
                found = front.places(evidence)
                self.assertEqual(found, places_by_definition(evidence), (noise, tolerance))
                seen.update(found)
        self.assertEqual(seen, {"on", "off", "undecided"})

    def test_of_different_numbers_of_missions_are_those_of_all_pairs(self):
        evidence = self.evidence(30, 12, 0.02)
        for design in range(0, 30, 4):
            evidence.count_to(design, 7)
        self.assertEqual(front.places(evidence), places_by_definition(evidence))


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
