#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts random networks from PyTorch's format, lets drones fall with them in fmu_world, and compares each step with NumPy.

Usage: downwash_test.py MEBOTS
"""

import collections
import csv
import io
import json
import pathlib
import pickle
import subprocess
import sys
import tempfile
import types
import zipfile

import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[2]
STEP_S = 0.001
STEPS = 150
GRAVITY, DRAG = 9.80665, (0.0147, 0.0147, 0.0128)  # fmu_world/src/dynamics, params/drones/crazyflie_bench.json
WIDTHS = {"phi_S": [6, 25, 40, 40, 20], "phi_G": [4, 25, 40, 40, 20], "rho_S": [20, 40, 40, 40, 1]}


class Storage:
    """Pickled as torch.save() pickles the storage of a tensor."""

    def __init__(self, key, kind, numbers):
        self.key, self.kind, self.numbers = key, kind, numbers


class Tensor:
    """Pickled as torch.save() pickles a tensor."""

    def __init__(self, storage):
        self.storage = storage

    def __reduce__(self):
        shape = self.storage.numbers.shape
        strides = (shape[1], 1) if len(shape) == 2 else (1,)
        return sys.modules["torch._utils"]._rebuild_tensor_v2, (self.storage, 0, shape, strides, False, collections.OrderedDict())


class Pickler(pickle.Pickler):
    def persistent_id(self, thing):
        return ("storage", thing.kind, thing.key, "cpu", thing.numbers.size) if isinstance(thing, Storage) else None


def stand_in_for_torch():
    """Creates stand-ins for PyTorch's modules, whose names the pickled file must contain."""
    torch, utils = types.ModuleType("torch"), types.ModuleType("torch._utils")
    torch.FloatStorage = type("FloatStorage", (), {"__module__": "torch"})
    exec("def _rebuild_tensor_v2(*_): raise NotImplementedError", utils.__dict__)
    utils._rebuild_tensor_v2.__module__ = "torch._utils"
    sys.modules |= {"torch": torch, "torch._utils": utils}
    return torch


def save(torch, file, layers, cut=0):
    """Writes a state_dict as torch.save() does, but without the last ``cut`` bytes of the last tensor."""
    tensors, storages = collections.OrderedDict(), []
    for number, (weights, offsets) in enumerate(layers, start=1):
        for name, numbers in (("weight", weights), ("bias", offsets)):
            storages.append(Storage(str(len(storages)), torch.FloatStorage, numbers))
            tensors[f"fc{number}.{name}"] = Tensor(storages[-1])
    text = io.BytesIO()
    Pickler(text, protocol=2).dump(tensors)
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("net/data.pkl", text.getvalue())
        for storage in storages:
            content = storage.numbers.tobytes()
            archive.writestr(f"net/data/{storage.key}", content[: len(content) - (cut if storage is storages[-1] else 0)])


def random_networks():
    random = np.random.default_rng(43)
    return {
        name: [((random.standard_normal((b, a)) * np.sqrt(2 / a)).astype(np.float32), (random.standard_normal(b) * 0.5).astype(np.float32))
               for a, b in zip(widths[:-1], widths[1:])]
        for name, widths in WIDTHS.items()
    }


def evaluate(layers, values):
    for number, (weights, offsets) in enumerate(layers):
        values = weights.astype(float) @ (values if number == 0 else np.maximum(values, 0)) + offsets.astype(float)
    return values


def force_n(networks, position, velocity, drone):
    """Returns the force and the number of neighbours, as docs/concepts/many-drones.md describes them."""
    ground = evaluate(networks["phi_G"], np.array([-min(position[drone, 2], 1.35), *-velocity[drone]]))
    features, neighbours = ground, 0
    for other in range(len(position)):
        apart = np.concatenate([position[other] - position[drone], velocity[other] - velocity[drone]])
        if other != drone and (abs(apart[:4]) < (0.2, 0.2, 1.1, 1.5)).all():
            features = features + evaluate(networks["phi_S"], apart)
            neighbours += 1
    return 0.00981 * (evaluate(networks["rho_S"], features)[0] - evaluate(networks["rho_S"], ground)[0]), neighbours


def config(fmu, count, file):
    parameters = {"scene.name": "empty", "drone.count": count, "physics.step": STEP_S, "downwash.strength": 1.5, "downwash.networks": str(file),
                  "start.spacing.y": 0, "wind.velocity.x": 2}
    random = np.random.default_rng(count)
    for i in range(1, count + 1):
        place = (*random.uniform(-0.25, 0.25, 2), 0.4 + 0.16 * i)
        parameters |= {f"drone[{i}].start.offset.{axis}": round(value, 4) for axis, value in zip("xyz", place)}
        parameters |= {f"drone[{i}].name": "crazyflie_bench", f"drone[{i}].dry_mass": 0.02 + 0.002 * i}
    return {"step": STEP_S, "stop_time": STEPS * STEP_S, "instances": {"world": {"fmu": fmu, "parameters": parameters}},
            "record": ["world.drone[*].position.*", "world.drone[*].velocity.*", "world.drone[*].mass"]}


def run(mebots, folder, content):
    file = folder / "config.json"
    file.write_text(json.dumps(content))
    return subprocess.run([mebots, "run", file, "--out", folder / "out"], text=True, capture_output=True, check=False)


def check(mebots, folder, fmu, count, networks, file):
    done = run(mebots, folder, config(fmu, count, file))
    assert done.returncode == 0, done.stdout + done.stderr
    with (folder / "out/results.csv").open(newline="") as stream:
        rows = list(csv.reader(stream))
    column = {name.rsplit(" [", 1)[0]: np.array([float(row[i]) for row in rows[1:]]) for i, name in enumerate(rows[0])}
    drones = range(1, count + 1)
    position, velocity = (np.stack([np.stack([column[f"world.drone[{i}].{what}.{axis}"] for axis in "xyz"], 1) for i in drones], 1)
                          for what in ("position", "velocity"))
    mass = [column[f"world.drone[{i}].mass"][0] for i in drones]
    wind, worst, most, pairs = np.array([2.0, 0, 0]), 0.0, 0.0, 0
    for k in range(STEPS):
        for i in range(count):
            force, neighbours = force_n(networks, position[k], velocity[k], i)
            air = np.array([0, 0, 1.5 * force]) - DRAG * (velocity[k, i] - wind)
            expected = velocity[k, i] + STEP_S * (air / mass[i] - [0, 0, GRAVITY])
            worst, most, pairs = max(worst, abs(velocity[k + 1, i] - expected).max() * mass[i] / STEP_S), max(most, abs(force)), pairs + neighbours
    assert pairs > STEPS, f"only {pairs} neighbours"
    assert most > 0.005, f"the greatest force is only {most} N"
    # Rounding changes velocities up to 2 m/s by 2e-16 m/s, which is 1e-14 N for 50 g and 1 ms. A force is a sum of thousands of terms, so its
    # rounding errors are larger.
    assert worst < 1e-11, f"the forces differ by {worst} N"
    print(f"{fmu}: {count} drones, {pairs} pairs in {STEPS} steps, forces up to {most:.3f} N, greatest difference {worst:.1e} N")
    return json.loads((folder / "out/summary.json").read_text())["inputs"]


def check_damaged(torch, folder, networks):
    """The converter refuses numbers that are not finite, and tensors that are larger than the stored numbers."""
    convert = [sys.executable, SOURCE / "scripts/downwash_networks.py", folder, folder / "damaged.json"]
    layers = [(weights.copy(), offsets) for weights, offsets in networks["rho_S"]]
    layers[1][0][2, 3] = np.nan
    save(torch, folder / "rho_S.pth", layers)
    done = subprocess.run(convert, text=True, capture_output=True, check=False)
    assert done.returncode == 1 and "rho_S.pth: layer 'fc2' contains numbers that are not finite" in done.stderr, done.stderr
    save(torch, folder / "rho_S.pth", networks["rho_S"], cut=4)
    done = subprocess.run(convert, text=True, capture_output=True, check=False)
    assert done.returncode == 1 and "a tensor of size (1,) exceeds its 0 stored numbers" in done.stderr, done.stderr
    assert not (folder / "damaged.json").exists()
    save(torch, folder / "rho_S.pth", networks["rho_S"])


def main():
    mebots, torch, networks = sys.argv[1], stand_in_for_torch(), random_networks()
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        for name, layers in networks.items():
            save(torch, folder / f"{name}.pth", layers)
        check_damaged(torch, folder, networks)
        file = folder / "networks.json"
        convert = [sys.executable, SOURCE / "scripts/downwash_networks.py", folder, file]
        subprocess.run(convert, check=True, capture_output=True)
        done = subprocess.run([mebots, "validate", file], text=True, capture_output=True, check=False)
        assert "valid downwash file" in done.stdout, done.stdout + done.stderr
        check(mebots, folder, "fmu_world_4", 4, networks, file)
        before = check(mebots, folder, "fmu_world_16", 16, networks, file)
        content = json.loads(file.read_text())
        content["rho"][-1]["offsets"][0] += 1  # has no effect on the force, but the file is an input of the mission
        file.write_text(json.dumps(content))
        after = check(mebots, folder, "fmu_world_16", 16, networks, file)
        assert after["sha256"] != before["sha256"] and after["files"].keys() == before["files"].keys() == {"world.downwash.networks"}, after
        done = run(mebots, folder, config("fmu_world_4", 4, folder / "nowhere.json"))
        assert done.returncode != 0 and "nowhere.json\": there is no such file" in done.stderr and "scripts/downwash_networks.py" in done.stderr, done.stderr
        done = subprocess.run([*convert[:2], folder / "nowhere", file], text=True, capture_output=True, check=False)
        assert done.returncode != 0 and "phi_S.pth: there is no such file" in done.stderr, done.stderr


if __name__ == "__main__":
    main()
