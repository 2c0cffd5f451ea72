#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a GAP8 program in configs/dronet.json, and compares its outputs with those expected for its pictures.

Usage: mission.py MEBOTS CONFIG FIRMWARE OUT [--dronet FOLDER] [--stop-time SECONDS]

FIRMWARE is brightness.elf, or with --dronet the ELF of PULP-Dronet v1. FOLDER is pulp-dronet-v1 of a checkout of
pulp-platform/pulp-dronet. The weights in this folder determine the expected outputs.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import numpy as np
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[3]
HALF_ROW = 162


def brightness(picture):
    halves = picture[:, :HALF_ROW], picture[:, HALF_ROW:]
    return tuple(int(half.astype(np.int64).sum()) >> 9 for half in halves)


def dronet(folder):
    sys.path.insert(0, str(ROOT / "tests/conformance/gap8"))
    from dronet_reference import Network
    network = Network(folder / "weights/binary")
    return lambda picture: tuple(network.infer(picture))


def call(command):
    return subprocess.run([str(part) for part in command], text=True, capture_output=True, check=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("mebots", "config", "firmware", "out"):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("--dronet", type=pathlib.Path)
    parser.add_argument("--stop-time", type=float, default=0.4)
    arguments = parser.parse_args()
    command = [arguments.mebots, "run", arguments.config, "--out", arguments.out,
               "--stop-time", arguments.stop_time]
    expected = brightness
    if arguments.dronet:
        command += ["--set", f"soc.flash.image={arguments.dronet / 'weights/WeightsPULPDroNet.raw'}"]
        expected = dronet(arguments.dronet)

    done = call([*command, "--set", f"soc.firmware={arguments.firmware}"])
    print(done.stdout, done.stderr)
    if done.returncode != 0:
        sys.exit("the mission failed")
    summary = json.loads((arguments.out / "summary.json").read_text())
    pictures = sorted(arguments.out.rglob("*.png"))
    count = summary["looks"]
    sent = summary["steering"], summary["collision"]
    if count < 3 or len(pictures) < count:
        sys.exit(f"{count} looks and {len(pictures)} pictures are too few")
    wanted = expected(np.asarray(Image.open(pictures[count - 1]))[:244])
    if sent != wanted:
        sys.exit(f"picture {count}, {pictures[count - 1]}: sent {sent}, expected {wanted}")
    print(f"{count} looks; the last one sent {sent}, as its picture wants")
    chip = summary["chip_energy"]["total"]
    of_parts = chip + sum(summary[f"{part}_energy"] for part in ("hyperram", "hyperflash", "pads", "camera"))
    if abs(of_parts - summary["rails_energy"]) > 1e-9 * of_parts:
        sys.exit(f"chip and parts take {of_parts} J, the rails {summary['rails_energy']} J")
    if not summary["board_energy"] > summary["rails_energy"] > chip + summary["camera_energy"] > 0:
        sys.exit(f"energies that cannot be: {summary}")

    for option, complaint in ((["--set", "soc.firmware="], "contains no program"),
                              (["--set", "soc.firmware=nowhere.elf"], "nowhere.elf"),
                              (["--set", f"soc.firmware={arguments.firmware}", "--set", "soc.flash.image=nowhere.raw"],
                               "nowhere.raw")):
        refused = call([*command, *option])
        if refused.returncode == 0 or complaint not in refused.stdout + refused.stderr:
            sys.exit(f"{option}: not refused, or not by name: {refused.stdout}{refused.stderr}")


if __name__ == "__main__":
    main()
