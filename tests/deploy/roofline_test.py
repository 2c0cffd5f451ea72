#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the roofline: no layer is faster than its bound, and long inner loops approach it."""

import sys
import unittest

from networks import DeployCase, Maker, objects

from mebots.deploy import chip, roofline
from mebots.deploy.checking import check
from mebots.deploy.deployed import Options
from mebots.deploy.lowering import lower
from mebots.deploy.plan import Stream, traffic

CORES = 8


class Roofline(DeployCase):
    def times(self, maker, board):
        """Returns the deployed network, and the times of its first 0, 1, 2 ... layers."""
        deployed = lower(*maker.save(self.folder), Options(board=board))
        library = self.folder / "library"
        deployed.sources.write(library)
        program = check(library, self.folder, deployed, True, objects(board))
        return deployed, [program.report(CORES, count)["time_s"] for count in range(len(program.bytes) + 1)]

    def shares(self, maker, board="ai_deck"):
        """Returns for each layer the lower bound of its cycles (the roofline) divided by the measured cycles."""
        deployed, times = self.times(maker, board)
        bounds = [roofline.bound(layer, steps, CORES) for layer, steps in zip(deployed.network.layers, deployed.plan.steps, strict=True)]
        return [one / ((b - a) * chip.CLOCK_HZ) for one, a, b in zip(bounds, times, times[1:], strict=False)]

    def test_long_dot_products_come_near_to_the_bound(self):
        maker = Maker(1, (256, 8, 8))
        maker.output(maker.conv("x", 256, 64, (1, 1)))
        (share,) = self.shares(maker)
        self.assertGreater(share, 0.75)
        self.assertLess(share, 1)

    def test_copies_take_less_than_twice_the_bound(self):
        maker = Maker(2, (1024, 1, 1))
        maker.output(maker.conv("x", 1024, 128, (1, 1)))
        (share,) = self.shares(maker)
        self.assertGreater(share, 0.5)
        self.assertLess(share, 1)

    def test_no_layer_is_faster_than_its_bound(self):
        maker = Maker(3, (3, 24, 24))
        first = maker.node("Relu", maker.conv("x", 3, 16, (3, 3), pads=[1] * 4))
        pooled = maker.node("MaxPool", maker.conv(first, 16, 8, (1, 1)), kernel_shape=[2, 2], strides=[2, 2])
        by_channel = maker.conv(pooled, 8, 8, (3, 3), 8, pads=[1] * 4)
        grouped = maker.conv(by_channel, 8, 8, (3, 3), 2)
        total = maker.node("Add", by_channel, pooled)
        maker.output(grouped, maker.node("Gemm", maker.node("Flatten", total), maker.weights(5, 1152), maker.weights(5), transB=1))
        self.assertLess(max(self.shares(maker, "gap8")), 1)

    def test_loops_load_as_few_operands_as_the_registers_allow(self):
        self.assertEqual(roofline.loads_per_dot(4, 4, 100), 0.5)  # eight loads for sixteen dot products
        self.assertEqual(roofline.loads_per_dot(4, 1, 100), 1.25)  # a dense layer: four weights and an input
        self.assertEqual(roofline.loads_per_dot(8, 100, 2), 1 / 7)  # the weights of seven channels stay in registers
        self.assertAlmostEqual(roofline.peak(8), 8 * 64 / 24)

    def test_no_network_is_faster_than_its_bound(self):
        maker = Maker(4, (640, 1, 1))
        name = "x"
        for before, out in ((640, 64), (64, 128), (128, 128), (128, 5)):
            name = maker.conv(name, before, out, (1, 1))
        maker.output(name)
        deployed, times = self.times(maker, "ai_deck")
        layers, steps = deployed.network.layers, deployed.plan.steps
        self.assertTrue(all(one.early for one in steps[1:]))
        total = roofline.total_bound(layers, deployed.plan, CORES, 1.0)
        self.assertLess(total, (times[-1] - times[0]) * chip.CLOCK_HZ)
        # All weights count, also those that are fetched during the previous layer.
        self.assertGreater(total, sum(one.weights for one in layers) / roofline.DMA_BYTES)
        self.assertGreater(total, sum(roofline.bound(*one, CORES) for one in zip(layers, steps, strict=True)))

    def test_rows_that_no_tile_fetches_do_not_count(self):
        maker = Maker(5, (64, 11, 300))
        maker.output(maker.conv("x", 64, 4, (1, 1), strides=[5, 5]))
        deployed, times = self.times(maker, "ai_deck")
        steps = deployed.plan.steps[0]
        self.assertEqual((steps.tiles, steps.tile_rows), (3, 1))
        self.assertEqual(traffic(deployed.network.layers[0], steps).fetched, 3 * 300 * 64)
        self.assertLess(roofline.bound(deployed.network.layers[0], steps, CORES), (times[1] - times[0]) * chip.CLOCK_HZ)

    def test_values_that_no_kernel_covers_are_not_loaded(self):
        maker = Maker(6, (8, 16, 16))
        maker.output(maker.conv("x", 8, 8, (1, 1), 8, strides=[4, 4]))
        layer = self.times(maker, "ai_deck")[0].network.layers[0]
        values = 8 * 4 * 4
        converted = roofline.compute_cycles(layer) - values * (1 + 0.25)  # a product and a quarter of a load for each value
        self.assertIn(converted / values, (3.75, 7.75, 11.75))

    def test_weights_from_hyperram_bound_the_whole_network(self):
        stream = Stream([(0, 1000), (1000, 300), (1300, 50)])
        self.assertEqual(roofline.with_hyperram([100.0, 200.0, 400.0], stream, 1.0), 1000 + 300 + 200 + 400)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
