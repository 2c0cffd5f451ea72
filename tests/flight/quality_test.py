#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the rules that find bad samples of a flight log."""

import pathlib
import unittest

import numpy as np

import mebots
from mebots.flight.log import COMMANDS, SPEEDS, UNITS, Signal, log_of
from mebots.flight.quality import clean, counts, covered

TIMES = np.arange(0, 10, 0.01)


def log(**changes):
    """Returns the log of a noisy hover of 10 s. ``changes`` replaces values by signal name."""
    noise = np.random.default_rng(1).normal(0, 1, (9, len(TIMES)))
    values = {name: 0.6 + 0.02 * noise[i] for i, name in enumerate(COMMANDS)}
    values |= {name: 2000 + 20 * noise[4 + i] for i, name in enumerate(SPEEDS)}
    values["battery.voltage"] = 3.8 + 0.002 * noise[8]
    values |= changes
    return log_of(pathlib.Path("hover"), "test", [Signal(n, UNITS[n], TIMES, np.asarray(v, float), n) for n, v in values.items()])


def changed(name, where, value):
    values = log()[name].values.copy()
    values[where] = value
    return log(**{name: values})


class Rules(unittest.TestCase):
    def test_a_good_log_is_left_alone(self):
        cleaned, findings = clean(log())
        self.assertEqual(findings, [])
        self.assertEqual(len(cleaned["battery.voltage"]), len(TIMES))

    def test_a_voltage_in_another_unit_is_refused_with_its_median(self):
        with self.assertRaisesRegex(mebots.InputError, r"battery\.voltage: 1000 of 1000 values are impossible for battery\.voltage, whose range is 0\.5 to 4\.4 V; their median is 38"):
            clean(log(**{"battery.voltage": 1000 * log()["battery.voltage"].values}), cells=1)

    def test_a_voltage_that_stays_on_one_value_is_excluded(self):
        cleaned, findings = clean(log(**{"battery.voltage": np.full(len(TIMES), 3.7)}))
        self.assertEqual(counts(findings), {"stuck": len(TIMES)})
        self.assertFalse(cleaned.has(["battery.voltage"]))

    def test_a_resting_voltage_may_stay_on_one_value(self):
        still = {name: np.zeros(len(TIMES)) for name in (*COMMANDS, *SPEEDS)}
        _, findings = clean(log(**{"battery.voltage": np.full(len(TIMES), 3.7)}, **still))
        self.assertEqual(findings, [])

    def test_a_rotor_that_reads_half_is_excluded(self):
        cleaned, findings = clean(changed("rotor[1].speed", slice(100, 300), log()["rotor[2].speed"].values[100:300] / 2))
        self.assertEqual(counts(findings), {"wrong_speed": 200})
        self.assertGreater(cleaned["rotor[1].speed"].values.min(), 1800)
        self.assertAlmostEqual(findings[0].first_s, 1.0)

    def test_a_rotor_that_is_driven_less_may_be_slow(self):
        slow = log()["rotor[1].speed"].values.copy()
        command = log()["motor[1].command"].values.copy()
        slow[100:300] /= 2
        command[60:300] = 0.2 + 0.001 * (np.arange(240) % 7)
        _, findings = clean(log(**{"rotor[1].speed": slow, "motor[1].command": command}))
        self.assertEqual(findings, [])

    def test_impossible_values_are_excluded(self):
        for name, value in (("motor[2].command", 20.96), ("battery.voltage", 0.0), ("rotor[3].speed", 6800.0)):
            with self.subTest(name):
                _, findings = clean(changed(name, [5, 50], value))
                self.assertEqual(counts(findings), {"impossible": 2})

    def test_one_cell_has_no_more_than_a_charger_gives(self):
        four = changed("battery.voltage", [7], 4.65)
        self.assertEqual(counts(clean(four)[1]), {})
        self.assertEqual(counts(clean(four, cells=1)[1]), {"impossible": 1})

    def test_gaps_that_were_filled_by_straight_lines_are_excluded(self):
        _, findings = clean(changed("motor[1].command", slice(100, 200), np.linspace(0.5, 0.9, 100)))
        self.assertEqual(counts(findings), {"straight": 100})

    def test_commands_at_their_limit_are_counted_and_kept(self):
        cleaned, findings = clean(changed("motor[1].command", [3, 4], 1.0))
        self.assertEqual([(one.rule, one.count, one.excluded) for one in findings], [("at_limit", 2, False)])
        self.assertEqual(len(cleaned["motor[1].command"]), len(TIMES))

    def test_numbers_that_are_none_are_excluded(self):
        _, findings = clean(changed("battery.voltage", [3, 9], np.nan))
        self.assertEqual(counts(findings), {"not_finite": 2})
        self.assertIn("2 of 1000 samples excluded", str(findings[0]))


class Clocks(unittest.TestCase):
    def signal(self, times):
        return log_of(pathlib.Path("clock"), "test", [Signal("battery.voltage", "V", np.array(times, float), np.full(len(times), 3.7), "v")])

    def test_times_that_go_back_are_excluded(self):
        cleaned, findings = clean(self.signal([0, 1, 2, 1.5, 3, 4]))
        self.assertEqual(counts(findings), {"time_back": 1})
        np.testing.assert_allclose(cleaned["battery.voltage"].times, [0, 1, 2, 3, 4])

    def test_a_clock_that_starts_again_is_refused(self):
        with self.assertRaises(mebots.InputError) as caught:
            clean(self.signal([100, 101, 0, 1, 2, 3, 4]))
        self.assertIn("sample 3", str(caught.exception))

    def test_gaps_are_counted_and_not_covered(self):
        cleaned, findings = clean(self.signal([0, 0.01, 0.02, 0.03, 1.03, 1.04]))
        self.assertEqual(counts(findings), {"gap": 1})
        np.testing.assert_array_equal(covered(cleaned["battery.voltage"], np.array([0.005, 0.5, 1.035, 2])), [True, False, True, False])


if __name__ == "__main__":
    unittest.main()
