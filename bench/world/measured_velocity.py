#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the velocity loop of fmu_world's Crazyflie controller with a published flight of a real Crazyflie.

    git clone https://github.com/MarkAkbashev/crazyflie-dataset /tmp/dataset
    git -C /tmp/dataset checkout 5a16f969dc18214ba977fff4ffe492d33f94f73c
    .venv/bin/python bench/world/measured_velocity.py build/release/fmus/fmu_world.fmu /tmp/dataset/drone?/flight1/posCtl1.csv

Ten times per second, the log contains the position controller's set-point and its requested velocity. This velocity is the
firmware's gain, 2 1/s, times the position error (PID_POS_X_KP; I and D are 0), so it determines the drone's position. The drone
kept its heading. The requested velocities are inputs of fmu_world. Position and forward speed of fmu_world are compared with the
flight.
"""
import argparse
import json
import tempfile
from pathlib import Path

import fmpy
import numpy as np

from firmware_steps import COMMAND, HOVER, SETTLED, STEP, Fmu

GAIN = 2.0
CRAZYFLIE = 1
LONGEST_DELAY = 1.0


def measured(path, least_height):
    """Returns times from 0 on, requested velocities and positions of the log's first flight. The flight begins when the height of
    the set-point first exceeds ``least_height``. It ends when this height falls below the limit, or at the end of the log.
    """
    log = np.genfromtxt(path, delimiter=",", names=True)
    level = log["posCtltargetZ"] > least_height
    if not level.any():
        raise SystemExit(f"{path}: never above {least_height} m; set --height")
    first = int(np.argmax(level))
    below = np.flatnonzero(~level[first:])
    flight = log[first:first + below[0]] if below.size else log[first:]
    if flight["timestamp"][-1] - flight["timestamp"][0] <= 1e3 * LONGEST_DELAY:
        raise SystemExit(f"{path}: above {least_height} m for less than {LONGEST_DELAY} s; set --height")
    asked = np.stack([flight["posCtltargetVX"], flight["posCtltargetVY"]], 1)
    place = np.stack([flight["posCtltargetX"], flight["posCtltargetY"]], 1) - asked / GAIN
    return 1e-3 * (flight["timestamp"] - flight["timestamp"][0]), asked, place


def flown(archive, unpacked, times, asked, lag):
    """Simulates a drone with the same requested velocities. Returns its positions at the times, interpolated linearly between
    rows."""
    drone = json.loads((Path(unpacked) / "resources/drones/crazyflie.json").read_text())
    curve = drone["thrust_curve"]
    fmu = Fmu(archive, unpacked, CRAZYFLIE)
    thrust = np.full(4, 0.25 * 0.04 * 9.80665)
    share = -np.expm1(-STEP / lag)
    settled = round(SETTLED / STEP)
    rows = []
    for k in range(settled + round(times[-1] / STEP) + 1):
        at = (k - settled) * STEP
        wanted = dict(HOVER)
        if at >= 0.0:
            wanted |= {name: np.interp(at, times, asked[:, i]) for i, name in enumerate(("forward", "left"))}
            rows.append(fmu.read(["drone.position.x", "drone.position.y"]))
        command = fmu.read(COMMAND)
        fmu.step(k, wanted, thrust, drone["torque_per_thrust"]["value"] * thrust)
        thrust = thrust + share * (np.interp(command, curve["command"], curve["thrust"]) - thrust)
    fmu.close()
    rows = np.array(rows)
    at = np.arange(len(rows)) * STEP
    return np.stack([np.interp(times, at, rows[:, i]) for i in (0, 1)], 1)


def delay(times, asked, place):
    """Returns the delay of the flown velocity relative to the requested velocity: the shift with the least sum of squares."""
    speed = np.gradient(place, times)
    shifts = np.arange(0.0, LONGEST_DELAY, 0.01)
    inner = times > shifts[-1]
    return shifts[np.argmin([np.square(speed[inner] - np.interp(times[inner] - s, times, asked)).sum() for s in shifts])]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fmu")
    parser.add_argument("logs", nargs="+", help="posCtl1.csv")
    parser.add_argument("--height", type=float, default=0.48, metavar="METRES",
                        help="where the flight counts: from the first row above it to the descent below it")
    parser.add_argument("--lag", type=float, default=0.1, metavar="SECONDS", help="of the rotors")
    given = parser.parse_args()
    print("| flight | way | place off, root mean square (largest) | speed off, root mean square | "
          "greatest speed asked, flown, ours | delay flown, ours |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as unpacked:
        fmpy.extract(given.fmu, unpacked)
        for log in given.logs:
            times, asked, place = measured(log, given.height)
            ours = flown(given.fmu, unpacked, times, asked, given.lag)
            way, own_way = place - place[0], ours - ours[0]
            off = np.abs(own_way - way)[:, 0]
            speed, own_speed = np.gradient(place[:, 0], times), np.gradient(ours[:, 0], times)
            late = [delay(times, asked[:, 0], p[:, 0]) for p in (place, ours)]
            print(f"| {log} | {np.ptp(way[:, 0]):.2f} m in {times[-1]:.1f} s | {np.sqrt(np.mean(off**2)):.3f} m ({off.max():.3f} m) | "
                  f"{np.sqrt(np.mean((own_speed - speed)**2)):.3f} m/s | "
                  f"{asked[:, 0].max():.3f}, {speed.max():.3f}, {own_speed.max():.3f} m/s | {late[0]:.2f} s, {late[1]:.2f} s |")


if __name__ == "__main__":
    main()
