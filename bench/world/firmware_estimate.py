#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares fmu_world's estimate with that of the Crazyflie's own firmware. Both use the same samples of the same sensors.

    git clone https://github.com/bitcraze/crazyflie-firmware /tmp/firmware
    git -C /tmp/firmware checkout 2a18fc299d7b48cf094d26c38a79f33dec64b5d7
    .venv/bin/python bench/world/firmware_estimate.py build/release/fmus/fmu_world.fmu /tmp/firmware

A Crazyflie takes off, flies two legs and turns between them, controlled by its own estimate, with noise in all sensors. Each
millisecond, the firmware's Kalman filter (kalman_core.c, mm_flow.c, mm_tof.c, unmodified) receives the readings of the FMU's
sensors. The table contains the largest and the root mean square difference between both filters, and between each filter and the
truth.
"""
import argparse
import ctypes
import json
import tempfile
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

from firmware import compiled

FILTER = ["modules/src/kalman_core/kalman_core", "modules/src/kalman_core/mm_flow", "modules/src/kalman_core/mm_tof",
          "modules/src/axis3fSubSampler", "utils/src/filter"]
STEP, END, LAG = 0.001, 40.0, 0.1
SENSORS = [f"imu.acceleration.{a}" for a in "xyz"] + [f"imu.angular_velocity.{a}" for a in "xyz"] + ["range.down"]
QUANTITIES = [f"{what}.{a}" for what in ("position", "velocity") for a in "xyz"] + ["roll", "pitch", "yaw"]
ROWS = {"level position [m]": [0, 1], "height [m]": [2], "velocity [m/s]": [3, 4, 5], "roll and pitch [degrees]": [6, 7], "yaw [degrees]": [8]}


def wish(t):
    """Returns the mode, the forward velocity and the yaw rate that are commanded at a time."""
    if t < 5.0:
        return 1, 0.0, 0.0
    return 2, 0.6 if 6.0 < t < 14.0 or 22.0 < t < 30.0 else 0.0, 0.5 if 16.0 < t < 20.0 else 0.0


class World:
    def __init__(self, archive):
        description = fmpy.read_model_description(archive)
        unpacked = fmpy.extract(archive)
        drone = json.loads((Path(unpacked) / "resources/drones/crazyflie.json").read_text())
        self.curve, self.arm = drone["thrust_curve"], drone["torque_per_thrust"]["value"]
        self.at = {v.name: v.valueReference for v in description.modelVariables}
        self.slave = FMU2Slave(guid=description.guid, unzipDirectory=unpacked, instanceName="world",
                               modelIdentifier=description.coSimulation.modelIdentifier)
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.setString([self.at["scene.name"]], ["empty"])
        self.slave.setInteger([self.at[n] for n in ("stabiliser.controller", "stabiliser.state", "range.model")], [1, 1, 1])
        self.slave.setReal([self.at[n] for n in ("imu.acceleration_noise", "imu.rate_noise")], [0.03, 0.006])
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()
        self.thrust = np.zeros(4)

    def real(self, names):
        return self.slave.getReal([self.at[n] for n in names])

    def step(self, k):
        """Performs step number k: sets the inputs, steps the FMU, and advances the rotors."""
        mode, forward, yaw_rate = wish(k * STEP)
        command = np.array(self.real([f"rotor[{i}].command" for i in (1, 2, 3, 4)]))
        self.slave.setReal([self.at[f"rotor[{i}].{what}"] for what in ("thrust", "torque") for i in (1, 2, 3, 4)],
                           [*self.thrust, *(self.arm * self.thrust)])
        self.slave.setReal([self.at[n] for n in ("setpoint.velocity.x", "setpoint.yaw_rate")], [forward, yaw_rate])
        self.slave.setInteger([self.at["setpoint.mode"]], [mode])
        self.slave.doStep(k * STEP, STEP)
        self.thrust += -np.expm1(-STEP / LAG) * (np.interp(command, self.curve["command"], self.curve["thrust"]) - self.thrust)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fmu")
    parser.add_argument("firmware", type=Path, help="checkout of crazyflie-firmware")
    given = parser.parse_args()
    world = World(given.fmu)
    truths, ours, theirs = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        own = ctypes.CDLL(str(compiled(given.firmware, Path(folder), "firmware_estimator", FILTER)))
        three, nine = ctypes.c_double * 3, ctypes.c_double * 9
        place = world.real([f"drone.position.{a}" for a in "xyz"] + ["drone.yaw"])
        own.begin((ctypes.c_double * 4)(*place))
        for k in range(round(END / STEP)):
            world.step(k)
            ms = k + 1
            read = world.real(SENSORS)
            counts = world.slave.getInteger([world.at["flow.motion.x"], world.at["flow.motion.y"]])
            seen = world.slave.getBoolean([world.at["flow.seen"]])[0]
            distance = read[6] if (ms % 25 == 0 or ms == 1) and read[6] < 4.0 else -1.0  # the first reading is that of
                                                                                         # the start
            out = nine()
            own.step(ctypes.c_uint(ms), three(*read[:3]), three(*read[3:6]), (ctypes.c_double * 2)(*counts),
                     ctypes.c_bool(bool(seen) and ms % 10 == 0), ctypes.c_double(distance), ctypes.c_bool(True), out)
            theirs.append(list(out))
            ours.append(world.real([f"estimate.{q}" for q in QUANTITIES]))
            truths.append(world.real([f"drone.{q}" for q in QUANTITIES]))
    truths, ours, theirs = (np.array(x)[round(5.0 / STEP):] for x in (truths, ours, theirs))

    def apart(a, b, columns):
        difference = a[:, columns] - b[:, columns]
        if columns[0] >= 6:
            difference = np.degrees((difference + np.pi) % (2 * np.pi) - np.pi)
        size = np.abs(difference).max(axis=1)
        return f"{np.sqrt(np.mean(size**2)):.4f} ({size.max():.4f})"

    print("| root mean square (largest) difference | ours from firmware's | ours from the truth | firmware's from the truth |")
    print("|---|---|---|---|")
    for name, columns in ROWS.items():
        print(f"| {name} | {apart(ours, theirs, columns)} | {apart(ours, truths, columns)} | {apart(theirs, truths, columns)} |")


if __name__ == "__main__":
    main()
