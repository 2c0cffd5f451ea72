#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that the shipped sight network, deployed from ONNX, gives nearly the outputs of the firmware's own kernels, and flies a mission."""

import contextlib
import csv
import io
import json
import os
import pathlib
import subprocess
import sys
import unittest

import numpy as np
from networks import DeployCase

from mebots.deploy import contracts
from mebots.deploy.arithmetic import Scale
from mebots.deploy.command import main
from mebots.deploy.graph import Tensor
from mebots.deploy.layers import Network

ROOT = pathlib.Path(__file__).resolve().parents[2]


class OwnNetworks(DeployCase):
    def test_the_sight_network_gives_the_same_outputs_and_a_program(self):
        script = ROOT / "examples/networks/own_networks.py"
        subprocess.run([sys.executable, script, self.folder], check=True, capture_output=True)
        out = self.folder / "sight"
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            code = main([str(self.folder / "sight.onnx"), "--data", str(self.folder / "sight.npy"), "--out", str(out), "--vectors", "12", "--json", "--page", str(self.folder / "sight.html")])
        self.assertEqual(code, 0)
        content = json.loads(printed.getvalue())
        self.assertEqual(content, json.loads((out / "network.json").read_text()))
        flight = {"program": "sight.elf", "board": "ai_deck", "firmware": ["sight", "gap8_sight"], "outputs": ["yaw", "rise", "size", "visible"]}
        self.assertEqual(content["flight"], flight)
        self.assertTrue((out / "sight.elf").is_file())
        self.near_to_golden(out, content["outputs"]["outputs"])
        measured = content["measured"]
        self.assertAlmostEqual(sum(one["time"] for one in measured["layers"]), measured["total"]["time"], places=9)
        self.assertGreater(min(one["energy"] for one in measured["layers"]), 0)
        self.accounts_add_up(measured)
        self.assertIn("<title>Network sight on board ai_deck - MEbots</title>", (self.folder / "sight.html").read_text())
        self.flies(out)

    def accounts_add_up(self, measured):
        """Checks that the measured costs of each layer and of the whole network add up.

        The causes contain all cycles of cores that are awake; the cause "base" contains one cycle per instruction. The energy is the sum of
        its parts. Waiting for the DMA takes less than the whole time. The cycles of each cause in the network are the sum over its layers.
        """
        for one in (*measured["layers"], measured["total"]):
            self.assertEqual(one["causes"]["base"], one["instructions"])
            self.assertEqual(sum(one["causes"].values()), one["instructions"] + one["stalled"])
            self.assertEqual(sum(one["causes"].values()) + one["asleep"], measured["cores"] * one["cycles"])
            self.assertAlmostEqual(sum(one["parts"].values()), one["energy"], delta=1e-9 * measured["total"]["energy"])
            self.assertGreater(one["dma"], 0)
            self.assertLess(one["dma"], one["time"])
        for cause, cycles in measured["total"]["causes"].items():
            self.assertEqual(sum(one["causes"].get(cause, 0) for one in measured["layers"]), cycles, cause)
        settings = {(one["cores"], one["cluster_clock"]): one["time"] for one in measured["settings"]}
        self.assertEqual(len(settings), 12)  # 1, 2, 4 and 8 cores at three clocks
        for clock in {clock for _, clock in settings}:
            times = [settings[cores, clock] for cores in (1, 2, 4, 8)]
            self.assertEqual(times, sorted(times, reverse=True))
        self.assertEqual(settings[8, measured["cluster_clock"]], measured["total"]["time"])

    def flies(self, out):
        """Tests a deployed folder as the network of a mission. The results equal those with the folder's program as firmware, and all files
        of the folder are inputs of the mission."""
        network = self.run_mission(f"soc.network={out}")
        program = self.run_mission(f"soc.firmware={out / 'sight.elf'}")
        self.assertEqual((network / "results.csv").read_bytes(), (program / "results.csv").read_bytes())
        files = json.loads((network / "summary.json").read_text())["inputs"]["files"]
        listed = {one.relative_to(out).as_posix() for one in out.rglob("*") if one.is_file()}
        self.assertEqual(set(files), {f"soc.network {one}" for one in listed})
        refused = self.run_mission(f"soc.network={out}", "soc.firmware=gate", code=2)
        self.assertIn("replaces the network of firmware sight or gap8_sight, but the mission flies firmware gate", refused)

    def run_mission(self, *settings, code=0):
        """Runs 3.5 s of a mission, which contain some pictures. Returns the results folder, or the program's output if it fails."""
        results = self.folder / f"results {len(list(self.folder.iterdir()))}"
        mebots = pathlib.Path(os.environ["MEBOTS_BUILD"]) / "bin/mebots"
        words = [mebots, "run", ROOT / "configs/gate_hard.json", "--stop-time", "3.5", "--out", results, "--set", *settings]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return results if code == 0 else done.stdout + done.stderr

    def near_to_golden(self, out, scale):
        rows = list(csv.DictReader((ROOT / "examples/paper/training/sight_golden.csv").read_text().splitlines()))
        names = ("yaw", "rise", "size", "visible")
        golden = np.array([[int(row[name]) for name in names] for row in rows])
        bytes_of = [np.frombuffer((out / f"vectors/{i:03}.outputs").read_bytes(), np.uint8) for i in range(len(rows))]
        got = np.clip((np.array(bytes_of, dtype=float) - scale["zero"]) * scale["step"] * 127, -127, 127)
        # Few values are clipped, because twelve pictures determine the ranges. Two roundings in each of eight layers remain.
        self.assertLess(np.abs(got - golden).max(), 8)


class Contracts(unittest.TestCase):
    GREY = 1 / 255

    def network(self, *outputs, shape=(1, 168, 168), step=GREY):
        """Returns a network without layers. ``outputs`` are (name, number of values)."""
        picture = Tensor("picture", shape)
        tensors = [Tensor(name, (count,)) for name, count in outputs]
        return Network(picture, tensors, [], dict.fromkeys(tensors, Scale(1 / 127, 0)) | {picture: Scale(step, 0)})

    def fit(self, *outputs, **changes):
        return contracts.fit(self.network(*outputs, **changes), self.GREY)

    def test_one_output_gives_its_values_in_the_contracts_order(self):
        found = self.fit(("any", 4))
        self.assertEqual((found.contract.name, found.order), ("sight", (0, 1, 2, 3)))
        self.assertEqual(self.fit(("any", 1)).contract.name, "navigator")

    def test_several_outputs_count_by_their_names(self):
        found = self.fit(("visible", 1), ("yaw", 1), ("rise", 1), ("size", 1))
        self.assertEqual((found.contract.name, found.order), ("sight", (1, 2, 3, 0)))

    def test_what_does_not_fit_is_named(self):
        self.assertIn("its outputs are steer (1 value), collision (1 value)", self.fit(("steer", 1), ("collision", 1)))
        self.assertIn("its input has 168 x 168 pixels, rgb", self.fit(("any", 4), shape=(3, 168, 168)))
        self.assertIn("its input has 400 x 168 pixels, grey", self.fit(("any", 4), shape=(1, 168, 400)))
        self.assertIn("a step of its input is 0.003, but a grey level of the camera is 0.00392157", self.fit(("any", 4), step=0.003))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
