#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares fmu_world's downwash, the formula of gym-pybullet-drones, with the prediction of networks.

Usage: .venv/bin/python bench/world/downwash.py FILE.json [--height METRES]

FILE.json is a file for `downwash.networks` of fmu_world; scripts/downwash_networks.py writes it. Two small drones (Crazyflies, 34 g) hover, one
above the other. The table contains the prediction for both drones, minus that for the lower drone alone.
"""

import argparse
import json
import math
import pathlib

import numpy as np

ROTOR_RADIUS_M = 0.02355  # default of rotors.radius


def evaluate(layers, values):
    """Returns the outputs of a network of linear layers with ReLU between them."""
    for i, layer in enumerate(layers):
        values = np.array(layer["weights"]) @ (values if i == 0 else np.maximum(values, 0)) + np.array(layer["offsets"])
    return values


def predicted_n(networks, relative, height_m):
    """Returns the vertical force on a drone that hovers, positive = up. `relative` contains the positions of other drones relative to it."""
    features = evaluate(networks["phi_ground"], np.array([-height_m, 0, 0, 0], float))
    limits = [networks["limits"].get(axis, {"value": math.inf})["value"] for axis in "xyz"]
    for place in relative:
        if any(abs(value) >= limit for value, limit in zip(place, limits)):
            continue
        features = features + evaluate(networks["phi"], np.array([*place, 0, 0, 0], float))
    return networks["force_per_output"]["value"] * float(evaluate(networks["rho"], features)[0])


def formula_n(above_m, aside_m):
    """The force by fmu_world/src/dynamics/downwash.hpp, positive = up."""
    width_m = 0.16 * above_m - 0.11
    if width_m <= 0:
        return 0.0
    return -2267.18 * (ROTOR_RADIUS_M / (4 * above_m)) ** 2 * math.exp(-0.5 * (aside_m / width_m) ** 2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--height", type=float, default=0.5, help="height of the lower drone above the ground [m]")
    arguments = parser.parse_args()
    networks = json.loads(arguments.file.read_text())
    alone_n = predicted_n(networks, [], arguments.height)
    print(f"the lower drone alone: {1e3 * alone_n:.1f} mN")
    print("above [m]  aside [m]  formula [mN]  networks [mN]")
    for above_m in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.0):
        for aside_m in (0.0, 0.1, 0.2):
            force_n = predicted_n(networks, [(0, aside_m, above_m)], arguments.height) - alone_n
            print(f"{above_m:9.1f} {aside_m:10.1f} {1e3 * formula_n(above_m, aside_m):13.1f} {1e3 * force_n:14.1f}")


if __name__ == "__main__":
    main()
