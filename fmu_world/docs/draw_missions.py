#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws missions.png. Its pictures are from a mission's camera, for each example world.

    mebots run configs/warehouse.json --out /tmp/warehouse; mebots run configs/forest.json --out /tmp/forest
    .venv/bin/python fmu_world/docs/draw_missions.py /tmp/warehouse /tmp/forest
"""
import sys
from pathlib import Path

from PIL import Image

COUNT, SIZE, GAP = 5, 200, 6


def row(results):
    """Returns pictures of a mission's camera at equal time intervals."""
    files = sorted(Path(results).glob("pictures/world.camera.frame/*.png"))
    if len(files) < COUNT:
        sys.exit(f"{results}: {len(files)} pictures, {COUNT} are drawn")
    return [Image.open(files[round((k + 0.5) * (len(files) - 1) / COUNT)]).convert("L").resize((SIZE, SIZE)) for k in range(COUNT)]


def main():
    rows = [row(results) for results in sys.argv[1:]]
    sheet = Image.new("L", (COUNT * (SIZE + GAP) - GAP, len(rows) * (SIZE + GAP) - GAP), 255)
    for y, pictures in enumerate(rows):
        for x, picture in enumerate(pictures):
            sheet.paste(picture, (x * (SIZE + GAP), y * (SIZE + GAP)))
    sheet.save(Path(__file__).parent / "missions.png", optimize=True)


if __name__ == "__main__":
    main()
