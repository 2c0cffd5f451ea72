#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that robots are in a run's MCAP file: a shape for each, and the poses of results.csv.

Usage: mcap_robots.py MEBOTS RUN_DIR OUT.mcap
"""

import collections
import csv
import math
import sys

from mcap_messages import exported

ROBOTS = (1, 2)

mebots, run, out = sys.argv[1:]
messages = exported(mebots, run, out)
with open(f"{run}/results.csv", newline="") as file:
    head, *rows = csv.reader(file)
columns = {title.split(" [")[0]: [float(row[i]) for row in rows] for i, title in enumerate(head)}

poses = collections.defaultdict(list)
for _, time, pose in messages["/tf"]:
    poses[pose["child_frame_id"]].append((time, pose))
entities = {entity["frame_id"]: entity for entity in messages["/scene"][0][2]["entities"]}
for robot in ROBOTS:
    frame = f"mover {robot - 1}"
    assert len(entities[frame]["triangles"]) > 20, f"robot {robot} has {len(entities[frame]['triangles'])} faces"
    heights = [point["z"] for triangle in entities[frame]["triangles"] for point in triangle["points"]]
    assert abs(max(heights) - 0.12) < 1e-9 and abs(min(heights)) < 1e-9, (min(heights), max(heights))  # roof and ground of the scene yard
    assert [time for time, _ in poses[frame]] == [round(1e9 * time) for time in columns["time"]]
    for axis in "xyz":
        assert [pose["translation"][axis] for _, pose in poses[frame]] == columns[f"world.robot[{robot}].place.{axis}"], (robot, axis)
    for (_, pose), heading in zip(poses[frame], columns[f"world.robot[{robot}].heading"]):
        q = pose["rotation"]
        assert math.isclose(2 * math.atan2(q["z"], q["w"]), heading, abs_tol=1e-12) and q["x"] == q["y"] == 0
assert columns["world.robot[1].place.x"][-1] - columns["world.robot[1].place.x"][0] > 0.5, "robot 1 did not drive"
assert columns["world.robot[2].heading"][-1] - columns["world.robot[2].heading"][0] > 1, "robot 2 did not turn"
print(f"{len(ROBOTS)} robots at {len(rows)} times agree with results.csv")
