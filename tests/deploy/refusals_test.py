#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that `mebots deploy` refuses unusable input. The message names the cause, the exit code is 2, and no folder is created."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

import numpy as np
import onnx
from networks import DeployCase, Maker
from onnx import TensorProto, helper
from PIL import Image

from mebots.deploy.command import main


def small(seed=1):
    maker = Maker(seed, (1, 8, 8))
    maker.output(maker.node("Relu", maker.conv("x", 1, 4, (3, 3))))
    return maker


class RefusalCase(DeployCase):
    def setUp(self):
        super().setUp()
        self.data = self.folder / "data.npy"
        np.save(self.data, np.zeros((2, 1, 8, 8), dtype=np.float32) + 0.5)

    def refuse(self, model, *expected, data=None, options=(), name="model.onnx"):
        """Checks that a model is refused. ``model`` is a model or the bytes of a file."""
        path = self.folder / name
        path.write_bytes(model if isinstance(model, bytes) else model.SerializeToString())
        before = {one.name for one in self.folder.iterdir()}
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors):
            code = main([str(path), "--data", str(data or self.data), "--out", str(self.folder / "out"), "--no-measure", *options])
        text = errors.getvalue()
        self.assertEqual(code, 2, text)
        for one in expected:
            self.assertIn(one, text)
        self.assertEqual({one.name for one in self.folder.iterdir()}, before)
        return text

    def refuse_node(self, op, inputs, *expected, shape=(1, 8, 8), **attributes):
        maker = Maker(1, shape)
        np.save(self.data, np.zeros((2, *shape), dtype=np.float32))
        maker.output(maker.node(op, *[maker.constant(one) if isinstance(one, np.ndarray) else one for one in inputs], **attributes))
        self.refuse(maker.model(), f"node {op}0 ({op})", *expected)


class Models(RefusalCase):
    def test_empty_short_and_cut_files(self):
        whole = small().model().SerializeToString()
        self.refuse(b"", "is empty")
        self.refuse(b"\x08", "not")
        for cut in (len(whole) // 2, len(whole) - 3):
            self.refuse(whole[:cut], "not")
        self.refuse(bytes(range(256)), "not")

    def test_flipped_bytes_end_with_a_refusal_or_a_folder(self):
        whole = small().model().SerializeToString()
        random = np.random.default_rng(1)
        for _ in range(40):
            broken = bytearray(whole)
            for place in random.integers(0, len(whole), 3):
                broken[place] = int(random.integers(0, 256))
            path = self.folder / "model.onnx"
            path.write_bytes(bytes(broken))
            with tempfile.TemporaryDirectory() as out, contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
                code = main([str(path), "--data", str(self.data), "--out", f"{out}/out", "--no-measure"])
                self.assertIn(code, (0, 2))
                self.assertEqual([one.name for one in pathlib.Path(out).iterdir()], ["out"] if code == 0 else [])

    def test_cyclic_graphs_and_missing_initialisers(self):
        model = small().model()
        model.graph.node[0].input[0] = model.graph.node[1].output[0]
        self.refuse(model, "is not a valid ONNX model", model.graph.node[1].output[0])
        model = small().model()
        name = model.graph.initializer[0].name
        del model.graph.initializer[0]
        self.refuse(model, name)

    def test_weights_that_are_not_finite(self):
        model = small().model()
        weights = onnx.numpy_helper.to_array(model.graph.initializer[0]).copy()
        weights[2, 0, 1, 1] = np.nan
        model.graph.initializer[0].CopyFrom(onnx.numpy_helper.from_array(weights, "constant0"))
        self.refuse(model, "constant constant0 is nan at [2, 0, 1, 1]")

    def test_unknown_data_types(self):
        model = small().model()
        model.graph.initializer[0].data_type = 35
        self.refuse(model, "constant0")

    def test_weights_that_cancel_each_other(self):
        maker = Maker(1, (2, 4, 4))
        maker.output(maker.node("Conv", "x", maker.constant(np.array([1e10, -1e10], dtype=np.float32).reshape(1, 2, 1, 1)), kernel_shape=[1, 1]))
        np.save(self.data, np.repeat(np.random.default_rng(1).random((2, 1, 4, 4)).astype(np.float32), 2, axis=1))
        self.refuse(maker.model(), "node Conv0 (Conv): the sums of a layer do not fit into 32 bits", "other pictures")

    def test_opsets_and_shapes(self):
        for opset in (8, 23):
            model = small().model()
            model.opset_import[0].version = opset
            self.refuse(model, f"has opset {opset}", "opset_version=17")
        model = small().model()
        model.graph.input[0].type.tensor_type.shape.dim[2].dim_param = "height"
        self.refuse(model, "dimension 2 of input x is height", "make_dynamic_shape_fixed")
        maker = Maker(1, (1, 8, 8))
        maker.output(maker.conv("x", 1, 4, (9, 9)))
        self.refuse(maker.model(), "node Conv0 (Conv) has an output of shape [1, 4, 0, 0]: its input is too small")
        huge = helper.make_tensor_value_info("x", TensorProto.FLOAT, [1, 1, 1 << 40, 1 << 40])
        model = small().model()
        model.graph.input[0].CopyFrom(huge)
        del model.graph.value_info[:]
        model.graph.output[0].CopyFrom(helper.make_tensor_value_info(model.graph.output[0].name, TensorProto.FLOAT, [None] * 4))
        self.refuse(model, str(1 << 40))

    def test_constants_beyond_memory(self):
        maker = Maker(1, (1, 8, 8))
        shape = maker.constant(np.array([1 << 40, 1, 8, 8], dtype=np.int64))
        big = maker.node("ConstantOfShape", shape)
        model = maker.model()
        model.graph.node.append(helper.make_node("Add", ["x", big], ["y"], name="sum"))
        model.graph.output.append(helper.make_tensor_value_info("y", TensorProto.FLOAT, [None] * 4))
        self.refuse(model, "ConstantOfShape0", str(1 << 46))

    def test_attributes_that_do_not_fit(self):
        maker = Maker(1, (1, 8, 8))
        maker.output(maker.node("ConvTranspose", "x", maker.weights(1, 2, 3, 3), strides=[1 << 31, 3], kernel_shape=[3, 3]))
        self.refuse(maker.model(), "ConvTranspose0")
        maker = Maker(1, (1, 8, 8))
        maker.output(maker.node("Gather", "x", maker.constant(np.array([1 << 31, 3], dtype=np.int64)), axis=2))
        self.refuse(maker.model(), "Gather0")
        maker = Maker(1, (1, 8, 8))
        maker.output(maker.node("Conv", "x", maker.weights(2, 1, 3, 3), kernel_shape=[2, 3]))
        self.refuse(maker.model(), "Conv0")

    def test_operators_and_attributes_that_are_not_supported(self):
        self.refuse_node("LpNormalization", ["x"], "not supported", "Supported are", axis=1)
        self.refuse_node("MaxPool", ["x"], "ceil_mode", kernel_shape=[3, 3], strides=[2, 2], ceil_mode=1)
        self.refuse_node("MatMul", ["x", "x"], "two tensors")
        self.refuse_node("Add", ["x", np.zeros((8, 1), dtype=np.float32)], "shape [8, 1]")
        self.refuse_node("Pad", ["x", np.array([0, 0, 1, 1, 0, 0, 1, 1], dtype=np.int64)], "reflect", mode="reflect")

    def test_networks_that_exceed_a_memory_name_a_layer(self):
        maker = Maker(1, (1, 64, 64))
        maker.output(maker.conv(maker.conv("x", 1, 128, (3, 3), pads=[1, 1, 1, 1]), 128, 8, (1, 1)))
        np.save(self.data, np.zeros((2, 1, 64, 64), dtype=np.float32) + 0.5)
        for board in ("ai_deck", "gap8"):  # gap8 uses HyperRAM only for weights
            text = self.refuse(maker.model(), "does not fit into L2", "activations", "layer Conv", "524288 are available", options=["--board", board])
            self.assertNotIn("or board gap8", text)
        maker = Maker(1, (512, 2, 64))
        np.save(self.data, np.zeros((2, 512, 2, 64), dtype=np.float32) + 0.5)
        maker.output(maker.conv("x", 512, 4, (1, 1)))
        self.refuse(maker.model(), "layer Conv0", "does not fit into L1", "are available")


class Data(RefusalCase):
    def picture(self, size, name="a.png"):
        folder = self.folder / "pictures"
        folder.mkdir(exist_ok=True)
        Image.fromarray(np.zeros(size, dtype=np.uint8)).save(folder / name)
        return folder

    def test_pictures_of_another_size(self):
        self.refuse(small().model(), "a.png", "9 x 8 pixels", "8 x 8", "--crop", data=self.picture((8, 9)))
        self.refuse(small().model(), "exceeds", data=self.picture((8, 9)), options=["--crop", "2,0"])

    def test_folders_without_pictures_and_broken_pictures(self):
        empty = self.folder / "empty"
        empty.mkdir()
        self.refuse(small().model(), "has no pictures", data=empty)
        folder = self.picture((8, 8))
        (folder / "b.pgm").write_bytes(b"P5 8 8 255\n123")
        self.refuse(small().model(), "b.pgm", data=folder)

    def test_vectors_of_another_shape_and_not_finite(self):
        np.save(self.data, np.zeros((2, 9), dtype=np.float32))
        self.refuse(small().model(), "[2, 9]", "[number, 1, 8, 8]")
        np.save(self.data, np.full((2, 1, 8, 8), np.inf, dtype=np.float32))
        self.refuse(small().model(), "not finite")

    def test_options(self):
        model = small().model()
        self.refuse(model, "--percentile is 20", options=["--percentile", "20"])
        self.refuse(model, "LEFT,TOP", options=["--crop", "five"])
        self.refuse(model, "nosuch", "ai_deck", options=["--board", "nosuch"])

    def test_a_page_that_cannot_be_written_or_lies_in_the_networks_folder(self):
        model = small().model()
        self.refuse(model, "outside of", options=["--page", str(self.folder / "out/network.html")])
        self.refuse(model, "nowhere does not exist", options=["--page", str(self.folder / "nowhere/network.html")])
        self.refuse(model, "this is a folder", options=["--page", str(self.folder)])

    def test_a_folder_that_exists_stays(self):
        out = self.folder / "out"
        out.mkdir()
        self.refuse(small().model(), "exists already")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
