#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests networks with weights in HyperRAM: they give the same integers as the reference with each number of cores."""

import sys
import unittest

import numpy as np
import onnx
from networks import DeployCase, Maker, objects

import mebots
from mebots.deploy import layers as integers
from mebots.deploy.checking import check, compare
from mebots.deploy.deployed import Options
from mebots.deploy.lowering import lower


class WeightsInHyperRam(DeployCase):
    def network(self, widths):
        """Writes a network of a small convolution and dense layers with these widths."""
        maker = Maker(7, (1, 10, 10))
        name = maker.node("Flatten", maker.node("Relu", maker.conv("x", 1, 4, (1, 1))))
        for before, after in zip((400, *widths), (*widths, 5), strict=True):
            name = maker.node("Relu", maker.node("Gemm", name, maker.weights(after, before), maker.weights(after), transB=1))
        maker.output(name)
        onnx.save(maker.model(), str(self.folder / "model.onnx"))
        np.save(self.folder / "data.npy", maker.random.random((2, 1, 10, 10)).astype(np.float32))
        return self.folder / "model.onnx", self.folder / "data.npy"

    def test_each_number_of_cores_gives_the_references_integers(self):
        deployed = lower(*self.network((400, 400, 400, 400)), Options(board="gap8"))
        sizes = [size for _, size in deployed.plan.stream.segments]
        self.assertGreater(sum(sizes), deployed.board.l2 - 65536)
        self.assertGreater(max(sizes), 1 << 17)  # requires several transfers
        library = self.folder / "library"
        deployed.sources.write(library)
        program = check(library, self.folder, deployed, True, objects("gap8"))
        values = integers.run(deployed.network, program.picture)
        for cores in range(2, 8):
            compare(deployed.network, values, program.check(cores), f"{cores} cores")

    def test_weights_that_fit_nowhere_are_refused(self):
        model, data = self.network((400, 400, 400, 400))
        with self.assertRaisesRegex(mebots.InputError, "does not fit into L2 of board ai_deck.*or board gap8"):
            lower(model, data, Options())
        model, data = self.network((700, 400))
        with self.assertRaisesRegex(mebots.InputError, "weights of two successive layers.*The most are those of layer Gemm"):
            lower(model, data, Options(board="gap8"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
