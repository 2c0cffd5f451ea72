#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Flies a drone through a hall of boxes, which it avoids with five range sensors. Also flies it without using the sensors.

Usage: .venv/bin/python examples/multiranger/run.py [--build BUILD_FOLDER] [--out FOLDER]

BUILD_FOLDER (build/release) contains a build of MEbots; firmware and FMUs are built there if they are missing.
"""

import argparse
import csv
import json
import math
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
HALF_DRONE_M = 0.046
LEAST_DISTANCE_M = 0.2  # from the drone's middle to a box or a wall
FORWARD_M = 0.0175  # distance of the front sensor from the drone's middle: fmu_world/params/drones/crazyflie.json


def require(good, complaint):
    if not good:
        sys.exit(f"FAILED: {complaint}")


def fly(build, out, *settings):
    """Returns the columns and the summary of the mission. The path of the scene in mission.json is relative to the root of the checkout."""
    subprocess.run([build / "bin/mebots", "run", HERE / "mission.json", "--out", out, *settings], check=True, cwd=ROOT)
    with (out / "results.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    columns = {name.rsplit(" [", 1)[0]: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}
    return columns, json.loads((out / "summary.json").read_text())


def distance(box, x, y):
    """Returns the horizontal distance from a point to a box, whose sides are parallel to the axes; 0 inside."""
    sides = [max(0.0, abs(value - middle) - size / 2) for value, middle, size in zip((x, y), box["position"], box["size"])]
    return math.hypot(*sides)


def check_distances(columns, boxes):
    flown = zip(columns["world.drone.position.x"], columns["world.drone.position.y"])
    nearest, name = min((distance(box, x, y), box["name"]) for x, y in flown for box in boxes)
    print(f"the nearest box was {nearest:.2f} m from the drone's middle: {name}")
    require(nearest > LEAST_DISTANCE_M, f"the drone came within {nearest:.3f} m of {name}")


def check_front(columns, boxes):
    """Compares the readings of the front sensor with the distance to the nearest box ahead."""
    compared = 0
    for row in range(60, len(columns["time"])):
        # A sample is up to 0.1 s old. So the comparison uses only rows in which the drone is level and hardly moves.
        angles = [abs(columns[f"world.drone.{angle}"][row]) for angle in ("roll", "pitch", "yaw")]
        if max(angles) > 0.02 or columns["world.drone.speed"][row] > 0.1 or columns["world.drone.position.z"][row] < 0.5:
            continue
        x, y = (columns[f"world.drone.position.{axis}"][row] for axis in "xy")
        ahead = [box["position"][0] - box["size"][0] / 2 - x - FORWARD_M for box in boxes
                 if abs(y - box["position"][1]) < box["size"][1] / 2 - 0.3 and box["position"][0] > x]
        if not ahead or min(ahead) > 2:
            continue
        compared += 1
        error = abs(columns["world.multiranger.front"][row] - min(ahead))
        require(error < 0.05, f"the sensor in front is wrong by {error:.3f} m at {columns['time'][row]:.3f} s")
    require(compared > 100, f"only {compared} rows could be compared")
    print(f"the sensor in front agrees with the scene in {compared} rows")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    out = (arguments.out or build / "multiranger").resolve()
    if not (build / "fmus/multiranger.fmu").exists():
        subprocess.run(["cmake", "--build", build, "--target", "multiranger_archive", "fmu_world_archive", "mebots"], check=True)
    boxes = json.loads((HERE / "scene.json").read_text())["boxes"]
    columns, summary = fly(build, out / "flight")
    require(summary["outcome"] == "arrived", f"the outcome is {summary['outcome']}")
    require(summary["exit_code"] == 0, f"the exit code is {summary['exit_code']}")
    check_distances(columns, boxes)
    check_front(columns, boxes)
    power_w = summary["energy"]["sensors"] / columns["time"][-1]
    require(abs(power_w / 0.092 - 1) < 0.01, f"the sensors took {power_w} W")
    again, _ = fly(build, out / "again", "--quiet")
    require(again == columns, "a second flight had other values")
    straight, ending = fly(build, out / "straight", "--quiet", "--set", "chip.course.avoid=false")
    require(ending["outcome"] == "crashed", f"without avoiding, the outcome is {ending['outcome']}")
    first = next(box for box in boxes if box["name"] == "first box")
    nearest = min(distance(first, x, y) for x, y in zip(straight["world.drone.position.x"], straight["world.drone.position.y"]))
    require(nearest < HALF_DRONE_M + 0.005, f"without avoiding, the drone came within {nearest:.3f} m of the first box only")
    require(max(straight["world.drone.position.x"]) < 2, "without avoiding, the drone passed the first box")
    print("a second flight had the same bits; without avoiding, the drone hits the first box and crashes")


if __name__ == "__main__":
    main()
