#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Flies a drone that follows a rover and lands on its roof.

Usage: .venv/bin/python examples/rover/mission.py [--build BUILD_FOLDER] [--out FOLDER]

BUILD_FOLDER (build/release) contains a build of MEbots. If FMUs are missing, they are built there.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
ROOF_M, HALF_DRONE_M = 0.12, 0.0145
HALF_LENGTH_M, HALF_WIDTH_M = 0.15, 0.12


def require(good, complaint):
    if not good:
        sys.exit(f"FAILED: {complaint}")


def fly(build, out, *settings):
    """Returns the columns and the summary of the mission."""
    subprocess.run([build / "bin/mebots", "run", HERE / "mission.json", "--out", out, *settings], check=True)
    with (out / "results.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    columns = {name.rsplit(" [", 1)[0]: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}
    return columns, json.loads((out / "summary.json").read_text())


def check_range(columns):
    """Checks that the sensor measures the height above the roof or the ground. The drone is level up to 0.05 rad, so the error is
    small."""
    over = 0
    for row in range(1, len(columns["time"])):
        x, y = (columns[f"world.drone[1].position.{axis}"][row] - columns[f"world.robot[1].place.{axis}"][row] for axis in "xy")
        tilt = max(abs(columns[f"world.drone[1].{angle}"][row]) for angle in ("roll", "pitch"))
        if abs(x) > HALF_LENGTH_M - 0.05 or abs(y) > HALF_WIDTH_M - 0.05 or tilt > 0.05:
            continue
        over += 1
        height = columns["world.drone[1].position.z"][row] - ROOF_M
        error = abs(columns["world.drone[1].range.down"][row] - height)
        # The noise of a sample is 2.5 mm. The last sample is up to 25 ms old.
        speed = abs(columns["world.drone[1].position.z"][row] - columns["world.drone[1].position.z"][row - 1]) / 0.002
        require(error < 0.02 + 0.03 * speed, f"the range sensor is wrong by {error:.3f} m at {columns['time'][row]:.3f} s")
    require(over > 1000, "the drone was hardly ever over the roof")
    print(f"over the roof for {over * 0.002:.1f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    out = (arguments.out or build / "rover_mission").resolve()
    if not all((build / f"fmus/{name}.fmu").exists() for name in ("rover", "rover_wheels", "fmu_world_4")):
        subprocess.run(["cmake", "--build", build, "--target", "rover_archive", "rover_wheels_archive", "fmu_world_4_archive", "mebots"], check=True)
    columns, summary = fly(build, out / "flight")
    require(summary["outcome"] == "landed_on_the_rover", f"the outcome is {summary['outcome']}")
    require(1.95 < summary["rover"]["x"] < 2.06, "the rover did not stop where it should")
    require(abs(summary["drone"]["z"] - ROOF_M - HALF_DRONE_M) < 0.001, "the drone does not rest on the roof")
    check_range(columns)
    again, _ = fly(build, out / "again", "--quiet")
    require(again == columns, "a second flight had other values")
    print("a second flight had the same bits")


if __name__ == "__main__":
    main()
