#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the MCAP file of a flight with MCAP's own package. Compares channels, order and numbers with results.csv.

Usage: mcap_check.py MEBOTS RUN_DIR OUT.mcap
"""

import base64
import csv
import math
import sys

from mcap_messages import exported

mebots, run, out = sys.argv[1:]
messages = exported(mebots, run, out)
with open(f"{run}/results.csv", newline="") as file:
    head, *rows = csv.reader(file)


def column(name):
    place = next(i for i, title in enumerate(head) if title.startswith(f"{name} ["))
    return [float(row[place]) for row in rows]


for topic, of_topic in messages.items():
    times = [time for _, time, _ in of_topic]
    assert times == sorted(times), f"{topic} is not in the order of time"

battery = messages["/battery"]
assert len(battery) == len(rows)
assert [time for _, time, _ in battery] == [round(time * 1e9) for time in column("time")]
assert [message["cell"]["voltage"] for _, _, message in battery] == column("battery.cell.voltage")
assert [message["power"]["value"] for _, _, message in messages["/soc"]] == column("soc.power")
assert [message["rotor_1"]["thrust"] for _, _, message in messages["/motors"]] == column("motors.rotor[1].thrust")

poses = messages["/tf"]
assert {name for name, _, _ in poses} == {"foxglove.FrameTransform"}
assert [pose["translation"]["z"] for _, _, pose in poses] == column("world.drone.position.z")
for (_, _, pose), roll, pitch, yaw in zip(poses, column("world.drone.roll"), column("world.drone.pitch"), column("world.drone.yaw")):
    q = pose["rotation"]  # converts the rotation to the angle about z, and to the z axis of the body
    assert math.isclose(math.atan2(2 * (q["w"] * q["z"] + q["x"] * q["y"]), 1 - 2 * (q["y"] ** 2 + q["z"] ** 2)), yaw, abs_tol=1e-12)
    assert math.isclose(1 - 2 * (q["x"] ** 2 + q["y"] ** 2), math.cos(roll) * math.cos(pitch), abs_tol=1e-12)

pictures = messages["/world.camera.frame"]
assert pictures and all(base64.b64decode(picture["data"]).startswith(b"\x89PNG") for _, _, picture in pictures)
assert any("take-off" in entry["message"] for _, _, entry in messages["/log"])
assert messages["/scene"][0][2]["entities"][0]["triangles"], "no faces"
print(f"{sum(map(len, messages.values()))} messages in {len(messages)} channels agree with results.csv")
