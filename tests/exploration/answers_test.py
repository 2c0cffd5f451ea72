#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares intervals with published values, and counts wrong decisions of studies that are evaluated after every mission."""

import math
import os
import random
import statistics
import subprocess
import sys
import unittest

from mebots.exploration import answers, chance
from mebots.exploration.answers import Moments, mean_sequence, share_sequence, student, t_quantile, wilson

STUDIES = int(os.environ.get("MEBOTS_STUDIES", "200"))
FLIGHTS = 500
# With few studies, the share of wrong decisions varies. The limit is 5 % plus two standard deviations of this share.
MOST_WRONG = 0.05 if STUDIES >= 1000 else 0.05 + 2 * math.sqrt(0.05 * 0.95 / STUDIES)


class Intervals(unittest.TestCase):
    def test_wilsons_is_that_of_the_literature(self):
        # Newcombe (1998), Statistics in Medicine 17, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
        for successes, count, low, high in ((81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0, 0.1611), (1, 29, 0.0061, 0.1718)):
            found = wilson(successes, count, 0.05)
            self.assertAlmostEqual(found[0], low, 4)
            self.assertAlmostEqual(found[1], high, 4)

    def test_students_quantiles_are_those_of_the_tables(self):
        for p, freedom, value in ((0.975, 1, 12.706), (0.975, 10, 2.2281), (0.995, 5, 4.0321), (0.9995, 120, 3.3735), (0.975, 10**6, 1.95997)):
            self.assertAlmostEqual(t_quantile(p, freedom), value, 3 if value > 10 else 4)

    def test_the_sequence_of_a_mean_is_where_its_evidence_is_one_over_the_error(self):
        moments = Moments().add((1.0, 2.5, 3.0, 0.5, 2.0, 1.5, 2.2, 0.9))
        low, high = mean_sequence(moments, 0.05)
        n = moments.count
        for edge in (low, high):
            x = n * (moments.mean - edge) ** 2 / moments.deviation**2 / (n - 1)
            evidence = (1 + n) ** -0.5 * ((1 + x) / (1 + x / (1 + n))) ** (n / 2)
            self.assertAlmostEqual(evidence, 20, 6)

    def test_the_sequence_of_a_share_is_where_its_evidence_is_one_over_the_error(self):
        for edge in share_sequence(30, 100, 0.01):
            self.assertAlmostEqual(answers.share_evidence(30, 100, edge), math.log(100), 6)

    def test_without_missions_every_share_is_possible(self):
        self.assertEqual(share_sequence(0, 0, 0.05), (0, 1))
        self.assertEqual(wilson(0, 0, 0.05), (0, 1))
        one = Moments().add([1.0])
        for interval in (student(one, 0.05), mean_sequence(one, 0.05)):
            self.assertEqual(interval, (-math.inf, math.inf))


class Sequences(unittest.TestCase):
    """Counts studies that find a difference where none exists. Each study is evaluated after every mission."""

    def wrong(self, finds):
        chance = random.Random(1)
        return sum(finds(chance) for _ in range(STUDIES)) / STUDIES

    def test_is_the_share_another_than_it_is(self):
        sequence, peeking = {}, {}
        for share in (0.5, 0.95):
            def finds(chance, share=share, interval=share_sequence):
                successes = 0
                for count in range(1, FLIGHTS + 1):
                    successes += chance.random() < share
                    if count < 10:
                        continue
                    # Compares the evidence (the value of the martingale) with its bound. This is equivalent to comparing the interval's
                    # limits, but needs no search.
                    if interval is share_sequence:
                        if answers.share_evidence(successes, count, share) >= -math.log(0.05):
                            return True
                    else:
                        low, high = interval(successes, count, 0.05)
                        if not low <= share <= high:
                            return True
                return False

            sequence[share] = self.wrong(finds)
            peeking[share] = self.wrong(lambda chance: finds(chance, interval=wilson))
        print(f"wrong by sequence {sequence}, by peeking at Wilson {peeking}")
        for share in sequence:
            self.assertLessEqual(sequence[share], MOST_WRONG)
            self.assertGreater(peeking[share], 0.2)

    def test_is_a_success_above_a_bound_that_it_just_does_not_pass(self):
        def finds(chance):
            successes = 0
            for count in range(1, FLIGHTS + 1):
                successes += chance.random() < 0.95
                if successes > 0.95 * count and share_sequence(successes, count, 0.05)[0] > 0.95:
                    return True
            return False

        rate = self.wrong(finds)
        print(f"\"success above 0.95\" said of 0.95: {rate}")
        self.assertLessEqual(rate, MOST_WRONG)

    def test_is_one_of_two_equal_designs_better_by_success(self):
        def finds(chance):
            wins = decided = 0
            for _ in range(FLIGHTS):
                # Both designs have the same starts, so only pairs with different outcomes count.
                hard = chance.random() < 0.5
                a, b = (chance.random() < (0.6 if hard else 0.98) for _ in range(2))
                wins, decided = wins + (a and not b), decided + (a != b)
                if decided and answers.share_evidence(wins, decided, 0.5) >= -math.log(0.05):
                    return True
            return False

        rate = self.wrong(finds)
        print(f"\"A better than B\" said of equals: {rate}")
        self.assertLessEqual(rate, MOST_WRONG)

    def test_has_one_of_two_equal_designs_less_energy(self):
        rates = {}
        draws = {
            "normal": lambda chance: chance.gauss(0, 2),
            "uniform": lambda chance: chance.uniform(-1, 1),
            "skewed": lambda chance: chance.expovariate(1) - chance.expovariate(1),
        }
        for name, draw in draws.items():
            def finds(chance, draw=draw):
                moments = Moments()
                for _ in range(FLIGHTS):
                    moments.add([draw(chance)])
                    if moments.count >= 5:
                        low, high = mean_sequence(moments, 0.05)
                        if not low <= 0 <= high:
                            return True
                return False

            rates[name] = self.wrong(finds)
        print(f"\"less energy\" said of equals: {rates}")
        for rate in rates.values():
            self.assertLessEqual(rate, MOST_WRONG)

    def test_detects_a_true_difference(self):
        chance = random.Random(2)
        needed = []
        for _ in range(100):
            successes = count = 0
            while share_sequence(successes, count, 0.05)[0] <= 0.8:
                successes += chance.random() < 0.95
                count += 1
            needed.append(count)
        self.assertLess(sorted(needed)[50], 80)


class Draws(unittest.TestCase):
    HASH = """
import hashlib
from mebots.exploration import chance
draws = [chance.value(spread, chance.unit(1, "x", i)) for i in range(3000)
         for spread in ({"normal": [0, 1]}, {"log_uniform": [1e-3, 300]}, {"uniform": [-1, 2]})]
print(hashlib.sha256(repr(draws).encode()).hexdigest())
"""

    def test_they_are_the_same_bits_on_any_processor(self):
        def hash_with(**more):
            return subprocess.run([sys.executable, "-c", self.HASH], env=os.environ | more, capture_output=True, text=True, check=True).stdout

        plain = hash_with(GLIBC_TUNABLES="glibc.cpu.hwcaps=-AVX,-AVX2,-AVX512F,-FMA,-FMA4,-BMI1,-BMI2")
        self.assertEqual(hash_with(), plain)

    def test_the_normal_distributions_are_those_of_python_but_for_the_last_bit(self):
        for i in range(1, 2000):
            for u in (i / 2000, (i / 2000) ** 20, 1e-300 * i):
                expected = statistics.NormalDist().inv_cdf(u)
                self.assertLessEqual(abs(chance.normal(u) - expected), 2 * math.ulp(expected), u)


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
