#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the processor time for determining the Pareto front of designs. There are two objectives, 30 missions per design, and
noise with a standard deviation of 0.05.

Usage: front.py FMU DESIGNS... (with the package mebots in PYTHONPATH). In one case, the mean objectives of the designs are spread
over a unit square. In the other case, all means are on a quarter of a circle, so that every design is on the front.
"""

import json
import math
import pathlib
import random
import sys
import tempfile
import time

from mebots.exploration import front
from mebots.exploration.comparison import Evidence
from mebots.exploration.study import read_study

REPLICATES = 30
NOISE = 0.05


def study(fmu):
    """Returns a study with two objectives. Only these objectives affect the measurement."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "mission.json").write_text(json.dumps({
            "step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": fmu}}, "connections": [],
            "summary": {"x": "a.integral", "y": "a.real_out"}}))
        (folder / "study.json").write_text(json.dumps({
            "mission": "mission.json", "design": {"kind": "grid", "factors": {"a.gain": [1, 2]}},
            "draws": {"replicates": REPLICATES, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}},
            "objectives": {label: {"summary": label, "minimize": True} for label in ("x", "y")}}))
        return read_study(folder / "study.json")


def point(chance, on_front):
    if not on_front:
        return chance.random(), chance.random()
    angle = chance.random() * math.pi / 2
    return 1 - math.sin(angle), 1 - math.cos(angle)


def timed(read, designs, on_front):
    """Returns the processor time for determining the front of `designs` designs once [s]. If `on_front` is true, all designs are
    on the front."""
    evidence, chance = Evidence(read, designs), random.Random(1)
    for design in range(designs):
        x, y = point(chance, on_front)
        for replicate in range(REPLICATES):
            evidence.put(design, replicate, (x + NOISE * chance.gauss(0, 1), y + NOISE * chance.gauss(0, 1)))
        evidence.count_to(design, REPLICATES)
    begun_s = time.process_time()
    front.places(evidence)
    return time.process_time() - begun_s


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: front.py FMU DESIGNS...")
    read = study(str(pathlib.Path(sys.argv[1]).resolve()))
    print("| designs | spread over a square | all on the front |\n|---|---|---|")
    for designs in map(int, sys.argv[2:]):
        print(f"| {designs} | {timed(read, designs, False):.2f} s | {timed(read, designs, True):.2f} s |", flush=True)


if __name__ == "__main__":
    main()
