#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The shipped sight network as ONNX, deployed: near the outputs of the firmware's own kernels, in a program that flies."""

import contextlib
import csv
import io
import json
import pathlib
import subprocess
import sys
import unittest

import numpy as np
from networks import DeployCase

from mebots.deploy.command import main

ROOT = pathlib.Path(__file__).resolve().parents[2]


class OwnNetworks(DeployCase):
    def test_the_sight_network_gives_the_same_outputs_and_a_program(self):
        script = ROOT / "examples/networks/own_networks.py"
        subprocess.run([sys.executable, script, self.folder], check=True, capture_output=True)
        out = self.folder / "sight"
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            code = main([str(self.folder / "sight.onnx"), "--data", str(self.folder / "sight.npy"), "--out", str(out), "--vectors", "12", "--json"])
        self.assertEqual(code, 0)
        content = json.loads(printed.getvalue())
        self.assertEqual(content, json.loads((out / "network.json").read_text()))
        self.assertEqual(content["flight"], {"program": "sight.elf"})
        self.assertTrue((out / "sight.elf").is_file())
        self.near_to_golden(out, content["outputs"]["outputs"])
        measured = content["measured"]
        self.assertAlmostEqual(sum(one["time"] for one in measured["layers"]), measured["total"]["time"], places=9)
        self.assertGreater(min(one["energy"] for one in measured["layers"]), 0)

    def near_to_golden(self, out, scale):
        rows = list(csv.DictReader((ROOT / "examples/paper/training/sight_golden.csv").read_text().splitlines()))
        names = ("yaw", "rise", "size", "visible")
        golden = np.array([[int(row[name]) for name in names] for row in rows])
        bytes_of = [np.frombuffer((out / f"vectors/{i:03}.outputs").read_bytes(), np.uint8) for i in range(len(rows))]
        got = np.clip((np.array(bytes_of, dtype=float) - scale["zero"]) * scale["step"] * 127, -127, 127)
        # The ranges of twelve pictures clip few values; two roundings of eight layers remain.
        self.assertLess(np.abs(got - golden).max(), 8)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
