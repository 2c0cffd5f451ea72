#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that deployed integer networks give the same bits as onnxruntime, whose floating-point results are exact for these networks."""

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
    """Writes integer networks. With ``shifts``, uses the operator RequantShift in place of Mul, Add, Div, Floor and Clip."""

    def __init__(self, seed, shape, shifts=False):
        super().__init__(seed, shape, opset=10)
        self.shifts = shifts

    def whole(self, low, high, *shape):
        return self.constant(self.random.integers(low, high + 1, shape).astype(np.float32))

    def requantise(self, source, channels, signed=False, factor=None):
        """Adds a requantisation. Its result in float is exact for sums below 2^24 / 256."""
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


class PlinioMaker(Maker):
    """Writes the nodes of PLiNIO's ONNX backend (commit 3d6b5e08, methods/mps/quant/backends/onnx/nn) with opset 10, its exporter's
    default: Pad, Conv, Mul, Add, Div, Floor and Clip. Both inputs of an addition have the same scale, so PLiNIO divides their sum by 2^0.
    ``signed`` is PLiNIO's option for activations from -128, which is also the value of pads."""

    def __init__(self, seed, signed):
        super().__init__(seed, (2, 10, 10), opset=10)
        self.signed = signed

    def whole(self, low, high, *shape):
        return self.constant(self.random.integers(low, high + 1, shape).astype(np.float32))

    def requantise(self, source, multiplier, addend, shift):
        total = self.node("Add", self.node("Mul", source, multiplier), addend)
        quotient = self.node("Floor", self.node("Div", total, self.constant(np.array([2.0**shift], dtype=np.float32))))
        return self.node("Clip", quotient, min=-128.0 if self.signed else 0.0, max=127.0 if self.signed else 255.0)

    def layer(self, source, channels, out, pad_value, groups=1):
        padded = self.node("Pad", source, mode="constant", pads=[0, 0, 1, 1, 0, 0, 1, 1], value=pad_value)
        product = self.node("Conv", padded, self.whole(-20, 20, out, channels // groups, 3, 3), group=groups, kernel_shape=[3, 3], pads=[0] * 4)
        return self.requantise(product, self.whole(20, 200, 1, out, 1, 1), self.whole(-9000, 9000, 1, out, 1, 1), 12)

    def network(self):
        pad_value = -128.0 if self.signed else 0.0
        first = self.layer("x", 2, 6, 0.0)
        total = self.node("Add", self.layer(first, 6, 6, pad_value), self.layer(first, 6, 6, pad_value, groups=6))
        joined = self.requantise(total, self.constant(np.float32(1)), self.constant(np.float32(128 if self.signed else 0)), 0)
        sums = self.node("MatMul", self.node("Flatten", joined), self.whole(-9, 9, 600, 5))
        self.output(self.node("Add", sums, self.whole(-99, 99, 1, 5)))
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

    def test_networks_of_plinio_keep_their_bits(self):
        for seed, signed in ((1, False), (2, True)):
            maker = PlinioMaker(seed, signed).network()
            exact = maker.model().SerializeToString()
            session = onnxruntime.InferenceSession(exact, providers=["CPUExecutionProvider"])
            deployed, pictures = self.deployed(maker, exact)
            for number, picture in enumerate(pictures):
                values = integers.run(deployed.network, deployed.pictures.one(number, deployed.scale))
                got = values[deployed.network.outputs[0]].ravel()
                np.testing.assert_array_equal(got, session.run(None, {"x": picture[np.newaxis]})[0].ravel())
            library = self.folder / f"library{seed}"
            deployed.sources.write(library)
            checking.check(library, self.folder, deployed, True, objects())

    def test_numbers_of_bits_in_plinios_graphs_do_not_matter(self):
        """PLiNIO's backend MATCH adds attributes that ONNX's checker rejects (methods/mps/quant/backends/match/annotator.py)."""
        maker = PlinioMaker(1, False).network()
        plain, _ = self.deployed(maker, maker.model().SerializeToString())
        model = maker.model()
        bits = {"Conv": {"weight_bits": 8, "bias_bits": 32}, "MatMul": {"weight_bits": 8}, "Mul": {"mult_bits": 32}, "Add": {"add_bits": 32}, "Clip": {"out_bits": 8}}
        for node in model.graph.node:
            node.attribute.extend(helper.make_attribute(name, value) for name, value in bits.get(node.op_type, {}).items())
        marked, _ = self.deployed(maker, model.SerializeToString())
        self.assertEqual([one.name for one in plain.network.layers], [one.name for one in marked.network.layers])
        picture = plain.pictures.one(0, plain.scale)
        expected, got = (integers.run(one.network, picture)[one.network.outputs[0]] for one in (plain, marked))
        np.testing.assert_array_equal(got, expected)

    def test_graphs_of_integer_operators_are_refused_by_name(self):
        model = PlinioMaker(1, False).network().model()
        node = next(one for one in model.graph.node if one.op_type == "Conv")
        node.op_type = "ConvInteger"
        maker = PlinioMaker(1, False)
        with self.assertRaisesRegex(mebots.InputError, "ConvInteger"):
            self.deployed(maker, model.SerializeToString())

    def test_divisors_that_are_no_power_of_two_are_refused(self):
        for divisor in (3, 255, 65535):
            maker = IntegerMaker(1, (2, 10, 10))
            total = maker.node("Mul", maker.node("Conv", "x", maker.whole(-9, 9, 4, 2, 3, 3), kernel_shape=[3, 3]), maker.constant(np.float32(2)))
            quotient = maker.node("Floor", maker.node("Div", total, maker.constant(np.float32(divisor))))
            maker.output(maker.node("Clip", quotient, min=0.0, max=255.0))
            with self.assertRaisesRegex(mebots.InputError, rf"\(Div\): divides by \[{divisor}\]"):
                self.deployed(maker, maker.model().SerializeToString())

    def test_biases_that_are_no_whole_numbers_are_refused(self):
        maker = IntegerMaker(1, (2, 10, 10))
        bias = maker.constant(np.array([1, 2.5, 3, 4], dtype=np.float32))
        sums = maker.node("Conv", "x", maker.whole(-9, 9, 4, 2, 3, 3), bias, kernel_shape=[3, 3])
        total = maker.node("Mul", sums, maker.constant(np.float32(2)))
        quotient = maker.node("Floor", maker.node("Div", total, maker.constant(np.float32(256))))
        maker.output(maker.node("Clip", quotient, min=0.0, max=255.0))
        with self.assertRaisesRegex(mebots.InputError, r"\(Conv\): its bias contains 2.5, which is no whole number"):
            self.deployed(maker, maker.model().SerializeToString())

    def test_pads_outside_a_byte_are_refused(self):
        for value in (300.0, 0.5, -1.0):
            maker = PlinioMaker(1, False)
            maker.output(maker.layer("x", 2, 4, value))
            with self.assertRaisesRegex(mebots.InputError, r"\(Pad\): it fills with .*; whole numbers from 0 to 255 are possible"):
                self.deployed(maker, maker.model().SerializeToString())

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
