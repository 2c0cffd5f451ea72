# SPDX-License-Identifier: Apache-2.0
"""Compares the known solutions in truths.py with values computed by hand. Also checks that wrong results do not agree with
them."""

import math
import types
import unittest

import numpy as np

import truths


def description(name, experiment=None, internal=None, **variables):
    """Returns a description like FMPy's with these variables and start values."""
    return types.SimpleNamespace(
        modelName=name, defaultExperiment=experiment, coSimulation=types.SimpleNamespace(fixedInternalStepSize=internal),
        modelVariables=[types.SimpleNamespace(name=key, start=None if value is None else str(value)) for key, value in variables.items()])


def source(block, **parameters):
    truth = truths.modelica_block(truths.Model(description(f"Modelica.Blocks.Sources.{block}", **parameters)))
    return lambda t: float(truth.values(np.array([t]))["y"][0])


class SourcesOfTheModelicaLibrary(unittest.TestCase):
    def test_sine_with_its_phase_starts_at_its_start_time(self):
        y = source("Sine", amplitude=2, freqHz=0.25, phase=math.pi / 2, offset=1, startTime=1)
        self.assertEqual(y(0.5), 1)
        self.assertAlmostEqual(y(1), 3)
        self.assertAlmostEqual(y(2), 1)
        self.assertAlmostEqual(y(3), -1)
        self.assertAlmostEqual(source("Sine", amplitude=1, f=1, phase=0, offset=0, startTime=0)(0.25), 1)
        self.assertAlmostEqual(source("Cosine", amplitude=1, f=1, phase=0, offset=0, startTime=0)(0.5), -1)

    def test_clock_step_ramp_and_constant(self):
        self.assertEqual(source("Clock", offset=0.5, startTime=1)(3), 2.5)
        self.assertEqual(source("Constant", k=4)(7), 4)
        step = source("Step", height=3, offset=1, startTime=2)
        self.assertEqual((step(1.9), step(2.1)), (1, 4))
        ramp = source("Ramp", height=4, duration=2, offset=1, startTime=1)
        self.assertEqual((ramp(0), ramp(1.5), ramp(2), ramp(9)), (1, 2, 3, 5))

    def test_periodic_signals(self):
        pulse = source("Pulse", amplitude=2, width=25, period=4, offset=1, startTime=1)
        self.assertEqual([pulse(t) for t in (0.5, 1.5, 2.5, 5.5, 6.5)], [1, 3, 1, 3, 1])
        saw = source("SawTooth", amplitude=2, period=4, offset=1, startTime=1)
        self.assertEqual([saw(t) for t in (0, 2, 4, 6)], [1, 1.5, 2.5, 1.5])
        trapezoid = source("Trapezoid", amplitude=2, rising=1, width=2, falling=1, period=5, offset=0, startTime=0)
        self.assertEqual([trapezoid(t) for t in (0.5, 2, 3.5, 4.5, 5.5)], [1, 2, 1, 0, 1])

    def test_exponential_signals(self):
        y = source("ExpSine", amplitude=1, f=0.25, phase=0, damping=1, offset=0, startTime=0)
        self.assertAlmostEqual(y(1), math.exp(-1))
        y = source("Exponentials", outMax=1, riseTime=1, riseTimeConst=1, fallTimeConst=2, offset=0, startTime=0)
        self.assertAlmostEqual(y(0.5), 1 - math.exp(-0.5))
        self.assertAlmostEqual(y(3), (1 - math.exp(-1)) * math.exp(-1))

    def test_an_unknown_block_has_no_truth(self):
        self.assertIsNone(truths.modelica_block(truths.Model(description("Modelica.Blocks.Sources.CombiTimeTable"))))


class Comparison(unittest.TestCase):
    times = [0.01 * k for k in range(101)]

    def test_a_clock_that_runs_to_the_stop_time_in_its_first_step_disagrees(self):
        clock = truths.modelica_block(truths.Model(description("Modelica.Blocks.Sources.Clock", offset=0, startTime=0)))
        ratio, error, place = truths.compare(clock, self.times, 0.01, {"y": [0.0] + [1.0] * 100})
        self.assertGreater(ratio, 1)
        self.assertAlmostEqual(error, 0.99)
        self.assertIn("y is 1 instead of 0.01 at 0.01 s", place)
        self.assertLessEqual(truths.compare(clock, self.times, 0.01, {"y": self.times})[0], 1)

    def test_a_method_may_be_as_far_off_as_it_is_and_no_further(self):
        decay = truths.reference_fmu(truths.Model(description("Dahlquist", internal="0.01", x=1, k=1)))
        euler = [0.99 ** k for k in range(101)]
        self.assertLessEqual(truths.compare(decay, self.times, 0.01, {"x": euler})[0], 1)
        self.assertGreater(truths.compare(decay, self.times, 0.01, {"x": [0.98 ** k for k in range(101)]})[0], 1)

    def test_a_bound_that_is_too_large_is_no_agreement(self):
        stiff = truths.openmodelica(truths.Model(description("HelloWorld", a=-300, x_start=1, x=0)))
        euler = [(-2.0) ** k for k in range(101)]
        ratio, _, place = truths.compare(stiff, self.times, 0.01, {"x": euler})
        self.assertEqual(ratio, math.inf)
        self.assertIn("says nothing", place)

    def test_a_ball_falls_and_rises_with_its_damped_speed(self):
        height = truths.bouncing(1.0, 0.0, 10.0, 0.5, 0.0, [0.0, 0.2, math.sqrt(0.2) + 0.1])
        self.assertAlmostEqual(height[1, 0], 0.8)
        self.assertAlmostEqual(height[2, 0], 0.5 * math.sqrt(20) * 0.1 - 0.05)

    def test_a_linear_system_is_solved_exactly(self):
        x = truths.linear([[0, 1], [-1, 0]], [0, 0], [1, 0])(np.array([0, math.pi / 2, math.pi]))
        self.assertTrue(np.allclose(x, [[1, 0], [0, -1], [-1, 0]], atol=1e-12))


if __name__ == "__main__":
    unittest.main()
