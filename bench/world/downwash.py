#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares fmu_world's downwash, the formula of gym-pybullet-drones, with the prediction of Neural-Swarm2's networks.

Usage: .venv/bin/python bench/world/downwash.py FOLDER [--height METRES]

FOLDER contains phi_S.pth, phi_G.pth and rho_S.pth from github.com/aerorobotics/neural-swarm, data/models/models/output. That
repository has no licence, so you must fetch the files yourself. Two small drones (Crazyflies, 34 g) hover, one above the other.
"""

import argparse
import collections
import io
import math
import pathlib
import pickle
import zipfile

import numpy as np

GRAM_N = 9.81e-3  # the networks predict in grams, with this acceleration
ROTOR_RADIUS_M = 0.02355  # default of rotors.radius


class Weights(pickle.Unpickler):
    """Reads a dict of tensors from an archive of torch.save(). Creates no other objects."""

    def __init__(self, archive: zipfile.ZipFile, folder: str):
        super().__init__(io.BytesIO(archive.read(f"{folder}/data.pkl")))
        self.archive, self.folder = archive, folder

    def find_class(self, module, name):
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return lambda numbers, offset, size, stride, *_: np.lib.stride_tricks.as_strided(numbers[offset:], size, [4 * step for step in stride]).copy()
        if (module, name) == ("collections", "OrderedDict"):
            return collections.OrderedDict
        if (module, name) == ("torch", "FloatStorage"):
            return np.float32
        raise pickle.UnpicklingError(f"{module}.{name} is no part of a network's weights")

    def persistent_load(self, saved):
        _, kind, key, *_ = saved
        return np.frombuffer(self.archive.read(f"{self.folder}/data/{key}"), kind)


def read_layers(file: pathlib.Path):
    """Returns the layers of a network as pairs of matrix and offset."""
    with zipfile.ZipFile(file) as archive:
        folder = archive.namelist()[0].split("/")[0]
        numbers = Weights(archive, folder).load()
    return [(numbers[f"fc{i}.weight"].astype(float), numbers[f"fc{i}.bias"].astype(float)) for i in range(1, 5)]


def evaluate(layers, values):
    """Returns the outputs of a network of linear layers with ReLU between them."""
    for i, (matrix, offset) in enumerate(layers):
        values = matrix @ (values if i == 0 else np.maximum(values, 0)) + offset
    return values


def predicted_n(networks, above_m, aside_m, height_m):
    """Returns the vertical force on the lower drone, positive = up. `height_m` is its height above the ground."""
    sum_of_features = evaluate(networks["phi_S"], np.array([0, aside_m, above_m, 0, 0, 0], float))
    sum_of_features = sum_of_features + evaluate(networks["phi_G"], np.array([-height_m, 0, 0, 0], float))
    return GRAM_N * float(evaluate(networks["rho_S"], sum_of_features)[0])


def formula_n(above_m, aside_m):
    """The force by fmu_world/src/dynamics/downwash.hpp, positive = up."""
    width_m = 0.16 * above_m - 0.11
    if width_m <= 0:
        return 0.0
    return -2267.18 * (ROTOR_RADIUS_M / (4 * above_m)) ** 2 * math.exp(-0.5 * (aside_m / width_m) ** 2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--height", type=float, default=0.5, help="height of the lower drone above the ground [m]")
    arguments = parser.parse_args()
    networks = {name: read_layers(arguments.folder / f"{name}.pth") for name in ("phi_S", "phi_G", "rho_S")}
    print("above [m]  aside [m]  formula [mN]  Neural-Swarm2 [mN]")
    for above_m in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0):
        for aside_m in (0.0, 0.1, 0.2):
            force_n = predicted_n(networks, above_m, aside_m, arguments.height)
            print(f"{above_m:9.1f} {aside_m:10.1f} {1e3 * formula_n(above_m, aside_m):13.1f} {1e3 * force_n:19.1f}")


if __name__ == "__main__":
    main()
