#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the processor time of a picture: for the shipped scenes, and over the number of objects in a scene.

    .venv/bin/python bench/world/renderer.py build/release/bin/mebots-camera

Each value is the fastest of several pictures of 320 x 320 pixels, without noise and blur, one metre above the start. The objects
are crates and firs in alternation. A seed places them on a field of 40 m x 40 m around the camera.
"""
import argparse
import json
import random
import re
import subprocess
import tempfile
from pathlib import Path

WORLD = Path(__file__).resolve().parents[2] / "fmu_world/params"
SHIPPED = ("empty", "gate_easy", "gate_edge", "warehouse", "forest")
COUNTS = (0, 10, 30, 100, 300, 1000, 3000)
CLEAR_M = 1.0  # free space around the camera


def fastest_ms(camera, scene, repeat):
    with tempfile.TemporaryDirectory() as folder:
        told = subprocess.run([camera, scene, "--repeat", str(repeat), "--out", f"{folder}/picture.pgm"],
                              check=True, capture_output=True, text=True).stdout
    return float(re.search(r"fastest ([0-9.]+) ms", told)[1])


def place(draw):
    while True:
        x, y = draw.uniform(-20.0, 20.0), draw.uniform(-20.0, 20.0)
        if max(abs(x), abs(y)) > CLEAR_M:
            return x, y


def field_of(count):
    """Returns a scene that contains `count` objects."""
    draw = random.Random(1)
    scene = json.loads((WORLD / "scenes/empty.json").read_text())
    scene["drone"] = str(WORLD / "drones/crazyflie.json")
    scene["boxes"], scene["meshes"] = [], []
    for i in range(count):
        x, y = place(draw)
        yaw = draw.uniform(0.0, 6.28)
        if i % 2:
            fir = {"name": f"fir {i}", "file": str(WORLD / "things/fir.glb"), "position": [x, y, 0.0], "yaw": yaw}
            scene["meshes"].append(fir | {"scale": draw.uniform(0.6, 1.2)})
        else:
            size = [draw.uniform(0.3, 1.2) for _ in range(3)]
            crate = {"name": f"crate {i}", "size": size, "position": [x, y, 0.5 * size[2]], "yaw": yaw}
            scene["boxes"].append(crate | {"texture": {"kind": "noise", "light": 180, "dark": 90, "scale": 0.1, "seed": 1}})
    return scene


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("camera", help="mebots-camera")
    parser.add_argument("--repeat", type=int, default=100, help="pictures of each scene")
    given = parser.parse_args()
    print("| scene | processor time of a picture |")
    print("|---|---|")
    for name in SHIPPED:
        print(f"| {name} | {fastest_ms(given.camera, WORLD / f'scenes/{name}.json', given.repeat):.2f} ms |", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for count in COUNTS:
            scene = Path(folder) / "field.json"
            scene.write_text(json.dumps(field_of(count)))
            print(f"| {count} things | {fastest_ms(given.camera, scene, given.repeat):.2f} ms |", flush=True)


if __name__ == "__main__":
    main()
