# SPDX-License-Identifier: Apache-2.0
"""Reads the files of mebots-dataset."""

import pathlib

import numpy as np

from network import EDGE


class Pictures:
    """Pictures (grey levels minus 128), and the expert's command for each picture."""

    def __init__(self, path):
        path = pathlib.Path(path)
        self.pixels = np.fromfile(f"{path}.pictures", np.int8).reshape(-1, 1, EDGE, EDGE)
        labels = np.genfromtxt(f"{path}.labels.csv", delimiter=",", names=True)
        self.yaw = labels["yaw"].astype(np.float32)
        self.visible = labels["visible"] > 0
        self.strength = labels["strength"]
        if len(self.yaw) != len(self.pixels):
            raise SystemExit(f"{path}: {len(self.pixels)} pictures, but {len(self.yaw)} labels: generate them again")

    def __len__(self):
        return len(self.yaw)


def batches(pictures, size, random=None):
    """Yields batches as (pixels, yaw). With a random generator, the order is random and half of the pictures are
    mirrored."""
    order = np.arange(len(pictures)) if random is None else random.permutation(len(pictures))
    for begin in range(0, len(order), size):
        chosen = order[begin:begin + size]
        pixels = pictures.pixels[chosen].astype(np.float32)
        yaw = pictures.yaw[chosen]
        if random is not None:
            mirrored = random.random(len(chosen)) < 0.5
            pixels[mirrored] = pixels[mirrored, :, :, ::-1]
            yaw = np.where(mirrored, -yaw, yaw).astype(np.float32)
        yield pixels, yaw
