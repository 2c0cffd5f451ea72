# SPDX-License-Identifier: Apache-2.0
"""Defines the outputs of the sight network, and reads its training pictures."""

import copy
import pathlib

import numpy as np

from network import EDGE

# The network's outputs, each in [-1, 1]. yaw and rise are the position of the opening's centre, to the left of and above the
# picture's centre, relative to half the picture. size is half the frame's edge, divided by half the picture's width and by
# MOST_SIZE. visible is positive if there is a gate.
OUTPUTS = ("yaw", "rise", "size", "visible")
MOST_SIZE = 2.0


class Sights:
    """Pictures (grey levels minus 128) and the target of each picture: the outputs, and whether there is a gate."""

    def __init__(self, path):
        path = pathlib.Path(path)
        self.pixels = np.fromfile(f"{path}.pictures", np.int8).reshape(-1, 1, EDGE, EDGE)
        self.labels = np.genfromtxt(f"{path}.labels.csv", delimiter=",", names=True)
        if len(self.labels) != len(self.pixels):
            raise SystemExit(f"{path}: {len(self.pixels)} pictures, but {len(self.labels)} labels: generate them again")
        size = np.minimum(self.labels["size"], MOST_SIZE) / MOST_SIZE
        self.visible = self.labels["visible"] > 0
        self.wanted = np.stack([self.labels["yaw"], self.labels["rise"], size, self.visible], 1).astype(np.float32)

    def __len__(self):
        return len(self.pixels)

    def with_first(self, count, others):
        """Returns these pictures, and the first `count` pictures of `others` without their labels."""
        both = copy.copy(self)
        for name in ("pixels", "visible", "wanted"):
            setattr(both, name, np.concatenate([getattr(self, name), getattr(others, name)[:count]]))
        return both


def batches(sights, size, random=None):
    """Yields batches as (pixels, wanted). With a random generator, the order is random and half of the pictures are
    mirrored."""
    order = np.arange(len(sights)) if random is None else random.permutation(len(sights))
    for begin in range(0, len(order), size):
        chosen = order[begin:begin + size]
        pixels = sights.pixels[chosen].astype(np.float32)
        wanted = sights.wanted[chosen]
        if random is not None:
            mirrored = random.random(len(chosen)) < 0.5
            pixels[mirrored] = pixels[mirrored, :, :, ::-1]
            wanted[mirrored, 0] *= -1
        yield pixels, wanted
