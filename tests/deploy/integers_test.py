#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that deployed integer networks have the same output bits as in onnxruntime, whose floating-point computation is
exact for them."""

import sys
import unittest

import numpy as np
import onnxruntime
from networks import DeployCase, Maker, objects
from onnx import helper

import mebots
from mebots.deploy import checking
from mebots.deploy import layers as integers
from mebots.deploy.deployed import Options
from mebots.deploy.lowering import lower


class IntegerMaker(Maker):
    """With ``shifts``, writes the operator RequantShift in place of Mul, Add, Div, Floor and Clip."""

    def __init__(self, seed, shape, shifts=False):
        super().__init__(seed, shape, opset=10)
        self.shifts = shifts

    def whole(self, low, high, *shape):
        return self.constant(self.random.integers(low, high + 1, shape).astype(np.float32))

    def requantise(self, source, channels, signed=False, factor=None):
        """Adds a requantisation. Sums below 2^24 / 256 are exact in float."""
        shape = () if factor else (1, channels, 1, 1)
        multiplier = self.constant(np.float32(factor)) if factor else self.whole(20, 200, *shape)
        addend = self.constant(np.float32(0)) if factor else self.whole(-9000, 9000, *shape)
        low, high = (-128.0, 127.0) if signed else (0.0, 255.0)
        if self.shifts:
            return self.node("RequantShift", source, multiplier, addend, div=[4096.0], n_levels_out=[256.0], signed=[float(signed)])
        total = self.node("Add", self.node("Mul", source, multiplier), addend)
        total = self.node("Add", total, self.constant(np.float32(2048)))
        return self.node("Clip", self.node("Floor", self.node("Div", total, self.constant(np.float32(4096)))), min=low, max=high)

    def network(self):
        first = self.requantise(self.node("Conv", "x", self.whole(-20, 20, 6, 2, 3, 3), pads=[1] * 4, kernel_shape=[3, 3]), 6)
        pooled = self.node("MaxPool", first, kernel_shape=[2, 2], strides=[2, 2])
        deep = self.requantise(self.node("Conv", pooled, self.whole(-20, 20, 6, 1, 3, 3), group=6, pads=[1] * 4, kernel_shape=[3, 3]), 6, signed=True)
        side = self.requantise(self.node("Conv", pooled, self.whole(-20, 20, 6, 6, 1, 1), kernel_shape=[1, 1]), 6, signed=True)
        joined = self.requantise(self.node("Add", deep, side), 1, factor=3000)
        flat = self.node("Flatten", joined)
        self.output(self.node("Gemm", flat, self.whole(-9, 9, 5, 150), self.whole(-99, 99, 5), transB=1))
        return self


class WholeNumbers(DeployCase):
    def deployed(self, maker, expected):
        model = self.folder / "model.onnx"
        model.write_bytes(expected)
        data = self.folder / "data.npy"
        np.save(data, np.random.default_rng(5).integers(0, 256, (4, *maker.shape)).astype(np.float32))
        return lower(model, data, Options()), np.load(data)

    def check(self, seed, shifts):
        exact = IntegerMaker(seed, (2, 10, 10)).network().model().SerializeToString()
        session = onnxruntime.InferenceSession(exact, providers=["CPUExecutionProvider"])
        maker = IntegerMaker(seed, (2, 10, 10), shifts).network()
        content = self.unchecked(maker).SerializeToString() if shifts else exact
        deployed, pictures = self.deployed(maker, content)
        for number, picture in enumerate(pictures):
            values = integers.run(deployed.network, deployed.pictures.one(number, deployed.scale))
            got = values[deployed.network.outputs[0]].ravel()
            np.testing.assert_array_equal(got, session.run(None, {"x": picture[np.newaxis]})[0].ravel())
        return deployed

    def unchecked(self, maker):
        """Returns a model with an operator that onnx does not know."""
        sizes = helper.make_tensor_value_info("x", 1, [1, *maker.shape]), helper.make_tensor_value_info(maker.outputs[0], 1, [1, 5])
        graph = helper.make_graph(maker.nodes, "made", [sizes[0]], [sizes[1]], maker.constants)
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", maker.opset)])
        model.ir_version = 5
        return model

    def test_divisions_and_shifts_on_all_machines(self):
        for seed, shifts in ((1, False), (2, True)):
            deployed = self.check(seed, shifts)
            library = self.folder / "library"
            deployed.sources.write(library)
            checking.check(library, self.folder, deployed, True, objects())

    def test_broken_requantising_is_refused(self):
        maker = IntegerMaker(1, (2, 10, 10), shifts=True)
        maker.output(maker.requantise(maker.node("Conv", "x", maker.whole(-20, 20, 5, 2, 6, 2), kernel_shape=[6, 2]), 3))
        model = self.unchecked(maker)
        del model.graph.node[-1].attribute[:]
        with self.assertRaisesRegex(mebots.InputError, "RequantShift lacks"):
            self.deployed(maker, model.SerializeToString())
        with self.assertRaises(mebots.InputError):
            self.deployed(maker, self.unchecked(maker).SerializeToString())

    def test_every_width_of_the_product_is_exact(self):
        random = np.random.default_rng(3)
        from mebots.deploy.arithmetic import exact_requantisation

        for most, multiplier, addend, shift, scaling in ((1 << 12, 1000, 5, 16, "narrow"), (1 << 23, 514, 0, 16, "wide"), (1 << 20, 99999, 12345, 24, "exact")):
            sums = random.integers(-most, most, (100, 3))
            made = exact_requantisation(np.full(3, multiplier), np.full(3, addend), shift, np.full(3, most))
            self.assertEqual(made.scaling, scaling)
            expected = [[min(max((int(one) * multiplier + addend) >> shift, 0), 255) for one in row] for row in sums]
            np.testing.assert_array_equal(made.apply(sums, 0, 255), expected)

    def test_equalisation_is_refused(self):
        model, data = self.folder / "model.onnx", self.folder / "data.npy"
        model.write_bytes(IntegerMaker(1, (2, 10, 10)).network().model().SerializeToString())
        np.save(data, np.zeros((2, 2, 10, 10), dtype=np.float32))
        with self.assertRaisesRegex(mebots.InputError, "--equalise: the network is in integers already"):
            lower(model, data, Options(equalise=True))

    def test_numbers_with_too_many_bits_are_refused(self):
        from mebots.deploy.arithmetic import exact_requantisation

        bounds = np.full(1, 1 << 20)
        widest = exact_requantisation(np.full(1, (1 << 30) - 1), np.zeros(1), 43, bounds)
        np.testing.assert_array_equal(widest.apply(np.full((1, 1), 1 << 20), 0, 255), [[((1 << 20) * ((1 << 30) - 1)) >> 43]])
        for multiplier, addend in ((1 << 30, 0), ((1 << 31) - 1, 0), (1, 1 << 62)):
            with self.assertRaisesRegex(OverflowError, "64 bits"):
                exact_requantisation(np.full(1, multiplier), np.full(1, addend), 40, bounds)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
