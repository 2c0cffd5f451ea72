# SPDX-License-Identifier: Apache-2.0
"""Writes a trained network for the firmware and its tests: the weights file and the golden vectors."""

import argparse
import hashlib
import pathlib

import numpy as np

import integer_network
from data import Pictures
from sight import OUTPUTS, Sights

# For each network: the class that reads its pictures, its outputs, and the number of golden pictures from each set.
NETWORKS = {"navigator": (Pictures, ("yaw",), {"test": 20, "easy": 6, "hard": 6}),
            "sight": (Sights, OUTPUTS, {"test": 8, "easy": 2, "hard": 2})}


def shrunk_pattern(width, height):
    """Returns the checksum of a shrunk picture given by a formula; tests/firmware/network_test.cpp has the same
    formula."""
    y, x = np.mgrid[:height, :width]
    return integer_network.checksum(integer_network.shrink((3 * x * x + 7 * y + x * y) % 256).astype(np.int8))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("network", type=pathlib.Path, help="integer.npz of train.py")
    parser.add_argument("data", type=pathlib.Path, help="folder with the pictures")
    parser.add_argument("weights", type=pathlib.Path, help="weights file to write")
    parser.add_argument("golden", type=pathlib.Path, help="golden vectors to write: <golden>.pictures, <golden>.csv")
    parser.add_argument("--of", choices=NETWORKS, default="navigator", help="which network")
    arguments = parser.parse_args()
    read, outputs, golden = NETWORKS[arguments.of]

    layers = integer_network.load(arguments.network)
    packed = integer_network.to_bytes(layers)
    arguments.weights.write_bytes(packed)
    print(f"{arguments.weights}: {len(packed)} bytes, sha256 {hashlib.sha256(packed).hexdigest()}")

    names = ["pooled", "second", "third", "fourth", "fifth", "sixth", "seventh"]
    lines = [",".join(["set", "index", *outputs, *names])]
    kept = []
    for name, count in golden.items():
        pictures = read(arguments.data / name)
        for index in np.linspace(0, len(pictures) - 1, count).astype(int):
            pixels = pictures.pixels[index, 0]
            values, activations = integer_network.infer(layers, pixels)
            kept.append(pixels)
            lines.append(",".join([name, str(index), *map(str, values)]
                                  + [f"{integer_network.checksum(a):08x}" for a in activations]))
    np.array(kept, np.int8).tofile(f"{arguments.golden}.pictures")
    for width, height in ((320, 320), (324, 244)):
        print(f"shrunk test pattern of {width} x {height}: {shrunk_pattern(width, height):08x}")
    pathlib.Path(f"{arguments.golden}.csv").write_text("\n".join(lines) + "\n")
    print(f"{arguments.golden}: {len(kept)} golden vectors")


if __name__ == "__main__":
    main()
