#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests cross-layer equalisation by its closed form (Nagel et al. 2019, equation 9) and by onnxruntime."""

import sys
import unittest

import numpy as np
import onnxruntime
from networks import DeployCase, Maker

import mebots
from mebots.deploy import layers as integers
from mebots.deploy.deployed import Options
from mebots.deploy.equalise import equalise
from mebots.deploy.graph import Graph, Node, Tensor
from mebots.deploy.importer import import_graph
from mebots.deploy.lowering import lower
from mebots.deploy.model_file import Model
from mebots.deploy.simplify import simplify


def chain(seed=1):
    """Returns a float chain of a convolution, a pool, a depthwise convolution and a dense layer. The ranges of the first layer's channels
    are from 0.1 to 10.
    """
    random = np.random.default_rng(seed)
    spread = 10.0 ** random.uniform(-1, 1, (6, 1, 1, 1))
    tensors = [Tensor("x", (2, 8, 8)), Tensor("a", (6, 8, 8)), Tensor("b", (6, 4, 4)), Tensor("c", (6, 4, 4)), Tensor("y", (3,))]
    relu = (0.0, np.inf)
    nodes = [
        Node("conv", "one", "Conv", [tensors[0]], tensors[1], weight=spread * random.normal(size=(6, 2, 3, 3)), bias=random.normal(size=6), kernel=(3, 3), pads=(1,) * 4, limits=relu),
        Node("max_pool", "pool", "MaxPool", [tensors[1]], tensors[2], kernel=(2, 2), strides=(2, 2)),
        Node("conv", "two", "Conv", [tensors[2]], tensors[3], weight=random.normal(size=(6, 1, 3, 3)), bias=random.normal(size=6), kernel=(3, 3), pads=(1,) * 4, groups=6, limits=relu),
        Node("conv", "three", "Gemm", [tensors[3]], tensors[4], weight=random.normal(size=(3, 6, 4, 4)), bias=random.normal(size=3), kernel=(4, 4)),
    ]  # fmt: skip
    return Graph([tensors[0]], [tensors[4]], nodes)


def run(graph, values):
    """Computes a chain of convolutions, dense layers and maximum pools with onnxruntime."""
    maker = Maker(1, graph.inputs[0].shape)
    name = "x"
    for node in graph.nodes:
        if node.kind == "conv":
            weight, bias = maker.constant(node.weight.astype(np.float32)), maker.constant(node.bias.astype(np.float32))
            name = maker.node("Conv", name, weight, bias, group=node.groups, pads=list(node.pads), kernel_shape=list(node.kernel))
            name = maker.node("Relu", name) if node.is_limited() else name
        else:
            name = maker.node("MaxPool", name, kernel_shape=list(node.kernel), strides=list(node.strides))
    maker.output(name)
    return onnxruntime.InferenceSession(maker.model().SerializeToString(), providers=["CPUExecutionProvider"]).run(None, {"x": values})[0].ravel()


class Equalisation(DeployCase):
    def test_both_layers_get_the_geometric_mean_of_their_ranges(self):
        graph = chain()
        graph.nodes[2:] = []
        graph.nodes.append(Node("conv", "two", "Conv", [graph.nodes[1].output], Tensor("y", (4, 2, 2)), weight=np.random.default_rng(2).normal(size=(4, 6, 3, 3)), bias=np.zeros(4), kernel=(3, 3)))
        first, second = graph.nodes[0], graph.nodes[2]
        expected = np.sqrt(np.abs(first.weight).max(axis=(1, 2, 3)) * np.abs(second.weight).max(axis=(0, 2, 3)))
        before = first.weight
        divisors = equalise(graph, set())
        np.testing.assert_allclose(np.abs(first.weight).max(axis=(1, 2, 3)), expected, rtol=1e-12)
        np.testing.assert_allclose(np.abs(second.weight).max(axis=(0, 2, 3)), expected, rtol=1e-12)
        for name in "ab":
            np.testing.assert_allclose(before / divisors[name].reshape(-1, 1, 1, 1), first.weight, rtol=1e-12)

    def test_outputs_in_float_stay_within_rounding(self):
        values = np.random.default_rng(3).normal(size=(1, 2, 8, 8)).astype(np.float32)
        graph = chain()
        before = run(graph, values)
        divisors = equalise(graph, set())
        self.assertGreater(max(divisors["a"]) / min(divisors["a"]), 5)
        np.testing.assert_allclose(run(graph, values), before, rtol=1e-5, atol=1e-5 * np.abs(before).max())

    def test_channels_with_negligible_weights_keep_their_bias(self):
        graph = chain()
        graph.nodes[0].weight[2] *= 1e-30
        graph.nodes[2].weight[4] *= 1e-30
        biases = graph.nodes[0].bias.copy()
        equalise(graph, set())
        for channel in (2, 4):
            self.assertEqual(graph.nodes[0].bias[channel], biases[channel])

    def test_all_layers_that_use_a_tensor_are_changed(self):
        maker = Maker(5, (2, 8, 8))
        first = maker.conv("x", 2, 6, (3, 3), pads=[1] * 4)
        inner = maker.conv(maker.node("Relu", first), 6, 6, (3, 3), pads=[1] * 4)
        maker.output(maker.node("Add", inner, maker.conv(first, 6, 6, (1, 1))))
        path, data = maker.save(self.folder)
        graphs = [import_graph(Model(path)) for _ in range(2)]
        for graph in graphs:
            simplify(graph)
        self.assertEqual(set(equalise(graphs[1], set())), {"t0", "t1"})
        # Both other convolutions read the first one's output. For each channel, the product of the first and the second weight must stay
        # the same.
        (before, *users), (after, *changed) = ([one for one in graph.nodes if one.kind == "conv"] for graph in graphs)
        self.assertEqual(len(users), 2)
        for old, new in zip(users, changed, strict=True):
            products = [np.einsum("ic,oi->ico", a.weight[:, :, 1, 1], b.weight[:, :, 0, 0]) for a, b in ((before, old), (after, new))]
            np.testing.assert_allclose(products[1], products[0], rtol=1e-12)
            self.assertGreater(np.abs(new.weight / old.weight - 1).max(), 0.1)

    def test_relu6_several_users_and_fixed_tensors_are_left_alone(self):
        graph = chain()
        graph.nodes[0].limits = graph.nodes[2].limits = (0.0, 6.0)
        self.assertEqual(equalise(graph, set()), {})
        graph = chain()
        graph.nodes.append(Node("table", "side", "Tanh", [graph.nodes[1].output], Tensor("z", (6, 4, 4))))
        self.assertEqual(set(equalise(graph, set())), {"c"})
        self.assertEqual(set(equalise(chain(), {"b"})), {"c"})

    def test_integers_agree_better_with_float_if_channels_differ(self):
        maker = Maker(1, (2, 12, 12))
        spread = (10.0 ** np.random.default_rng(4).uniform(-1.5, 1.5, 8)).astype(np.float32)
        first = (maker.random.normal(size=(8, 2, 3, 3)) * spread.reshape(-1, 1, 1, 1)).astype(np.float32)
        second = (maker.random.normal(size=(4, 8, 3, 3)) / spread.reshape(1, -1, 1, 1)).astype(np.float32)
        hidden = maker.node("Relu", maker.node("Conv", "x", maker.constant(first), kernel_shape=[3, 3]))
        maker.output(maker.node("Conv", hidden, maker.constant(second), kernel_shape=[3, 3]))
        path, data = maker.save(self.folder)
        errors = []
        for option in (False, True):
            deployed = lower(path, data, Options(equalise=option))
            stored = deployed.pictures.one(0, deployed.scale)
            output = deployed.network.outputs[0]
            got = deployed.network.scales[output].real(output.view(integers.run(deployed.network, stored)[output]))
            floats = deployed.float_model.run(deployed.pictures.real(stored, deployed.scale))[output.name]
            errors.append(np.sqrt(np.mean((got - floats[0]) ** 2)))
        self.assertLess(errors[1], errors[0] / 3)

    def test_a_model_without_equalised_layers_is_refused(self):
        maker = Maker(1, (2, 6, 6))
        hidden = maker.node("Clip", maker.conv("x", 2, 4, (3, 3)), maker.constant(np.float32(0)), maker.constant(np.float32(6)))
        maker.output(maker.conv(hidden, 4, 4, (3, 3)))
        with self.assertRaisesRegex(mebots.InputError, "no two layers can be equalised"):
            lower(*maker.save(self.folder), Options(equalise=True))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
