#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the accuracy of PULP-DroNet v2 on the Himax data set, in float and in integers. Prints intervals of both accuracies
and of their difference.

MODEL is model_original_himax.onnx or model_original.onnx of github.com/pulp-platform/pulp-dronet (pulp-dronet-v2/gapflow);
PICTURES is a checkout of github.com/pulp-platform/Himax_Dataset. The data set has no labels for steering. For steering, the root
mean square difference between integers and float is printed."""

import argparse
import pathlib

import numpy as np

from mebots.deploy import layers as integers
from mebots.deploy.deployed import Options
from mebots.deploy.lowering import lower
from mebots.deploy.pictures import Crop

CROP = Crop(62, 44)  # 200 x 200 pixels in the middle of the lower edge, as in PULP-DroNet's firmware
REPETITIONS = 10_000


def read_labels(folder):
    """Returns {path of a picture: its collision label}."""
    labels = {}
    for file in folder.rglob("labels.txt"):
        frames = sorted(file.parent.glob("frame_*.pgm"), key=lambda one: int(one.stem.split("_")[1]))
        values = [int(float(one)) for one in file.read_text().split()]
        if len(frames) != len(values):
            print(f"{file}: {len(values)} labels for {len(frames)} pictures; the folder is left out")
            continue
        labels |= dict(zip(frames, values, strict=True))
    return labels


def interval(values, random):
    """Returns the 95 % confidence interval of a mean, by resampling the pictures."""
    chosen = random.integers(0, len(values), (REPETITIONS, len(values)))
    return np.percentile(values[chosen].mean(axis=1), [2.5, 97.5])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("pictures", type=pathlib.Path)
    parser.add_argument("--percentile", type=float)
    given = parser.parse_args()
    deployed = lower(given.model, given.pictures, Options(crop=CROP, percentile=given.percentile))
    labels = read_labels(given.pictures)
    rows = []
    for number, file in enumerate(deployed.pictures.files):
        if file not in labels:
            continue
        stored = deployed.pictures.one(number, deployed.scale)
        floats = deployed.float_model.run(deployed.pictures.real(stored, deployed.scale))
        values = integers.run(deployed.network, stored)
        both = [floats[one.name].item() for one in deployed.graph.outputs]
        both += [float(deployed.network.scales[one].real(values[one]).item()) for one in deployed.network.outputs]
        rows.append((labels[file], *both))
    label, steer, collision, steer_byte, collision_byte = np.array(rows).T
    right, right_byte = ((one > 0.5) == (label > 0.5) for one in (collision, collision_byte))
    random = np.random.default_rng(1)
    print(f"{len(label)} pictures, {int(label.sum())} with a collision")
    for name, values in (("float", right), ("int8", right_byte), ("loss", right.astype(float) - right_byte)):
        low, high = interval(values.astype(float), random)
        print(f"collision, {name}: {100 * values.mean():.2f} %, 95 % interval {100 * low:.2f} to {100 * high:.2f} %")
    print(f"collision probability: root mean square difference {np.sqrt(np.mean((collision - collision_byte) ** 2)):.4f}")
    print(f"steering: root mean square difference {np.sqrt(np.mean((steer - steer_byte) ** 2)):.4f}, of values with deviation {steer.std():.4f}")


if __name__ == "__main__":
    main()
