#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares step responses of fmu_world's controllers with those of the Crazyflie's own firmware and of an identified Crazyflie.

    git clone https://github.com/bitcraze/crazyflie-firmware /tmp/firmware
    git -C /tmp/firmware checkout 2a18fc299d7b48cf094d26c38a79f33dec64b5d7
    pip download --no-deps --no-binary :none: crazyflow==0.4.0 -d /tmp && unzip -d /tmp/crazyflow /tmp/crazyflow-*.whl
    .venv/bin/python bench/world/firmware_steps.py build/release/fmus/fmu_world.fmu /tmp/firmware --identified /tmp/crazyflow

The firmware's controller_pid.c and its dependencies are compiled unmodified, and control the body of fmu_world: they read its
outputs, and their commands go through the same rotors as for the FMU's own controllers (the drone file's thrust curve, a
first-order lag). Therefore the rows `crazyflie` and `firmware` differ only by our transcription. `identified` is crazyflow's
second-order response of a real Crazyflie (cf2x_L250) to attitude commands. Its authors fitted it to flights
(dynamics/so_rpy/params.toml). Its gain is not 1, so it is judged relative to its own final value.
"""
import argparse
import ctypes
import json
import shutil
import tempfile
import tomllib
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

from firmware import compiled

STEP = 0.002
SETTLED = 12.0
CONTROLLER = [f"modules/src/controller/{name}" for name in ("controller_pid", "position_controller_pid", "attitude_pid_controller")] + [
    "utils/src/pid", "utils/src/filter", "utils/src/num", "modules/src/power_distribution_quadrotor"]
STATE = ([f"drone.position.{a}" for a in "xyz"] + [f"drone.velocity.{a}" for a in "xyz"] + ["drone.roll", "drone.pitch", "drone.yaw"] +
         [f"drone.angular_velocity.{a}" for a in "xyz"])
COMMAND = [f"rotor[{i}].command" for i in (1, 2, 3, 4)]
HOVER = {"forward": 0.0, "left": 0.0, "yaw_rate": 0.0, "altitude": 1.0}
# Maps a name to: the goal after the step, the column of the state that should follow it, the column's value before and after the
# step, and the seconds that are compared.
STEPS = {
    "pitch, 20 degrees": ({"forward": 3.0}, 7, 0.0, np.radians(20.0), 0.6),
    "velocity, 0.5 m/s": ({"forward": 0.5}, 3, 0.0, 0.5, 8.0),
    "yaw rate, 0.5 rad/s": ({"yaw_rate": 0.5}, 11, 0.0, 0.5, 4.0),
    "altitude, 0.3 m": ({"altitude": 1.3}, 2, 1.0, 1.3, 8.0),
}


class Fmu:
    def __init__(self, archive, unpacked, controller):
        description = fmpy.read_model_description(archive)
        self.at = {v.name: v.valueReference for v in description.modelVariables}
        self.slave = FMU2Slave(guid=description.guid, unzipDirectory=unpacked, instanceName="world",
                               modelIdentifier=description.coSimulation.modelIdentifier)
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.setString([self.at["scene.name"]], ["empty"])
        self.slave.setReal([self.at["start.offset.z"]], [1.0])
        self.slave.setInteger([self.at["stabiliser.controller"], self.at["setpoint.mode"]], [controller, 2])
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def read(self, names):
        return np.array(self.slave.getReal([self.at[n] for n in names]))

    def step(self, k, goal, thrust, torque):
        names = [f"rotor[{i}].{what}" for what in ("thrust", "torque") for i in (1, 2, 3, 4)]
        names += ["setpoint.velocity.x", "setpoint.velocity.y", "setpoint.yaw_rate", "setpoint.altitude"]
        self.slave.setReal([self.at[n] for n in names],
                           [*thrust, *torque, goal["forward"], goal["left"], goal["yaw_rate"], goal["altitude"]])
        self.slave.doStep(k * STEP, STEP)

    def close(self):
        self.slave.terminate()
        self.slave.freeInstance()


def fly(archive, unpacked, drone, goal, seconds, lag, controller, library=None):
    """Returns the state at each step, from the change of the goal on."""
    fmu = Fmu(archive, unpacked, controller)
    own = None
    if library:  # loads a copy for each flight, because the controller's state is in global variables
        with tempfile.NamedTemporaryFile(suffix=".so") as copy:
            shutil.copy(library, copy.name)
            own = ctypes.CDLL(copy.name)
        own.begin()
    command = np.zeros(4)
    thrust = np.full(4, 0.25 * 0.04 * 9.80665)
    curve = drone["thrust_curve"]
    share = -np.expm1(-STEP / lag)
    rows = []
    start = round(SETTLED / STEP)
    heard = HOVER  # inputs that are set for a step take effect at its end
    for k in range(start + round(seconds / STEP) + 1):
        wanted = HOVER | (goal if k >= start else {})
        state = fmu.read(STATE)
        if k >= start:
            rows.append(state)
        if own:
            four = (ctypes.c_double * 4)(*command)
            own.step((ctypes.c_double * 12)(*state), (ctypes.c_double * 4)(*heard.values()), ctypes.c_uint(2 * k), four)
            command = np.array(four)
        else:
            command = fmu.read(COMMAND)
        heard = wanted
        fmu.step(k, wanted, thrust, drone["torque_per_thrust"]["value"] * thrust)
        thrust = thrust + share * (np.interp(command, curve["command"], curve["thrust"]) - thrust)
    fmu.close()
    return np.array(rows)


def judged(values, begin, end):
    """Returns the rise time from 10 to 90 %, the overshoot, and the time after which the response stays within 5 %."""
    share = (values - begin) / (end - begin)
    above = [np.argmax(share >= level) if (share >= level).any() else None for level in (0.1, 0.9)]
    rise = (above[1] - above[0]) * STEP if None not in above else np.nan
    outside = np.flatnonzero(np.abs(share - 1.0) > 0.05)
    last = outside[-1] + 1 if len(outside) else 0
    settled = last * STEP if last < len(share) else np.nan
    return rise, max(0.0, share.max() - 1.0), settled


def identified(folder, seconds):
    """Returns the response to a step of the commanded pitch, divided by its final value."""
    p = tomllib.loads(next(folder.glob("**/dynamics/so_rpy/params.toml")).read_text())["cf2x_L250"]
    angle, rate, given = p["rpy_coef"][1], p["rpy_rates_coef"][1], p["cmd_rpy_coef"][1]
    a = np.array([[0.0, 1.0], [angle, rate]])
    y, out = np.zeros(2), []
    for _ in range(round(seconds / STEP) + 1):
        out.append(y[0])
        for _ in range(20):
            y = y + STEP / 20 * (a @ y + [0.0, given])
    return np.array(out) / (-given / angle)


def line(name, controller, figures, apart=""):
    rise, over, settled = figures
    end = "not yet" if np.isnan(settled) else f"{settled:.2f} s"
    print(f"| {name} | {controller} | {rise:.2f} s | {100 * over:.1f} % | {end} | {apart} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fmu")
    parser.add_argument("firmware", type=Path, help="checkout of crazyflie-firmware")
    parser.add_argument("--identified", type=Path, metavar="FOLDER", help="crazyflow, unpacked")
    parser.add_argument("--lag", type=float, default=0.1, metavar="SECONDS", help="of the rotors; the README's table has 0.1")
    given = parser.parse_args()
    unpacked = fmpy.extract(given.fmu)
    drone = json.loads((Path(unpacked) / "resources/drones/crazyflie.json").read_text())
    with tempfile.TemporaryDirectory() as folder:
        library = compiled(given.firmware, Path(folder), "firmware_controller", CONTROLLER)
        print("| step of | controller | rise 10 to 90 % | overshoot | within 5 % after | from firmware at most |")
        print("|---|---|---|---|---|---|")
        for name, (goal, column, begin, end, seconds) in STEPS.items():
            theirs = fly(given.fmu, unpacked, drone, goal, seconds, given.lag, 0, library)[:, column]
            # Omits the ideal stabiliser for the step of the pitch, because it commands another pitch than the firmware.
            for controller, number in (("crazyflie", 1),) if column == 7 else (("ideal", 0), ("crazyflie", 1)):
                ours = fly(given.fmu, unpacked, drone, goal, seconds, given.lag, number)[:, column]
                line(name, controller, judged(ours, begin, end), f"{100 * np.abs(ours - theirs).max() / abs(end - begin):.2f} %")
            line(name, "firmware", judged(theirs, begin, end))
            if given.identified and column == 7:
                line(name, "identified", judged(identified(given.identified, seconds), 0.0, 1.0))


if __name__ == "__main__":
    main()
