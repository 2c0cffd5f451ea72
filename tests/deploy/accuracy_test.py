#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the accuracy of deployed networks against float and labels, and inputs of other sizes."""

import contextlib
import io
import shutil
import sys
import unittest

import numpy as np
import onnx
from networks import DeployCase, Maker, objects

import mebots
from mebots.deploy.accuracy import Outputs, _against, _resampled, difference
from mebots.deploy.command import main
from mebots.deploy.deployed import Options
from mebots.deploy.judging import Judgement
from mebots.deploy.lowering import lower
from mebots.deploy.report import _shown_sizes
from mebots.deploy.sizes import reason


def pooled(shape=(1, 20, 24)):
    """Returns a network with three classes that accepts any input size."""
    maker = Maker(3, shape)
    hidden = maker.node("Relu", maker.conv("x", 1, 8, (3, 3), strides=[2, 2], pads=[1, 1, 1, 1]))
    flat = maker.node("Flatten", maker.node("GlobalAveragePool", hidden))
    maker.output(maker.node("Gemm", flat, maker.weights(3, 8), maker.weights(3), transB=1))
    return maker


class Accuracy(unittest.TestCase):
    def test_errors_and_intervals_are_those_of_known_values(self):
        errors = np.random.default_rng(2).normal(0, 0.3, (4000, 1))
        got = difference({"a": errors}, {"a": np.zeros((4000, 1))})["a"]
        self.assertAlmostEqual(got["error"], 0.3, delta=0.012)
        # The mean square of n normal values has the standard deviation s^2 sqrt(2/n), so its root has s / sqrt(2n).
        half = 1.96 * 0.3 / np.sqrt(2 * 4000)
        self.assertAlmostEqual(got["interval"][1] - got["interval"][0], 2 * half, delta=0.15 * half)
        self.assertEqual(_resampled(np.full(9, 4.0), np.full(9, 1.0)), (1.0, 1.0))  # 2 - 1

    def test_classes_are_counted_with_wilsons_interval(self):
        floats, integers = np.eye(4)[[0, 1, 2, 3, 0]], np.eye(4)[[0, 1, 2, 0, 1]]
        got = _against("class", Outputs({"a": floats}, {"a": integers}), np.array([0, 1, 2, 3, 1]))
        self.assertEqual((got["float"]["share"], got["int8"]["share"], got["loss"]["share"]), (0.8, 0.8, 0.0))  # one lost, one gained
        # Wilson's interval of 4 of 5: Brown, Cai and DasGupta (2001), equation 4.
        np.testing.assert_allclose(got["int8"]["interval"], [0.3755, 0.9638], atol=1e-4)
        self.assertLess(got["loss"]["interval"][0], -0.4)
        self.assertGreater(got["loss"]["interval"][1], 0.4)

    def test_labels_of_zero_and_one_have_the_threshold_one_half(self):
        values = np.array([[0.4], [0.6], [0.7]])
        got = _against("a", Outputs(None, {"a": values}), np.array([0, 1, 0]))
        self.assertAlmostEqual(got["int8"]["share"], 2 / 3)
        got = _against("a", Outputs(None, {"a": values}), np.array([0.4, 0.6, 1.0]))
        self.assertAlmostEqual(got["int8"]["error"], 0.3 / np.sqrt(3))


class Sizes(DeployCase):
    def setUp(self):
        super().setUp()
        self.data = self.folder / "data.npy"
        self.labels = self.folder / "labels.csv"
        np.save(self.data, np.random.default_rng(1).random((6, 1, 20, 24)).astype(np.float32))

    def judged(self, maker, **options):
        """Returns accuracy and sizes of a network as in network.json."""
        path = f"{self.folder}/./model.onnx"  # messages omit the "./"
        onnx.save(maker.model(), path)
        scratch = self.folder / "scratch"
        shutil.copytree(objects(), scratch, dirs_exist_ok=True)
        deployed = lower(path, self.data, Options(**options))
        return Judgement(path, self.data, deployed, Options(**options)).result(scratch)

    def refused(self, *options):
        path = self.folder / "model.onnx"
        onnx.save(pooled().model(), str(path))
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors):
            code = main([str(path), "--data", str(self.data), "--out", str(self.folder / "out"), "--no-measure", *options])
        self.assertEqual((code, (self.folder / "out").exists()), (2, False))
        return errors.getvalue()

    def test_each_size_is_checked_measured_and_judged(self):
        self.labels.write_text("picture,class\n0,2\n3,0\n5,1\n")
        content = self.judged(pooled(), sizes=((10, 12),), labels=str(self.labels))
        (row,) = content["sizes"]["rows"]
        self.assertEqual((row["rows"], row["columns"], row["macs"]), (10, 12, 5 * 6 * 8 * 9 + 24))
        self.assertEqual(row["accuracy"]["pictures"], 3)
        self.assertEqual(set(row["accuracy"]["labels"]["outputs"]["class"]), {"float", "int8", "loss"})
        for part in (content["accuracy"]["float"], row["accuracy"]["float"]):
            (one,) = part.values()
            self.assertLess(one["error"], 0.02 * one["deviation"])
        energies = {(one["cores"], one["cluster_clock"]): one["energy"] for one in row["settings"]}
        self.assertEqual(len(energies), 12)
        for clock in {clock for _, clock in energies}:
            self.assertLess(energies[8, clock], energies[1, clock])

    def test_a_network_with_one_size_says_why(self):
        maker = Maker(1, (1, 20, 24))
        maker.output(maker.node("Gemm", maker.node("Flatten", maker.conv("x", 1, 2, (3, 3))), maker.weights(3, 2 * 18 * 22), transB=1))
        why = self.judged(maker)["sizes"]["none"]
        self.assertIn("with an input of 18 x 15, the model is not a valid ONNX model", why)
        self.assertIn("Gemm2", why)
        self.assertIn("The size can change if the network ends in convolutions", why)
        with self.assertRaisesRegex(mebots.InputError, "--sizes: with an input of 8 x 8"):
            self.judged(maker, sizes=((8, 8),))

    def test_a_size_that_fails_for_another_reason_has_no_hint_on_shapes(self):
        onnx.save(pooled().model(), str(self.folder / "model.onnx"))
        broken = self.folder / "broken.npy"
        np.save(broken, np.full((2, 1, 20, 24), np.nan, dtype=np.float32))
        with self.assertRaises(mebots.InputError) as raised:
            lower(self.folder / "model.onnx", broken, Options(), (10, 12))
        got = reason(raised.exception, (10, 12), self.folder / "model.onnx")
        self.assertEqual(got, f"with an input of 12 x 10, {broken}: has values that are not finite")

    def test_sizes_before_the_first_impossible_one_stay(self):
        maker = Maker(3, (1, 20, 24))
        flat = maker.node("Flatten", maker.node("GlobalAveragePool", maker.conv("x", 1, 4, (12, 12))))
        maker.output(maker.node("Gemm", flat, maker.weights(3, 4), maker.weights(3), transB=1))
        sizes = self.judged(maker)["sizes"]
        self.assertEqual([(row["rows"], row["columns"]) for row in sizes["rows"]], [(15, 18)])
        self.assertIn("with an input of 12 x 10, ", sizes["none"])
        self.assertIn("node Conv", sizes["none"])
        self.assertIn("its input is too small. Use a larger input", sizes["none"])
        self.assertNotIn("if the network ends in convolutions", sizes["none"])
        *_, last = _shown_sizes(sizes)
        self.assertIn("no smaller input: with an input of 12 x 10", last)

    def test_bad_sizes_and_labels_are_refused(self):
        self.assertIn("--sizes is '5'", self.refused("--sizes", "5"))
        self.assertIn("99 x 4 exceeds the network's input, 24 x 20", self.refused("--sizes", "99x4"))
        self.assertIn("--sizes needs the measurement on the chip", self.refused("--sizes", "12x10"))  # refused with --no-measure
        for text, expected in (
            ("", "labels.csv:1: the columns are none"),
            ("picture,t9\n0,1\n", "labels.csv:1: column t9 needs an output of this name with one value; the network's outputs are t4 (3 values)"),
            ("picture,class\n0\n", "labels.csv:2: has 1 values, the header 2"),
            ("picture,class\n6,0\n", "labels.csv:2: "),
            ("picture,class\n0,1\n0,1\n", "labels.csv:3: picture '0' has two rows"),
            ("picture,class\n0,3\n", "labels.csv:2: class is 3; a whole number from 0 to 2 is expected"),
            ("picture,class\n0,nan\n", "labels.csv:2: class is 'nan'"),
            ("picture,class\n", "has no rows"),
        ):
            self.labels.write_text(text)
            self.assertIn(expected, self.refused("--labels", str(self.labels)))
        self.assertIn("labels.csv: cannot be read", self.refused("--labels", str(self.folder / "none/labels.csv")))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
