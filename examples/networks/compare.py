#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the sight network at three widths on gate_easy and gate_hard: success, latency and energy. Writes the deployed
networks, both studies with their results, and table.md into FOLDER.

Usage: python examples/networks/compare.py FOLDER [--flights N] [--mebots PROGRAM]"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
CONFIGS = HERE.parents[1] / "configs"
NETWORKS = ("sight", "sight_three_quarters", "sight_half")
# Maps a mission to parameters of the sight firmware, and to the ranges of the random starts. Both are those of
# examples/paper/sight.
MISSIONS = {
    "gate_easy": (
        {"soc.firmware": ["sight"], "soc.mission.policy": ["adaptive"], "soc.mission.yaw_rate_scale": [0.8], "soc.mission.frame_period": [0.033]},
        {"world.start.offset.x": 0.5, "world.start.offset.y": 0.5, "world.start.yaw_offset": 0.3},
    ),
    # A stop time of 90 s ends unsuccessful flights. A successful flight takes 35 s.
    "gate_hard": ({"/stop_time": [90]}, {"world.start.offset.x": 0.3, "world.start.offset.y": 0.1, "world.start.yaw_offset": 0.02}),
}
OBJECTIVES = {
    "success": {"outcome": ["passed", "touched_passed"]},
    "inference": {"summary": "decision.mean.inference", "where": "success"},
    "latency": {"summary": "decision.mean.latency", "where": "success"},
    "chip energy": {"summary": "energy.soc", "unit": "J", "minimize": True, "where": "success"},
    "energy": {"summary": "energy.delivered", "unit": "J", "where": "success"},
}
COLUMNS = ("network", "mission", "flights", "passed", "of them touched", "inference", "picture to set-point", "chip", "all")


def study(mission, folder, flights):
    """Returns the study of a mission. An empty network name selects the firmware's network, whose kernels are scheduled by hand.
    """
    settings, ranges = MISSIONS[mission]
    draws = {name: {"uniform": [-most, most]} for name, most in ranges.items()} | {"world.sensors.seed": {"integer": [1, 1_000_000]}}
    return {
        "mission": str(CONFIGS / f"{mission}.json"),
        "design": {"kind": "grid", "factors": {"soc.network": ["", *(str(folder / one) for one in NETWORKS)], **settings}},
        "draws": {"replicates": flights, "seed": 1, "variables": draws},
        "objectives": OBJECTIVES,
        "limits": {"processor_time": 300},
    }


def rows_of(mission, results):
    """Computes a row of the table for each network from the missions of a study."""
    with open(results / "missions.csv", newline="", encoding="utf-8") as file:
        missions = list(csv.DictReader(file))
    for network in dict.fromkeys(one["soc.network"] for one in missions):
        flown = [one for one in missions if one["soc.network"] == network]
        passed = [one for one in flown if one["outcome"] in OBJECTIVES["success"]["outcome"]]

        def mean(label, factor, unit, passed=passed):
            column = f"{label} [{OBJECTIVES[label]['unit']}]" if "unit" in OBJECTIVES[label] else label
            values = [float(one[column]) for one in passed]
            return f"{factor * sum(values) / len(values):.4g} {unit}" if values else "-"

        name = pathlib.Path(network).name if network else "sight, kernels by hand"
        costs = mean("inference", 1e3, "ms"), mean("latency", 1e3, "ms"), mean("chip energy", 1, "J"), mean("energy", 1, "J")
        touched = sum(one["outcome"] == "touched_passed" for one in passed)
        yield name, mission, str(len(flown)), str(len(passed)), str(touched), *costs


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--flights", type=int, default=8, help="of each network in each mission")
    parser.add_argument("--mebots", default="mebots")
    given = parser.parse_args()
    folder = given.folder.absolute()
    models = folder / "models"
    subprocess.run([sys.executable, HERE / "own_networks.py", models], check=True)
    for name in NETWORKS:
        if not (folder / name).exists():
            words = [given.mebots, "deploy", models / f"{name}.onnx", "--data", models / f"{name}.npy", "--out", folder / name]
            subprocess.run(words, check=True)
    lines = [f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|"]
    for mission in MISSIONS:
        file = folder / f"{mission}.json"
        file.write_text(json.dumps(study(mission, folder, given.flights), indent=1) + "\n", encoding="utf-8")
        subprocess.run([given.mebots, "sweep", file, "--out", folder / mission], check=True)
        lines += [f"| {' | '.join(row)} |" for row in rows_of(mission, folder / mission)]
    (folder / "table.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
