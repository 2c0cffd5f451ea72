#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts the networks of Neural-Swarm2 from PyTorch to the file that `downwash.networks` of fmu_world names.

Usage: .venv/bin/python scripts/downwash_networks.py FOLDER FILE.json [--large]

FOLDER contains phi_S.pth, phi_G.pth and rho_S.pth (for large drones: phi_L.pth, phi_G.pth, rho_L.pth) from
github.com/aerorobotics/neural-swarm, data/models/models/output. That repository has no licence, so MEbots contains no part of it, and you need
your own copy. Networks that you have trained can be converted too, if each file is a state_dict of linear layers in their order.
PyTorch is not needed.
"""

import argparse
import collections
import io
import json
import pathlib
import pickle
import sys
import zipfile

import numpy as np

PLANNER = "the authors' planning/robots.py, class RobotCrazyFlie3D"
RECORDINGS = "range in 46 recordings of small drones in the authors' data/training"
STORAGES = {"FloatStorage": np.float32, "DoubleStorage": np.float64}


class Weights(pickle.Unpickler):
    """Reads a dict of tensors from the archive of torch.save(), and creates no other objects."""

    def __init__(self, archive: zipfile.ZipFile, folder: str):
        super().__init__(io.BytesIO(archive.read(f"{folder}/data.pkl")))
        self.archive, self.folder = archive, folder

    @staticmethod
    def tensor(numbers, offset, size, stride, *_):
        last = offset + sum((count - 1) * step for count, step in zip(size, stride, strict=True))
        if min(offset, *stride) < 0 or min(size, default=1) < 1 or last >= numbers.size:
            raise pickle.UnpicklingError(f"a tensor of size {tuple(size)} exceeds its {numbers.size} stored numbers")
        return np.lib.stride_tricks.as_strided(numbers[offset:], size, [numbers.itemsize * step for step in stride]).copy()

    def find_class(self, module, name):
        if (module, name) == ("torch._utils", "_rebuild_tensor_v2"):
            return self.tensor
        if (module, name) == ("collections", "OrderedDict"):
            return collections.OrderedDict
        if module == "torch" and name in STORAGES:
            return STORAGES[name]
        raise pickle.UnpicklingError(f"{module}.{name} is no part of a network's weights")

    def persistent_load(self, saved):
        _, kind, key, *_ = saved
        return np.frombuffer(self.archive.read(f"{self.folder}/data/{key}"), kind)


def read_layers(file: pathlib.Path):
    """Returns the layers of a network in the form of the JSON file."""
    try:
        with zipfile.ZipFile(file) as archive:
            tensors = Weights(archive, archive.namelist()[0].split("/")[0]).load()
    except FileNotFoundError:
        sys.exit(f"{file}: there is no such file; copy it from data/models/models/output of github.com/aerorobotics/neural-swarm")
    except (zipfile.BadZipFile, pickle.UnpicklingError, KeyError, IndexError, ValueError) as error:
        sys.exit(f"{file}: not a state_dict in the format of torch.save() since PyTorch 1.6 ({error}); load it with PyTorch and save it again")
    layers = []
    for name, weights in tensors.items():
        if not name.endswith(".weight"):
            continue
        offsets = tensors.get(name.removesuffix("weight") + "bias")
        if weights.ndim != 2 or offsets is None:
            sys.exit(f"{file}: '{name}' is not the matrix of a linear layer with a bias; only such layers can be converted")
        if not (np.isfinite(weights).all() and np.isfinite(offsets).all()):
            sys.exit(f"{file}: layer '{name.removesuffix('.weight')}' contains numbers that are not finite; train the network again")
        layers.append({"weights": weights.astype(float).tolist(), "offsets": offsets.astype(float).tolist()})
    if not layers:
        sys.exit(f"{file}: no linear layer, which would have the tensors NAME.weight and NAME.bias")
    return layers


def limit(value, unit, source):
    return {"value": value, "unit": unit, "source": source}


def converted(folder: pathlib.Path, size: str):
    return {
        "$schema": "mebots-downwash.schema.json",
        "name": "neural_swarm2_" + ("large" if size == "L" else "small"),
        "source": f"phi_{size}.pth, phi_G.pth and rho_{size}.pth of github.com/aerorobotics/neural-swarm",
        "force_per_output": limit(0.00981, "N", "the networks predict grams; the authors' learning/utils.py converts with 9.81 m/s2"),
        "include_alone": False,
        "limits": {
            "x": limit(0.2, "m", PLANNER),
            "y": limit(0.2, "m", PLANNER),
            "z": limit(1.1, "m", RECORDINGS),
            "velocity_x": limit(1.5, "m/s", PLANNER),
            "height": limit(1.35, "m", RECORDINGS),
        },
        "phi": read_layers(folder / f"phi_{size}.pth"),
        "phi_ground": read_layers(folder / "phi_G.pth"),
        "rho": read_layers(folder / f"rho_{size}.pth"),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--large", action="store_true", help="networks of large drones (67 g) instead of small ones (34 g)")
    arguments = parser.parse_args()
    content = converted(arguments.folder, "L" if arguments.large else "S")
    arguments.file.write_text(json.dumps(content) + "\n")
    print(f"{arguments.file}: set downwash.networks to this path, and downwash.strength to 1")


if __name__ == "__main__":
    main()
