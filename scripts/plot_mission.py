#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a mission from its results folder: mission.png, and pictures.png from the camera's pictures.

Usage: plot_mission.py RESULTS_DIR [--scene SCENE.json] [--build BUILD_FOLDER]
"""

import argparse
import json
import math
import pathlib
import sys

import numpy as np

import figure_style as style
from figure_style import plt

NEEDED = ["world.drone.position.x", "world.drone.position.y", "world.drone.position.z", "world.drone.speed",
          "soc.setpoint.yaw_rate", "battery.cell.voltage", "battery.cell.state_of_charge", "battery.motors.energy",
          "battery.avionics.energy", "battery.soc.energy", "battery.camera.energy"]
ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENES = ROOT / "fmu_world" / "params" / "scenes"


def read_run(folder, build):
    """Reads the results of a run. Uses the Python package of a build."""
    sys.path.insert(0, str(build / "python"))
    try:
        import mebots
    except ImportError as error:
        sys.exit(f"plot_mission.py: {build} has no Python package of mebots: {error}. Name a build with --build")
    try:
        return mebots.read(folder)
    except mebots.InputError as error:
        sys.exit(f"plot_mission.py: {error}")


def draw_gates(axes, scene):
    """Draws the top view: each gate as its two posts and the opening between them."""
    for gate in scene.get("gates", []):
        x, y = gate["position"][:2]
        yaw = gate.get("yaw", 0.0)
        along = np.array([-math.sin(yaw), math.cos(yaw)])
        for side in (-1, 1):
            inner = np.array([x, y]) + side * along * gate["inner"] / 2
            outer = np.array([x, y]) + side * along * gate["outer"] / 2
            axes.plot(*zip(inner, outer), color=style.INK, linewidth=4, solid_capstyle="butt")


def mean_power(time, energy, window=1.0):
    """Returns the mean power over the last `window` seconds, from the energy since the start. Chip and camera switch many times
    between two rows. Samples of the power would miss this.
    """
    first = np.searchsorted(time, time - window)
    first[0] = 0
    span = time - time[first]
    return np.where(span > 0, energy - energy[first], np.nan) / np.where(span > 0, span, 1)


def find_scene(summary, path):
    """Returns the scene of the run, according to its summary."""
    world = summary.get("parameters", {}).get("world", {})
    file = path or world.get("scene.file") or SCENES / f"{world.get('scene.name', 'gate_easy')}.json"
    try:
        return json.loads(pathlib.Path(file).read_text())
    except (OSError, ValueError) as error:
        sys.exit(f"plot_mission.py: {file}: the scene cannot be read: {error}. Name it with --scene")


def plot_mission(data, scene, summary, path):
    time = data.times
    figure, axes = plt.subplots(2, 2, figsize=(11, 7), constrained_layout=True)
    outcome = summary.get("outcome", "?")
    figure.suptitle(f"{summary.get('config', path.parent.name)}: {outcome}")

    top = axes[0, 0]
    top.plot(data["world.drone.position.x"], data["world.drone.position.y"])
    top.plot(data["world.drone.position.x"][0], data["world.drone.position.y"][0], "o", color=style.GREEN, label="start")
    top.plot(data["world.drone.position.x"][-1], data["world.drone.position.y"][-1], "s", color="black", label="end")
    draw_gates(top, scene)
    top.set(xlabel="x [m]", ylabel="y [m]", title="path from above, gate in black")
    top.axis("equal")
    top.legend()

    flight = axes[0, 1]
    flight.plot(time, data["world.drone.position.z"], label="altitude [m]")
    flight.plot(time, data["world.drone.speed"], label="speed [m/s]")
    flight.plot(time, data["soc.setpoint.yaw_rate"], label="yaw-rate set-point [rad/s]", linewidth=0.8)
    flight.set(xlabel="time [s]", title="flight")
    flight.legend()

    cell = axes[1, 0]
    cell.plot(time, data["battery.cell.voltage"], linewidth=0.8)
    cell.set(xlabel="time [s]", ylabel="cell voltage [V]", title="battery")
    charge = cell.twinx()
    charge.plot(time, 100 * data["battery.cell.state_of_charge"], color=style.VERMILION)
    charge.set_ylabel("state of charge [%]", color=style.VERMILION)

    power = axes[1, 1]
    for name, label in (("motors", "motors"), ("avionics", "avionics"), ("soc", "chip"), ("camera", "camera")):
        power.plot(time, mean_power(time, data[f"battery.{name}.energy"]), label=label, linewidth=1.2)
    power.set(xlabel="time [s]", ylabel="power [W]", yscale="log", ylim=(1e-4, 50), title="power of the loads, mean over 1 s")
    power.legend()

    style.save(figure, path)


def plot_pictures(folder, path, count=8):
    files = sorted(folder.rglob("*.png"))
    chosen = [files[round(i)] for i in np.linspace(0, len(files) - 1, min(count, len(files)))]
    figure, axes = plt.subplots(2, (len(chosen) + 1) // 2, figsize=(11, 5.8), constrained_layout=True, squeeze=False)
    for cell in axes.flat:
        cell.axis("off")
    for cell, file in zip(axes.flat, chosen):
        cell.imshow(plt.imread(file), cmap="gray", vmin=0, vmax=1)
        cell.set_title(f"{float(file.stem):.2f} s", fontsize=9)
    figure.suptitle("what the camera saw")
    style.save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=pathlib.Path)
    parser.add_argument("--scene", type=pathlib.Path, help="scene file; default: the one that the run flew in")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    arguments = parser.parse_args()

    data = read_run(arguments.results, arguments.build)
    summary = data.summary
    missing = [name for name in NEEDED if name not in data]
    if missing:
        sys.exit(f"plot_mission.py: {arguments.results}: this is not the flight of a drone, or it did not record "
                 f"{', '.join(missing)}")
    scene = find_scene(summary, arguments.scene)
    plot_mission(data, scene, summary, arguments.results / "mission.png")
    print(f"wrote {arguments.results / 'mission.png'}")
    pictures = arguments.results / "pictures"
    if any(pictures.rglob("*.png")):
        plot_pictures(pictures, arguments.results / "pictures.png")
        print(f"wrote {arguments.results / 'pictures.png'}")


if __name__ == "__main__":
    main()
