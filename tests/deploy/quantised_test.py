#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that models quantised by onnxruntime keep the bits of their weights, and their scales."""

import sys
import unittest

import numpy as np
import onnx
from networks import DeployCase, Maker
from onnxruntime.quantization import CalibrationDataReader, QuantFormat, QuantType, quantize_static

from mebots.deploy import layers as integers
from mebots.deploy.arithmetic import Scale
from mebots.deploy.deployed import Options
from mebots.deploy.lowering import lower


class Reader(CalibrationDataReader):
    def __init__(self, values):
        self._rows = iter([{"x": one[np.newaxis]} for one in values])

    def get_next(self):
        return next(self._rows, None)


class QuantisedModels(DeployCase):
    def test_weights_and_scales_of_onnxruntime_stay(self):
        for activations in (QuantType.QUInt8, QuantType.QInt8):
            maker = Maker(1, (2, 9, 9))
            first = maker.node("Relu", maker.conv("x", 2, 8, (3, 3), pads=[1, 1, 1, 1]))
            second = maker.node("Add", maker.conv(first, 8, 8, (3, 3), pads=[1, 1, 1, 1]), first)
            maker.output(maker.node("Gemm", maker.node("Flatten", second), maker.weights(4, 8 * 81), maker.weights(4), transB=1))
            path, data = maker.save(self.folder)
            quantised = self.folder / "quantised.onnx"
            quantize_static(
                str(path), str(quantised), Reader(np.load(data)), quant_format=QuantFormat.QDQ, per_channel=True, activation_type=activations, weight_type=QuantType.QInt8
            )
            self.check(quantised, data)

    def test_clips_between_quantising_and_dequantising_are_integers(self):
        # Brevitas exports activations of less than 8 bits in this way (QCDQ).
        for kind, zero, low, high in ((np.uint8, 0, 0, 15), (np.uint8, 3, 1, 12), (np.int8, -8, -8, 7)):
            maker = Maker(1, (2, 9, 9))
            hidden = maker.node("Relu", maker.conv("x", 2, 8, (3, 3)))
            step, point = maker.constant(np.float32(0.125)), maker.constant(np.array(zero, dtype=kind))
            limits = [maker.constant(np.array(one, dtype=kind)) for one in (low, high)]
            clipped = maker.node("Clip", maker.node("QuantizeLinear", hidden, step, point), *limits)
            maker.output(maker.node("DequantizeLinear", clipped, step, point))
            deployed = lower(*maker.save(self.folder), Options())
            (layer,) = deployed.network.layers
            offset = 128 if kind == np.int8 else 0
            self.assertEqual((layer.low, layer.high), (max(low, zero) + offset, high + offset))  # Relu ends at the zero point
            self.assertEqual(deployed.network.scales[layer.output], Scale(0.125, zero + offset))

    def check(self, path, data):
        deployed = lower(path, data, Options())
        bytes_of = {one.name: onnx.numpy_helper.to_array(one) for one in onnx.load(str(path)).graph.initializer}
        kept = [one for one in bytes_of.values() if one.dtype == np.int8 and one.ndim > 1]
        got = [layer.weight for layer in deployed.network.layers if layer.weight.size > 0]
        self.assertEqual(len(got), 3)
        for weight in got:
            self.assertTrue(any(one.size == weight.size and (one.ravel() == weight.ravel()).all() for one in kept))
        for number in range(3):
            stored = deployed.pictures.one(number, deployed.scale)
            values = integers.run(deployed.network, stored)
            tensor = deployed.network.outputs[0]
            floats = deployed.float_model.run(deployed.pictures.real(stored, deployed.scale))
            scale = deployed.network.scales[tensor]
            # onnxruntime rounds half to even and the chip rounds half up, so a byte of a layer may differ by one.
            error = np.abs(scale.real(values[tensor]).ravel() - floats[deployed.graph.outputs[0].name].ravel())
            self.assertLess(error.max(), 1.5 * scale.step)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
