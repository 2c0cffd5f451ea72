#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes PULP-DroNet v1 as ONNX, from the 16-bit weights that its repository publishes.

WEIGHTS is pulp-dronet-v1/weights/binary of a checkout of github.com/pulp-platform/pulp-dronet. The layers and the fractional bits
of their weights are those of its src/config.h. The input is in grey levels: deploy it with --input-scale 1.

Usage: dronet_v1.py WEIGHTS OUT.onnx"""

import argparse
import pathlib

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

SAME, HALF = (1, 1), (1, 0)  # padding at the begin and at the end of rows and columns


class Writer:
    def __init__(self, folder):
        self.folder = folder
        self.nodes = []
        self.constants = []

    def read(self, name, shape, digits):
        """Reads 16-bit integers from a file, divides them by 2 to the power of ``digits``, and adds them as a constant. Returns
        the constant's name."""
        values = np.fromfile(self.folder / f"{name}.hex", "<i2").reshape(shape) * 2.0**-digits
        self.constants.append(numpy_helper.from_array(values.astype(np.float32), name))
        return name

    def node(self, op, *inputs, **attributes):
        name = attributes.pop("output", f"{op.lower()}{len(self.nodes)}")
        self.nodes.append(helper.make_node(op, inputs, [name], name=name, **attributes))
        return name

    def conv(self, source, number, shape, stride, digits, pads):
        weight = self.read(f"weights_conv2d_{number}", shape, digits)
        bias = self.read(f"bias_conv2d_{number}", shape[:1], 0)
        return self.node("Conv", source, weight, bias, output=f"conv{number}", kernel_shape=shape[2:], strides=[stride] * 2, pads=[pads[0]] * 2 + [pads[1]] * 2)

    def block(self, source, first, before, channels, pads, digits):
        """Adds a residual block of three convolutions. ``first`` is the number of the first convolution."""
        inner = self.node("Relu", self.conv(self.node("Relu", source), first, (channels, before, 3, 3), 2, 14, pads))
        inner = self.conv(inner, first + 1, (channels, channels, 3, 3), 1, 14, SAME)
        return self.node("Add", inner, self.conv(source, first + 2, (channels, before, 1, 1), 2, digits, (0, 0)))

    def dense(self, source, number, name):
        # The inputs are integers. The weights have 22 fractional bits; the bias and the output have 11.
        weight = self.read(f"weights_dense_{number}", (1, 128 * 7 * 7), 22)
        return self.node("Gemm", source, weight, self.read(f"bias_dense_{number}", (1,), 11), output=name, transB=1)

    def network(self):
        first = self.node("MaxPool", self.conv("picture", 1, (32, 1, 5, 5), 2, 9, (2, 1)), kernel_shape=[2, 2], strides=[2, 2])
        second = self.block(first, 2, 32, 32, HALF, 7)
        third = self.block(second, 5, 32, 64, SAME, 14)
        last = self.node("Flatten", self.node("Relu", self.block(third, 8, 64, 128, SAME, 12)))
        self.dense(last, 1, "steering")
        self.node("Sigmoid", self.dense(last, 2, "logit"), output="collision")
        outputs = [helper.make_tensor_value_info(name, TensorProto.FLOAT, [1, 1]) for name in ("steering", "collision")]
        picture = helper.make_tensor_value_info("picture", TensorProto.FLOAT, [1, 1, 200, 200])
        graph = helper.make_graph(self.nodes, "pulp_dronet_v1", [picture], outputs, self.constants)
        return helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("weights", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    given = parser.parse_args()
    model = Writer(given.weights).network()
    onnx.checker.check_model(model)
    onnx.save(model, given.out)


if __name__ == "__main__":
    main()
