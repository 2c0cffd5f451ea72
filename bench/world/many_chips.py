#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures missions of several drones, each with its chip, camera, network, motors and battery.

    .venv/bin/python bench/world/many_chips.py build/release/bin/mebots

Each drone is the one of configs/gate_easy.json: its chip runs the shipped firmware, which takes pictures and computes the network. The drones
start 0.5 m apart in rows of four, so they are in each other's pictures. Prints simulated drone seconds per second of wall time and
of processor time, and the largest amount of memory. `--out` keeps the configs.
"""
import argparse
import json
import os
import subprocess
import tempfile
import time
from pathlib import Path

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
SPACING_M = 0.5
POSE = ["position.x", "position.y", "position.z", "yaw", "velocity.x", "velocity.y", "velocity.z", "yaw_rate"]


def of_drone(variable):
    """Returns the name of a variable in the mission of several drones, from its name in the mission of one drone."""
    instance, name = variable.split(".", 1)
    if instance != "world":
        return f"{instance}[{{i}}].{name}"
    return f"world.drone[{{i}}].{name.removeprefix('drone.')}"


def mission_of(drones, seconds):
    """Returns the config of `drones` drones. One drone is the shipped mission."""
    config = json.loads((CONFIGS / "gate_easy.json").read_text())
    shown = {"$schema": str(CONFIGS / "schemas/mebots-config.schema.json"), "step": config["step"], "stop_time": seconds, "record": {"interval": 0.1}}
    if drones == 1:
        return config | {"record": shown["record"], "stop_time": seconds, "$schema": shown["$schema"]}
    instances = {f"{name}[{{i}}]": {"repeat": "drones"} | one for name, one in config["instances"].items() if name != "world"}
    world = config["instances"]["world"]["parameters"]
    shared = {name: world[name] for name in world if name.startswith(("scene.", "wind."))}
    instances["world"] = {
        "fmu": "fmu_world_4" if drones <= 4 else "fmu_world_16",
        "parameters": [
            shared | {"drone.count": drones, "start.spacing.y": 0},
            *({f"drone[{i + 1}].start.offset.x": -SPACING_M * (i // 4), f"drone[{i + 1}].start.offset.y": SPACING_M * (i % 4 - 1.5)} for i in range(drones)),
            {"repeat": "drones"} | {f"drone[{{i}}].{name}": world[name] for name in world if name not in shared},
            {"repeat": {"r": [1, 4], "v": {"pose": POSE}}, "robot[{r}].{pose}": 0},
        ],
    }
    connections = [{"repeat": "drones", "from": of_drone(one["from"]), "to": of_drone(one["to"])} for one in config["connections"]]
    return shown | {"groups": {"drones": {"i": [1, drones]}}, "instances": instances, "connections": connections}


def measure(mebots, config, folder):
    """Runs a config. Returns its seconds of wall time and of processor time, and its largest memory in MiB."""
    start = time.perf_counter()
    process = subprocess.Popen([mebots, "run", config, "--out", folder, "--quiet"])
    _, status, usage = os.wait4(process.pid, 0)
    wall_s = time.perf_counter() - start
    if status != 0:
        raise SystemExit(f"{config}: mebots run failed")
    return wall_s, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mebots")
    parser.add_argument("--drones", type=int, nargs="+", default=[1, 4, 16], choices=range(1, 17), metavar="N", help="1 to 16 (default: 1 4 16)")
    parser.add_argument("--seconds", type=float, default=5.0, help="simulated time (default: 5)")
    parser.add_argument("--out", type=Path, help="folder for the configs and results (default: a temporary one)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.out or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        print("drones  real time  drones x real time  per second of processor time   MiB  pictures of a drone")
        for drones in options.drones:
            path = folder / f"drones_{drones}.json"
            path.write_text(json.dumps(mission_of(drones, options.seconds), indent=2))
            wall_s, cpu_s, memory_mib = measure(options.mebots, path, folder / f"drones_{drones}")
            simulated_s, pictures = end_of(folder / f"drones_{drones}/results.csv", drones)
            pace = simulated_s / wall_s
            print(f"{drones:6} {pace:10.2f} {drones * pace:19.2f} {drones * simulated_s / cpu_s:29.2f} {memory_mib:5.0f} {pictures:20.0f}")


def end_of(results, drones):
    """Returns the simulated time of a mission, and the mean number of pictures that a drone took. The mission of one drone can stop before
    its stop time."""
    with results.open() as file:
        names, *_, last = (line.rstrip("\n").split(",") for line in file)
    frames = [float(value) for name, value in zip(names, last, strict=True) if name.split("[", 1)[0].startswith("world") and "camera.frame_id" in name]
    return float(last[0]), sum(frames) / drones


if __name__ == "__main__":
    main()
