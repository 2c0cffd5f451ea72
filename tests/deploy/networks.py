# SPDX-License-Identifier: Apache-2.0
"""Writes small ONNX networks with random weights for the tests."""

import hashlib
import os
import pathlib
import tempfile
import unittest

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

from mebots.deploy import chip


class Maker:
    """Collects the nodes of a network. Each method for an operator returns the name of the node's output."""

    def __init__(self, seed, shape, opset=17):
        self.random = np.random.default_rng(seed)
        self.opset = opset
        self.nodes = []
        self.constants = []
        self.outputs = []
        self.shape = shape

    def constant(self, values, name=None):
        name = name or f"constant{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(np.asarray(values), name))
        return name

    def weights(self, *shape):
        fan = max(int(np.prod(shape[1:])), 1)
        return self.constant((self.random.standard_normal(shape) / np.sqrt(fan)).astype(np.float32))

    def node(self, op, *inputs, **attributes):
        name = f"{op}{len(self.nodes)}"
        self.nodes.append(helper.make_node(op, inputs, [f"t{len(self.nodes)}"], name=name, **attributes))
        return f"t{len(self.nodes) - 1}"

    def conv(self, source, channels, out, kernel, groups=1, **attributes):
        weight = self.weights(out, channels // groups, *kernel)
        bias = self.constant((0.2 * self.random.standard_normal(out)).astype(np.float32))
        return self.node("Conv", source, weight, bias, group=groups, kernel_shape=list(kernel), **attributes)

    def output(self, *names):
        self.outputs += names

    def model(self):
        graph = helper.make_graph(
            self.nodes,
            "made",
            [helper.make_tensor_value_info("x", TensorProto.FLOAT, [1, *self.shape])],
            [helper.make_empty_tensor_value_info(name) for name in self.outputs],
            self.constants,
        )
        model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", self.opset)])
        model.ir_version = 8
        model = onnx.shape_inference.infer_shapes(model)
        types = {one.name: one for one in [*model.graph.value_info, *model.graph.output]}
        outputs = [types[name] for name in self.outputs]
        del model.graph.output[:]
        model.graph.output.extend(outputs)
        return model

    def save(self, folder):
        path = pathlib.Path(folder) / "model.onnx"
        onnx.save(self.model(), str(path))
        np.save(path.with_name("data.npy"), self.random.random((8, *self.shape)).astype(np.float32) * 2 - 0.7)
        return path, path.with_name("data.npy")


def objects(board="ai_deck"):
    """Returns a folder for the kernels' object files for a board, which all tests of a build share."""
    content = hashlib.sha256(pathlib.Path(chip.__file__).read_bytes())
    content.update(board.encode())
    for folder in ("kernels", "runtime", "gap8/runtime"):
        for file in sorted((chip.data_folder() / "fmu_soc/firmware" / folder).iterdir()):
            content.update(file.read_bytes())
    place = pathlib.Path(os.environ.get("MEBOTS_BUILD", tempfile.gettempdir())) / "tests/deploy/objects" / content.hexdigest()[:16]
    place.mkdir(parents=True, exist_ok=True)
    return place


class DeployCase(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
