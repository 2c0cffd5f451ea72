#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests each operator with random shapes. NumPy, C on this machine, and C on the chip with one and eight cores must give the same bytes,
close to the float results of onnxruntime."""

import sys

import numpy as np
from networks import DeployCase, Maker, objects

from mebots.deploy import checking
from mebots.deploy import layers as integers
from mebots.deploy.deployed import Options
from mebots.deploy.lowering import lower
from mebots.deploy.plan import gathers, has_outer_columns, is_dense, is_depthwise_3x3


def pair(random, low, high):
    return [int(one) for one in random.integers(low, high + 1, 2)]


class OperatorCase(DeployCase):
    def check(self, maker, steps=2.5, board="ai_deck"):
        """Deploys the network and compares all outputs. Floats may differ by ``steps`` steps of the output's scale."""
        model, data = maker.save(self.folder)
        deployed = lower(model, data, Options(board=board))
        library = self.folder / "library"
        deployed.sources.write(library)
        checking.check(library, self.folder, deployed, True, objects(board))
        self.near_to_float(deployed, steps)
        return deployed

    def near_to_float(self, deployed, steps):
        for number in range(3):
            stored = deployed.pictures.one(number, deployed.scale)
            values = integers.run(deployed.network, stored)
            floats = deployed.float_model.run(deployed.pictures.real(stored, deployed.scale))
            for tensor, named in zip(deployed.network.outputs, deployed.graph.outputs, strict=True):
                scales = deployed.network.scales
                got = named.view(scales[tensor].real(values[tensor]).ravel())
                layer = next(one for one in deployed.network.layers if one.output is tensor)
                # A layer of kind "table" also rounds its input, so its error may be as large as the step of the input.
                step = max(scales[one].step for one in (tensor, *(layer.inputs if layer.kind == "table" else ())))
                error = np.abs(got - floats[named.name].reshape(got.shape)).max() / step
                self.assertLess(error, steps, f"{named.name} of {layer.op}")


class Convolutions(OperatorCase):
    def test_random_kernels_strides_pads_groups_and_dilations(self):
        for seed in (1, 2):
            maker = Maker(seed, (8, 17, 15))
            random = maker.random
            for groups in (1, 1, 2, 4, 8):
                kernel = pair(random, 1, 5)
                pads = [int(one) for one in random.integers(0, 3, 4)]
                out = groups * int(random.integers(1, 7))
                dilations = pair(random, 1, 2)
                maker.output(maker.conv("x", 8, out, kernel, groups, pads=pads, strides=pair(random, 1, 3), dilations=dilations))
            self.check(maker)

    def test_channels_by_themselves(self):
        maker = Maker(10, (6, 14, 11))
        for kernel, strides, dilations in (((3, 3), [1, 1], [1, 1]), ((5, 2), [2, 1], [1, 1]), ((3, 3), [1, 2], [2, 2])):
            maker.output(maker.conv("x", 6, 6, kernel, 6, pads=[1, 2, 0, 1], strides=strides, dilations=dilations))
        self.check(maker)
        maker = Maker(11, (128, 16, 30))
        maker.output(maker.conv("x", 128, 128, (3, 3), 128, pads=[1, 1, 1, 1]))
        deployed = self.check(maker)
        self.assertGreater(len(deployed.plan.steps[0].parts), 1)

    def test_depthwise_kernels_of_3x3_give_the_references_integers_with_each_number_of_cores(self):
        maker = Maker(12, (7, 13, 10))
        plain = [1, 1]
        geometries = ((plain, plain, [1] * 4), ([2, 1], [2, 1], [0, 2, 1, 0]), ([3, 2], plain, [2, 0, 0, 1]), ([1, 3], plain, [0, 1, 2, 2]))
        for strides, dilations, pads in geometries:
            maker.output(maker.conv("x", 7, 7, (3, 3), 7, pads=pads, strides=strides, dilations=dilations))
        deployed = self.check_with_each_number_of_cores(maker)
        self.assertTrue(all(is_depthwise_3x3(one) for one in deployed.network.layers))
        self.near_to_float(deployed, 2.5)

    def check_with_each_number_of_cores(self, maker):
        deployed = lower(*maker.save(self.folder), Options())
        library = self.folder / "library"
        deployed.sources.write(library)
        program = checking.check(library, self.folder, deployed, True, objects())
        values = integers.run(deployed.network, program.picture)
        for cores in range(2, 8):
            checking.compare(deployed.network, values, program.check(cores), f"{cores} cores")
        return deployed

    def test_dense_layers_give_the_references_integers_with_each_number_of_cores(self):
        # The layers have one group of four channels for all cores, groups that end within a core's part of the products, and fewer words than cores.
        for inputs, sizes in ((517, (3, 4, 64, 37)), (9, (70, 5))):
            maker = Maker(18, (inputs, 1, 1))
            name, before = "x", inputs
            for out in sizes:
                name, before = maker.conv(name, before, out, (1, 1)), out
                maker.output(name)
            deployed = self.check_with_each_number_of_cores(maker)
            self.assertTrue(all(is_dense(one) for one in deployed.network.layers))

    def test_a_layer_that_fills_l1_leaves_room_for_the_stacks(self):
        for board in ("ai_deck", "gap8"):
            maker = Maker(1, (56, 16, 25))
            maker.output(maker.conv("x", 56, 40, (3, 3), pads=[1] * 4))
            deployed = self.check(maker, board=board)
            if board == "ai_deck":
                self.assertEqual(deployed.plan.l1_bytes, (64 - 8) << 10)

    def test_patches_with_few_channels_at_the_sides_of_the_input(self):
        maker = Maker(16, (3, 10, 9))
        geometries = ((9, (3, 2), [1, 1], [1, 1, 2, 1]), (8, (2, 5), [2, 2], [0, 4, 1, 3]), (13, (3, 1), [1, 3], [2, 0, 0, 2]))
        for out, kernel, strides, pads in geometries:
            first, second = (maker.conv("x", 3, out, kernel, pads=pads, strides=strides) for _ in range(2))
            maker.output(first, maker.node("MaxPool", second, kernel_shape=[2, 2], strides=[2, 2]))
        deployed = self.check(maker, steps=4)
        self.assertGreater(sum(gathers(one) and not has_outer_columns(one) for one in deployed.network.layers), 1)
        # A pool of 3 that omits columns, and a pool of 2 with only its first column inside the input.
        for shape, pads, pool in (((3, 7, 11), [1, 1, 1, 1], 3), ((3, 6, 3), [0, 0, 1, 1], 2)):
            maker = Maker(17, shape)
            convolved = maker.conv("x", 3, 16, (3, 3), pads=pads)
            maker.output(maker.node("MaxPool", convolved, kernel_shape=[pool, pool], strides=[pool, pool]))
            self.check(maker, steps=4)

    def test_transposed_convolutions(self):
        maker = Maker(12, (6, 5, 7))
        for groups, out, kernel, more in (
            (1, 5, (3, 3), {"strides": [2, 2], "pads": [1, 1, 1, 1], "output_padding": [1, 1]}),
            (2, 2, (2, 4), {"strides": [3, 1], "pads": [0, 1, 1, 2]}),
            (1, 4, (3, 2), {"dilations": [1, 2]}),
        ):
            weight = maker.weights(6, out, *kernel)
            maker.output(maker.node("ConvTranspose", "x", weight, maker.weights(out * groups), group=groups, kernel_shape=list(kernel), **more))
        self.check(maker)

    def test_channels_that_are_no_multiples_of_four(self):
        maker = Maker(3, (3, 12, 13))
        first = maker.node("Relu", maker.conv("x", 3, 7, (3, 3), pads=[1, 1, 1, 1]))
        second = maker.conv(first, 7, 5, (1, 1))
        maker.output(first, second, maker.conv(second, 5, 9, (3, 2), strides=[2, 1]))
        self.check(maker, steps=4)

    def test_layers_that_need_several_tiles_and_parts(self):
        maker = Maker(4, (16, 40, 40))
        wide = maker.node("Relu", maker.conv("x", 16, 96, (3, 3), pads=[1, 1, 1, 1], strides=[2, 2]))
        deep = maker.conv(wide, 96, 128, (3, 3), pads=[1, 1, 1, 1], strides=[2, 2])
        maker.output(deep, maker.node("GlobalAveragePool", wide), maker.node("MaxPool", wide, kernel_shape=[3, 3], strides=[2, 2], pads=[1, 1, 1, 1]))
        deployed = self.check(maker, steps=4)
        self.assertGreater(max(len(one.parts) for one in deployed.plan.steps), 1)
        self.assertGreater(max(one.tiles for one in deployed.plan.steps), 1)

    def test_normalisation_limits_and_pools_join_the_convolution(self):
        maker = Maker(5, (4, 16, 16))
        padded = maker.node("Pad", "x", maker.constant(np.array([0, 0, 1, 2, 0, 0, 2, 1], dtype=np.int64)))
        conv = maker.conv(padded, 4, 8, (3, 3))
        numbers = [maker.constant((0.5 + maker.random.random(8)).astype(np.float32)) for _ in range(4)]
        pooled = maker.node("MaxPool", maker.node("BatchNormalization", conv, *numbers), kernel_shape=[2, 2], strides=[2, 2])
        maker.output(maker.node("Relu", pooled))
        deployed = self.check(maker)
        self.assertEqual([layer.kind for layer in deployed.network.layers], ["convolution"])

    def test_pools_of_several_sizes_after_long_and_short_runs(self):
        maker = Maker(13, (16, 14, 13))
        for pool, channels, kernel in ((2, 7, (3, 3)), (3, 8, (3, 3)), (2, 4, (1, 1))):
            conv = maker.conv("x", 16, channels, kernel)
            maker.output(maker.node("MaxPool", conv, kernel_shape=[pool, pool], strides=[pool, pool]))
        deployed = self.check(maker)
        self.assertEqual([layer.pool for layer in deployed.network.layers], [2, 3, 2])


class Others(OperatorCase):
    def test_dense_layers_and_flattened_tensors(self):
        maker = Maker(6, (5, 6, 7))
        flat = maker.node("Flatten", "x")
        first = maker.node("Relu", maker.node("Gemm", flat, maker.weights(30, 210), maker.weights(30), transB=1))
        second = maker.node("MatMul", first, maker.weights(30, 10))
        maker.output(second, maker.node("Softmax", second, axis=1), maker.node("Add", flat, flat))
        self.check(maker, steps=4)

    def test_arithmetic_and_functions(self):
        maker = Maker(7, (6, 9, 5))
        other = maker.conv("x", 6, 6, (1, 1))
        for op in ("Add", "Mul"):
            maker.output(maker.node(op, "x", other))
        for op in ("LeakyRelu", "Sigmoid", "HardSwish", "HardSigmoid", "Tanh", "Elu"):
            maker.output(maker.node(op, "x"))
        maker.output(maker.node("Clip", other, maker.constant(np.float32(0)), maker.constant(np.float32(0.5))))
        maker.output(maker.node("Mul", other, maker.constant(maker.random.random((6, 1, 1)).astype(np.float32))))
        self.check(maker)

    def test_board_with_gap8s_own_devices(self):
        maker = Maker(14, (6, 12, 12))
        conv = maker.node("Relu", maker.conv("x", 6, 8, (3, 3), pads=[1, 1, 1, 1]))
        maker.output(maker.node("Add", conv, maker.conv(conv, 8, 8, (3, 3), 8, pads=[1, 1, 1, 1])))
        self.check(maker, steps=4, board="gap8")

    def test_pools(self):
        maker = Maker(8, (6, 11, 13))
        random = maker.random
        for kind in ("MaxPool", "AveragePool", "AveragePool"):
            kernel = pair(random, 2, 4)
            pads = [min(int(random.integers(0, 2)), one - 1) for one in (*kernel, *kernel)]
            more = {"count_include_pad": int(random.integers(0, 2))} if kind == "AveragePool" else {}
            maker.output(maker.node(kind, "x", kernel_shape=kernel, strides=pair(random, 1, 3), pads=pads, **more))
        maker.output(maker.node("GlobalAveragePool", "x"), maker.node("GlobalMaxPool", "x"))
        self.check(maker)

    def test_moves(self):
        maker = Maker(9, (4, 6, 10))
        other = maker.conv("x", 4, 3, (1, 1))

        def numbers(*values):
            return maker.constant(np.array(values, dtype=np.int64))

        maker.output(
            maker.node("Concat", "x", other, axis=1),
            maker.node("Concat", "x", "x", axis=3),
            maker.node("Pad", "x", numbers(0, 1, 0, 2, 0, 0, 3, 0), maker.constant(np.float32(0.5))),
            maker.node("Transpose", "x", perm=[0, 2, 3, 1]),
            maker.node("Slice", "x", numbers(1, 9), numbers(4, -100), numbers(1, 3), numbers(2, -3)),
            maker.node("Reshape", "x", numbers(1, 8, 3, 10)),
            maker.node("Resize", "x", "", maker.constant(np.array([1, 1, 2, 3], dtype=np.float32)), mode="nearest", coordinate_transformation_mode="asymmetric", nearest_mode="floor"),
            maker.node("Gather", "x", numbers(1, 3), axis=1),
        )
        self.check(maker)


if __name__ == "__main__":
    import unittest

    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
