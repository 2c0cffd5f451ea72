#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a firmware that reads a time-of-flight sensor: alone, then in flight.

An entry of board.json is the sensor's only definition.

Usage: run.py [--build BUILD_FOLDER] [--out FOLDER]

BUILD_FOLDER (build/release) contains a build of MEbots. If firmware and FMU are missing, they are built there.
"""

import argparse
import csv
import json
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
MEASUREMENTS = 20
SUPPLY_V, RANGING_A, RANGING_S = 2.8, 16e-3, 0.033  # values in board.json


def call(*command):
    done = subprocess.run([str(part) for part in command], text=True, capture_output=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed:\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def distances_mm(text):
    return [int(number) for number in re.findall(r"distance (\d+) mm", text)]


def require(good, complaint):
    if not good:
        sys.exit(complaint)


def run_alone(build):
    """Runs the firmware without motion. The distance is the `start` of the variable, 1.25 m."""
    report = call(build / "bin/mebots-soc", "run", build / "firmware/time_of_flight.elf", "--board", HERE / "board.json")
    print(report, end="")
    found = distances_mm(report)
    require(found == [1250] * MEASUREMENTS, f"expected {MEASUREMENTS} times the 1.25 m of board.json, got {found}")


def fly(build, out):
    """Runs the mission with the FMUs of this build. Returns the columns and the summary of its results."""
    text = call(build / "bin/mebots", "run", HERE / "mission.json", "--out", out / "flight")
    print(text, end="")
    with (out / "flight/results.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    names = [name.rsplit(" [", 1)[0] for name in rows[0]]
    columns = {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(names)
               if name in ("chip.range_finder.reported", "world.range.down")}
    return text, columns, json.loads((out / "flight/summary.json").read_text())


def check_flight(text, columns, summary):
    reported, below = columns["chip.range_finder.reported"], columns["world.range.down"]
    changes = [k for k in range(1, len(reported)) if reported[k] != reported[k - 1]]
    require(len(changes) > MEASUREMENTS // 2, f"the drone climbs, but only {len(changes)} different distances came")
    for k in changes:
        # The chip reports the world's output at the start of the step in which the sensor measured. This is one of the last three
        # rows before row k.
        candidates = [round(below[i], 3) for i in range(max(0, k - 3), k)]
        require(any(abs(reported[k] - candidate) < 1e-9 for candidate in candidates),
                f"row {k}: the chip reported {reported[k]} m, the world was at {candidates} m")
    require(len(distances_mm(text)) == MEASUREMENTS, "the firmware's prints are not in the log")
    require(reported[changes[-1]] > reported[changes[0]], "the drone did not climb")
    ranging_j = MEASUREMENTS * SUPPLY_V * RANGING_A * RANGING_S
    require(abs(summary["sensor_energy"] / ranging_j - 1) < 0.01, "the sensor's energy is not that of its data sheet")
    # The battery receives the loads one step later, so 2 ms of standby are missing.
    require(abs(summary["sensor_energy_of_the_battery"] / summary["sensor_energy"] - 1) < 1e-3,
            f"the battery gave the sensor another energy: {summary}")
    print(f"\n{len(changes)} distances from {reported[changes[0]]} m to {max(reported)} m, each as the world had it; "
          f"the sensor took {summary['sensor_energy'] * 1e3:.1f} mJ")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    if not (build / "fmus/time_of_flight.fmu").exists():
        call("cmake", "--build", build, "--target", "time_of_flight_archive", "mebots", "mebots-soc")
    run_alone(build)
    check_flight(*fly(build, (arguments.out or build / "time_of_flight").resolve()))


if __name__ == "__main__":
    main()
