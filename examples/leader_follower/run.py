#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Flies a leader that broadcasts its position, and two followers that keep their distance to the leader by ranging.

Usage: run.py [--build BUILD_FOLDER] [--out FOLDER]

BUILD_FOLDER (build/release) contains a build of MEbots. If firmware and FMUs are missing, they are built there.
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
DISTANCES_M = {2: 1.0, 3: 2.0}
SETTLED_S = 8.0
LOSS = 0.1  # probability of a lost packet, as in mission.json


def call(*command):
    done = subprocess.run([str(part) for part in command], text=True, capture_output=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed:\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def require(good, complaint):
    if not good:
        sys.exit(complaint)


def fly(build, out, *settings):
    """Runs the mission. Returns its output, its columns and its summary."""
    text = call(build / "bin/mebots", "run", HERE / "mission.json", "--out", out, *settings)
    with (out / "results.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    names = [name.rsplit(" [", 1)[0] for name in rows[0]]
    columns = {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(names)}
    return text, columns, json.loads((out / "summary.json").read_text())


def apart(columns, drone, row):
    return math.dist(*([columns[f"world.drone[{i}].position.{axis}"][row] for axis in "xyz"] for i in (1, drone)))


def check_distances(columns):
    for drone, wanted in DISTANCES_M.items():
        errors = [abs(apart(columns, drone, row) - wanted) for row, time in enumerate(columns["time"]) if time >= SETTLED_S]
        mean, most = sum(errors) / len(errors), max(errors)
        print(f"drone {drone} kept {wanted} m within {most:.2f} m, {mean:.2f} m in the mean")
        require(mean < 0.2 and most < 0.6, f"drone {drone} did not keep its distance")


def check_loss(summary):
    sent = summary["sent"]
    for name, lost in summary["lost"]["each"].items():
        # The last packet may still be under way.
        require(abs(lost + summary["received"]["each"][name] - sent) <= 1, f"packets of drone {name} are not accounted for")
        require(abs(lost - sent * LOSS) < 4 * math.sqrt(sent * LOSS * (1 - LOSS)), f"drone {name} lost {lost} of {sent} packets")
    print(f"of {sent} packets, {' and '.join(str(lost) for lost in summary['lost']['each'].values())} were lost, {LOSS:.0%} of them by chance")


def check_energy(summary):
    for name, energy in summary["energy"]["radio"]["each"].items():
        given = summary["energy"]["radio_of_the_battery"]["each"][name]
        # The battery receives the power of a load one step later.
        require(abs(given / energy - 1) < 1e-3, f"the battery gave radio {name} {given} J, it took {energy} J")
    print(f"the radios took {summary['energy']['radio']['least']:.2f} to {summary['energy']['radio']['most']:.2f} J")


def check_hover(columns):
    settled = next(row for row, time in enumerate(columns["time"]) if time >= SETTLED_S)
    for drone in DISTANCES_M:
        way = list(zip(*(columns[f"world.drone[{drone}].position.{axis}"][settled:] for axis in "xyz")))
        most = max(math.dist(place, way[0]) for place in way)
        require(most < 0.3, f"drone {drone} heard nothing, but flew {most:.2f} m away")


def check_approach(columns):
    nearer = apart(columns, 2, 0) - apart(columns, 2, -1)
    print(f"from 50 m away, drone 2 came {nearer:.1f} m nearer in {columns['time'][-1]:g} s")
    require(nearer > 2, "drone 2 did not come nearer")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    out = (arguments.out or build / "leader_follower").resolve()
    if not (build / "fmus/leader_follower.fmu").exists():
        call("cmake", "--build", build, "--target", "leader_follower_archive", "fmu_radio_archive", "fmu_world_4_archive", "mebots")
    text, columns, summary = fly(build, out / "flight")
    print(text, end="")
    check_distances(columns)
    check_loss(summary)
    check_energy(summary)
    require(fly(build, out / "again")[1] == columns, "a second flight had other values")
    _, deaf, heard = fly(build, out / "deaf", "--set", "radio.packet.loss=1", "--stop-time", "12")
    require(heard["received"]["most"] == 0, "a radio that loses all packets received one")
    check_hover(deaf)
    print("a second flight had the same bits; without packets the followers hover")
    check_approach(fly(build, out / "far", "--set", "world.start.spacing.x=-50", "--stop-time", "12")[1])


if __name__ == "__main__":
    main()
