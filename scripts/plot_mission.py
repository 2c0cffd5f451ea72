#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a mission from its results folder: mission.png, and pictures.png from what the camera saw.

Usage: plot_mission.py RESULTS_DIR [--scene SCENE.json]
"""

import argparse
import csv
import json
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

SCENES = pathlib.Path(__file__).resolve().parent.parent / "fmu_world" / "params" / "scenes"


def read_results(path):
    """Columns of results.csv as {"instance.variable": array}, units left out of the names."""
    with path.open(newline="") as file:
        rows = csv.reader(file)
        header = [name.rsplit(" [", 1)[0] for name in next(rows)]
        values = np.array([[float(cell) for cell in row] for row in rows])
    return {name: values[:, column] for column, name in enumerate(header)}


def draw_gates(axes, scene):
    """Top view: each gate as its two posts and the opening between them."""
    for gate in scene.get("gates", []):
        x, y = gate["position"][:2]
        yaw = gate.get("yaw", 0.0)
        along = np.array([-math.sin(yaw), math.cos(yaw)])
        for side in (-1, 1):
            inner = np.array([x, y]) + side * along * gate["inner"] / 2
            outer = np.array([x, y]) + side * along * gate["outer"] / 2
            axes.plot(*zip(inner, outer), color="tab:red", linewidth=4, solid_capstyle="butt")


def running_mean(time, values, window=1.0):
    """Mean over the last `window` seconds: chip and camera switch many times a second."""
    count = max(1, round(window / (time[1] - time[0])))
    sums = np.concatenate(([0.0], np.cumsum(values)))
    first = np.maximum(np.arange(len(values)) - count + 1, 0)
    return (sums[1:] - sums[first]) / (np.arange(len(values)) + 1 - first)


def plot_mission(data, scene, summary, path):
    time = data["time"]
    figure, axes = plt.subplots(2, 2, figsize=(11, 7), constrained_layout=True)
    outcome = summary.get("outcome", "?")
    figure.suptitle(f"{summary.get('config', path.parent.name)}: {outcome}")

    top = axes[0, 0]
    top.plot(data["world.drone.position.x"], data["world.drone.position.y"], color="tab:blue")
    top.plot(data["world.drone.position.x"][0], data["world.drone.position.y"][0], "o", color="tab:green", label="start")
    top.plot(data["world.drone.position.x"][-1], data["world.drone.position.y"][-1], "s", color="black", label="end")
    draw_gates(top, scene)
    top.set(xlabel="x [m]", ylabel="y [m]", title="path from above, gate in red")
    top.axis("equal")
    top.legend()

    flight = axes[0, 1]
    flight.plot(time, data["world.drone.position.z"], label="altitude [m]")
    flight.plot(time, data["world.drone.speed"], label="speed [m/s]")
    flight.plot(time, data["soc.setpoint.yaw_rate"], label="yaw-rate set-point [rad/s]", linewidth=0.8)
    flight.set(xlabel="time [s]", title="flight")
    flight.legend()

    cell = axes[1, 0]
    cell.plot(time, data["battery.cell.voltage"], color="tab:orange", linewidth=0.8)
    cell.set(xlabel="time [s]", ylabel="cell voltage [V]", title="battery")
    charge = cell.twinx()
    charge.plot(time, 100 * data["battery.cell.state_of_charge"], color="tab:purple")
    charge.set_ylabel("state of charge [%]", color="tab:purple")

    power = axes[1, 1]
    for name, label in (("motors.power", "motors"), ("motors.avionics.power", "avionics"),
                        ("soc.power", "chip"), ("soc.camera.power", "camera")):
        power.plot(time, running_mean(time, data[name]), label=label, linewidth=1.2)
    power.set(xlabel="time [s]", ylabel="power [W]", yscale="log", ylim=(1e-4, 50), title="power of the loads, mean over 1 s")
    power.legend()

    figure.savefig(path, dpi=110)
    plt.close(figure)


def read_pgm(path):
    """An 8-bit binary PGM as a 2-d array."""
    magic, size, limit, pixels = path.read_bytes().split(b"\n", 3)
    width, height = (int(n) for n in size.split())
    if magic != b"P5" or limit != b"255":
        sys.exit(f"{path}: not an 8-bit binary PGM")
    return np.frombuffer(pixels, np.uint8, width * height).reshape(height, width)


def plot_pictures(folder, path, count=8):
    files = sorted(folder.rglob("*.pgm"))
    chosen = [files[round(i)] for i in np.linspace(0, len(files) - 1, min(count, len(files)))]
    figure, axes = plt.subplots(2, (len(chosen) + 1) // 2, figsize=(11, 5.8), constrained_layout=True, squeeze=False)
    for cell in axes.flat:
        cell.axis("off")
    for cell, file in zip(axes.flat, chosen):
        cell.imshow(read_pgm(file), cmap="gray", vmin=0, vmax=255)
        cell.set_title(f"{float(file.stem):.2f} s", fontsize=9)
    figure.suptitle("what the camera saw")
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--scene", type=pathlib.Path, help="scene file; default: the easy gate")
    arguments = parser.parse_args()

    summary = json.loads((arguments.results / "summary.json").read_text())
    scene = json.loads((arguments.scene or SCENES / "gate_easy.json").read_text())
    plot_mission(read_results(arguments.results / "results.csv"), scene, summary, arguments.results / "mission.png")
    print(f"wrote {arguments.results / 'mission.png'}")
    pictures = arguments.results / "pictures"
    if any(pictures.rglob("*.pgm")):
        plot_pictures(pictures, arguments.results / "pictures.png")
        print(f"wrote {arguments.results / 'pictures.png'}")


if __name__ == "__main__":
    main()
