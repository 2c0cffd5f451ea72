#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Flies a relay of four drones that hand over by radio: without loss, with loss, and with a radio that loses everything.

Usage: run.py [--build BUILD_FOLDER] [--out FOLDER]

BUILD_FOLDER (build/release) contains a build of MEbots; firmware and FMUs are built there if they are missing.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
LEG_M, RESERVE = 5.0, 0.1  # node.leg and node.reserve of board.json
DRONES = range(1, 5)


def require(good, complaint):
    if not good:
        sys.exit(f"FAILED: {complaint}")


def fly(build, out, loss, *options):
    """Returns the columns and the summary of the mission."""
    command = [build / "bin/mebots", "run", HERE / "mission.json", "--out", out, "--quiet", "--set", f"radio.packet.loss={loss}", *options]
    subprocess.run(command, check=True)
    with (out / "results.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    columns = {name.rsplit(" [", 1)[0]: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}
    return columns, json.loads((out / "summary.json").read_text())


def check_order(columns):
    """Checks that each drone takes off when the previous one is at the end of its leg, and not before."""
    time = columns["time"]
    for drone in DRONES:
        way, height = ([columns[f"world.drone[{drone}].position.{axis}"][row] for row in range(len(time))] for axis in "xz")
        require(abs(way[-1] - LEG_M) < 0.1, f"drone {drone} landed {way[-1]:.2f} m from its start")
        if drone == 1:
            continue
        start = next(row for row in range(len(time)) if height[row] > height[0] + 0.05)
        before = columns[f"world.drone[{drone - 1}].position.x"][start]
        require(before > LEG_M - 0.5, f"drone {drone} took off when drone {drone - 1} had flown {before:.2f} m")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    out = (arguments.out or build / "relay").resolve()
    if not (build / "fmus/relay.fmu").exists():
        subprocess.run(["cmake", "--build", build, "--target", "relay_archive", "fmu_radio_archive", "fmu_world_4_archive", "mebots"], check=True)

    columns, summary = fly(build, out / "without_loss", 0)
    require(summary["outcome"] == "finished" and summary["finished"]["count"] == len(DRONES), f"without loss: {summary['outcome']}")
    # A drone sends one packet to the next one, and one reply to the previous one.
    require(list(summary["sent"]["each"].values()) == [1, 2, 2, 1], f"packets: {summary['sent']['each']}")
    check_order(columns)
    print(f"without loss, four drones finish after {columns['time'][-1]:.0f} s")

    lossy, summary = fly(build, out / "loss", 0.8)
    require(summary["finished"]["count"] == len(DRONES), f"with a loss of 0.8, {summary['finished']['count']} drones finish")
    require(sum(summary["sent"]["each"].values()) > 20, f"with a loss of 0.8, few packets: {summary['sent']['each']}")
    check_order(lossy)
    require(fly(build, out / "again", 0.8)[0] == lossy, "a second flight had other values")
    print(f"with a loss of 0.8, they finish after {lossy['time'][-1]:.0f} s; a second flight had the same bits")

    _, summary = fly(build, out / "deaf", 1, "battery[?].cell.initial_state_of_charge=0.3")  # shortens the flight
    charge = summary["state_of_charge"]["each"]
    require(summary["outcome"] == "out_of_charge" and summary["finished"]["count"] == 0, f"with a loss of 1: {summary['outcome']}")
    require(RESERVE - 0.02 < charge["1"] < RESERVE, f"drone 1 landed with a charge of {charge['1']}")
    require(min(charge[str(drone)] for drone in DRONES[1:]) > 0.25, f"drones on the ground have a charge of {charge}")
    print("with a radio that loses everything, drone 1 hovers until its reserve")


if __name__ == "__main__":
    main()
